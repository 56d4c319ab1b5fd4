//! The files of an agent in a scene.

use std::collections::BTreeSet;

use codecs::images::{ImageError, Limits, Pixels, PngStyle, decode_png, encode_png};
use frames::{Agent, Pose, Sensor, World};
use scene::{ArrayReader, BoxFrames, LabelledBox, SensorEntry, SensorFrames};
use schema::arrays::BEV_MASKS;
use schema::table::{Framed, Row};
use schema::tables::{AgentRow, CameraRow};
use schema::{AgentId, AgentKind};
use serde_json::Value;

use super::beams::Rings;
use super::bev::{Mask, RoadChannel, lane_picture, place};
use super::clouds::Sweep;
use super::finish::Fragment;
use super::handedness::{LeftPose, left, left_matrix, left_pose};
use super::lanes::LaneLines;
use super::options::{Options, Variant, scenario, split_of};
use super::record::{map, number, numbers, to_json, to_yaml};
use super::roster::{AgentRoster, CameraPair, Member, StandIns, agent_from_camera, agent_from_stand_in};
use super::vehicles::{kmh, listed, listed_class};
use crate::picture::{grey_png, png_of_jpeg};
use crate::{ExportError, SceneSource, UnitFiles};

/// Frames that a trajectory looks ahead.
const TRAJECTORY: usize = 10;
/// Beams of the thinned clouds.
const THINNED: [u16; 2] = [32, 16];
/// Horizontal field of view that cameras have which stand in, degrees: that of the original rig.
const STAND_IN_FOV_DEG: f64 = 100.0;

/// Writes all frames of a member; what of it the end must know.
pub(super) fn write(
    scene: &SceneSource,
    roster: &AgentRoster,
    (member, stand_ins): (&Member, Option<StandIns>),
    options: &Options,
    files: &mut UnitFiles<'_>,
) -> Result<Vec<u8>, ExportError> {
    let mut unit = Unit::open(scene, roster, (member, stand_ins), options)?;
    let mut most_boxes = 0;
    for frame in roster.frames(scene) {
        most_boxes = most_boxes.max(unit.frame(frame, files)?);
        files.advance(1)?;
    }
    let info = scene.info();
    Fragment {
        split: info.split.clone(),
        map: info.map.clone(),
        agent: member.agent.to_string(),
        name: member.name,
        frames: roster.frames(scene).count() as u32,
        every_n_frames: roster.every_n_frames,
        most_boxes: most_boxes as u32,
        is_thinned: member.is_thinned(),
        camera_px: member.cameras.as_ref().map(|cameras| cameras[0].size_px()),
    }
    .to_bytes()
}

/// Bytes and seconds of one core of a member's frame, about.
pub(super) fn cost(scene: &SceneSource, member: &Member, variant: Variant) -> [f64; 2] {
    let sweeps = schema::rate::count(scene.info().frames, member.lidar.about.every_n_frames).max(1);
    // A point takes some 15 bytes in the store, 16 in a cloud; half and a quarter of them stand in thinned
    // ones.
    let cloud = 1.1 * member.lidar.bytes as f64 / f64::from(sweeps);
    let pictures = member.cameras.iter().flatten().map(|camera| {
        let [width, height] = camera.size_px().map(f64::from);
        let depth = if camera.depth.is_some() && variant == Variant::Opv2v { 1.0 } else { 0.0 };
        [width * height * (1.1 + 0.05 * depth), width * height * (40e-9 + 10e-9 * depth)]
    });
    let pictures = pictures.fold([0.0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]]);
    let copies = if variant == Variant::Opv2v && member.is_thinned() { 1.75 } else { 1.0 };
    [copies * cloud + pictures[0] + 2e4, pictures[1] + 1e-8 * cloud + 5e-3]
}

/// What the pictures from above are made of.
struct Above {
    road: Option<(RoadChannel, ArrayReader)>,
    lanes: Option<LaneLines>,
}

/// Where a camera is on its agent (it looks forward), and its intrinsics.
type MountedLens = (Pose<Agent, Sensor>, [[f64; 3]; 3]);

/// A member, frame by frame.
struct Unit<'a> {
    scene: &'a SceneSource,
    roster: &'a AgentRoster,
    member: &'a Member,
    options: &'a Options,
    /// Where the members are, by member and frame.
    tracks: Vec<Vec<AgentRow>>,
    own: usize,
    sweeps: SensorFrames<Sweep>,
    pictures: Vec<SensorFrames<CameraRow>>,
    depths: Vec<Option<SensorFrames<CameraRow>>>,
    boxes: BoxFrames,
    above: Option<Above>,
    /// Where it has no four cameras of its own.
    stand_ins: Option<StandIns>,
}

