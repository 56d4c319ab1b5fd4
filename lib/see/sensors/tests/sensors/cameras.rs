//! Camera images against closed forms.

use std::collections::{BTreeMap, BTreeSet};

use crate::common::{
    at, block, camera, encoded, grey_sight, instance, optics, plane, sight, snapshot, standing_view, street,
    with_scene,
};
use frames::{Agent, LocalOrigin, Pose, Sensor, World, deg};
use glam::{Affine3A, Vec3};
use nalgebra::Point3;
use schema::Tag;
use schema::geometry::Surface;
use schema::images::{Depth, Flow, Instance, Rgb, Semantic};
use schema::tables::Weather;
use sensors::{Image, decode_depth_m, pixel_counts};
use settings::{CameraSettings, Lens, Mount, Optics};
use shading::Sight;

fn decode(bytes: &[u8]) -> (Vec<u8>, png::OutputInfo) {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().expect("is PNG");
    let mut data = vec![0; reader.output_buffer_size().expect("is small")];
    let info = reader.next_frame(&mut data).expect("has an image");
    (data, info)
}

#[test]
fn known_points_project_as_the_pinhole_formula_says() {
    // Small blocks at known places: their pixels' mean must be where K [R|t] puts their centres.
    // Neither square pixels nor the axis in the middle.
    let optics = Optics { fy: 500.0, cx: 371.3, cy: 260.7, ..optics(800, 450) };
    let pose = Pose::<World, Agent>::from_xyz_rpy([3.0, -2.0, 0.5], [0.02, -0.03, 0.7]);
    let mount = Mount { xyz_m: [0.4, 0.4, 1.6], rpy_rad: [0.0, 0.05, deg(55.0)] };
    let origin = LocalOrigin::near([0.0; 3]);
    let view = camera(mount, optics.clone(), &CameraSettings::default()).view(&origin, &pose, &pose);
    let k = optics.matrix();
    let world_from_sensor: Pose<World, Sensor> = pose * mount.agent_from_sensor();
    for (id, forward) in [(5u16, [12.0, 3.0, 1.0]), (300, [20.0, -8.0, -2.0]), (65535, [9.0, 0.0, 0.0])] {
        let centre = world_from_sensor * Point3::from(forward);
        let pose =
            Affine3A::from_translation(Vec3::new(centre.x as f32, centre.y as f32, centre.z as f32 - 0.1));
        let snapshot = snapshot(vec![block([0.2; 3], Tag::Car, Surface::Plain)], vec![instance(0, id, pose)]);
        let sight = with_scene(&snapshot, |scene| grey_sight(scene, &view));
        let (data, info) = decode(&encoded::<Instance>(&snapshot, &sight));
        let (mut u, mut v, mut n) = (0.0, 0.0, 0.0);
        for (i, p) in data.chunks_exact(3).enumerate() {
            if p[0] != Tag::Sky as u8 {
                assert_eq!((p[0], u16::from_le_bytes([p[1], p[2]])), (Tag::Car as u8, id));
                u += (i % info.width as usize) as f64 + 0.5;
                v += (i / info.width as usize) as f64 + 0.5;
                n += 1.0;
            }
        }
        // Forward, left, up to right, down, forward.
        let want_u = k[0][0] * -forward[1] / forward[0] + k[0][2];
        let want_v = k[1][1] * -forward[2] / forward[0] + k[1][2];
        assert!(n > 4.0);
        assert!((u / n - want_u).abs() < 1.0 && (v / n - want_v).abs() < 1.0, "{} {want_u}", u / n);
        let counts = pixel_counts(&snapshot, &sight.seen);
        assert_eq!(counts, BTreeMap::from([((id, Tag::Car), n as u32)]));
    }
}

/// The formulas of the lenses as they are printed.
fn bent(lens: &Lens, [x, y, z]: [f64; 3]) -> [f64; 2] {
    match *lens {
        Lens::Pinhole => [x / z, y / z],
        Lens::Brown { k: [k1, k2, k3], p: [p1, p2] } => {
            let (x, y) = (x / z, y / z);
            let r2 = x * x + y * y;
            let radial = 1.0 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
            [
                x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
                y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
            ]
        }
        Lens::Fisheye { k } => {
            let across = (x * x + y * y).sqrt();
            let angle = frames::math::atan2(across, z);
            let far =
                (0..4).map(|i| k[i] * frames::math::pow(angle, 2.0 * i as f64 + 3.0)).sum::<f64>() + angle;
            [x * far / across, y * far / across]
        }
    }
}

