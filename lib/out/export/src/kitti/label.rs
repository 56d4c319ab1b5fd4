//! Labels: an object in a picture, one line.

use frames::wrap_pi;
use nalgebra::{Isometry3, Point3};
use scene::LabelledBox;
use schema::tables::Box2dRow;
use schema::{Attribute, DetectionClass, Tag};

/// Nearer than this before the camera no corner is projected, m.
const NEAR_M: f64 = 0.1;

/// A label without its frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Label {
    pub(super) id: u16,
    kind: &'static str,
    /// Share of its box outside of the picture, 0 to 1.
    truncated: f64,
    /// 0 wholly seen, 1 partly hidden, 2 largely hidden, 3 unknown.
    occluded: u8,
    /// Left, top, right, bottom, pixels from 0.
    bounds_px: [f64; 4],
    height_width_length_m: [f64; 3],
    /// Middle of the bottom face in the camera's frame, m.
    bottom_m: [f64; 3],
    /// About the camera's y axis; 0 is heading along its x axis.
    rotation_y_rad: f64,
}

/// The name of a box's class in KITTI; none where it has none.
fn kind_of(raw: &schema::tables::BoxRow) -> Option<&'static str> {
    let base = raw.attributes.get(&Attribute::BaseType);
    Some(match DetectionClass::from_name(&raw.class)? {
        DetectionClass::Car | DetectionClass::Truck if base == Some("van") => "Van",
        DetectionClass::Car => "Car",
        DetectionClass::Truck => "Truck",
        DetectionClass::Pedestrian
            if [Attribute::UseWheelchair, Attribute::SitsOnBench]
                .iter()
                .any(|f| raw.attributes.is_true(f)) =>
        {
            "Person_sitting"
        }
        DetectionClass::Pedestrian => "Pedestrian",
        DetectionClass::Bicycle if raw.semantic_tags.contains(&(Tag::Rider as u8)) => "Cyclist",
        DetectionClass::Bicycle | DetectionClass::Motorcycle | DetectionClass::Bus => "Misc",
        _ => return None,
    })
}

/// The label of a box in a picture of a size; none where the picture does not show it or the benchmark has no
/// such class. `shown` is what the store says of it in this picture, if it says anything.
pub(super) fn label(
    labelled: &LabelledBox,
    shown: Option<&Box2dRow>,
    optical_from_world: &Isometry3<f64>,
    (intrinsics, size_px): ([[f64; 3]; 3], [f64; 2]),
) -> Option<Label> {
    let raw = &labelled.raw;
    let kind = kind_of(raw)?;
    let corners: Vec<Point3<f64>> =
        raw.corners_m.as_chunks::<3>().0.iter().map(|c| optical_from_world * Point3::from(*c)).collect();
    let (bounds_px, truncated, occluded) = match shown {
        Some(shown) => {
            let occluded = match shown.occlusion {
                share if share < 0.1 => 0,
                share if share < 0.5 => 1,
                _ => 2,
            };
            (shown.visible_px.map(f64::from), f64::from(shown.truncation), occluded)
        }
        None => {
            let whole = bounds(&corners, intrinsics)?;
            let cut = cut(whole, size_px)?;
            (cut, 1.0 - area(cut) / area(whole), 3)
        }
    };
    let bottom = (corners[0].coords + corners[2].coords + corners[4].coords + corners[6].coords) / 4.0;
    let ahead = corners[4] - corners[0];
    let [length, width, height] = raw.size_m;
    Some(Label {
        id: raw.id,
        kind,
        truncated,
        occluded,
        bounds_px,
        height_width_length_m: [height, width, length],
        bottom_m: bottom.into(),
        rotation_y_rad: frames::math::atan2(-ahead.z, ahead.x),
    })
}

