//! A stage of one scene, and stores to run it in.

use std::collections::BTreeMap;
use std::io::Write;

use schema::tables::GnssRow;
use store::{Attempt, Identity, Manifest, Scope, Store, StoreError, keys};

pub(crate) const STAGE: &str = "render-sensors";
pub(crate) const SCOPE: Scope = Scope::Scene(7);

/// A store that is gone after the test.
pub(crate) struct Bench {
    pub(crate) store: Store,
    folder: Option<tempfile::TempDir>,
}

impl Bench {
    pub(crate) fn on_disk() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        Self { store: Store::open(folder.path()).expect("a folder is a place"), folder: Some(folder) }
    }

    pub(crate) fn in_memory() -> Self {
        Self { store: Store::open("memory:").expect("memory is a place"), folder: None }
    }

    /// Another one of the same kind.
    pub(crate) fn another(&self) -> Self {
        if self.folder.is_some() { Self::on_disk() } else { Self::in_memory() }
    }

    /// All objects. There must be no unfinished ones.
    pub(crate) fn tree(&self) -> BTreeMap<String, Vec<u8>> {
        let backend = self.store.backend();
        assert_eq!(backend.unfinished("").expect("lists"), []);
        let keys = backend.keys("").expect("lists");
        keys.into_iter().map(|key| (key.clone(), self.bytes(&key))).collect()
    }

    pub(crate) fn bytes(&self, key: &str) -> Vec<u8> {
        self.store.read(key).expect("reads").expect("is there")
    }

    /// Puts an object past the store's protocol.
    pub(crate) fn put(&self, key: &str, bytes: &[u8]) {
        let mut sink = self.store.backend().create(key, "somebody").expect("creates");
        sink.write_all(bytes).expect("writes");
        sink.commit().expect("commits");
    }
}

/// Runs each test on every backend.
macro_rules! on_every_backend {
    ($($test:ident),+ $(,)?) => {
        mod on_disk {
            $( #[test] fn $test() { super::$test(&crate::common::Bench::on_disk()); } )+
        }
        mod in_memory {
            $( #[test] fn $test() { super::$test(&crate::common::Bench::in_memory()); } )+
        }
    };
}
pub(crate) use on_every_backend;

pub(crate) fn identity(config: &str) -> Identity {
    Identity {
        stage: STAGE.into(),
        scope: SCOPE,
        code_version: "test".into(),
        config_hash: config.into(),
        inputs: BTreeMap::from([("simulate-and-log".to_owned(), "abc".to_owned())]),
        made_by: None,
    }
}

pub(crate) fn gnss(frames: u32) -> Vec<GnssRow> {
    (0..frames)
        .map(|frame| GnssRow {
            frame,
            time_s: f64::from(frame) * 0.05,
            latitude_deg: 1.0,
            ..GnssRow::default()
        })
        .collect()
}

pub(crate) fn key(unit: &str) -> String {
    keys::scene(7, &format!("sensors/{unit}/GNSS.parquet"))
}

/// Runs a stage of some units.
pub(crate) fn run(store: &Store, config: &str, force: bool, units: &[&str]) -> Result<Manifest, StoreError> {
    let attempt = Attempt::start(store, identity(config), force)?;
    for name in units {
        if let Some(mut unit) = attempt.unit(name)? {
            unit.rows(&key(name), &gnss(40))?;
            unit.finish()?;
        }
    }
    attempt.commit()
}

/// Starts a stage and stops after its first unit, without a manifest.
pub(crate) fn run_half(store: &Store, config: &str, force: bool) {
    let attempt = Attempt::start(store, identity(config), force).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is to do");
    unit.rows(&key("vehicle_0"), &gnss(40)).expect("writes");
    unit.finish().expect("finishes");
}
