//! Bodies lean on their springs and wheels stay on the road; two-wheelers lean with theirs. All in closed
//! form.

use catalogue::{BaseType, Model, models};
use frames::math::{cos, sin, tan};
use frames::{Object, Pose, World};
use glam::Vec3;
use schema::geometry::{Instance, Snapshot};
use schema::tables::{ActorRow, FrameRow, StateRow};
use schema::{ActorKind, ActorRole};
use world::{Moment, SceneWorld};

/// Roll and pitch of the road, and the yaw.
const ROAD_RPY: [f64; 3] = [0.02, -0.05, 0.7];
const AT_M: [f64; 3] = [12.0, -5.0, 3.0];

fn world(model: &Model) -> SceneWorld {
    let [length_m, width_m, height_m] = model.size_m;
    let actor = ActorRow {
        id: 7,
        kind: ActorKind::Vehicle,
        model: model.name.to_owned(),
        role: ActorRole::Background,
        length_m,
        width_m,
        height_m,
        color: vec![255, 0, 0],
        quaternion: [1.0, 0.0, 0.0, 0.0],
        ..ActorRow::default()
    };
    SceneWorld::new(&[actor], Vec::new()).expect("has a mesh")
}

/// On the road, its body (by what the log says of springs, or all of it) rolled and pitched against that.
fn leaning(lean_rad: [f64; 2], on_springs: bool) -> StateRow {
    let [roll, pitch, yaw] = ROAD_RPY;
    let pose = Pose::<World, Object>::from_xyz_rpy(AT_M, [roll + lean_rad[0], pitch + lean_rad[1], yaw]);
    StateRow {
        id: 7,
        xyz_m: AT_M,
        quaternion: pose.wxyz(),
        lean_rad: if on_springs { lean_rad.map(|angle| angle as f32) } else { [0.0; 2] },
        phase_rad: 0.0,
        ..StateRow::default()
    }
}

fn seen(world: &SceneWorld, now: &StateRow, before: &StateRow, from_m: f64) -> Snapshot {
    let (now, before) = (std::slice::from_ref(now), std::slice::from_ref(before));
    let frame = FrameRow::default();
    let moment = Moment { states: now, previous: before, signals: &[], frame: &frame };
    world.snapshot(&moment, [AT_M[0] + from_m, AT_M[1], AT_M[2]], 150.0)
}

/// Places of an instance's vertices in the frame of the road under the object; of this frame or the one
/// before.
fn on_road(snapshot: &Snapshot, instance: &Instance, before: bool) -> Vec<Vec3> {
    let road = Pose::<World, Object>::from_xyz_rpy(AT_M, ROAD_RPY);
    let road_from_local = snapshot.origin.local_from_body(&road).inverse();
    let local = if before { instance.previous_local_from_object } else { instance.local_from_object };
    let mesh = snapshot.mesh(instance);
    mesh.positions.iter().map(|p| road_from_local.transform_point3(local.transform_point3(*p))).collect()
}

fn low(points: &[Vec3]) -> f32 {
    points.iter().map(|p| p.z).fold(f32::INFINITY, f32::min)
}

fn on_four_wheels(model: &Model) -> bool {
    !matches!(model.base, BaseType::Motorcycle | BaseType::Bicycle)
}

