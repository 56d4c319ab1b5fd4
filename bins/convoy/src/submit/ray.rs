//! Ray: one script, which starts `python -m convoy.ray`.

use std::path::PathBuf;

use super::groups::Split;
use crate::words::quoted;

/// What Ray calls a GPU.
const GPU: &str = "GPU";

/// What the script is about.
#[derive(Clone, Debug)]
pub(super) struct Driver {
    pub(super) config: PathBuf,
    pub(super) store: PathBuf,
    pub(super) maps: Option<PathBuf>,
    /// Of the script; the tasks' logs lie in `logs` in it.
    pub(super) folder: PathBuf,
    /// `convoy` on the nodes.
    pub(super) program: PathBuf,
    pub(super) address: Option<String>,
    pub(super) tasks: u32,
    pub(super) cores: u32,
    pub(super) memory_gib: u32,
    pub(super) splits: Vec<Split>,
}

/// Refuses what a stage cannot want of Ray.
pub(super) fn check_splits(splits: &[Split]) -> Result<(), String> {
    match splits.iter().find(|split| !split.options.is_empty()) {
        Some(split) => {
            Err(format!("--split {}: Ray takes one resource of a node and no options", split.stage))
        }
        None => Ok(()),
    }
}

impl Driver {
    /// The script.
    pub(super) fn script(&self) -> String {
        let mut lines =
            vec![format!("--config {}", quoted(&self.config)), format!("--store {}", quoted(&self.store))];
        lines.extend(self.maps.as_deref().map(|maps| format!("--maps {}", quoted(maps))));
        lines.push(format!("--tasks {} --cpus {} --memory {}", self.tasks, self.cores, self.memory_gib));
        lines.extend(self.splits.iter().map(|Split { stage, place, .. }| {
            let resource = if place.eq_ignore_ascii_case(GPU) { GPU } else { place };
            format!("--split {}", quoted(format!("{stage}={resource}").as_ref()))
        }));
        lines.extend(self.address.as_ref().map(|address| format!("--address {}", quoted(address.as_ref()))));
        lines.push(format!("--program {}", quoted(&self.program)));
        lines.push(format!("--logs {}", quoted(&self.folder.join("logs"))));
        format!(
            "#!/bin/bash\n# Makes the dataset with Ray; started again, it goes on where it was. PYTHON names an \
             interpreter\n# that has Ray and convoy-data.\nset -eu\nexec \"${{PYTHON:-python3}}\" -m convoy.ray \\\n    \
             {}\n",
            lines.join(" \\\n    ")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_script_starts_the_driver() {
        let plain = Driver {
            config: "/home/mira/rain town.toml".into(),
            store: "/scratch/rain".into(),
            maps: None,
            folder: "/scratch/rain-jobs".into(),
            program: "/opt/convoy/bin/convoy".into(),
            address: None,
            tasks: 40,
            cores: 16,
            memory_gib: 18,
            splits: Vec::new(),
        };
        let all = Driver {
            store: "s3://sets/rain".into(),
            maps: Some("/data/maps".into()),
            program: "convoy".into(),
            address: Some("10.0.0.7:6379".into()),
            splits: vec!["render-sensors=gpu".parse().expect("is a split")],
            ..plain.clone()
        };
        insta::assert_snapshot!(format!("{}\n{}", plain.script(), all.script()), @r#"
        #!/bin/bash
        # Makes the dataset with Ray; started again, it goes on where it was. PYTHON names an interpreter
        # that has Ray and convoy-data.
        set -eu
        exec "${PYTHON:-python3}" -m convoy.ray \
            --config '/home/mira/rain town.toml' \
            --store /scratch/rain \
            --tasks 40 --cpus 16 --memory 18 \
            --program /opt/convoy/bin/convoy \
            --logs /scratch/rain-jobs/logs

        #!/bin/bash
        # Makes the dataset with Ray; started again, it goes on where it was. PYTHON names an interpreter
        # that has Ray and convoy-data.
        set -eu
        exec "${PYTHON:-python3}" -m convoy.ray \
            --config '/home/mira/rain town.toml' \
            --store s3://sets/rain \
            --maps /data/maps \
            --tasks 40 --cpus 16 --memory 18 \
            --split render-sensors=GPU \
            --address 10.0.0.7:6379 \
            --program convoy \
            --logs /scratch/rain-jobs/logs
        "#);
        let options: Vec<Split> = vec!["render-sensors=gpu,--gres=gpu:1".parse().expect("is a split")];
        assert!(check_splits(&options).is_err() && check_splits(&all.splits).is_ok());
    }
}
