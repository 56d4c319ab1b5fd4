//! Helpers for tests across stages: where the programs are, how to run them, what a store holds.

pub mod measured;

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::{env, fs};

/// Folder of the workspace.
#[must_use]
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A program of the workspace, built by `cargo build --workspace --bins` in the profile of this test.
///
/// # Panics
/// It was not built.
#[must_use]
pub fn program(name: &str) -> PathBuf {
    // A test runs as target/PROFILE/deps/NAME-HASH.
    let mut folder = env::current_exe().expect("a running test has a path");
    folder.pop();
    if folder.ends_with("deps") {
        folder.pop();
    }
    let path = folder.join(name);
    assert!(path.is_file(), "{} is missing: run `cargo build --workspace --bins` first", path.display());
    path
}

/// A dataset to be made in a temporary folder.
pub struct Bench {
    /// The folder.
    pub folder: tempfile::TempDir,
}

/// The smallest dataset, with the sensors that agents usually carry: one second, one vehicle, one RSU.
pub const SMALL: &str = include_str!("../configurations/small.toml");

/// [`SMALL`] by day, with every sensor at the size of a thumbnail. The sun stands still: shadow maps of a sun
/// that moves take a third of the time.
pub const TINY: &str =
    concat!(include_str!("../configurations/small.toml"), "\n", include_str!("../configurations/tiny.toml"));

/// [`SMALL`] with small lidars and no cameras or voxels: the quickest dataset that goes through all stages.
pub const LEAN: &str =
    concat!(include_str!("../configurations/small.toml"), "\n", include_str!("../configurations/lean.toml"));

/// Runs a script of `tests` in Python with some arguments, and expects that it finds nothing wrong. With exit
/// code 77 it says that it could not look at everything: a note.
///
/// # Panics
/// It finds something wrong, or there is no Python with these packages and `CONVOY_REQUIRE` names it.
#[track_caller]
pub fn check_in_python(script: &str, packages: &[&str], args: &[&Path]) {
    if let Some(python) = testkit::python(packages) {
        check_by(&python, script, args);
    }
}

/// The same, by an interpreter that has nuscenes-devkit.
///
/// # Panics
/// It finds something wrong, or there is no such interpreter and `CONVOY_REQUIRE` names `devkit`.
#[track_caller]
pub fn check_in_devkit(script: &str, args: &[&Path]) {
    if let Some(python) = testkit::devkit() {
        check_by(&python, script, args);
    }
}

#[track_caller]
fn check_by(python: &str, script: &str, args: &[&Path]) {
    let output = Command::new(python).arg(workspace().join("tests").join(script)).args(args).output();
    let outcome = Outcome::of(&output.expect("Python starts"));
    if outcome.code == 77 {
        // Past the harness, which keeps the output of tests that pass to itself.
        let _ = writeln!(std::io::stderr(), "{}", outcome.stdout.lines().last().unwrap_or_default());
    } else {
        outcome.expect_done();
    }
}

impl Bench {
    /// A folder with a configuration.
    ///
    /// # Panics
    /// The folder cannot be made.
    #[must_use]
    pub fn new(config: &str) -> Self {
        let bench = Self { folder: tempfile::tempdir().expect("a temporary folder") };
        bench.configure(config);
        bench
    }

    /// Replaces the configuration.
    ///
    /// # Panics
    /// It cannot be written.
    pub fn configure(&self, config: &str) {
        fs::write(self.config(), config).expect("the configuration is written");
    }

    /// The configuration's path.
    #[must_use]
    pub fn config(&self) -> PathBuf {
        self.folder.path().join("config.toml")
    }

    /// The store's path.
    #[must_use]
    pub fn store(&self) -> PathBuf {
        self.folder.path().join("store")
    }

    /// A program on this dataset, with further arguments.
    #[must_use]
    pub fn command(&self, name: &str, args: &[&str]) -> Command {
        let mut command = Command::new(program(name));
        if name == "convoy" {
            command.args(&args[..1]).arg("--store").arg(self.store());
            if !["verify", "tidy", "merge"].contains(&args[0]) {
                command.arg("--config").arg(self.config());
            }
            command.args(&args[1..]);
        } else {
            command.arg("--config").arg(self.config()).arg("--store").arg(self.store()).args(args);
            command.args(["--progress", "none"]);
        }
        command
    }

    /// Runs a program to its end.
    ///
    /// # Panics
    /// It cannot be started.
    #[must_use]
    pub fn run(&self, name: &str, args: &[&str]) -> Outcome {
        Outcome::of(&self.command(name, args).output().expect("the program starts"))
    }

    /// Starts a program and leaves it running.
    ///
    /// # Panics
    /// It cannot be started.
    #[must_use]
    pub fn start(&self, name: &str, args: &[&str]) -> Child {
        let mut command = self.command(name, args);
        command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program starts")
    }

    /// Every file of the store with the digest of its bytes.
    #[must_use]
    pub fn digests(&self) -> BTreeMap<String, String> {
        digests(&self.store())
    }
}

/// What a program said and how it ended.
#[derive(Debug)]
pub struct Outcome {
    /// Exit code; -1 when a signal ended it.
    pub code: i32,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl Outcome {
    /// Of a program that has ended.
    #[must_use]
    pub fn of(output: &Output) -> Self {
        Self {
            code: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    /// Expects exit code 0.
    ///
    /// # Panics
    /// It was another one.
    pub fn expect_done(&self) {
        assert_eq!(self.code, 0, "stdout:\n{}\nstderr:\n{}", self.stdout, self.stderr);
    }
}

/// Every file below a folder with the digest of its bytes.
///
/// # Panics
/// A file cannot be read.
#[must_use]
pub fn digests(folder: &Path) -> BTreeMap<String, String> {
    let files = walkdir::WalkDir::new(folder).into_iter().filter_map(Result::ok);
    files
        .filter(|e| e.file_type().is_file())
        .map(|e| {
            let name = e.path().strip_prefix(folder).expect("is below").to_string_lossy().into_owned();
            (name, store::hash_bytes(&fs::read(e.path()).expect("the file is read")))
        })
        .collect()
}