#[test]
fn wheels_stand_on_the_road_while_the_roof_goes_aside() {
    for model in models::vehicles().filter(|m| on_four_wheels(m)) {
        let world = world(model);
        let rest = leaning([0.0; 2], true);
        // In a curve, braking, and both; the frame before another one.
        for (lean, lean_before) in
            [([0.012, 0.0], [0.010, 0.0]), ([0.0, 0.010], [0.0, 0.0]), ([-0.008, -0.007], [0.004, -0.009])]
        {
            // As near as it is finest, and as far as its wheels are one piece.
            for from_m in [0.0, 30.0, 100.0] {
                let snapshot = seen(&world, &leaning(lean, true), &leaning(lean_before, true), from_m);
                let level = seen(&world, &rest, &rest, from_m);
                let count = snapshot.instances.len();
                assert!(count >= 2 && count == level.instances.len(), "{}", model.name);
                for (k, (instance, flat)) in snapshot.instances.iter().zip(&level.instances).enumerate() {
                    for (before, [roll, pitch]) in [(false, lean), (true, lean_before)] {
                        let (points, flat) =
                            (on_road(&snapshot, instance, before), on_road(&level, flat, before));
                        if k > 0 {
                            // A wheel is where it is without any lean: on the road.
                            assert!(low(&points).abs() < 0.004, "{}: {}", model.name, low(&points));
                            let off = points.iter().zip(&flat).map(|(a, b)| (*a - *b).length());
                            assert!(off.fold(0.0, f32::max) < 1e-4, "{}", model.name);
                            continue;
                        }
                        // The body has turned about the origin: the roof went aside by the lean times its
                        // height.
                        let height = f64::from(flat.iter().map(|p| p.z).fold(0.0, f32::max));
                        for (p, q) in points.iter().zip(&flat).filter(|(_, q)| f64::from(q.z) > 0.95 * height)
                        {
                            let moved = (*p - *q).as_dvec3();
                            let z = f64::from(q.z);
                            assert!((moved.x - sin(pitch) * z).abs() < 0.004, "{}: {moved}", model.name);
                            assert!((moved.y + sin(roll) * z).abs() < 0.004, "{}: {moved}", model.name);
                        }
                    }
                }
                // Boxes lean with the body.
                let motion = snapshot.motion(7).expect("it moves");
                assert_eq!(motion.local_from_object, snapshot.instances[0].local_from_object);
                for cabin in &snapshot.cabins {
                    assert_eq!(cabin.local_from_object, motion.local_from_object);
                }
            }
        }
    }
}

#[test]
fn two_wheelers_lean_about_the_line_on_which_their_wheels_stand() {
    let mut ridden = 0;
    for model in models::vehicles().filter(|m| !on_four_wheels(m)) {
        let world = world(model);
        for roll in [0.2, -0.3, 0.45] {
            let state = leaning([roll, 0.0], false);
            let snapshot = seen(&world, &state, &state, 0.0);
            let motion = snapshot.motion(7).expect("it moves");
            let points: Vec<Vec<Vec3>> =
                snapshot.instances.iter().map(|instance| on_road(&snapshot, instance, false)).collect();
            // Tyres are round, all but: they neither lift off nor sink in by more than their edge does.
            let all = points.iter().map(|p| low(p)).fold(f32::INFINITY, f32::min);
            let most = if model.base == BaseType::Bicycle { 0.008 } else { 0.020 };
            assert!((-most..0.004).contains(&all), "{} leaning by {roll}: {all}", model.name);
            // All of it goes with the lean, the rider's head most.
            let high =
                points.iter().flatten().fold(Vec3::ZERO, |high, p| if p.z > high.z { *p } else { high });
            let aside = f64::from(-high.y) / f64::from(high.z);
            assert!((aside - tan(roll)).abs() < 0.12, "{} leaning by {roll}: {high}", model.name);
            // The box leans with it and holds it.
            let inside = motion.local_from_object.inverse();
            let half = Vec3::from_array(model.size_m.map(|side| 0.5 * side as f32));
            for (instance, _) in snapshot.instances.iter().zip(&points) {
                let pose = inside * instance.local_from_object;
                for p in &snapshot.mesh(instance).positions {
                    let p = pose.transform_point3(*p);
                    let over = (p.abs() - half).with_z((p.z - 2.0 * half.z).max(-p.z)).max_element();
                    assert!(over < 0.05, "{}: {p}", model.name);
                }
            }
            let top = f64::from(half.z) * 2.0 * cos(roll);
            assert!(
                f64::from(high.z) < top + 0.5 * model.size_m[1] * sin(roll.abs()) + 0.01,
                "{}",
                model.name
            );
        }
        ridden += 1;
    }
    assert!(ridden >= 6, "{ridden}");
}
