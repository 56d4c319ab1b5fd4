//! Vehicles as near and as far as they are drawn.

use std::collections::{BTreeMap, BTreeSet};

use catalogue::models::vehicles;

use super::*;
use crate::actors::wheel::Wheels;

/// The levels of a vehicle, the nearest first.
fn levels(model: &Model) -> Vec<Vec<Piece>> {
    let actor = made(model.name, model.size_m, 0);
    std::iter::once(actor.pieces).chain(actor.coarser.into_iter().map(|level| level.pieces)).collect()
}

fn on_four_wheels() -> impl Iterator<Item = &'static Model> {
    let driven = vehicles().filter(|m| !matches!(m.base, BaseType::Motorcycle | BaseType::Bicycle));
    driven.chain(trains::sections())
}

/// Where pieces are at rest that are seen while doors are closed.
fn placed(pieces: &[Piece], posture: &Posture) -> Vec<[Vec3; 3]> {
    let seen = pieces.iter().filter_map(|p| Some((p, p.joint.object_from_piece(posture)?)));
    seen.flat_map(|(p, pose)| {
        (0..p.mesh.triangles.len()).map(move |i| p.mesh.corners(i).map(|c| pose.transform_point3(c)))
    })
    .collect()
}

/// Of each vertex of a mesh one that it hangs together with, the same of all that do.
pub(super) fn roots(mesh: &TriMesh) -> Vec<usize> {
    let mut root: Vec<usize> = (0..mesh.positions.len()).collect();
    let find = |root: &[usize], mut v: usize| {
        while root[v] != v {
            v = root[v];
        }
        v
    };
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|v| find(&root, v as usize));
        let least = a.min(b).min(c);
        for vertex in [a, b, c] {
            root[vertex] = least;
        }
    }
    (0..root.len()).map(|v| find(&root, v)).collect()
}

/// Where each part of a mesh is that hangs together by its vertices, and six times its volume.
fn volumes(mesh: &TriMesh) -> Vec<(Vec3, f64)> {
    let root = roots(mesh);
    let mut sums: BTreeMap<usize, f64> = BTreeMap::new();
    for (i, corners) in mesh.triangles.iter().enumerate() {
        let part = root[corners[0] as usize];
        // About a point of the part itself: far from the origin little would be left of the difference.
        let [a, b, c] = mesh.corners(i).map(|p| (p - mesh.positions[part]).as_dvec3());
        *sums.entry(part).or_default() += a.dot(b.cross(c));
    }
    sums.into_iter().map(|(part, volume)| (mesh.positions[part], volume)).collect()
}

#[test]
fn every_solid_of_every_level_is_closed_and_faces_outward() {
    for model in vehicles().chain(PARKED_TWO_WHEELERS).chain(trains::sections()) {
        for (level, pieces) in levels(model).iter().enumerate() {
            for piece in pieces {
                assert!(closed_volume(&piece.mesh).1, "{} is open at level {level}", model.name);
                for (at, volume) in volumes(&piece.mesh) {
                    assert!(volume > 0.0, "{} level {level}: a solid at {at} is inside out", model.name);
                }
            }
        }
    }
}

#[test]
fn every_level_fills_its_box_on_five_faces() {
    for model in vehicles().chain(PARKED_TWO_WHEELERS).chain(trains::sections()) {
        let [l, w, h] = model.size_m.map(|v| v as f32);
        for (level, pieces) in levels(model).iter().enumerate() {
            let corners = placed(pieces, &made(model.name, model.size_m, 0).posed(Posture::default()));
            let b = corners.iter().flatten().fold(Aabb::EMPTY, |b, p| b.with(*p));
            let off =
                [b.min.x + 0.5 * l, b.max.x - 0.5 * l, b.min.y + 0.5 * w, b.max.y - 0.5 * w, b.max.z - h];
            assert!(off.iter().all(|d| d.abs() < 0.015), "{} level {level}: {off:?}", model.name);
            // Wheels stand on the road, if only by the corners of those far away.
            assert!(b.min.z > -1e-3 && b.min.z < 0.02, "{} level {level}: {}", model.name, b.min.z);
        }
    }
}

