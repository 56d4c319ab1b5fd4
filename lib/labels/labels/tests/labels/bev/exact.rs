//! The rule `exact`, cell by cell.

use std::collections::{BTreeMap, BTreeSet};

use frames::{Agent, Pose, World};
use labels::bev::{Areas, BevMask, BevRasterizer};
use nalgebra::Point3;
use proptest::prelude::*;
use schema::geometry::Snapshot;
use schema::{BevClass, ObjectId, Tag};
use settings::BevSettings;
use testkit::{WorldBuilder, box_mesh, sheet, small_town};

use crate::bev::rays::{EDGE, Grid, Hit, Piece, cast, pieces};

const GROUND: [Tag; 7] =
    [Tag::Road, Tag::RoadLine, Tag::Sidewalk, Tag::Terrain, Tag::Ground, Tag::Water, Tag::RailTrack];
const OBJECTS: [(Tag, BevClass); 9] = [
    (Tag::TrafficCone, BevClass::TrafficCone),
    (Tag::Barrier, BevClass::Barrier),
    (Tag::Car, BevClass::Car),
    (Tag::Truck, BevClass::Truck),
    (Tag::Bus, BevClass::Bus),
    (Tag::Motorcycle, BevClass::Motorcycle),
    (Tag::Bicycle, BevClass::Bicycle),
    (Tag::Rider, BevClass::Rider),
    (Tag::Pedestrian, BevClass::Pedestrian),
];

/// Heights (lowest, highest) and classes of one layer of the ground at a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Layer {
    low: f64,
    high: f64,
    road: bool,
    sidewalk: bool,
}

/// The layers of the ground that a line meets: surfaces less than 1.5 m apart are one.
fn layers(hits: &[Hit]) -> Vec<Layer> {
    let mut ground: Vec<&Hit> = hits.iter().filter(|h| GROUND.contains(&h.tag)).collect();
    ground.sort_by(|a, b| a.z.total_cmp(&b.z));
    let mut layers: Vec<Layer> = Vec::new();
    for hit in ground {
        let (road, sidewalk) = (matches!(hit.tag, Tag::Road | Tag::RoadLine), hit.tag == Tag::Sidewalk);
        match layers.last_mut().filter(|last| hit.z - last.high <= 1.5) {
            Some(last) => {
                last.high = hit.z;
                last.road |= road;
                last.sidewalk |= sidewalk;
            }
            None => layers.push(Layer { low: hit.z, high: hit.z, road, sidewalk }),
        }
    }
    layers
}

/// The layer that is shown at each cell: the one that a way leads to from the agent, over neighbouring cells
/// and steps of at most 0.6 m, first on paving alone, then on any ground; else the one nearest to the agent's
/// height.
fn shown(layers: &[Vec<Layer>], cells: usize, cell_m: f64) -> Vec<Option<Layer>> {
    let gap = |a: Layer, b: Layer| (a.low - b.high).max(b.low - a.high).max(0.0);
    let height_gap = |l: Layer| l.low.max(-l.high).max(0.0);
    let mut shown: Vec<Option<Layer>> = vec![None; cells * cells];
    for paved in [true, false] {
        let fits = |l: &Layer| l.road || l.sidewalk || !paved;
        let reach = (3.0 / cell_m).ceil() as usize;
        let near = cells / 2 - reach..cells / 2 + reach;
        let mut todo: Vec<usize> = (0..cells * cells).filter(|&at| shown[at].is_some()).collect();
        for row in near.clone() {
            for column in near.clone() {
                let at = row * cells + column;
                let stand = layers[at].iter().copied().filter(fits);
                let best = stand.min_by(|a, b| height_gap(*a).total_cmp(&height_gap(*b)));
                if let Some(layer) = best.filter(|l| shown[at].is_none() && height_gap(*l) <= 3.0) {
                    shown[at] = Some(layer);
                    todo.push(at);
                }
            }
        }
        // Whatever the order of the search: a cell that two layers can be reached of would be a tie.
        while let Some(at) = todo.pop() {
            let Some(from) = shown[at] else { continue };
            let (row, column) = (at / cells, at % cells);
            let mut next = Vec::new();
            next.extend((row > 0).then(|| at - cells));
            next.extend((row + 1 < cells).then_some(at + cells));
            next.extend((column > 0).then(|| at - 1));
            next.extend((column + 1 < cells).then_some(at + 1));
            for to in next.into_iter().filter(|&to| shown[to].is_none()).collect::<Vec<_>>() {
                let mut ways = layers[to].iter().copied().filter(fits).filter(|l| gap(*l, from) <= 0.6);
                if let Some(layer) = ways.next() {
                    assert!(ways.next().is_none(), "a tie");
                    shown[to] = Some(layer);
                    todo.push(to);
                }
            }
        }
    }
    let nearest = |l: &Vec<Layer>| l.iter().copied().min_by(|a, b| height_gap(*a).total_cmp(&height_gap(*b)));
    shown.iter().zip(layers).map(|(shown, layers)| shown.or_else(|| nearest(layers))).collect()
}

