//! Datasets that grow, shrink and have scenes replaced, by the real program.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use convoy_tests::{Bench, Outcome, program};
use schema::tables::{PlanAgentRow, PlanSceneRow};
use store::{Manifest, Scope, Store, keys};

/// A dataset that is planned again and again.
struct Growing(Bench);

impl Growing {
    fn new() -> Self {
        Self(Bench::new(""))
    }

    fn folder(&self) -> &Path {
        self.0.folder.path()
    }

    /// Runs the planner with a configuration in a file of some name.
    fn run(&self, file: &str, config: &str, args: &[&str]) -> Outcome {
        let path = self.folder().join(file);
        fs::write(&path, config).expect("the configuration is written");
        let mut command = Command::new(program("spawn-planner"));
        command.arg("--config").arg(&path).arg("--store").arg(self.0.store());
        let output = command.args(["--progress", "none"]).args(args).output().expect("the program starts");
        Outcome::of(&output)
    }

    /// Plans, expecting success; gives what the program said.
    fn plan(&self, config: &str) -> String {
        let outcome = self.run("config.toml", config, &[]);
        outcome.expect_done();
        outcome.stderr
    }

    fn store(&self) -> Store {
        Store::open(self.0.store()).expect("is a folder")
    }

    fn manifest(&self) -> Manifest {
        self.store().manifest(Scope::Plan, "spawn-planner").expect("is readable").expect("is there")
    }

    /// What later stages remember of each scene's plan.
    fn digests(&self) -> BTreeMap<String, String> {
        self.manifest().sections
    }

    fn scenes(&self) -> Vec<PlanSceneRow> {
        self.store().read_rows(&self.manifest(), keys::PLAN_SCENES).expect("is readable")
    }

    fn agents(&self) -> Vec<PlanAgentRow> {
        self.store().read_rows(&self.manifest(), keys::PLAN_AGENTS).expect("is readable")
    }

    /// Something that a later stage made of a scene.
    fn pretend_made(&self, scene: u32) {
        let path = self.0.store().join(format!("scenes/{scene:04}/log/scene.json"));
        fs::create_dir_all(path.parent().expect("has a folder")).expect("makes folders");
        fs::write(path, "{}").expect("writes");
    }
}

fn config(scenes: &str) -> String {
    format!("name = \"grows\"\nseed = 5\n{scenes}[agents]\nmax_vehicles = 3\n")
}

const FIRST: &str = "[scenes.train]\n\"convoy/demo\" = 2\n[scenes.val]\n\"convoy/demo\" = 1\n";

fn short(bench: &Growing) -> Vec<(u32, String, String)> {
    bench.scenes().into_iter().map(|s| (s.scene, s.split, s.map)).collect()
}

fn slot(scene: u32, split: &str, map: &str) -> (u32, String, String) {
    (scene, split.into(), map.into())
}

#[test]
fn a_dataset_grows_at_its_end() {
    let bench = Growing::new();
    bench.plan(&config(FIRST));
    let before = bench.digests();
    let first = short(&bench);
    assert_eq!(
        first,
        [slot(0, "train", "convoy/demo"), slot(1, "train", "convoy/demo"), slot(2, "val", "convoy/demo")]
    );

    let wider = "[scenes.train]\n\"convoy/01\" = 1\n\"convoy/demo\" = 3\n[scenes.val]\n\"convoy/demo\" = 1\n";
    bench.plan(&config(wider));
    let after = short(&bench);
    assert_eq!(after[..3], first);
    assert_eq!(after[3..], [slot(3, "train", "convoy/01"), slot(4, "train", "convoy/demo")]);
    // What was made of the older scenes still holds: later stages remember these digests.
    let digests = bench.digests();
    assert!(before.iter().all(|(scene, digest)| digests.get(scene) == Some(digest)));
    assert_eq!(digests.len(), 5);

    // Again: nothing to do, and not one byte changes even when forced to.
    let plan = bench.scenes();
    let outcome = bench.run("config.toml", &config(wider), &["--force"]);
    assert_eq!(outcome.code, 0, "{outcome:?}");
    assert_eq!((bench.scenes(), bench.digests()), (plan, digests));
}

#[test]
fn a_killed_expansion_gives_the_same_numbers() {
    let whole = Growing::new();
    whole.plan(&config(FIRST));
    let wider = config(&FIRST.replace("= 2", "= 3"));
    whole.plan(&wider);
    // As if killed after the new roster had taken the old one's place.
    fs::remove_file(whole.folder().join("store/plan/_manifest.json")).expect("removes");
    let (plan, agents) = {
        let fresh = Growing::new();
        fresh.plan(&config(FIRST));
        fresh.plan(&wider);
        (fresh.scenes(), fresh.agents())
    };
    whole.plan(&wider);
    assert_eq!((whole.scenes(), whole.agents()), (plan, agents));
}

