//! What is compared by a build's programs while code is being changed: real programs whose files say by
//! which commit they were built, and one of which was edited.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use convoy_tests::{Bench, LEAN, Outcome, program};

const STAMP: &[u8] = b"\0convoy-build-stamp\0";
const STAGES: [&str; 3] = ["spawn-planner", "simulate-and-log", "bev-gt"];

/// Copies of programs in a folder of their own.
struct Build {
    folder: PathBuf,
}

impl Build {
    /// Copies that say they are of a commit, or of one with uncommitted changes.
    fn new(folder: &Path, is_committed: bool) -> Self {
        fs::create_dir(folder).expect("is made");
        for name in STAGES.iter().chain(&["convoy"]) {
            let mut file = fs::read(program(name)).expect("is built");
            stamp(&mut file, is_committed);
            let path = folder.join(name);
            fs::copy(program(name), &path).expect("has its permissions");
            fs::write(&path, file).expect("is written");
        }
        Self { folder: folder.to_owned() }
    }

    /// Changes a program without changing what it does.
    fn edit(&self, name: &str) {
        let path = self.folder.join(name);
        let mut file = fs::read(&path).expect("is there");
        file.extend_from_slice(b"edited");
        fs::write(&path, file).expect("is written");
    }

    fn run(&self, bench: &Bench, name: &str, args: &[&str]) -> Outcome {
        let command = bench.command(name, args);
        let output = Command::new(self.folder.join(name)).args(command.get_args()).output();
        Outcome::of(&output.expect("starts"))
    }

    /// The states of the scene's stages by `convoy status --why`.
    fn states(&self, bench: &Bench) -> [String; 3] {
        STAGES.map(|stage| {
            let why = self.run(bench, "convoy", &["status", "--why", "0", stage]);
            let of_stage = |line: &&str| line.starts_with(&format!("{stage}: "));
            why.stdout.lines().map(str::trim).find(of_stage).unwrap_or_default().to_owned()
        })
    }
}

/// Writes into a program that it was built from just a commit, or not.
fn stamp(file: &mut [u8], is_committed: bool) {
    let starts = file.windows(STAMP.len()).enumerate().filter(|(_, bytes)| *bytes == STAMP);
    let starts: Vec<usize> = starts.map(|(at, _)| at + STAMP.len()).collect();
    let mut stamped = 0;
    for at in starts {
        let Some(bytes) = file.get_mut(at..at + 65) else { continue };
        // Programs have the name alone, too.
        if matches!(bytes[64], b'+' | b'-') {
            bytes[..64].fill(b'a');
            bytes[64] = if is_committed { b'+' } else { b'-' };
            stamped += 1;
        }
    }
    assert!(stamped > 0, "the program has no stamp");
}

#[test]
fn an_edited_program_makes_its_stage_again_until_it_is_committed() {
    let bench = Bench::new(LEAN);
    let committed = Build::new(&bench.folder.path().join("committed"), true);
    for stage in STAGES {
        committed.run(&bench, stage, &[]).expect_done();
    }
    let done = STAGES.map(|stage| format!("{stage}: done"));
    assert_eq!(committed.states(&bench), done);

    // A commit is trusted to its versions, whatever its programs are.
    committed.edit("bev-gt");
    assert_eq!(committed.states(&bench), done);

    // With uncommitted changes the program counts as well: that of the stage alone.
    let edited = Build::new(&bench.folder.path().join("edited"), false);
    assert_eq!(edited.states(&bench), done, "the programs are those that made it");
    edited.edit("bev-gt");
    let [plan, log, masks] = edited.states(&bench);
    assert_eq!([&plan, &log], [&done[0], &done[1]]);
    assert_eq!(masks, "bev-gt: stale: the program changed (a build with uncommitted changes)");
    let made = edited.run(&bench, "bev-gt", &[]);
    assert!(made.code == 0 && made.stderr.contains("1 done, 0 kept"), "{made:?}");
    assert_eq!(edited.states(&bench), done);
    // A commit trusts it as far as its own program is the same.
    assert_eq!(committed.states(&bench), done);
    committed.edit("bev-gt");
    assert_eq!(committed.states(&bench)[2], masks);
}
