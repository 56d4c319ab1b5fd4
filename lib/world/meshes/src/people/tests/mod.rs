mod looks;

use std::collections::{BTreeMap, BTreeSet};
use std::f32::consts::TAU;

use crate::solids::Detail;
use catalogue::{BaseType, Model, Special, models::MODELS};
use frames::Aabb;
use glam::Vec3;
use schema::geometry::TriMesh;

use super::*;
use crate::people::dog::LEGS;
use crate::people::pram::{FRONT, REAR};

/// From a slow walk to a fast run, m/s.
const SPEEDS_MPS: [f32; 9] = [0.3, 0.6, 1.0, 1.4, 1.8, 2.2, 3.0, 4.5, 6.0];

fn models() -> impl Iterator<Item = &'static Model> {
    MODELS.iter().filter(|m| m.base == BaseType::Pedestrian && m.wheel_radius_m == 0.0)
}

fn everybody() -> impl Iterator<Item = (String, Walker)> {
    models().flat_map(|model| {
        (0..APPEARANCES).map(move |look| (format!("{} {look}", model.name), Walker::new(model, look)))
    })
}

/// Somebody of each age, build and sex, and those who carry something.
fn some() -> impl Iterator<Item = (String, Walker)> {
    let mut seen = BTreeSet::new();
    everybody().filter(move |(name, who)| {
        let look = who.figure().look;
        let kind = (name.split(' ').next().map(str::to_owned), look.build as u8, look.carried as u8);
        seen.insert(kind)
    })
}

fn placed(who: &Walker, phase_rad: f32, speed_mps: f32) -> Vec<(Bone, Vec<Vec3>)> {
    let bones = who.figure().walking(phase_rad, speed_mps);
    let at = |(bone, mesh): &(Bone, std::sync::Arc<TriMesh>)| {
        let pose = bones.object_from_bone(*bone);
        (*bone, mesh.positions.iter().map(|p| pose.transform_point3(*p)).collect())
    };
    who.meshes().iter().map(at).collect()
}

fn bounds(who: &Walker, phase_rad: f32, speed_mps: f32) -> Aabb {
    let points = placed(who, phase_rad, speed_mps).into_iter().flat_map(|(_, points)| points);
    points.fold(Aabb::EMPTY, |b, p| b.with(p))
}

/// How far, over a cycle, a vertex of a shoe goes along the ground at most while it touches it, and how deep
/// any goes below, m.
fn slide_and_depth(who: &Walker, speed_mps: f32) -> (f32, f32) {
    const STEPS: usize = 160;
    const TOUCHES_M: f32 = 0.002;
    let stride_m = who.figure().stride_m(speed_mps);
    let (mut slide, mut depth) = (0.0f32, 0.0f32);
    // Where each vertex came to touch the ground, in the world.
    let mut since: BTreeMap<(u8, usize), Vec3> = BTreeMap::new();
    for k in 0..=2 * STEPS {
        let turns = k as f32 / STEPS as f32;
        let way = Vec3::X * turns * stride_m;
        for (bone, points) in placed(who, TAU * turns, speed_mps) {
            let shoe = [Bone::FootLeft, Bone::FootRight, Bone::ToesLeft, Bone::ToesRight].contains(&bone)
                || LEGS.iter().any(|paw| paw.lower == bone);
            for (v, p) in points.iter().enumerate().filter(|_| shoe) {
                depth = depth.max(-p.z);
                let key = (bone as u8, v);
                if p.z > TOUCHES_M {
                    since.remove(&key);
                } else {
                    let from = *since.entry(key).or_insert(*p + way);
                    slide = slide.max((*p + way - from).truncate().length());
                }
            }
        }
    }
    (slide, depth)
}

#[test]
fn planted_feet_stand_still() {
    let (mut slide, mut depth) = ((0.0, String::new()), (0.0, String::new()));
    for (name, who) in some() {
        for speed_mps in SPEEDS_MPS {
            let (s, d) = slide_and_depth(&who, speed_mps);
            let whose = format!("{name} at {speed_mps} m/s");
            if s > slide.0 {
                slide = (s, whose.clone());
            }
            if d > depth.0 {
                depth = (d, whose);
            }
        }
    }
    assert!(slide.0 < 0.02, "slides: {slide:?}");
    assert!(depth.0 < 0.01, "goes below the ground: {depth:?}");
}

