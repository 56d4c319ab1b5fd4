//! What an agent's sensors saw of each box: points inside it, pixels, and how hard it is to detect.

use std::collections::BTreeMap;

use frames::{Pose, Sensor, World, math};
use nalgebra::{Point3, Vector3};
use schema::ObjectId;
use schema::difficulty::difficulty_of;
use schema::tables::{BoxRow, ValidBoxRow};

/// Side of the squares in which boxes are looked up, metres.
const SQUARE_M: f64 = 2.0;
/// Most squares along one axis; boxes spread wider share larger squares.
const MAX_SQUARES: usize = 512;

/// Points of one sensor at one frame.
#[derive(Clone, Copy, Debug)]
pub struct PointCloud<'a> {
    /// Where the sensor is.
    pub world_from_sensor: Pose<World, Sensor>,
    /// Forward, metres, sensor frame; as long as `y` and `z` (of unequal columns the common length counts).
    pub x: &'a [f32],
    /// Left, metres.
    pub y: &'a [f32],
    /// Up, metres.
    pub z: &'a [f32],
}

impl PointCloud<'_> {
    /// The points in the world.
    fn in_world(&self) -> impl Iterator<Item = Point3<f64>> + '_ {
        let rotation = self.world_from_sensor.isometry().rotation.to_rotation_matrix();
        let origin = self.world_from_sensor.translation();
        self.x.iter().zip(self.y).zip(self.z).map(move |((&x, &y), &z)| {
            let p = rotation * Vector3::new(f64::from(x), f64::from(y), f64::from(z));
            Point3::from(p + origin)
        })
    }
}

/// Radar returns as x, y, z columns in the radar's frame, metres: `x = d cos(alt) cos(az)`,
/// `y = d cos(alt) sin(az)`, `z = d sin(alt)`, azimuth positive to the left.
#[must_use]
pub fn radar_to_cartesian(depth_m: &[f32], altitude_rad: &[f32], azimuth_rad: &[f32]) -> [Vec<f32>; 3] {
    let mut columns = [const { Vec::new() }; 3];
    for ((&depth, &altitude), &azimuth) in depth_m.iter().zip(altitude_rad).zip(azimuth_rad) {
        let (sin_altitude, cos_altitude) = math::f32::sin_cos(altitude);
        let (sin_azimuth, cos_azimuth) = math::f32::sin_cos(azimuth);
        columns[0].push(depth * cos_altitude * cos_azimuth);
        columns[1].push(depth * cos_altitude * sin_azimuth);
        columns[2].push(depth * sin_altitude);
    }
    columns
}

/// Pixels by object and semantic tag.
pub type PixelCounts = BTreeMap<(ObjectId, u8), u32>;

/// What an agent's sensors gave at one frame.
#[derive(Clone, Copy, Debug)]
pub struct Evidence<'a> {
    /// Its lidars (semantic ones don't count).
    pub lidars: &'a [PointCloud<'a>],
    /// Its radars.
    pub radars: &'a [PointCloud<'a>],
    /// Pixels of each object and semantic tag in all its instance images together.
    pub num_pixels: &'a PixelCounts,
    /// Whether an object without points is valid when a pixel shows it.
    pub valid_by_image: bool,
}

/// Judges the boxes of one agent at one frame; one row per box, in the same order.
#[must_use]
pub fn validate(boxes: &[BoxRow], evidence: &Evidence<'_>) -> Vec<ValidBoxRow> {
    let index = BoxIndex::new(boxes);
    let lidar = index.count(evidence.lidars);
    let radar = index.count(evidence.radars);
    let points = lidar.into_iter().zip(radar);
    boxes.iter().zip(points).map(|(row, (lidar, radar))| valid_row(row, lidar, radar, evidence)).collect()
}

