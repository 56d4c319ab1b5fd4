//! Closed forms, point-in-polygon tests and overpasses.

use frames::{FOOTPRINT_LOOP, Object, OrientedBox};
use proptest::prelude::*;
use testkit::{WorldBuilder, box_mesh, sheet};

use nalgebra::Point3;
use schema::{BevClass, Tag};
use settings::BevSettings;

use frames::{Agent, Pose, World};

use super::*;

fn settings() -> BevSettings {
    BevSettings { cells: 100, cell_m: 0.4, ..BevSettings::default() }
}

fn mask_of(builder: &WorldBuilder, pose: &Pose<World, Agent>, areas: Areas<'_>) -> BevMask {
    let near = pose.xyz();
    BevRasterizer::new(&settings()).expect("settings").rasterize(&builder.snapshot(near), pose, areas)
}

fn at(xyz_m: [f64; 3], rpy_rad: [f64; 3]) -> Pose<World, Agent> {
    Pose::from_xyz_rpy(xyz_m, rpy_rad)
}

/// Centre of a cell in the world, at the agent's height.
fn centre(pose: &Pose<World, Agent>, row: usize, column: usize) -> Point3<f64> {
    let level = Pose::<World, Agent>::from_xyz_rpy(pose.xyz(), [0.0, 0.0, pose.yaw()]);
    level * Point3::new(20.0 - 0.4 * (row as f64 + 0.5), 20.0 - 0.4 * (column as f64 + 0.5), 0.0)
}

/// Distance of a point from the border of a convex loop, positive inside.
fn inside_m(corners: &[Point3<f64>], p: Point3<f64>) -> f64 {
    let n = corners.len();
    (0..n)
        .map(|e| {
            let (a, b) = (corners[e], corners[(e + 1) % n]);
            let (along, to) = ((b - a).xy(), (p - a).xy());
            along.perp(&to) / along.norm()
        })
        .fold(f64::INFINITY, f64::min)
}

