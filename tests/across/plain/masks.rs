//! Masks by vertical lines through the cells' centres, as the rule `exact` is stated.

use std::collections::{BTreeMap, VecDeque};

use frames::{Agent, Pose, World};
use nalgebra::{Point2, Vector3};
use schema::geometry::Snapshot;
use schema::{BevClass, ObjectId, Tag};

use super::grid::{BEYOND, Bits, CELL_M, Grid, LAYER_M, SIDE, TIE, WIDE, bit};
use super::paint;
use super::roads::Road;
use super::soup::{self, Piece};

/// What one vertical line meets.
#[derive(Clone, Copy)]
struct Met {
    z: f64,
    bits: u16,
    near_edge: bool,
}

/// A layer of ground in a cell.
#[derive(Clone, Copy, PartialEq)]
struct Layer {
    low: f64,
    high: f64,
    bits: u16,
}

/// Calls with each cell of a grid whose centre a triangle covers, or whose centre is near its outline: the
/// cell, the height there, and whether it is near.
fn cover(corners: &[Vector3<f64>; 3], size: usize, mut cell: impl FnMut(usize, f64, bool)) {
    let [a, b, c] = *corners;
    let edges = [(a, b), (b, c), (c, a)];
    // Cells whose centres may lie between two coordinates.
    let cells = |low: f64, high: f64| {
        let last = (high + 1.0).ceil().clamp(0.0, size as f64) as usize;
        ((low - 1.0).floor().max(0.0) as usize)..last
    };
    // Columns that the triangle comes near to in a row: from its edges between the centres of the rows
    // beside.
    let columns = |row: usize| {
        let (above, below) = (row as f64 - 0.5, row as f64 + 1.5);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (from, to) in edges {
            let share = |y: f64| ((y - from.y) / (to.y - from.y)).clamp(0.0, 1.0);
            let [first, last] = if from.y == to.y { [0.0, 1.0] } else { [share(above), share(below)] };
            let ends = [first, last].map(|share| from + (to - from) * share);
            if ends.iter().any(|end| end.y >= above - 1e-6 && end.y <= below + 1e-6) {
                low = ends.iter().fold(low, |low, end| low.min(end.x));
                high = ends.iter().fold(high, |high, end| high.max(end.x));
            }
        }
        if low <= high { cells(low, high) } else { 0..0 }
    };
    let normal = (b - a).cross(&(c - a));
    let (low, high) = (a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z));
    for row in cells(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y)) {
        for column in columns(row) {
            let at = Point2::new(column as f64 + 0.5, row as f64 + 0.5);
            let mut sides = [false; 2];
            let mut nearest = f64::INFINITY;
            for (from, to) in edges {
                let (from, to) = (Point2::new(from.x, from.y), Point2::new(to.x, to.y));
                let (along, away) = (to - from, at - from);
                sides[usize::from(along.perp(&away) > 0.0)] = true;
                let share = (away.dot(&along) / along.norm_squared().max(1e-30)).clamp(0.0, 1.0);
                nearest = nearest.min((away - along * share).norm());
            }
            let inside = !(sides[0] && sides[1]);
            if inside || nearest < TIE {
                let slope = |axis: usize| -normal[axis] / normal.z;
                let plane = a.z + (at.x - a.x) * slope(0) + (at.y - a.y) * slope(1);
                let z = if plane.is_finite() { plane.clamp(low, high) } else { high };
                cell(row * size + column, z, nearest < TIE);
            }
        }
    }
}

/// The classes that ground of a tag shows; none where it is no ground.
fn ground_bits(tag: Tag) -> Option<u16> {
    match tag {
        Tag::Road | Tag::RoadLine => Some(bit(BevClass::Road)),
        Tag::Sidewalk => Some(bit(BevClass::Sidewalk)),
        Tag::Terrain | Tag::Ground | Tag::Water | Tag::RailTrack => Some(0),
        _ => None,
    }
}

fn object_class(tag: Tag) -> Option<BevClass> {
    BevClass::ALL.into_iter().skip(BevClass::TrafficCone as usize).find(|class| class.name() == tag.name())
}

/// Layers of a line from low to high; with or without what is met near an edge.
fn layers(met: &[Met], edges_too: bool) -> Vec<Layer> {
    let mut met: Vec<&Met> = met.iter().filter(|m| edges_too || !m.near_edge).collect();
    met.sort_by(|a, b| a.z.total_cmp(&b.z));
    let mut layers: Vec<Layer> = Vec::new();
    for m in met {
        match layers.last_mut() {
            Some(last) if m.z - last.high <= LAYER_M => {
                last.high = m.z;
                last.bits |= m.bits;
            }
            _ => layers.push(Layer { low: m.z, high: m.z, bits: m.bits }),
        }
    }
    layers
}