const LENSES: [Lens; 2] = [
    Lens::Brown { k: [-0.25, 0.08, -0.01], p: [2e-3, -1e-3] },
    Lens::Fisheye { k: [-0.03, 0.006, -0.001, 1e-4] },
];

#[test]
fn lenses_put_known_points_where_their_formulas_say() {
    let pose = Pose::<World, Agent>::from_xyz_rpy([3.0, -2.0, 0.5], [0.02, -0.03, 0.7]);
    let mount = Mount { xyz_m: [0.4, 0.4, 1.6], rpy_rad: [0.0, 0.05, deg(55.0)] };
    let world_from_sensor: Pose<World, Sensor> = pose * mount.agent_from_sensor();
    for lens in LENSES {
        let is_fisheye = matches!(lens, Lens::Fisheye { .. });
        let (fx, fy) = if is_fisheye { (220.0, 215.0) } else { (500.0, 510.0) };
        let optics = Optics { fx, fy, cx: 390.3, cy: 231.7, lens, ..optics(800, 450) };
        let view = camera(mount, optics.clone(), &CameraSettings::default()).view(
            &LocalOrigin::near([0.0; 3]),
            &pose,
            &pose,
        );
        // Forward, left, up; the last is beside the camera and a little behind it.
        let mut places = vec![[12.0, 3.0, 1.0], [9.0, -5.0, -2.5], [9.0, 0.5, 0.5]];
        places.extend(is_fisheye.then_some([-0.7, 8.0, 0.5]));
        for forward in places {
            let centre = world_from_sensor * Point3::from(forward);
            let at = Vec3::new(centre.x as f32, centre.y as f32, centre.z as f32 - 0.1);
            let instance = instance(0, 5, Affine3A::from_translation(at));
            let snapshot = snapshot(vec![block([0.2; 3], Tag::Car, Surface::Plain)], vec![instance]);
            let sight = with_scene(&snapshot, |scene| grey_sight(scene, &view));
            let (data, info) = decode(&encoded::<Instance>(&snapshot, &sight));
            let (depths, _) = decode(&encoded::<Depth>(&snapshot, &sight));
            let (mut u, mut v, mut n, mut depth_m) = (0.0, 0.0, 0.0, 0.0);
            for (i, (p, depth)) in data.as_chunks::<3>().0.iter().zip(depths.as_chunks::<3>().0).enumerate() {
                if p[0] == Tag::Car as u8 {
                    u += (i % info.width as usize) as f64 + 0.5;
                    v += (i / info.width as usize) as f64 + 0.5;
                    depth_m += decode_depth_m(*depth);
                    n += 1.0;
                }
            }
            let [x, y] = bent(&lens, [-forward[1], -forward[2], forward[0]]);
            let want = [optics.cx + fx * x, optics.cy + fy * y];
            let off = (u / n - want[0]).abs().max((v / n - want[1]).abs());
            assert!(n > 4.0 && off < 1.0, "{lens:?} {forward:?}: {} {} {want:?}", u / n, v / n);
            // Along the axis, of fisheyes along the ray; its near faces are seen.
            let range_m = forward.iter().map(|part| part * part).sum::<f64>().sqrt();
            let want_m = if is_fisheye { range_m } else { forward[0] };
            assert!((depth_m / n - want_m).abs() < 0.2, "{lens:?} {forward:?}: {} {want_m}", depth_m / n);
        }
    }
}

#[test]
fn a_lens_that_bends_nothing_sees_what_a_pinhole_does() {
    let street = street(false);
    let through = |lens| {
        let view = standing_view([0.0, -5.0, 0.0], [0.0; 3], Optics { lens, ..optics(320, 180) });
        with_scene(&street, |scene| sight(scene, &view, &Weather::default()))
    };
    let straight = through(Lens::Pinhole);
    let traced = through(Lens::Brown { k: [0.0; 3], p: [0.0; 2] });
    let pixels = straight.seen.depth_m.len();
    let differ = |unlike: usize, most: usize, what: &str| assert!(unlike <= most, "{unlike} {what} differ");
    let ids = straight.seen.instance.iter().zip(&traced.seen.instance).filter(|(a, b)| a != b).count();
    differ(ids, pixels / 1000, "ids");
    let depths = straight.seen.depth_m.iter().zip(&traced.seen.depth_m);
    differ(depths.filter(|(a, b)| a != b && (*a / *b - 1.0).abs() > 1e-3).count(), pixels / 500, "depths");
    let colours = |sight: &Sight| sight.picture.clone().expect("in colour").rgb;
    let far = colours(&straight).iter().zip(colours(&traced)).filter(|(a, b)| a.abs_diff(*b) > 4).count();
    differ(far, 3 * pixels / 200, "values");
}

