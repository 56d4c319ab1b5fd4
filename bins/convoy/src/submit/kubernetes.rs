//! Kubernetes: a Job that plans, Indexed Jobs of tasks, a Job that counts, and a script that waits for each.

use std::path::PathBuf;

use super::config_map::ConfigMap;
use super::groups::{Group, Split, groups_of};
use super::storage::Storage;
use super::yaml;

/// A Job of more indexes that are tried again each alone is bound in other ways, too.
pub(super) const MOST_TASKS: u32 = 100_000;
/// A task that could not end is tried again so many times.
const MOST_RETRIES: u32 = 5;
/// Seconds between the word to stop and the end: a task stops at a frame.
const NOTICE_S: u32 = 120;
/// Where the configuration lies in a container.
const CONFIG_FOLDER: &str = "/etc/convoy";
/// Characters of a dataset's name in the names of its Jobs: what is added has room in the 63 of a host's
/// name.
const NAME_LEN: usize = 40;

/// Refuses a stage on other nodes than those with a GPU.
pub(super) fn check_splits(splits: &[Split]) -> Result<(), String> {
    match splits.iter().find(|split| split.place != "gpu" || !split.options.is_empty()) {
        Some(split) => Err(format!(
            "--split {0}: Kubernetes knows --split {0}=gpu alone, which asks for nvidia.com/gpu: 1",
            split.stage
        )),
        None => Ok(()),
    }
}

/// What the manifests are about.
#[derive(Clone, Debug)]
pub(super) struct Jobs {
    pub(super) name: String,
    pub(super) image: String,
    pub(super) namespace: Option<String>,
    pub(super) secret: Option<String>,
    pub(super) storage: Storage,
    pub(super) maps: Option<PathBuf>,
    pub(super) config: ConfigMap,
    pub(super) tasks: u32,
    pub(super) cores: u32,
    pub(super) memory_gib: u32,
    pub(super) splits: Vec<Split>,
    pub(super) at_once: Option<u32>,
}

/// What a Job is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Plan,
    Tasks,
    Stats,
}

/// One Job.
struct Job {
    kind: Kind,
    /// Of its file, and the end of its name.
    name: String,
    /// What it does, for people.
    about: String,
    args: Vec<String>,
    has_gpu: bool,
    cores: u32,
    memory_gib: u32,
}

impl Jobs {
    /// The files, by name.
    pub(super) fn files(&self) -> Vec<(String, String)> {
        let mut jobs = vec![self.plan()];
        let groups = groups_of(&self.splits);
        jobs.extend((1..).zip(&groups).map(|(number, group)| self.scenes(group, number, groups.len())));
        jobs.push(self.stats());
        let mut files = vec![("config.yaml".to_owned(), self.config_map())];
        files.extend(jobs.iter().map(|job| (format!("{}.yaml", job.name), self.manifest(job))));
        files.push(("submit.sh".to_owned(), self.submit(&jobs)));
        files
    }

    fn args(&self, stages: &str, more: &[&str]) -> Vec<String> {
        let store = self.storage.word();
        let words = ["run", "--stages", stages, "--store", &store].into_iter().chain(more.iter().copied());
        words.chain(["--progress", "plain"]).map(str::to_owned).collect()
    }

    fn plan(&self) -> Job {
        let config = format!("{CONFIG_FOLDER}/{}", self.config.main());
        let maps = self.maps.as_deref().map(|maps| maps.display().to_string());
        let mut more = vec!["--config", &config];
        more.extend(maps.iter().flat_map(|maps| ["--maps", maps]));
        Job {
            kind: Kind::Plan,
            name: "plan".to_owned(),
            about: "Makes the plan, or sees that it still stands.".to_owned(),
            args: self.args("plan", &more),
            has_gpu: false,
            cores: self.cores.min(2),
            memory_gib: self.memory_gib.min(4),
        }
    }

    /// The tasks of a group of stages, one of so many.
    fn scenes(&self, group: &Group, number: u32, groups: usize) -> Job {
        let (tasks, threads) = (self.tasks.to_string(), self.cores.to_string());
        // A task with a GPU does not quietly work on without it.
        let device: &[&str] = if group.split.is_some() { &["--device", "gpu"] } else { &[] };
        Job {
            kind: Kind::Tasks,
            name: if groups == 1 { "scenes".to_owned() } else { format!("scenes-{number}") },
            about: format!("Tasks, each a share of the scenes: {}.", group.stages.join(", ")),
            args: self
                .args(&group.words(), &[&["--shard", &*tasks, "--threads", &*threads][..], device].concat()),
            has_gpu: group.split.is_some(),
            cores: self.cores,
            memory_gib: self.memory_gib,
        }
    }

    fn stats(&self) -> Job {
        Job {
            kind: Kind::Stats,
            name: "stats".to_owned(),
            about: "Counts what is there, whatever happened.".to_owned(),
            args: self.args("stats", &[]),
            has_gpu: false,
            cores: self.cores.min(2),
            memory_gib: self.memory_gib.min(8),
        }
    }

