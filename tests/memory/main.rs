//! Stages hold a few frames at a time, whatever the scene's length: no more memory for many frames than for
//! some.
//!
//! One test in a program of its own: the allocator counts for all threads.

use std::collections::BTreeMap;

use codecs::Scalar;
use labels::voxels::{CpuVoxelRenderer, GridPlacement, Wanted};
use peak_alloc::PeakAlloc;
use rayon::ThreadPoolBuilder;
use render::VoxelRenderer;
use runner::frames::{FrameArray, FrameArrays, FrameGroup, Labelled, Writer, in_turn};
use runner::{Progress, ProgressMode, StageError};
use schema::arrays::{ArrayKind, BEV_MASKS};
use schema::measures::counts::PartialCounts;
use schema::tables::LidarRow;
use schema::{AgentId, Tag};
use settings::OccupancySettings;
use store::{Attempt, EncodedGroup, GroupEncoder, Identity, Scope, Store, TableOptions, TableWriter, Unit};
use testkit::{WorldBuilder, sheet};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

const THREADS: usize = 2;
const SOME: u32 = 20;
const MANY: u32 = 300;
const FRAME_BYTES: usize = 256 << 10;

/// Bytes that do not compress.
fn noise(frame: u32) -> impl Iterator<Item = u32> {
    let mut state = u64::from(frame) + 1;
    std::iter::repeat_with(move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 32) as u32
    })
}

/// Masks and voxel grids are written so.
struct Grids;

impl FrameArrays for Grids {
    type Memory = Vec<u8>;

    fn memory(&self) -> Result<Vec<u8>, StageError> {
        Ok(vec![0; FRAME_BYTES])
    }

    fn every_n_frames(&self) -> u32 {
        1
    }

    fn kinds(&self) -> Vec<&'static ArrayKind> {
        vec![&BEV_MASKS]
    }

    fn arrays<'m>(
        &self,
        memory: &'m mut Vec<u8>,
        frame: u32,
        _: &mut PartialCounts,
    ) -> Result<Vec<FrameArray<'m>>, StageError> {
        memory.iter_mut().zip(noise(frame)).for_each(|(byte, word)| *byte = word as u8);
        Ok(vec![FrameArray { scalar: Scalar::U8, shape: vec![FRAME_BYTES], bytes: memory.as_slice().into() }])
    }
}

/// An array a frame.
fn arrays(attempt: &Attempt, frames: u32) -> Result<(), StageError> {
    let unit = attempt.unit("vehicle_0")?.expect("is not there yet");
    let progress = Progress::start(ProgressMode::None, "test".into(), 0);
    let labelled = Labelled { unit, scene: 0, agent: AgentId::vehicle(0), counted: None, label: Grids };
    runner::frames::write_labels([Ok(labelled)], frames, &progress)
}

/// The table of a lidar.
struct Sweeps<'u> {
    unit: Unit<'u>,
    table: TableWriter<LidarRow>,
}

impl Writer<Vec<EncodedGroup>> for Sweeps<'_> {
    fn take(&mut self, _: u32, groups: Vec<EncodedGroup>) -> Result<(), StageError> {
        Ok(groups.into_iter().try_for_each(|group| self.table.append(group))?)
    }

    fn finish(self) -> Result<(), StageError> {
        let Self { mut unit, table } = self;
        unit.add(table.finish()?);
        Ok(unit.finish()?)
    }
}

/// A row group a frame, as sensors are written.
fn tables(attempt: &Attempt, frames: u32) -> Result<(), StageError> {
    let unit = attempt.unit("vehicle_0")?.expect("is not there yet");
    let options = TableOptions::compressed_frames(Vec::new());
    let table = unit.table::<LidarRow>("scenes/0000/sensors/vehicle_0/LIDAR.parquet", options)?;
    let progress = Progress::start(ProgressMode::None, "test".into(), 0);
    let points = FRAME_BYTES / 16;
    let sense = |encoder: &GroupEncoder<LidarRow>, frame: u32| {
        let column = |k: u32| noise(4 * frame + k).map(|word| word as f32).take(points).collect();
        let [x, y, z, intensity] = std::array::from_fn(|k| column(k as u32));
        Ok(encoder.encode(&[LidarRow { frame, x, y, z, intensity, ..LidarRow::default() }])?)
    };
    let part =
        FrameGroup { due: (0..frames).collect(), seen: table.encoder(), writer: Sweeps { unit, table } };
    in_turn([Ok(part)], frames, &progress, sense)
}

/// Most bytes that were allocated at a time, beyond those from before.
fn peak(frames: u32, write: fn(&Attempt, u32) -> Result<(), StageError>) -> usize {
    let folder = tempfile::tempdir().expect("a folder");
    let store = Store::open(folder.path()).expect("is a folder");
    let identity = Identity {
        stage: "test".into(),
        scope: Scope::Scene(0),
        code_version: "test".into(),
        config_hash: "c".into(),
        inputs: BTreeMap::new(),
        made_by: None,
    };
    let attempt = Attempt::start(&store, identity, false).expect("starts");
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    write(&attempt, frames).expect("writes");
    MEMORY.peak_usage() - before
}

#[test]
fn frames_are_not_gathered() {
    let pool = ThreadPoolBuilder::new().num_threads(THREADS).build().expect("threads");
    for (name, write) in [("arrays", arrays as fn(&Attempt, u32) -> _), ("tables", tables)] {
        // What is made once and kept.
        pool.install(|| peak(1, write));
        let [some, many] = [SOME, MANY].map(|frames| pool.install(|| peak(frames, write)));
        // A table keeps what it says of each row group: a few kilobytes.
        let gathered = (MANY - SOME) as usize * FRAME_BYTES;
        assert!(many < some + gathered / 20, "{name}: {some} bytes for {SOME} frames, {many} for {MANY}");
        assert!(some < THREADS * 12 * FRAME_BYTES, "{name}: {some} bytes");
    }
    pool.install(a_fine_grid_is_never_whole);
}

/// 6,400 x 6,400 x 400 cells of 2 cm, a million of them occupied: eight slices of the grid a thread, and what
/// is listed.
fn a_fine_grid_is_never_whole() {
    let mut world = WorldBuilder::default();
    world.add(sheet(Tag::Road, [-10.0, 10.0], [-10.0, 10.0], 1.0, |x, _| 0.02 * x), 1, [0.0; 3], [0.0; 3]);
    let snapshot = world.snapshot([0.0; 3]);
    let settings = OccupancySettings { voxel_m: 0.02, sparse: true, ..OccupancySettings::default() };
    let mut renderer = CpuVoxelRenderer::default();
    renderer.prepare(&snapshot.meshes).expect("has no device");
    let placement = GridPlacement::new(&settings).expect("is possible");
    let here = frames::Pose::from_xyz_rpy([0.0; 3], [0.0, 0.0, 0.3]);
    let block = placement.block(&snapshot.origin, &here, None);
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let wanted = Wanted { places: true, ..Wanted::default() };
    let rows = renderer.cell_rows(&snapshot, &block, wanted).expect("is prepared");
    let peak = MEMORY.peak_usage() - before;
    assert!(rows.counts[Tag::Road as usize] > 1_000_000 && rows.places.len() > 8_000_000);
    let slab = 8 * 6400 * (400 * size_of::<u32>() + size_of::<[usize; 2]>());
    assert!(peak < THREADS * slab + 6 * rows.places.len(), "{peak} bytes");
}
