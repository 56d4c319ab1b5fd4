//! What only a bucket has: parts, ranges, answers that are lost or mean neither yes nor no.

use std::io::Write;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use async_trait::async_trait;
use futures_util::stream::BoxStream;
use object_store::memory::InMemory;
use object_store::path::Path;
use object_store::{
    CopyOptions, Error, GetOptions, GetResult, ListResult, MultipartUpload, ObjectMeta, ObjectStore,
    PutMultipartOptions, PutOptions, PutPayload, PutResult, Result, UploadPart,
};
use schema::tables::{GnssRow, LidarRow};
use store::{Objects, Store, StoreError, TableOptions};

use crate::common::{STAGE, gnss, identity, key, run};

/// What goes wrong with a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    /// It is not done, and the service says that it is out of order.
    Fails,
    /// It is done, and the answer is lost.
    LosesAnswer,
    /// It is not done, and the service says that there is one.
    Conflicts,
}

/// A service in memory that counts requests; the next writes have faults.
#[derive(Debug, Default)]
struct Service {
    place: InMemory,
    faults: Arc<Mutex<Vec<Fault>>>,
    gets: AtomicUsize,
    puts: AtomicUsize,
    parts: Arc<AtomicUsize>,
}

impl std::fmt::Display for Service {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a service")
    }
}

fn lost() -> Error {
    Error::Generic { store: "test", source: "connection reset".into() }
}

fn fault(faults: &Mutex<Vec<Fault>>) -> Option<Fault> {
    faults.lock().expect("no test panics").pop()
}

#[async_trait]
impl ObjectStore for Service {
    async fn put_opts(&self, path: &Path, bytes: PutPayload, options: PutOptions) -> Result<PutResult> {
        self.puts.fetch_add(1, Ordering::Relaxed);
        match fault(&self.faults) {
            None => self.place.put_opts(path, bytes, options).await,
            Some(Fault::Fails) => Err(lost()),
            Some(Fault::LosesAnswer) => self.place.put_opts(path, bytes, options).await.and(Err(lost())),
            Some(Fault::Conflicts) => {
                Err(Error::AlreadyExists { path: path.to_string(), source: "409 Conflict".into() })
            }
        }
    }
    async fn put_multipart_opts(
        &self,
        path: &Path,
        options: PutMultipartOptions,
    ) -> Result<Box<dyn MultipartUpload>> {
        let upload = self.place.put_multipart_opts(path, options).await?;
        let (faults, parts) = (Arc::clone(&self.faults), Arc::clone(&self.parts));
        Ok(Box::new(Parts { upload, faults, parts }))
    }
    async fn get_opts(&self, path: &Path, options: GetOptions) -> Result<GetResult> {
        self.gets.fetch_add(usize::from(!options.head), Ordering::Relaxed);
        self.place.get_opts(path, options).await
    }
    fn delete_stream(&self, paths: BoxStream<'static, Result<Path>>) -> BoxStream<'static, Result<Path>> {
        self.place.delete_stream(paths)
    }
    fn list(&self, prefix: Option<&Path>) -> BoxStream<'static, Result<ObjectMeta>> {
        self.place.list(prefix)
    }
    async fn list_with_delimiter(&self, prefix: Option<&Path>) -> Result<ListResult> {
        self.place.list_with_delimiter(prefix).await
    }
    async fn copy_opts(&self, from: &Path, to: &Path, options: CopyOptions) -> Result<()> {
        self.place.copy_opts(from, to, options).await
    }
}

#[derive(Debug)]
struct Parts {
    upload: Box<dyn MultipartUpload>,
    faults: Arc<Mutex<Vec<Fault>>>,
    parts: Arc<AtomicUsize>,
}

#[async_trait]
impl MultipartUpload for Parts {
    fn put_part(&mut self, part: PutPayload) -> UploadPart {
        self.parts.fetch_add(1, Ordering::Relaxed);
        self.upload.put_part(part)
    }
    async fn complete(&mut self) -> Result<PutResult> {
        match fault(&self.faults) {
            None => self.upload.complete().await,
            Some(Fault::Fails) => Err(lost()),
            Some(_) => self.upload.complete().await.and(Err(lost())),
        }
    }
    async fn abort(&mut self) -> Result<()> {
        self.upload.abort().await
    }
}

/// A store on such a service.
fn store(faults: &[Fault]) -> (Arc<Service>, Store) {
    let faults = Arc::new(Mutex::new(faults.iter().rev().copied().collect()));
    let service = Arc::new(Service { faults, ..Service::default() });
    let store = Store::new(Arc::new(Objects::new(service.clone(), "test://bucket", "set")));
    (service, store)
}

