//! The Python package on a small store: its own tests, which hold it against the tables, and the examples of
//! its page; the baseline's tests, where there is PyTorch.

use convoy_tests::{Bench, TINY, check_in_python, program};

#[test]
fn the_package_reads_a_store() {
    let config = TINY
        .replace(
            "[agents]\nmin_vehicles = 1\nmax_vehicles = 1",
            "[scenes.val]\n\"convoy/demo\" = 1\n\n[agents]\nmin_vehicles = 2\nmax_vehicles = 2",
        )
        .replace("channels = 16", "channels = 32")
        .replace("semantic = true\ndepth", "boxes_2d = true\nsemantic = true\ndepth");
    // Masks are rarer than sweeps; the second scene is planned and not made.
    let bench = Bench::new(&format!("{config}\n[bev]\nevery_n_frames = 2\n"));
    bench.run("convoy", &["run", "--scenes", "0", "--progress", "none"]).expect_done();
    let (store, packages) = (bench.store(), ["numpy", "pyarrow"]);
    check_in_python("../python/tests/run.py", &packages, &[&store, &program("convoy")]);
    check_in_python("../python/baseline/tests/run.py", &packages, &[&store, &program("convoy")]);
}
