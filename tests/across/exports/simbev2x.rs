//! The layout `simbev2x`.

use convoy_tests::{Bench, check_in_python, digests};

use super::export;

pub(super) fn check(bench: &Bench) {
    let (processed, outcome) = export(bench, "simbev2x", "processed", &["--threads", "1"]);
    outcome.expect_done();
    let (raw, outcome) = export(bench, "simbev2x", "raw", &["--state", "raw"]);
    outcome.expect_done();
    let packages = ["numpy", "pyarrow", "PIL"];
    check_in_python("exports/simbev2x.py", &packages, &[&bench.store(), &processed, &raw]);

    // Of the same bytes for any number of threads, wherever it stands.
    let prefix = processed.to_string_lossy().into_owned();
    let (again, outcome) = export(bench, "simbev2x", "again", &["--threads", "2", "--path-prefix", &prefix]);
    outcome.expect_done();
    assert_eq!(digests(&processed), digests(&again));

    let (_, refused) = export(bench, "simbev2x", "gaps", &["--agents", "vehicle_1,rsu_0"]);
    assert!(refused.code == 2 && refused.stderr.contains("without gaps"), "{}", refused.stderr);
    let (_, refused) = export(bench, "simbev2x", "rsus", &["--agents", "rsu_*"]);
    assert!(refused.code == 2 && refused.stderr.contains("vehicle_0"), "{}", refused.stderr);
    let (thin, outcome) = export(bench, "simbev2x", "thin", &["--every", "5", "--sensors", "LIDAR"]);
    outcome.expect_done();
    assert!(outcome.stdout.contains("frames between"), "{}", outcome.stdout);
    let sweeps = digests(&thin.join("simbev2x/sweeps/vehicle-0/LIDAR"));
    assert_eq!(sweeps.len(), 4, "frames 0, 5, 10, 15 of 20");
    assert!(sweeps.keys().next_back().is_some_and(|name| name.contains("frame-0003")), "numbered anew");
}