/// The layer of each cell that one gets to from the agent: along paved ground first, then over all, and along
/// paved ground again wherever that meets some. The cells are those of the wide grid.
fn reachable(cells: &[Vec<Layer>]) -> Vec<Option<Layer>> {
    let above_agent = |l: &Layer| l.low.max(-l.high).max(0.0);
    let nearest = |cell: usize, paved: bool, far: &dyn Fn(&Layer) -> f64| {
        let fits = cells[cell].iter().filter(|l| !paved || l.bits != 0);
        fits.min_by(|a, b| far(a).total_cmp(&far(b))).copied().map(|l| (far(&l), l))
    };
    let mut shown: Vec<Option<Layer>> = vec![None; cells.len()];
    let (mut on_roads, mut on_all) = (VecDeque::new(), VecDeque::new());
    let about = (WIDE / 2 - 8)..(WIDE / 2 + 8);
    for paved in [true, false] {
        for cell in about.clone().flat_map(|row| about.clone().map(move |column| row * WIDE + column)) {
            if let (None, Some((far, layer))) = (shown[cell], nearest(cell, paved, &above_agent))
                && far <= 3.0
            {
                shown[cell] = Some(layer);
                [&mut on_roads, &mut on_all].into_iter().for_each(|queue| queue.push_back(cell));
            }
        }
        loop {
            let next = on_roads.pop_front().map(|cell| (cell, true));
            let over_all = |queue: &mut VecDeque<usize>| queue.pop_front().map(|cell| (cell, false));
            let next = if paved { next } else { next.or_else(|| over_all(&mut on_all)) };
            let Some((cell, along)) = next else { break };
            let from: Layer = shown[cell].expect("was reached");
            if along && from.bits == 0 {
                continue;
            }
            let step = |l: &Layer| (l.low - from.high).max(from.low - l.high).max(0.0);
            let (row, column) = (cell / WIDE, cell % WIDE);
            let ways = [
                (row > 0, -(WIDE as i64)),
                (column > 0, -1),
                (column + 1 < WIDE, 1),
                (row + 1 < WIDE, WIDE as i64),
            ];
            for to in ways.into_iter().filter(|(is_in, _)| *is_in).map(|(_, by)| (cell as i64 + by) as usize)
            {
                if let (None, Some((far, layer))) = (shown[to], nearest(to, along, &step))
                    && far <= 0.6
                {
                    shown[to] = Some(layer);
                    [&mut on_roads, &mut on_all].into_iter().for_each(|queue| queue.push_back(to));
                }
            }
        }
    }
    let left =
        |cell: usize| shown[cell].or_else(|| nearest(cell, false, &above_agent).map(|(_, layer)| layer));
    (0..cells.len()).map(left).collect()
}

/// What a scene has on its ground: the map's roads, the log's hazards.
pub(super) struct Ground {
    pub(super) roads: Vec<Road>,
    pub(super) hazards: Vec<Vec<Vector3<f64>>>,
}

/// Holds a mask against all triangles, crossings, hazards and markings. Returns how many cells of each class
/// were compared, of markings: metres.
pub(super) fn check(
    on_ground: &Ground,
    snapshot: &Snapshot,
    pieces: &[Piece],
    pose: &Pose<World, Agent>,
    got: &[u8],
    place: &str,
) -> [usize; BevClass::COUNT] {
    let grid = Grid { origin: pose.xyz(), ahead: frames::math::sin_cos(pose.yaw()) };
    let mut met = vec![Vec::new(); WIDE * WIDE];
    let beyond = Vector3::new(BEYOND as f64, BEYOND as f64, 0.0);
    for piece in pieces {
        if let Some(bits) = ground_bits(piece.tag) {
            let corners = piece.corners.map(|p| grid.of(p) + beyond);
            cover(&corners, WIDE, |cell, z, near_edge| met[cell].push(Met { z, bits, near_edge }));
        }
    }
    let all: Vec<Vec<Layer>> = met.iter().map(|met| layers(met, true)).collect();
    let reached = reachable(&all);
    let in_wide = |cell: usize| (cell / SIDE + BEYOND) * WIDE + cell % SIDE + BEYOND;
    let ground: Vec<Option<Layer>> = (0..SIDE * SIDE).map(|cell| reached[in_wide(cell)]).collect();
    // Where rounding may decide what ground there is, nothing is compared.
    let is_open = |cell: usize| {
        let (met, all) = (&met[in_wide(cell)], &all[in_wide(cell)]);
        let inner = layers(met, false);
        let alike = |(a, b): (&Layer, &Layer)| {
            a.bits == b.bits && (a.high - b.high).abs() < TIE && (a.low - b.low).abs() < TIE
        };
        inner.len() != all.len() || !inner.iter().zip(all).all(alike)
    };
    let open: Vec<bool> = (0..SIDE * SIDE).map(is_open).collect();
    let level: Vec<f64> = ground.iter().map(|layer| layer.map_or(0.0, |l| l.high)).collect();
    let bits: Vec<u16> = ground.iter().map(|layer| layer.map_or(0, |l| l.bits)).collect();
    let mut bits = Bits { sure: bits.clone(), perhaps: bits };
    paint::areas(&on_ground.roads, &on_ground.hazards, &grid, &level, &mut bits);
    let lines_m = paint::markings(&on_ground.roads, &grid, pose, &level, &open, got, (&mut bits, place));
    objects(snapshot, pieces, &grid, (&ground, &level), &mut bits);

    let mut compared = [0_usize; BevClass::COUNT];
    let (mut carried, mut ties) = (0, 0);
    for cell in (0..SIDE * SIDE).filter(|&cell| !open[cell]) {
        for class in BevClass::ALL {
            let got = got[class as usize * SIDE * SIDE + cell] != 0;
            let (sure, perhaps) = (bits.sure[cell] & bit(class) != 0, bits.perhaps[cell] & bit(class) != 0);
            let at = || format!("{place}: {} at row {}, column {}", class.name(), cell / SIDE, cell % SIDE);
            assert!(got || !sure, "{} is missing", at());
            assert!(!got || perhaps, "{} should not be there", at());
            compared[class as usize] += usize::from(sure);
            carried += usize::from(got);
            // Samples of markings lie where they lie: what they must and may set was held against the lines.
            ties += usize::from(sure != perhaps && class != BevClass::RoadLine);
        }
    }
    let unsure = open.iter().filter(|open| **open).count();
    assert!(ties * 20 < carried && unsure * 20 < SIDE * SIDE, "{place}: {ties} ties, {unsure} open cells");
    compared[BevClass::RoadLine as usize] = lines_m as usize;
    compared
}

