//! What one bad scene, a panic or a full store does to a run.

use std::io::Write;
use std::sync::{Arc, LazyLock};

use schema::scene_info::LOG_STAGE;
use settings::DatasetSettings;
use settings::stages::MaskSettings;
use store::{Backend, Manifest, Memory};

use super::*;

mod counted;

use crate::state::plan_section;
use crate::views::example_settings;

/// A store in which three scenes are planned and simulated.
fn simulated(store: &Store, settings: &DatasetSettings) {
    finished(store, settings, "spawn-planner", Scope::Plan);
    (0..3).for_each(|scene| finished(store, settings, "simulate-and-log", Scope::Scene(scene)));
}

/// Finishes a stage that writes nothing.
fn finished(store: &Store, settings: &DatasetSettings, name: &str, scope: Scope) {
    let spec = Graph::get().stage(name).expect("is a stage");
    let programs = Programs::given(Some("c"), &[]);
    let editions = Editions::only(settings);
    let status = Status::new(store, &editions, &programs);
    let ready = status.survey(scope).inputs(spec).expect("reads").expect("is ready");
    let identity = Identity {
        stage: name.into(),
        scope,
        code_version: crate::code_version(name).into(),
        config_hash: config_hash(spec, &editions, scope).expect("is a view"),
        inputs: ready.digests,
        made_by: None,
    };
    let mut attempt = Attempt::start(store, identity, false).expect("starts");
    if scope == Scope::Plan {
        (0..3).for_each(|scene| attempt.section(&plan_section(scene), format!("plan of {scene}")));
    }
    attempt.commit().expect("commits");
}

fn run_of<'a>(
    settings: &'a DatasetSettings,
    store: &Store,
    run: fn(&mut Job<'_, MaskSettings>) -> Result<(), StageError>,
) -> Run<'a, MaskSettings> {
    Run {
        stage: Stage::new(run),
        spec: Graph::get().stage("bev-gt").expect("is a stage"),
        of_dataset: MaskSettings::of(settings),
        editions: Editions::only(settings),
        programs: &COMMITTED,
        store: store.clone(),
        maps: None,
        device: DeviceOptions::default(),
        device_in_use: None,
        redo: false,
        redo_older: false,
        in_run: Vec::new(),
        force: false,
        accept_code: false,
        progress: ProgressMode::None,
        shard: None,
        known: Arc::default(),
        prepared: Prepared::default(),
    }
}

/// Runs some scenes.
fn some(run: &Run<'_, MaskSettings>, scopes: &[Scope]) -> Result<u8, StageError> {
    run.all(&run.look(scopes)?.0)
}

/// Runs all scenes that there are.
fn all(run: &Run<'_, MaskSettings>) -> Result<u8, StageError> {
    some(run, &SCENES)
}

/// The programs of a commit.
static COMMITTED: LazyLock<Programs> = LazyLock::new(|| Programs::given(Some("c"), &[("bev-gt", "p")]));

const SCENES: [Scope; 3] = [Scope::Scene(0), Scope::Scene(1), Scope::Scene(2)];

fn states(run: &Run<'_, MaskSettings>) -> [State; 3] {
    SCENES.map(|scope| run.state(scope, &BTreeMap::new()).expect("is known"))
}

/// Why masks of a scene are what they are, with versions of now written as N.
fn chain(run: &Run<'_, MaskSettings>, scope: Scope) -> String {
    let lines =
        crate::why::why(&run.store, Some(&run.editions), run.programs, (run.spec, scope)).expect("is known");
    let mut stage = "";
    let mut told = String::new();
    for line in &lines {
        if let Some(spec) =
            Graph::get().stages.iter().find(|s| line.trim().starts_with(&format!("{}: ", s.name)))
        {
            stage = spec.name;
        }
        let version = crate::code_version(stage);
        let line = line.replace(&format!("by version {version}:"), "by version N:");
        told += &(line.replace(&format!("-> {version}"), "-> N") + "\n");
    }
    told
}

fn write(job: &mut Job<'_, MaskSettings>, bytes: usize) -> Result<(), StageError> {
    let key = store::keys::scene(job.scene(), "bev/vehicle_0.npz");
    if let Some(mut unit) = job.unit("vehicle_0")? {
        unit.bytes(&key, &vec![7; bytes], 1)?;
        unit.finish()?;
    }
    Ok(())
}

