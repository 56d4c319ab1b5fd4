//! Draws a sheet of all models and two views of a town, to look at:
//! `look OUT_DIR [TOWN | MAP.xodr [X Y [MODEL]]]`. With a model: things of it (or whose name begins so), as
//! they look from where they look to.
#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a tool for developers")]

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::sync::Arc;

use catalogue::models::MODELS;
use frames::{LocalOrigin, Object, Pose, World};
use glam::{Affine3A, Mat4, Vec3};
use land::scenery::PLATES;
use land::tiles::{Surroundings, TileMaker};
use meshes::actors::{Posture, actor_mesh};
use opendrive::{Map, Network};
use schema::geometry::{Instance, Snapshot, Surface, TriMesh};
use schema::tables::FrameRow;
use settings::SceneryRules;
use world::{Moment, SceneWorld};

/// A z-buffer with flat shading.
struct Canvas {
    width: usize,
    height: usize,
    depth: Vec<f32>,
    rgb: Vec<u8>,
}

impl Canvas {
    fn new(width: usize, height: usize) -> Self {
        let rgb = [150u8, 180, 215].repeat(width * height);
        Self { width, height, depth: vec![f32::INFINITY; width * height], rgb }
    }

    fn draw(&mut self, snapshot: &Snapshot, clip_from_local: Mat4) {
        let sun = Vec3::new(0.4, 0.25, 0.88).normalize();
        for instance in &snapshot.instances {
            let mesh = snapshot.mesh(instance);
            for i in 0..mesh.triangles.len() {
                let p = mesh.corners(i).map(|v| instance.local_from_object.transform_point3(v));
                let part = mesh.part(i);
                let normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
                let light = 0.40 + 0.60 * normal.dot(sun).max(0.0);
                let base = match part.surface {
                    Surface::Paint => instance.paint,
                    Surface::Facade(_) if normal.z.abs() < 0.5 => part.rgb.map(|c| c * 0.9),
                    _ => part.rgb,
                };
                let colour = base.map(|c| ((c * light).max(0.0).sqrt() * 255.0).min(255.0) as u8);
                self.triangle(p.map(|v| clip_from_local * v.extend(1.0)), colour);
            }
        }
    }

    fn triangle(&mut self, clip: [glam::Vec4; 3], colour: [u8; 3]) {
        if clip.iter().any(|c| c.w < 0.2) {
            return;
        }
        let s = clip.map(|c| {
            Vec3::new(
                (c.x / c.w * 0.5 + 0.5) * self.width as f32,
                (0.5 - c.y / c.w * 0.5) * self.height as f32,
                c.z / c.w,
            )
        });
        let area = (s[1].x - s[0].x) * (s[2].y - s[0].y) - (s[2].x - s[0].x) * (s[1].y - s[0].y);
        // Back faces are left out: wrong windings show.
        if area >= 0.0 {
            return;
        }
        let min = s[0].min(s[1]).min(s[2]).max(Vec3::ZERO);
        let max = s[0].max(s[1]).max(s[2]);
        for y in min.y as usize..(max.y as usize + 1).min(self.height) {
            for x in min.x as usize..(max.x as usize + 1).min(self.width) {
                let (px, py) = (x as f32 + 0.5, y as f32 + 0.5);
                let edge = |a: Vec3, b: Vec3| ((b.x - a.x) * (py - a.y) - (b.y - a.y) * (px - a.x)) / area;
                let (u, v, w) = (edge(s[1], s[2]), edge(s[2], s[0]), edge(s[0], s[1]));
                if u >= 0.0 && v >= 0.0 && w >= 0.0 {
                    let z = u * s[0].z + v * s[1].z + w * s[2].z;
                    let k = y * self.width + x;
                    if z < self.depth[k] {
                        self.depth[k] = z;
                        self.rgb[3 * k..3 * k + 3].copy_from_slice(&colour);
                    }
                }
            }
        }
    }