impl<'a> Unit<'a> {
    fn open(
        scene: &'a SceneSource,
        roster: &'a AgentRoster,
        (member, stand_ins): (&'a Member, Option<StandIns>),
        options: &'a Options,
    ) -> Result<Self, ExportError> {
        let mut rows = scene.agent_rows()?;
        let mut tracks = Vec::new();
        for other in &roster.members {
            let at = scene.agents().iter().position(|agent| *agent == other.agent);
            tracks.push(at.map(|at| std::mem::take(&mut rows[at])).unwrap_or_default());
        }
        let own = roster.members.iter().position(|other| other.agent == member.agent).unwrap_or(0);
        let (mut pictures, mut depths) = (Vec::new(), Vec::new());
        for CameraPair { color, depth } in member.cameras.iter().flatten() {
            pictures.push(scene.readings(member.agent, color)?);
            let depth = depth.as_ref().filter(|_| options.variant == Variant::Opv2v);
            depths.push(depth.map(|depth| scene.readings(member.agent, depth)).transpose()?);
        }
        Ok(Self {
            scene,
            roster,
            member,
            options,
            tracks,
            own,
            sweeps: scene.readings(member.agent, &member.lidar)?,
            pictures,
            depths,
            boxes: scene.boxes_of_all()?,
            stand_ins,
            above: (options.variant == Variant::Opv2v)
                .then(|| Above::open(scene, roster, member.agent))
                .transpose()?,
        })
    }

    /// Writes a frame; how many objects it lists.
    fn frame(&mut self, frame: u32, files: &mut UnitFiles<'_>) -> Result<usize, ExportError> {
        let split = split_of(&self.scene.info().split);
        let place = format!("{split}/{}/{}/{frame:06}", scenario(self.scene.number()), self.member.name);
        let main = format!("{}/{place}", self.options.variant.folder());
        let boxes = self.boxes.at(frame)?;
        let (record, listed) = self.record(frame, &boxes);
        files.put(&format!("{main}.yaml"), &to_yaml(&record))?;
        files.put(&format!("{main}.json"), &to_json(&record))?;
        let wrong = |problem| content(self.scene, self.member, frame, problem);
        let mut sweep = reading(&mut self.sweeps, frame, &self.member.lidar, wrong)?;
        match self.options.variant {
            Variant::V2xReal => files.put(&format!("{main}.bin"), &sweep.to_bin())?,
            Variant::Opv2v => {
                files.put(&format!("{main}.pcd"), &sweep.to_pcd(1))?;
                if let Rings::Told(beams) = &self.member.rings {
                    sweep.ring = beams.rings(&sweep);
                }
                let is_thinned = self.member.is_thinned();
                for beams in THINNED.into_iter().filter(|_| is_thinned) {
                    let name = format!("OPV2V_Hetero/{place}_{beams}.pcd");
                    files.put(&name, &sweep.to_pcd(sweep.thinning(beams)))?;
                }
                self.pictures_from_above(frame, &boxes, &main, files)?;
            }
        }
        self.camera_pictures(frame, &main, &format!("OPV2V_Hetero/{place}"), files)?;
        Ok(listed)
    }

    /// Where a member is.
    fn world_from_agent(&self, member: usize, frame: u32) -> Pose<World, Agent> {
        let row = &self.tracks[member][frame as usize];
        Pose::from_xyz_wxyz(row.xyz_m, row.quaternion)
    }

    fn world_from_lidar(&self, member: usize, frame: u32) -> Pose<World, Sensor> {
        let lidar = &self.roster.members[member].lidar;
        self.world_from_agent(member, frame) * lidar.about.agent_from_sensor.agent_from_sensor()
    }

    /// What a frame's YAML says, and how many objects are listed in it.
    fn record(&self, frame: u32, boxes: &[LabelledBox]) -> (Value, usize) {
        let (row, is_rsu) =
            (&self.tracks[self.own][frame as usize], self.member.agent.kind == AgentKind::Rsu);
        let lidars: Vec<LeftPose> =
            (0..self.tracks.len()).map(|member| left_pose(&self.world_from_lidar(member, frame))).collect();
        let vehicles = listed(self.own_boxes(boxes), self.options, &lidars);
        let pose = numbers(left_pose(&self.world_from_agent(self.own, frame)));
        let speed = if is_rsu { 0.0 } else { kmh(row.velocity_mps) };
        let mut entries = vec![
            ("lidar_pose".to_owned(), numbers(lidars[self.own])),
            ("true_ego_pos".into(), pose.clone()),
            ("predicted_ego_pos".into(), pose),
            ("ego_speed".into(), number(speed)),
            (
                "plan_trajectory".into(),
                if is_rsu { Value::Array(Vec::new()) } else { self.trajectory(frame) },
            ),
            ("RSU".into(), is_rsu.into()),
        ];
        let world_from_lidar = self.world_from_lidar(self.own, frame);
        for (number, (agent_from_camera, intrinsic)) in self.lenses().into_iter().enumerate() {
            let world_from_camera = self.world_from_agent(self.own, frame) * agent_from_camera;
            let extrinsic = left_matrix(&(world_from_camera.inverse() * world_from_lidar));
            let fields = [
                ("cords", numbers(left_pose(&world_from_camera))),
                ("extrinsic", matrix([0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|at| extrinsic[(row, at)])))),
                ("intrinsic", matrix(intrinsic)),
            ];
            entries.push((format!("camera{number}"), map(fields)));
        }
        let listed = vehicles.len();
        entries.push(("vehicles".into(), map(vehicles)));
        (map(entries), listed)
    }

