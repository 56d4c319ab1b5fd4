//! What a vehicle tows: its front turns about the hitch, and its axle never slides sideways (a tractrix).

use catalogue::trains::Train;
use frames::math::{sin_cos, tan};
use frames::{Object, Pose, World};
use nalgebra::{Point3, Vector3};
use schema::FRAME_PERIOD_S;

use crate::bodies::{Body, BodyMotion};
use crate::road::centreline::CentrelinePoint;
use crate::vehicle::motion::{after_rod, springs};
use crate::vehicle::sway::Sway;

/// A towed unit, where it is and how it stands.
#[derive(Debug)]
pub(crate) struct Towed {
    train: &'static Train,
    /// The hitch, on the ground.
    hitch: Point3<f64>,
    yaw_rad: f64,
    /// Against the level, positive nose down and right side down, radians.
    pitch_rad: f64,
    roll_rad: f64,
    /// Way of its wheels since the start, metres.
    rolled_m: f64,
    sway: Sway,
    body: Body,
    /// Where its body has skidded to since an accident, and the middle's height over the hitch's plane.
    adrift: Option<Point3<f64>>,
}

/// The middle of what is towed, from its hitch.
pub(crate) fn middle(train: &Train, hitch: Point3<f64>, yaw_rad: f64, pitch_rad: f64) -> Point3<f64> {
    let (sin, cos) = sin_cos(yaw_rad);
    hitch - Vector3::new(cos, sin, -tan(pitch_rad)) * train.coupling_m
}

impl Towed {
    /// At rest behind its hitch.
    pub(crate) fn new(train: &'static Train, hitch: Point3<f64>, yaw_rad: f64, body: Body) -> Self {
        Self {
            train,
            hitch,
            yaw_rad,
            pitch_rad: 0.0,
            roll_rad: 0.0,
            rolled_m: 0.0,
            sway: Sway::default(),
            body,
            adrift: None,
        }
    }

    pub(crate) fn train(&self) -> &'static Train {
        self.train
    }

    pub(crate) fn body(&self) -> Body {
        self.body
    }

    pub(crate) fn yaw_rad(&self) -> f64 {
        self.yaw_rad
    }

    /// Way of its wheels since the start, metres.
    pub(crate) fn rolled_m(&self) -> f64 {
        self.rolled_m
    }

    /// The middle of its footprint, on the ground.
    pub(crate) fn position(&self) -> Point3<f64> {
        self.adrift.unwrap_or_else(|| middle(self.train, self.hitch, self.yaw_rad, self.pitch_rad))
    }

    /// Its pose on the slope under it, leaning on its springs.
    pub(crate) fn world_from_object(&self) -> Pose<World, Object> {
        let (roll_rad, pitch_rad) = (self.roll_rad + self.sway.roll_rad, self.pitch_rad);
        Pose::from_xyz_rpy(self.position().into(), [roll_rad, pitch_rad, self.yaw_rad])
    }

    /// What of its pose's roll and pitch is lean on its springs, radians.
    pub(crate) fn lean_rad(&self) -> [f64; 2] {
        [self.sway.roll_rad, 0.0]
    }

    /// Comes after its hitch, which has moved straight on to a place. `under`: the road under its axle.
    pub(crate) fn follow(&mut self, hitch: Point3<f64>, under: &CentrelinePoint) {
        let moved = hitch - self.hitch;
        let before_rad = self.yaw_rad;
        self.yaw_rad = after_rod(before_rad, &moved, self.train.rod_m);
        self.hitch = hitch;
        let turned_rad = frames::wrap_pi(self.yaw_rad - before_rad);
        // The axle goes where the rod points.
        let (sin, cos) = sin_cos(before_rad + 0.5 * turned_rad);
        let ahead_m = moved.x * cos + moved.y * sin;
        self.rolled_m += ahead_m;
        self.stand(under);
        let turn_radps = turned_rad / FRAME_PERIOD_S;
        let springs = springs(self.train.towed);
        self.sway.step(0.0, ahead_m / FRAME_PERIOD_S * turn_radps, &springs, FRAME_PERIOD_S);
    }

    /// Stands on the road under its axle, as high as that and its hitch are.
    pub(crate) fn stand(&mut self, under: &CentrelinePoint) {
        let (sin, cos) = sin_cos(self.yaw_rad);
        let axle = self.hitch - Vector3::new(cos, sin, 0.0) * self.train.rod_m;
        let [ahead, left] = under.local(&axle);
        let z = under.point.z - ahead * tan(under.pitch_rad) + left * tan(under.roll_rad);
        self.pitch_rad = frames::math::atan((z - self.hitch.z) / self.train.rod_m);
        self.roll_rad = under.roll_rad;
    }

    /// Takes over where its body has skidded to after an accident, on the plane that it was on.
    pub(crate) fn skid_to(&mut self, body: &BodyMotion) {
        let at = self.position();
        let (sin, cos) = sin_cos(self.yaw_rad);
        let ahead = (body.x_m - at.x) * cos + (body.y_m - at.y) * sin;
        self.adrift = Some(Point3::new(body.x_m, body.y_m, at.z - ahead * tan(self.pitch_rad)));
        self.yaw_rad = body.yaw_rad;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use catalogue::trains;

    /// The yaw of what is towed after its lead's hitch has gone along some points.
    fn after(points: impl Iterator<Item = Point3<f64>>, rod_m: f64) -> (Point3<f64>, f64) {
        let mut at: Option<Point3<f64>> = None;
        let mut yaw_rad = 0.0;
        for point in points {
            if let Some(before) = at {
                yaw_rad = after_rod(yaw_rad, &(point - before), rod_m);
            }
            at = Some(point);
        }
        (at.expect("a point"), yaw_rad)
    }

    #[test]
    fn on_a_circle_the_axle_goes_round_inside_by_pythagoras() {
        let train = trains::of_towed("trailer.box").expect("a train");
        for radius_m in [12.0, 20.0, 40.0] {
            // The hitch itself goes round: R_t^2 = R_h^2 - L^2.
            let round = (0..4000).map(|k| {
                let (sin, cos) = sin_cos(0.005 * f64::from(k));
                Point3::new(radius_m * sin, radius_m * (1.0 - cos), 0.0)
            });
            let (hitch, yaw_rad) = after(round, train.rod_m);
            let (sin, cos) = sin_cos(yaw_rad);
            let axle = hitch - Vector3::new(cos, sin, 0.0) * train.rod_m;
            let found_m = (axle - Point3::new(0.0, radius_m, 0.0)).norm();
            let wanted_m = (radius_m * radius_m - train.rod_m * train.rod_m).sqrt();
            assert!((found_m - wanted_m).abs() < 2e-3, "{radius_m}: {found_m} instead of {wanted_m}");
        }
    }

    #[test]
    fn behind_a_straight_way_it_comes_into_line_as_a_tractrix() {
        // Turned across by 0.8 rad at first: tan(angle / 2) decays by e for each length of the rod.
        let mut yaw_rad = 0.8;
        for _ in 0..60 {
            yaw_rad = after_rod(yaw_rad, &Vector3::new(0.25, 0.0, 0.0), 7.7);
        }
        let wanted = 2.0 * frames::math::atan(tan(0.4) * frames::math::exp(-15.0 / 7.7));
        assert!((yaw_rad - wanted).abs() < 1e-9, "{yaw_rad} instead of {wanted}");
    }
}