#[test]
fn what_was_made_is_never_removed() {
    let bench = Growing::new();
    let two_maps = "[scenes.train]\n\"convoy/demo\" = 2\n\"convoy/01\" = 2\n";
    bench.plan(&config(two_maps));
    bench.pretend_made(1);
    bench.pretend_made(3);
    let before = bench.digests();
    let said = bench.plan(&config("[scenes.train]\n\"convoy/demo\" = 1\n"));
    // Of the demo town the made scene stays and fulfils the wish; of the other one the made scene stays, too.
    assert_eq!(short(&bench), [slot(1, "train", "convoy/demo"), slot(3, "train", "convoy/01")]);
    assert!(said.contains("train on convoy/01") && said.contains("scenes 3;"), "{said}");
    assert!(bench.digests().iter().all(|(scene, digest)| before.get(scene) == Some(digest)));
    assert!(bench.manifest().output("maps/convoy/01.xodr.zst").is_some());
    // A failed try is nothing that was made.
    let failure = bench.folder().join("store/scenes/0001/_manifests/simulate-and-log.failed.json");
    fs::remove_dir_all(bench.folder().join("store/scenes/0001")).expect("removes");
    fs::create_dir_all(failure.parent().expect("has a folder")).expect("makes folders");
    fs::write(&failure, "{}").expect("writes");
    bench.plan(&config("[scenes.val]\n\"convoy/demo\" = 1\n"));
    assert_eq!(short(&bench), [slot(3, "train", "convoy/01"), slot(4, "val", "convoy/demo")]);
}

#[test]
fn the_map_file_of_older_scenes_may_be_gone() {
    let bench = Growing::new();
    let network = town::generate(&town::named("convoy/demo").expect("is known")).expect("is sound");
    let file = bench.folder().join("elsewhere.xodr");
    fs::write(&file, opendrive::write(&network)).expect("writes");
    let wish = format!("[scenes.train]\n\"{}\" = 1\n", file.display());
    bench.plan(&config(&wish));
    bench.pretend_made(0);
    let before = bench.digests();
    fs::remove_file(&file).expect("removes");
    bench.plan(&config("[scenes.test]\n\"convoy/demo\" = 1\n"));
    assert_eq!(short(&bench), [slot(0, "train", "elsewhere"), slot(1, "test", "convoy/demo")]);
    assert_eq!(bench.digests().get("scene/0000"), before.get("scene/0000"));
}

#[test]
fn a_dry_run_says_what_to_expect_and_writes_nothing() {
    let bench = Growing::new();
    let outcome = bench.run("config.toml", &config(FIRST), &["--dry-run"]);
    assert_eq!(outcome.code, 0, "{outcome:?}");
    assert!(!bench.folder().join("store").exists());
    bench.plan(&config(FIRST));
    let (scenes, agents) = (bench.scenes(), bench.agents());
    let frames: u32 = scenes.iter().map(|s| s.frames).sum();
    let agent_frames: u32 =
        agents.iter().filter_map(|a| scenes.iter().find(|s| s.scene == a.scene)).map(|s| s.frames).sum();
    let plain = outcome.stdout.replace(',', "");
    assert!(plain.contains("3 scenes (2 train 1 val 0 test) on 1 maps"), "{plain}");
    assert!(plain.contains(&format!("{frames} frames")), "{plain}");
    assert!(plain.contains(&format!("{agent_frames} agent-frames")), "{plain}");
    assert!(plain.contains("on disk") && plain.contains(" core-"), "{plain}");
}

#[test]
fn the_originals_yaml_is_planned() {
    let bench = Growing::new();
    let yaml = "mode: create\ntrain_scene_config:\n  convoy/demo: 2\nval_scene_config:\nmax_vehicles: 2\n\
                render_gpu: 0\ninitial_weather: {cloudiness: 15}\nmagic: 1\n";
    let outcome = bench.run("config.yaml", yaml, &[]);
    assert_eq!(outcome.code, 0, "{outcome:?}");
    assert!(bench.scenes().iter().all(|s| s.initial_weather.cloudiness == 15.0) && bench.scenes().len() == 2);
    assert!(outcome.stderr.contains("config.yaml:6: `render_gpu` has no effect here"), "{outcome:?}");
    assert!(outcome.stderr.contains("config.yaml:8: `magic`: no such key here"), "{outcome:?}");
    let outcome = bench.run("bad.yml", &yaml.replace("max_vehicles: 2", "max_vehicles: two"), &[]);
    assert!(outcome.code == 2 && outcome.stderr.contains("bad.yml:5: `agents.max_vehicles`"), "{outcome:?}");
}

#[test]
fn replacing_scenes_touches_no_other() {
    let bench = Growing::new();
    bench.plan(&config(FIRST));
    let (before, old) = (bench.digests(), bench.scenes());
    let redrawn = |draws: &str| config(&format!("{FIRST}[scenes.redraw]\n{draws}\n"));
    bench.plan(&redrawn("1 = 1"));
    let changed = |now: &BTreeMap<String, String>| -> Vec<String> {
        now.iter().filter(|(k, v)| before.get(*k) != Some(*v)).map(|(k, _)| k.clone()).collect()
    };
    let first_draw = bench.digests();
    assert_eq!(changed(&first_draw), ["scene/0001"]);
    let new = bench.scenes();
    assert_eq!((&new[1].split, &new[1].map), (&old[1].split, &old[1].map));
    assert!(new[1].seed != old[1].seed && new[1].initial_weather != old[1].initial_weather);
    bench.plan(&redrawn("1 = 2\n2 = 1"));
    let second_draw = bench.digests();
    assert_eq!(changed(&second_draw), ["scene/0001", "scene/0002"]);
    assert_ne!(first_draw["scene/0001"], second_draw["scene/0001"]);
    // Taken back: the first scenes again.
    bench.plan(&config(FIRST));
    assert_eq!(bench.digests(), before);
    // Mistakes are named.
    let outcome = bench.run("config.toml", &redrawn("one = 1"), &[]);
    assert!(
        outcome.code == 2 && outcome.stderr.contains("`scenes.redraw`: `one` is no scene number"),
        "{outcome:?}"
    );
    assert!(bench.plan(&redrawn("77 = 1")).contains("there is no scene 77"));
}