fn flat(b: &mut WorldBuilder, tag: Tag, x: [f32; 2], y: [f32; 2], z: f64) {
    b.add(sheet(tag, x, y, 5.0, |_, _| 0.0), 1, [0.0, 0.0, z], [0.0; 3]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn a_car_covers_the_centres_in_its_footprint(
        x in -18.0..18.0f64, y in -18.0..18.0f64, yaw in -3.0..3.0f64, agent_yaw in -3.0..3.0f64, tilt in -0.1..0.1f64,
    ) {
        let place = [x + 7000.0, y - 300.0, 12.0];
        let mut b = WorldBuilder::default();
        b.add(box_mesh(Tag::Car, [4.6, 1.9, 1.5], 2), 4, place, [0.0, 0.0, yaw]);
        // The mask ignores the agent's own tilt.
        let pose = at([7000.0, -300.0, 12.0], [tilt, -tilt, agent_yaw]);
        let mask = mask_of(&b, &pose, Areas::default());
        let corners = OrientedBox::standing(Pose::<World, Object>::from_xyz_rpy(place, [0.0, 0.0, yaw]), 4.6, 1.9, 1.5).corners();
        let footprint: Vec<_> = FOOTPRINT_LOOP.iter().map(|&c| corners[c]).collect();
        for row in 0..100 {
            for column in 0..100 {
                let deep = inside_m(&footprint, centre(&pose, row, column));
                if deep.abs() > 1e-3 {
                    prop_assert_eq!(mask.get(BevClass::Car, row, column), deep > 0.0, "{} {}", row, column);
                }
            }
        }
    }

    #[test]
    fn small_things_have_the_cell_they_are_in(x in -13.0..13.0f64, y in -13.0..13.0f64, yaw in -3.0..3.0f64) {
        let mut b = WorldBuilder::default();
        flat(&mut b, Tag::Road, [-30.0, 30.0], [-30.0, 30.0], 0.0);
        // Below half a cell: it covers one centre or none.
        b.add(box_mesh(Tag::Pedestrian, [0.2, 0.1, 1.7], 1), 4, [x, y, 0.0], [0.0; 3]);
        let pose = at([0.0; 3], [0.0, 0.0, yaw]);
        let mask = mask_of(&b, &pose, Areas::default());
        prop_assert_eq!(mask.counts()[BevClass::Pedestrian as usize], 1);
        let away = |row, column| (centre(&pose, row, column) - Point3::new(x, y, 0.0)).xy().norm();
        for row in 0..100 {
            for column in 0..100 {
                if mask.get(BevClass::Pedestrian, row, column) {
                    prop_assert!(away(row, column) < 0.29, "{} m away", away(row, column));
                }
            }
        }
    }
}

#[test]
fn rows_run_backwards_and_columns_to_the_right() {
    let mut b = WorldBuilder::default();
    b.add(box_mesh(Tag::Bus, [1.0, 1.0, 3.0], 1), 1, [15.0, 5.0, 0.0], [0.0; 3]);
    let mask = mask_of(&b, &at([0.0; 3], [0.0; 3]), Areas::default());
    // 15 m ahead of 20: row 5 / 0.4 = 12.5; 5 m left of 20: column 15 / 0.4 = 37.5.
    assert!(mask.get(BevClass::Bus, 12, 37));
    assert_eq!(mask.counts()[BevClass::Bus as usize], 9, "centres 0.2 apart from 0.1 inside: 3 x 3");
    let bytes = mask.to_bytes(&BevClass::ALL);
    assert_eq!(bytes.len(), 14 * 100 * 100);
    assert_eq!(bytes[BevClass::Bus as usize * 10_000 + 12 * 100 + 37], 1);
    assert_eq!(bytes.iter().map(|b| u64::from(*b)).sum::<u64>(), mask.counts().iter().sum::<u64>());
    assert_eq!(to_rgb(&mask)[3 * (12 * 100 + 37)..][..3], BevClass::Bus.rgb());
    assert_eq!(to_rgb(&mask)[..3], [255; 3]);
}

#[test]
fn lines_sidewalks_and_areas_are_where_they_are() {
    let mut b = WorldBuilder::default();
    flat(&mut b, Tag::Road, [-30.0, 30.0], [-4.0, 4.0], 0.0);
    flat(&mut b, Tag::Sidewalk, [-30.0, 30.0], [4.0, 8.0], 0.15);
    // Paint that is no lane marking.
    flat(&mut b, Tag::RoadLine, [-30.0, 30.0], [0.15, 0.27], 0.005);
    let marking = [[-30.0, 0.2], [-3.0, 0.2], [30.0, 0.2]].map(|p| Point3::new(p[0], p[1], 0.005)).to_vec();
    let area = |x: [f64; 2], y: [f64; 2], z: f64| {
        [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]].map(|p| Point3::new(p[0], p[1], z)).to_vec()
    };
    let crosswalks = [area([5.0, 9.0], [-6.0, 6.0], 0.0)];
    let hazards = [area([-10.0, -6.0], [-4.0, 0.0], 0.1), area([-10.0, -6.0], [-4.0, 0.0], 6.0)];
    let road_lines = [marking];
    let areas = Areas { crosswalks: &crosswalks, hazards: &hazards, road_lines: &road_lines };
    let mask = mask_of(&b, &at([0.0; 3], [0.0; 3]), areas);
    let counts = mask.counts();
    let of = |class: BevClass| counts[class as usize];
    assert_eq!(of(BevClass::Road), 100 * 20);
    assert_eq!(of(BevClass::Sidewalk), 100 * 10);
    assert_eq!(of(BevClass::RoadLine), 100, "one column");
    assert!((0..100).all(|row| mask.get(BevClass::RoadLine, row, 49)), "0.2 m left of the middle");
    assert_eq!(of(BevClass::Crosswalk), 10 * 20, "where there is road");
    assert_eq!(of(BevClass::Hazard), 10 * 10);
}

/// A road with a bridge across: the deck 6 m above, traffic on both. Ramps lead up at its far end.
fn overpass() -> WorldBuilder {
    let mut b = WorldBuilder::default();
    flat(&mut b, Tag::Terrain, [-40.0, 40.0], [-40.0, 40.0], -0.2);
    flat(&mut b, Tag::Road, [-40.0, 40.0], [-4.0, 4.0], 0.0);
    flat(&mut b, Tag::Road, [4.0, 12.0], [-40.0, 40.0], 6.0);
    flat(&mut b, Tag::Bridge, [4.0, 12.0], [-40.0, 40.0], 5.2);
    b.add(box_mesh(Tag::Car, [4.6, 1.9, 1.5], 1), 10, [8.0, 0.0, 0.0], [0.0; 3]);
    b.add(box_mesh(Tag::Truck, [8.0, 2.4, 4.6], 1), 11, [-2.0, 2.0, 0.0], [0.0; 3]);
    b.add(box_mesh(Tag::Bus, [12.0, 2.4, 3.0], 1), 12, [6.0, 0.0, 6.0], [0.0, 0.0, frames::deg(90.0)]);
    // Half over the edge of the grid.
    b.add(box_mesh(Tag::Bus, [12.0, 2.4, 3.0], 1), 13, [10.0, 21.0, 6.0], [0.0, 0.0, frames::deg(90.0)]);
    b
}

