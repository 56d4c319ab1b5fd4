//! How long predictions of 100,000 frames take, with reading:
//! `cargo bench -p convoy-evaluation --bench many_boxes [-- THREADS]`. The store and the file of predictions
//! are made up first, in a temporary folder.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use arrow_array::{ArrayRef, FixedSizeListArray, Float64Array, RecordBatch, StringArray, UInt32Array};
use arrow_schema::{DataType, Field};
use evaluation::{Breakdown, Plan, PredictionFile, Protocol, SeenBy, evaluate};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::file::properties::WriterProperties;
use scene::SceneReader;
use schema::scene_info::{AgentInfo, LOG_STAGE, SCENE_FILE, SceneInfo};
use schema::table::Row;
use schema::tables::{ActorRow, AgentRow, BoxRow, ValidBoxRow};
use schema::{AgentId, AgentKind, DetectionClass};
use store::{Attempt, Identity, Scope, Store, Unit, keys};

const SCENES: u32 = 50;
const FRAMES: u32 = 250;
const EGOS: u32 = 8;
/// Boxes of an ego at a frame, and what is predicted there: of each box one, and some of nothing.
const BOXES: u32 = 40;
const PREDICTIONS: u32 = 55;

#[expect(clippy::print_stdout, reason = "this is the benchmark's answer")]
fn main() -> Result<(), Box<dyn Error>> {
    let threads = std::env::args().filter_map(|arg| arg.parse().ok()).next().unwrap_or(2);
    let folder = tempfile::tempdir()?;
    let store = Store::open(folder.path().join("store"))?;
    let file = folder.path().join("predictions.parquet");
    write_store(&store)?;
    write_predictions(&file)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let stages = [LOG_STAGE, ValidBoxRow::STAGE];
    let readers = (0..SCENES).map(|scene| SceneReader::open(&store, scene, &stages));
    let readers = readers.collect::<Result<Vec<_>, _>>()?;
    println!("{:.1} MB of predictions, {threads} threads", std::fs::metadata(&file)?.len() as f64 * 1e-6);
    for (name, protocols) in [
        ("simbev2x", &[Protocol::SimBev2x][..]),
        ("nuscenes", &[Protocol::NuScenes]),
        ("opv2v", &[Protocol::Opv2v]),
        ("all", &Protocol::ALL),
    ] {
        let start = Instant::now();
        let opened = PredictionFile::open(&file)?;
        let plan = Plan {
            protocols,
            seen: SeenBy::Partners { range_m: 80.0, elevation_m: 4.8 },
            annotations: None,
            every_n_frames: None,
            extent: None,
            attributes_by_speed: false,
            worst_frames: None,
            breakdown: Breakdown::default(),
            is_ego: &|agent| agent.kind == AgentKind::Vehicle,
        };
        let result = pool.install(|| evaluate(&readers, &opened, &plan))?;
        println!(
            "{name}: {} samples, {} predictions in {:.1} s",
            result.counts.samples,
            result.counts.predictions,
            start.elapsed().as_secs_f64()
        );
    }
    Ok(())
}

/// The same numbers each time, 0 to 1.
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / f64::from(1 << 24)
    }
}

fn ego_m(frame: u32, ego: u32) -> [f64; 3] {
    [f64::from(frame) * 0.5, f64::from(ego) * 15.0, 0.0]
}

/// Where a box of an ego's list is: most are the same for all egos.
fn box_m(frame: u32, number: u32) -> [f64; 3] {
    let mut draws = Draws(u64::from(number) + 1);
    let mut across = || 120.0 * (draws.next() - 0.5);
    let (x, y) = (across(), across());
    [x + f64::from(frame) * 0.5, y + 50.0, 0.8]
}

fn class(number: u32) -> DetectionClass {
    use DetectionClass::{Bus, Car, Pedestrian, TrafficLight, Truck};
    [Car, Car, Car, Pedestrian, Pedestrian, Truck, Bus, TrafficLight][number as usize % 8]
}

