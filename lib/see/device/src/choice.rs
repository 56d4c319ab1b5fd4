//! What `--device` may say.

use std::fmt::Write;

use gpu::Adapter;

use crate::error::DeviceError;

/// What `--device` says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// A GPU if a usable one is there, else the CPU.
    #[default]
    Auto,
    /// The CPU.
    Cpu,
    /// A GPU: it is an error if there is none.
    Gpu,
    /// An adapter, by its number in the list or by a part of its name.
    Named(String),
}

impl From<&str> for Choice {
    fn from(text: &str) -> Self {
        match text.trim() {
            "auto" | "" => Self::Auto,
            "cpu" => Self::Cpu,
            "gpu" => Self::Gpu,
            name => Self::Named(name.to_owned()),
        }
    }
}

/// All adapters, a line each: number, name, driver, memory, and whether it is usable.
#[must_use]
pub fn list() -> String {
    let mut text = String::new();
    for (number, adapter) in gpu::adapters().iter().enumerate() {
        let state = match gpu::eyes(adapter, None) {
            Ok(_) if adapter.is_software() => {
                "computes as the CPU does; software, used by its name only".to_owned()
            }
            Ok(_) => "computes as the CPU does".to_owned(),
            Err(e) => format!("not usable: {e}"),
        };
        // Writing to a text cannot fail.
        let _ = writeln!(text, "{number}  {adapter}: {state}");
    }
    if text.is_empty() {
        text.push_str("Vulkan has no adapter: the CPU looks at scenes\n");
    }
    text
}

/// The adapter that a number or a part of a name means.
pub(crate) fn named<'a>(name: &str, adapters: &'a [Adapter]) -> Result<&'a Adapter, DeviceError> {
    let names: Vec<&str> = adapters.iter().map(Adapter::name).collect();
    match place(name, &names)[..] {
        [only] => Ok(&adapters[only]),
        [] => Err(DeviceError::Unknown { name: name.to_owned(), adapters: numbered(&names) }),
        _ => Err(DeviceError::Several { name: name.to_owned(), adapters: numbered(&names) }),
    }
}

/// Which names are meant: by number, by the whole name, else by a part of it.
fn place(name: &str, names: &[&str]) -> Vec<usize> {
    if let Ok(number) = name.parse::<usize>()
        && number < names.len()
    {
        return vec![number];
    }
    let name = name.to_lowercase();
    let those = |fits: &dyn Fn(&str) -> bool| -> Vec<usize> {
        (0..names.len()).filter(|&i| fits(&names[i].to_lowercase())).collect()
    };
    let whole = those(&|other| other == name);
    if whole.is_empty() { those(&|other| other.contains(&name)) } else { whole }
}

fn numbered(names: &[&str]) -> String {
    if names.is_empty() {
        return "Vulkan has no adapter".to_owned();
    }
    let lines: Vec<String> =
        names.iter().enumerate().map(|(number, name)| format!("{number}: {name}")).collect();
    format!("the adapters are {}", lines.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adapters_are_meant_by_number_or_by_name() {
        let names = ["NVIDIA H100", "NVIDIA H100 NVL", "llvmpipe (LLVM 15)", "NVIDIA H100"];
        assert_eq!(place("2", &names), [2]);
        assert_eq!(place("LLVM", &names), [2]);
        assert_eq!(place("nvidia h100 nvl", &names), [1]);
        // The whole name goes before a part of one; two cards of one name are told by their numbers.
        assert_eq!(place("NVIDIA H100", &names), [0, 3]);
        assert_eq!(place("h100", &names), [0, 1, 3]);
        assert!(place("4", &names).is_empty() && place("radeon", &names).is_empty());
    }

    #[test]
    fn words_are_choices() {
        let words = ["auto", "cpu", "gpu", "H100"].map(Choice::from);
        assert_eq!(words, [Choice::Auto, Choice::Cpu, Choice::Gpu, Choice::Named("H100".into())]);
    }

    #[test]
    fn what_is_missing_is_named_with_what_there_is() {
        let error = named("radeon", &[]).expect_err("there is none").to_string();
        assert_eq!(error, "--device radeon: there is no such adapter; Vulkan has no adapter");
    }
}