    fn save(&self, path: &Path) -> Result<(), Box<dyn Error>> {
        let mut encoder =
            png::Encoder::new(BufWriter::new(File::create(path)?), self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header()?.write_image_data(&self.rgb)?;
        println!("{}", path.display());
        Ok(())
    }
}

fn view(eye: Vec3, at: Vec3, fov: f32, aspect: f32) -> Mat4 {
    glam::camera::rh::proj::directx::perspective(fov, aspect, 0.2, 2000.0)
        * glam::camera::rh::view::look_at_mat4(eye, at, Vec3::Z)
}

/// Models in rows on a plane.
fn sheet(models: &[(String, [f64; 3], u32)], columns: usize, pitch: f32) -> Snapshot {
    let (mut meshes, mut instances): (Vec<Arc<TriMesh>>, Vec<Instance>) = (Vec::new(), Vec::new());
    for (k, (model, size, variant)) in models.iter().enumerate() {
        let at = Vec3::new((k / columns) as f32 * -pitch, (k % columns) as f32 * pitch, 0.0);
        let turn = Affine3A::from_rotation_z(-0.6);
        let posture = Posture {
            steer_rad: 0.25,
            phase_rad: 1.2,
            gait_mps: 1.3,
            door_rad: [1.1, 0.0, 1.1, 0.0],
            ..Posture::default()
        };
        let made = actor_mesh(model, *size, *variant).unwrap();
        let posture = made.posed(posture);
        for piece in made.pieces {
            let Some(joint) = piece.joint.object_from_piece(&posture) else { continue };
            let pose = Affine3A::from_translation(at) * turn * joint;
            instances.push(Instance {
                mesh: meshes.len() as u32,
                object: 1,
                local_from_object: pose,
                previous_local_from_object: pose,
                paint: [[0.5, 0.04, 0.04], [0.04, 0.1, 0.4], [0.6, 0.6, 0.6], [0.5, 0.4, 0.05]][k % 4],
                lights: 0,
                glow: [1.0; 3],
            });
            meshes.push(piece.mesh);
        }
        let name = model.clone();
        let count: usize =
            actor_mesh(model, *size, *variant).unwrap().pieces.iter().map(|p| p.mesh.triangles.len()).sum();
        println!("{name}: {count} triangles");
    }
    Snapshot {
        origin: LocalOrigin::near([0.0; 3]),
        meshes: meshes.into(),
        instances,
        cabins: Vec::new(),
        motions: Vec::new(),
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let out = Path::new(arguments.first().map_or("/tmp", String::as_str));
    let vehicles: Vec<_> =
        MODELS.iter().filter(|m| m.size_m[0] > 1.3).map(|m| (m.name.to_owned(), m.size_m, 4)).collect();
    let mut canvas = Canvas::new(1800, 1100);
    canvas.draw(
        &sheet(&vehicles, 7, 6.5),
        view(Vec3::new(17.0, 19.5, 15.0), Vec3::new(-9.5, 19.5, 0.0), 0.95, 1800.0 / 1100.0),
    );
    canvas.save(&out.join("world-vehicles.png"))?;
    let mut small: Vec<(String, [f64; 3], u32)> = Vec::new();
    for m in MODELS.iter().filter(|m| m.size_m[0] <= 1.3) {
        small.push((m.name.to_owned(), m.size_m, 0));
        small.push((m.name.to_owned(), m.size_m, 6));
        small.push((m.name.to_owned(), m.size_m, 17));
    }
    for m in MODELS.iter().filter(|m| m.name.contains("cycle")) {
        small.push((m.name.to_owned(), m.size_m, 5));
    }
    for (name, size) in [
        ("prop.bench", [0.55, 1.7, 0.85]),
        ("prop.bin", [0.42, 0.42, 0.95]),
        ("prop.fence", [2.0, 0.1, 1.1]),
        ("prop.wall", [2.0, 0.3, 1.4]),
        ("light.signal", [0.36, 0.42, 1.1]),
        ("rsu.pole", [0.4, 0.4, 3.4]),
        ("bush.round", [1.5, 1.5, 1.0]),
        ("bush.hedge", [2.0, 0.8, 1.2]),
    ] {
        small.push((name.to_owned(), size, 0));
    }
    let works: Vec<(String, [f64; 3], u32)> =
        catalogue::works::all().map(|(name, size)| (name.to_owned(), size, 0)).collect();
    let mut canvas = Canvas::new(1800, 1100);
    canvas.draw(
        &sheet(&works, 9, 2.2),
        view(Vec3::new(4.5, 8.8, 4.5), Vec3::new(-2.6, 8.8, 0.3), 0.95, 1800.0 / 1100.0),
    );
    canvas.save(&out.join("world-works.png"))?;
    let mut canvas = Canvas::new(1800, 1100);
    canvas.draw(
        &sheet(&small, 9, 2.2),
        view(Vec3::new(6.5, 8.8, 6.0), Vec3::new(-4.0, 8.8, 0.3), 0.95, 1800.0 / 1100.0),
    );
    canvas.save(&out.join("world-small.png"))?;
    let signs: Vec<(String, [f64; 3], u32)> =
        PLATES.iter().map(|plate| (plate.model.to_owned(), plate.size_m, 100)).collect();
    let mut canvas = Canvas::new(1800, 1100);
    canvas.draw(
        &sheet(&signs, 6, 2.0),
        view(Vec3::new(6.0, 3.0, 2.0), Vec3::new(-2.0, 5.0, 0.2), 0.95, 1800.0 / 1100.0),
    );
    canvas.save(&out.join("world-signs.png"))?;
    let mut large: Vec<(String, [f64; 3], u32)> = Vec::new();
    for (name, size) in [
        ("building.block", [14.0, 22.0, 20.0]),
        ("building.tower", [20.0, 24.0, 45.0]),
        ("building.house", [9.0, 11.0, 9.0]),
        ("building.shop", [12.0, 18.0, 8.0]),
        ("building.hall", [22.0, 30.0, 10.0]),
        ("pole.lamp", [2.4, 0.28, 7.5]),
    ] {
        large.push((name.to_owned(), size, 2));
    }
    let mut canvas = Canvas::new(1800, 1100);
    canvas.draw(
        &sheet(&large, 6, 34.0),
        view(Vec3::new(75.0, 85.0, 48.0), Vec3::new(-20.0, 85.0, 8.0), 0.95, 1800.0 / 1100.0),
    );
    canvas.save(&out.join("world-large.png"))?;
    let mut plants: Vec<(String, [f64; 3], u32)> = Vec::new();
    for (name, size) in [
        ("tree.lime", [9.0, 9.0, 15.0]),
        ("tree.maple", [9.0, 9.0, 14.0]),
        ("tree.plane", [13.0, 13.0, 18.0]),
        ("tree.chestnut", [11.0, 11.0, 16.0]),
        ("tree.robinia", [8.0, 8.0, 14.0]),
        ("tree.oak", [12.0, 12.0, 16.0]),
        ("tree.ash", [10.0, 10.0, 17.0]),
        ("tree.birch", [6.0, 6.0, 15.0]),
        ("tree.hornbeam", [4.0, 4.0, 10.0]),
        ("tree.cherry", [6.0, 6.0, 7.0]),
        ("tree.poplar", [3.0, 3.0, 20.0]),
        ("tree.willow", [11.0, 11.0, 12.0]),
        ("tree.spruce", [5.0, 5.0, 18.0]),
        ("tree.pine", [6.0, 6.0, 15.0]),
        ("tree.palm", [5.0, 5.0, 12.0]),
        ("tree.lime", [3.0, 3.0, 6.0]),
        ("bush.round", [1.75, 1.75, 1.25]),
        ("bush.hedge", [5.0, 0.8, 1.2]),
    ] {
        plants.push((name.to_owned(), size, 2));
    }
    let mut canvas = Canvas::new(1800, 1100);
    canvas.draw(
        &sheet(&plants, 6, 16.0),
        view(Vec3::new(62.0, 40.0, 24.0), Vec3::new(-14.0, 40.0, 4.0), 0.95, 1800.0 / 1100.0),
    );
    canvas.save(&out.join("world-plants.png"))?;

    let place = arguments.get(1).map_or("convoy/demo", String::as_str);
    let network = match town::named(place) {
        Some(parameters) => Network::parse(&opendrive::write(&town::generate(&parameters)?))?,
        None => opendrive::read_bytes(&std::fs::read(place)?)?,
    };
    let map = Map::new(network);
    let coordinate = |k: usize| arguments.get(k).and_then(|v| v.parse::<f64>().ok());
    let start = match (coordinate(2), coordinate(3)) {
        (Some(x), Some(y)) => nalgebra::Point3::new(x, y, 0.0),
        _ => nalgebra::Point3::origin(),
    };
    let hit = map.nearest_driving_lane(start).unwrap();
    let here = map.lane_point(hit.lane, hit.s, 0.0).unwrap();
    let centre: [f64; 3] = here.position.coords.into();
    let rules = SceneryRules::default();
    let clock = std::time::Instant::now();
    let Surroundings { actors, ground } =
        TileMaker::new(&map, &rules, catalogue::Catalogue::built_in()).around(&[centre], 300.0, 1)?;
    println!("tiles {:?}: {} actors", clock.elapsed(), actors.len());
    let clock = std::time::Instant::now();
    let world = SceneWorld::new(&actors, ground)?;
    println!("new {:?}", clock.elapsed());
    let frame = FrameRow::default();
    let moment = Moment { states: &[], previous: &[], signals: &[], frame: &frame };
    let clock = std::time::Instant::now();
    let snapshot = world.snapshot(&moment, centre, 400.0);
    println!("snapshot {:?}: {} instances", clock.elapsed(), snapshot.instances.len());
    let triangles: usize = snapshot.instances.iter().map(|i| snapshot.mesh(i).triangles.len()).sum();
    println!("{triangles} triangles");
    let mut kinds = std::collections::BTreeMap::new();
    for actor in &actors {
        *kinds.entry((actor.kind, actor.model.split('.').next().unwrap_or("").to_owned())).or_insert(0) += 1;
    }
    println!("{kinds:?}");
    let local = snapshot.origin.local_from_world(centre);
    let (s, c) = frames::math::f32::sin_cos(here.heading_rad as f32);
    let ahead = Vec3::new(c, s, 0.0);
    for (name, eye, at, fov) in [
        ("world-street.png", local + Vec3::Z * 1.7, local + ahead * 30.0 + Vec3::Z * 1.5, 0.9),
        ("world-above.png", local - ahead * 60.0 + Vec3::Z * 45.0, local + ahead * 30.0, 0.9),
        ("world-top.png", local + Vec3::new(0.01, 0.0, 150.0), local, 0.9),
    ] {
        let mut canvas = Canvas::new(1600, 900);
        canvas.draw(&snapshot, view(eye, at, fov, 1600.0 / 900.0));
        canvas.save(&out.join(name))?;
    }
    let wanted = arguments.get(4);
    let things = actors.iter().filter(|a| wanted.is_some_and(|model| a.model.starts_with(model.as_str())));
    let mut things: Vec<_> = things.collect();
    let away =
        |p: [f64; 3]| (p[0] - centre[0]) * (p[0] - centre[0]) + (p[1] - centre[1]) * (p[1] - centre[1]);
    things.sort_by(|a, b| away(a.xyz_m).total_cmp(&away(b.xyz_m)));
    for (k, actor) in things.into_iter().take(12).enumerate() {
        let pose = Pose::<World, Object>::from_xyz_wxyz(actor.xyz_m, actor.quaternion);
        let (s, c) = frames::math::f32::sin_cos(pose.yaw() as f32);
        let at = snapshot.origin.local_from_world(actor.xyz_m);
        let ground =
            at.z - (actor.variant & 0xfff) as f32 * 0.01 * f32::from(actor.model.starts_with("sign"));
        let eye = Vec3::new(at.x + 9.0 * c - 3.0 * s, at.y + 9.0 * s + 3.0 * c, ground + 1.7);
        let mut canvas = Canvas::new(640, 400);
        canvas.draw(&snapshot, view(eye, Vec3::new(at.x, at.y, ground + 1.5), 0.9, 1.6));
        canvas.save(&out.join(format!("world-thing-{k}.png")))?;
        println!("{} {:?}", actor.model, actor.xyz_m);
    }
    Ok(())
}
