//! A street made by hand: what tests, benches and the picture example look at.
#![allow(dead_code, unused_imports, reason = "each user needs a part of it")]

use std::sync::Arc;

use frames::{Agent, LocalOrigin, Pose, World};
use glam::{Affine3A, Vec3};
use render::CameraView;
use render::cpu::CpuRenderer;
use render::{Renderer, Scene};
use schema::geometry::{Instance, MeshPart, Snapshot, Surface, TriMesh, Wall};
use schema::tables::{CameraRow, Weather};
use schema::{ImageSet, Tag, lights};
use sensors::{Camera, Image};
use settings::{CameraSettings, CameraSpec, Mount, Optics};
use shading::{CpuPainter, FrameWeather, Lighting, Painter, Picture, Sight, Sky};
pub(crate) use testkit::{MeshBuilder, block, instance, plane, snapshot};

/// A renderer with a snapshot's meshes.
pub(crate) fn prepared(snapshot: &Snapshot) -> CpuRenderer {
    let mut renderer = CpuRenderer::default();
    renderer.prepare(&snapshot.meshes).expect("has no device");
    renderer
}

/// Calls with the scene of a snapshot.
pub(crate) fn with_scene<T>(snapshot: &Snapshot, run: impl FnOnce(&dyn Scene) -> T) -> T {
    run(&*prepared(snapshot).place(snapshot).expect("all meshes are prepared"))
}

/// The first frame in a weather.
pub(crate) fn first_frame(weather: &Weather) -> FrameWeather {
    FrameWeather { frame: 0, time_s: 0.0, weather: *weather, is_steady: true }
}

/// Pictures of a size, 80 degrees wide.
pub(crate) fn optics(width: u32, height: u32) -> Optics {
    Optics::pinhole(width, height, frames::deg(80.0))
}

/// A camera of a rig.
pub(crate) fn camera(mount: Mount, optics: Optics, settings: &CameraSettings) -> Camera {
    Camera::new(&CameraSpec { name: "CAM".into(), mount, optics }, settings).expect("is a camera")
}

/// A camera on an agent that stands.
pub(crate) fn standing_view(xyz_m: [f64; 3], rpy_rad: [f64; 3], optics: Optics) -> CameraView {
    set_view(xyz_m, rpy_rad, optics, &CameraSettings::default())
}

/// The same with settings of its own.
pub(crate) fn set_view(
    xyz_m: [f64; 3],
    rpy_rad: [f64; 3],
    optics: Optics,
    settings: &CameraSettings,
) -> CameraView {
    let pose = Pose::<World, Agent>::from_xyz_rpy(xyz_m, rpy_rad);
    let mount = Mount::upright([0.6, 0.0, 1.6], 0.0);
    camera(mount, optics, settings).view(&LocalOrigin::near([0.0; 3]), &pose, &pose)
}

/// What a camera sees, in colour if its settings say so.
pub(crate) fn sight(scene: &dyn Scene, view: &CameraView, weather: &Weather) -> Sight {
    let painter = CpuPainter::default();
    let views = vec![view.clone()];
    sensors::see(scene, Some(&painter as &dyn Painter), &first_frame(weather), Vec3::ZERO, views)
        .expect("is a camera")
        .remove(0)
}

/// What a camera sees, without colour.
pub(crate) fn grey_sight(scene: &dyn Scene, view: &CameraView) -> Sight {
    let settings = CameraSettings { images: ImageSet::NONE, ..view.settings.clone() };
    sight(scene, &CameraView { settings, ..view.clone() }, &Weather::default())
}

/// An encoded image.
pub(crate) fn encoded<I: Image<Row = CameraRow>>(snapshot: &Snapshot, sight: &Sight) -> Vec<u8> {
    I::of(snapshot, sight, 0).expect("is encoded").image.0
}

/// A colour picture before it is encoded.
pub(crate) fn picture(snapshot: &Snapshot, view: &CameraView, weather: &Weather) -> Picture {
    with_scene(snapshot, |scene| sight(scene, view, weather).picture.expect("is in colour"))
}

