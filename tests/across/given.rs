//! Trajectories from outside, by the real programs.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, Int64Array, RecordBatch, StringArray};
use convoy_tests::{Bench, LEAN};
use frames::{Object, Pose, World};
use parquet::arrow::ArrowWriter;
use runner::Graph;
use schema::tables::{ActorRow, BoxRow, PlanTrajectoryRow, StateRow};
use schema::{ActorKind, ActorRole, ObjectId};
use store::{Scope, Store, keys};

/// Actor, model, frame, position, roll, pitch and yaw.
type Pose20Hz = (String, String, i64, [f64; 3], [f64; 3]);

fn write(path: &Path, poses: &[Pose20Hz]) {
    let texts =
        |of: fn(&Pose20Hz) -> &str| Arc::new(StringArray::from_iter_values(poses.iter().map(of))) as ArrayRef;
    let numbers = |of: &dyn Fn(&Pose20Hz) -> f64| {
        Arc::new(Float64Array::from_iter_values(poses.iter().map(of))) as ArrayRef
    };
    let batch = RecordBatch::try_from_iter([
        ("actor", texts(|p| &p.0)),
        ("model", texts(|p| &p.1)),
        ("frame", Arc::new(Int64Array::from_iter_values(poses.iter().map(|p| p.2))) as ArrayRef),
        ("x_m", numbers(&|p| p.3[0])),
        ("y_m", numbers(&|p| p.3[1])),
        ("z_m", numbers(&|p| p.3[2])),
        ("roll_rad", numbers(&|p| p.4[0])),
        ("pitch_rad", numbers(&|p| p.4[1])),
        ("yaw_rad", numbers(&|p| p.4[2])),
    ]);
    let batch = batch.expect("columns of one length");
    let file = File::create(path).expect("is created");
    let mut writer = ArrowWriter::try_new(file, batch.schema(), None).expect("a writer");
    writer.write(&batch).expect("is written");
    writer.close().expect("is written");
}

struct Log {
    actors: Vec<ActorRow>,
    states: Vec<StateRow>,
}

fn log(bench: &Bench) -> Log {
    let store = Store::open(bench.store()).expect("is a folder");
    let log = store.manifest(Scope::Scene(0), "simulate-and-log").expect("reads").expect("is there");
    Log {
        actors: store.read_rows(&log, &keys::table::<ActorRow>(0)).expect("reads"),
        states: store.read_rows(&log, &keys::table::<StateRow>(0)).expect("reads"),
    }
}

/// The poses of an actor of a log, under a name.
fn poses(log: &Log, id: ObjectId, name: &str) -> Vec<Pose20Hz> {
    let actor = log.actors.iter().find(|a| a.id == id).expect("is there");
    let own = log.states.iter().filter(|s| s.id == id);
    own.map(|s| {
        let rpy = Pose::<World, Object>::from_xyz_wxyz(s.xyz_m, s.quaternion).rpy();
        (name.to_owned(), actor.model.clone(), i64::from(s.frame), s.xyz_m, rpy)
    })
    .collect()
}