/// The line in the middle of the deck.
fn deck_line() -> [Vec<Point3<f64>>; 1] {
    [vec![Point3::new(8.0, -40.0, 6.005), Point3::new(8.0, 40.0, 6.005)]]
}

#[test]
fn under_a_bridge_one_sees_the_lower_deck() {
    let areas = Areas { road_lines: &deck_line(), ..Areas::default() };
    let mask = mask_of(&overpass(), &at([0.0; 3], [0.0; 3]), areas);
    let counts = mask.counts();
    assert_eq!(counts[BevClass::Road as usize], 100 * 20, "the lower road alone");
    assert_eq!(counts[BevClass::RoadLine as usize], 0);
    assert!(counts[BevClass::Car as usize] > 0 && counts[BevClass::Truck as usize] > 0);
    assert_eq!(counts[BevClass::Bus as usize], 0);
}

#[test]
fn on_a_bridge_one_sees_the_upper_deck() {
    let areas = Areas { road_lines: &deck_line(), ..Areas::default() };
    let mask = mask_of(&overpass(), &at([8.0, 0.0, 6.0], [0.0; 3]), areas);
    let counts = mask.counts();
    // Deck: 8 m of 40; lower road: 8 m, but not under the deck.
    assert_eq!(counts[BevClass::Road as usize], 20 * 100 + 80 * 20);
    assert_eq!(counts[BevClass::RoadLine as usize], 100);
    assert_eq!(counts[BevClass::Car as usize], 0, "the car is under the deck");
    let bus_cells = 6 * 30;
    assert!(counts[BevClass::Bus as usize] >= bus_cells, "both buses, one of them half outside");
}

#[test]
fn a_ramp_leads_up_to_the_layer_it_ends_on() {
    let mut b = WorldBuilder::default();
    flat(&mut b, Tag::Terrain, [-60.0, 60.0], [-60.0, 60.0], -0.2);
    // 30 % up from x = -10 to x = 10, then level 6 m above the terrain.
    b.add(
        sheet(Tag::Road, [-30.0, 30.0], [-4.0, 4.0], 1.0, |x, _| (0.3 * (x + 10.0)).clamp(0.0, 6.0)),
        2,
        [0.0; 3],
        [0.0; 3],
    );
    b.add(box_mesh(Tag::Car, [4.6, 1.9, 1.5], 1), 10, [15.0, 0.0, 6.0], [0.0; 3]);
    b.add(box_mesh(Tag::Truck, [4.6, 1.9, 3.0], 1), 11, [15.0, 0.0, -0.2], [0.0; 3]);
    // From the foot of the ramp: the road goes on up the ramp, and the truck under it can't be seen.
    let mask = mask_of(&b, &at([-15.1, 0.0, 0.0], [0.0; 3]), Areas::default());
    let near = mask.counts();
    // Row centres from x = 4.7 on backwards by 0.4; the last one on the road is at -29.7.
    assert_eq!(near[BevClass::Road as usize], 20 * 87, "from x = -30 to the grid's end at 4.9");
    let mask = mask_of(&b, &at([5.0, 0.0, 4.5], [0.0, -0.29, 0.0]), Areas::default());
    let counts = mask.counts();
    assert!(counts[BevClass::Car as usize] > 0);
    assert_eq!(counts[BevClass::Truck as usize], 0);
    assert_eq!(counts[BevClass::Road as usize], 20 * 100);
}

#[test]
fn a_bridge_shows_though_only_land_leads_to_it() {
    // Two parallel roads over a valley 3 m deep, its slopes at 45 degrees.
    let mut b = WorldBuilder::default();
    let valley = |x: f32, _: f32| (x.abs() - 10.0).clamp(-3.0, 0.0);
    b.add(sheet(Tag::Terrain, [-40.0, 40.0], [-40.0, 40.0], 1.0, valley), 1, [0.0, 0.0, -0.2], [0.0; 3]);
    for y in [0.0, 12.0] {
        flat(&mut b, Tag::Road, [-40.0, 40.0], [y - 4.0, y + 4.0], 0.0);
    }
    // The other road is joined to the agent's beyond the grid alone: where land leads to it, the way goes on
    // over its bridge.
    for x in [-15.0, 0.0] {
        let mask = mask_of(&b, &at([x, 0.0, 0.0], [0.0; 3]), Areas::default());
        assert_eq!(mask.counts()[BevClass::Road as usize], 2 * 20 * 100, "{x}");
    }
}

