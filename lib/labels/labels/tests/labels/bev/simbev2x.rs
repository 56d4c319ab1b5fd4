//! The rule `simbev2x` against hand-made numbers and vertical lines.

use frames::{Agent, Pose, World};
use labels::bev::{BevMask, Footprint, LaneAreas, LaneRasterizer, LaneStrip, LaneView};
use nalgebra::Point3;
use schema::geometry::Snapshot;
use schema::{BevClass, Tag};
use settings::BevSettings;
use testkit::{WorldBuilder, box_mesh, sheet, small_town};

use crate::bev::rays::{Hit, cast, pieces};

/// 20 cells of 0.4 m: from -4 m to 4 m.
fn small() -> BevSettings {
    BevSettings { cells: 20, cell_m: 0.4, ..BevSettings::default() }
}

fn at(xyz_m: [f64; 3], rpy_rad: [f64; 3]) -> Pose<World, Agent> {
    Pose::from_xyz_rpy(xyz_m, rpy_rad)
}

/// A straight lane along x.
fn strip(x: [f64; 2], y: [f64; 2], z: f64) -> LaneStrip {
    let steps = ((x[1] - x[0]) / 0.4).round() as usize;
    let side = |y: f64| -> Vec<Point3<f64>> {
        (0..=steps).map(|k| Point3::new(x[0] + 0.4 * k as f64, y, z)).collect()
    };
    let middle = side(0.5 * (y[0] + y[1]));
    let midline = middle.iter().enumerate().filter(|(k, _)| k % 10 == 0 || *k == steps).map(|(_, p)| *p);
    LaneStrip { left: side(y[1]), right: side(y[0]), midline: midline.collect(), markings: side(y[1] - 0.06) }
}

struct Scene {
    lanes: LaneAreas,
    hazards: Vec<Vec<Point3<f64>>>,
    footprints: Vec<Footprint>,
    world: WorldBuilder,
}

impl Scene {
    fn of(roads: Vec<LaneStrip>) -> Self {
        let lanes = LaneAreas { roads, ..LaneAreas::default() };
        Self { lanes, hazards: Vec::new(), footprints: Vec::new(), world: WorldBuilder::default() }
    }

    fn mask(&self, settings: &BevSettings, pose: &Pose<World, Agent>) -> BevMask {
        let Self { lanes, hazards, footprints, world } = self;
        let view = LaneView { lanes, hazards, footprints, chosen_at: pose.xyz().into() };
        let mut rasterizer = LaneRasterizer::new(settings).expect("settings");
        rasterizer.rasterize(&world.snapshot(pose.xyz()), pose, view)
    }
}

/// Cells (row, column) that carry a class.
fn cells(mask: &BevMask, class: BevClass) -> Vec<(usize, usize)> {
    let n = mask.cells();
    (0..n * n).map(|at| (at / n, at % n)).filter(|&(row, column)| mask.get(class, row, column)).collect()
}

fn rectangle(
    rows: std::ops::RangeInclusive<usize>,
    columns: std::ops::RangeInclusive<usize>,
) -> Vec<(usize, usize)> {
    rows.flat_map(|row| columns.clone().map(move |column| (row, column))).collect()
}

#[test]
fn lanes_are_polygons_on_whole_cells() {
    let scene = Scene::of(vec![strip([-1.9, 2.1], [-1.0, 1.0], 0.0)]);
    let mask = scene.mask(&small(), &at([0.0; 3], [0.0; 3]));
    // y = 1: (4 - 1) / 0.4 = 7.5, y = -1: 12.5; x = 2.1: 4.75, x = -1.9: 14.75. Both borders belong to it.
    assert_eq!(cells(&mask, BevClass::Road), rectangle(4..=14, 7..=12));
    // y = 0.94: 7.65.
    assert_eq!(cells(&mask, BevClass::RoadLine), rectangle(4..=14, 7..=7));
    // Only its yaw and place in plan turn the polygons.
    let tilted = scene.mask(&small(), &at([0.0, 0.0, 3.0], [0.1, -0.2, 0.0]));
    assert_eq!(cells(&tilted, BevClass::Road), cells(&mask, BevClass::Road));
}