#[test]
fn a_scene_that_was_driven_is_driven_again() {
    let first = Bench::new(LEAN);
    for stage in ["spawn-planner", "simulate-and-log"] {
        first.run(stage, &[]).expect_done();
    }
    let driven = log(&first);
    let agent =
        driven.actors.iter().find(|a| matches!(a.role, ActorRole::Agent(_)) && !a.fixed).expect("one");
    let other = driven.actors.iter().find(|a| a.role == ActorRole::Background).expect("one");
    let mut given = poses(&driven, agent.id, "vehicle_0");
    given.extend(poses(&driven, other.id, "the other"));

    let bench = Bench::new(&LEAN.replace("[agents]", "[agents]\ntrajectories = \"drive.parquet\""));
    let maps = ["--maps", bench.folder.path().to_str().expect("is text")];
    write(&bench.folder.path().join("drive.parquet"), &given);
    bench.run("spawn-planner", &maps).expect_done();
    bench.run("simulate-and-log", &[]).expect_done();
    let again = log(&bench);
    let of = |name: &str| match name {
        "vehicle_0" => again.actors.iter().find(|a| a.role == agent.role).expect("one").id,
        _ => again.actors.iter().rfind(|a| a.role == ActorRole::Background).expect("one").id,
    };
    for (name, _, frame, xyz_m, rpy_rad) in &given {
        let id = of(name);
        let state =
            again.states.iter().find(|s| s.id == id && i64::from(s.frame) == *frame).expect("a state");
        assert_eq!(state.xyz_m, *xyz_m, "{name} at {frame}");
        let rpy = Pose::<World, Object>::from_xyz_wxyz(state.xyz_m, state.quaternion).rpy();
        assert!((0..3).all(|k| frames::wrap_pi(rpy[k] - rpy_rad[k]).abs() < 1e-9), "{name} at {frame}");
    }
    // All that follows works with it, and labels what drives there.
    let those = Graph::get().stages.iter().skip_while(|stage| stage.name != "simulate-and-log");
    for stage in those.skip(1) {
        bench.run(stage.name, &[]).expect_done();
    }
    let store = Store::open(bench.store()).expect("is a folder");
    let manifest = store.manifest(Scope::Scene(0), "simulate-and-log").expect("reads").expect("is there");
    let boxes: Vec<BoxRow> = store.read_rows(&manifest, &keys::table::<BoxRow>(0)).expect("reads");
    assert!(again.actors.iter().any(|a| a.kind == ActorKind::Vehicle && boxes.iter().any(|b| b.id == a.id)));
    bench.run("convoy", &["verify"]).expect_done();

    // The store has them: the file may go. A changed file is a changed scene.
    std::fs::remove_file(bench.folder.path().join("drive.parquet")).expect("is removed");
    bench.run("render-sensors", &["--scenes", "0"]).expect_done();
    bench.run("spawn-planner", &[]).expect_done();
    let gone = bench.run("spawn-planner", &["--force"]);
    assert_eq!(gone.code, 2, "{gone:?}");
    assert!(gone.stderr.contains("agents.trajectories: there is no file `drive.parquet`"), "{}", gone.stderr);
    given.iter_mut().for_each(|pose| pose.3[0] += 0.01);
    write(&bench.folder.path().join("drive.parquet"), &given);
    let status = bench.run("convoy", &["status", maps[0], maps[1]]);
    assert!(status.stdout.contains("spawn-planner: stale"), "{}", status.stdout);
    bench.run("spawn-planner", &[&maps[..], &["--redo"]].concat()).expect_done();
    let planned = store.manifest(Scope::Plan, "spawn-planner").expect("reads").expect("is there");
    let rows: Vec<PlanTrajectoryRow> = store.read_rows(&planned, keys::PLAN_TRAJECTORIES).expect("reads");
    assert_eq!((rows.len(), rows[0].xyz_m[0]), (given.len(), given[0].3[0]));
    let status = bench.run("convoy", &["status", maps[0], maps[1]]);
    assert!(status.stdout.contains("simulate-and-log: stale"), "{}", status.stdout);
}

#[test]
fn files_that_hold_no_trajectories_are_refused() {
    let bench = Bench::new(&LEAN.replace("[agents]", "[agents]\ntrajectories = \"drive.parquet\""));
    let path = bench.folder.path().join("drive.parquet");
    let folder = bench.folder.path().display().to_string();
    let maps = ["--maps", folder.as_str()];
    let refused = || {
        let outcome = bench.run("spawn-planner", &maps);
        assert_eq!(outcome.code, 2, "{outcome:?}");
        assert!(!bench.store().join("plan").exists());
        outcome.stderr.replace(&folder, "FOLDER")
    };
    let pose = |frame: i64| ("vehicle_0".to_owned(), "car.sedan".to_owned(), frame, [0.0; 3], [0.0; 3]);
    let mut said = vec![refused()];
    std::fs::write(&path, "no parquet").expect("is written");
    said.push(refused());
    write(&path, &[]);
    said.push(refused());
    write(&path, &[pose(0), pose(1), pose(3)]);
    said.push(refused());
    write(&path, &[pose(0), pose(1), pose(1)]);
    said.push(refused());
    write(&path, &[pose(0), pose(1)]);
    said.push(refused());
    let batch = RecordBatch::try_from_iter([("actor", Arc::new(StringArray::from(vec!["a"])) as ArrayRef)]);
    let batch = batch.expect("one column");
    let mut writer = ArrowWriter::try_new(File::create(&path).expect("is created"), batch.schema(), None)
        .expect("a writer");
    writer.write(&batch).expect("is written");
    writer.close().expect("is written");
    said.push(refused());
    insta::assert_snapshot!("refused-files", said.concat());
}
