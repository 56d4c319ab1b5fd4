//! Worlds put together from boxes and sheets.

use std::sync::Arc;

use frames::{LocalOrigin, Object, Pose, World};
use glam::{Affine3A, Vec3};
use schema::Tag;
use schema::geometry::{Instance, MeshPart, Snapshot, Surface, TriMesh};

/// Collects meshes and instances.
#[derive(Clone, Debug, Default)]
pub struct WorldBuilder {
    meshes: Vec<Arc<TriMesh>>,
    instances: Vec<(u32, u16, Pose<World, Object>)>,
}

impl WorldBuilder {
    /// Adds a mesh and returns its number.
    pub fn mesh(&mut self, mesh: TriMesh) -> u32 {
        self.meshes.push(Arc::new(mesh));
        self.meshes.len() as u32 - 1
    }

    /// Places a mesh: metres, radians.
    pub fn place(&mut self, mesh: u32, object: u16, xyz_m: [f64; 3], rpy_rad: [f64; 3]) {
        self.instances.push((mesh, object, Pose::from_xyz_rpy(xyz_m, rpy_rad)));
    }

    /// Adds a mesh and places it.
    pub fn add(&mut self, mesh: TriMesh, object: u16, xyz_m: [f64; 3], rpy_rad: [f64; 3]) {
        let mesh = self.mesh(mesh);
        self.place(mesh, object, xyz_m, rpy_rad);
    }

    /// The world, with the origin of its coordinates near a place.
    #[must_use]
    pub fn snapshot(&self, near_m: [f64; 3]) -> Snapshot {
        let origin = LocalOrigin::near(near_m);
        let instance = |&(mesh, object, pose): &(u32, u16, Pose<World, Object>)| {
            let local_from_object: Affine3A = origin.local_from_body(&pose);
            Instance {
                mesh,
                object,
                local_from_object,
                previous_local_from_object: local_from_object,
                paint: [0.5; 3],
                lights: 0,
                glow: [1.0; 3],
            }
        };
        Snapshot {
            origin,
            meshes: self.meshes.clone().into(),
            instances: self.instances.iter().map(instance).collect(),
            cabins: Vec::new(),
            motions: Vec::new(),
        }
    }
}

fn part(tag: Tag) -> MeshPart {
    MeshPart { tag, surface: Surface::Plain, rgb: [0.5; 3] }
}

/// A closed grey box that stands on z = 0, each face in `n` x `n` pairs of triangles.
#[must_use]
pub fn box_mesh(tag: Tag, size_m: [f32; 3], n: usize) -> TriMesh {
    let mut mesh = TriMesh { parts: vec![part(tag)], ..TriMesh::default() };
    let size = Vec3::from(size_m);
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in [0.0, 1.0] {
            let base = mesh.positions.len() as u32;
            for a in 0..=n {
                for b in 0..=n {
                    let mut p = Vec3::ZERO;
                    p[axis] = side;
                    p[u] = a as f32 / n as f32;
                    p[v] = b as f32 / n as f32;
                    mesh.positions.push((p - Vec3::new(0.5, 0.5, 0.0)) * size);
                }
            }
            for a in 0..n as u32 {
                for b in 0..n as u32 {
                    let row = n as u32 + 1;
                    let q = [a * row + b, (a + 1) * row + b, (a + 1) * row + b + 1, a * row + b + 1]
                        .map(|i| base + i);
                    let turned = |t: [u32; 3]| if side > 0.5 { t } else { [t[0], t[2], t[1]] };
                    mesh.triangles.push(turned([q[0], q[1], q[2]]));
                    mesh.triangles.push(turned([q[0], q[2], q[3]]));
                }
            }
        }
    }
    mesh.triangle_part = vec![0; mesh.triangles.len()];
    mesh
}