#[test]
fn places_are_cut_off_towards_zero() {
    // Half a cell beyond the far left corner: -0.5 becomes 0. A cell and a half beyond: -1.
    let marks = |x: f64, y: f64| LaneStrip {
        markings: vec![Point3::new(x, y, 0.0)],
        ..strip([0.0, 0.4], [0.0, 0.2], 0.0)
    };
    let lines = |x, y| {
        cells(&Scene::of(vec![marks(x, y)]).mask(&small(), &at([0.0; 3], [0.0; 3])), BevClass::RoadLine)
    };
    assert_eq!(lines(4.2, 4.2), [(0, 0)]);
    assert_eq!(lines(4.6, 0.1), []);
    assert_eq!(lines(-3.9, -3.9), [(19, 19)]);
    assert_eq!(lines(-4.1, 0.1), []);
}

#[test]
fn pieces_share_no_corner() {
    let road = |end: f64| {
        let scene = Scene::of(vec![strip([-11.9, end], [-1.0, 1.0], 0.0)]);
        cells(&scene.mask(&small(), &at([2.0, 0.0, 0.0], [0.0; 3])), BevClass::Road)
    };
    // 41 samples: a piece of 40 and one of a single sample, which is no polygon. The first ends at 3.7 m, 1.7
    // m ahead: 5.75.
    assert_eq!(road(4.1), rectangle(5..=19, 7..=12));
    // A second piece of two samples: 2.1 and 2.5 m ahead.
    assert_eq!(road(4.5), rectangle(3..=19, 7..=12));
}

#[test]
fn only_lanes_near_the_agent_are_drawn() {
    let far = |x: f64| {
        let mut lane = strip([-1.9, 2.1], [-1.0, 1.0], 0.0);
        // Where its middle is decides, not its borders.
        lane.midline = vec![Point3::new(x, 0.0, 0.0)];
        cells(&Scene::of(vec![lane]).mask(&small(), &at([0.0; 3], [0.0; 3])), BevClass::Road).len()
    };
    assert_eq!([far(140.0), far(140.1)], [66, 0]);
}

#[test]
fn what_is_seen_from_above_is_road_and_crossings_lie_on_it() {
    let mut scene = Scene::of(Vec::new());
    // 0.8 to 2.0 m ahead: centres at 1.0, 1.4, 1.8, rows 7 to 5; a line 0.1 m above some of it is road, too.
    scene.world.add(sheet(Tag::Road, [0.8, 1.6], [-5.0, 5.0], 10.0, |_, _| 0.0), 1, [0.0; 3], [0.0; 3]);
    scene.world.add(sheet(Tag::RoadLine, [1.6, 2.0], [-5.0, 5.0], 10.0, |_, _| 0.1), 1, [0.0; 3], [0.0; 3]);
    let ring = |x: [f64; 2], y: [f64; 2]| {
        vec![
            Point3::new(x[0], y[0], 0.0),
            Point3::new(x[1], y[0], 0.0),
            Point3::new(x[1], y[1], 0.0),
            Point3::new(x[0], y[1], 0.0),
        ]
    };
    // Rows 2 to 8, columns 9 to 11.
    scene.lanes.crosswalks = vec![ring([0.7, 3.1], [-0.7, 0.3])];
    scene.hazards = vec![ring([-3.1, -2.1], [-1.1, 1.1])];
    scene.lanes.sidewalks = vec![strip([-1.9, 2.1], [2.1, 2.9], 0.0)];
    let mask = scene.mask(&small(), &at([0.0; 3], [0.0; 3]));
    assert_eq!(cells(&mask, BevClass::Road), rectangle(5..=7, 0..=19));
    assert_eq!(cells(&mask, BevClass::Crosswalk), rectangle(5..=7, 9..=11));
    assert_eq!(cells(&mask, BevClass::Hazard), rectangle(15..=17, 7..=12));
    assert_eq!(cells(&mask, BevClass::Sidewalk), rectangle(4..=14, 2..=4));
    assert!(cells(&mask, BevClass::RoadLine).is_empty(), "markings are points of lanes alone");
}

