//! Every sensor through a second renderer, which tries each triangle: readings are the same.

use crate::common::{at, block, first_frame, instance, optics, plane, prepared, snapshot};
use frames::{Agent, Pose, World};
use glam::Affine3A;
use nalgebra::Vector3;
use render::{Renderer, Scene};
use schema::geometry::{Snapshot, Surface, Wall};
use schema::table::{Column, Row};
use schema::tables::Weather;
use schema::{AgentId, ImageKind, ImageSet, Tag};
use sensors::{
    AgentState, Cameras, GeoOrigin, Motion, Observation, Sensor, SensorContext, SensorError, SensorVisitor,
};
use settings::Rig;
use shading::CpuPainter;
use testkit::BruteRenderer;

/// A road, a house and cars, one of which drives.
fn corner() -> Snapshot {
    let mut moving = instance(2, 5, at(14.0, 2.5, 0.0, 0.2));
    moving.previous_local_from_object = at(13.4, 2.5, 0.0, 0.2);
    let corner = snapshot(
        vec![
            plane(150.0, 0.0, Tag::Road, Surface::Asphalt),
            block([12.0, 8.0, 9.0], Tag::Building, Surface::Facade(Wall::Plaster)),
            block([4.4, 1.8, 1.5], Tag::Car, Surface::Paint),
            block([4.0, 1.7, 1.9], Tag::Car, Surface::Window),
            block([1.0, 1.2, 0.9], Tag::Car, Surface::Cloth),
        ],
        vec![
            instance(0, 1, Affine3A::IDENTITY),
            instance(1, 2, at(22.0, -9.0, 0.0, 0.1)),
            instance(2, 4, at(0.1, 0.05, 0.0, 0.01)),
            moving,
            instance(3, 6, at(9.0, -1.5, 0.0, 0.4)),
        ],
    );
    // The last one is of glass, with a seat in it.
    Snapshot { cabins: vec![instance(4, 6, at(9.3, -1.4, 0.2, 0.4))], ..corner }
}

fn rig() -> Rig {
    let mut rig = Rig::vehicle();
    rig.cameras.truncate(2);
    rig.cameras.iter_mut().for_each(|camera| camera.optics = optics(64, 36));
    rig.camera.images = ImageSet::of(ImageKind::ALL);
    (rig.lidars[0].scan.channels, rig.lidars[0].scan.columns) = (8, 64);
    rig.lidars.push(rig.lidars[0].semantic());
    rig.radars.iter_mut().for_each(|radar| radar.rays = 80);
    rig
}

/// Columns of every sensor's rows, by table.
struct Readings<'a> {
    at: &'a Observation<'a>,
    tables: Vec<(String, Vec<Column>)>,
}

impl SensorVisitor for Readings<'_> {
    type Error = SensorError;

    fn visit<S: Sensor>(&mut self, sensor: S) -> Result<(), SensorError> {
        let rows = sensor.sense(self.at)?;
        self.tables.push((sensor.table().name, S::Row::to_columns(&rows)));
        Ok(())
    }
}

fn readings(scene: &dyn Scene) -> (Vec<(String, Vec<Column>)>, Vec<u8>) {
    let pose = |x: f64| Pose::<World, Agent>::from_xyz_rpy([x, 0.0, 0.0], [0.0; 3]);
    let motion = |x| Motion {
        world_from_agent: pose(x),
        velocity_mps: Vector3::new(4.0, 0.0, 0.0),
        angular_velocity_radps: Vector3::zeros(),
    };
    let agent = AgentState { own: 4, motion: motion(0.0), previous: Some(motion(-0.2)) };
    let rig = rig();
    let weather = Weather { sun_altitude_deg: 40.0, fog_density: 0.0, ..Weather::default() };
    let painter = CpuPainter::default();
    let cameras = Cameras::of(&rig).expect("are cameras");
    let at =
        Observation::new(scene, Some(&painter), &cameras, &first_frame(&weather), agent).expect("no device");
    let carrier =
        SensorContext { seed: 3, scene: 1, agent: AgentId::vehicle(0), geo_origin: GeoOrigin::default() };
    let mut readings = Readings { at: &at, tables: Vec::new() };
    sensors::visit_sensors(&rig, &carrier, &mut readings).expect("no device");
    let pictures =
        at.sights.iter().flatten().flat_map(|sight| sight.picture.as_ref().expect("in colour").rgb.clone());
    (readings.tables, pictures.collect())
}

/// Whether two columns say the same: ids and counts exactly, distances and depths as far as `f32` carries.
fn alike(a: &Column, b: &Column) -> bool {
    let near = |a: &f32, b: &f32| (a - b).abs() <= 2e-4 * a.abs().max(1.0);
    match (a, b) {
        (Column::ListF32(a), Column::ListF32(b)) => {
            a.iter().zip(b).all(|(a, b)| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| near(a, b)))
        }
        _ => a == b,
    }
}

#[test]
fn all_sensors_read_the_same_through_another_renderer() {
    let world = corner();
    let cpu = prepared(&world);
    let mut brute = BruteRenderer::default();
    brute.prepare(&world.meshes).expect("has no device");
    let (ours, our_pictures) = readings(&*cpu.place(&world).expect("is prepared"));
    let (theirs, their_pictures) = readings(&*brute.place(&world).expect("is prepared"));
    // Two cameras of all kinds, two lidars, four radars, GNSS, IMU and what is visible.
    assert_eq!(ours.len(), 2 * ImageKind::ALL.len() + 2 + 4 + 2 + 1);
    for ((name, ours), (other, theirs)) in ours.iter().zip(&theirs) {
        assert_eq!(name, other);
        // JPEG spreads a level over a block, and depth's lowest bits are below f32: compared below and by
        // ids.
        let coarse = name.starts_with("RGB") || name.starts_with("DPT");
        let same = ours.iter().zip(theirs).all(|(a, b)| coarse || alike(a, b));
        assert!(same && !ours[0].is_empty(), "{name}");
    }
    let far = our_pictures.iter().zip(&their_pictures).filter(|(a, b)| a.abs_diff(**b) > 2).count();
    assert_eq!(our_pictures.len(), 2 * 3 * 64 * 36);
    assert!(far * 500 <= our_pictures.len(), "{far} values differ by more than two levels");
}
