//! One actor on a given trajectory.

use catalogue::Model;
use frames::{Object, Pose, World};
use nalgebra::{Point3, Vector3};
use schema::tables::PlanTrajectoryRow;
use schema::{ActorRole, FRAME_PERIOD_S, ObjectId};

use crate::scene::rows::Snapshot;

/// Before its first row an actor comes along as it goes on then, for so many frames: those that velocities of
/// the first recorded frame and the one before need.
const LEAD_FRAMES: i32 = 2;
/// Slower than this it stands, m/s.
const STANDS_MPS: f64 = 0.05;
/// Largest steering angle, radians.
const MAX_STEER_RAD: f64 = 0.9;

/// A vehicle or a pedestrian, pose by pose.
#[derive(Debug)]
pub(super) struct GivenActor {
    model: &'static Model,
    color: Vec<u8>,
    role: ActorRole,
    first_frame: i32,
    /// Position, and roll, pitch and yaw, frame by frame; never empty.
    poses: Vec<([f64; 3], [f64; 3])>,
    /// Way since the first of them, metres; negative backwards.
    rolled_m: Vec<f64>,
    /// It does not move from this frame on.
    stays_from: i32,
}

impl GivenActor {
    /// From its rows, frame by frame without gaps.
    pub(super) fn new(
        model: &'static Model,
        color: Vec<u8>,
        role: ActorRole,
        rows: &[PlanTrajectoryRow],
    ) -> Self {
        let poses: Vec<([f64; 3], [f64; 3])> = rows.iter().map(|row| (row.xyz_m, row.rpy_rad)).collect();
        let mut rolled_m = vec![0.0];
        let mut stays_from = rows[0].frame;
        for (pair, row) in rows.windows(2).zip(&rows[1..]) {
            let moved = Point3::from(pair[1].xyz_m) - Point3::from(pair[0].xyz_m);
            let (sin, cos) = frames::math::sin_cos(pair[0].rpy_rad[2]);
            let forward = moved.x * cos + moved.y * sin;
            let rolled = rolled_m.last().copied().unwrap_or(0.0);
            rolled_m.push(rolled + moved.norm().copysign(forward));
            if moved.norm() > STANDS_MPS * FRAME_PERIOD_S {
                stays_from = row.frame;
            }
        }
        Self { model, color, role, first_frame: rows[0].frame, poses, rolled_m, stays_from }
    }