/// The rectangle around the corners on the screen; none where one is not before the camera.
fn bounds(corners: &[Point3<f64>], k: [[f64; 3]; 3]) -> Option<[f64; 4]> {
    let mut around = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    for corner in corners {
        if corner.z < NEAR_M {
            return None;
        }
        let [x, y] = [corner.x / corner.z, corner.y / corner.z];
        let (u, v) = (k[0][0] * x + k[0][1] * y + k[0][2], k[1][0] * x + k[1][1] * y + k[1][2]);
        around = [around[0].min(u), around[1].min(v), around[2].max(u), around[3].max(v)];
    }
    Some(around)
}

/// Labels have two digits of a pixel: what is less wide would have no width.
const LEAST_PX: f64 = 0.02;

/// What of a rectangle is in the picture.
fn cut([left, top, right, bottom]: [f64; 4], [width, height]: [f64; 2]) -> Option<[f64; 4]> {
    let inside = [left.max(0.0), top.max(0.0), right.min(width), bottom.min(height)];
    (inside[0] + LEAST_PX <= inside[2] && inside[1] + LEAST_PX <= inside[3]).then_some(inside)
}

fn area([left, top, right, bottom]: [f64; 4]) -> f64 {
    (right - left) * (bottom - top)
}

impl Label {
    /// The line of the object benchmark, without its end; that of tracking has the frame and the track before
    /// it.
    pub(super) fn line(&self) -> String {
        let [left, top, right, bottom] = self.bounds_px;
        let [height, width, length] = self.height_width_length_m;
        let [x, y, z] = self.bottom_m;
        let observed = wrap_pi(self.rotation_y_rad - frames::math::atan2(x, z));
        format!(
            "{} {:.2} {} {observed:.6} {left:.2} {top:.2} {right:.2} {bottom:.2} {height:.4} {width:.4} {length:.4} {x:.4} {y:.4} {z:.4} {:.6}",
            self.kind, self.truncated, self.occluded, self.rotation_y_rad
        )
    }

    /// The line of the tracking benchmark: whole numbers stand for how far it is cut off.
    pub(super) fn tracking_line(&self, frame: u32) -> String {
        let truncated = match self.truncated {
            share if share < 0.05 => "0",
            share if share < 0.5 => "1",
            _ => "2",
        };
        let line = self.line();
        let mut words = line.splitn(3, ' ');
        let (kind, _, rest) = (words.next().unwrap_or(""), words.next(), words.next().unwrap_or(""));
        format!("{frame} {} {kind} {truncated} {rest}", self.id)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{UnitQuaternion, Vector3};
    use schema::tables::BoxRow;

    use super::*;

    const K: [[f64; 3]; 3] = [[500.0, 0.0, 320.0], [0.0, 500.0, 180.0], [0.0, 0.0, 1.0]];
    const SIZE: [f64; 2] = [640.0, 360.0];

    /// The world as a camera at the origin sees it that looks along +x: x right is -y, y down is -z, z ahead
    /// is x.
    fn optical_from_world() -> Isometry3<f64> {
        let half = 0.5;
        let turn = nalgebra::Quaternion::new(half, -half, half, -half);
        Isometry3::from_parts(Vector3::zeros().into(), UnitQuaternion::from_quaternion(turn)).inverse()
    }

    /// A car of 4 x 2 x 1.5 m.
    fn car(x: f64, y: f64, yaw: f64) -> LabelledBox {
        let (s, c) = (frames::math::sin(yaw), frames::math::cos(yaw));
        let mut corners_m = [0.0; 24];
        for (i, corner) in corners_m.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            let ahead = if i < 4 { -2.0 } else { 2.0 };
            let left = if i % 4 < 2 { 1.0 } else { -1.0 };
            let up = if i % 2 == 0 { -1.0 } else { 0.5 };
            *corner = [x + c * ahead - s * left, y + s * ahead + c * left, up];
        }
        let raw =
            BoxRow { id: 7, class: "car".into(), size_m: [4.0, 2.0, 1.5], corners_m, ..BoxRow::default() };
        LabelledBox { raw, seen: None }
    }

