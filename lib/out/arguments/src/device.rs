//! What looks at scenes, on a command line.

use runner::DeviceOptions;

/// What looks at scenes.
#[derive(Clone, Debug, clap::Args)]
pub struct DeviceArgs {
    /// What looks at scenes: cpu, gpu, auto (a GPU if a usable one is there), or a GPU by its number or a
    /// part of its name; `render-sensors --device list` prints them. The output does not depend on it.
    #[arg(long, value_name = "NAME", env = "CONVOY_DEVICE", default_value = "auto", hide_env_values = true,
          value_parser = name)]
    device: String,
    /// How much of a GPU's memory may be used, in GiB (default: half of what it has).
    #[arg(long, value_name = "GIB", env = "CONVOY_DEVICE_MEMORY", hide_env_values = true, value_parser = gib)]
    device_memory: Option<f64>,
}

impl DeviceArgs {
    /// Whether a GPU is asked for, not taken where there is one.
    #[must_use]
    pub fn must_be_there(&self) -> bool {
        !matches!(self.device.trim(), "" | "auto" | "cpu")
    }

    /// The words that say the same to another program.
    #[must_use]
    pub fn words(&self) -> Vec<String> {
        let mut words = vec!["--device".to_owned(), self.device.clone()];
        if let Some(gib) = self.device_memory {
            words.extend(["--device-memory".to_owned(), gib.to_string()]);
        }
        words
    }
}

impl From<DeviceArgs> for DeviceOptions {
    fn from(args: DeviceArgs) -> Self {
        let bytes = |gib: f64| (gib * f64::from(1u32 << 30)) as u64;
        Self { name: args.device, memory_bytes: args.device_memory.map(bytes) }
    }
}

/// A device's name.
fn name(text: &str) -> Result<String, String> {
    match text {
        "list" => Err("`render-sensors --device list` prints the devices".to_owned()),
        name => Ok(name.to_owned()),
    }
}

fn gib(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok().filter(|gib| (0.001..=1e6).contains(gib));
    number.ok_or_else(|| "expected GiB, as 4 or 0.5".to_owned())
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Program {
        #[command(flatten)]
        device: DeviceArgs,
    }

    #[test]
    fn what_is_said_is_handed_on_and_understood() {
        let of = |words: &[&str]| {
            let given = Program::try_parse_from([&["program"], words].concat()).ok()?.device;
            let again = Program::try_parse_from([vec!["program".to_owned()], given.words()].concat());
            let again: DeviceOptions = again.expect("its own words").device.into();
            assert_eq!(again, given.clone().into());
            Some((given.must_be_there(), again.memory_bytes))
        };
        assert_eq!(of(&["--device", "cpu"]), Some((false, None)));
        assert_eq!(of(&["--device", "H100", "--device-memory", "0.5"]), Some((true, Some(1 << 29))));
        for bad in ["0", "-1", "inf", "4GiB"] {
            assert_eq!(of(&["--device-memory", bad]), None, "{bad}");
        }
        assert_eq!(of(&["--device", "list"]), None);
    }
}
