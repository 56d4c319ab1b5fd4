//! Writing fails: whatever was being written, the error names the file and the cause, and nothing committed
//! is lost.

use std::io::{self, Write};
use std::sync::Arc;
use std::time::SystemTime;

use schema::table::Column;
use store::{
    Area, Attempt, Backend, Listing, Memory, Shard, Sink, Store, StoreError, Unfinished, Unit, keys,
};

use crate::common::{Bench, SCOPE, STAGE, gnss, identity, key, on_every_backend, run};

on_every_backend!(every_writer_names_file_and_cause, a_fault_anywhere_in_a_run_loses_nothing_committed);

/// ENOSPC, EDQUOT, EFBIG, EIO.
const FAULTS: [i32; 4] = [28, 122, 27, 5];

/// Where writing fails.
#[derive(Clone, Copy, Debug)]
enum Fault {
    /// From a byte of each object on.
    Byte(usize),
    /// When an object is to be completed.
    Commit,
    /// When an object is to be put on condition.
    Put,
}

/// A place that fails.
struct Failing {
    place: Store,
    fault: Fault,
    code: i32,
}

struct FailingSink {
    sink: Box<dyn Sink>,
    location: String,
    fault: Fault,
    code: i32,
}

impl Write for FailingSink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Fault::Byte(room) = &mut self.fault else { return self.sink.write(bytes) };
        let n = bytes.len().min(*room);
        if n == 0 && !bytes.is_empty() {
            return Err(io::Error::from_raw_os_error(self.code));
        }
        *room -= n;
        self.sink.write(&bytes[..n])
    }
    fn flush(&mut self) -> io::Result<()> {
        self.sink.flush()
    }
}

impl Sink for FailingSink {
    fn commit(self: Box<Self>) -> Result<(), StoreError> {
        match self.fault {
            Fault::Commit => {
                Err(StoreError::write(self.location, "sync", io::Error::from_raw_os_error(self.code)))
            }
            Fault::Byte(_) | Fault::Put => self.sink.commit(),
        }
    }
}

impl Backend for Failing {
    fn create(&self, key: &str, owner: &str) -> Result<Box<dyn Sink>, StoreError> {
        let sink = self.place.backend().create(key, owner)?;
        Ok(Box::new(FailingSink { sink, location: self.location(key), fault: self.fault, code: self.code }))
    }
    fn put_if_absent(&self, key: &str, owner: &str, bytes: &[u8]) -> Result<bool, StoreError> {
        match self.fault {
            Fault::Put => {
                Err(StoreError::write(self.location(key), "write", io::Error::from_raw_os_error(self.code)))
            }
            Fault::Byte(_) | Fault::Commit => self.place.backend().put_if_absent(key, owner, bytes),
        }
    }
    fn replace(&self, key: &str, owner: &str, old: &[u8], new: &[u8]) -> Result<bool, StoreError> {
        self.place.backend().replace(key, owner, old, new)
    }
    fn read(&self, key: &str) -> Result<Option<Vec<u8>>, StoreError> {
        self.place.backend().read(key)
    }
    fn open(&self, key: &str, bytes: Option<u64>) -> Result<Box<dyn Shard>, StoreError> {
        self.place.backend().open(key, bytes)
    }
    fn size(&self, key: &str) -> Result<Option<u64>, StoreError> {
        self.place.backend().size(key)
    }
    fn modified(&self, key: &str) -> Result<Option<SystemTime>, StoreError> {
        self.place.backend().modified(key)
    }
    fn remove(&self, key: &str) -> Result<(), StoreError> {
        self.place.backend().remove(key)
    }
    fn list(&self, folder: &str) -> Result<Listing, StoreError> {
        self.place.backend().list(folder)
    }
    fn folders(&self, folder: &str) -> Result<Vec<String>, StoreError> {
        self.place.backend().folders(folder)
    }
    fn unfinished(&self, folder: &str) -> Result<Vec<Unfinished>, StoreError> {
        self.place.backend().unfinished(folder)
    }
    fn sweep(&self, area: Area<'_>, owner: &str) -> Result<usize, StoreError> {
        self.place.backend().sweep(area, owner)
    }
    fn location(&self, key: &str) -> String {
        self.place.location(key)
    }
}

