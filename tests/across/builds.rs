//! What is compared by a build's programs while code is being changed: real programs whose files say by
//! which commit they were built, and one of which was edited.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use convoy_tests::{Bench, LEAN, Outcome, program};
use runner::Graph;

use super::slips::words;

const STAMP: &[u8] = b"\0convoy-build-stamp\0";
const STAGES: [&str; 3] = ["spawn-planner", "simulate-and-log", "bev-gt"];

/// Copies of programs in a folder of their own.
struct Build {
    folder: PathBuf,
}

impl Build {
    /// Copies that say they are of a commit, or of one with uncommitted changes.
    fn new(folder: &Path, is_committed: bool, stages: &[&str]) -> Self {
        fs::create_dir(folder).expect("is made");
        for name in stages.iter().chain(&["convoy"]) {
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
    let committed = Build::new(&bench.folder.path().join("committed"), true, &STAGES);
    for stage in STAGES {
        committed.run(&bench, stage, &[]).expect_done();
    }
    let done = STAGES.map(|stage| format!("{stage}: done"));
    assert_eq!(committed.states(&bench), done);

    // A commit is trusted to its versions, whatever its programs are.
    committed.edit("bev-gt");
    assert_eq!(committed.states(&bench), done);

    // With uncommitted changes the program counts as well: that of the stage alone.
    let edited = Build::new(&bench.folder.path().join("edited"), false, &STAGES);
    assert_eq!(edited.states(&bench), done, "the programs are those that made it");
    edited.edit("bev-gt");
    let [plan, log, masks] = edited.states(&bench);
    assert_eq!([&plan, &log], [&done[0], &done[1]]);
    assert_eq!(masks, "bev-gt: stale: the program changed (a build with uncommitted changes)");
    let why = edited.run(&bench, "convoy", &["status", "--why", "0", "bev-gt"]);
    let digests = |line: &str| {
        let (then, now) = line.trim().strip_prefix("program: ")?.split_once(" -> ")?;
        let now = now.strip_suffix(" (one of them has uncommitted changes)")?;
        let is_digest = |text: &str| text.len() == 8 && text.chars().all(|c| c.is_ascii_hexdigit());
        (is_digest(then) && is_digest(now)).then_some((then.to_owned(), now.to_owned()))
    };
    let (then, now) = why.stdout.lines().find_map(digests).expect("both programs are named");
    assert_ne!(then, now);
    let made = edited.run(&bench, "bev-gt", &[]);
    assert!(made.code == 0 && made.stderr.contains("1 done, 0 kept"), "{made:?}");
    assert_eq!(edited.states(&bench), done);
    // A commit trusts it as far as its own program is the same.
    assert_eq!(committed.states(&bench), done);
    committed.edit("bev-gt");
    assert_eq!(committed.states(&bench)[2], masks);
}

#[test]
fn what_an_edited_program_would_make_again_is_asked_about() {
    let bench = Bench::new(&format!("{LEAN}\n[store]\nask_beyond_s = 0\n"));
    let stages: Vec<&str> = Graph::get().stages.iter().map(|stage| stage.name).collect();
    let build = Build::new(&bench.folder.path().join("edited"), false, &stages);
    let run = |args: &[&str]| build.run(&bench, "convoy", &[&["run", "--progress", "none"], args].concat());
    run(&[]).expect_done();
    build.edit("bev-gt");
    let made = bench.digests();
    let again = "bev-gt: scene 0 (the program changed (a build with uncommitted changes))";
    for refused in [build.run(&bench, "bev-gt", &[]), run(&[])] {
        assert_eq!(refused.code, 2, "{refused:?}");
        for words in [again, "--redo makes it again", "--accept-code keeps what older code made"] {
            assert!(refused.stderr.contains(words), "{words}: {}", refused.stderr);
        }
        assert!(bench.digests() == made, "the store was touched");
    }
    insta::assert_snapshot!("run-of-an-edited-program", words(&bench, &run(&[])));
    // Both ways: of the stage alone,
    let accepted = build.run(&bench, "bev-gt", &["--accept-code"]);
    assert!(accepted.code == 0 && accepted.stderr.contains("0 done, 1 kept"), "{accepted:?}");
    build.edit("bev-gt");
    let redone = build.run(&bench, "bev-gt", &["--redo"]);
    assert!(redone.code == 0 && redone.stderr.contains("1 done, 0 kept"), "{redone:?}");
    // and of all.
    build.edit("bev-gt");
    let accepted = run(&["--accept-code"]);
    accepted.expect_done();
    assert!(!accepted.stderr.contains("makes again"), "{accepted:?}");
    build.edit("bev-gt");
    let redone = run(&["--redo"]);
    redone.expect_done();
    assert!(redone.stderr.contains(&format!("makes again {again}")), "{redone:?}");
    let last = run(&[]);
    last.expect_done();
    assert!(!last.stderr.contains("makes again"), "{last:?}");
    let shards = |digests: BTreeMap<String, String>| -> BTreeMap<String, String> {
        digests.into_iter().filter(|(name, _)| !name.ends_with("json")).collect()
    };
    assert!(shards(bench.digests()) == shards(made), "nothing that it makes was changed");
}
