//! The layouts `opv2v` and `v2x-real`.

use std::fs;

use convoy_tests::{Bench, check_in_python, digests};

use super::export;

pub(super) fn check(bench: &Bench) {
    let packages = ["numpy", "pyarrow", "PIL"];
    for layout in ["opv2v", "v2x-real"] {
        let (dest, outcome) = export(bench, layout, layout, &["--threads", "2"]);
        outcome.expect_done();
        // The rig has six cameras, an RSU three: four are chosen, or none, and it is said.
        for word in ["RGB-CAM_FRONT_LEFT", "cameras of rsu_0", "radars", "160 x 90"] {
            assert!(outcome.stdout.contains(word), "{word}: {}", outcome.stdout);
        }
        check_in_python("exports/opv2v.py", &packages, &[&bench.store(), &dest]);
        let (again, outcome) = export(bench, layout, &format!("{layout}-1"), &["--threads", "1"]);
        outcome.expect_done();
        assert_eq!(digests(&dest), digests(&again));
        fs::remove_dir_all(again).expect("is removed");
    }
    let (few, outcome) = export(bench, "opv2v", "few", &["--sensors", "LIDAR", "--every", "7"]);
    outcome.expect_done();
    let names: Vec<String> = digests(&few).into_keys().filter(|name| name.contains("OPV2V/")).collect();
    assert!(names.iter().any(|name| name.ends_with("/000014.pcd")), "{names:?}");
    assert!(!names.iter().any(|name| name.contains("camera") || name.contains("000002")), "{names:?}");
    for (args, word) in [
        (vec!["--sensors", "RGB-*"], "no agent has a lidar"),
        (vec!["--cameras", "CAM_FRONT,CAM_BACK"], "expected four"),
        (vec!["--classes", "tank"], "no such class"),
    ] {
        let (_, refused) = export(bench, "opv2v", "refused", &args);
        assert!(refused.code == 2 && refused.stderr.contains(word), "{args:?}: {}", refused.stderr);
    }
    let (_, refused) = export(bench, "v2x-real", "refused", &["--classes", "car,traffic_light"]);
    assert!(refused.code == 2 && refused.stderr.contains("traffic_light"), "{}", refused.stderr);
}