/// Film value of an 8-bit value: the inverse of the filmic curve (Narkowicz 2015) and the sRGB code.
pub(crate) fn film(value: u8) -> f64 {
    let c = f64::from(value) / 255.0;
    let l = if c <= 0.040_45 { c / 12.92 } else { frames::math::pow((c + 0.055) / 1.055, 2.4) };
    // l (2.43 v^2 + 0.59 v + 0.14) = 2.51 v^2 + 0.03 v
    let (a, b, c) = (2.51 - 2.43 * l, 0.03 - 0.59 * l, -0.14 * l);
    (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)
}

/// The light around the origin.
pub(crate) fn lighting(scene: &dyn Scene, weather: &Weather) -> Lighting {
    let sky = Arc::new(Sky::new(weather, 0.0));
    Lighting::new(scene, sky, weather, Vec3::ZERO).expect("has no device")
}

pub(crate) fn at(x: f32, y: f32, z: f32, yaw: f32) -> Affine3A {
    Affine3A::from_translation(Vec3::new(x, y, z)) * Affine3A::from_rotation_z(yaw)
}

fn ground() -> Arc<TriMesh> {
    let mut b = MeshBuilder::default();
    let grass = b.part(Tag::Terrain, Surface::Grass, [0.09, 0.14, 0.035]);
    let road = b.part(Tag::Road, Surface::Asphalt, [0.075, 0.075, 0.078]);
    let walk = b.part(Tag::Sidewalk, Surface::Concrete, [0.34, 0.33, 0.31]);
    let line = b.part(Tag::RoadLine, Surface::RoadMarking, [0.75, 0.75, 0.72]);
    let yellow = b.part(Tag::RoadLine, Surface::RoadMarking, [0.75, 0.5, 0.06]);
    let mut flat = |part, x0: f32, x1: f32, y0: f32, y1: f32, z: f32| {
        let p = |x, y| Vec3::new(x, y, z);
        b.quad(part, [p(x0, y0), p(x1, y0), p(x1, y1), p(x0, y1)]);
    };
    flat(grass, -600.0, 600.0, -600.0, 600.0, -0.06);
    flat(road, -600.0, 600.0, -7.0, 7.0, 0.0);
    flat(road, 33.0, 47.0, -300.0, 300.0, 0.001);
    for y in [-0.15, 0.15] {
        flat(yellow, -600.0, 31.0, y - 0.06, y + 0.06, 0.01);
    }
    for i in 0..60 {
        let x = -150.0 + 9.0 * i as f32;
        if !(28.0..50.0).contains(&x) {
            for y in [-3.5, 3.5] {
                flat(line, x, x + 3.0, y - 0.07, y + 0.07, 0.01);
            }
        }
    }
    for i in 0..11 {
        let y = -6.6 + 1.25 * i as f32;
        flat(line, 27.0, 30.5, y, y + 0.55, 0.01);
    }
    for (y0, y1) in [(-11.5, -7.0), (7.0, 11.5)] {
        for (x0, x1) in [(-300.0, 31.0), (49.0, 300.0)] {
            b.cuboid(walk, [x0, y0, -0.3], [x1, y1, 0.15]);
        }
    }
    b.finish()
}

fn house(length: f32, depth: f32, height: f32, rgb: [f32; 3]) -> Arc<TriMesh> {
    let mut b = MeshBuilder::default();
    let wall = b.part(Tag::Building, Surface::Facade(Wall::Plaster), rgb);
    b.cuboid(wall, [-0.5 * length, -0.5 * depth, 0.0], [0.5 * length, 0.5 * depth, height]);
    b.finish()
}

fn tree(height: f32) -> Arc<TriMesh> {
    let mut b = MeshBuilder::default();
    let trunk = b.part(Tag::Vegetation, Surface::Wood, [0.12, 0.085, 0.06]);
    let leaves = b.part(Tag::Vegetation, Surface::Foliage, [0.09, 0.17, 0.035]);
    b.frustum(trunk, [-0.2, 0.2, -0.2, 0.2], 0.0, [-0.1, 0.1, -0.1, 0.1], 0.5 * height);
    for i in 0..7 {
        let (s, c) = frames::math::f32::sin_cos(i as f32 * 0.9);
        let spread = if i == 0 { 0.0 } else { 0.17 * height };
        let centre = Vec3::new(spread * c, spread * s, height * (0.62 + 0.05 * (i % 3) as f32));
        b.ball(leaves, centre, Vec3::new(0.21, 0.21, 0.19) * height, 9);
    }
    b.finish()
}