#[test]
fn somebody_is_always_on_the_ground_but_runners() {
    for (name, who) in some() {
        for speed_mps in SPEEDS_MPS.into_iter().filter(|v| *v < 1.2) {
            for k in 0..24 {
                let low = bounds(&who, TAU * k as f32 / 24.0, speed_mps).min.z;
                assert!(low.abs() < 0.01, "{name} at {speed_mps} m/s: {low}");
            }
        }
    }
}

#[test]
fn footprints_are_a_stride_apart() {
    // In closed form: a cycle is a stride, and both feet come down half a stride apart.
    for (name, who) in some() {
        let figure = who.figure();
        for speed_mps in SPEEDS_MPS {
            let heel = |phase_rad: f32, foot: Bone| {
                let bones = figure.walking(phase_rad, speed_mps);
                let at = Vec3::new(figure.heel, 0.0, -figure.ankle);
                bones.object_from_bone(foot).transform_point3(at).x
            };
            let stride = figure.stride_m(speed_mps);
            let (left, right) = (heel(0.001, Bone::FootLeft), heel(0.5 * TAU + 0.001, Bone::FootRight));
            let step = right + 0.5 * stride - left;
            assert!((step - 0.5 * stride).abs() < 0.01, "{name} at {speed_mps} m/s: {step} of {stride}");
        }
    }
    let stride = Walker::of_height(catalogue::models::find("walker.man").expect("a model"), 2, 1.75)
        .figure()
        .stride_m(1.4);
    assert!((1.2..1.5).contains(&stride), "{stride}");
}

#[test]
fn knees_bend_forward_and_elbows_back() {
    for (name, who) in some() {
        for speed_mps in [0.0, 0.5, 1.4, 3.0] {
            for k in 0..16 {
                let bones = who.figure().walking(TAU * k as f32 / 16.0, speed_mps);
                for side in Side::BOTH {
                    let [thigh, shin, foot, _] = side.leg();
                    let [hip, knee, ankle] = [thigh, shin, foot].map(|bone| bones.joint(bone));
                    let along = (ankle - hip).normalize();
                    let out = (knee - hip) - along * (knee - hip).dot(along);
                    assert!(out.x > -1e-3, "{name} at {speed_mps} m/s: a knee bends by {out}");
                    let [upper, lower] = side.arm();
                    let bend = bones.object_from_bone(upper).matrix3.inverse()
                        * bones.object_from_bone(lower).matrix3;
                    // Seen from the upper arm the hand is ahead.
                    let hand = bend * glam::Vec3A::NEG_Z;
                    assert!(
                        hand.x > -0.02 || hand.z > -0.9999,
                        "{name} at {speed_mps} m/s: an elbow bends by {hand}"
                    );
                }
            }
        }
    }
}

/// Each bone begins where the one above it ends.
fn hang_together(name: &str, figure: &Figure, bones: &Bones) {
    let end = |bone: Bone, length: f32| bones.object_from_bone(bone).transform_point3(Vec3::NEG_Z * length);
    for side in Side::BOTH {
        let [thigh, shin, foot, _] = side.leg();
        let [upper, lower] = side.arm();
        let pairs = [
            (end(thigh, figure.thigh), bones.joint(shin)),
            (end(shin, figure.shin), bones.joint(foot)),
            (end(upper, figure.upper_arm), bones.joint(lower)),
        ];
        for (above, below) in pairs {
            assert!((above - below).length() < 2e-3, "{name}: {above} {below}");
        }
    }
}

#[test]
fn bones_hang_together() {
    for (name, who) in some() {
        let figure = who.figure();
        for (phase_rad, speed_mps) in [(0.0, 0.0), (0.4, 1.4), (2.0, 1.4), (4.4, 0.6), (3.0, 4.0)] {
            let bones = figure.walking(phase_rad, speed_mps);
            hang_together(&name, figure, &bones);
        }
    }
}

#[test]
fn boxes_are_those_of_all_vertices() {
    for (name, who) in some() {
        for speed_mps in [0.0, 0.7, 1.4, 3.0] {
            for k in 0..6 {
                let phase_rad = TAU * k as f32 / 6.0 + 0.2;
                let found = bounds(&who, phase_rad, speed_mps);
                let reach = found.max.max(-found.min);
                let size = who.box_m(phase_rad, speed_mps);
                let off = (size - Vec3::new(2.0 * reach.x, 2.0 * reach.y, found.max.z)).abs().max_element();
                assert!(off < 0.012, "{name} at {speed_mps} m/s: {size} {found:?}");
            }
        }
    }
}

