//! Slurm: a job that plans, arrays of tasks, a job that joins whatever happened.

use std::path::{Path, PathBuf};

use runner::StageSpec;
use runner::scene_stages;

/// A task that could not end is tried again so many times.
const MOST_RESTARTS: u32 = 5;

/// A stage whose tasks go to another partition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Split {
    stage: &'static str,
    pub(super) partition: String,
    options: Vec<String>,
}

impl std::str::FromStr for Split {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (stage, rest) = text.split_once('=').ok_or("expected STAGE=PARTITION")?;
        let known = scene_stages().find(|known| known.name == stage).ok_or_else(|| {
            let names: Vec<&str> = scene_stages().map(|stage| stage.name).collect();
            format!("there is no stage of scenes `{stage}`; there are {}", names.join(", "))
        })?;
        let mut words = rest.split(',').map(str::to_owned);
        let partition = words.next().filter(|name| !name.is_empty()).ok_or("expected STAGE=PARTITION")?;
        Ok(Self { stage: known.name, partition, options: words.collect() })
    }
}

/// What the scripts are about.
#[derive(Clone, Debug)]
pub(super) struct Cluster {
    pub(super) name: String,
    pub(super) convoy: PathBuf,
    pub(super) config: PathBuf,
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

/// Stages that run in one array.
struct Group {
    stages: Vec<&'static str>,
    split: Option<Split>,
}

impl Cluster {
    /// The scripts, by name.
    pub(super) fn scripts(&self) -> Vec<(String, String)> {
        let groups = self.groups();
        let mut scripts = vec![("plan.sh".to_owned(), self.plan())];
        let named = groups.iter().map(|group| (format!("{}.sh", group.name()), self.array(group)));
        scripts.extend(named);
        scripts.push(("join.sh".to_owned(), self.join()));
        scripts.push(("submit.sh".to_owned(), self.submit(&groups)));
        scripts
    }

    /// The stages of scenes in the arrays in which they run, in their order: those that go elsewhere alone,
    /// all others as early as what they read allows.
    fn groups(&self) -> Vec<Group> {
        let split_of = |stage: &StageSpec| self.splits.iter().find(|split| split.stage == stage.name);
        let mut left: Vec<&'static StageSpec> = scene_stages().collect();
        let mut groups = Vec::new();
        while !left.is_empty() {
            let mut stages = Vec::new();
            let mut later = Vec::new();
            for stage in left {
                let waits =
                    |input: &StageSpec| later.iter().any(|later: &&StageSpec| later.name == input.name);
                if split_of(stage).is_some() || stage.inputs().any(waits) {
                    later.push(stage);
                } else {
                    stages.push(stage.name);
                }
            }
            if !stages.is_empty() {
                groups.push(Group { stages, split: None });
            }
            // The first of those that wait reads nothing of the others.
            left = later;
            if let Some(split) = left.first().copied().and_then(split_of) {
                groups.push(Group { stages: vec![split.stage], split: Some(split.clone()) });
                left.remove(0);
            }
        }
        groups
    }

    fn header(&self, kind: &str, lines: &[String], split: Option<&Split>) -> String {
        let partition = split.map(|split| &split.partition).or(self.partition.as_ref());
        let mut all = vec![format!("--job-name={}", word(&format!("{}-{kind}", self.name)))];
        all.extend(partition.map(|partition| format!("--partition={partition}")));
        all.extend(lines.iter().cloned());
        all.extend(self.options.iter().chain(split.iter().flat_map(|split| &split.options)).cloned());
        let lines: String = all.iter().map(|line| format!("#SBATCH {line}\n")).collect();
        format!("#!/bin/bash\n{lines}set -u\n")
    }

    fn log(&self, name: &str) -> String {
        format!("--output={}", quoted(&self.folder.join("logs").join(name)))
    }

    /// What a job needs that is no task.
    fn small(&self, memory_gib: u32, name: &str) -> [String; 4] {
        [
            format!("--cpus-per-task={}", self.cores.min(2)),
            format!("--mem={}G", self.memory_gib.min(memory_gib)),
            "--time=60".to_owned(),
            self.log(&format!("{name}.log")),
        ]
    }