#[test]
fn what_is_farther_away_has_fewer_triangles_and_the_same_lamps() {
    for model in on_four_wheels() {
        let levels = levels(model);
        assert_eq!(levels.len(), 3, "{}", model.name);
        let counts = levels.iter().map(|pieces| placed(pieces, &Posture::default()).len());
        let lamps = |pieces: &[Piece]| -> BTreeSet<u32> {
            let parts = pieces
                .iter()
                .flat_map(|p| p.mesh.triangle_part.iter().map(|k| p.mesh.parts[usize::from(*k)]));
            parts
                .filter_map(|part| if let Surface::Lamp(bits) = part.surface { Some(bits) } else { None })
                .collect()
        };
        // Lorries with a machine on their back and six wheels have most.
        for (count, (least, most)) in counts.zip([(2000, 8000), (500, 2350), (150, 780)]) {
            assert!((least..=most).contains(&count), "{}: {count}", model.name);
        }
        let near = lamps(&levels[0]);
        for bit in [
            lights::BRAKE,
            lights::BLINK_LEFT,
            lights::BLINK_RIGHT,
            lights::REVERSE,
            lights::LOW_BEAM,
            lights::FOG,
        ] {
            // What is towed has those of a rear end; the one before it, if that never drives alone, those of
            // a front.
            let of_front = bit == lights::LOW_BEAM;
            let lacks = match model.name {
                "bus.articulated" => bit & (lights::BRAKE | lights::REVERSE) != 0,
                name => of_front && trains::of_towed(name).is_some(),
            };
            if lacks {
                assert!(near.iter().all(|bits| bits & bit == 0), "{} has a lamp {bit}", model.name);
                continue;
            }
            assert!(near.iter().any(|bits| bits & bit != 0), "{} has no lamp {bit}", model.name);
        }
        for pieces in &levels[1..] {
            assert_eq!(lamps(pieces), near, "{}", model.name);
        }
    }
}

#[test]
fn two_wheelers_lose_triangles_with_every_level() {
    let two_wheeled = vehicles().filter(|m| matches!(m.base, BaseType::Motorcycle | BaseType::Bicycle));
    for model in two_wheeled.chain(PARKED_TWO_WHEELERS) {
        let posture = made(model.name, model.size_m, 0).posed(Posture::default());
        let counts: Vec<usize> = levels(model).iter().map(|pieces| placed(pieces, &posture).len()).collect();
        assert!(counts.windows(2).all(|pair| pair[1] < pair[0]), "{}: {counts:?}", model.name);
        assert!(
            (1000..=9500).contains(&counts[0]) && counts[counts.len() - 1] < 2100,
            "{}: {counts:?}",
            model.name
        );
    }
}

/// How often closed solids hold a place, by the faces above it.
pub(super) fn times_inside(solids: &[[Vec3; 3]], place: Vec3) -> i32 {
    solids
        .iter()
        .map(|[a, b, c]| {
            let side = |p: Vec3, q: Vec3| (q - p).truncate().perp_dot((place - p).truncate());
            let sides = [side(*a, *b), side(*b, *c), side(*c, *a)];
            let upward = sides.iter().all(|s| *s > 0.0);
            if !upward && !sides.iter().all(|s| *s < 0.0) {
                return 0;
            }
            let normal = (*b - *a).cross(*c - *a);
            let above = (place - *a).dot(normal) / normal.z < 0.0;
            i32::from(above) * if upward { 1 } else { -1 }
        })
        .sum()
}