    pub(super) fn model(&self) -> &'static Model {
        self.model
    }

    pub(super) fn color(&self) -> &[u8] {
        &self.color
    }

    pub(super) fn role(&self) -> ActorRole {
        self.role
    }

    pub(super) fn is_vehicle(&self) -> bool {
        self.model.wheelbase_m > 0.0
    }

    /// Whether it moves no more from a frame on.
    pub(super) fn stays_from(&self, frame: i32) -> bool {
        frame >= self.stays_from
    }

    /// Position, and roll, pitch and yaw at a frame: before its first row as if it came along evenly, for two
    /// frames; after the last one as there.
    fn at(&self, frame: i32) -> ([f64; 3], [f64; 3]) {
        let number = frame.saturating_sub(self.first_frame);
        let last = self.poses.len() - 1;
        if number >= 0 {
            return self.poses[(number as usize).min(last)];
        }
        let back = f64::from(number.max(-LEAD_FRAMES));
        let ((xyz_m, rpy_rad), (next_xyz_m, next_rpy_rad)) = (self.poses[0], self.poses[last.min(1)]);
        let axes = [0, 1, 2];
        (
            axes.map(|k| xyz_m[k] + back * (next_xyz_m[k] - xyz_m[k])),
            axes.map(|k| rpy_rad[k] + back * frames::wrap_pi(next_rpy_rad[k] - rpy_rad[k])),
        )
    }

    pub(super) fn position(&self, frame: i32) -> Point3<f64> {
        self.at(frame).0.into()
    }

    pub(super) fn yaw_rad(&self, frame: i32) -> f64 {
        frames::wrap_pi(self.at(frame).1[2])
    }

    pub(super) fn pose(&self, frame: i32) -> Pose<World, Object> {
        let (xyz_m, rpy_rad) = self.at(frame);
        Pose::from_xyz_rpy(xyz_m, rpy_rad)
    }

    /// Over the step that ends at a frame.
    pub(super) fn velocity_mps(&self, frame: i32) -> Vector3<f64> {
        (self.position(frame) - self.position(frame - 1)) / FRAME_PERIOD_S
    }

    pub(super) fn speed_mps(&self, frame: i32) -> f64 {
        self.velocity_mps(frame).norm()
    }

    /// How fast it becomes faster, m/s2; negative while it brakes.
    pub(super) fn along_mps2(&self, frame: i32) -> f64 {
        (self.speed_mps(frame) - self.speed_mps(frame - 1)) / FRAME_PERIOD_S
    }

    /// Way since its first row, metres.
    fn rolled_m(&self, frame: i32) -> f64 {
        let number = frame.saturating_sub(self.first_frame).max(0) as usize;
        self.rolled_m[number.min(self.rolled_m.len() - 1)]
    }

    /// The angle of front wheels that turn it as it turns over so much way (the bicycle model), radians.
    fn steer_rad(&self, frame: i32) -> f64 {
        let way_m = (self.position(frame) - self.position(frame - 1)).xy().norm();
        if way_m < STANDS_MPS * FRAME_PERIOD_S {
            return 0.0;
        }
        let turn_rad = frames::wrap_pi(self.yaw_rad(frame) - self.yaw_rad(frame - 1));
        frames::math::atan(self.model.wheelbase_m * turn_rad / way_m).clamp(-MAX_STEER_RAD, MAX_STEER_RAD)
    }

    /// Its state at a frame.
    pub(super) fn snapshot(&self, id: ObjectId, frame: i32, lights: u32) -> Snapshot {
        let is_vehicle = self.is_vehicle();
        let wheel_m = if self.model.wheel_radius_m > 0.0 { self.model.wheel_radius_m } else { 1.0 };
        Snapshot {
            id,
            world_from_object: self.pose(frame),
            world_from_object_before: self.pose(frame - 1),
            lean_rad: [0.0; 2],
            steer_rad: if is_vehicle { self.steer_rad(frame) } else { 0.0 },
            phase_rad: self.rolled_m(frame) / wheel_m,
            seat_m: 0.0,
            lights,
            door_rad: [0.0; 4],
            dormant: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn actor(rows: impl Iterator<Item = (i32, [f64; 3], f64)>) -> GivenActor {
        let row = |(frame, xyz_m, yaw_rad)| PlanTrajectoryRow {
            frame,
            xyz_m,
            rpy_rad: [0.0, 0.0, yaw_rad],
            ..PlanTrajectoryRow::default()
        };
        let rows: Vec<PlanTrajectoryRow> = rows.map(row).collect();
        let model = catalogue::models::find("car.sedan").expect("a model");
        GivenActor::new(model, vec![0; 3], ActorRole::Background, &rows)
    }

    #[test]
    fn it_comes_along_two_frames_before_its_first_row_and_stays_after_its_last() {
        let car = actor((0..5).map(|k| (k, [0.5 * f64::from(k), 1.0, 2.0], 0.0)));
        assert_eq!(car.position(3), Point3::new(1.5, 1.0, 2.0));
        assert_eq!(car.position(-1), Point3::new(-0.5, 1.0, 2.0));
        assert_eq!(car.position(-40), Point3::new(-1.0, 1.0, 2.0));
        assert_eq!(car.position(9), Point3::new(2.0, 1.0, 2.0));
        assert!((car.speed_mps(0) - 10.0).abs() < 1e-9 && (car.speed_mps(-1) - 10.0).abs() < 1e-9);
        assert_eq!((car.speed_mps(-10), car.speed_mps(8)), (0.0, 0.0));
        assert!(!car.stays_from(3) && car.stays_from(4));
    }

    #[test]
    fn on_a_circle_the_wheels_are_turned_as_its_radius_asks() {
        // 20 m of radius at 8 m/s: the bicycle's angle is atan(wheelbase / radius).
        let radius_m = 20.0;
        let at = |k: i32| {
            let angle = 8.0 * FRAME_PERIOD_S * f64::from(k) / radius_m;
            let (sin, cos) = frames::math::sin_cos(angle);
            (k, [radius_m * cos, radius_m * sin, 0.0], frames::wrap_pi(angle + 0.5 * std::f64::consts::PI))
        };
        let car = actor((0..400).map(at));
        let want = frames::math::atan(car.model().wheelbase_m / radius_m);
        for frame in [1, 100, 399] {
            assert!((car.steer_rad(frame) - want).abs() < 1e-3, "{frame}: {}", car.steer_rad(frame));
            assert!((car.rolled_m(frame) - 0.4 * f64::from(frame)).abs() < 1e-3 * f64::from(frame));
        }
    }
}