    fn plan(&self) -> String {
        let lines = self.small(4, "plan");
        let maps = self.maps.as_deref().map_or(String::new(), |maps| format!(" --maps {}", quoted(maps)));
        format!(
            "{}# It was made when these scripts were: this looks whether it still stands.\n\
             exec {} run --stages plan --config {} --store {}{maps} --progress plain\n",
            self.header("plan", &lines, None),
            quoted(&self.convoy),
            quoted(&self.config),
            quoted(&self.store),
        )
    }

    fn array(&self, group: &Group) -> String {
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
            self.log(&format!("{}-%a.log", group.name())),
        ];
        format!(
            r#"{header}# A requeued task goes on where it was: what is finished is kept.
{convoy} run --stages {stages} --shard {tasks} --store {store} \
    --threads {cores} --progress plain &
task=$!
trap 'kill -TERM "$task" 2>/dev/null' TERM
while kill -0 "$task" 2>/dev/null; do wait "$task"; done
wait "$task"
code=$?
# Stopped, or out of memory: once more. What fails by itself (1, 2) would fail again.
if [ "$code" -eq 75 ] || [ "$code" -eq 137 ]; then
    if [ "${{SLURM_RESTART_COUNT:-0}}" -lt {MOST_RESTARTS} ]; then
        scontrol requeue "$SLURM_JOB_ID" && sleep 60
    fi
fi
exit "$code"
"#,
            header = self.header(&group.name(), &lines, group.split.as_ref()),
            convoy = quoted(&self.convoy),
            stages = group.words(),
            tasks = self.tasks,
            store = quoted(&self.store),
            cores = self.cores,
        )
    }

    fn join(&self) -> String {
        let lines = self.small(8, "join");
        let (convoy, store) = (quoted(&self.convoy), quoted(&self.store));
        format!(
            "{}# Whatever happened: manifests tell what is done.\n\
             {convoy} run --stages stats --store {store} --progress plain\n\
             exec {convoy} status --store {store}\n",
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

impl Group {
    fn is_all(&self) -> bool {
        self.stages.len() == scene_stages().count()
    }

    /// Of its script and of its logs.
    fn name(&self) -> String {
        if self.is_all() { "scenes".to_owned() } else { self.stages.join("-") }
    }

    /// As `--stages` takes it.
    fn words(&self) -> String {
        if self.is_all() { "scenes".to_owned() } else { self.stages.join(",") }
    }
}

/// A path as a word of a shell.
fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-+:,@%=".contains(c);
    if text.chars().all(is_plain) { text } else { format!("'{}'", text.replace('\'', r"'\''")) }
}

/// A name without what a job's name cannot have.
fn word(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '_' }).collect()
}

#[cfg(test)]
mod tests {
    use runner::Graph;

    use super::*;

    fn cluster() -> Cluster {
        Cluster {
            name: "rain in town".into(),
            convoy: "/opt/convoy/bin/convoy".into(),
            config: "/home/mira/rain town.toml".into(),
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

    #[test]
    fn splits_name_stages_of_scenes() {
        for wrong in ["render-sensors", "render-sensors=", "stats=gpu", "paint=gpu"] {
            assert!(wrong.parse::<Split>().is_err(), "{wrong}");
        }
        // A graph of two splits: the first is not waited for by what does not read it.
        let mut two = cluster();
        two.splits =
            ["occupancy-gt=big", "render-sensors=gpu"].map(|split| split.parse().expect("is one")).to_vec();
        let groups: Vec<Vec<&str>> = two.groups().into_iter().map(|group| group.stages).collect();
        assert_eq!(
            groups,
            [
                vec!["simulate-and-log", "bev-gt"],
                vec!["render-sensors"],
                vec!["occupancy-gt"],
                vec!["postprocess-valid", "merge-tracks"]
            ]
        );
        assert!(
            Graph::get().stages.len() > groups.concat().len(),
            "plan and statistics are jobs of their own"
        );
    }

    #[test]
    fn paths_are_words_of_a_shell() {
        assert_eq!(quoted(Path::new("/a b/it's")), r"'/a b/it'\''s'");
        assert_eq!(quoted(Path::new("/a-b/c.d")), "/a-b/c.d");
        assert_eq!(word("rain in: town"), "rain_in__town");
    }
}