#[test]
fn wheels_turn_and_steer_clear_of_the_body() {
    for model in on_four_wheels() {
        let actor = made(model.name, model.size_m, 0);
        let body: Vec<[Vec3; 3]> = {
            let mesh = &actor.pieces[0].mesh;
            (0..mesh.triangles.len()).map(|i| mesh.corners(i)).collect()
        };
        // The middle of a car lies in its body, the middle of the road under it does not.
        let high = 0.45 * model.size_m[2] as f32;
        if model.base == BaseType::Car {
            assert_eq!(times_inside(&body, Vec3::new(0.0101, 0.0203, high)), 1, "{}", model.name);
        }
        assert_eq!(times_inside(&body, Vec3::new(0.0101, 0.0203, 0.02)), 0, "{}", model.name);
        for steer_rad in [-Wheels::STEER_RAD, 0.0, Wheels::STEER_RAD] {
            let posture = Posture { steer_rad, phase_rad: 0.7, ..Posture::default() };
            let wheels = actor.pieces.iter().filter(|p| matches!(p.joint, Joint::Wheel { .. }));
            for wheel in wheels {
                let pose = wheel.joint.object_from_piece(&posture).expect("wheels are always there");
                // The outermost points of the tyre decide.
                let radius = model.wheel_radius_m as f32;
                let outer = wheel.mesh.positions.iter().filter(|p| p.length() > 0.93 * radius);
                for p in outer.map(|p| pose.transform_point3(*p)) {
                    assert!(times_inside(&body, p) <= 0, "{} steered by {steer_rad}: {p}", model.name);
                }
            }
        }
    }
}

#[test]
fn wheels_stay_in_their_arches_while_the_body_leans() {
    let mut leaned = 0;
    for model in on_four_wheels() {
        let travel_m = model.spring_travel_m() as f32;
        let at_m = [0.5 * model.wheelbase_m.max(1.0), 0.5 * model.size_m[1]].map(|m| m as f32);
        let actor = made(model.name, model.size_m, 0);
        let mesh = &actor.pieces[0].mesh;
        // All of the springs' travel ahead, aside, and half of each: nobody accelerates as hard as they
        // brake.
        for [ahead, aside] in [[1.0, 0.0], [-0.5, 0.0], [0.0, 1.0], [0.5, 0.5], [-0.5, 0.5]] {
            // Traffic lets them lean by no more than this.
            let pitch = (ahead * travel_m / at_m[0]).clamp(-0.03, 0.03);
            let roll = (aside * travel_m / at_m[1]).min(0.025);
            let lean =
                glam::Affine3A::from_mat3(glam::Mat3::from_euler(glam::EulerRot::ZYX, 0.0, pitch, roll));
            let leaning = |i: usize| mesh.corners(i).map(|p| lean.transform_point3(p));
            let body: Vec<[Vec3; 3]> = (0..mesh.triangles.len()).map(leaning).collect();
            for wheel in actor.pieces.iter().filter(|p| p.joint.stays_on_road()) {
                let pose =
                    wheel.joint.object_from_piece(&Posture::default()).expect("wheels are always there");
                let radius = model.wheel_radius_m as f32;
                let tread = wheel.mesh.positions.iter().filter(|p| p.length() > 0.93 * radius);
                // The beds of lorries lie close over their wheels, unseen.
                let share = if model.base == BaseType::Truck { 1.0 - 0.012 / radius } else { 1.0 };
                for p in tread.map(|p| pose.transform_point3(*p * Vec3::new(share, 1.0, share))) {
                    assert!(times_inside(&body, p) <= 0, "{} leaning by {pitch} {roll}: {p}", model.name);
                }
            }
            leaned += 1;
        }
        // Far away the wheels are a piece of their own, too, and stand on the ground.
        let coarse = &actor.coarser[actor.coarser.len() - 1].pieces;
        let standing: Vec<&Piece> = coarse.iter().filter(|p| p.joint.stays_on_road()).collect();
        assert!(standing.len() == 1 && standing[0].mesh.aabb().min.z.abs() < 1e-3, "{}", model.name);
        assert!(coarse[0].mesh.aabb().min.z > 0.05, "{}: the body stands on the ground", model.name);
    }
    assert!(leaned >= 50);
}