#[test]
fn a_panic_is_the_fault_of_its_scene_alone() {
    let settings = example_settings();
    let store = Store::open("memory:").expect("is a place");
    simulated(&store, &settings);
    let bad = run_of(&settings, &store, |job| {
        write(job, 10)?;
        let numbers: Vec<u32> = (0..job.scene()).collect();
        // Scene 1 has one number.
        assert!(numbers.len() != 1 || numbers.get(1).is_some(), "number {} of {}", 1, numbers.len());
        Ok(())
    });
    assert_eq!(all(&bad).expect("goes on"), EXIT_SOME_FAILED);
    let [first, second, third] = states(&bad);
    assert_eq!([first, third], [State::Done, State::Done]);
    let reason = "a bug in Convoy: number 1 of 1 (please report it)".to_owned();
    assert_eq!(second, State::Failed(reason));

    let corrected = run_of(&settings, &store, |job| write(job, 10));
    assert_eq!(all(&corrected).expect("runs"), EXIT_DONE);
    assert_eq!(states(&corrected), [State::Done, State::Done, State::Done]);
    assert!(store.read(&SCENES[1].failure("bev-gt")).expect("asks").is_none(), "is forgotten");
}

#[test]
fn a_full_store_stops_the_stage_and_blames_no_scene() {
    let settings = example_settings();
    let whole = Memory::default();
    simulated(&Store::new(Arc::new(whole.clone())), &settings);
    // The same store with room for one scene's file and its records.
    let used: u64 = whole.keys("").expect("lists").iter().filter_map(|key| whole.size(key).ok()?).sum();
    let small = Memory::with_capacity(usize::try_from(used).expect("is small") + 6000);
    for key in whole.keys("").expect("lists") {
        let mut sink = small.create(&key, "copy").expect("creates");
        sink.write_all(&whole.read(&key).expect("reads").expect("is there")).expect("writes");
        sink.commit().expect("commits");
    }
    let store = Store::new(Arc::new(small));
    let run = run_of(&settings, &store, |job| write(job, 3000));
    let error = all(&run).expect_err("is full");
    assert_eq!(error.exit_code(), crate::EXIT_TRY_AGAIN);
    assert!(error.report().contains("scenes/0001/bev/vehicle_0.npz: cannot write"), "{}", error.report());
    assert_eq!(states(&run), [State::Done, State::Missing, State::Missing]);
}

#[test]
fn what_is_not_ready_is_no_failure() {
    let settings = example_settings();
    let store = Store::open("memory:").expect("is a place");
    simulated(&store, &settings);
    store.backend().remove(&SCENES[1].manifest("simulate-and-log")).expect("removes");
    let run = run_of(&settings, &store, |job| write(job, 10));
    let error = run.one(SCENES[1], Pace::of(1)).expect_err("has no log");
    assert_eq!(error.report(), "simulate-and-log is missing: run that first");
    assert_eq!(all(&run).expect("goes on"), EXIT_SOME_FAILED);
    assert_eq!(states(&run), [State::Done, State::Missing, State::Done]);
    // A log that failed is told once, with its own reason.
    let failure = Failure { code_version: "x".into(), reason: "no driving lanes".into() };
    store.write_json(&SCENES[1].failure("simulate-and-log"), "simulate-and-log", &failure).expect("writes");
    let error = run.one(SCENES[1], Pace::of(1)).expect_err("has no log");
    assert_eq!(error.report(), "simulate-and-log failed (no driving lanes): run that first");
}

#[test]
fn a_store_of_another_format_is_left_alone() {
    let settings = example_settings();
    let store = Store::open("memory:").expect("is a place");
    simulated(&store, &settings);
    let key = SCENES[1].manifest("simulate-and-log");
    let mut manifest = store.manifest(SCENES[1], "simulate-and-log").expect("reads").expect("is there");
    manifest.format_version += 1;
    store.write_json(&key, "test", &manifest).expect("writes");
    let run = run_of(&settings, &store, |job| write(job, 10));
    assert_eq!(all(&run).expect_err("is of another format").exit_code(), EXIT_USAGE);
    assert!(store.read(&SCENES[1].failure("bev-gt")).expect("asks").is_none());
}

