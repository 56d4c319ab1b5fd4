//! The ray tracer against brute force and closed forms.

use glam::{Affine3A, Vec3};
use proptest::prelude::*;
use render::cpu::CpuRenderer;
use render::{Hit, Renderer};
use testkit::BruteRenderer;

use crate::cpu::common::*;

fn ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray { origin, direction, range_m: [0.0, 200.0] }
}

/// Whether two answers may differ: one is at an edge, or they are at the same place.
fn agree(ours: Option<Hit>, theirs: Option<Hit>) -> bool {
    let edge = |hit: &Option<Hit>| hit.as_ref().is_some_and(|h| edge_weight(h) < 1e-4);
    match (ours, theirs) {
        (None, None) => true,
        (Some(a), Some(b)) if (a.t - b.t).abs() <= 1e-4 * b.t.max(1.0) => {
            (a.instance, a.triangle) != (b.instance, b.triangle)
                || ((a.u - b.u).abs() < 2e-3 && (a.v - b.v).abs() < 2e-3)
        }
        (a, b) => edge(&a) || edge(&b),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn rays_find_what_brute_force_finds(number in 0u64..1000) {
        let world = world(number);
        let renderer = prepared(&world);
        let scene = &*renderer.place(&world).unwrap();
        let mut brute = BruteRenderer::default();
        brute.prepare(&world.meshes).unwrap();
        let every = &*brute.place(&world).unwrap();
        let mut s = stream("rays", number);
        let mut hits = 0;
        for _ in 0..24 {
            let ray = ray(point(&mut s, 30.0), unit(&mut s));
            let (ours, theirs) = (trace(scene, &ray), trace(every, &ray));
            prop_assert!(agree(ours, theirs), "{ray:?}: {ours:?} {theirs:?}");
            hits += usize::from(ours.is_some());
        }
        prop_assert!(hits > 2);
    }

    #[test]
    fn packets_are_single_rays_bit_for_bit(
        number in 0u64..1000,
        count in 0usize..70,
        spread in prop_oneof![Just(0.3_f32), Just(0.01)],
        along_axis: bool,
    ) {
        let world = world(number);
        let renderer = prepared(&world);
        let scene = &*renderer.place(&world).unwrap();
        let mut s = stream("packets", number);
        let origin = point(&mut s, 20.0);
        // About an axis some lanes go up, others down the other two.
        let towards = if along_axis { Vec3::X } else { unit(&mut s) };
        let directions: Vec<Vec3> =
            (0..count).map(|_| (towards + unit(&mut s) * spread).normalize()).collect();
        let range_m = [0.5, 80.0];
        let out = trace_all(scene, origin, &directions, range_m);
        for (direction, packet) in directions.iter().zip(out.iter()) {
            let single = trace(scene, &Ray { origin, direction: *direction, range_m });
            let bits = |h: Option<Hit>| h.map(|h| {
                (h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.instance, h.triangle)
            });
            prop_assert_eq!(bits(packet), bits(single));
        }
    }
}

#[test]
fn a_floor_is_hit_at_the_closed_form_distance() {
    let world = snapshot(vec![floor(8, 50.0)], vec![instance(0, 1, Affine3A::IDENTITY)]);
    let renderer = prepared(&world);
    let scene = &*renderer.place(&world).unwrap();
    let mut s = stream("floor", 0);
    for _ in 0..500 {
        let origin =
            Vec3::new(uniform(&mut s, -9.0, 9.0), uniform(&mut s, -9.0, 9.0), uniform(&mut s, 1.0, 9.0));
        let target = Vec3::new(uniform(&mut s, -45.0, 45.0), uniform(&mut s, -45.0, 45.0), 0.0);
        let direction = (target - origin).normalize();
        let hit = trace(scene, &ray(origin, direction)).unwrap();
        let expected = (target - origin).length();
        assert!((hit.t - expected).abs() < 1e-5 * expected * (expected / origin.z), "{hit:?} {expected}");
        assert!(trace(scene, &ray(origin, -direction)).is_none());
        for range_m in [[0.0, expected * 0.99], [expected * 1.01, 200.0]] {
            assert!(trace(scene, &Ray { range_m, ..ray(origin, direction) }).is_none());
        }
    }
}

#[test]
fn nothing_leaks_between_neighbours() {
    // From inside a closed ball every ray must hit, also those aimed exactly at edges and corners.
    let mut s = stream("leaks", 0);
    let meshes = vec![ball(&mut s, 20, 30, 4.0)];
    let place = pose(&mut s, 60.0);
    let world = snapshot(meshes, vec![instance(0, 1, place)]);
    let renderer = prepared(&world);
    let scene = &*renderer.place(&world).unwrap();
    let source = &world.meshes[0];
    let origin = place.transform_point3(Vec3::new(0.3, -0.2, 0.1));
    let mut directions = Vec::new();
    for triangle in 0..source.triangles.len() {
        let corners = source.corners(triangle);
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            for share in [0.0, 0.25, 0.5, uniform(&mut s, 0.0, 1.0)] {
                directions.push((place.transform_point3(a.lerp(b, share)) - origin).normalize());
            }
        }
    }
    directions.extend((0..20_000).map(|_| unit(&mut s)));
    let out = trace_all(scene, origin, &directions, [0.0, f32::INFINITY]);
    let leaks = out.iter().filter(|h| h.is_none()).count();
    assert_eq!(leaks, 0, "of {}", out.len());
}