/// Bytes that differ from one place to the next.
fn many(bytes: usize) -> Vec<u8> {
    (0..bytes).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect()
}

fn write(store: &Store, key: &str, bytes: &[u8]) -> std::result::Result<(), StoreError> {
    let mut sink = store.backend().create(key, STAGE)?;
    bytes.chunks(1_000_003).try_for_each(|chunk| sink.write_all(chunk)).expect("writes");
    sink.commit()
}

#[test]
fn large_objects_go_up_in_parts_and_come_back_in_ranges() {
    let (service, store) = store(&[]);
    let bytes = many(12 << 20);
    write(&store, "large", &bytes).expect("commits");
    assert_eq!((service.parts.load(Ordering::Relaxed), service.puts.load(Ordering::Relaxed)), (3, 0));
    let shard = store.backend().open("large", None).expect("opens");
    assert_eq!(shard.size(), bytes.len() as u64);
    let end = bytes.len() as u64;
    let edge = end - (64 << 10);
    let ranges: [Range<u64>; 7] =
        [0..10, 5 << 20..6 << 20, 100..200, 0..end, end - 8..end, edge - 5..edge + 5, edge..end];
    for range in ranges {
        let wanted = &bytes[range.start as usize..range.end as usize];
        assert!(shard.read_at(range.clone()).expect("reads") == wanted, "{range:?}");
    }
    assert!(shard.read_at(end - 1..end + 1).is_err());
}

#[test]
fn what_is_not_committed_is_not_there() {
    let (service, store) = store(&[]);
    let mut sink = store.backend().create("large", STAGE).expect("creates");
    sink.write_all(&many(11 << 20)).expect("writes");
    drop(sink);
    assert_eq!(service.parts.load(Ordering::Relaxed), 2);
    assert!(store.backend().keys("").expect("lists").is_empty());
    drop(store.backend().create("small", STAGE).expect("creates"));
    assert_eq!(service.puts.load(Ordering::Relaxed), 0);
}

#[test]
fn small_things_are_one_request() {
    let (service, store) = store(&[]);
    write(&store, "small", &many(3 << 20)).expect("commits");
    assert_eq!(service.puts.load(Ordering::Relaxed), 1);
    assert_eq!(store.read("small").expect("reads").map(|bytes| bytes.len()), Some(3 << 20));
    assert_eq!(service.gets.load(Ordering::Relaxed), 1);
}

#[test]
fn a_small_table_is_one_request() {
    let (service, store) = store(&[]);
    let manifest = run(&store, "c", false, &["vehicle_0"]).expect("runs");
    assert!(manifest.outputs[0].bytes < 1 << 20, "{manifest:?}");
    service.gets.store(0, Ordering::Relaxed);
    let rows: Vec<GnssRow> = store.read_rows(&manifest, &key("vehicle_0")).expect("reads");
    assert_eq!((rows.len(), service.gets.load(Ordering::Relaxed)), (gnss(40).len(), 1));
}

