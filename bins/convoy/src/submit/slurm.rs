//! Slurm: a job that plans, arrays of tasks, a job that joins whatever happened.

use std::path::PathBuf;

use super::groups::{Group, Split, groups_of};
use crate::words::{quoted, word};

/// A job that could not end is tried again five times; one whose node was lost Slurm requeues without limit.
const TRIED_ENOUGH: &str = r#"restarts=${SLURM_RESTART_COUNT:-0}
if [ "$restarts" -gt 5 ]; then
    echo "was tried 6 times: given up"
    exit 75
fi
"#;
/// Of a job that somebody cancels Slurm says that it no longer runs.
const AGAIN: &str = r#"# Stopped, out of memory, or the store is away: once more. What fails by itself (1, 2) would fail again.
if [ "$code" -eq 75 ] || [ "$code" -eq 137 ]; then
    if [ "$restarts" -lt 5 ] && [ "$(squeue --noheader --jobs="$SLURM_JOB_ID" --format=%T)" = RUNNING ]; then
        echo "ended with $code: requeued, for the $((restarts + 1)). of 5 times"
        scontrol requeue "$SLURM_JOB_ID" && sleep 60
    fi
fi
"#;
const PASSED_ON: &str = r#"# A scene that failed keeps no others from the next array: it is told there, and by the job that joins.
[ "$code" -ne 1 ] || exit 0
"#;

/// What the scripts are about.
#[derive(Clone, Debug)]
pub(super) struct Cluster {
    pub(super) name: String,
    pub(super) convoy: PathBuf,
    pub(super) config: PathBuf,
    /// Where the call was made: paths in the configuration are looked for from there.
    pub(super) directory: PathBuf,
    pub(super) store: PathBuf,
    pub(super) maps: Option<PathBuf>,
    /// Of the scripts; their logs lie in `logs` in it.
    pub(super) folder: PathBuf,
    pub(super) tasks: u32,
    pub(super) cores: u32,
    pub(super) memory_gib: u32,
    pub(super) minutes: u32,
    pub(super) partition: Option<String>,
    pub(super) splits: Vec<Split>,
    pub(super) options: Vec<String>,
    pub(super) at_once: Option<u32>,
}

impl Cluster {
    /// The scripts, by name.
    pub(super) fn scripts(&self) -> Vec<(String, String)> {
        let groups = groups_of(&self.splits);
        let mut scripts = vec![("plan.sh".to_owned(), self.plan())];
        for (position, group) in groups.iter().enumerate() {
            let is_last = position + 1 == groups.len();
            scripts.push((format!("{}.sh", group.name()), self.array(group, is_last)));
        }
        scripts.push(("join.sh".to_owned(), self.join()));
        scripts.push(("submit.sh".to_owned(), self.submit(&groups)));
        scripts
    }

    fn header(&self, kind: &str, lines: &[String], split: Option<&Split>) -> String {
        let partition = split.map(|split| &split.place).or(self.partition.as_ref());
        let mut all = vec![format!("--job-name={}", word(&format!("{}-{kind}", self.name)))];
        all.extend(partition.map(|partition| format!("--partition={partition}")));
        all.extend(lines.iter().cloned());
        all.extend(self.options.iter().chain(split.iter().flat_map(|split| &split.options)).cloned());
        let lines: String = all.iter().map(|line| format!("#SBATCH {line}\n")).collect();
        format!("#!/bin/bash\n{lines}set -u\n{TRIED_ENOUGH}")
    }

    fn log(&self, name: &str) -> String {
        format!("--output={}", quoted(&self.folder.join("logs").join(name)))
    }

    /// What a job needs that is no task.
    fn small(&self, memory_gib: u32, name: &str) -> [String; 6] {
        [
            format!("--cpus-per-task={}", self.cores.min(2)),
            format!("--mem={}G", self.memory_gib.min(memory_gib)),
            "--time=60".to_owned(),
            "--requeue".to_owned(),
            "--open-mode=append".to_owned(),
            self.log(&format!("{name}-%j.log")),
        ]
    }

    fn plan(&self) -> String {
        let lines = [&self.small(4, "plan")[..], &[format!("--chdir={}", quoted(&self.directory))]].concat();
        let maps = self.maps.as_deref().map_or(String::new(), |maps| format!(" --maps {}", quoted(maps)));
        format!(
            "{}# It was made when these scripts were: this looks whether it still stands.\n\
             {} run --stages plan --config {} --store {}{maps} --progress plain\ncode=$?\n{AGAIN}exit \"$code\"\n",
            self.header("plan", &lines, None),
            quoted(&self.convoy),
            quoted(&self.config),
            quoted(&self.store),
        )
    }