/// Where an object stands: the middle of the bottom of the box about its largest mesh, in that mesh's own
/// frame.
fn bases(snapshot: &Snapshot, grid: &Grid) -> BTreeMap<ObjectId, Point3<f64>> {
    let mut bases: BTreeMap<ObjectId, (f32, Point3<f64>)> = BTreeMap::new();
    for instance in &snapshot.instances {
        let bounds = snapshot.mesh(instance).aabb();
        let size = bounds.max - bounds.min;
        let bottom = (0.5 * (bounds.min + bounds.max)).with_z(bounds.min.z);
        let world = snapshot.origin.world_from_local(instance.local_from_object.transform_point3(bottom));
        let offer = (size.x * size.y * size.z, grid.level(Point3::from(world)));
        let known = bases.entry(instance.object).or_insert(offer);
        if offer.0 > known.0 {
            *known = offer;
        }
    }
    bases.into_iter().map(|(object, (_, place))| (object, place)).collect()
}

/// What must be at each cell: whether it carries a class, and no answer where rounding decides.
struct Expected {
    cells: usize,
    answers: BTreeMap<(BevClass, usize), Option<bool>>,
}

impl Expected {
    fn compare(&self, mask: &BevMask, classes: &[BevClass]) -> usize {
        let (mut carried, mut open) = (0, 0);
        for &class in classes {
            for at in 0..self.cells * self.cells {
                let got = mask.get(class, at / self.cells, at % self.cells);
                match self.answers.get(&(class, at)).copied().unwrap_or(Some(false)) {
                    Some(want) => {
                        assert_eq!(
                            got,
                            want,
                            "{class:?} at row {} column {}",
                            at / self.cells,
                            at % self.cells
                        );
                        carried += usize::from(want);
                    }
                    None => open += 1,
                }
            }
        }
        assert!(open * 10 < carried.max(100), "{open} of {carried} cells are left open");
        carried
    }
}

fn expected(snapshot: &Snapshot, grid: &Grid) -> (Expected, Vec<Option<Layer>>) {
    let cells = grid.cells;
    let all = pieces(snapshot, |p| grid.level(p));
    let hits = cast(&all, cells);
    let layers: Vec<Vec<Layer>> = hits.iter().map(|hits| layers(hits)).collect();
    let shown = shown(&layers, cells, grid.cell_m);
    let mut answers: BTreeMap<(BevClass, usize), Option<bool>> = BTreeMap::new();
    for (at, hits) in hits.iter().enumerate() {
        let Some(layer) = shown[at] else { continue };
        for (class, carried) in [(BevClass::Road, layer.road), (BevClass::Sidewalk, layer.sidewalk)] {
            if carried {
                // Surfaces side by side overlap at an edge: what only touches the centre is open.
                let sure = hits.iter().any(|h| {
                    let its = if class == BevClass::Road {
                        matches!(h.tag, Tag::Road | Tag::RoadLine)
                    } else {
                        h.tag == Tag::Sidewalk
                    };
                    its && !h.near_edge && (layer.low..=layer.high).contains(&h.z)
                });
                answers.insert((class, at), sure.then_some(true));
            }
        }
    }
    objects(&all, &hits, &shown, &bases(snapshot, grid), grid, &mut answers);
    (Expected { cells, answers }, shown)
}