#[test]
fn who_stands_fills_the_box_on_five_faces() {
    for (name, who) in everybody() {
        let (found, size) = (bounds(&who, 0.0, 0.0), who.size_m());
        let faces = [
            found.min.x + 0.5 * size.x,
            found.max.x - 0.5 * size.x,
            found.min.y + 0.5 * size.y,
            found.max.y - 0.5 * size.y,
            found.max.z - size.z,
            found.min.z,
        ];
        assert!(faces.iter().all(|off| off.abs() < 0.01), "{name}: {faces:?}");
        // A person's measures: neither flat nor a giant; with a pram ahead, or a dog aside.
        let most = match who.figure().look.carried {
            Carried::Pram => 1.55,
            Carried::Dog => 1.05,
            _ => 0.95,
        };
        assert!((0.22..most).contains(&size.x) && (0.28..0.95).contains(&size.y), "{name}: {size}");
        assert!((1.05..2.10).contains(&size.z), "{name}: {size}");
    }
}

#[test]
fn who_stands_moves_a_little_on_still_feet() {
    let feet = |who: &Walker, phase_rad: f32| -> Vec<Vec3> {
        let paws = LEGS.iter().map(|leg| leg.lower);
        let feet = [Bone::FootLeft, Bone::FootRight, Bone::ToesLeft, Bone::ToesRight].into_iter().chain(paws);
        let bones = who.figure().walking(phase_rad, 0.0);
        feet.map(|foot| bones.joint(foot)).collect()
    };
    for (name, who) in some() {
        let [a, b] = [0.3, 2.9].map(|phase| feet(&who, phase));
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).length() < 1e-3), "{name}: {a:?} {b:?}");
        // From one twentieth of a second to the next, of 4.5 s; heads turn.
        let [mut moved, mut fastest] = [0.0f32; 2];
        let steps = 90;
        for k in 0..steps {
            let [then, now] = [k, k + 1].map(|k| placed(&who, TAU * k as f32 / steps as f32, 0.0));
            for ((bone, then), (_, now)) in then.iter().zip(&now) {
                let wheel = [Bone::PramFront, Bone::PramRear].contains(bone);
                let step = then.iter().zip(now).map(|(a, b)| (a - b).length()).fold(0.0, f32::max);
                if !wheel {
                    (moved, fastest) = (moved + step, fastest.max(step / 0.05));
                }
            }
        }
        assert!(moved > 0.1 && fastest < 1.2, "{name}: {moved} m in all, {fastest} m/s");
        let [first, last] = [0.0, TAU].map(|phase| bounds(&who, phase, 0.0));
        assert!((first.min - last.min).length() + (first.max - last.max).length() < 1e-3, "{name}");
    }
}

#[test]
fn looks_differ() {
    let mut shapes = BTreeSet::new();
    let (mut all, mut least, mut most) = (0, usize::MAX, 0);
    for (name, who) in everybody() {
        let look = who.figure().look;
        // By shape alone, colours left out.
        shapes.insert(format!(
            "{:?} {} {:?} {:?} {:?} {:?} {:?} {:?}",
            look.age, look.woman, look.build, look.top, look.bottom, look.hair, look.hat, look.carried
        ));
        all += 1;
        let count: usize = who.meshes().iter().map(|(_, mesh)| mesh.triangles.len()).sum();
        let bound = if matches!(look.carried, Carried::Pram | Carried::Dog) { 7400 } else { 6300 };
        assert!((3000..=bound).contains(&count), "{name}: {count} triangles");
        (least, most) = (least.min(count), most.max(count));
    }
    assert!(shapes.len() >= 80, "{} shapes of {all} looks, {least} to {most} triangles", shapes.len());
}

#[test]
fn somebody_on_a_seat_reaches_what_they_hold() {
    let model = catalogue::models::find("bicycle.city").expect("a model");
    let figure = Figure::new(Appearance::new(model, 3).riding(false), 1.75);
    let seat = Seat {
        hips: Vec3::new(-0.2, 0.0, 1.0),
        lean_rad: 0.3,
        hands: [Vec3::new(0.3, 0.25, 1.1), Vec3::new(0.3, -0.25, 1.1)],
        balls: [Vec3::new(0.0, 0.12, 0.5), Vec3::new(0.0, -0.12, 0.25)],
        heels_rad: 0.2,
        knees: Vec3::new(1.0, 0.1, 0.6),
        elbows: Vec3::new(-0.7, 0.3, -0.8),
    };
    let bones = figure.seated(&seat);
    for (k, side) in Side::BOTH.into_iter().enumerate() {
        let palm = Vec3::NEG_Z * (figure.forearm + 0.45 * figure.hand);
        let hand = bones.object_from_bone(side.arm()[1]).transform_point3(palm);
        assert!((hand - seat.hands[k]).length() < 0.002, "{hand}");
        let ball = Vec3::new(figure.ball, 0.0, -figure.ankle);
        let ball = bones.object_from_bone(side.leg()[2]).transform_point3(ball);
        assert!((ball - seat.balls[k]).length() < 0.002, "{ball}");
    }
}

