//! An agent of a scene: a sequence of the tracking benchmark, and its frames in the object benchmark.

use frames::{Agent, Pose, World};
use scene::SensorKind;
use scene::{FrameRanges, SensorFrames, agent_rows};
use schema::AgentId;
use schema::tables::{AgentRow, BOXES_2D_TABLE, Box2dRow, CameraRow, GnssRow, ImuRow};

use super::pair::{MOST, Pair, Sequence};
use super::{calib, label};
use crate::picture::png_of_jpeg;
use crate::{ExportError, SceneSource, UnitFiles};

schema::columns! {
    /// Points with their intensity.
    Cloud of schema::tables::LidarRow { frame: u32, x: Vec<f32>, y: Vec<f32>, z: Vec<f32>, intensity: Vec<f32> }
}
schema::framed!(Cloud);

/// Name of a frame in the object benchmark.
pub(super) fn object_name(scene: u32, number: u32) -> String {
    format!("{:06}", MOST * scene + number)
}

/// Writes the sequence of an agent.
pub(super) fn write(
    scene: &SceneSource,
    agent: AgentId,
    pair: &Pair,
    files: &mut UnitFiles<'_>,
) -> Result<Sequence, ExportError> {
    let number = scene.number();
    let content = |frame: u32, problem: String| ExportError::Content {
        scene: number,
        frame: Some(frame),
        agent: Some(agent.to_string()),
        problem,
    };
    let frames = pair.frames(scene);
    let poses = own_rows(scene, agent)?;
    let mut pictures = scene.readings::<CameraRow>(agent, &pair.camera)?;
    let mut clouds = scene.readings::<Cloud>(agent, &pair.lidar)?;
    let mut boxes = scene.boxes(agent)?;
    let shown = Shown::read(scene, agent, pair.camera.camera().unwrap_or_default())?;
    let mut inertial = Inertial::open(scene, agent)?;
    let size_px =
        [pair.camera.about.width, pair.camera.about.height].map(|side| f64::from(side.unwrap_or(0)));
    let [tracking, object] = ["tracking", "object"].map(|set| format!("{agent}/{set}/training"));
    let (mut labels, mut oxts) = (String::new(), String::new());
    for (position, &frame) in frames.iter().enumerate() {
        let position = position as u32;
        let missing = |what: &str| content(frame, format!("{what} has no reading"));
        let picture = pictures.at(frame)?.ok_or_else(|| missing(&pair.camera.name))?;
        let cloud = clouds.at(frame)?.ok_or_else(|| missing(&pair.lidar.name))?;
        let png = png_of_jpeg(&picture.image.0)
            .map_err(|problem| content(frame, format!("{}: {problem}", pair.camera.name)))?;
        let (name, sequence) = (object_name(number, position), format!("{number:04}/{position:06}"));
        let image = format!("{tracking}/image_02/{sequence}.png");
        files.put(&image, &png)?;
        files.link(&image, &format!("{object}/image_2/{name}.png"))?;
        let points = format!("{tracking}/velodyne/{sequence}.bin");
        files.put(&points, &bytes_of(&cloud))?;
        files.link(&points, &format!("{object}/velodyne/{name}.bin"))?;

        let world_from_agent: Pose<World, Agent> =
            Pose::from_xyz_wxyz(poses[frame as usize].xyz_m, poses[frame as usize].quaternion);
        let optical_from_world = pair.optical_from_agent() * world_from_agent.isometry().inverse();
        let mut lines = String::new();
        for labelled in boxes.at(frame)? {
            // An agent is in its own list.
            if labelled.raw.is_ego {
                continue;
            }
            let row = shown.as_ref().map(|shown| shown.of(frame, labelled.raw.id));
            if matches!(row, Some(None)) {
                continue;
            }
            let unseen = labelled.seen.as_ref().is_some_and(|seen| !seen.valid_flag);
            if row.is_none() && unseen {
                continue;
            }
            let view = (pair.intrinsics(), size_px);
            if let Some(label) = label::label(&labelled, row.flatten(), &optical_from_world, view) {
                lines += &(label.line() + "\n");
                labels += &(label.tracking_line(position) + "\n");
            }
        }
        files.put(&format!("{object}/label_2/{name}.txt"), lines.as_bytes())?;
        files.put(&format!("{object}/calib/{name}.txt"), calib::object(pair).as_bytes())?;
        if let Some(inertial) = &mut inertial {
            oxts += &inertial.line(frame, &poses[frame as usize])?;
        }
        files.advance(1)?;
    }
    files.put(&format!("{tracking}/label_02/{number:04}.txt"), labels.as_bytes())?;
    files.put(&format!("{tracking}/calib/{number:04}.txt"), calib::tracking(pair).as_bytes())?;
    if inertial.is_some() {
        files.put(&format!("{tracking}/oxts/{number:04}.txt"), oxts.as_bytes())?;
    }
    Ok(Sequence { split: scene.info().split.clone(), frames: frames.len() as u32 })
}

