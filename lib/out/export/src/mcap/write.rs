//! The file of a scene.

use std::collections::BTreeMap;

use rayon::prelude::*;
use scene::{SensorEntry, SensorKind};
use schema::arrays::BEV_MASKS;
use schema::table::Row;
use schema::tables::{CameraRow, TrackFrameRow};
use schema::{AgentId, FORMAT_VERSION, FRAME_PERIOD_S, ImageKind};
use store::keys;

use super::chunk::{Chunk, Messages};
use super::clock::{EPOCH_S, time_ns};
use super::container::McapWriter;
use super::map::lines_near;
use super::messages::SceneUpdate;
use super::options::McapOptions;
use super::topics::{Topic, Topics};
use super::tracks::Track;
use super::tracks::clouds::{LidarTrack, RadarTrack};
use super::tracks::depths::DepthTrack;
use super::tracks::masks::MaskTrack;
use super::tracks::merged::MergedTrack;
use super::tracks::motion::{MotionTrack, ReadingTrack};
use super::tracks::pictures::{CameraTrack, topic_of};
use super::tracks::seen::BoxTrack;
use super::tracks::voxels::VoxelTrack;
use crate::{ExportError, SceneSource, UnitFiles};

/// The name of the program that writes: no version, so that files of the same content are the same.
const LIBRARY: &str = "convoy";

type Tracks = Vec<Box<dyn Track>>;

/// Writes the file of a scene.
///
/// # Errors
/// The store cannot be read, the destination not be written, or a signal came.
pub(crate) fn scene(
    scene: &SceneSource,
    options: McapOptions,
    files: &mut UnitFiles<'_>,
) -> Result<(), ExportError> {
    let mut topics = Topics::default();
    let mut tracks = open(scene, options, &mut topics)?;
    let name = format!("{}/scene_{:04}.mcap", scene.info().split, scene.number());
    let mut file = files.create(&name)?;
    let path = std::path::PathBuf::from(&name);
    let failed = |source| ExportError::Write { path: path.clone(), action: "write", source };
    let mut writer =
        McapWriter::new(&mut file, LIBRARY, &topics.schemas, &topics.channels).map_err(failed)?;
    writer.metadata("convoy", &facts(scene)).map_err(failed)?;
    let info = scene.reader().store().read(&keys::scene(scene.number(), schema::scene_info::SCENE_FILE))?;
    if let Some(info) = info {
        writer.attachment("scene.json", "application/json", time_ns(0), &info).map_err(failed)?;
    }
    let agents = scene.agents().len() as u64;
    for frame in scene.frames() {
        let chunks: Vec<Result<Option<Chunk>, ExportError>> =
            tracks.par_iter_mut().map(|track| chunk(track.as_mut(), frame)).collect();
        for chunk in chunks {
            if let Some(chunk) = chunk? {
                writer.chunk(&chunk).map_err(failed)?;
            }
        }
        files.advance(agents)?;
    }
    writer.finish().map_err(failed)?;
    files.add(file)
}

/// A track's messages of a frame.
fn chunk(track: &mut dyn Track, frame: u32) -> Result<Option<Chunk>, ExportError> {
    let mut messages = Messages::default();
    track.messages(frame, &mut messages)?;
    if messages.is_empty() {
        return Ok(None);
    }
    let chunk = messages.into_chunk(track.compression());
    let chunk = chunk.map_err(|e| ExportError::Refused(format!("frame {frame} cannot be compressed: {e}")));
    chunk.map(Some)
}

/// What the file says of its scene.
fn facts(scene: &SceneSource) -> BTreeMap<String, String> {
    let info = scene.info();
    [
        ("scene", info.scene.to_string()),
        ("split", info.split.clone()),
        ("map", info.map.clone()),
        ("geo_reference", info.geo_reference.clone()),
        ("seed", info.seed.to_string()),
        ("frames", info.frames.to_string()),
        ("frame_period_s", FRAME_PERIOD_S.to_string()),
        ("frame_0_s", EPOCH_S.to_string()),
        ("format_version", FORMAT_VERSION.to_string()),
    ]
    .into_iter()
    .map(|(key, value)| (key.to_owned(), value))
    .collect()
}