#[test]
fn hands_hold_the_handle_and_the_wheels_stand_on_the_ground() {
    for (name, who) in some().filter(|(_, who)| who.figure().look.carried == Carried::Pram) {
        let figure = who.figure();
        let palm = Vec3::NEG_Z * (figure.forearm + 0.45 * figure.hand);
        let [ahead, up] = figure.handle_m();
        // A child's way to the handle is as far as a grown-up's, and the feet stay behind the wheels.
        for speed_mps in [0.0, 0.4, 0.8, 1.4, 2.0] {
            for k in 0..24 {
                let phase_rad = TAU * k as f32 / 24.0;
                let bones = figure.walking(phase_rad, speed_mps);
                let pram = bones.object_from_bone(Bone::Pram);
                for side in Side::BOTH {
                    let hand = bones.object_from_bone(side.arm()[1]).transform_point3(palm);
                    let hand = pram.inverse().transform_point3(hand);
                    let off = Vec3::new(hand.x - ahead, 0.0, hand.z - up).length();
                    assert!(off < 0.002, "{name} at {speed_mps} m/s: a hand is {off} off");
                }
                for (bone, points) in placed(&who, phase_rad, speed_mps) {
                    let far =
                        points.iter().map(|p| p.x - pram.translation.x).fold(f32::NEG_INFINITY, f32::max);
                    let low = points.iter().map(|p| p.z).fold(f32::INFINITY, f32::min);
                    match bone {
                        Bone::PramFront | Bone::PramRear => assert!(low.abs() < 0.003, "{name}: {low}"),
                        Bone::FootLeft | Bone::FootRight | Bone::ToesLeft | Bone::ToesRight => {
                            assert!(far < REAR.ahead - 0.05, "{name} at {speed_mps} m/s: a foot at {far}");
                        }
                        _ => {}
                    }
                }
            }
        }
        // A cycle at the usual pace is a stride of way, and a wheel rolls that far without slipping.
        let (few, stride_m) = (1e-3, figure.stride_m(1.3));
        for (bone, axle) in [(Bone::PramFront, FRONT), (Bone::PramRear, REAR)] {
            let [from, to] = [0.0, few].map(|phase| figure.walking(phase, 1.3).object_from_bone(bone));
            let top = Vec3::Z * axle.radius;
            let moved = to.transform_point3(top).x - from.transform_point3(top).x;
            assert!((moved / few * TAU - stride_m).abs() < 0.02 * stride_m, "{name}: {moved}");
        }
    }
}

#[test]
fn both_hands_hold_a_shovel_whose_blade_stands_on_the_ground() {
    let mut seen = 0;
    for (name, who) in everybody().filter(|(_, who)| who.figure().look.carried == Carried::Shovel) {
        let figure = who.figure();
        let bones = figure.walking(0.0, 0.0);
        let shaft = bones.object_from_bone(Bone::Shovel);
        let palm = Vec3::NEG_Z * (figure.forearm + 0.45 * figure.hand);
        for side in Side::BOTH {
            let hand = bones.object_from_bone(side.arm()[1]).transform_point3(palm);
            let hand = shaft.inverse().transform_point3(hand);
            let on = (-figure.shovel_m()..0.0).contains(&hand.z);
            assert!(on && hand.truncate().length() < 0.004, "{name}: a hand at {hand}");
        }
        let points = placed(&who, 0.0, 0.0);
        let blade = points.iter().filter(|(bone, _)| *bone == Bone::Shovel).flat_map(|(_, points)| points);
        let low = blade.map(|p| p.z).fold(f32::INFINITY, f32::min);
        assert!((-0.001..0.01).contains(&low), "{name}: {low}");
        seen += 1;
    }
    assert!(seen >= 5, "{seen} hold a shovel");
}

