//! Archives of frames, written into a store that fills up.

use std::collections::BTreeMap;
use std::sync::Arc;

use codecs::{NpzReader, Scalar, frame_member};
use runner::frames::{FrameArray, FrameArrays, Labelled};
use runner::{At, Place, Progress, ProgressMode, StageError};
use schema::AgentId;
use schema::arrays::{ArrayKind, BEV_IDS, BEV_MASKS};
use schema::measures::counts::PartialCounts;
use schema::tables::PartialRow;
use store::{Attempt, Identity, Manifest, Memory, Scope, Store, StoreError};

const KEY: &str = "scenes/0007/bev/vehicle_0.npz";
const COUNTS: &str = "scenes/0007/stats/vehicle_0.parquet";
const FRAMES: u32 = 9;

fn grid(frame: u32) -> Vec<u8> {
    // Hardly to be compressed, so that the archive grows with each frame.
    (0..500_u32).map(|i| (i.wrapping_mul(2_654_435_761).wrapping_add(frame * 40_503) >> 13) as u8).collect()
}

/// One small grid a frame, but for a broken one.
struct Grids {
    broken: Option<u32>,
    every: u32,
    /// Arrays of frame 6, of two archives.
    at_frame_6: usize,
}

impl FrameArrays for Grids {
    type Memory = Vec<u8>;

    fn memory(&self) -> Result<Vec<u8>, StageError> {
        Ok(Vec::new())
    }

    fn every_n_frames(&self) -> u32 {
        self.every
    }

    fn kinds(&self) -> Vec<&'static ArrayKind> {
        vec![&BEV_MASKS, &BEV_IDS]
    }

    fn arrays<'m>(
        &self,
        memory: &'m mut Vec<u8>,
        frame: u32,
        counts: &mut PartialCounts,
    ) -> Result<Vec<FrameArray<'m>>, StageError> {
        if self.broken == Some(frame) {
            return Err("no such grid").at(|| Place::scene(7).frame(frame));
        }
        *memory = grid(frame);
        counts.add("", "grids", "", frame as i32, 1);
        let other = FrameArray { scalar: Scalar::U8, shape: vec![1], bytes: vec![frame as u8].into() };
        let grid = FrameArray { scalar: Scalar::U8, shape: vec![500], bytes: memory.as_slice().into() };
        let arrays = vec![grid, other.clone(), other];
        Ok(arrays.into_iter().take(if frame == 6 { self.at_frame_6 } else { 2 }).collect())
    }
}

fn archive(store: &Store, broken: Option<u32>) -> Result<Manifest, StageError> {
    write(store, Grids { broken, every: 1, at_frame_6: 2 })
}

fn write(store: &Store, label: Grids) -> Result<Manifest, StageError> {
    let identity = Identity {
        stage: "bev-gt".into(),
        scope: Scope::Scene(7),
        code_version: "test".into(),
        config_hash: "c".into(),
        inputs: BTreeMap::new(),
        made_by: None,
    };
    let attempt = Attempt::start(store, identity, false)?;
    let Some(unit) = attempt.unit("vehicle_0")? else { return Ok(attempt.commit()?) };
    let progress = Progress::start(ProgressMode::None, "test".into(), 0);
    let counted = Some(COUNTS.to_owned());
    let labelled = Labelled { unit, scene: 7, agent: AgentId::vehicle(0), counted, label };
    runner::frames::write_labels([Ok(labelled)], FRAMES, &progress)?;
    Ok(attempt.commit()?)
}

#[test]
fn frames_come_back_in_order() {
    let store = Store::open("memory:").expect("is a place");
    let manifest = archive(&store, None).expect("writes");
    let mut reader =
        NpzReader::new(store.stream_output(&manifest, KEY).expect("opens")).expect("is an archive");
    assert_eq!(reader.members().len(), FRAMES as usize);
    for frame in [8, 0, 3] {
        assert_eq!(reader.read(&frame_member(frame)).expect("reads").bytes, grid(frame));
    }
    let key = "scenes/0007/bev_ids/vehicle_0.npz";
    let mut ids = NpzReader::new(store.stream_output(&manifest, key).expect("opens")).expect("is an archive");
    assert_eq!(ids.read(&frame_member(5)).expect("reads").bytes, [5]);
}

#[test]
fn frames_between_have_no_member() {
    let store = Store::open("memory:").expect("is a place");
    let manifest = write(&store, Grids { broken: None, every: 4, at_frame_6: 2 }).expect("writes");
    let mut reader =
        NpzReader::new(store.stream_output(&manifest, KEY).expect("opens")).expect("is an archive");
    assert_eq!(reader.members().collect::<Vec<_>>(), [0, 4, 8].map(frame_member));
    assert_eq!(reader.read(&frame_member(8)).expect("reads").bytes, grid(8));
    assert_eq!(manifest.outputs.iter().find(|o| o.key == KEY).map(|o| o.rows), Some(3));
    let counts: Vec<PartialRow> = store.read_rows(&manifest, COUNTS).expect("reads");
    assert_eq!(counts.iter().map(|row| row.bin).collect::<Vec<_>>(), [0, 4, 8]);
}

#[test]
fn a_full_store_is_nobodys_fault_but_the_disks() {
    let whole = Memory::default();
    archive(&Store::new(Arc::new(whole)), None).expect("writes");
    let mut full = 0;
    for room in (0..6000).step_by(211) {
        let store = Store::new(Arc::new(Memory::with_capacity(room)));
        let Err(error) = archive(&store, None) else { continue };
        full += 1;
        assert_eq!(error.exit_code(), runner::EXIT_TRY_AGAIN, "{error}");
        let StageError::Store(StoreError::Write { path, source, .. }) = &error else { panic!("{error:?}") };
        assert_eq!(source.kind(), std::io::ErrorKind::StorageFull);
        assert!(path.contains("vehicle_0") || path.contains("bev-gt"), "{path}");
        if room > 0 && room < 4000 {
            assert!(path.ends_with(KEY) || path.contains("/bev_ids/"), "{path}");
        }
        assert!(error.report().contains("make room"), "{}", error.report());
        let left = store.backend().keys("").expect("lists");
        assert!(left.iter().all(|key| !key.ends_with("bev-gt.json")), "{left:?}");
    }
    assert!(full > 15, "{full}");
}

#[test]
fn a_bad_frame_is_named() {
    let store = Store::open("memory:").expect("is a place");
    let error = archive(&store, Some(4)).expect_err("frame 4 is bad");
    assert_eq!(error.exit_code(), runner::EXIT_SOME_FAILED);
    assert_eq!(error.report(), "scene 7 frame 4: no such grid");
    assert!(store.backend().keys("").expect("lists").is_empty());
}

#[test]
fn an_array_too_few_or_too_many_is_an_error() {
    for (at_frame_6, file) in
        [(0, KEY), (1, "scenes/0007/bev_ids/vehicle_0.npz"), (3, "bev_ids/vehicle_0.npz")]
    {
        let store = Store::open("memory:").expect("is a place");
        let error = write(&store, Grids { broken: None, every: 1, at_frame_6 }).expect_err("is noticed");
        let report = error.report();
        assert!(report.contains(file) && report.contains("frame 6"), "{report}");
        assert!(
            report.contains(&format!("the label gave {at_frame_6} arrays for its 2 archives")),
            "{report}"
        );
        assert!(store.backend().keys("").expect("lists").is_empty());
    }
}
