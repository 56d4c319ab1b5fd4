//! The layout `kitti`.

use convoy_tests::{Bench, check_in_python};

use super::export;

pub(super) fn check(bench: &Bench) {
    let (dest, outcome) = export(bench, "kitti", "kitti", &[]);
    outcome.expect_done();
    check_in_python("exports/kitti.py", &["numpy", "pyarrow", "PIL"], &[&bench.store(), &dest]);
    let (_, refused) = export(bench, "kitti", "other", &["--camera", "CAM_TOP"]);
    assert!(refused.code == 2 && refused.stderr.contains("RGB-CAM_TOP"), "{}", refused.stderr);
}