    /// The dataset's name as objects may have it.
    fn object(&self) -> String {
        let small = self.name.to_ascii_lowercase();
        let plain: String =
            small.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).take(NAME_LEN).collect();
        match plain.trim_matches('-') {
            "" => "dataset".to_owned(),
            name => name.to_owned(),
        }
    }

    fn job_name(&self, job: &Job) -> String {
        format!("{}-{}", self.object(), job.name)
    }

    /// The head of an object, with the labels by which all of a dataset's are found.
    fn metadata(&self, name: &str) -> String {
        let namespace = self
            .namespace
            .as_deref()
            .map_or(String::new(), |namespace| format!("  namespace: {}\n", yaml::quoted(namespace)));
        format!("metadata:\n  name: {}\n{namespace}{}", yaml::quoted(name), self.labels(2))
    }

    fn labels(&self, indent: usize) -> String {
        let (space, name) = (" ".repeat(indent), yaml::quoted(&self.object()));
        format!(
            "{space}labels:\n{space}  app.kubernetes.io/name: convoy\n{space}  app.kubernetes.io/instance: {name}\n"
        )
    }

    fn config_map(&self) -> String {
        let name = format!("{}-config", self.object());
        format!("apiVersion: v1\nkind: ConfigMap\n{}data:\n{}", self.metadata(&name), self.config.data())
    }

    fn manifest(&self, job: &Job) -> String {
        let (tasks, at_once) = (self.tasks, self.at_once.map_or(self.tasks, |n| n.min(self.tasks)));
        let (retries, fail) = match job.kind {
            Kind::Tasks => (
                format!(
                    "  completionMode: Indexed\n  completions: {tasks}\n  parallelism: {at_once}\n  \
                     backoffLimitPerIndex: {MOST_RETRIES}\n"
                ),
                "FailIndex",
            ),
            Kind::Plan | Kind::Stats => (format!("  backoffLimit: {MOST_RETRIES}\n"), "FailJob"),
        };
        format!(
            r#"# {about}
apiVersion: batch/v1
kind: Job
{metadata}spec:
{retries}  podFailurePolicy:
    rules:
      # A node that was taken away is no try.
      - action: Ignore
        onPodConditions:
          - type: DisruptionTarget
            status: "True"
      # What fails by itself would fail again; all else (75: stopped, 137: out of memory) is tried again.
      - action: {fail}
        onExitCodes:
          operator: In
          values: [1, 2]
  template:
    metadata:
{labels}    spec:
      restartPolicy: Never
      terminationGracePeriodSeconds: {NOTICE_S}
      containers:
        - name: convoy
          image: {image}
          command: ["convoy"]
          args:
{args}{rest}"#,
            about = job.about,
            metadata = self.metadata(&self.job_name(job)),
            labels = self.labels(6),
            image = yaml::quoted(&self.image),
            args = lines(12, job.args.iter().map(|arg| format!("- {}", yaml::quoted(arg)))),
            rest = self.surroundings(job),
        )
    }

    /// What a container is given.
    fn surroundings(&self, job: &Job) -> String {
        let mut container: Vec<String> = Vec::new();
        if let Some(secret) = &self.secret {
            container.push("envFrom:".to_owned());
            container.push("  - secretRef:".to_owned());
            container.push(format!("      name: {}", yaml::quoted(secret)));
        }
        container.push("resources:".to_owned());
        container.push("  requests:".to_owned());
        container.push(format!("    cpu: \"{}\"", job.cores));
        container.push(format!("    memory: {}Gi", job.memory_gib));
        container.push("  limits:".to_owned());
        container.push(format!("    memory: {}Gi", job.memory_gib));
        if job.has_gpu {
            container.push("    nvidia.com/gpu: 1".to_owned());
        }
        let (mut mounts, mut volumes) = (Vec::new(), String::new());
        if job.kind == Kind::Plan {
            mounts.push("  - name: config".to_owned());
            mounts.push(format!("    mountPath: {CONFIG_FOLDER}"));
            mounts.push("    readOnly: true".to_owned());
            let name = yaml::quoted(&format!("{}-config", self.object()));
            let items = self.config.items(14);
            volumes += &format!(
                "        - name: config\n          configMap:\n            name: {name}\n            items:\n{items}"
            );
        }
        if let Storage::Claimed { claim, folder, .. } = &self.storage {
            mounts.push("  - name: store".to_owned());
            mounts.push(format!("    mountPath: {}", yaml::quoted(&folder.display().to_string())));
            let claim = yaml::quoted(claim);
            volumes += &format!(
                "        - name: store\n          persistentVolumeClaim:\n            claimName: {claim}\n"
            );
        }
        if !mounts.is_empty() {
            container.push("volumeMounts:".to_owned());
            container.extend(mounts);
            volumes.insert_str(0, "      volumes:\n");
        }
        lines(10, container) + &volumes
    }

    fn submit(&self, jobs: &[Job]) -> String {
        let namespace =
            self.namespace.as_deref().map_or(String::new(), |namespace| format!(" --namespace={namespace}"));
        let mut text = format!(
            r#"#!/bin/bash
# Applies the Jobs one after the other and waits for each. Started again, it ends what still runs, and makes
# what is missing.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
k() {{ kubectl{namespace} "$@"; }}

# Starts the Job of a file. A Job cannot be changed: that of an earlier start goes first.
start() {{
    k delete --ignore-not-found -f "$here/$1.yaml"
    k apply -f "$here/$1.yaml"
}}

# Waits until a Job has ended; whether it ended well.
ended_well() {{
    local left
    until k wait --for=condition=Complete "job/$1" --timeout=20s >/dev/null 2>&1; do
        k wait --for=condition=Failed "job/$1" --timeout=1s >/dev/null 2>&1 && return 1
        # No answer is no end: the network may be away for a while.
        if left=$(k get "job/$1" --ignore-not-found -o name) && [ -z "$left" ]; then
            echo "job/$1 is gone" >&2
            return 1
        fi
        sleep 2
    done
}}

k apply -f "$here/config.yaml"
code=0
"#
        );
        for job in jobs {
            let (file, name) = (&job.name, self.job_name(job));
            text += &format!("start {file}\n");
            text += &match job.kind {
                Kind::Plan => format!(
                    "if ! ended_well {name}; then\n    k logs job/{name} --tail=40 || true\n    \
                     echo \"there is no plan\" >&2\n    exit 1\nfi\n"
                ),
                Kind::Tasks => format!(
                    "if ! ended_well {name}; then\n    code=1\n    \
                     echo \"failed tasks: $(k get job/{name} -o 'jsonpath={{.status.failedIndexes}}')\" >&2\nfi\n"
                ),
                Kind::Stats => format!("ended_well {name} || code=1\nk logs job/{name} --tail=40 || true\n"),
            };
        }
        text += "exit $code\n";
        text
    }
}