    fn of(labelled: &LabelledBox) -> Option<Label> {
        label(labelled, None, &optical_from_world(), (K, SIZE))
    }

    #[test]
    fn a_car_ahead_that_drives_away() {
        let label = of(&car(20.0, 0.0, 0.0)).expect("is in the picture");
        // Its rear is 18 m away: 1 m of width are 500 / 18 pixels; it stands from 1 m below to 0.5 m above
        // the camera.
        let side = 500.0 / 18.0;
        let expected = [320.0 - side, 180.0 - side / 2.0, 320.0 + side, 180.0 + side];
        assert!(
            label.bounds_px.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9),
            "{:?}",
            label.bounds_px
        );
        assert!((label.rotation_y_rad + std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert!((Vector3::from(label.bottom_m) - Vector3::new(0.0, 1.0, 20.0)).norm() < 1e-12);
        assert_eq!(label.height_width_length_m, [1.5, 2.0, 4.0]);
        let line = "Car 0.00 3 -1.570796 292.22 166.11 347.78 207.78 1.5000 2.0000 4.0000 0.0000 1.0000 20.0000 -1.570796";
        assert_eq!(label.line().replace("-0.0000", "0.0000"), line);
        let tracked = label.tracking_line(12).replace("-0.0000", "0.0000");
        assert_eq!(tracked, line.replace("Car 0.00", "12 7 Car 0"));
    }

    #[test]
    fn headings_are_about_the_cameras_y_axis() {
        // To the right (world -y) is along the camera's x axis; towards the camera is its -z.
        for (yaw, expected) in [(-90.0_f64, 0.0), (90.0, 180.0), (180.0, 90.0)] {
            let found =
                of(&car(20.0, 0.0, yaw.to_radians())).expect("in the picture").rotation_y_rad.to_degrees();
            assert!(
                (found - expected).abs() < 1e-6 || (found + 360.0 - expected).abs() < 1e-6,
                "{yaw}: {found}"
            );
        }
        assert_eq!(of(&car(20.0, -20.0, 0.0)), None, "it is outside of the picture");
    }

    #[test]
    fn what_is_cut_off_is_counted_and_what_is_behind_left_out() {
        let label = of(&car(10.0, 6.0, 0.0)).expect("is partly in the picture");
        let whole = [320.0 - 500.0 * 7.0 / 8.0, 320.0 - 500.0 * 5.0 / 12.0];
        let expected = 1.0 - whole[1] / (whole[1] - whole[0]);
        assert!((label.truncated - expected).abs() < 1e-9, "{}", label.truncated);
        assert!(of(&car(-10.0, 0.0, 0.0)).is_none() && of(&car(1.0, 0.0, 0.0)).is_none());
        let mut sign = car(20.0, 0.0, 0.0);
        sign.raw.class = "traffic_sign".into();
        assert!(of(&sign).is_none());
    }

    #[test]
    fn a_hair_of_a_box_in_the_picture_is_none() {
        let size = [640.0, 480.0];
        assert_eq!(cut([630.0, 10.0, 700.0, 20.0], size), Some([630.0, 10.0, 640.0, 20.0]));
        assert_eq!(cut([639.99, 10.0, 700.0, 20.0], size), None);
        assert_eq!(cut([10.0, -5.0, 20.0, 0.004], size), None);
    }

    #[test]
    fn what_the_store_says_of_the_picture_comes_first() {
        let shown = Box2dRow {
            visible_px: [1.0, 2.0, 3.0, 4.0],
            occlusion: 0.3,
            truncation: 0.6,
            ..Box2dRow::default()
        };
        let label =
            label(&car(20.0, 0.0, 0.0), Some(&shown), &optical_from_world(), (K, SIZE)).expect("a label");
        assert_eq!((label.bounds_px, label.occluded), ([1.0, 2.0, 3.0, 4.0], 1));
        assert!(label.tracking_line(0).starts_with("0 7 Car 2 1 "));
    }
}