#[test]
fn cones_are_riders_too() {
    let mut scene = Scene::of(Vec::new());
    scene.world.add(box_mesh(Tag::TrafficCone, [0.5, 0.5, 0.7], 1), 4, [1.0, 0.2, 0.0], [0.0; 3]);
    let mask = scene.mask(&small(), &at([0.0; 3], [0.0; 3]));
    // From 0.75 to 1.25 and -0.05 to 0.45: the centres 1.0 and 0.2.
    assert_eq!(cells(&mask, BevClass::TrafficCone), [(7, 9)]);
    assert_eq!(cells(&mask, BevClass::Rider), [(7, 9)]);
}

#[test]
fn roofs_hide_from_above_and_not_from_below() {
    let mut scene = Scene::of(Vec::new());
    let mut add =
        |tag, size: [f32; 3], place: [f64; 3]| scene.world.add(box_mesh(tag, size, 1), 9, place, [0.0; 3]);
    add(Tag::Car, [1.0, 1.0, 1.5], [2.0, 2.0, 0.1]);
    add(Tag::Vegetation, [3.0, 3.0, 2.0], [2.0, 2.0, 3.0]);
    // On a deck: only from above.
    add(Tag::Bridge, [3.0, 3.0, 0.5], [-2.0, 2.0, 5.0]);
    add(Tag::Bus, [1.0, 1.0, 3.0], [-2.0, 2.0, 5.6]);
    // Between a crate and a roof: from nowhere.
    add(Tag::Static, [2.0, 2.0, 1.0], [2.0, -2.0, 0.0]);
    add(Tag::Pedestrian, [1.0, 1.0, 1.0], [2.0, -2.0, 1.0]);
    add(Tag::Building, [2.0, 2.0, 1.0], [2.0, -2.0, 2.5]);
    scene.world.add(sheet(Tag::Road, [-9.0, 9.0], [-9.0, 9.0], 18.0, |_, _| 0.0), 1, [0.0; 3], [0.0; 3]);
    let mask = scene.mask(&small(), &at([0.0; 3], [0.0; 3]));
    // The centres 1.8 and 2.2 each way.
    assert_eq!(cells(&mask, BevClass::Car).len(), 4);
    assert_eq!(cells(&mask, BevClass::Bus).len(), 4);
    assert!(cells(&mask, BevClass::Pedestrian).is_empty());
}

/// A road at 0 m, another one 8 m above it, 20 m aside.
fn two_levels() -> Scene {
    let mut scene =
        Scene::of(vec![strip([-1.9, 2.1], [-1.0, 1.0], 0.0), strip([-1.9, 2.1], [2.1, 2.9], 8.0)]);
    scene.lanes.multi_level = true;
    let box_at = |tags: &[Tag], x: f64, z: f64| Footprint {
        tags: tags.to_vec(),
        corners: [[0.5, 0.5], [0.5, -0.5], [-0.5, -0.5], [-0.5, 0.5]]
            .map(|[dx, dy]| Point3::new(x + dx, dy, z)),
    };
    scene.footprints = vec![
        box_at(&[Tag::Rider, Tag::Motorcycle], 2.0, 0.0),
        box_at(&[Tag::TrafficCone], -2.0, 4.7),
        box_at(&[Tag::Car], 0.0, 8.0),
    ];
    // A triangle tells nothing here.
    scene.world.add(box_mesh(Tag::Bus, [1.8, 1.8, 3.0], 1), 3, [0.0; 3], [0.0; 3]);
    scene
}