#[test]
fn what_older_code_made_is_kept_when_told_so() {
    let settings = example_settings();
    let store = Store::open("memory:").expect("is a place");
    simulated(&store, &settings);
    let run = run_of(&settings, &store, |job| write(job, 10));
    assert_eq!(all(&run).expect("runs"), EXIT_DONE);
    let of = |scope: Scope| store.manifest(scope, "bev-gt").expect("reads").expect("is there");
    for scope in &SCENES[1..] {
        let older = Manifest { code_version: "0.0.9+older".into(), ..of(*scope) };
        store.write_json(&scope.manifest("bev-gt"), "test", &older).expect("writes");
    }
    let stale = State::Stale(Staleness::Code);
    assert_eq!(states(&run), [State::Done, stale.clone(), stale.clone()]);
    insta::assert_snapshot!(chain(&run, SCENES[1]), @"
    bev-gt: stale: the code changed
      made by version 0.0.9+older: 1 file, 10 B
      version: 0.0.9+older -> N
      simulate-and-log: done
        made by version N: 0 files, 0 B
        spawn-planner: done
          made by version N: 0 files, 0 B
    ");

    let digest = of(SCENES[1]).digest();
    let accepting = Run { accept_code: true, ..run_of(&settings, &store, |_| panic!("is not run")) };
    assert_eq!(some(&accepting, &SCENES[..2]).expect("keeps"), EXIT_DONE);
    assert_eq!(states(&run), [State::Done, State::Done, stale], "recorded, for who does not ask again");
    let kept = of(SCENES[1]);
    assert_eq!((kept.code_version.as_str(), kept.accepted_by.len()), ("0.0.9+older", 1));
    assert_eq!(kept.digest(), digest, "what was made from it holds");
    assert!(of(SCENES[0]).accepted_by.is_empty(), "it is of this code");

    // Where something else changed, too, it is made anew.
    let mut finer = settings.clone();
    finer.bev.cell_m *= 0.5;
    let again = Run { accept_code: true, ..run_of(&finer, &store, |job| write(job, 20)) };
    assert_eq!(some(&again, &SCENES[2..]).expect("runs"), EXIT_DONE);
    let made = of(SCENES[2]);
    assert_eq!((made.outputs[0].bytes, made.accepted_by.len()), (20, 0));
    assert_eq!(made.code_version, crate::code_version("bev-gt"));
}

#[test]
fn an_edited_program_makes_its_stage_again_and_leaves_others() {
    let settings = example_settings();
    let store = Store::open("memory:").expect("is a place");
    simulated(&store, &settings);
    let of_build = |programs: &'static Programs, run: fn(&mut Job<'_, MaskSettings>) -> _| Run {
        programs,
        ..run_of(&settings, &store, run)
    };
    let programs = |commit, program| -> &'static Programs {
        Box::leak(Box::new(Programs::given(commit, &[("bev-gt", program)])))
    };
    let committed = of_build(programs(Some("c"), "p"), |job| write(job, 10));
    assert_eq!(all(&committed).expect("runs"), EXIT_DONE);
    let made_by =
        store.manifest(SCENES[0], "bev-gt").expect("reads").and_then(|m| m.made_by).expect("is said");
    assert_eq!((made_by.commit.as_deref(), made_by.program.as_str()), (Some("c"), "p"));

    let done = [State::Done, State::Done, State::Done];
    let stale = State::Stale(Staleness::Program);
    let all_stale = [stale.clone(), stale.clone(), stale.clone()];
    assert_eq!(states(&of_build(programs(Some("d"), "q"), |_| Ok(()))), done, "of another commit");
    assert_eq!(states(&of_build(programs(None, "p"), |_| Ok(()))), done, "other files were edited");
    let edited = of_build(programs(None, "q"), |job| write(job, 20));
    assert_eq!(states(&edited), all_stale);
    insta::assert_snapshot!(chain(&edited, SCENES[1]), @"
    bev-gt: stale: the program changed (a build with uncommitted changes)
      made by version N: 1 file, 10 B
      program: p -> q (one of them has uncommitted changes)
      simulate-and-log: done
        made by version N: 0 files, 0 B
        spawn-planner: done
          made by version N: 0 files, 0 B
    ");
    let editions = Editions::only(&settings);
    let status = Status::new(&store, &editions, edited.programs);
    let log = Graph::get().stage(LOG_STAGE).expect("is a stage");
    assert_eq!(status.state(log, SCENES[0]).expect("is known"), State::Done, "has no edited program");

    // What the edited program makes is not trusted by the next build, unless told so.
    assert_eq!(some(&edited, &SCENES[..2]).expect("runs"), EXIT_DONE);
    let later = programs(Some("e"), "r");
    assert_eq!(states(&of_build(later, |_| Ok(()))), [stale.clone(), stale, State::Done]);
    let accepting = Run { accept_code: true, ..of_build(later, |_| panic!("is not run")) };
    assert_eq!(all(&accepting).expect("keeps"), EXIT_DONE);
    assert_eq!(states(&of_build(later, |_| Ok(()))), done);
    assert_eq!(states(&edited), [State::Done, State::Done, State::Stale(Staleness::Program)]);
}