fn objects(
    all: &[Piece],
    hits: &[Vec<Hit>],
    shown: &[Option<Layer>],
    bases: &BTreeMap<ObjectId, Point3<f64>>,
    grid: &Grid,
    answers: &mut BTreeMap<(BevClass, usize), Option<bool>>,
) {
    let cells = grid.cells;
    let level = |at: usize| shown[at].map_or(0.0, |layer| layer.high);
    let stands = |object: ObjectId| {
        let place = bases[&object];
        let clamp = |v: f64| v.floor().clamp(0.0, cells as f64 - 1.0) as usize;
        let above = place.z - level(clamp(place.y) * cells + clamp(place.x));
        let beyond = |v: f64| (-v).max(v - cells as f64).max(0.0);
        let slack = 0.3 * beyond(place.x).max(beyond(place.y)) * grid.cell_m;
        (-0.5 - slack..=1.5 + slack).contains(&above)
    };
    let is_on = |at: usize, range: [f64; 2]| range[1] >= level(at) - 0.5 && range[0] <= level(at) + 4.8;
    let names: BTreeSet<(ObjectId, Tag)> = all.iter().map(|piece| (piece.object, piece.tag)).collect();
    for (object, tag) in names {
        let Some((_, class)) = OBJECTS.into_iter().find(|(of, _)| *of == tag) else { continue };
        if !stands(object) {
            continue;
        }
        let mut note = |at: usize, sure: bool| {
            let known = answers.entry((class, at)).or_insert(None);
            *known = known.or(sure.then_some(true));
        };
        let (mut covers, mut doubtful) = (false, false);
        for (at, hits) in hits.iter().enumerate() {
            for hit in hits.iter().filter(|h| h.object == object && h.tag == tag) {
                covers |= !hit.near_edge;
                doubtful |= hit.near_edge;
                if is_on(at, hit.range) {
                    note(at, !hit.near_edge);
                }
            }
        }
        if covers {
            continue;
        }
        let corners = || all.iter().filter(|p| p.object == object && p.tag == tag).flat_map(|p| p.corners);
        let bounds = |k: usize| {
            corners()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| [low.min(p[k]), high.max(p[k])])
        };
        let [u, v, z] = [0, 1, 2].map(bounds);
        let (u, v) = (0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1]));
        let near_border = (u - u.round()).abs() < EDGE || (v - v.round()).abs() < EDGE;
        let inside = 0.0..cells as f64;
        if inside.contains(&u) && inside.contains(&v) && is_on(v as usize * cells + u as usize, z) {
            note(v as usize * cells + u as usize, !doubtful && !near_border);
        }
    }
}

fn at(xyz_m: [f64; 3], rpy_rad: [f64; 3]) -> Pose<World, Agent> {
    Pose::from_xyz_rpy(xyz_m, rpy_rad)
}

const DRAWN: [BevClass; 11] = {
    use BevClass::*;
    [Road, Sidewalk, TrafficCone, Barrier, Car, Truck, Bus, Motorcycle, Bicycle, Rider, Pedestrian]
};

