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
    benchmark-gpu.toml: 545123aa f772e48e 315e07af 0e37fd3f 5c801ac1 a436178d 6613bdbf 5207b9fd 0f1d1761
    benchmark.toml: 1b58147b 2174f3fa 9bd97d37 711a7267 5c801ac1 a436178d e1c2dea8 5207b9fd e00b19f6
    day-and-night.toml: 8edc065c caba3b23 e3ac8abc 65b302c6 961b4abb 0a4ec2fd 322f19e3 eab30c91 b39ae58c
    demo.toml: f8801ff6 056dfa7c e3ac8abc c20b4b2b 961b4abb 8331b841 5f2eeba9 eab30c91 fe03a8a2
    simbev2x-full.toml: 35e5d40e 00522d85 cd6439a3 016f0e4e 961b4abb 0a4ec2fd 322f19e3 eab30c91 e87c5a7f
    town03.toml: 24a4df01 0fb9d819 e3ac8abc af99136b 961b4abb 8331b841 5f2eeba9 eab30c91 dafa5808
    town04.toml: ea041b6c 4cc2e2d7 e3ac8abc c0144bb8 961b4abb 8331b841 5f2eeba9 eab30c91 4fa69b5b
    town10.toml: 5ded1352 d799cfcd e3ac8abc 89f0cb48 961b4abb 8331b841 5f2eeba9 eab30c91 cccee083
    every_key.toml: 0f5065d7 0011915a b4c47427 2f86cf5c ff64fdd9 5729b336 b14115f7 364d2be1 3ecc8f04
    every_key.yaml: 64b9b880 6a6b2630 ed854b02 931cb5c2 d92a2cd4 a9d6c410 8f7b9b9a eab30c91 c2f67f5c
    rigs/nuscenes.toml: c5a84d3d 5834cd7f cd6439a3 c2b790a0 961b4abb ef24d922 5102b1d9 eab30c91 de8af1e7
    rigs/opv2v-rsu.toml: 67ff8e56 5834cd7f cd6439a3 c875a191 961b4abb ef24d922 cd424764 eab30c91 a6a5fc24
    rigs/opv2v.toml: aa93f831 5834cd7f cd6439a3 53a05ec5 961b4abb ef24d922 9afbf752 eab30c91 a08a105c
    rigs/simbev2x-rsu.toml: 378c825a 5834cd7f cd6439a3 f8ce41e8 961b4abb 7adb271d 787aa86a eab30c91 723ade2d
    rigs/simbev2x-vehicle.toml: 52d3cf5a 5834cd7f cd6439a3 f6405367 961b4abb 7adb271d 7aefe54b eab30c91 eb2dda11
    ");
}