#[test]
fn depth_decodes_to_the_buffer() {
    let snapshot = street(false);
    let view = standing_view([0.0, -5.0, 0.0], [0.0; 3], optics(320, 180));
    let sight = with_scene(&snapshot, |scene| grey_sight(scene, &view));
    assert!(sight.picture.is_none());
    let depth = encoded::<Depth>(&snapshot, &sight);
    let semantic = encoded::<Semantic>(&snapshot, &sight);
    let instance = encoded::<Instance>(&snapshot, &sight);
    let (data, _) = decode(&depth);
    for (p, depth) in data.as_chunks::<3>().0.iter().zip(&sight.seen.depth_m) {
        let want = f64::from(*depth).min(1000.0);
        assert!((decode_depth_m(*p) - want).abs() <= 1000.0 / 16_777_216.0);
    }
    for image in [&semantic, &instance, &depth] {
        // Byte 24 of a PNG is the bit depth, byte 25 the kind of colour: 2 is red, green, blue without a
        // palette.
        assert_eq!(image[24..26], [8, 2]);
    }
    // Semantic colours name the same tags as the instance image.
    let (semantic, _) = decode(&semantic);
    let (instance, _) = decode(&instance);
    for (s, i) in semantic.as_chunks::<3>().0.iter().zip(instance.as_chunks::<3>().0) {
        assert_eq!(Tag::from_u8(i[0]).expect("is a tag").camera_rgb(), *s);
    }
    assert_eq!(&instance[..3], &[Tag::Sky as u8, 0, 0]);
    // Pixels are counted by what the instance image says, object and tag together.
    let mut counts = BTreeMap::new();
    for [tag, low, high] in instance.as_chunks::<3>().0 {
        let key = (u16::from_le_bytes([*low, *high]), Tag::from_u8(*tag).expect("is a tag"));
        *counts.entry(key).or_insert(0) += 1;
    }
    counts.retain(|(id, _), _| *id != 0);
    assert_eq!(pixel_counts(&snapshot, &sight.seen), counts);
    let objects: BTreeSet<u16> = counts.keys().map(|(id, _)| *id).collect();
    assert!(objects.len() < counts.len(), "some object shows several tags");
}

#[test]
fn flow_is_the_difference_of_two_projections() {
    // A level plane seen by a camera that drives and turns, and a block that moves by itself.
    for lens in [Lens::Pinhole, LENSES[0], LENSES[1]] {
        flow_is_that_of(Optics { fx: 96.0, fy: 99.0, cx: 75.25, cy: 50.5, lens, ..optics(160, 90) });
    }
}