#[test]
fn a_bridge_shows_though_its_road_joins_the_agents_beyond_the_mask() {
    // The agent's road and beside it a bridge, 6 m above land that goes on below it everywhere. The mask ends
    // at 20 m; from 26 m on the bridge comes down and bends to the agent's road.
    let mut b = WorldBuilder::default();
    flat(&mut b, Tag::Terrain, [-100.0, 100.0], [-100.0, 100.0], -0.2);
    flat(&mut b, Tag::Road, [-100.0, 100.0], [-4.0, 4.0], 0.0);
    let deck = |x: f32, _: f32| (0.25 * (50.0 - x)).min(6.0);
    let road = |b: &mut WorldBuilder, x: [f32; 2], y: [f32; 2]| {
        b.add(sheet(Tag::Road, x, y, 1.0, deck), 1, [0.0; 3], [0.0; 3]);
    };
    road(&mut b, [-26.0, 26.0], [10.0, 18.0]);
    let alone = mask_of(&b, &at([0.0; 3], [0.0; 3]), Areas::default());
    assert_eq!(alone.counts()[BevClass::Road as usize], 20 * 100, "no road leads to it");
    road(&mut b, [26.0, 50.0], [10.0, 18.0]);
    road(&mut b, [44.0, 50.0], [4.0, 10.0]);
    let joined = mask_of(&b, &at([0.0; 3], [0.0; 3]), Areas::default());
    assert_eq!(joined.counts()[BevClass::Road as usize], 2 * 20 * 100);
    // Where the mask's ground has one layer alone, nothing beyond it counts.
    let below = mask_of(&b, &at([0.0, -16.0, 0.0], [0.0; 3]), Areas::default());
    assert_eq!(below.counts()[BevClass::Road as usize], 20 * 100);
}

#[test]
fn senseless_grids_are_refused() {
    for (cells, cell_m) in [(0, 0.4), (9000, 0.4), (400, 0.0), (400, f64::NAN)] {
        assert!(BevRasterizer::new(&BevSettings { cells, cell_m, ..BevSettings::default() }).is_err());
    }
}

#[test]
fn an_open_door_belongs_to_its_car() {
    let mut b = WorldBuilder::default();
    flat(&mut b, Tag::Road, [-30.0, 30.0], [-30.0, 30.0], 0.0);
    // From -2.3 to 2.3 along, -0.95 to 0.95 across; a leaf of 1 m that stands out square at x = 0.6, 0.2 m
    // thick.
    b.add(box_mesh(Tag::Car, [4.6, 1.9, 1.5], 2), 7, [0.0; 3], [0.0; 3]);
    let closed = mask_of(&b, &at([0.0; 3], [0.0; 3]), Areas::default()).counts()[BevClass::Car as usize];
    b.add(box_mesh(Tag::Car, [0.2, 1.0, 1.0], 1), 7, [0.6, 1.45, 0.4], [0.0; 3]);
    let mask = mask_of(&b, &at([0.0; 3], [0.0; 3]), Areas::default());
    // Centres at 0.6 ahead, 1.0, 1.4 and 1.8 to the left.
    assert_eq!(mask.counts()[BevClass::Car as usize], closed + 3);
    assert!((45..48).all(|column| mask.get(BevClass::Car, 48, column)));
}

