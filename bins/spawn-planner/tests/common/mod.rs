//! A store and the real program.
#![allow(dead_code)] // Each test binary uses its part.

use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

use schema::tables::{PlanAgentRow, PlanSceneRow};
use store::{Manifest, Scope, Store, keys};

pub(crate) struct Bench {
    pub(crate) folder: tempfile::TempDir,
}

/// What the program said and how it ended.
#[derive(Debug)]
pub(crate) struct Outcome {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Bench {
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder") }
    }

    /// Runs the planner with a configuration in a file of some name.
    pub(crate) fn run(&self, file: &str, config: &str, args: &[&str]) -> Outcome {
        let path = self.folder.path().join(file);
        fs::write(&path, config).expect("the configuration is written");
        let mut command = Command::new(env!("CARGO_BIN_EXE_spawn-planner"));
        command.arg("--config").arg(&path).arg("--store").arg(self.folder.path().join("store"));
        let output = command.args(["--progress", "none"]).args(args).output().expect("the program starts");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        Outcome {
            code: output.status.code().unwrap_or(-1),
            out: text(&output.stdout),
            err: text(&output.stderr),
        }
    }

    /// Plans, expecting success; gives what the program said.
    pub(crate) fn plan(&self, config: &str) -> String {
        let outcome = self.run("config.toml", config, &[]);
        assert_eq!(outcome.code, 0, "{outcome:?}");
        outcome.err
    }

    pub(crate) fn store(&self) -> Store {
        Store::open(self.folder.path().join("store")).expect("is a folder")
    }

    pub(crate) fn manifest(&self) -> Manifest {
        self.store().manifest(Scope::Plan, "spawn-planner").expect("is readable").expect("is there")
    }

    /// What later stages remember of each scene's plan.
    pub(crate) fn digests(&self) -> BTreeMap<String, String> {
        self.manifest().sections
    }

    pub(crate) fn scenes(&self) -> Vec<PlanSceneRow> {
        self.store().read_rows(&self.manifest(), keys::PLAN_SCENES).expect("is readable")
    }

    pub(crate) fn agents(&self) -> Vec<PlanAgentRow> {
        self.store().read_rows(&self.manifest(), keys::PLAN_AGENTS).expect("is readable")
    }

    /// Something that a later stage made of a scene.
    pub(crate) fn pretend_made(&self, scene: u32) {
        let path = self.folder.path().join(format!("store/scenes/{scene:04}/log/scene.json"));
        fs::create_dir_all(path.parent().expect("has a folder")).expect("makes folders");
        fs::write(path, "{}").expect("writes");
    }
}