#[test]
fn frames_are_a_request_or_two_a_mebibyte() {
    let (service, store) = store(&[]);
    let attempt = store::Attempt::start(&store, identity("c"), false).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is to do");
    let mut table =
        unit.table::<LidarRow>(&key("vehicle_0"), TableOptions::frames(Vec::new())).expect("starts");
    // Numbers that do not pack.
    let noise = |salt: u64| -> Vec<f32> {
        let mixed = |i: u64| (i ^ salt.rotate_left(32)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (0..40_000).map(|i| f32::from_bits(0x3f80_0000 | (mixed(mixed(i)) >> 41) as u32)).collect()
    };
    let frame = |frame: u32| {
        let at = |axis: u64| noise(u64::from(frame) * 3 + axis);
        LidarRow { frame, x: at(0), y: at(1), z: at(2), ..LidarRow::default() }
    };
    for number in 0..12 {
        table.push(&[frame(number)]).expect("writes");
    }
    unit.add(table.finish().expect("ends"));
    unit.finish().expect("finishes");
    let manifest = attempt.commit().expect("commits");
    // Smaller ones are read whole.
    assert!(manifest.outputs[0].bytes > 1 << 20, "{manifest:?}");
    service.gets.store(0, Ordering::Relaxed);
    let rows = store.row_groups::<LidarRow>(&manifest, &key("vehicle_0")).expect("opens");
    assert_eq!(service.gets.load(Ordering::Relaxed), 1, "its end");
    let read: Vec<LidarRow> = rows.flat_map(|group| group.expect("reads")).collect();
    assert!(read.len() == 12 && read[7] == frame(7));
    let gets = service.gets.load(Ordering::Relaxed);
    // The index, and small frames together; a stream may now and then read beyond what was fetched for one.
    let bytes = manifest.outputs[0].bytes;
    assert!((2..=2 + 2 * (bytes as usize >> 20)).contains(&gets), "{gets} for 12 frames of {bytes} bytes");
    // One of them alone, once the table's end is known.
    let one = store
        .rows_at::<LidarRow>(&manifest, &key("vehicle_0"), std::iter::once(7..8).collect())
        .expect("opens");
    service.gets.store(0, Ordering::Relaxed);
    let read: Vec<LidarRow> = one.flat_map(|group| group.expect("reads")).collect();
    assert!(read.len() == 1 && read[0] == frame(7));
    assert!((1..=2).contains(&service.gets.load(Ordering::Relaxed)), "{:?}", service.gets);
}

#[test]
fn a_lost_answer_is_no_no() {
    let (_, store) = store(&[Fault::LosesAnswer, Fault::Fails, Fault::LosesAnswer]);
    let backend = store.backend();
    assert!(backend.put_if_absent("once", STAGE, b"first").expect("puts"), "was done");
    assert!(backend.put_if_absent("twice", STAGE, b"second").expect("puts"), "is done at the third try");
    assert!(!backend.put_if_absent("once", STAGE, b"other").expect("puts"));
    assert_eq!(store.read("once").expect("reads").as_deref(), Some(&b"first"[..]));
}

#[test]
fn neither_yes_nor_no_means_again() {
    let (service, store) = store(&[Fault::Conflicts, Fault::Conflicts]);
    assert!(store.backend().put_if_absent("once", STAGE, b"first").expect("puts"));
    assert_eq!(service.puts.load(Ordering::Relaxed), 3);
    let (_, store) = self::store(&[Fault::Fails; 9]);
    let error = store.backend().put_if_absent("once", STAGE, b"first").expect_err("is out of order");
    assert!(error.is_transient() && error.to_string().contains("connection reset"), "{error}");
}

#[test]
fn an_upload_whose_end_was_not_heard_of_is_looked_at() {
    let bytes = many(6 << 20);
    let (_, store) = store(&[Fault::LosesAnswer]);
    write(&store, "large", &bytes).expect("was done");
    assert_eq!(store.read("large").expect("reads"), Some(bytes.clone()));
    let (_, store) = self::store(&[Fault::Fails]);
    let error = write(&store, "large", &bytes).expect_err("was not done");
    assert!(error.is_transient(), "{error}");
    assert!(store.backend().keys("").expect("lists").is_empty());
}

#[test]
fn of_two_that_replace_one_succeeds() {
    let (_, store) = store(&[]);
    write(&store, "record", b"old").expect("commits");
    let backend = store.backend();
    let won: usize = std::thread::scope(|scope| {
        let tries = (0..8_u8).map(|i| {
            scope.spawn(move || backend.replace("record", STAGE, b"old", &[i; 40]).expect("replaces"))
        });
        let tries: Vec<_> = tries.collect();
        tries.into_iter().map(|t| usize::from(t.join().expect("ends"))).sum()
    });
    assert_eq!(won, 1);
    assert!(!backend.replace("record", STAGE, b"old", b"new").expect("looks"));
    assert!(!backend.replace("nothing", STAGE, b"", b"new").expect("looks"));
}

#[test]
fn parts_of_two_objects_make_none() {
    let (service, store) = store(&[]);
    let (old, new) = (many(4 << 20), vec![7; 4 << 20]);
    write(&store, "a", &old).expect("written");
    let size = old.len() as u64;
    let opened = store.backend().open("a", Some(size)).expect("there");
    assert_eq!(opened.read_at(0..10).expect("read"), old[..10]);
    // Another process puts one of the same size there: who has opened the old one learns of it.
    let other = Store::new(Arc::new(Objects::new(service, "test://bucket", "set")));
    write(&other, "a", &new).expect("written");
    let error = opened.read_at(2 << 20..3 << 20).expect_err("the old one is gone");
    assert!(error.to_string().contains("another object is there now"), "{error}");
    // One that replaces it itself reads the new one, though the old one is still open.
    write(&store, "a", &old).expect("written");
    let reopened = store.backend().open("a", Some(size)).expect("there");
    assert_eq!(reopened.read_at(2 << 20..3 << 20).expect("read"), old[2 << 20..3 << 20]);
    drop(opened);
}