fn failing(bench: &Bench, fault: Fault, code: i32) -> Store {
    Store::new(Arc::new(Failing { place: bench.store.clone(), fault, code }))
}

fn assert_names(error: &StoreError, file: &str, code: i32) {
    let StoreError::Write { path, source, .. } = error else { panic!("{error:?}") };
    assert!(path.ends_with(file), "{path}: expected {file}");
    assert_eq!(source.raw_os_error(), Some(code), "{error}");
    assert!(error.is_transient() && error.to_string().contains("run the same command again"), "{error}");
}

type Writer = fn(&mut Unit<'_>, &str) -> Result<(), StoreError>;

/// The ways of a unit to write a shard. (Archives are written by `replay`, which has its own test.)
const WRITERS: [(&str, Writer); 4] = [
    ("table.parquet", |unit, key| unit.rows(key, &gnss(3000))),
    ("columns.parquet", |unit, key| {
        unit.columns(
            key,
            vec![("count", Column::U64((0..3000_u64).map(|i| i.wrapping_mul(0x9e37_79b9)).collect()))],
        )
    }),
    ("bytes.csv", |unit, key| unit.bytes(key, &[7; 5000], 1)),
    ("stream.npz", |unit, key| {
        let mut file = unit.file(key)?;
        file.write_bytes(&[1; 2500])?;
        file.write_bytes(&[2; 2500])?;
        let finished = file.finish(1)?;
        unit.add(finished);
        Ok(())
    }),
];

fn every_writer_names_file_and_cause(bench: &Bench) {
    for code in FAULTS {
        for (name, write) in WRITERS {
            for fault in [Fault::Byte(0), Fault::Byte(3), Fault::Byte(1000), Fault::Commit] {
                let store = failing(bench, fault, code);
                let attempt = Attempt::start(&store, identity("c"), false).expect("starts");
                let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is to do");
                let written = write(&mut unit, &keys::scene(7, name)).and_then(|()| unit.finish());
                assert_names(&written.expect_err(name), name, code);
            }
        }
        let record = failing(bench, Fault::Byte(1), code).write_json(keys::ROSTER, STAGE, &[1, 2, 3]);
        assert_names(&record.expect_err("is full"), keys::ROSTER, code);
        let store = failing(bench, Fault::Put, code);
        let manifest = Attempt::start(&store, identity("c"), false).expect("starts").commit();
        assert_names(&manifest.expect_err("is full"), &SCOPE.manifest(STAGE), code);
    }
    assert!(bench.tree().is_empty());
}

fn a_fault_anywhere_in_a_run_loses_nothing_committed(bench: &Bench) {
    run(&bench.store, "c", false, &["vehicle_0", "vehicle_1"]).expect("runs");
    let before = bench.tree();
    let error = run(&failing(bench, Fault::Byte(100), 28), "d", false, &["vehicle_0", "vehicle_1"]);
    assert_names(&error.expect_err("is full"), "vehicle_0/GNSS.parquet", 28);
    assert_eq!(before, bench.tree());
    // Shards fit, the manifest does not: the units are kept for the next try.
    let error = run(&failing(bench, Fault::Put, 28), "d", false, &["vehicle_0", "vehicle_1"]);
    assert_names(&error.expect_err("is full"), &SCOPE.manifest(STAGE), 28);
    let attempt = Attempt::start(&bench.store, identity("d"), false).expect("starts");
    for unit in ["vehicle_0", "vehicle_1"] {
        assert!(attempt.unit(unit).expect("asks").is_none(), "{unit} is kept");
    }
    attempt.commit().expect("commits");
    assert_eq!(before.keys().collect::<Vec<_>>(), bench.tree().keys().collect::<Vec<_>>());
}

/// With any room at all a run ends whole or says what is full; with more room the next one ends.
#[test]
fn a_small_place_fills_up_and_goes_on() {
    let unlimited = Bench::in_memory();
    run(&unlimited.store, "c", false, &["vehicle_0", "vehicle_1"]).expect("runs");
    let needed: usize = unlimited.tree().values().map(Vec::len).sum();
    let mut full = 0;
    for room in (0..needed + 4000).step_by(97) {
        let memory = Memory::with_capacity(room);
        let store = Store::new(Arc::new(memory.clone()));
        match run(&store, "c", false, &["vehicle_0", "vehicle_1"]) {
            Ok(manifest) => assert!(store.outputs_present(&manifest).expect("asks")),
            Err(error) => {
                assert!(
                    matches!(&error, StoreError::Write { .. }) && error.is_transient(),
                    "{room}: {error}"
                );
                assert!(error.to_string().contains("make room"), "{error}");
                assert!(store.manifest(SCOPE, STAGE).expect("asks").is_none());
                full += 1;
            }
        }
    }
    assert!(full > 20, "{full}");
}

/// Parquet turns errors of reading into text; ours keep the cause.
#[test]
fn a_failed_read_is_no_broken_shard() {
    struct Unreadable(Memory);
    struct NoShard(u64);
    impl Shard for NoShard {
        fn size(&self) -> u64 {
            self.0
        }
        fn read_at(&self, _: std::ops::Range<u64>) -> io::Result<bytes::Bytes> {
            Err(io::Error::from_raw_os_error(5))
        }
    }
    impl Backend for Unreadable {
        fn create(&self, key: &str, owner: &str) -> Result<Box<dyn Sink>, StoreError> {
            self.0.create(key, owner)
        }
        fn put_if_absent(&self, key: &str, owner: &str, bytes: &[u8]) -> Result<bool, StoreError> {
            self.0.put_if_absent(key, owner, bytes)
        }
        fn replace(&self, key: &str, owner: &str, old: &[u8], new: &[u8]) -> Result<bool, StoreError> {
            self.0.replace(key, owner, old, new)
        }
        fn read(&self, key: &str) -> Result<Option<Vec<u8>>, StoreError> {
            if key.ends_with(".parquet") {
                return Err(StoreError::read(self.location(key), "read", io::Error::from_raw_os_error(5)));
            }
            self.0.read(key)
        }
        fn open(&self, key: &str, _: Option<u64>) -> Result<Box<dyn Shard>, StoreError> {
            Ok(Box::new(NoShard(self.0.size(key)?.unwrap_or_default())))
        }
        fn size(&self, key: &str) -> Result<Option<u64>, StoreError> {
            self.0.size(key)
        }
        fn modified(&self, key: &str) -> Result<Option<SystemTime>, StoreError> {
            self.0.modified(key)
        }
        fn remove(&self, key: &str) -> Result<(), StoreError> {
            self.0.remove(key)
        }
        fn list(&self, folder: &str) -> Result<Listing, StoreError> {
            self.0.list(folder)
        }
        fn folders(&self, folder: &str) -> Result<Vec<String>, StoreError> {
            self.0.folders(folder)
        }
        fn unfinished(&self, folder: &str) -> Result<Vec<Unfinished>, StoreError> {
            self.0.unfinished(folder)
        }
        fn sweep(&self, area: Area<'_>, owner: &str) -> Result<usize, StoreError> {
            self.0.sweep(area, owner)
        }
        fn location(&self, key: &str) -> String {
            self.0.location(key)
        }
    }
    let store = Store::new(Arc::new(Unreadable(Memory::default())));
    let manifest = run(&store, "c", false, &["vehicle_0"]).expect("runs");
    let error = store.read_rows::<schema::tables::GnssRow>(&manifest, &key("vehicle_0")).expect_err("fails");
    assert!(
        matches!(&error, StoreError::Read { path, source, .. }
            if path.ends_with("GNSS.parquet") && source.raw_os_error() == Some(5)),
        "{error:?}"
    );
    assert!(matches!(store::verify(&store, &[], |_| {}), Err(StoreError::Read { .. })));
}
