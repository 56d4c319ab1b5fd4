//! The rasteriser against the ray tracer and closed forms.

use glam::{Affine3A, Vec3};
use render::{PinholeCamera, RayQuery, SKY, Surfaces, VisibilityBuffer};
use schema::geometry::Snapshot;
use testkit::{Agreement, PixelRays};

use crate::cpu::common::*;

/// A camera at the origin that looks along x.
fn forward(width: u32, height: u32, focal: f32) -> PinholeCamera {
    let mut camera = camera_at(Vec3::ZERO, Vec3::X, width, height, 1.0);
    (camera.fx, camera.fy) = (focal, focal);
    camera
}

/// A rectangle across the x axis at a distance, from (left, top) to (right, bottom) in metres.
fn wall(distance: f32, left: f32, top: f32, right: f32, bottom: f32) -> Vec<Vec3> {
    // Right of the picture is -y, down is -z.
    [(left, top), (left, bottom), (right, bottom), (right, top)]
        .map(|(x, y)| Vec3::new(distance, -x, -y))
        .to_vec()
}

const QUAD: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

fn quads(list: &[Vec<Vec3>]) -> Snapshot {
    let meshes: Vec<_> = list.iter().map(|corners| mesh(corners.clone(), QUAD.to_vec())).collect();
    let instances = (0..meshes.len()).map(|i| instance(i as u32, 1 + i as u16, Affine3A::IDENTITY)).collect();
    snapshot(meshes, instances)
}

/// The pixels of a picture against rays: all alike but where rounding decides.
fn compare(world: &Snapshot, camera: &PinholeCamera) -> Agreement {
    let rays = PixelRays::new(camera);
    with_scene(world, |scene| {
        let hits = scene.trace(&[RayQuery::of(rays.batch())]).unwrap().remove(0);
        rays.compare(world, &see(scene, camera), &hits).unwrap()
    })
}

#[test]
fn the_rasteriser_sees_what_rays_see() {
    let mut all = Agreement::default();
    for number in 0..10 {
        let world = world(number);
        let mut s = stream("cameras", number);
        let from = point(&mut s, 15.0) * Vec3::new(1.0, 1.0, 0.3);
        let mut camera =
            camera_at(from, unit(&mut s) * Vec3::new(1.0, 1.0, 0.3), 203, 117, uniform(&mut s, 0.4, 2.4));
        camera.cx += 7.3;
        camera.fy *= 1.1;
        all += compare(&world, &camera);
    }
    // What rounding decides is rare.
    assert!(all.seen > 20_000 && all.on_edges * 50 < all.seen, "{all:?}");
}

#[test]
fn cameras_inside_the_clutter_see_what_rays_see() {
    // Loose triangles all around and through the camera: many cross the near plane.
    for number in 0..6 {
        let mut s = stream("inside", number);
        let meshes = vec![soup(&mut s, 300, 2.0, 2.0), soup(&mut s, 300, 0.3, 0.2)];
        let world =
            snapshot(meshes, vec![instance(0, 1, Affine3A::IDENTITY), instance(1, 2, Affine3A::IDENTITY)]);
        let camera = camera_at(Vec3::ZERO, unit(&mut s), 150, 100, 1.6);
        let all = compare(&world, &camera);
        assert!(all.seen > 5000 && all.on_edges * 20 < all.seen, "{all:?}");
    }
}

#[test]
fn a_wall_covers_exactly_its_pixels() {
    // At 10 m with a focal length of 100 px, a metre is 10 px: columns 70 +- 20, rows 50 +- 10, moved by
    // nothing and by just less and just more than half a pixel.
    let camera = forward(140, 100, 100.0);
    for (shift, columns, rows) in [(0.0, 50..90, 40..60), (0.049, 50..90, 40..60), (0.051, 51..91, 41..61)] {
        let world = quads(&[wall(10.0, -2.0 + shift, -1.0 + shift, 2.0 + shift, 1.0 + shift)]);
        let buffer = with_scene(&world, |scene| see(scene, &camera));
        for y in 0..100 {
            for x in 0..140 {
                let i = buffer.index(x, y);
                let inside = columns.contains(&x) && rows.contains(&y);
                assert_eq!(buffer.instance[i], if inside { 0 } else { SKY }, "{shift}: {x} {y}");
                assert!(if inside {
                    (buffer.depth_m[i] - 10.0).abs() < 1e-5
                } else {
                    buffer.depth_m[i] > 1e9
                });
            }
        }
    }
}