    /// Where the four cameras are on the agent, and their intrinsics.
    fn lenses(&self) -> Vec<MountedLens> {
        if let Some(StandIns { size_px, .. }) = self.stand_ins {
            let [width, height] = size_px.map(f64::from);
            let (sin, cos) = frames::math::sin_cos(0.5 * frames::deg(STAND_IN_FOV_DEG));
            let focal_px = 0.5 * width * cos / sin;
            let intrinsic = [[focal_px, 0.0, 0.5 * width], [0.0, focal_px, 0.5 * height], [0.0, 0.0, 1.0]];
            return (0..4).map(|n| (agent_from_stand_in(&self.member.lidar, n), intrinsic)).collect();
        }
        let cameras = self.member.cameras.iter().flatten();
        let lens = |CameraPair { color, .. }: &CameraPair| {
            (agent_from_camera(color), color.about.intrinsics.unwrap_or_default())
        };
        cameras.map(lens).collect()
    }

    /// Where the agent will be, and how fast: x, y, km/h of the next exported frames.
    fn trajectory(&self, frame: u32) -> Value {
        let track = &self.tracks[self.own];
        let ahead = (1..=TRAJECTORY).map(|step| frame as usize + step * self.roster.every_n_frames as usize);
        let points = ahead.map_while(|at| track.get(at)).map(|row| {
            let [x, y, _] = left(row.xyz_m);
            numbers([x, y, kmh(row.velocity_mps)])
        });
        Value::Array(points.collect())
    }

    /// The boxes of the agent's own list, but for itself.
    fn own_boxes<'b>(&self, boxes: &'b [LabelledBox]) -> impl Iterator<Item = &'b LabelledBox> + use<'b> {
        let (agent, id) = (self.member.agent.to_string(), self.member.id);
        boxes.iter().filter(move |labelled| labelled.raw.agent == agent && labelled.raw.id != id)
    }

    fn camera_pictures(
        &mut self,
        frame: u32,
        main: &str,
        hetero: &str,
        files: &mut UnitFiles<'_>,
    ) -> Result<(), ExportError> {
        let wrong = |problem| content(self.scene, self.member, frame, problem);
        let of = |sensor: &SensorEntry, error: ImageError| wrong(format!("{}: {error}", sensor.name));
        if let Some(StandIns { size_px, have_depths }) = self.stand_ins {
            let grey = vec![0; size_px[0] as usize * size_px[1] as usize];
            let rgb = vec![0; 3 * grey.len()];
            let bad = |error: ImageError| wrong(format!("pictures that stand in: {error}"));
            let black = encode_png(size_px, &Pixels::Rgb(&rgb), PngStyle::FLAT).map_err(bad)?;
            let near = grey_png(size_px, &grey).map_err(bad)?;
            for number in 0..4 {
                files.put(&format!("{main}_camera{number}.png"), &black)?;
                if have_depths {
                    files.put(&format!("{hetero}_depth{number}.png"), &near)?;
                }
            }
            return Ok(());
        }
        let cameras = self.member.cameras.iter().flatten();
        for (number, CameraPair { color, depth }) in cameras.enumerate() {
            let row = reading(&mut self.pictures[number], frame, color, wrong)?;
            let png = png_of_jpeg(&row.image.0).map_err(|error| of(color, error))?;
            files.put(&format!("{main}_camera{number}.png"), &png)?;
            let (Some(rows), Some(depth)) = (&mut self.depths[number], depth) else { continue };
            let row = reading(rows, frame, depth, wrong)?;
            let png = depth_png(&row.image.0).map_err(|error| of(depth, error))?;
            files.put(&format!("{hetero}_depth{number}.png"), &png)?;
        }
        Ok(())
    }

    fn pictures_from_above(
        &mut self,
        frame: u32,
        boxes: &[LabelledBox],
        main: &str,
        files: &mut UnitFiles<'_>,
    ) -> Result<(), ExportError> {
        let world_from_agent = self.world_from_agent(self.own, frame);
        let by_own = self.seen_by(self.own, boxes);
        let by_any: BTreeSet<u16> =
            (0..self.roster.members.len()).flat_map(|member| self.seen_by(member, boxes)).collect();
        let drawn = |wanted: &dyn Fn(u16) -> bool| {
            let mut mask = Mask::new();
            let shown = |labelled: &&LabelledBox| {
                wanted(labelled.raw.id) && listed_class(&labelled.raw, self.options).is_some()
            };
            for LabelledBox { raw, .. } in self.own_boxes(boxes).filter(shown) {
                let corners = raw.corners_m.as_chunks::<3>().0;
                mask.fill(frames::FOOTPRINT_LOOP.map(|corner| place(&world_from_agent, corners[corner])));
            }
            mask
        };
        let mut masks = vec![
            ("dynamic", drawn(&|_| true)),
            ("visibility", drawn(&|id| by_own.contains(&id))),
            ("visibility_corp", drawn(&|id| by_any.contains(&id))),
        ];
        if let Some(above) = &mut self.above {
            let wrong = |problem| content(self.scene, self.member, frame, problem);
            masks.extend(above.masks(frame, &world_from_agent, wrong)?);
        }
        for (kind, mask) in masks {
            let png =
                mask.to_png().map_err(|error| content(self.scene, self.member, frame, error.to_string()))?;
            files.put(&format!("{main}_bev_{kind}.png"), &png)?;
        }
        Ok(())
    }

    /// The objects that a member sees.
    fn seen_by(&self, member: usize, boxes: &[LabelledBox]) -> BTreeSet<u16> {
        let member = &self.roster.members[member];
        let agent = member.agent.to_string();
        let sees = |labelled: &&LabelledBox| {
            labelled.raw.agent == agent
                && labelled.seen.as_ref().is_some_and(|seen| match member.pixels_every_n_frames {
                    Some(_) => seen.num_pixels > 0,
                    None => seen.num_lidar_pts > 0,
                })
        };
        boxes.iter().filter(sees).map(|labelled| labelled.raw.id).collect()
    }
}