fn check(snapshot: &Snapshot, pose: Pose<World, Agent>, cells: u32, cell_m: f64) -> usize {
    let settings = BevSettings { cells, cell_m, ..BevSettings::default() };
    let mask = BevRasterizer::new(&settings).expect("settings").rasterize(snapshot, &pose, Areas::default());
    let grid = Grid { cells: cells as usize, cell_m, pose };
    expected(snapshot, &grid).0.compare(&mask, &DRAWN)
}

#[test]
fn a_town_is_what_vertical_lines_meet() {
    let town = small_town();
    for (xyz, rpy) in [([-20.0, -2.0, -0.1], [0.002, -0.006, 0.05]), ([7.3, 5.1, 0.0], [0.0, 0.03, 2.0])] {
        assert!(check(&town, at(xyz, rpy), 100, 0.4) > 4000);
    }
    assert!(
        check(&town, at([-20.0, -2.0, -0.1], [0.0, 0.0, -1.1]), 60, 1.7) > 1000,
        "many things are below a cell"
    );
    assert!(check(&town, at([18.0, -5.0, 0.0], [0.0, 0.0, 0.4]), 120, 0.11) > 4000);
}

/// A road along x with a bridge across it 6 m higher, whose ramp comes down beyond y = 20; things on both and
/// below.
fn overpass() -> WorldBuilder {
    let mut b = WorldBuilder::default();
    b.add(sheet(Tag::Terrain, [-60.0, 60.0], [-60.0, 60.0], 7.0, |_, _| -0.2), 1, [0.0; 3], [0.0; 3]);
    b.add(sheet(Tag::Road, [-60.0, 60.0], [-4.1, 3.9], 5.0, |_, _| 0.0), 1, [0.0; 3], [0.0; 3]);
    let deck = |_: f32, y: f32| 6.0 - 0.25 * (y - 12.0).clamp(0.0, 24.0);
    b.add(sheet(Tag::Road, [4.13, 12.07], [-60.0, 40.0], 1.0, deck), 1, [0.0; 3], [0.0; 3]);
    b.add(sheet(Tag::Bridge, [4.13, 12.07], [-60.0, 12.0], 5.0, |_, _| 5.2), 2, [0.0; 3], [0.0; 3]);
    let mut id = 10;
    let mut add = |tag, size: [f32; 3], place: [f64; 3], yaw: f64| {
        id += 1;
        b.add(box_mesh(tag, size, 1), id, place, [0.0, 0.0, yaw]);
    };
    for z in [0.0, 6.0] {
        add(Tag::Car, [4.6, 1.9, 1.5], [8.0, 0.3, z], 0.1);
        add(Tag::Pedestrian, [0.3, 0.4, 1.8], [6.1, -2.2, z], 0.7);
        add(Tag::TrafficCone, [0.2, 0.2, 0.7], [9.03, -3.0, z], 0.2);
        add(Tag::Barrier, [2.4, 0.05, 1.0], [10.1, 3.3, z], 0.55);
    }
    add(Tag::Bus, [12.0, 2.4, 3.0], [7.1, -17.0, 6.0], 1.5);
    add(Tag::Truck, [8.0, 2.4, 4.1], [-9.0, 1.0, 0.0], 0.02);
    add(Tag::Motorcycle, [2.1, 0.6, 1.1], [19.3, 2.0, 0.0], 0.3);
    b
}