#[test]
fn neighbours_share_no_pixel_and_leave_none_out() {
    // Two walls share an edge through pixel centres, at the same depth: each pixel is seen once whatever the
    // order, and nothing shines through.
    let camera = forward(64, 64, 64.0);
    let left = wall(1.0, -0.4, -0.4, 1.0 / 128.0, 0.4);
    let right = wall(1.0, 1.0 / 128.0, -0.4, 0.4, 0.4);
    let both =
        |a: &Vec<Vec3>, b: &Vec<Vec3>| with_scene(&quads(&[a.clone(), b.clone()]), |s| see(s, &camera));
    let first = both(&left, &right);
    let second = both(&right, &left);
    let swapped: Vec<u32> = second.instance.iter().map(|&i| if i == SKY { SKY } else { 1 - i }).collect();
    assert_eq!(first.instance, swapped);
    assert_eq!(first.depth_m, second.depth_m);
    let alone = |a: &Vec<Vec3>| with_scene(&quads(std::slice::from_ref(a)), |s| see(s, &camera));
    let covered = |b: &VisibilityBuffer| b.instance.iter().filter(|&&i| i != SKY).count();
    assert_eq!(covered(&alone(&left)) + covered(&alone(&right)), covered(&first));
}

#[test]
fn a_closed_ball_has_no_cracks() {
    // Seen from inside, no pixel may show the sky.
    let mut s = stream("cracks", 0);
    let place = pose(&mut s, 40.0);
    let world = snapshot(vec![ball(&mut s, 40, 60, 3.0)], vec![instance(0, 1, place)]);
    with_scene(&world, |scene| {
        for along in [Vec3::X, Vec3::new(-1.0, 0.4, 2.0), Vec3::new(0.1, -1.0, -0.5)] {
            let from = place.transform_point3(Vec3::new(0.5, 0.9, -0.7));
            let buffer = see(scene, &camera_at(from, along, 500, 300, 2.0));
            assert!(buffer.instance.iter().all(|&i| i == 0));
        }
    });
}

#[test]
fn a_floor_has_the_closed_form_depth() {
    // Height h over a floor, level camera: depth = h * fy / (row - cy).
    let mut camera = forward(200, 120, 150.0);
    camera.local_from_optical.translation.z = 1.7;
    let world = snapshot(vec![floor(30, 900.0)], vec![instance(0, 1, Affine3A::IDENTITY)]);
    let buffer = with_scene(&world, |scene| see(scene, &camera));
    for y in 0..120 {
        let expected = 1.7 * 150.0 / (y as f32 + 0.5 - 60.0);
        for x in 0..200 {
            let depth = buffer.depth_m[buffer.index(x, y)];
            if expected <= 0.0 {
                assert!(depth.is_infinite());
            } else if expected < 800.0 {
                assert!((depth / expected - 1.0).abs() < 1e-5, "{x} {y}: {depth} {expected}");
            }
        }
    }
}

#[test]
fn near_and_far_end_the_view() {
    let mut camera = forward(40, 40, 40.0);
    let at = |distance: f32| wall(distance, -50.0, -50.0, 50.0, 50.0);
    let sees = |camera: &PinholeCamera, list: &[Vec<Vec3>]| {
        with_scene(&quads(list), |scene| see(scene, camera)).depth_m[20 * 40 + 20]
    };
    assert_eq!(sees(&camera, &[at(0.04), at(3.0)]), 3.0);
    assert_eq!(sees(&camera, &[at(-2.0), at(3.0)]), 3.0);
    camera.far_m = 2.0;
    assert!(sees(&camera, &[at(3.0)]).is_infinite());
    assert_eq!(sees(&camera, &[at(2.0)]), 2.0);
}

#[test]
fn the_smaller_number_wins_ties() {
    let camera = forward(40, 40, 40.0);
    let quad = wall(4.0, -1.0, -1.0, 1.0, 1.0);
    let buffer = with_scene(&quads(&[quad.clone(), quad]), |scene| see(scene, &camera));
    assert_eq!(buffer.instance[20 * 40 + 20], 0);
    assert!(buffer.instance.iter().all(|&i| i == 0 || i == SKY));
}