fn car() -> Arc<TriMesh> {
    let mut b = MeshBuilder::default();
    let paint = b.part(Tag::Car, Surface::Paint, [0.5; 3]);
    let glass = b.part(Tag::Car, Surface::Glass, [0.02; 3]);
    let tyre = b.part(Tag::Car, Surface::Rubber, [0.02; 3]);
    let rim = b.part(Tag::Car, Surface::Metal, [0.5; 3]);
    let head = b.part(Tag::Car, Surface::Lamp(lights::LOW_BEAM | lights::HIGH_BEAM), [1.0, 0.95, 0.85]);
    let tail = b.part(Tag::Car, Surface::Lamp(lights::POSITION | lights::BRAKE), [1.0, 0.05, 0.03]);
    b.frustum(paint, [-2.3, 2.3, -0.88, 0.88], 0.3, [-2.3, 2.25, -0.9, 0.9], 0.75);
    b.frustum(paint, [-2.3, 2.25, -0.9, 0.9], 0.75, [-2.2, 1.9, -0.82, 0.82], 0.95);
    b.frustum(glass, [-1.9, 1.1, -0.8, 0.8], 0.95, [-1.3, 0.3, -0.62, 0.62], 1.4);
    b.frustum(paint, [-1.3, 0.3, -0.62, 0.62], 1.4, [-1.2, 0.2, -0.6, 0.6], 1.44);
    for x in [-1.4, 1.4] {
        for y in [-0.82, 0.82] {
            b.wheel(tyre, Vec3::new(x, y, 0.33), 0.33, 0.22);
            b.wheel(rim, Vec3::new(x, y, 0.33), 0.2, 0.24);
        }
    }
    for y in [-0.65f32, 0.65] {
        b.cuboid(head, [2.2, y - 0.18, 0.6], [2.3, y + 0.18, 0.72]);
        b.cuboid(tail, [-2.33, y - 0.2, 0.65], [-2.25, y + 0.2, 0.78]);
    }
    b.finish()
}

fn street_lamp() -> Arc<TriMesh> {
    let mut b = MeshBuilder::default();
    let pole = b.part(Tag::Pole, Surface::Metal, [0.25; 3]);
    let lamp = b.part(Tag::Pole, Surface::Lamp(lights::STREET_LAMP), [1.0, 0.82, 0.55]);
    b.frustum(pole, [-0.08, 0.08, -0.08, 0.08], 0.0, [-0.05, 0.05, -0.05, 0.05], 7.0);
    b.cuboid(pole, [-0.05, -0.05, 6.95], [2.0, 0.05, 7.05]);
    b.cuboid(lamp, [1.3, -0.12, 6.85], [2.0, 0.12, 6.95]);
    b.finish()
}

fn walker() -> Arc<TriMesh> {
    let mut b = MeshBuilder::default();
    let skin = b.part(Tag::Pedestrian, Surface::Cloth, [0.45, 0.28, 0.2]);
    let coat = b.part(Tag::Pedestrian, Surface::Cloth, [0.25, 0.05, 0.05]);
    let legs = b.part(Tag::Pedestrian, Surface::Cloth, [0.03, 0.04, 0.08]);
    b.ball(skin, Vec3::new(0.0, 0.0, 1.64), Vec3::new(0.1, 0.09, 0.13), 7);
    b.frustum(coat, [-0.13, 0.13, -0.2, 0.2], 0.85, [-0.11, 0.11, -0.23, 0.23], 1.48);
    for y in [-0.1f32, 0.1] {
        b.frustum(legs, [-0.06, 0.08, y - 0.06, y + 0.06], 0.0, [-0.09, 0.09, y - 0.09, y + 0.09], 0.85);
    }
    b.finish()
}

fn sign() -> Arc<TriMesh> {
    let mut b = MeshBuilder::default();
    let pole = b.part(Tag::Pole, Surface::Metal, [0.5; 3]);
    let face = b.part(Tag::TrafficSign, Surface::Plain, [0.6, 0.04, 0.04]);
    b.cuboid(pole, [-0.03, -0.03, 0.0], [0.03, 0.03, 2.6]);
    b.cuboid(face, [-0.06, -0.35, 1.9], [-0.03, 0.35, 2.6]);
    b.finish()
}

