//! Digests of settings stand in the manifests of finished stores: an equal configuration must give equal
//! ones, however the settings are declared and read.

use std::path::{Path, PathBuf};

use runner::{Editions, Graph, StageSpec, UnitKind, config_hash};
use settings::DatasetSettings;
use store::Scope;

/// The TOML files of a folder, by name.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder").flatten().map(|entry| entry.path());
    let mut files: Vec<PathBuf> = entries.filter(|p| p.extension().is_some_and(|e| e == "toml")).collect();
    files.sort();
    files
}

/// The shipped configurations and rigs, and two files that name all keys.
fn configurations() -> Vec<(String, DatasetSettings)> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let configs = here.join("../../../configs");
    let every_key = ["every_key.toml", "every_key.yaml"].map(|name| here.join("tests/runner").join(name));
    let name = |file: &Path| file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let whole = files(&configs).into_iter().chain(every_key).map(|file| {
        let (settings, _) = settings::load(&file).unwrap_or_else(|faults| panic!("{faults:?}"));
        (name(&file), settings)
    });
    let rigs = files(&configs.join("rigs")).into_iter().map(|file| {
        let rig = format!("rigs/{}", name(&file));
        let text = format!(
            "[scenes.train]\n\"convoy/demo\" = 1\n[vehicle]\nrig = \"{rig}\"\n[rsu]\nrig = \"{rig}\"\n[[rigs]]\nagents = \
             [\"vehicle_1\"]\n"
        );
        let at = configs.join("some.toml").display().to_string();
        let settings = settings::parse(&text, &at).unwrap_or_else(|faults| panic!("{faults:?}"));
        (rig, settings)
    });
    whole.chain(rigs).collect()
}

/// An edition is read back from `dataset.json`: nothing may be lost on the way.
#[test]
fn settings_come_back_from_their_record() {
    for (name, settings) in configurations() {
        let text = serde_json::to_string_pretty(&settings).expect("is JSON");
        let read: DatasetSettings = serde_json::from_str(&text).expect("is a configuration");
        let settings = DatasetSettings { store: read.store.clone(), ..settings };
        assert_eq!(read, settings, "{name}");
    }
}

/// The whole settings as `dataset.json` has them, then what each stage sees.
#[test]
fn settings_are_written_as_ever() {
    let mut said = String::new();
    for (name, settings) in configurations() {
        let whole = serde_json::to_vec(&settings).expect("is JSON");
        let stages = &Graph::get().stages;
        let editions = Editions::only(&settings);
        let view = |stage: &StageSpec| {
            let scope = match stage.unit {
                UnitKind::Plan => Scope::Plan,
                UnitKind::Scene => Scope::Scene(0),
                UnitKind::Stats => Scope::Stats,
            };
            config_hash(stage, &editions, scope).expect("has a view")
        };
        let views = stages.iter().map(view);
        let digests: Vec<String> = std::iter::once(store::hash_bytes(&whole)).chain(views).collect();
        said += &format!("{name}: {}\n", digests.iter().map(|d| &d[..8]).collect::<Vec<_>>().join(" "));
    }
    insta::assert_snapshot!(said, @r"
    benchmark-gpu.toml: a6794746 91a7d26b 94a92673 974e7b3c 5c801ac1 a436178d e1c2dea8 5207b9fd 49e7a01e
    benchmark.toml: ce71fedf 2174f3fa 6ddbadbf 711a7267 5c801ac1 a436178d e1c2dea8 5207b9fd e00b19f6
    day-and-night.toml: 21ce82d0 caba3b23 82b5e6b3 65b302c6 961b4abb 0a4ec2fd 322f19e3 eab30c91 b39ae58c
    demo.toml: 187866b6 056dfa7c 82b5e6b3 c20b4b2b 961b4abb 8331b841 5f2eeba9 eab30c91 fe03a8a2
    simbev2x-full.toml: 3a404c6e 00522d85 a54aebcf 016f0e4e 961b4abb 0a4ec2fd 322f19e3 eab30c91 e87c5a7f
    tiny.toml: 8b2d1585 f2d02299 dd4ad3e7 127b718e b67157b0 ac1c5d5d 31afe447 eab30c91 b63739ed
    town03.toml: 735f3480 0fb9d819 82b5e6b3 af99136b 961b4abb 8331b841 5f2eeba9 eab30c91 dafa5808
    town04.toml: e797202e 4cc2e2d7 82b5e6b3 c0144bb8 961b4abb 8331b841 5f2eeba9 eab30c91 4fa69b5b
    town10.toml: 00239d85 d799cfcd 82b5e6b3 89f0cb48 961b4abb 8331b841 5f2eeba9 eab30c91 cccee083
    every_key.toml: 55fc6aec 0011915a b4c47427 546c9745 ff64fdd9 5729b336 51d851e6 364d2be1 76ad185d
    every_key.yaml: 9948aab7 6a6b2630 a31c28ce 931cb5c2 d92a2cd4 a9d6c410 8f7b9b9a eab30c91 c2f67f5c
    rigs/nuscenes.toml: 1ba223ab 5834cd7f a54aebcf c2b790a0 961b4abb ef24d922 5102b1d9 eab30c91 de8af1e7
    rigs/opv2v-rsu.toml: 9d106fc5 5834cd7f a54aebcf c875a191 961b4abb ef24d922 cd424764 eab30c91 a6a5fc24
    rigs/opv2v.toml: b500e091 5834cd7f a54aebcf 53a05ec5 961b4abb ef24d922 9afbf752 eab30c91 a08a105c
    rigs/simbev2x-rsu.toml: 166f17c1 5834cd7f a54aebcf f8ce41e8 961b4abb 7adb271d 787aa86a eab30c91 723ade2d
    rigs/simbev2x-vehicle.toml: 400de71b 5834cd7f a54aebcf f6405367 961b4abb 7adb271d 7aefe54b eab30c91 eb2dda11
    ");
}