fn flow_is_that_of(optics: Optics) {
    let mount = Mount::upright([0.6, 0.0, 1.6], 0.0);
    let before = Pose::<World, Agent>::from_xyz_rpy([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]);
    let now = Pose::<World, Agent>::from_xyz_rpy([0.7, 0.05, 0.0], [0.0, 0.002, 0.03]);
    let origin = LocalOrigin::near([0.0; 3]);
    let view = camera(mount, optics.clone(), &CameraSettings::default()).view(&origin, &now, &before);
    let mut mover = instance(1, 2, at(15.0, -2.0, 0.0, 0.1));
    mover.previous_local_from_object = at(14.2, -2.0, 0.0, 0.0);
    let snapshot = snapshot(
        vec![
            plane(300.0, 0.0, Tag::Road, Surface::Asphalt),
            block([3.0, 2.0, 2.5], Tag::Car, Surface::Paint),
        ],
        vec![instance(0, 1, Affine3A::IDENTITY), mover],
    );
    let sight = with_scene(&snapshot, |scene| grey_sight(scene, &view));
    let flow = Flow::of(&snapshot, &sight, 0).expect("is no file");
    let buffer = &sight.seen;

    let optical = mount.agent_from_sensor() * frames::flu_from_optical();
    let (now_optical, before_optical) = (now * optical, (before * optical).inverse());
    let moved = |p: Point3<f64>| {
        // Block: undo the present pose, redo the one before.
        let local =
            mover.local_from_object.inverse().transform_point3(Vec3::new(p.x as f32, p.y as f32, p.z as f32));
        let was = mover.previous_local_from_object.transform_point3(local);
        Point3::new(f64::from(was.x), f64::from(was.y), f64::from(was.z))
    };
    let Optics { fx, fy, cx, cy, lens, .. } = optics;
    let (mut on_plane, mut on_block, mut on_sky) = (0, 0, 0);
    for y in 0..90u32 {
        for x in 0..160u32 {
            let i = buffer.index(x, y);
            let now = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            let ray = Point3::from(buffer.direction_optical(x, y).to_array().map(f64::from));
            let [u, v] = bent(&lens, [ray.x, ray.y, ray.z]);
            let off = (cx + fx * u - now[0]).abs().max((cy + fy * v - now[1]).abs());
            assert!(off < 1e-3, "{lens:?}: the ray of {now:?} is {off} pixels off");
            let was = match buffer.instance[i] {
                0 => {
                    // Closed form: the ray meets z = 0.
                    let direction = now_optical.rotate(ray.coords);
                    let eye = now_optical.translation();
                    on_plane += 1;
                    before_optical * Point3::from(eye - direction * (eye.z / direction.z))
                }
                1 => {
                    on_block += 1;
                    before_optical
                        * moved(now_optical * Point3::from(ray.coords * f64::from(buffer.depth_m[i])))
                }
                _ => {
                    on_sky += 1;
                    Point3::from(before_optical.rotate(now_optical.rotate(ray.coords)))
                }
            };
            let [u, v] = bent(&lens, [was.x, was.y, was.z]);
            let dx = (now[0] - cx - fx * u) * 2.0 / 160.0;
            let dy = -(now[1] - cy - fy * v) * 2.0 / 90.0;
            assert!((f64::from(flow.dx[i]) - dx).abs() < 2e-4, "{x} {y}: {} {dx}", flow.dx[i]);
            assert!((f64::from(flow.dy[i]) - dy).abs() < 2e-4, "{x} {y}: {} {dy}", flow.dy[i]);
        }
    }
    assert!(on_plane > 1000 && on_block > 50 && on_sky > 1000);
    // Driving forward, the ground ahead moves down: not up.
    assert!(flow.dy[buffer.index(80, 80)] < 0.0);
}

#[test]
fn what_stands_still_has_no_flow() {
    // A turned camera high above the street, so that no coordinate is a round number.
    let snapshot = street(false);
    let view = standing_view([0.0, -5.0, 5.7], [0.01, 0.33, 0.7], optics(320, 180));
    let sight = with_scene(&snapshot, |scene| grey_sight(scene, &view));
    let flow = Flow::of(&snapshot, &sight, 0).expect("is no file");
    let buffer = &sight.seen;
    let still = snapshot.instances.iter().map(|i| i.local_from_object == i.previous_local_from_object);
    let still: Vec<bool> = still.collect();
    let mut checked = 0;
    for (i, (dx, dy)) in flow.dx.iter().zip(&flow.dy).enumerate() {
        if still.get(buffer.instance[i] as usize).copied().unwrap_or(true) {
            assert_eq!((dx.to_bits(), dy.to_bits()), (0, 0), "pixel {i}");
            checked += 1;
        }
    }
    assert!(checked > 10_000);
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let snapshot = street(true);
    let weather =
        Weather { sun_altitude_deg: -10.0, precipitation: 40.0, fog_density: 10.0, ..Weather::default() };
    let view = standing_view([0.0, -5.0, 0.0], [0.0; 3], optics(320, 180));
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("starts");
        pool.install(|| {
            let sight = with_scene(&snapshot, |scene| sight(scene, &view, &weather));
            let files = [
                encoded::<Rgb>(&snapshot, &sight),
                encoded::<Semantic>(&snapshot, &sight),
                encoded::<Instance>(&snapshot, &sight),
                encoded::<Depth>(&snapshot, &sight),
            ];
            (files, Flow::of(&snapshot, &sight, 0).expect("is no file"), pixel_counts(&snapshot, &sight.seen))
        })
    };
    let (one, two) = (with(1), with(2));
    assert!(one == two);
    assert_eq!(&one.0[0][..2], &[0xff, 0xd8], "starts as a JPEG");
}
