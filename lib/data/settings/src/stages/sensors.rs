//! What `render-sensors` sees, and what each table of a sensor depends on.

use serde::Serialize;

use schema::tables::{BOXES_2D_TABLE, GNSS_TABLE, IMU_TABLE, VISIBLE_TABLE};
use schema::{AgentId, ImageKind, ImageSet};

use crate::{
    CameraSettings, CameraSpec, GnssSpec, ImuSpec, LidarSpec, Mount, Optics, PerAgent, RadarSpec, Rig,
};

/// What sensors are rendered from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SensorSettings {
    /// Seed of every random stream.
    pub seed: u64,
    /// Sensors of each agent.
    pub rigs: PerAgent<Rig>,
}

/// What a table of an agent's sensors is made from: of all settings nothing else can alter it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SensorTableSettings<'a> {
    /// Its name among those of the agent.
    #[serde(skip)]
    pub name: String,
    seed: u64,
    sensor: SensorOf<'a>,
}

/// A sensor, with what it uses of the settings.
#[derive(Clone, Debug, PartialEq, Serialize)]
enum SensorOf<'a> {
    /// Colour: what light makes of it, too.
    Colour {
        camera: &'a CameraSpec,
        film: CameraSettings,
    },
    /// Images of labels: what is where.
    Labels {
        kind: &'static str,
        camera: &'a CameraSpec,
        every_n_frames: u32,
        flow_half: bool,
    },
    /// Objects that all cameras see.
    Visible {
        cameras: Vec<(Mount, &'a Optics)>,
        every_n_frames: u32,
    },
    /// Boxes in the pictures of all cameras.
    Boxes2d {
        cameras: &'a [CameraSpec],
        every_n_frames: u32,
    },
    Lidar(&'a LidarSpec),
    Radar(&'a RadarSpec),
    Gnss(&'a GnssSpec),
    Imu(&'a ImuSpec),
}

impl SensorSettings {
    /// The tables of an agent's sensors, in no order to rely on.
    #[must_use]
    pub fn tables(&self, agent: AgentId) -> Vec<SensorTableSettings<'_>> {
        let rig = self.rigs.of(agent);
        let Rig { camera: _, cameras: _, lidars, radars, gnss, imu } = rig;
        let lidars = lidars.iter().map(|spec| (spec.name.clone(), SensorOf::Lidar(spec)));
        let radars = radars.iter().map(|spec| (spec.name.clone(), SensorOf::Radar(spec)));
        let gnss = gnss.iter().map(|spec| (GNSS_TABLE.to_owned(), SensorOf::Gnss(spec)));
        let imu = imu.iter().map(|spec| (IMU_TABLE.to_owned(), SensorOf::Imu(spec)));
        let all = of_cameras(rig).into_iter().chain(lidars).chain(radars).chain(gnss).chain(imu);
        all.map(|(name, sensor)| SensorTableSettings { name, seed: self.seed, sensor }).collect()
    }
}

/// The tables of a rig's cameras, by name.
fn of_cameras(rig: &Rig) -> Vec<(String, SensorOf<'_>)> {
    // Every key is named here, so that a new one does not compile before it is said which images it alters:
    // all of them, or colour alone.
    let CameraSettings {
        f_stop: _,
        vignetting: _,
        white_balance: _,
        bloom: _,
        noise: _,
        exposure_time_s: _,
        aperture_mm: _,
        focus_m: _,
        lens_drops: _,
        jpeg_quality: _,
        boxes_2d,
        flow_half,
        every_n_frames,
        images,
    } = rig.camera;
    let film =
        CameraSettings { boxes_2d: false, flow_half: false, images: ImageSet::NONE, ..rig.camera.clone() };
    let mut tables = Vec::new();
    for camera in &rig.cameras {
        for kind in images.iter() {
            let sensor = match kind {
                ImageKind::Rgb => SensorOf::Colour { camera, film: film.clone() },
                _ => SensorOf::Labels {
                    kind: kind.spec().prefix,
                    camera,
                    every_n_frames,
                    flow_half: flow_half && kind == ImageKind::Flow,
                },
            };
            tables.push((kind.table(&camera.name), sensor));
        }
    }
    if images.has(ImageKind::Instance) {
        let cameras = rig.cameras.iter().map(|camera| (camera.mount, &camera.optics)).collect();
        tables.push((VISIBLE_TABLE.to_owned(), SensorOf::Visible { cameras, every_n_frames }));
    }
    if boxes_2d && !images.is_empty() {
        let cameras = rig.cameras.as_slice();
        tables.push((BOXES_2D_TABLE.to_owned(), SensorOf::Boxes2d { cameras, every_n_frames }));
    }
    tables
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings() -> SensorSettings {
        let mut rig = Rig::vehicle();
        let images = [ImageKind::Rgb, ImageKind::Instance, ImageKind::Depth];
        (rig.camera.images, rig.camera.boxes_2d) = (ImageSet::of(&images), true);
        rig.cameras.truncate(2);
        rig.radars.truncate(2);
        let second = LidarSpec { name: "SECOND".into(), ..LidarSpec::vehicle() };
        rig.lidars.push(second);
        SensorSettings { seed: 1, rigs: PerAgent { vehicle: rig, rsu: Rig::rsu(), own: Vec::new() } }
    }

    /// Tables of a vehicle that a change of its rig alters, adds or removes.
    fn altered(change: impl FnOnce(&mut Rig)) -> Vec<String> {
        let (before, mut after) = (settings(), settings());
        change(&mut after.rigs.vehicle);
        assert_eq!(before.tables(AgentId::rsu(0)), after.tables(AgentId::rsu(0)));
        let text = |all: &SensorSettings| -> Vec<(String, String)> {
            let tables = all.tables(AgentId::vehicle(0));
            let json = |table: &SensorTableSettings<'_>| serde_json::to_string(table).expect("is JSON");
            tables.iter().map(|table| (table.name.clone(), json(table))).collect()
        };
        let (before, after) = (text(&before), text(&after));
        let gone = before.iter().filter(|table| !after.contains(table));
        let new = after.iter().filter(|table| !before.contains(table));
        let mut names: Vec<String> = gone.chain(new).map(|(name, _)| name.clone()).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    #[test]
    fn a_change_concerns_the_tables_of_what_was_changed() {
        assert_eq!(altered(|_| {}), [""; 0]);
        assert_eq!(altered(|rig| rig.lidars[1].scan.channels = 16), ["SECOND"]);
        assert_eq!(altered(|rig| rig.radars[0].every_n_frames = 3), ["RAD_LEFT"]);
        assert_eq!(altered(|rig| rig.imu = None), ["IMU"]);
        let both = "CAM_FRONT";
        let of = |kinds: &[&str]| -> Vec<String> {
            let mut all: Vec<String> = kinds.iter().map(|kind| format!("{kind}-{both}")).collect();
            all.extend(["boxes_2d".into(), "visible".into()]);
            all.sort_unstable();
            all
        };
        assert_eq!(altered(|rig| rig.cameras[1].optics.width = 99), of(&["DPT", "IST", "RGB"]));
        let flow = altered(|rig| rig.camera.images.set(ImageKind::Flow, true));
        assert_eq!(flow, ["FLW-CAM_FRONT", "FLW-CAM_FRONT_LEFT"]);
        let colour = ["RGB-CAM_FRONT", "RGB-CAM_FRONT_LEFT"];
        assert_eq!(altered(|rig| rig.camera.jpeg_quality = 7), colour);
        assert_eq!(altered(|rig| rig.camera.exposure_time_s = 0.01), colour);
        assert_eq!(altered(|rig| rig.camera.boxes_2d = false), ["boxes_2d"]);
        assert_eq!(altered(|rig| rig.camera.flow_half = true), [""; 0], "there is no flow");
        assert_eq!(altered(|rig| rig.camera.every_n_frames = 5).len(), 2 * 3 + 2);
        // The names of cameras are told with boxes.
        assert_eq!(altered(|rig| rig.cameras[1].name = "OTHER".into()).len(), 2 * 3 + 1);
    }
}