#[test]
fn decks_never_mix() {
    let world = overpass();
    for (xyz, rpy) in [
        ([0.0, 0.1, 0.0], [0.0, 0.0, 0.02]),
        ([8.0, -6.0, 6.0], [0.0, 0.0, 1.6]),
        // On the ramp.
        ([8.1, 25.0, 2.75], [0.0, 0.24, 1.57]),
    ] {
        assert!(check(&world.snapshot(xyz), at(xyz, rpy), 100, 0.4) > 1500);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn things_of_any_size_are_where_they_are(
        things in proptest::collection::vec((0..9_usize, 0.05..3.0f32, 0.05..1.0f32, -9.0..9.0f64, -9.0..9.0f64, -3.0..3.0f64), 1..12),
        yaw in -3.0..3.0f64,
    ) {
        let mut b = WorldBuilder::default();
        b.add(sheet(Tag::Road, [-15.0, 15.0], [-15.0, 15.0], 30.0, |_, _| 0.0), 1, [0.0; 3], [0.0; 3]);
        for (k, (which, long, wide, x, y, turn)) in things.into_iter().enumerate() {
            b.add(box_mesh(OBJECTS[which].0, [long, wide, 1.0], 1), 2 + k as u16, [x, y, 0.0], [0.0, 0.0, turn]);
        }
        prop_assert!(check(&b.snapshot([0.0; 3]), at([0.03, 0.05, 0.0], [0.0, 0.0, yaw]), 40, 0.4) > 0);
    }
}

#[test]
fn markings_are_the_cells_of_their_samples() {
    let mut b = WorldBuilder::default();
    b.add(sheet(Tag::Road, [-30.0, 30.0], [-30.0, 30.0], 60.0, |_, _| 0.0), 1, [0.0; 3], [0.0; 3]);
    let chain = |points: &[[f64; 3]]| points.iter().map(|&p| Point3::from(p)).collect::<Vec<_>>();
    let lines = [
        chain(&[[-40.0, 1.03, 0.0], [-3.0, 1.7, 0.0], [2.0, 5.0, 0.0], [2.9, 40.0, 0.0]]),
        // On another deck.
        chain(&[[-10.0, -3.0, 6.0], [10.0, -3.0, 6.0]]),
    ];
    let pose = at([0.0; 3], [0.0, 0.0, 0.3]);
    let grid = Grid { cells: 100, cell_m: 0.4, pose };
    let areas = Areas { road_lines: &lines, ..Areas::default() };
    let settings = BevSettings { cells: 100, ..BevSettings::default() };
    let mask =
        BevRasterizer::new(&settings).expect("settings").rasterize(&b.snapshot([0.0; 3]), &pose, areas);
    let (mut sure, mut open) = (BTreeSet::new(), BTreeSet::new());
    for pair in lines[0].windows(2) {
        let ends = [pair[0], pair[1]].map(|p| grid.level(p));
        // At most 0.99 cells apart.
        let steps = ((ends[1] - ends[0]).xy().norm() / 0.99).ceil();
        for k in 0..=steps as usize {
            let at = ends[0] + (ends[1] - ends[0]) * (k as f64 / steps);
            let near_border = (at.x - at.x.round()).abs() < EDGE || (at.y - at.y.round()).abs() < EDGE;
            if (0.0..100.0).contains(&at.x) && (0.0..100.0).contains(&at.y) {
                let cell = at.y as usize * 100 + at.x as usize;
                let kind = if near_border { &mut open } else { &mut sure };
                kind.insert(cell);
            }
        }
    }
    assert!(sure.len() > 80 && open.len() < 5);
    let got: BTreeSet<usize> =
        (0..10_000).filter(|c| mask.get(BevClass::RoadLine, c / 100, c % 100)).collect();
    assert!(sure.is_subset(&got));
    assert!(got.iter().all(|cell| sure.contains(cell) || near(&open, *cell)));
    // Without a gap: going on, each row or column has one.
    let mut columns: Vec<usize> = got.iter().map(|c| c % 100).collect();
    columns.sort_unstable();
    let mut rows: Vec<usize> = got.iter().map(|c| c / 100).collect();
    rows.sort_unstable();
    for places in [columns, rows] {
        assert!(places.windows(2).all(|w| w[1] - w[0] <= 1), "{places:?}");
    }
}

/// Whether a cell is one of some or beside one.
fn near(cells: &BTreeSet<usize>, cell: usize) -> bool {
    cells.iter().any(|c| (c % 100).abs_diff(cell % 100) <= 1 && (c / 100).abs_diff(cell / 100) <= 1)
}