#[test]
fn a_lead_goes_from_the_hand_to_the_collar() {
    for (name, who) in some().filter(|(_, who)| who.figure().look.carried == Carried::Dog) {
        let figure = who.figure();
        for speed_mps in SPEEDS_MPS.into_iter().chain([0.0]) {
            for k in 0..24 {
                let bones = figure.walking(TAU * k as f32 / 24.0, speed_mps);
                let palm = Vec3::NEG_Z * (figure.forearm + 0.45 * figure.hand);
                let hand = bones.object_from_bone(Bone::ForearmLeft).transform_point3(palm);
                let end = Vec3::NEG_Z * figure.lead_m();
                let [upper, lower] = [Bone::LeadUpper, Bone::LeadLower]
                    .map(|bone| (bones.joint(bone), bones.object_from_bone(bone).transform_point3(end)));
                // Nobody's fist and neck are smaller than that.
                let collar = bones.object_from_bone(Bone::DogHead).inverse().transform_point3(lower.1);
                let off = [(upper.0 - hand).length(), (upper.1 - lower.0).length(), collar.x.abs()];
                assert!(off.iter().all(|off| *off < 0.03), "{name} at {speed_mps} m/s: {off:?}");
                for leg in LEGS {
                    let reach = 0.4 * figure.look.dog_m;
                    let knee = bones.object_from_bone(leg.upper).transform_point3(Vec3::NEG_Z * reach);
                    let off = (knee - bones.joint(leg.lower)).length();
                    assert!(off < 0.02 * figure.look.dog_m, "{name} at {speed_mps} m/s: {off}");
                }
            }
        }
    }
}

#[test]
fn boxes_of_those_who_walk_are_not_much_longer_than_they() {
    for (name, who) in
        some().filter(|(_, who)| matches!(who.figure().look.carried, Carried::Pram | Carried::Dog))
    {
        for speed_mps in [0.8, 1.1, 1.4, 1.8] {
            let slack = |k: usize| {
                let phase_rad = TAU * k as f32 / 24.0;
                let (found, size) = (bounds(&who, phase_rad, speed_mps), who.box_m(phase_rad, speed_mps));
                size.x - (found.max.x - found.min.x)
            };
            let most = (0..24).map(slack).fold(0.0, f32::max);
            assert!(most < 0.30, "{name} at {speed_mps} m/s: {most} too long");
        }
    }
}

#[test]
fn models_are_as_large_as_those_who_have_something_with_them() {
    // Walkers keep apart by what the catalogue says.
    for (name, who) in everybody() {
        let Some(model) = name.split(' ').next().and_then(catalogue::models::find) else { continue };
        if matches!(who.figure().look.carried, Carried::Pram | Carried::Dog) {
            let [length, width, _] = model.size_m.map(|v| v as f32);
            let size = who.size_m();
            assert!((size.x - length).abs() < 0.15 && (size.y - width).abs() < 0.15, "{name}: {size}");
        }
    }
}

/// Six times the volume that a mesh's triangles enclose is the sum of their corners' triple products.
fn volume_m3(mesh: &TriMesh) -> f32 {
    let six = |[a, b, c]: [Vec3; 3]| a.dot(b.cross(c));
    (0..mesh.triangles.len()).map(|t| six(mesh.corners(t))).sum::<f32>() / 6.0
}

#[test]
fn far_away_people_are_as_large_of_fewer_triangles() {
    for (name, who) in everybody() {
        let near = bounds(&who, 0.0, 0.0);
        let bones = who.figure().walking(0.0, 0.0);
        let of = |detail| who.figure().meshes(schema::Tag::Pedestrian, detail);
        let count = |made: &[(Bone, TriMesh)]| made.iter().map(|(_, m)| m.triangles.len()).sum::<usize>();
        let volume = |made: &[(Bone, TriMesh)]| made.iter().map(|(_, m)| volume_m3(m)).sum::<f32>();
        let full = of(Detail::Full);
        for (detail, most, thin, off_m) in
            [(Detail::Half, 0.6, 0.9, 0.02), (Detail::Coarse, 0.22, 0.75, 0.05)]
        {
            let made = of(detail);
            let share = count(&made) as f32 / count(&full) as f32;
            assert!(share < most, "{name} {detail:?}: {share} of the triangles");
            let thick = volume(&made) / volume(&full);
            assert!((thin..1.15).contains(&thick), "{name} {detail:?}: {thick} of the volume");
            let far = made.iter().fold(Aabb::EMPTY, |far, (bone, mesh)| {
                let pose = bones.object_from_bone(*bone);
                mesh.positions.iter().fold(far, |far, p| far.with(pose.transform_point3(*p)))
            });
            let off = (far.min - near.min).abs().max((far.max - near.max).abs());
            assert!(off.max_element() < off_m, "{name} {detail:?}: {off} off");
        }
    }
}