/// Opens the tracks of a scene, in the order in which their chunks are written.
fn open(scene: &SceneSource, options: McapOptions, topics: &mut Topics) -> Result<Tracks, ExportError> {
    let mut sensors = Vec::new();
    for agent in scene.agents() {
        let own = if scene.has(CameraRow::STAGE) { scene.sensors(*agent)? } else { Vec::new() };
        sensors.push((*agent, own));
    }
    let poses = scene.agent_rows()?;
    let lifetime_frames = lifetime(scene);
    let mut common: Tracks = vec![Box::new(MotionTrack::open(scene, &sensors, topics)?)];
    let first_frame = scene.frames().next().unwrap_or(0);
    common.push(Box::new(MapTrack {
        topic: topics.add("/map".into(), &[])?,
        lines: Some(lines_near(scene, &poses, first_frame)?),
    }));
    if scene.has(TrackFrameRow::STAGE) {
        common.push(Box::new(MergedTrack::open(scene, lifetime_frames, topics)?));
    }
    let mut tracks: Tracks = vec![Box::new(Together(common))];
    for ((agent, own), poses) in sensors.iter().zip(poses) {
        let mut small: Tracks = vec![Box::new(BoxTrack::open(scene, *agent, lifetime_frames, topics)?)];
        sensor_tracks(scene, *agent, own, options, topics, (&mut small, &mut tracks))?;
        tracks.push(Box::new(Together(small)));
        if scene.has_arrays(&BEV_MASKS, *agent) {
            tracks.push(Box::new(MaskTrack::open(scene, *agent, poses, topics)?));
        }
        if options.voxel_range_m > 0.0 {
            let crop = (options.voxel_range_m, options.voxel_block);
            if let Some(track) = VoxelTrack::open(scene, *agent, crop, topics)? {
                tracks.push(Box::new(track));
            }
        }
    }
    Ok(tracks)
}

/// Opens the tracks of an agent's sensors: those with a few numbers a frame, and those that are worth a chunk
/// of their own.
fn sensor_tracks(
    scene: &SceneSource,
    agent: AgentId,
    sensors: &[SensorEntry],
    options: McapOptions,
    topics: &mut Topics,
    (small, large): (&mut Tracks, &mut Tracks),
) -> Result<(), ExportError> {
    let mut cameras: BTreeMap<&str, Vec<(&SensorEntry, ImageKind)>> = BTreeMap::new();
    for sensor in sensors {
        match sensor.kind {
            SensorKind::Lidar | SensorKind::SemanticLidar => {
                large.push(Box::new(LidarTrack::open(scene, agent, sensor, topics)?));
            }
            SensorKind::Radar => small.push(Box::new(RadarTrack::open(scene, agent, sensor, topics)?)),
            SensorKind::Gnss | SensorKind::Imu => {
                if let Some(track) = ReadingTrack::open(scene, agent, sensor, topics)? {
                    small.push(Box::new(track));
                }
            }
            SensorKind::Image(kind) => {
                let is_written = topic_of(kind).is_some() || (options.depth && kind == ImageKind::Depth);
                if let Some(camera) = sensor.camera().filter(|_| is_written) {
                    cameras.entry(camera).or_default().push((sensor, kind));
                }
            }
        }
    }
    for (camera, tables) in cameras {
        for (sensor, _) in tables.iter().filter(|(_, kind)| *kind == ImageKind::Depth) {
            large.push(Box::new(DepthTrack::open(scene, agent, camera, sensor, topics)?));
        }
        if let Some(track) = CameraTrack::open(scene, agent, camera, &tables, topics)? {
            large.push(Box::new(track));
        }
    }
    Ok(())
}

/// For how many frames a box is drawn: until the next frame with labels that is exported.
fn lifetime(scene: &SceneSource) -> u32 {
    let every = scene.info().label_every_n_frames.max(1);
    let mut frames = scene.frames().filter(|frame| schema::rate::is_due(*frame, every));
    match (frames.next(), frames.next()) {
        (Some(first), Some(second)) => second - first,
        _ => every,
    }
}

/// Several tracks in one chunk.
struct Together(Tracks);

impl Track for Together {
    fn messages(&mut self, frame: u32, out: &mut Messages) -> Result<(), ExportError> {
        self.0.iter_mut().try_for_each(|track| track.messages(frame, out))
    }
}

/// The map, once.
struct MapTrack {
    topic: Topic<SceneUpdate>,
    lines: Option<SceneUpdate>,
}

impl Track for MapTrack {
    fn messages(&mut self, frame: u32, out: &mut Messages) -> Result<(), ExportError> {
        if let Some(lines) = self.lines.take() {
            self.topic.send(frame, &lines, out);
        }
        Ok(())
    }
}