#[test]
fn layers_beside_the_mask() {
    let mut b = WorldBuilder::default();
    flat(&mut b, Tag::Road, [-30.0, 30.0], [-4.0, 4.0], 0.25);
    b.add(box_mesh(Tag::Car, [4.6, 1.9, 1.5], 1), 300, [8.0, 0.0, 0.25], [0.0; 3]);
    b.add(box_mesh(Tag::Pedestrian, [0.1, 0.1, 1.7], 1), 5, [0.1, 3.1, 0.25], [0.0; 3]);
    // Lower than the car: below it, the car's cell stays the car's.
    b.add(box_mesh(Tag::TrafficCone, [0.5, 0.5, 0.7], 1), 4, [8.2, 0.2, 0.25], [0.0; 3]);
    let pose = at([0.0; 3], [0.0; 3]);
    let mut rasterizer = BevRasterizer::new(&BevSettings { ids: true, ..settings() }).expect("settings");
    let mask = rasterizer.rasterize(&b.snapshot([0.0; 3]), &pose, Areas::default());
    assert!(mask.get(BevClass::TrafficCone, 29, 49));
    let ids: Vec<u16> = rasterizer.id_bytes().as_chunks().0.iter().map(|&b| u16::from_le_bytes(b)).collect();
    // 8.2 m ahead: row 11.8 / 0.4 = 29.5; 0.2 m left: column 49.5.
    assert_eq!(ids[29 * 100 + 49], 300);
    // In the cell that holds its middle: 19.9 / 0.4 = 49.75, 16.9 / 0.4 = 42.25.
    assert_eq!((ids[49 * 100 + 42], mask.counts()[BevClass::Pedestrian as usize]), (5, 1));
    let shown = mask.bits().iter().map(|bits| bits >> BevClass::TrafficCone as u16 != 0);
    assert!(ids.iter().map(|&id| id != 0).eq(shown));
    let heights = rasterizer.height_bytes();
    let height_m = |at: usize| f32::from_le_bytes(heights.as_chunks().0[at]);
    assert_eq!(height_m(50 * 100 + 50), 0.25);
    assert!(height_m(50 * 100 + 5).is_nan(), "beside the road there is nothing");

    let line = |points: &[[f64; 2]]| points.iter().map(|p| Point3::new(p[0], p[1], 0.25)).collect::<Vec<_>>();
    let (stop, arrow) =
        ([line(&[[3.0, -3.7], [3.0, 0.1]])], [line(&[[5.0, 1.0], [7.0, 1.0], [7.0, 2.0], [5.0, 2.0]])]);
    let square = [line(&[[-5.0, 0.2], [-5.0, 3.2], [-10.0, 3.2], [-10.0, 0.2], [-5.0, 0.2]])];
    let paint =
        rasterizer.paint_bytes(&pose, PaintAreas { stop_lines: &stop, parking: &square, arrows: &arrow });
    let count = |channel: usize| paint[channel * 10_000..][..10_000].iter().filter(|&&b| b == 1).count();
    // Columns 49 to 59; an outline of 13 by 8 cells: rows 62 to 74 or 75, columns 42 to 49; centres 5.0 to
    // 6.6 by 1.0 to 1.8.
    assert_eq!(count(0), 11);
    assert!((38..=42).contains(&count(1)), "{}", count(1));
    assert_eq!(count(2), 5 * 3);
}

#[test]
fn masks_are_counted_altogether_and_by_place() {
    use schema::measures::bev::{BEV_CELLS, BEV_HEAT};
    let mut b = WorldBuilder::default();
    flat(&mut b, Tag::Road, [-30.0, 30.0], [-4.0, 4.0], 0.0);
    b.add(box_mesh(Tag::Bus, [1.0, 1.0, 3.0], 1), 1, [15.0, 5.0, 0.0], [0.0; 3]);
    let mask = mask_of(&b, &at([0.0; 3], [0.0; 3]), Areas::default());
    let mut counts = schema::measures::counts::PartialCounts::new();
    (0..3).for_each(|_| mask.add_to(&mut counts, "rsu_0", &settings()));
    let rows = counts.rows();
    let of = |measure: &str, class: &str| -> Vec<(i32, u64)> {
        let rows = rows.iter().filter(|row| row.measure == measure && row.class == class);
        rows.map(|row| (row.bin, row.count)).collect()
    };
    assert_eq!((of(BEV_CELLS, "bus"), of(BEV_CELLS, "car")), (vec![(0, 27)], vec![(0, 0)]));
    // Rows 11 to 13, columns 36 to 38, in blocks of two by two: one row in block 5 and two in block 6, two
    // columns in block 18 and one in block 19; three masks.
    let bus = [(50 * 5 + 18, 6), (50 * 5 + 19, 3), (50 * 6 + 18, 12), (50 * 6 + 19, 6)];
    assert_eq!(of(BEV_HEAT, "bus"), bus);
    // Twenty columns of road from 4 m left to 4 m right: ten blocks in each of fifty rows, all full.
    let road: Vec<(i32, u64)> =
        (0..50).flat_map(|row| (20..30).map(move |column| (50 * row + column, 12))).collect();
    assert_eq!(of(BEV_HEAT, "road"), road);
    assert!(of(BEV_HEAT, "car").is_empty());
}