#[test]
fn where_levels_mix_boxes_and_heights_decide() {
    let scene = two_levels();
    let low = scene.mask(&small(), &at([0.0; 3], [0.0; 3]));
    assert_eq!(cells(&low, BevClass::Road), rectangle(4..=14, 7..=12));
    assert_eq!(cells(&low, BevClass::RoadLine), rectangle(4..=14, 7..=7));
    // x = 2.5: 3.75, x = 1.5: 6.25; y = 0.5: 8.75, y = -0.5: 11.25.
    assert_eq!(cells(&low, BevClass::Motorcycle), rectangle(3..=6, 8..=11));
    assert_eq!(cells(&low, BevClass::Rider), rectangle(3..=6, 8..=11), "and no cone");
    assert_eq!(cells(&low, BevClass::TrafficCone), rectangle(13..=16, 8..=11));
    assert!(cells(&low, BevClass::Car).is_empty() && cells(&low, BevClass::Bus).is_empty());

    let high = scene.mask(&small(), &at([0.0, 0.0, 8.0], [0.0; 3]));
    assert_eq!(cells(&high, BevClass::Road), rectangle(4..=14, 2..=4));
    assert_eq!(cells(&high, BevClass::Car), rectangle(8..=11, 8..=11));
    assert_eq!(cells(&high, BevClass::TrafficCone), rectangle(13..=16, 8..=11), "3.3 m below");

    // A map without levels never asks: all lanes, and what is seen.
    let mut flat = two_levels();
    flat.lanes.multi_level = false;
    let mask = flat.mask(&small(), &at([0.0; 3], [0.0; 3]));
    // The crack of two cells between the lanes is closed, but for its ends.
    assert_eq!(cells(&mask, BevClass::Road).len(), 66 + 33 + 2 * 9);
    assert_eq!((cells(&mask, BevClass::Bus).len(), cells(&mask, BevClass::Car).len()), (16, 0));
}

/// What is highest and lowest on each vertical line of the agent, where no rounding decides.
fn ends(hits: &[Hit]) -> Option<[Option<Tag>; 2]> {
    const GROUND: [Tag; 4] = [Tag::Road, Tag::RoadLine, Tag::Sidewalk, Tag::Terrain];
    if hits.iter().any(|hit| hit.near_edge) {
        return None;
    }
    let end = |hits: &mut dyn Iterator<Item = &Hit>, sign: f64| {
        let mut all: Vec<&Hit> = hits.collect();
        all.sort_by(|a, b| (sign * a.z).total_cmp(&(sign * b.z)));
        let clear =
            all.windows(2).next_back().is_none_or(|w| (w[1].z - w[0].z).abs() > 1e-4 || w[0].tag == w[1].tag);
        clear.then(|| all.last().map(|hit| hit.tag))
    };
    let above = end(&mut hits.iter(), 1.0)?;
    let below = end(&mut hits.iter().filter(|hit| !GROUND.contains(&hit.tag)), -1.0)?;
    Some([above, below])
}

fn check_seen(snapshot: &Snapshot, pose: Pose<World, Agent>) {
    let settings = BevSettings { cells: 120, ..BevSettings::default() };
    let lanes = LaneAreas::default();
    let view = LaneView { lanes: &lanes, hazards: &[], footprints: &[], chosen_at: pose.xyz().into() };
    let mask = LaneRasterizer::new(&settings).expect("settings").rasterize(snapshot, &pose, view);
    let agent_from_world = pose.inverse();
    let all = pieces(snapshot, |p| {
        let p = agent_from_world * p;
        Point3::new(60.0 - p.y / 0.4, 60.0 - p.x / 0.4, p.z)
    });
    let (mut sure, mut carried) = (0, 0);
    for (at, hits) in cast(&all, 120).iter().enumerate() {
        let Some(seen) = ends(hits) else { continue };
        sure += 1;
        for (tag, class) in [
            (Tag::Car, BevClass::Car),
            (Tag::Bus, BevClass::Bus),
            (Tag::Bicycle, BevClass::Bicycle),
            (Tag::Pedestrian, BevClass::Pedestrian),
            (Tag::TrafficCone, BevClass::TrafficCone),
        ] {
            let want = seen.contains(&Some(tag));
            assert_eq!(mask.get(class, at / 120, at % 120), want, "{class:?} at {} {}", at / 120, at % 120);
            carried += usize::from(want);
        }
        let rider = seen.contains(&Some(Tag::Rider)) || seen.contains(&Some(Tag::TrafficCone));
        assert_eq!(mask.get(BevClass::Rider, at / 120, at % 120), rider);
    }
    assert!(sure > 9_000 && carried > 500, "{sure} {carried}");
}

#[test]
fn objects_are_what_is_highest_or_lowest() {
    let town = small_town();
    check_seen(&town, at([-20.0, -2.0, -0.1], [0.002, -0.006, 0.05]));
    // The look tilts with the agent.
    check_seen(&town, at([4.0, 3.0, 0.3], [0.04, 0.06, 2.2]));
}
