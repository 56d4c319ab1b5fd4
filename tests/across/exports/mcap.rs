//! The layout `mcap`.

use std::path::Path;

use convoy_tests::{Bench, check_in_python, digests};

use super::export;

pub(super) fn check(bench: &Bench) {
    let args = ["--depth", "--voxel-block", "2", "--threads"];
    let (dest, outcome) = export(bench, "mcap", "mcap", &[&args[..], &["2"]].concat());
    outcome.expect_done();
    // Tracks of a scene run side by side: their number must not show either.
    let (other, outcome) = export(bench, "mcap", "mcap_one", &[&args[..], &["1"]].concat());
    outcome.expect_done();
    assert_eq!(digests(&dest), digests(&other));
    check_in_python(
        "exports/mcap.py",
        &["numpy", "pyarrow", "PIL"],
        &[&bench.store(), &dest, Path::new("depth")],
    );
    let (_, refused) = export(bench, "mcap", "none", &["--voxel-range=-1"]);
    assert!(refused.code == 2 && refused.stderr.contains("-1 m"), "{}", refused.stderr);
}