/// A crossing with houses, trees, parked and moving cars, lamps and people; the camera belongs at the origin,
/// looking along x. The first instance is the ground.
pub(crate) fn street(night: bool) -> Snapshot {
    let meshes = vec![
        ground(),
        house(24.0, 14.0, 18.0, [0.42, 0.33, 0.24]),
        house(18.0, 12.0, 27.0, [0.36, 0.37, 0.4]),
        house(30.0, 16.0, 12.0, [0.5, 0.22, 0.15]),
        tree(7.0),
        tree(9.5),
        car(),
        street_lamp(),
        walker(),
        sign(),
    ];
    let mut all = vec![instance(0, 1, Affine3A::IDENTITY)];
    let mut next = 2;
    let mut add = |mesh: u32, pose: Affine3A, previous: Affine3A, paint: [f32; 3], lights: u32| {
        all.push(Instance {
            mesh,
            object: next,
            local_from_object: pose,
            previous_local_from_object: previous,
            paint,
            lights,
            glow: [1.0, 0.7, 0.4],
        });
        next += 1;
    };
    let half = std::f32::consts::FRAC_PI_2;
    let windows = if night { lights::BUILDING } else { 0 };
    for i in 0..14i32 {
        let x = -100.0 + 28.0 * i as f32;
        if (20.0..60.0).contains(&x) {
            continue;
        }
        for (side, y) in [(0, 21.0), (1, -21.0)] {
            let pose = at(x, y, 0.0, 0.0);
            add(1 + ((i + side) % 3) as u32, pose, pose, [0.5; 3], windows);
        }
    }
    for i in 0..16 {
        let x = -60.0 + 13.0 * i as f32;
        if (27.0..53.0).contains(&x) {
            continue;
        }
        for (side, y) in [(0, 10.5), (1, -10.5)] {
            let pose = at(x + 3.0 * side as f32, y, 0.15, i as f32);
            add(4 + ((i + side) % 2) as u32, pose, pose, [0.5; 3], 0);
        }
    }
    let paints =
        [[0.55, 0.02, 0.02], [0.7, 0.7, 0.7], [0.02, 0.06, 0.3], [0.03, 0.03, 0.035], [0.25, 0.27, 0.28]];
    let lit = if night { lights::LOW_BEAM | lights::POSITION } else { 0 };
    for i in 0..7 {
        let pose = at(-40.0 + 9.5 * i as f32, 5.9, 0.0, std::f32::consts::PI);
        add(6, pose, pose, paints[i % 5], 0);
    }
    for (i, (x, y, yaw, speed)) in [
        (12.0, -1.75, 0.0, 8.0),
        (30.0, 1.8, half * 2.0, 10.0),
        (60.0, 1.8, half * 2.0, 12.0),
        (38.0, -25.0, half, 6.0),
    ]
    .into_iter()
    .enumerate()
    {
        let pose = at(x, y, 0.0, yaw);
        let step = Affine3A::from_translation(Vec3::new(-speed * 0.05, 0.0, 0.0));
        add(6, pose, pose * step, paints[(i + 2) % 5], lit | if i == 0 { lights::BRAKE } else { 0 });
    }
    for i in 0..9 {
        let x = -50.0 + 24.0 * i as f32;
        for (y, yaw) in [(7.6, -half), (-7.6, half)] {
            let pose = at(x, y, 0.15, yaw);
            add(7, pose, pose, [0.5; 3], if night { lights::STREET_LAMP } else { 0 });
        }
    }
    for (x, y, yaw) in
        [(9.0, -8.6, 0.3), (18.0, -9.4, 3.0), (28.5, -2.0, 1.5), (29.2, 3.5, -1.5), (22.0, 9.0, 0.2)]
    {
        let pose = at(x, y, if y.abs() > 7.0 { 0.15 } else { 0.0 }, yaw);
        add(8, pose, pose, [0.5; 3], 0);
    }
    let pose = at(24.0, -7.5, 0.15, 0.0);
    add(9, pose, pose, [0.5; 3], 0);
    snapshot(meshes, all)
}