#[test]
fn rays_within_planes_and_along_axes_are_safe() {
    // The floor's box has no height, and the rays run within its plane or along its grid lines.
    let world = snapshot(vec![floor(4, 2.0)], vec![instance(0, 1, Affine3A::IDENTITY)]);
    let renderer = prepared(&world);
    let scene = &*renderer.place(&world).unwrap();
    for direction in [Vec3::X, Vec3::NEG_Y, Vec3::new(0.6, 0.8, 0.0)] {
        let within = trace(scene, &ray(Vec3::new(-5.0, 0.0, 0.0), direction));
        assert!(within.is_none_or(|h| h.t.is_finite()));
    }
    // Straight down onto a corner that six triangles share, and onto the outermost corner.
    for (x, y) in [(0.0, 0.0), (1.0, -1.0), (2.0, 2.0), (-2.0, 0.5)] {
        let hit = trace(scene, &ray(Vec3::new(x, y, 3.0), Vec3::NEG_Z)).unwrap();
        assert_eq!(hit.t, 3.0);
    }
}

#[test]
fn the_smaller_number_wins_ties() {
    let twice = {
        let one = floor(1, 5.0);
        let mut triangles = one.triangles.clone();
        triangles.extend(&one.triangles);
        mesh(one.positions.clone(), triangles)
    };
    for order in [[0u32, 1], [1, 0]] {
        let instances = order.map(|m| instance(m, 1, Affine3A::IDENTITY)).to_vec();
        let world = snapshot(vec![floor(1, 5.0), twice.clone()], instances);
        let renderer = prepared(&world);
        let scene = &*renderer.place(&world).unwrap();
        let hit = trace(scene, &ray(Vec3::new(1.0, 2.0, 4.0), Vec3::NEG_Z)).unwrap();
        assert!(hit.instance == 0 && hit.triangle < 2, "{hit:?}");
    }
}

#[test]
fn degenerate_and_absent_things_are_not_seen() {
    let a = Vec3::new(0.0, 0.0, 1.0);
    let flat = mesh(
        vec![a, a, a + Vec3::X, a + 2.0 * Vec3::X, Vec3::new(f32::NAN, 0.0, 1.0)],
        vec![[0, 1, 2], [0, 2, 3], [0, 0, 0], [0, 2, 4]],
    );
    let lost = Affine3A::from_translation(Vec3::splat(f32::NAN));
    let world = snapshot(
        vec![flat, mesh(vec![], vec![]), floor(2, 3.0)],
        vec![
            instance(0, 1, Affine3A::IDENTITY),
            instance(1, 2, Affine3A::IDENTITY),
            instance(2, 3, lost),
            instance(2, 4, Affine3A::IDENTITY),
        ],
    );
    let renderer = prepared(&world);
    let scene = &*renderer.place(&world).unwrap();
    for x in [-1.0, 0.0, 0.5, 1.5] {
        let hit = trace(scene, &ray(Vec3::new(x, 0.0, 3.0), Vec3::NEG_Z)).unwrap();
        assert_eq!((hit.instance, hit.t), (3, 3.0));
    }
    let nothing = snapshot(vec![], vec![]);
    let renderer = CpuRenderer::default();
    let scene = &*renderer.place(&nothing).unwrap();
    assert_eq!(trace(scene, &ray(Vec3::ZERO, Vec3::X)), None);
    assert_eq!(trace(scene, &ray(Vec3::ZERO, Vec3::splat(f32::NAN))), None);
}

#[test]
fn meshes_can_be_appended() {
    let world = snapshot(
        vec![floor(1, 5.0), floor(2, 5.0)],
        vec![instance(1, 1, Affine3A::IDENTITY), instance(0, 2, Affine3A::from_translation(Vec3::Z))],
    );
    let mut renderer = CpuRenderer::default();
    renderer.prepare(&world.meshes[..1]).unwrap();
    renderer.prepare(&world.meshes[1..]).unwrap();
    let scene = &*renderer.place(&world).unwrap();
    assert_eq!(trace(scene, &ray(Vec3::new(0.5, 1.0, 5.0), Vec3::NEG_Z)).unwrap().instance, 1);
    assert_eq!(trace(scene, &ray(Vec3::new(0.5, 1.0, -5.0), Vec3::Z)).unwrap().instance, 0);
}