/// Lines that are set in by so much.
fn lines(indent: usize, lines: impl IntoIterator<Item = String>) -> String {
    lines.into_iter().map(|line| format!("{}{line}\n", " ".repeat(indent))).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::storage::Claim;
    use super::*;

    fn jobs() -> Jobs {
        let folder = tempfile::tempdir().expect("a folder");
        let config = folder.path().join("rain town.toml");
        std::fs::write(&config, "name = \"rain in town\"\n\n[scenes.train]\n\"convoy/03\" = 256\n")
            .expect("is written");
        Jobs {
            name: "Rain in town".into(),
            image: "registry.lab/convoy:0.1.0".into(),
            namespace: None,
            secret: Some("rain-store".into()),
            storage: Storage::Url("s3://sets/rain".into()),
            maps: None,
            config: ConfigMap::read(&config).expect("is read"),
            tasks: 40,
            cores: 16,
            memory_gib: 18,
            splits: Vec::new(),
            at_once: None,
        }
    }

    fn text(files: &[(String, String)]) -> String {
        files.iter().map(|(name, text)| format!("==> {name}\n{text}")).collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn a_plan_an_indexed_job_and_statistics() {
        insta::assert_snapshot!(text(&jobs().files()));
    }

    #[test]
    fn a_stage_with_a_gpu_is_a_job_of_its_own_and_a_claim_is_mounted() {
        let claim: Claim = "sets:/data".parse().expect("is one");
        let splits: Vec<Split> = vec!["render-sensors=gpu".parse().expect("is a split")];
        check_splits(&splits).expect("is known");
        let jobs = Jobs {
            namespace: Some("lab".into()),
            secret: None,
            storage: Storage::of(Path::new("/data/rain"), Some(&claim)).expect("is held"),
            maps: Some("/data/maps".into()),
            splits,
            at_once: Some(8),
            ..jobs()
        };
        let files = jobs.files();
        let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(
            names,
            [
                "config.yaml",
                "plan.yaml",
                "scenes-1.yaml",
                "scenes-2.yaml",
                "scenes-3.yaml",
                "stats.yaml",
                "submit.sh"
            ]
        );
        insta::assert_snapshot!(text(&files));
    }

    #[test]
    fn names_are_those_of_objects() {
        let named = |name: &str| Jobs { name: name.into(), ..jobs() }.object();
        assert_eq!(named("Rain in: Town_2"), "rain-in--town-2");
        assert_eq!(named("éé"), "dataset");
        assert_eq!(named(&"a".repeat(90)).len(), NAME_LEN);
    }

    #[test]
    fn stages_go_to_gpus_alone() {
        let splits: Vec<Split> = vec!["render-sensors=gpu,--gres=gpu:1".parse().expect("is a split")];
        insta::assert_snapshot!(
            check_splits(&splits).expect_err("is refused"),
            @"--split render-sensors: Kubernetes knows --split render-sensors=gpu alone, which asks for nvidia.com/gpu: 1"
        );
    }
}
