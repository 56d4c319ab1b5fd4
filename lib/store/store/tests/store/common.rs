//! A stage of one scene, and stores to run it in.

use std::collections::BTreeMap;
use std::io::Write;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

use object_store::ObjectStore;
use object_store::aws::AmazonS3Builder;
use schema::tables::GnssRow;
use store::{Attempt, Identity, Manifest, Objects, Scope, Store, StoreError, keys};
use testkit::bucket::BucketServer;

pub(crate) const STAGE: &str = "render-sensors";
pub(crate) const SCOPE: Scope = Scope::Scene(7);

/// A store that is gone after the test.
pub(crate) struct Bench {
    pub(crate) store: Store,
    place: Place,
}

/// Where it is.
enum Place {
    Disk(#[allow(dead_code, reason = "is removed when it is dropped")] tempfile::TempDir),
    Memory,
    /// What answers like a bucket, in memory.
    Bucket,
    /// A folder of its own of a real one.
    Service,
}

impl Bench {
    pub(crate) fn on_disk() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        Self { store: Store::open(folder.path()).expect("a folder is a place"), place: Place::Disk(folder) }
    }

    pub(crate) fn in_memory() -> Self {
        Self { store: Store::open("memory:").expect("memory is a place"), place: Place::Memory }
    }

    pub(crate) fn in_bucket() -> Self {
        let service = Arc::new(object_store::memory::InMemory::new());
        let store = Store::new(Arc::new(Objects::new(service, "test://bucket", "a set")));
        Self { store, place: Place::Bucket }
    }

    /// A folder of its own in the bucket that `CONVOY_TEST_STORE` names, else in one of a server of ours.
    pub(crate) fn in_service() -> Self {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        let folder = format!("{}-{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
        let store = match std::env::var("CONVOY_TEST_STORE") {
            Ok(bucket) => Store::open(format!("{bucket}/{folder}")).expect("a folder of a bucket is a place"),
            Err(_) => Store::new(Arc::new(Objects::new(service(), "s3://sets", &folder))),
        };
        Self { store, place: Place::Service }
    }

    /// Another one of the same kind.
    pub(crate) fn another(&self) -> Self {
        match &self.place {
            Place::Disk(_) => Self::on_disk(),
            Place::Memory => Self::in_memory(),
            Place::Bucket => Self::in_bucket(),
            Place::Service => Self::in_service(),
        }
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

/// A client of a server that all tests of this process share.
fn service() -> Arc<dyn ObjectStore> {
    static SERVER: OnceLock<BucketServer> = OnceLock::new();
    let _ = rustls::crypto::ring::default_provider().install_default();
    let service = AmazonS3Builder::new()
        .with_endpoint(SERVER.get_or_init(BucketServer::start).endpoint())
        .with_allow_http(true)
        .with_bucket_name("sets")
        .with_access_key_id("test")
        .with_secret_access_key("secret")
        .with_disable_bulk_delete(true)
        .build();
    Arc::new(service.expect("is whole"))
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
        mod in_bucket {
            $( #[test] fn $test() { super::$test(&crate::common::Bench::in_bucket()); } )+
        }
        mod in_service {
            $( #[test] fn $test() { super::$test(&crate::common::Bench::in_service()); } )+
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
