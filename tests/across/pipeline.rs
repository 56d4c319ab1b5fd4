//! The whole pipeline on a tiny dataset: same bytes however it is run, stale exactly where it should be.

use std::time::{Duration, Instant};

use convoy_tests::{Bench, TINY, check_in_python};
use runner::{Graph, UnitKind};

/// The stages of scenes, in running order.
fn scene_stages() -> Vec<&'static str> {
    let of_scenes = Graph::get().stages.iter().filter(|stage| stage.unit == UnitKind::Scene);
    of_scenes.map(|stage| stage.name).collect()
}

/// The state of every stage, as `convoy status` prints it: scene stages in order.
fn states(bench: &Bench) -> Vec<String> {
    let status = bench.run("convoy", &["status"]);
    let line = status.stdout.lines().find(|l| l.starts_with("0000 ")).expect("the table has scene 0");
    line.split_whitespace().skip(1).map(str::to_owned).collect()
}

fn stale(bench: &Bench) -> Vec<&'static str> {
    let states = states(bench);
    let stages = scene_stages().into_iter().zip(&states);
    stages.filter(|(_, state)| *state != "done").map(|(stage, _)| stage).collect()
}

/// Runs every stage with a number of threads.
fn run_all(bench: &Bench, threads: &str) {
    bench.run("convoy", &["run", "--threads", threads, "--progress", "none"]).expect_done();
}

#[test]
fn one_dataset_however_it_is_made() {
    let whole = Bench::new(TINY);
    run_all(&whole, "1");
    let digests = whole.digests();
    assert!(digests.len() > 40, "{digests:?}");
    whole.run("convoy", &["verify"]).expect_done();
    // Stock pyarrow and numpy read everything.
    check_in_python("check_readers.py", &["numpy", "pyarrow"], &[&whole.store()]);

    // A second run changes nothing.
    run_all(&whole, "1");
    assert_eq!(digests, whole.digests());

    // Killed again and again, on two threads: the same bytes in the end.
    let killed = Bench::new(TINY);
    run_killed(&killed);
    assert_eq!(digests, killed.digests());

    stale_exactly_where_it_should_be(&whole);
}

/// Starts each stage, kills it without warning after a while, and again a little later, until it ends by
/// itself.
fn run_killed(bench: &Bench) {
    for stage in ["spawn-planner"].into_iter().chain(scene_stages()).chain(["stats"]) {
        // The first kill comes before anything can be done.
        let mut patience = Duration::from_millis(2);
        let mut kills = 0;
        loop {
            let mut child = bench.start(stage, &["--threads", "2"]);
            let start = Instant::now();
            let ended = loop {
                match child.try_wait().expect("the child can be asked") {
                    Some(status) => break Some(status),
                    None if start.elapsed() > patience => break None,
                    None => std::thread::sleep(Duration::from_millis(5)),
                }
            };
            if let Some(status) = ended {
                assert!(status.success(), "{stage}: {status}");
                break;
            }
            child.kill().expect("the child is killed");
            child.wait().expect("the child is reaped");
            kills += 1;
            patience = patience * 8 / 5;
            assert!(kills < 60, "{stage} never ends");
        }
        assert!(kills > 0, "{stage} was too fast to be killed");
    }
}

fn stale_exactly_where_it_should_be(bench: &Bench) {
    assert_eq!(stale(bench), [""; 0]);

    // A lidar option concerns the sensors and what was made from them.
    bench.configure(&TINY.replace("[vehicle.lidar]\n", "[vehicle.lidar]\nnoise_m = 0.07\n"));
    assert_eq!(stale(bench), ["render-sensors", "postprocess-valid", "merge-tracks"]);
    bench.configure(TINY);
    assert_eq!(stale(bench), [""; 0]);

    // Redoing a stage makes what was made from it stale, and nothing else.
    let before = bench.digests();
    bench.run("render-sensors", &["--scenes", "0", "--force"]).expect_done();
    assert_eq!(stale(bench), ["postprocess-valid", "merge-tracks"]);
    let after = bench.digests();
    let changed: Vec<&String> = before.keys().filter(|k| before[*k] != after[*k]).collect();
    assert_eq!(changed, ["scenes/0000/_manifests/render-sensors.json"], "the same shards");

    // A damaged manifest is seen and made again, and stops nobody else.
    let manifest = bench.store().join("scenes/0000/_manifests/bev-gt.json");
    let whole = bench.digests();
    std::fs::write(&manifest, "{").expect("truncates");
    assert_eq!(stale(bench), ["bev-gt", "postprocess-valid", "merge-tracks"]);
    bench.run("bev-gt", &[]).expect_done();
    assert_eq!(whole, bench.digests());

    // A truncated shard is seen, named and made again.
    let shard = bench.store().join("scenes/0000/boxes.parquet");
    let bytes = std::fs::read(&shard).expect("reads");
    std::fs::write(&shard, &bytes[..bytes.len() / 2]).expect("truncates");
    let verify = bench.run("convoy", &["verify"]);
    assert_eq!(verify.code, 1);
    assert!(
        verify.stdout.contains("scenes/0000/boxes.parquet") && verify.stdout.contains("truncated"),
        "{verify:?}"
    );
    let blocked = bench.run("merge-tracks", &[]);
    assert_eq!(blocked.code, 1);
    assert!(blocked.stderr.contains("simulate-and-log is stale"), "{blocked:?}");
    run_all(bench, "2");
    assert_eq!(stale(bench), [""; 0]);
    bench.run("convoy", &["verify"]).expect_done();
}
