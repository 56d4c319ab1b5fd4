//! Bodies that lean, by closed forms.

use glam::{Affine3A, Vec3};
use schema::models::{self, Model};
use schema::tables::{ActorRow, FrameRow, StateRow};
use schema::{ActorKind, ActorRole};
use world::{LEAN_FRAMES, Moment, SceneWorld};

fn world(model: &Model, role: ActorRole) -> SceneWorld {
    let [length_m, width_m, height_m] = model.size_m;
    let actor = ActorRow {
        id: 7,
        kind: ActorKind::Vehicle,
        model: model.name.to_owned(),
        role,
        length_m,
        width_m,
        height_m,
        color: vec![255, 0, 0],
        quaternion: [1.0, 0.0, 0.0, 0.0],
        ..ActorRow::default()
    };
    SceneWorld::new(&[actor], Vec::new()).expect("has a mesh")
}

/// At the origin, turned and as fast as this.
fn moving(yaw_rad: f64, mps: f64) -> StateRow {
    let (sin, cos) = frames::math::sin_cos(0.5 * yaw_rad);
    let (y, x) = frames::math::sin_cos(yaw_rad);
    StateRow {
        id: 7,
        quaternion: [cos, 0.0, 0.0, sin],
        velocity_mps: [(mps * x) as f32, (mps * y) as f32, 0.0],
        ..StateRow::default()
    }
}

/// Where the body and its wheels are within the object's frame, which is turned by `yaw_rad`; `previous` as of the frame before.
struct Seen {
    body: [Affine3A; 2],
    wheels: Vec<Affine3A>,
    points: Vec<Vec3>,
}

fn seen(world: &SceneWorld, now: &StateRow, before: &StateRow, earlier: [&StateRow; 2]) -> Seen {
    let (now, before) = (std::slice::from_ref(now), std::slice::from_ref(before));
    let frame = FrameRow::default();
    let earlier = earlier.map(std::slice::from_ref);
    let moment = Moment { states: now, previous: before, earlier, signals: &[], frame: &frame };
    let snapshot = world.snapshot(&moment, [0.0; 3], 50.0);
    let motion = *snapshot.motion(7).expect("it moves");
    let inside = |pose: Affine3A| motion.local_from_object.inverse() * pose;
    let body = &snapshot.instances[0];
    // Who sits in it goes with the body.
    for cabin in &snapshot.cabins {
        assert_eq!(cabin.local_from_object, body.local_from_object);
        assert_eq!(cabin.previous_local_from_object, body.previous_local_from_object);
    }
    let was = motion.previous_local_from_object.inverse() * body.previous_local_from_object;
    let local = inside(body.local_from_object);
    let points = snapshot.mesh(body).positions.iter().map(|p| local.transform_point3(*p)).collect();
    let wheels = snapshot.instances[1..].iter().map(|i| inside(i.local_from_object)).collect();
    Seen { body: [local, was], wheels, points }
}

/// Whether a sine is that of an angle, within some 1e-5 radians.
fn is_sine(sine: f32, angle_rad: f64) -> bool {
    (f64::from(sine) - frames::math::sin(angle_rad)).abs() < 1e-5
}

#[test]
fn bodies_dive_and_roll_as_they_are_accelerated_and_wheels_do_not() {
    let sedan = models::find("car.sedan").expect("is a model");
    let background = world(sedan, ActorRole::Background);
    let over_s = LEAN_FRAMES as f64 * schema::FRAME_PERIOD_S;
    let steady = moving(0.3, 10.0);
    // Braking by 1.5 m/s2: the nose goes down by 0.0045 rad for each, in the frame before by those of 1 m/s2 yet.
    let braked = |mps2: f64| moving(0.3, 10.0 - mps2 * over_s);
    let dive = seen(&background, &braked(1.5), &braked(1.0), [&steady; 2]);
    for (pose, want_rad) in dive.body.iter().zip([0.00675, 0.0045]) {
        let ahead = pose.transform_vector3(Vec3::X);
        assert!(is_sine(-ahead.z, want_rad), "{ahead}");
        assert!(pose.transform_vector3(Vec3::Y).z.abs() < 1e-6);
        // About an axis half a metre above the road.
        assert!((pose.transform_point3(Vec3::Z * 0.5) - Vec3::Z * 0.5).length() < 1e-5);
    }
    let rest = seen(&background, &steady, &steady, [&steady; 2]);
    assert!(rest.body.iter().all(|pose| pose.abs_diff_eq(Affine3A::IDENTITY, 1e-5)));
    assert_eq!(dive.wheels.len(), 4);
    for (wheel, at_rest) in dive.wheels.iter().zip(&rest.wheels) {
        assert!(wheel.abs_diff_eq(*at_rest, 1e-4));
    }
    // 10 m/s in a left curve by 1.5 m/s2: the left side up, by 0.0089 rad for each.
    let turned = moving(0.3 + 0.15 * over_s, 10.0);
    let roll = seen(&background, &turned, &turned, [&steady; 2]).body[0];
    let left = roll.transform_vector3(Vec3::Y);
    assert!(is_sine(left.z, 0.0089 * 1.5), "{left}");
    // Agents' sensors are mounted where their boxes are.
    let agent = world(sedan, "vehicle_0".parse().expect("is a role"));
    let seen = seen(&agent, &braked(1.5), &braked(1.0), [&steady; 2]);
    assert!(seen.body.iter().all(|pose| pose.abs_diff_eq(Affine3A::IDENTITY, 1e-5)));
}

#[test]
fn bodies_stay_in_their_boxes() {
    let mut leaning = 0;
    for model in models::vehicles() {
        let world = world(model, ActorRole::Background);
        let half = Vec3::from_array(model.size_m.map(|v| 0.5 * v as f32));
        let mut farthest = [0.0_f32; 2];
        for (mps, yaw_rad) in [(0.0, 1.5), (0.0, -1.5), (40.0, 1.5), (40.0, -1.5)] {
            let (now, then) = (moving(yaw_rad, mps), moving(0.0, 20.0));
            let Seen { body: [pose, _], points, .. } = seen(&world, &now, &now, [&then; 2]);
            farthest[0] = farthest[0].max(pose.transform_vector3(Vec3::X).z.abs());
            farthest[1] = farthest[1].max(pose.transform_vector3(Vec3::Y).z.abs());
            for at in points {
                let over = (at.abs() - half).with_z((at.z - 2.0 * half.z).max(-at.z)).max_element();
                assert!(over < 0.025, "{}: {at}", model.name);
            }
        }
        let two_wheels = model.base.tags().len() > 1;
        if two_wheels {
            assert_eq!(farthest, [0.0; 2], "{} stays upright", model.name);
        }
        leaning += usize::from(farthest[0] > 0.008 && farthest[1] > 0.01);
    }
    // Cars do; what is high and square hardly at all.
    assert!(leaning >= 15, "{leaning}");
}