/// What an object has of a class.
#[derive(Default)]
struct Share {
    /// Cells that it covers: with the lowest and highest corner of the triangle, and whether the centre is
    /// near an edge.
    cells: Vec<(usize, [f64; 2], bool)>,
    corners: Vec<Vector3<f64>>,
}

fn objects(
    snapshot: &Snapshot,
    pieces: &[Piece],
    grid: &Grid,
    (ground, level): (&[Option<Layer>], &[f64]),
    bits: &mut Bits,
) {
    let mut bases: BTreeMap<ObjectId, (Vector3<f64>, f64)> = BTreeMap::new();
    for instance in &snapshot.instances {
        let mesh = snapshot.mesh(instance);
        if mesh.parts.iter().any(|part| object_class(part.tag).is_some()) {
            let base = soup::base(snapshot, instance, mesh);
            let known = bases.entry(instance.object).or_insert(base);
            if base.1 > known.1 {
                *known = base;
            }
        }
    }
    let mut shares: BTreeMap<(ObjectId, BevClass), Share> = BTreeMap::new();
    for piece in pieces {
        let Some(class) = object_class(piece.tag) else { continue };
        let corners = piece.corners.map(|p| grid.of(p));
        let share = shares.entry((piece.object, class)).or_default();
        share.corners.extend(corners);
        let z = [corners.map(|p| p.z).into_iter().fold(f64::INFINITY, f64::min), {
            corners.map(|p| p.z).into_iter().fold(f64::NEG_INFINITY, f64::max)
        }];
        cover(&corners, SIDE, |cell, _, near_edge| share.cells.push((cell, z, near_edge)));
    }
    for ((object, class), share) in shares {
        let last = SIDE as f64 - 1.0;
        let base = grid.of(bases[&object].0);
        let (u, v) = (base.x.floor().clamp(0.0, last), base.y.floor().clamp(0.0, last));
        let beyond = ((base.x - u - 0.5).abs().max((base.y - v - 0.5).abs()) - 0.5).max(0.0);
        let at = v as usize * SIDE + u as usize;
        let above = base.z - level[at];
        let slack_m = 0.3 * beyond * CELL_M;
        let most = if ground[at].is_some() { LAYER_M } else { 4.8 };
        let stands = |give: f64| above >= -0.5 - slack_m - give && above <= most + slack_m + give;
        if !stands(TIE) {
            continue;
        }
        let sure = stands(-TIE);
        let on_layer = |cell: usize, z: [f64; 2], give: f64| {
            z[1] >= level[cell] - 0.5 - give && z[0] <= level[cell] + 4.8 + give
        };
        for &(cell, z, near_edge) in share.cells.iter().filter(|(cell, z, _)| on_layer(*cell, *z, TIE)) {
            bits.set(cell, class, sure && !near_edge && on_layer(cell, z, -TIE));
        }
        if share.cells.iter().any(|(.., near_edge)| !near_edge) {
            continue;
        }
        // Too small for any centre: the one cell about its middle; not surely if an edge may cover a centre.
        let side = |axis: usize| {
            let values = || share.corners.iter().map(move |p| p[axis]);
            [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)]
        };
        let (across, down, z) = (side(0), side(1), side(2));
        let middle = [across, down].map(|s| 0.5 * (s[0] + s[1]));
        for shift in [[0.0; 2], [TIE, TIE], [-TIE, -TIE], [TIE, -TIE], [-TIE, TIE]] {
            let at = [0, 1].map(|k| (middle[k] + shift[k]).floor());
            if at.iter().all(|c| (0.0..SIDE as f64).contains(c)) {
                let cell = at[1] as usize * SIDE + at[0] as usize;
                let clear = middle.iter().all(|v| (v - v.round()).abs() > TIE);
                if on_layer(cell, z, TIE) {
                    bits.set(cell, class, sure && clear && share.cells.is_empty() && on_layer(cell, z, -TIE));
                }
            }
        }
    }
}
