//! A replayed frame shows what the log says of it, and where things were a frame before.

use convoy_tests::{Bench, SMALL};
use glam::Vec3;
use replay::Replay;
use scene::SceneReader;
use schema::tables::StateRow;
use store::Store;

/// Where a state has its object, in the frame of a snapshot.
fn place(replay: &Replay, snapshot: &schema::geometry::Snapshot, frame: i64, id: u16) -> Option<Vec3> {
    let state: &StateRow = replay.log.states_at(frame).iter().find(|s| s.id == id)?;
    Some(snapshot.origin.local_from_world(state.xyz_m))
}

#[test]
fn frames_show_their_states_and_those_before_them() {
    let bench = Bench::new(SMALL);
    for stage in ["spawn-planner", "simulate-and-log"] {
        bench.run(stage, &[]).expect_done();
    }
    let store = Store::open(bench.store()).expect("is a folder");
    let scene = SceneReader::open(&store, 0, &["simulate-and-log"]).expect("is done");
    let replay = Replay::open(&scene).expect("is a log");
    let last = replay.log.frame_count() - 1;
    let (mut found, mut farthest_m) = (0, 0.0_f32);
    for frame in [0, 1, last] {
        let at = replay.log.world_from_agent(0, frame).xyz();
        let snapshot = replay.snapshot(frame, at, 1000.0);
        let frame = i64::from(frame);
        for state in replay.log.states_at(frame) {
            let now = place(&replay, &snapshot, frame, state.id).expect("is in the log");
            // Frame -1 is one period before the first.
            let before = place(&replay, &snapshot, frame - 1, state.id).expect("is in the log");
            let shown = snapshot.instances.iter().filter(|i| i.object == state.id);
            // The body's own frame is the object's: other pieces hang on joints.
            let body = shown.clone().find(|i| {
                let off = Vec3::from(i.local_from_object.translation) - now;
                off.truncate().length() < 2e-3
            });
            let Some(body) = body else { continue };
            let moved =
                Vec3::from(body.local_from_object.translation - body.previous_local_from_object.translation);
            assert!((moved - (now - before)).length() < 2e-3, "object {} at {frame}: {moved}", state.id);
            found += 1;
            farthest_m = farthest_m.max(moved.length());
        }
    }
    assert!(found > 30 && farthest_m > 0.1, "{found} bodies, {farthest_m} m");
}
