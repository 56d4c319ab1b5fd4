//! Probes: small scenes (`tests/probes/NAME.toml`) the digests of whose shards are committed beside them.
//! They prove the numbers of `versions.toml`: a stage whose bytes differ has to have another number.
//! `make accept-bytes` raises it and renews the digests.

mod accept;
mod digests;
mod made;
mod stated;
mod versions;

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use convoy_tests::workspace;

use stated::Stated;
use versions::Versions;

/// A scene and what is made of its store.
struct Probe {
    name: &'static str,
    /// Where its maps and packs are, from the workspace.
    maps: Option<&'static str>,
    /// Arguments of `export`, the layout first.
    exports: &'static [&'static [&'static str]],
    /// Whether the last export is imported again.
    import: bool,
}

/// A probe without maps and exports.
const SCENE: Probe = Probe { name: "", maps: None, exports: &[], import: false };

/// A test for each probe, so that they run side by side, and the list of all.
macro_rules! probes {
    ($($name:ident $with:tt)*) => {
        const PROBES: &[Probe] = &[$(probes!(@ $name $with)),*];

        $(#[test]
        fn $name() {
            compare(PROBES.iter().find(|probe| probe.name == stringify!($name)).expect("is listed"));
        })*
    };
    (@ $name:ident { $($field:ident: $value:expr),* }) => {
        Probe { name: stringify!($name), $($field: $value,)* ..SCENE }
    };
}

probes! {
    day {
        exports: &[
            &["kitti"],
            &["mcap", "--depth"],
            &["nuscenes", "--sweeps", "lidar,radar"],
            &["opv2v"],
            &["v2x-real"],
            &["simbev2x", "--every", "10", "--path-prefix", "/data"]
        ]
    }
    night {}
    rain {}
    fog {}
    lenses {}
    lidars {}
    frames { exports: &[&["simbev2x", "--path-prefix", "/data"]], import: true }
    hazards {}
    bridge {}
    motorway {}
    walkers {}
    rounds {}
    voxels {}
    pack { maps: Some("tests/packs") }
    imported { maps: Some("lib/map/opendrive/tests/data") }
}

/// Where probes and their digests are.
fn folder() -> PathBuf {
    workspace().join("tests/probes")
}

/// Makes a probe's store and holds it against what is stated.
fn compare(probe: &Probe) {
    let name = probe.name;
    let stated = Stated::read(name)
        .unwrap_or_else(|| panic!("probe {name} has no digests yet: run `make accept-bytes`"));
    assert!(
        stated.input == made::input(probe),
        "probe {name} itself has changed (its configuration, maps or packs): run `make accept-bytes`, which renews its digests and \
         raises no number for it. Do it without a change of the code, which would go unseen."
    );
    let differences = stated.differences(&made::digests(probe));
    assert!(differences.is_empty(), "{}", stated::report(name, &differences, &Versions::read()));
}

#[test]
fn versions_and_digests_agree() {
    let versions = Versions::read();
    for probe in PROBES {
        let Some(stated) = Stated::read(probe.name) else { continue };
        assert_eq!(
            stated.versions,
            versions.numbers(),
            "tests/probes/{}.digests (left) is of other numbers than versions.toml (right): run `make accept-bytes`",
            probe.name
        );
    }
}

#[test]
fn every_file_is_of_a_probe() {
    let expected: BTreeSet<String> =
        PROBES.iter().flat_map(|p| [format!("{}.toml", p.name), format!("{}.digests", p.name)]).collect();
    let files = fs::read_dir(folder()).expect("is there").map(|file| file.expect("is listed").file_name());
    let found: BTreeSet<String> = files.map(|name| name.to_string_lossy().into_owned()).collect();
    let strange: Vec<&String> = found.difference(&expected).collect();
    assert!(
        strange.is_empty(),
        "of no probe in tests/across/probes/mod.rs, to be removed or listed: {strange:?}"
    );
    let missing: Vec<&String> = expected.difference(&found).collect();
    assert!(missing.is_empty(), "missing in tests/probes (`make accept-bytes` writes digests): {missing:?}");
}