/// Marks what a stage has done as imported.
fn mark_imported(store: &Store, scope: Scope, stage: &str) {
    let read = store.manifest(scope, stage).expect("reads").expect("stands");
    let marked = Manifest {
        code_version: schema::IMPORTED.into(),
        config_hash: "of a dataset".into(),
        inputs: BTreeMap::new(),
        ..read.clone()
    };
    store.replace_manifest(scope, &read, &marked).expect("replaces");
}

#[test]
fn what_was_imported_is_never_stale_and_never_made_again() {
    let store = Store::open("memory:").expect("opens");
    let settings = DatasetSettings::with_scenes(Vec::new());
    simulated(&store, &settings);
    let run = run_of(&settings, &store, |job| write(job, 10));
    assert_eq!(some(&run, &SCENES[..1]).expect("runs"), EXIT_DONE);
    let planner = Graph::get().planner().name;
    for (scope, stage) in
        [(Scope::Plan, planner), (SCENES[0], LOG_STAGE), (SCENES[0], "bev-gt"), (SCENES[1], LOG_STAGE)]
    {
        mark_imported(&store, scope, stage);
    }
    // The plan is another one: what was made of scene 2 before is still right, and what was imported stays.
    assert_eq!(states(&run), [State::Done, State::Missing, State::Missing]);
    let other = DatasetSettings { seed: 99, ..settings.clone() };
    assert_eq!(
        run_of(&other, &store, |job| write(job, 10)).state(SCENES[0], &BTreeMap::new()).expect("is known"),
        State::Done
    );
    let sources = BTreeMap::from([("source/a.xodr".to_owned(), "changed".to_owned())]);
    assert_eq!(run.state(SCENES[0], &sources).expect("is known"), State::Done);

    run.look(&SCENES[..1]).expect("it is done");
    run.look(&SCENES[2..]).expect("it has a log");
    let refused = run.look(&SCENES).expect_err("scene 1 has none");
    assert_eq!(refused.exit_code(), EXIT_USAGE);
    assert_eq!(refused.report(), "scene 1: imported, without a log that bev-gt could be made from");
    let forced = Run { force: true, ..run_of(&settings, &store, |job| write(job, 10)) };
    let refused = forced.look(&SCENES[..2]).expect_err("neither can be made again");
    assert_eq!(refused.report(), "scene 0, scene 1: imported, without a log that bev-gt could be made from");

    // Without its file it is stale, and cannot be made again either.
    store.backend().remove("scenes/0000/bev/vehicle_0.npz").expect("removes");
    assert_eq!(states(&run)[0], State::Stale(Staleness::Output));
    assert!(run.look(&SCENES[..1]).is_err());
}

#[test]
fn stages_that_look_at_labels_alone_are_told_apart() {
    let without: Vec<&str> = Graph::get().stages.iter().filter(|s| !s.needs_log).map(|s| s.name).collect();
    assert_eq!(without, ["merge-tracks", "stats"]);
}
