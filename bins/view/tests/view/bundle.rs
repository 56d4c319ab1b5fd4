//! The committed bundle is what the sources give.

use std::path::Path;
use std::process::Command;

use testkit::{Need, skip};

#[test]
fn the_bundle_is_built_from_the_sources() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let viewer = here.join("../../viewer");
    if !["node", "npm"].iter().all(|program| Command::new(program).arg("--version").output().is_ok()) {
        return skip(Need::Npm, "there is no npm to build the viewer's page with");
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    // A copy: the packages are not to lie in the working tree.
    let mut copy = Command::new("cp");
    copy.arg("-r").args(["package.json", "package-lock.json", "build.mjs", "src"]).arg(folder.path());
    assert!(copy.current_dir(&viewer).status().is_ok_and(|s| s.success()), "the sources are copied");
    let installed = Command::new("npm")
        .args(["ci", "--ignore-scripts", "--no-audit", "--no-fund"])
        .current_dir(folder.path())
        .output()
        .expect("npm starts");
    if !installed.status.success() {
        let why = String::from_utf8_lossy(&installed.stderr);
        return skip(
            Need::Npm,
            &format!("npm cannot install the viewer's packages: {}", why.lines().last().unwrap_or_default()),
        );
    }
    let out = folder.path().join("out");
    let built = Command::new("node")
        .arg("build.mjs")
        .arg(&out)
        .current_dir(folder.path())
        .output()
        .expect("node starts");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    for name in ["index.html", "style.css", "app.js", "worker.js"] {
        let read = |path: &Path| std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let same = read(&out.join(name)) == read(&here.join("assets").join(name));
        assert!(
            same,
            "bins/view/assets/{name} is not what the sources give: cd viewer && npm ci && npm run build"
        );
    }
}