/// Where an agent is, by frame.
fn own_rows(scene: &SceneSource, agent: AgentId) -> Result<Vec<AgentRow>, ExportError> {
    let position = scene.agents().iter().position(|other| *other == agent).unwrap_or(0);
    Ok(scene.agent_rows()?.swap_remove(position))
}

/// x, y, z and intensity of each point.
fn bytes_of(cloud: &Cloud) -> Vec<u8> {
    let points = cloud.x.iter().zip(&cloud.y).zip(&cloud.z).zip(&cloud.intensity);
    points.flat_map(|(((x, y), z), i)| [*x, *y, *z, *i]).flat_map(f32::to_le_bytes).collect()
}

/// What one camera shows, as the store says it.
struct Shown {
    rows: Vec<Box2dRow>,
    ranges: FrameRanges,
}

impl Shown {
    /// None where the store does not say it.
    fn read(scene: &SceneSource, agent: AgentId, camera: &str) -> Result<Option<Self>, ExportError> {
        let key = store::keys::sensor(scene.number(), agent, BOXES_2D_TABLE);
        let manifest = scene.reader().manifest(<Box2dRow as schema::table::Row>::STAGE)?;
        if manifest.output(&key).is_none() {
            return Ok(None);
        }
        let mut rows: Vec<Box2dRow> = agent_rows(scene.reader(), agent, BOXES_2D_TABLE)?;
        rows.retain(|row| row.camera == camera);
        let ranges =
            FrameRanges::new(&rows, 0, scene.info().frames).map_err(|row| scene::SceneError::Order {
                path: scene.reader().store().location(&key),
                row,
                frame: rows.get(row).map_or(0, |row| i64::from(row.frame)),
            })?;
        Ok(Some(Self { rows, ranges }))
    }

    fn of(&self, frame: u32, id: u16) -> Option<&Box2dRow> {
        self.rows[self.ranges.of(i64::from(frame))].iter().find(|row| row.id == id)
    }
}

/// The receivers of an agent.
struct Inertial {
    gnss: SensorFrames<GnssRow>,
    imu: SensorFrames<ImuRow>,
}

impl Inertial {
    /// None where the agent has not both.
    fn open(scene: &SceneSource, agent: AgentId) -> Result<Option<Self>, ExportError> {
        let sensors = scene.sensors(agent)?;
        let of = |kind| sensors.iter().find(|sensor| sensor.kind == kind);
        let (Some(gnss), Some(imu)) = (of(SensorKind::Gnss), of(SensorKind::Imu)) else { return Ok(None) };
        Ok(Some(Self { gnss: scene.readings(agent, gnss)?, imu: scene.readings(agent, imu)? }))
    }

    /// A line of `oxts`: position and motion as KITTI's development kit lists them. Angles and velocities are
    /// true, positions and accelerations those of the receivers; nothing where they have none.
    fn line(&mut self, frame: u32, truth: &AgentRow) -> Result<String, ExportError> {
        let (Some(fix), Some(imu)) = (self.gnss.at(frame)?, self.imu.at(frame)?) else {
            return Ok("\n".into());
        };
        let pose: Pose<World, Agent> = Pose::from_xyz_wxyz(truth.xyz_m, truth.quaternion);
        let [roll, pitch, yaw] = pose.rpy();
        let [east, north, _] = truth.velocity_mps;
        let own = pose.inverse().rotate(truth.velocity_mps.into());
        let level = level_turn(yaw);
        let about = |[x, y, z]: [f64; 3]| [level[0] * x + level[1] * y, -level[1] * x + level[0] * y, z];
        let world = |v: [f64; 3]| -> [f64; 3] { pose.rotate(v.into()).into() };
        let [af, al, au] = about(world(imu.acceleration_mps2));
        let [wf, wl, wu] = about(world(imu.gyroscope_radps));
        let [ax, ay, az] = imu.acceleration_mps2;
        let [wx, wy, wz] = imu.gyroscope_radps;
        let numbers = [
            fix.latitude_deg,
            fix.longitude_deg,
            fix.altitude_m,
            roll,
            pitch,
            yaw,
            north,
            east,
            own.x,
            own.y,
            own.z,
            ax,
            ay,
            az,
            af,
            al,
            au,
            wx,
            wy,
            wz,
            wf,
            wl,
            wu,
        ];
        let text: Vec<String> = numbers.iter().map(|v| format!("{v:.14}")).collect();
        // Accuracies of position and velocity; states and satellites that a simulation has not.
        Ok(format!("{} 0.05 0.01 4 10 4 4 0\n", text.join(" ")))
    }
}

/// Cosine and sine of a heading.
fn level_turn(yaw_rad: f64) -> [f64; 2] {
    [frames::math::cos(yaw_rad), frames::math::sin(yaw_rad)]
}