fn valid_row(row: &BoxRow, num_lidar_pts: u32, num_radar_pts: u32, evidence: &Evidence<'_>) -> ValidBoxRow {
    // A part with another tag (the pole of a traffic light) is not the object that the box is around.
    let num_pixels = row
        .semantic_tags
        .iter()
        .filter_map(|&tag| evidence.num_pixels.get(&(row.id, tag)))
        .fold(0, |sum: u32, &pixels| sum.saturating_add(pixels));
    let points = num_lidar_pts.saturating_add(num_radar_pts);
    let difficulty = difficulty_of(&row.class, Some(row.distance_m), points);
    ValidBoxRow {
        frame: row.frame,
        agent: row.agent.clone(),
        id: row.id,
        is_ego: row.is_ego,
        class: row.class.clone(),
        num_lidar_pts,
        num_radar_pts,
        valid_flag: points > 0 || (evidence.valid_by_image && num_pixels > 0),
        difficulty: difficulty.name().to_owned(),
        num_pixels,
        corners_m: row.corners_m,
        velocity_mps: row.velocity_mps,
        distance_m: row.distance_m,
        angle_rad: row.angle_rad,
    }
}

/// Points inside each box, edges included.
#[must_use]
pub fn count_points(boxes: &[BoxRow], clouds: &[PointCloud<'_>]) -> Vec<u32> {
    BoxIndex::new(boxes).count(clouds)
}

/// A box as three independent slabs. A point lies inside when its way from corner 0 along each edge is
/// between nothing and the edge's length.
#[derive(Clone, Copy, Debug)]
struct Slabs {
    corner: Vector3<f64>,
    /// Unit vectors along corner 0 to 2, 4, 1.
    along: [Vector3<f64>; 3],
    lengths_m: [f64; 3],
}

impl Slabs {
    fn new(corners_m: &[f64; 24]) -> Self {
        let corner = |i: usize| Vector3::new(corners_m[3 * i], corners_m[3 * i + 1], corners_m[3 * i + 2]);
        let edges = [2, 4, 1].map(|i| corner(i) - corner(0));
        let lengths_m = edges.map(|e| e.norm());
        // A flat box has no direction there: NaN, which nothing lies inside of.
        let along = std::array::from_fn(|e| edges[e] / lengths_m[e]);
        Self { corner: corner(0), along, lengths_m }
    }

    fn contains(&self, point: &Point3<f64>) -> bool {
        let from_corner = point.coords - self.corner;
        (0..3).all(|e| {
            let way = from_corner.dot(&self.along[e]);
            0.0 <= way && way <= self.lengths_m[e]
        })
    }
}

/// Boxes by the squares of the ground they may touch: a point looks at one square's boxes only.
struct BoxIndex {
    slabs: Vec<Slabs>,
    low: [f64; 2],
    per_m: f64,
    squares: [usize; 2],
    /// Where each square's boxes start in `lists`, and at last where the last one ends.
    starts: Vec<u32>,
    lists: Vec<u32>,
}

impl BoxIndex {
    fn new(boxes: &[BoxRow]) -> Self {
        let slabs = boxes.iter().map(|row| Slabs::new(&row.corners_m)).collect();
        // Outer bounds of each box in x and y; a box with a corner that is no number holds nothing.
        let bounds: Vec<Option<[[f64; 2]; 2]>> = boxes.iter().map(|row| footprint(&row.corners_m)).collect();
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for [a, b] in bounds.iter().flatten() {
            for axis in 0..2 {
                low[axis] = low[axis].min(a[axis]);
                high[axis] = high[axis].max(b[axis]);
            }
        }
        let extent_m = (high[0] - low[0]).max(high[1] - low[1]).max(0.0);
        let per_m = 1.0 / SQUARE_M.max(extent_m / (MAX_SQUARES - 1) as f64);
        let squares = [0, 1].map(|axis| {
            let count = ((high[axis] - low[axis]) * per_m).floor();
            if count.is_finite() { count as usize + 1 } else { 0 }
        });
        let mut index = Self {
            slabs,
            low,
            per_m,
            squares,
            starts: vec![0; squares[0] * squares[1] + 1],
            lists: Vec::new(),
        };
        index.sort(&bounds);
        index
    }

    /// A counting sort of boxes into squares.
    fn sort(&mut self, bounds: &[Option<[[f64; 2]; 2]>]) {
        let touched: Vec<(u32, usize)> = bounds
            .iter()
            .enumerate()
            .filter_map(|(at, bounds)| bounds.map(|b| (at as u32, b)))
            .flat_map(|(at, [low, high])| {
                let first = self.square(low);
                let last = self.square(high);
                (first[0]..=last[0])
                    .flat_map(move |x| (first[1]..=last[1]).map(move |y| (x, y)))
                    .map(move |xy| (at, xy))
            })
            .map(|(at, (x, y))| (at, x * self.squares[1] + y))
            .collect();
        for &(_, square) in &touched {
            self.starts[square + 1] += 1;
        }
        for square in 1..self.starts.len() {
            self.starts[square] += self.starts[square - 1];
        }
        self.lists = vec![0; touched.len()];
        let mut next = self.starts.clone();
        for (at, square) in touched {
            self.lists[next[square] as usize] = at;
            next[square] += 1;
        }
    }

    /// The square of a place inside the bounds.
    fn square(&self, xy: [f64; 2]) -> [usize; 2] {
        [0, 1].map(|axis| (((xy[axis] - self.low[axis]) * self.per_m) as usize).min(self.squares[axis] - 1))
    }

    fn count(&self, clouds: &[PointCloud<'_>]) -> Vec<u32> {
        let mut counts = vec![0_u32; self.slabs.len()];
        if self.lists.is_empty() {
            return counts;
        }
        let high = [0, 1].map(|axis| self.squares[axis] as f64);
        for point in clouds.iter().flat_map(PointCloud::in_world) {
            let x = (point.x - self.low[0]) * self.per_m;
            let y = (point.y - self.low[1]) * self.per_m;
            if x >= 0.0 && y >= 0.0 && x < high[0] && y < high[1] {
                let square = x as usize * self.squares[1] + y as usize;
                for &at in &self.lists[self.starts[square] as usize..self.starts[square + 1] as usize] {
                    counts[at as usize] += u32::from(self.slabs[at as usize].contains(&point));
                }
            }
        }
        counts
    }
}

/// Lowest and highest x and y of a box, a hair's breadth wider: rounding must not lose points on its edges.
fn footprint(corners_m: &[f64; 24]) -> Option<[[f64; 2]; 2]> {
    if !corners_m.iter().all(|c| c.is_finite()) {
        return None;
    }
    let ends = |axis: usize| {
        let values = || corners_m.iter().skip(axis).step_by(3).copied();
        [values().fold(f64::INFINITY, f64::min) - 1e-6, values().fold(f64::NEG_INFINITY, f64::max) + 1e-6]
    };
    let (x, y) = (ends(0), ends(1));
    Some([[x[0], y[0]], [x[1], y[1]]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use frames::{Object, OrientedBox};
    use proptest::prelude::*;
    use schema::Tag;

    pub(super) fn box_row(world_from_object: Pose<World, Object>, size: [f64; 3], class: &str) -> BoxRow {
        let bounds = OrientedBox::standing(world_from_object, size[0], size[1], size[2]);
        let mut row = BoxRow { class: class.into(), id: 1, ..BoxRow::default() };
        for (to, corner) in row.corners_m.chunks_exact_mut(3).zip(bounds.corners()) {
            to.copy_from_slice(corner.coords.as_slice());
        }
        row
    }

    fn cloud<'a>(points: &'a [Vec<f32>; 3]) -> PointCloud<'a> {
        PointCloud { world_from_sensor: Pose::identity(), x: &points[0], y: &points[1], z: &points[2] }
    }

    #[test]
    fn edges_are_inside() {
        let row = box_row(Pose::identity(), [4.0, 2.0, 1.0], "car");
        // On three corners and a face; just outside one face.
        let points = [
            vec![2.0, -2.0, 2.0, 0.0, 0.0],
            vec![1.0, -1.0, -1.0, 1.0, 0.0],
            vec![0.0, 1.0, 1.0, 0.5, 1.000_001],
        ];
        assert_eq!(count_points(&[row], &[cloud(&points)]), [4]);
    }

    #[test]
    fn flat_and_broken_boxes_hold_nothing() {
        let flat = box_row(Pose::identity(), [4.0, 2.0, 0.0], "car");
        let mut broken = box_row(Pose::identity(), [4.0, 2.0, 1.0], "car");
        broken.corners_m[5] = f64::NAN;
        let points = [vec![0.0; 3], vec![0.0; 3], vec![0.0; 3]];
        assert_eq!(count_points(&[flat, broken], &[cloud(&points)]), [0, 0]);
        assert_eq!(count_points(&[], &[cloud(&points)]), Vec::<u32>::new());
    }

    #[test]
    fn images_make_valid_only_when_asked() {
        let tags = vec![Tag::Car as u8];
        let rows = [BoxRow { semantic_tags: tags, ..box_row(Pose::identity(), [4.0, 2.0, 1.0], "car") }];
        let pixels = BTreeMap::from([((1, Tag::Car as u8), 3)]);
        let judge = |valid_by_image| {
            validate(&rows, &Evidence { lidars: &[], radars: &[], num_pixels: &pixels, valid_by_image })[0]
                .clone()
        };
        assert!(judge(true).valid_flag);
        assert!(!judge(false).valid_flag);
        assert_eq!(judge(true).difficulty, "hard");
        assert_eq!(judge(false).num_pixels, 3);
    }

    #[test]
    fn only_parts_with_the_boxs_tags_make_valid() {
        let row = |id, tags: &[Tag]| BoxRow {
            id,
            semantic_tags: tags.iter().map(|&t| t as u8).collect(),
            ..box_row(Pose::identity(), [0.3, 0.3, 0.9], "traffic_light")
        };
        // Of light 1 the pole is seen alone, of light 2 the housing too; rider and motorcycle are one object.
        let rows = [
            row(1, &[Tag::TrafficLight]),
            row(2, &[Tag::TrafficLight]),
            row(3, &[Tag::Rider, Tag::Motorcycle]),
        ];
        let pixels: PixelCounts = [
            (1, Tag::Pole, 900),
            (2, Tag::Pole, 700),
            (2, Tag::TrafficLight, 5),
            (3, Tag::Rider, 20),
            (3, Tag::Motorcycle, 30),
        ]
        .map(|(id, tag, n)| ((id, tag as u8), n))
        .into();
        let evidence = Evidence { lidars: &[], radars: &[], num_pixels: &pixels, valid_by_image: true };
        let judged: Vec<_> =
            validate(&rows, &evidence).iter().map(|v| (v.valid_flag, v.num_pixels)).collect();
        assert_eq!(judged, [(false, 0), (true, 5), (true, 50)]);
    }

    #[test]
    fn radar_returns_point_where_they_should() {
        let [x, y, z] = radar_to_cartesian(&[2.0, 2.0], &[0.0, 0.5], &[std::f32::consts::FRAC_PI_2, 0.0]);
        assert!((y[0] - 2.0).abs() < 1e-6 && x[0].abs() < 1e-6);
        assert!(
            (z[1] - 2.0 * math::f32::sin(0.5)).abs() < 1e-6
                && (x[1] - 2.0 * math::f32::cos(0.5)).abs() < 1e-6
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn counts_equal_a_test_of_every_pair(
            places in proptest::collection::vec((-40.0..40.0f64, -40.0..40.0f64, -3.0..3.0f64, -0.4..0.4f64), 1..12),
            points in proptest::collection::vec((-30.0..30.0f32, -30.0..30.0f32, -2.0..2.0f32), 0..300),
            yaw in -3.0..3.0f64,
        ) {
            let rows: Vec<BoxRow> = places
                .iter()
                .map(|p| box_row(Pose::from_xyz_rpy([p.0 + 5000.0, p.1, 0.0], [p.3, 0.1, p.2]), [9.0, 4.0, 2.0], "bus"))
                .collect();
            let world_from_sensor = Pose::from_xyz_rpy([5000.0, 0.0, 1.0], [0.02, 0.01, yaw]);
            let columns = [
                points.iter().map(|p| p.0).collect::<Vec<_>>(),
                points.iter().map(|p| p.1).collect(),
                points.iter().map(|p| p.2).collect(),
            ];
            let cloud = PointCloud { world_from_sensor, ..cloud(&columns) };
            let got = count_points(&rows, &[cloud]);
            for (place, count) in places.iter().zip(got) {
                let at = Pose::from_xyz_rpy([place.0 + 5000.0, place.1, 0.0], [place.3, 0.1, place.2]);
                let bounds = OrientedBox::standing(at, 9.0, 4.0, 2.0);
                let want = points
                    .iter()
                    .filter(|p| {
                        let p = Point3::new(f64::from(p.0), f64::from(p.1), f64::from(p.2));
                        bounds.contains(world_from_sensor * p)
                    })
                    .count();
                prop_assert_eq!(count as usize, want);
            }
        }
    }
}