fn write_store(store: &Store) -> Result<(), Box<dyn Error>> {
    let (mut agents, mut boxes, mut seen) = (Vec::new(), Vec::new(), Vec::new());
    let actors = (0..BOXES).map(|number| ActorRow { id: 100 + number as u16, ..ActorRow::default() });
    let actors: Vec<ActorRow> = actors.collect();
    for frame in 0..FRAMES {
        for ego in 0..EGOS {
            let agent = AgentId::vehicle(ego as u16).to_string();
            let (id, xyz_m) = (1 + ego as u16, ego_m(frame, ego));
            agents.push(AgentRow { frame, agent: agent.clone(), id, xyz_m, ..AgentRow::default() });
            for number in 0..BOXES {
                let id = 100 + number as u16;
                boxes.push(BoxRow {
                    frame,
                    agent: agent.clone(),
                    id,
                    class: class(number).name().into(),
                    center_m: box_m(frame, number),
                    size_m: [4.5, 1.9, 1.6],
                    ..BoxRow::default()
                });
                let points = (number + ego) % 3 * 7;
                seen.push(ValidBoxRow {
                    frame,
                    agent: agent.clone(),
                    id,
                    num_lidar_pts: points,
                    valid_flag: points > 0,
                    difficulty: ["easy", "medium", "hard"][number as usize % 3].into(),
                    ..ValidBoxRow::default()
                });
            }
        }
    }
    for scene in 0..SCENES {
        let info = SceneInfo {
            scene,
            frames: FRAMES,
            label_every_n_frames: 1,
            agents: (0..EGOS)
                .map(|ego| AgentInfo {
                    agent: AgentId::vehicle(ego as u16).to_string(),
                    ..AgentInfo::default()
                })
                .collect(),
            ..SceneInfo::default()
        };
        stage(store, scene, LOG_STAGE, |unit| {
            unit.bytes(&keys::scene(scene, SCENE_FILE), &serde_json::to_vec(&info)?, 1)?;
            table(unit, scene, &agents)?;
            table(unit, scene, &actors)?;
            table(unit, scene, &boxes)
        })?;
        stage(store, scene, ValidBoxRow::STAGE, |unit| table(unit, scene, &seen))?;
    }
    Ok(())
}

fn stage(
    store: &Store,
    scene: u32,
    name: &str,
    write: impl FnOnce(&mut Unit<'_>) -> Result<(), Box<dyn Error>>,
) -> Result<(), Box<dyn Error>> {
    let identity = Identity {
        stage: name.into(),
        scope: Scope::Scene(scene),
        code_version: "bench".into(),
        config_hash: "bench".into(),
        inputs: BTreeMap::new(),
        made_by: None,
    };
    let attempt = Attempt::start(store, identity, false)?;
    if let Some(mut unit) = attempt.unit("all")? {
        write(&mut unit)?;
        unit.finish()?;
    }
    attempt.commit()?;
    Ok(())
}

fn table<R: Row>(unit: &mut Unit<'_>, scene: u32, rows: &[R]) -> Result<(), Box<dyn Error>> {
    Ok(unit.rows(&keys::scene(scene, &format!("{}.parquet", R::TABLE)), rows)?)
}

/// As a model's would be: near the boxes, of any score, scene after scene.
fn write_predictions(path: &Path) -> Result<(), Box<dyn Error>> {
    let mut writer: Option<ArrowWriter<File>> = None;
    let mut draws = Draws(1);
    for scene in 0..SCENES {
        let (mut frames, mut agents, mut classes) = (Vec::new(), Vec::new(), Vec::new());
        let (mut scores, mut centers, mut sizes, mut turns) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for frame in 0..FRAMES {
            for ego in 0..EGOS {
                for number in 0..PREDICTIONS {
                    frames.push(frame);
                    agents.push(AgentId::vehicle(ego as u16).to_string());
                    classes.push(class(number).name());
                    scores.push(draws.next());
                    centers.extend(box_m(frame, number).map(|v| v + 2.0 * (draws.next() - 0.5)));
                    sizes.extend([4.5, 1.9, 1.6].map(|v| v + 0.2 * draws.next()));
                    turns.extend([1.0, 0.0, 0.0, 0.2 * draws.next()]);
                }
            }
        }
        let rows = frames.len();
        let lists = |values: Vec<f64>, length: i32| -> Result<ArrayRef, arrow_schema::ArrowError> {
            let item = Arc::new(Field::new("item", DataType::Float64, false));
            Ok(Arc::new(FixedSizeListArray::try_new(
                item,
                length,
                Arc::new(Float64Array::from(values)),
                None,
            )?))
        };
        let batch = RecordBatch::try_from_iter([
            ("scene", Arc::new(UInt32Array::from(vec![scene; rows])) as ArrayRef),
            ("frame", Arc::new(UInt32Array::from(frames))),
            ("agent", Arc::new(StringArray::from(agents))),
            ("class", Arc::new(StringArray::from(classes))),
            ("score", Arc::new(Float64Array::from(scores))),
            ("center_m", lists(centers, 3)?),
            ("size_m", lists(sizes, 3)?),
            ("quaternion", lists(turns, 4)?),
        ])?;
        let new = || {
            let as_pyarrow_does = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
            ArrowWriter::try_new(File::create(path)?, batch.schema(), Some(as_pyarrow_does))
        };
        let to = match &mut writer {
            Some(writer) => writer,
            None => writer.insert(new()?),
        };
        to.write(&batch)?;
    }
    if let Some(writer) = writer {
        writer.close()?;
    }
    Ok(())
}