    /// `is_last`: no other array waits for this one.
    fn array(&self, group: &Group, is_last: bool) -> String {
        let at_once = self.at_once.map_or(String::new(), |n| format!("%{n}"));
        let lines = [
            format!("--array=0-{}{at_once}", self.tasks - 1),
            format!("--cpus-per-task={}", self.cores),
            format!("--mem={}G", self.memory_gib),
            format!("--time={}", self.minutes),
            // Two minutes before the end the script is told, and tells the task.
            "--signal=B:TERM@120".into(),
            "--requeue".into(),
            "--open-mode=append".into(),
            self.log(&format!("{}-%A-%a.log", group.name())),
        ];
        format!(
            r#"{header}# A requeued task goes on where it was: what is finished is kept.
{convoy} run --stages {stages} --shard {tasks} --store {store} \
    --threads {cores}{device} --progress plain &
task=$!
trap 'kill -TERM "$task" 2>/dev/null' TERM
while kill -0 "$task" 2>/dev/null; do wait "$task"; done
wait "$task"
code=$?
{AGAIN}{passed_on}exit "$code"
"#,
            header = self.header(&group.name(), &lines, group.split.as_ref()),
            convoy = quoted(&self.convoy),
            stages = group.words(),
            tasks = self.tasks,
            store = quoted(&self.store),
            cores = self.cores,
            // A task with a GPU does not quietly work on without it.
            device = if group.split.as_ref().is_some_and(asks_for_gpu) { " --device gpu" } else { "" },
            passed_on = if is_last { "" } else { PASSED_ON },
        )
    }

    fn join(&self) -> String {
        let lines = self.small(8, "join");
        let (convoy, store) = (quoted(&self.convoy), quoted(&self.store));
        format!(
            "{}# Whatever happened: manifests tell what is done.\n\
             {convoy} run --stages stats --store {store} --progress plain\n\
             code=$?\n{AGAIN}exec {convoy} status --store {store}\n",
            self.header("join", &lines, None)
        )
    }

    fn submit(&self, groups: &[Group]) -> String {
        let script = |name: &str| quoted(&self.folder.join(format!("{name}.sh")));
        let mut text = format!(
            "#!/bin/bash\n# Sends all jobs to Slurm.\nset -eu\njob=$(sbatch --parsable {})\necho \"plan: $job\"\n",
            script("plan")
        );
        for (position, group) in groups.iter().enumerate() {
            // A task of the next array follows the task of the same share.
            let after = if position == 0 { "afterok" } else { "aftercorr" };
            let name = group.name();
            text += &format!(
                "job=$(sbatch --parsable --dependency=\"{after}:${{job%%;*}}\" --kill-on-invalid-dep=yes {})\n\
                 echo \"{name}: $job\"\n",
                script(&name)
            );
        }
        text += &format!(
            "job=$(sbatch --parsable --dependency=\"afterany:${{job%%;*}}\" {})\necho \"join: $job\"\n",
            script("join")
        );
        text
    }
}

/// Whether the options of an array ask Slurm for a GPU: `--gres=gpu:1`, `--gpus=1`, `--gpus-per-node=1`.
fn asks_for_gpu(split: &Split) -> bool {
    let is_gpu = |option: &String| option.starts_with("--gpus") || option.starts_with("--gres=gpu");
    split.options.iter().any(is_gpu)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cluster() -> Cluster {
        Cluster {
            name: "rain in town".into(),
            convoy: "/opt/convoy/bin/convoy".into(),
            config: "/home/mira/rain town.toml".into(),
            directory: "/home/mira/my work".into(),
            store: "/scratch/rain".into(),
            maps: None,
            folder: "/scratch/rain-jobs".into(),
            tasks: 40,
            cores: 16,
            memory_gib: 18,
            minutes: 60,
            partition: None,
            splits: Vec::new(),
            options: Vec::new(),
            at_once: None,
        }
    }

    fn text(scripts: &[(String, String)]) -> String {
        scripts.iter().map(|(name, text)| format!("==> {name}\n{text}")).collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn a_plan_an_array_and_a_join() {
        insta::assert_snapshot!(text(&cluster().scripts()));
    }

    #[test]
    fn a_stage_on_other_nodes_is_an_array_of_its_own() {
        let split = Cluster {
            partition: Some("cpu".into()),
            splits: vec!["render-sensors=gpu,--gres=gpu:1".parse().expect("is a split")],
            options: vec!["--account=lab".into()],
            maps: Some("/data/maps".into()),
            at_once: Some(8),
            ..cluster()
        };
        let scripts = split.scripts();
        let names: Vec<&str> = scripts.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(
            names,
            [
                "plan.sh",
                "simulate-and-log-bev-gt-occupancy-gt.sh",
                "render-sensors.sh",
                "postprocess-valid-merge-tracks.sh",
                "join.sh",
                "submit.sh"
            ]
        );
        insta::assert_snapshot!(text(&scripts));
    }
}