#[test]
fn thread_counts_change_no_byte() {
    let world = world(77);
    let camera = camera_at(Vec3::new(1.0, -20.0, 3.0), Vec3::new(0.1, 1.0, -0.1), 301, 199, 1.3);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            with_scene(&world, |scene| {
                let mut s = stream("threads", 0);
                let directions: Vec<Vec3> = (0..5000).map(|_| unit(&mut s)).collect();
                (see(scene, &camera), trace_all(scene, Vec3::Z, &directions, [0.0, 100.0]))
            })
        })
    };
    let (one, two) = (run(1), run(2));
    assert_eq!(one, two);
    assert!(one.0.instance.iter().any(|&i| i != SKY) && one.1.iter().any(|hit| hit.is_some()));
}

#[test]
fn empty_pictures_and_scenes() {
    let nothing = snapshot(vec![], vec![]);
    let buffer = with_scene(&nothing, |scene| see(scene, &forward(70, 35, 40.0)));
    assert!(buffer.instance.len() == 70 * 35 && buffer.instance.iter().all(|&i| i == SKY));
    let world = world(1);
    with_scene(&world, |scene| {
        assert!(see(scene, &forward(0, 35, 40.0)).instance.is_empty());
        assert!(see(scene, &forward(35, 0, 40.0)).instance.is_empty());
    });
}

/// Weights of a triangle's corners at the foot of a point on its plane; they sum to 1.
fn weights([a, b, c]: [Vec3; 3], point: Vec3) -> [f32; 3] {
    let normal = (b - a).cross(c - a);
    let share = |p: Vec3, q: Vec3| (p - point).cross(q - point).dot(normal) / normal.length_squared();
    [share(b, c), share(c, a), share(a, b)]
}

#[test]
fn surface_points_lie_on_their_triangles() {
    let world = world(3);
    let camera = camera_at(Vec3::new(2.0, -25.0, 4.0), Vec3::new(0.0, 1.0, -0.1), 160, 90, 1.2);
    with_scene(&world, |scene| {
        let buffer = see(scene, &camera);
        let surfaces = Surfaces::new(&buffer, &world);
        let eye = Vec3::from(camera.local_from_optical.translation);
        let mut seen = 0;
        for y in 0..90 {
            for x in 0..160 {
                let i = buffer.index(x, y);
                let Some(point) = surfaces.at(x, y) else {
                    assert_eq!(buffer.instance[i], SKY);
                    continue;
                };
                seen += 1;
                let placed = &world.instances[point.instance as usize];
                let [a, b, c] = world.mesh(placed).corners(point.triangle as usize);
                // Within the triangle: in its plane, and inside its edges by their areas.
                let [u, v, w] = weights([a, b, c], point.position_object);
                assert!(u.min(v).min(w) > -1e-3, "{point:?}");
                let tolerance = 1e-5 * (10.0 + point.depth_m);
                let by_weights = a * u + b * v + c * w;
                assert!((by_weights - point.position_object).length() < tolerance, "{point:?}");
                let local = placed.local_from_object.transform_point3(point.position_object);
                assert!((local - point.position_local).length() < tolerance);
                assert!((point.depth_m / buffer.depth_m[i] - 1.0).abs() < 1e-4, "{point:?}");
                // It projects back onto the pixel's centre.
                let optical = camera.local_from_optical.inverse().transform_point3(point.position_local);
                let column = camera.fx * optical.x / optical.z + camera.cx;
                let row = camera.fy * optical.y / optical.z + camera.cy;
                assert!((column - x as f32 - 0.5).abs() < 5e-3 && (row - y as f32 - 0.5).abs() < 5e-3);
                assert!((point.normal_local.length() - 1.0).abs() < 1e-5);
                assert!(point.normal_local.dot(eye - point.position_local) >= 0.0);
                let normal = placed.local_from_object.transform_vector3((b - a).cross(c - a).normalize());
                assert!(normal.dot(point.normal_local).abs() > 0.9999);
            }
            // Eight at a time they are the same.
            surfaces.for_each_span(y, |span, triangle| {
                for x in span {
                    let point = surfaces.at(x, y).map(|p| (p.position_object, p.position_local, p.depth_m));
                    let points =
                        triangle.map(|t| t.points(&buffer, &[x.saturating_sub(3), 0, x, x, 1, 2, 3, 4], y));
                    let third = points.map(|p| {
                        (p.position_object.lane(2), p.position_local.lane(2), p.depth_m.as_array()[2])
                    });
                    assert_eq!(third, point, "{x} {y}");
                }
            });
        }
        assert!(seen > 5000);
    });
}