impl Above {
    fn open(scene: &SceneSource, roster: &AgentRoster, agent: AgentId) -> Result<Self, ExportError> {
        let store = scene.reader().store();
        let road = RoadChannel::read(store)?.ok();
        let has = |road: &RoadChannel| {
            scene.has_arrays(&BEV_MASKS, agent)
                && roster.every_n_frames.is_multiple_of(road.every_n_frames.max(1))
        };
        let road = match road.filter(has) {
            Some(road) => Some((road, scene.arrays(&BEV_MASKS, agent)?)),
            None => None,
        };
        Ok(Self { road, lanes: LaneLines::read(store, &scene.info().map)? })
    }

    /// The pictures of the ground of a frame, as far as the store knows it.
    fn masks(
        &mut self,
        frame: u32,
        world_from_agent: &Pose<World, Agent>,
        wrong: impl Fn(String) -> ExportError,
    ) -> Result<Vec<(&'static str, Mask)>, ExportError> {
        let mut masks = Vec::new();
        if let Some((road, arrays)) = &mut self.road {
            let mask = road.picture(&arrays.read(frame)?);
            masks.push(("static", mask.map_err(|problem| wrong(format!("{}: {problem}", arrays.path())))?));
        }
        masks.extend(self.lanes.iter().map(|lanes| ("lane", lane_picture(lanes, world_from_agent))));
        Ok(masks)
    }
}

/// What is wrong with a frame of an agent.
fn content(scene: &SceneSource, member: &Member, frame: u32, problem: String) -> ExportError {
    let agent = Some(member.agent.to_string());
    ExportError::Content { scene: scene.number(), frame: Some(frame), agent, problem }
}

/// A sensor's reading of a frame, which it must have.
fn reading<R: Row + Framed>(
    frames: &mut SensorFrames<R>,
    frame: u32,
    sensor: &SensorEntry,
    wrong: impl Fn(String) -> ExportError,
) -> Result<R, ExportError> {
    let missing = || wrong(format!("{} has no reading: run `convoy verify` on the store", sensor.name));
    frames.at(frame)?.ok_or_else(missing)
}

/// Rows of a matrix.
fn matrix<const R: usize, const C: usize>(rows: [[f64; C]; R]) -> Value {
    Value::Array(rows.map(numbers).to_vec())
}

/// Depth in whole metres, up to 255, as a grey picture.
fn depth_png(png: &[u8]) -> Result<Vec<u8>, ImageError> {
    let picture = decode_png(png, Limits::SENSOR)?;
    let metres = |rgb: &[u8; 3]| {
        let code = u32::from_le_bytes([rgb[0], rgb[1], rgb[2], 0]);
        (1000.0 * f64::from(code) / f64::from((1 << 24) - 1)).round().min(255.0) as u8
    };
    let grey: Vec<u8> = picture.rgb.as_chunks::<3>().0.iter().map(metres).collect();
    grey_png([picture.width, picture.height], &grey)
}
