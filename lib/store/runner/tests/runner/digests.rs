//! Digests of settings stand in the manifests of finished stores: an equal configuration must give equal
//! ones, however the settings are declared and read.

use std::path::{Path, PathBuf};

use runner::{Graph, config_hash};
use settings::DatasetSettings;

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

/// The whole settings as `dataset.json` has them, then what each stage sees.
#[test]
fn settings_are_written_as_ever() {
    let mut said = String::new();
    for (name, settings) in configurations() {
        let whole = serde_json::to_vec(&settings).expect("is JSON");
        let stages = &Graph::get().stages;
        let views = stages.iter().map(|stage| config_hash(stage, &settings).expect("has a view"));
        let digests: Vec<String> = std::iter::once(store::hash_bytes(&whole)).chain(views).collect();
        said += &format!("{name}: {}\n", digests.iter().map(|d| &d[..8]).collect::<Vec<_>>().join(" "));
    }
    insta::assert_snapshot!(said, @r"
    benchmark-gpu.toml: f24abc3b f772e48e 315e07af 0e37fd3f 5c801ac1 a436178d 6613bdbf 5207b9fd 0f1d1761
    benchmark.toml: 2b904c62 2174f3fa 9bd97d37 711a7267 5c801ac1 a436178d e1c2dea8 5207b9fd e00b19f6
    demo.toml: 3f56321e 056dfa7c e3ac8abc c20b4b2b 961b4abb 8331b841 5f2eeba9 eab30c91 fe03a8a2
    simbev2x-full.toml: 1ac5a7c4 00522d85 cd6439a3 016f0e4e 961b4abb 0a4ec2fd 322f19e3 eab30c91 e87c5a7f
    town03.toml: 881af3d1 0fb9d819 e3ac8abc af99136b 961b4abb 8331b841 5f2eeba9 eab30c91 dafa5808
    town04.toml: 417655c5 4cc2e2d7 e3ac8abc c0144bb8 961b4abb 8331b841 5f2eeba9 eab30c91 4fa69b5b
    town10.toml: 0556db27 d799cfcd e3ac8abc 89f0cb48 961b4abb 8331b841 5f2eeba9 eab30c91 cccee083
    every_key.toml: ad88e061 96768665 60d22a57 2f86cf5c ff64fdd9 5729b336 b14115f7 364d2be1 3ecc8f04
    every_key.yaml: f7dab86f 6a6b2630 ed854b02 931cb5c2 d92a2cd4 a9d6c410 8f7b9b9a eab30c91 c2f67f5c
    rigs/nuscenes.toml: 1b1caab9 5834cd7f cd6439a3 c2b790a0 961b4abb ef24d922 5102b1d9 eab30c91 de8af1e7
    rigs/opv2v-rsu.toml: f0416a1a 5834cd7f cd6439a3 c875a191 961b4abb ef24d922 cd424764 eab30c91 a6a5fc24
    rigs/opv2v.toml: 2342b06e 5834cd7f cd6439a3 53a05ec5 961b4abb ef24d922 9afbf752 eab30c91 a08a105c
    rigs/simbev2x-rsu.toml: dddc9323 5834cd7f cd6439a3 f8ce41e8 961b4abb 7adb271d 787aa86a eab30c91 723ade2d
    rigs/simbev2x-vehicle.toml: 898e7a6f 5834cd7f cd6439a3 f6405367 961b4abb 7adb271d 7aefe54b eab30c91 eb2dda11
    ");
}