/// All people who may sit, on a seat of a height at a phase: the points by bone.
fn sitting() -> impl Iterator<Item = (String, Walker)> {
    let plain = |model: &&Model| model.special == Special::None && model.name != "walker.child";
    models().filter(plain).flat_map(|model| {
        let may =
            (0..APPEARANCES).map(|look| Walker::new(model, look)).filter(|who| who.figure().look.may_sit());
        let found: Vec<(String, Walker)> = may.map(|who| (model.name.to_owned(), who)).collect();
        assert!(found.len() >= 2, "{}: {} of its looks may sit", model.name, found.len());
        found
    })
}

#[test]
fn who_sits_is_on_the_seat_with_both_feet_on_the_ground() {
    // Of a bench as `benches` has it: 0.55 deep, the back rest before its rear end.
    let front_m = 0.195 - (-0.275 + catalogue::benches::BACK_M as f32);
    let mut sat = 0;
    for (name, who) in sitting() {
        let figure = who.figure();
        for seat_m in [0.40, 0.425, 0.45] {
            for phase_rad in [0.0, 1.3, 2.9, 4.4] {
                let bones = figure.sitting(phase_rad, seat_m);
                let size = who.posed_box_m(&bones);
                let (mut all, mut feet) = (Aabb::EMPTY, Aabb::EMPTY);
                for (bone, mesh) in who.meshes() {
                    let pose = bones.object_from_bone(*bone);
                    for p in mesh.positions.iter().map(|p| pose.transform_point3(*p)) {
                        all = all.with(p);
                        if [Bone::FootLeft, Bone::FootRight, Bone::ToesLeft, Bone::ToesRight].contains(bone) {
                            feet = feet.with(p);
                        }
                        // The rear of the box leans at the back rest: nothing goes through the seat before
                        // that.
                        let over = p.x + 0.5 * size.x;
                        assert!(
                            over > front_m || p.z > seat_m - 0.02,
                            "{name}: {bone:?} at {over} before the back rest is {} below the seat",
                            seat_m - p.z
                        );
                    }
                }
                assert!(all.min.z > -0.005 && feet.min.z.abs() < 0.005, "{name}: {all:?}");
                // Both feet are flat on it.
                for side in Side::BOTH {
                    let foot = bones.object_from_bone(side.leg()[2]);
                    assert!(foot.matrix3.z_axis.z > 0.9999, "{name}: a foot is up");
                    assert!(
                        (foot.translation.z - figure.ankle).abs() < 1e-3,
                        "{name}: a foot is off the ground"
                    );
                }
                // Hips over the seat's middle third, somewhat above it; upright.
                let hips = bones.joint(Bone::Pelvis);
                let over = hips.x + 0.5 * size.x;
                assert!((0.08..0.26).contains(&over), "{name}: the hips are {over} before the back rest");
                assert!((0.06..0.165).contains(&(hips.z - seat_m)), "{name}: {hips}");
                let head = bones.joint(Bone::Head);
                assert!(
                    head.z - hips.z > 0.25 * figure.stature && (head.x - hips.x).abs() < 0.12,
                    "{name}: {head}"
                );
                // The box is that of the mesh, on five faces.
                let faces = [
                    all.min.x + 0.5 * size.x,
                    all.max.x - 0.5 * size.x,
                    all.min.y + 0.5 * size.y,
                    all.max.y - 0.5 * size.y,
                    all.max.z - size.z,
                ];
                assert!(faces.iter().all(|off| off.abs() < 0.02), "{name}: {faces:?}");
                // Two have room on a bench.
                assert!(size.y < 0.72 && size.x < 1.0, "{name}: {size}");
                sat += 1;
            }
        }
    }
    assert!(sat > 200, "{sat}");
}

#[test]
fn limbs_of_who_sits_hang_together() {
    for (name, who) in sitting() {
        let figure = who.figure();
        let bones = figure.sitting(0.7, 0.425);
        hang_together(&name, figure, &bones);
        for side in Side::BOTH {
            let [thigh, shin, ..] = side.leg();
            // Knees are ahead, thighs all but level.
            let [hip, knee] = [thigh, shin].map(|bone| bones.joint(bone));
            assert!(knee.x - hip.x > 0.8 * figure.thigh, "{name}: {hip} {knee}");
        }
        assert!(bones.0.iter().all(|bone| bone.is_finite()), "{name}");
    }
}