/// A grey surface over a rectangle, in steps of about `step_m`; its height in metres by x and y.
pub fn sheet(
    tag: Tag,
    x_m: [f32; 2],
    y_m: [f32; 2],
    step_m: f32,
    height: impl Fn(f32, f32) -> f32,
) -> TriMesh {
    let mut mesh = TriMesh { parts: vec![part(tag)], ..TriMesh::default() };
    let steps = |range: [f32; 2]| ((range[1] - range[0]) / step_m).ceil().max(1.0) as u32;
    let (nx, ny) = (steps(x_m), steps(y_m));
    for i in 0..=nx {
        for j in 0..=ny {
            let x = x_m[0] + (x_m[1] - x_m[0]) * i as f32 / nx as f32;
            let y = y_m[0] + (y_m[1] - y_m[0]) * j as f32 / ny as f32;
            mesh.positions.push(Vec3::new(x, y, height(x, y)));
        }
    }
    for i in 0..nx {
        for j in 0..ny {
            let at = |i: u32, j: u32| i * (ny + 1) + j;
            mesh.triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            mesh.triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    mesh.triangle_part = vec![0; mesh.triangles.len()];
    mesh
}

/// A crossing in a town: two roads with lines and sidewalks, houses, trees, traffic, people; about 110 000
/// triangles within 64 m. The ground rolls gently.
#[must_use]
pub fn small_town() -> Snapshot {
    let mut b = WorldBuilder::default();
    let hills = |x: f32, y: f32| 0.006 * x + 0.0002 * (x - 3.0) * y;
    let mut id = 1;
    let mut next = || {
        id += 1;
        id
    };
    let ground = next();
    // Beside the roads, in four quarters: terrain, then sidewalks along the roads.
    for (sx, sy) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0_f32)] {
        let q = |a: f32, b: f32, s: f32| if s > 0.0 { [a, b] } else { [-b, -a] };
        b.add(
            sheet(Tag::Terrain, q(11.0, 100.0, sx), q(11.0, 100.0, sy), 2.0, hills),
            ground,
            [0.0; 3],
            [0.0; 3],
        );
        let raised = |x: f32, y: f32| hills(x, y) + 0.14;
        b.add(
            sheet(Tag::Sidewalk, q(8.0, 100.0, sx), q(8.0, 11.0, sy), 1.0, raised),
            ground,
            [0.0; 3],
            [0.0; 3],
        );
        b.add(
            sheet(Tag::Sidewalk, q(8.0, 11.0, sx), q(11.0, 100.0, sy), 1.0, raised),
            ground,
            [0.0; 3],
            [0.0; 3],
        );
    }
    let line = |x: f32, y: f32| hills(x, y) + 0.005;
    b.add(sheet(Tag::Road, [-100.0, 100.0], [-8.0, 8.0], 1.0, hills), ground, [0.0; 3], [0.0; 3]);
    b.add(sheet(Tag::Road, [-8.0, 8.0], [8.0, 100.0], 1.0, hills), ground, [0.0; 3], [0.0; 3]);
    b.add(sheet(Tag::Road, [-8.0, 8.0], [-100.0, -8.0], 1.0, hills), ground, [0.0; 3], [0.0; 3]);
    for at in [-4.0, -0.1, 0.1, 4.0_f32] {
        b.add(
            sheet(Tag::RoadLine, [8.0, 100.0], [at - 0.06, at + 0.06], 3.0, line),
            ground,
            [0.0; 3],
            [0.0; 3],
        );
        b.add(
            sheet(Tag::RoadLine, [-100.0, -8.0], [at - 0.06, at + 0.06], 3.0, line),
            ground,
            [0.0; 3],
            [0.0; 3],
        );
        b.add(
            sheet(Tag::RoadLine, [at - 0.06, at + 0.06], [8.0, 100.0], 3.0, line),
            ground,
            [0.0; 3],
            [0.0; 3],
        );
        b.add(
            sheet(Tag::RoadLine, [at - 0.06, at + 0.06], [-100.0, -8.0], 3.0, line),
            ground,
            [0.0; 3],
            [0.0; 3],
        );
    }

    let stand = |x: f64, y: f64| [x, y, f64::from(hills(x as f32, y as f32))];
    let house = b.mesh(box_mesh(Tag::Building, [14.0, 12.0, 5.0], 10));
    let crown = b.mesh(box_mesh(Tag::Vegetation, [3.0, 3.2, 3.0], 7));
    let trunk = b.mesh(box_mesh(Tag::Pole, [0.3, 0.3, 2.2], 2));
    for k in 0..7 {
        let along = 20.0 + 12.0 * f64::from(k);
        for (sx, sy) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            if k % 2 == 0 {
                let place = stand(sx * along, sy * 24.0);
                b.place(house, next(), place, [0.0, 0.0, 0.03 * along]);
            }
            for (x, y) in [(sx * along, sy * 14.0), (sx * 14.0, sy * along)] {
                let (tree, [x, y, z]) = (next(), stand(x, y));
                b.place(trunk, tree, [x, y, z], [0.0; 3]);
                b.place(crown, tree, [x, y, z + 2.0], [0.0, 0.0, along]);
            }
        }
    }
    // Bodies hang above the road.
    let ride = |x: f64, y: f64| [x, y, f64::from(hills(x as f32, y as f32)) + 0.25];
    let car = b.mesh(box_mesh(Tag::Car, [4.6, 1.9, 1.5], 11));
    let bus = b.mesh(box_mesh(Tag::Bus, [12.0, 2.5, 3.1], 10));
    let bike = b.mesh(box_mesh(Tag::Bicycle, [1.8, 0.5, 1.0], 6));
    let rider = b.mesh(box_mesh(Tag::Rider, [0.4, 0.5, 1.0], 5));
    let walker = b.mesh(box_mesh(Tag::Pedestrian, [0.4, 0.55, 1.75], 7));
    let cone = b.mesh(box_mesh(Tag::TrafficCone, [0.36, 0.36, 0.7], 3));
    for k in 0..9 {
        let along = -54.0 + 13.0 * f64::from(k) + 0.37 * f64::from(k * k % 5);
        for (lane, yaw) in [(-2.0, 0.0), (-6.0, 0.01), (2.0, 3.1), (6.0, 3.15)] {
            let mesh = if (k + lane as i32) % 7 == 0 { bus } else { car };
            b.place(mesh, next(), ride(along + lane, lane), [0.0, -0.006, yaw]);
        }
        b.place(
            car,
            next(),
            ride(2.0, along + if along.abs() < 12.0 { 70.0 } else { 0.0 }),
            [0.0, 0.0, 1.57],
        );
        let cyclist = next();
        let [x, y, z] = stand(along * 0.9, 7.2);
        b.place(bike, cyclist, [x, y, z], [0.0, 0.0, 3.1]);
        b.place(rider, cyclist, [x, y, z + 0.8], [0.0, 0.0, 3.1]);
        for side in [9.0, 10.2, -9.4] {
            let [x, y, z] = stand(along + side, side);
            b.place(walker, next(), [x, y, z + 0.14], [0.0, 0.0, along]);
        }
        b.place(cone, next(), stand(20.0 + 1.5 * f64::from(k), -4.6), [0.0; 3]);
    }
    b.snapshot([0.0; 3])
}
