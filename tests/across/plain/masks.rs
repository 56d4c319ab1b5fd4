//! Masks by vertical lines through the cells' centres, as the rule `exact` is stated.

use std::collections::BTreeMap;

use frames::{Agent, Pose, World};
use nalgebra::{Point2, Vector3};
use replay::Replay;
use schema::geometry::Snapshot;
use schema::{BevClass, ObjectId, Tag};

use super::soup::{self, Piece};

const SIDE: usize = 400;
const CELL_M: f64 = 0.4;
/// Nearer to an edge than this, rounding decides on which side a centre lies, cells; and nearer in height, metres.
const TIE: f64 = 2e-3;
/// Ground surfaces this near above one another are one layer, metres.
const LAYER_M: f64 = 1.5;

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

/// An agent's grid: column, row (cells), height above the agent (metres).
struct Grid {
    origin: [f64; 3],
    ahead: (f64, f64),
}

impl Grid {
    fn of(&self, p: Vector3<f64>) -> Vector3<f64> {
        let (sin, cos) = self.ahead;
        let (dx, dy) = (p.x - self.origin[0], p.y - self.origin[1]);
        let middle = 0.5 * SIDE as f64;
        let (ahead, left) = (cos * dx + sin * dy, cos * dy - sin * dx);
        Vector3::new(middle - left / CELL_M, middle - ahead / CELL_M, p.z - self.origin[2])
    }
}

/// Calls with each cell whose centre a triangle covers, or whose centre is near its outline: the cell, the height there, and
/// whether it is near.
fn cover(corners: &[Vector3<f64>; 3], mut cell: impl FnMut(usize, f64, bool)) {
    let span = |axis: usize| {
        let values = corners.map(|p| p[axis]);
        let low = values[0].min(values[1]).min(values[2]);
        let high = values[0].max(values[1]).max(values[2]);
        let last = ((high + 1.0).ceil().clamp(0.0, SIDE as f64)) as usize;
        ((low - 1.0).floor().max(0.0) as usize)..last
    };
    let [a, b, c] = *corners;
    let normal = (b - a).cross(&(c - a));
    let (low, high) = (a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z));
    for row in span(1) {
        for column in span(0) {
            let at = Point2::new(column as f64 + 0.5, row as f64 + 0.5);
            let mut sides = [false; 2];
            let mut nearest = f64::INFINITY;
            for (from, to) in [(a, b), (b, c), (c, a)] {
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
                cell(row * SIDE + column, z, nearest < TIE);
            }
        }
    }
}

fn bit(class: BevClass) -> u16 {
    1 << class as u16
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

/// The layer of each cell that one gets to from the agent: along paved ground first, then over all.
fn reachable(cells: &[Vec<Layer>]) -> Vec<Option<Layer>> {
    let above_agent = |l: &Layer| l.low.max(-l.high).max(0.0);
    let nearest = |cell: usize, paved: bool, far: &dyn Fn(&Layer) -> f64| {
        let fits = cells[cell].iter().filter(|l| !paved || l.bits != 0);
        fits.min_by(|a, b| far(a).total_cmp(&far(b))).copied().map(|l| (far(&l), l))
    };
    let mut shown: Vec<Option<Layer>> = vec![None; cells.len()];
    let mut order = Vec::new();
    let about = (SIDE / 2 - 8)..(SIDE / 2 + 8);
    for paved in [true, false] {
        for cell in about.clone().flat_map(|row| about.clone().map(move |column| row * SIDE + column)) {
            if let (None, Some((far, layer))) = (shown[cell], nearest(cell, paved, &above_agent))
                && far <= 3.0
            {
                shown[cell] = Some(layer);
                order.push(cell);
            }
        }
        let mut next = 0;
        while next < order.len() {
            let cell: usize = order[next];
            next += 1;
            let from = shown[cell].expect("was reached");
            let step = |l: &Layer| (l.low - from.high).max(from.low - l.high).max(0.0);
            let (row, column) = (cell / SIDE, cell % SIDE);
            let ways = [
                (row > 0, -(SIDE as i64)),
                (column > 0, -1),
                (column + 1 < SIDE, 1),
                (row + 1 < SIDE, SIDE as i64),
            ];
            for to in ways.into_iter().filter(|(is_in, _)| *is_in).map(|(_, by)| (cell as i64 + by) as usize)
            {
                if let (None, Some((far, layer))) = (shown[to], nearest(to, paved, &step))
                    && far <= 0.6
                {
                    shown[to] = Some(layer);
                    order.push(to);
                }
            }
        }
    }
    let left =
        |cell: usize| shown[cell].or_else(|| nearest(cell, false, &above_agent).map(|(_, layer)| layer));
    (0..cells.len()).map(left).collect()
}

/// The bits that each cell surely has, and those that it may have.
struct Bits {
    sure: Vec<u16>,
    perhaps: Vec<u16>,
}

impl Bits {
    fn set(&mut self, cell: usize, class: BevClass, is_sure: bool) {
        self.perhaps[cell] |= bit(class);
        if is_sure {
            self.sure[cell] |= bit(class);
        }
    }
}

/// Holds a mask against all triangles, crossings, hazards and markings.
pub(super) fn check(
    replay: &Replay,
    snapshot: &Snapshot,
    pieces: &[Piece],
    pose: &Pose<World, Agent>,
    got: &[u8],
    place: &str,
) {
    let grid = Grid { origin: pose.xyz(), ahead: frames::math::sin_cos(pose.yaw()) };
    let mut met = vec![Vec::new(); SIDE * SIDE];
    for piece in pieces {
        if let Some(bits) = ground_bits(piece.tag) {
            let corners = piece.corners.map(|p| grid.of(p));
            cover(&corners, |cell, z, near_edge| met[cell].push(Met { z, bits, near_edge }));
        }
    }
    let all: Vec<Vec<Layer>> = met.iter().map(|met| layers(met, true)).collect();
    let ground = reachable(&all);
    // Where rounding may decide what ground there is, nothing is compared.
    let is_open = |cell: usize| {
        let inner = layers(&met[cell], false);
        let alike = |(a, b): (&Layer, &Layer)| {
            a.bits == b.bits && (a.high - b.high).abs() < TIE && (a.low - b.low).abs() < TIE
        };
        inner.len() != all[cell].len() || !inner.iter().zip(&all[cell]).all(alike)
    };
    let open: Vec<bool> = (0..SIDE * SIDE).map(is_open).collect();
    let level: Vec<f64> = ground.iter().map(|layer| layer.map_or(0.0, |l| l.high)).collect();
    let bits: Vec<u16> = ground.iter().map(|layer| layer.map_or(0, |l| l.bits)).collect();
    let mut bits = Bits { sure: bits.clone(), perhaps: bits };
    areas(replay, &grid, &level, &mut bits);
    markings(replay, &grid, &level, &mut bits);
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
            ties += usize::from(sure != perhaps);
        }
    }
    let unsure = open.iter().filter(|open| **open).count();
    assert!(compared[BevClass::Road as usize] > 1000, "{place}: {compared:?}");
    assert!(ties * 20 < carried && unsure * 20 < SIDE * SIDE, "{place}: {ties} ties, {unsure} open cells");
}

/// Crossings (on road) and hazards: even-odd, where the area is within half a clearance of the ground.
fn areas(replay: &Replay, grid: &Grid, level: &[f64], bits: &mut Bits) {
    let crossings = replay.map.crosswalks();
    let crossings =
        crossings.iter().map(|c| (BevClass::Crosswalk, c.polygon.iter().map(|p| p.coords).collect()));
    let hazards = replay.log.info.hazards.iter();
    let hazards = hazards.map(|h| (BevClass::Hazard, h.area_m.iter().map(|&p| Vector3::from(p)).collect()));
    for (class, polygon) in crossings.chain(hazards) {
        let polygon: Vec<Vector3<f64>> = polygon;
        let corners: Vec<Vector3<f64>> = polygon.iter().map(|&p| grid.of(p)).collect();
        let (lows, highs) = (corners.iter().map(|p| p.z), corners.iter().map(|p| p.z));
        let (low, high) = (lows.fold(f64::INFINITY, f64::min), highs.fold(f64::NEG_INFINITY, f64::max));
        for (cell, &level) in level.iter().enumerate() {
            let at = Point2::new((cell % SIDE) as f64 + 0.5, (cell / SIDE) as f64 + 0.5);
            let (mut inside, mut nearest) = (false, f64::INFINITY);
            for (k, b) in corners.iter().enumerate() {
                let a = corners[(k + corners.len() - 1) % corners.len()];
                if (a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x) {
                    inside = !inside;
                }
                let (along, away) = ((b - a).xy(), at.coords - a.xy());
                let share = (away.dot(&along) / along.norm_squared().max(1e-30)).clamp(0.0, 1.0);
                nearest = nearest.min((away - along * share).norm());
            }
            let far = |z: f64| (z - level).abs();
            let on_layer = far(low).max(far(high)) < 2.4 - TIE;
            let may_be = low - 2.4 - TIE < level && level < high + 2.4 + TIE;
            let road = class == BevClass::Hazard || bits.sure[cell] & bit(BevClass::Road) != 0;
            if (inside || nearest < TIE) && may_be && road {
                bits.set(cell, class, inside && nearest >= TIE && on_layer);
            }
        }
    }
}

/// Markings: samples of their middles, less than a cell apart.
fn markings(replay: &Replay, grid: &Grid, level: &[f64], bits: &mut Bits) {
    let mut reach = bevmap::Reach::default();
    reach.add(std::iter::once(grid.origin), 130.0);
    for line in bevmap::road_lines(&replay.map, &reach) {
        let points: Vec<Vector3<f64>> = line.iter().map(|p| grid.of(p.coords)).collect();
        let mut samples: Vec<Vector3<f64>> = points.first().copied().into_iter().collect();
        for pair in points.windows(2) {
            let steps = ((pair[1] - pair[0]).xy().norm() / 0.99).ceil().max(1.0) as usize;
            samples.extend((1..=steps).map(|k| pair[0].lerp(&pair[1], k as f64 / steps as f64)));
        }
        for sample in samples {
            let near = |v: f64| (v - v.round()).abs() < TIE;
            let is_near = near(sample.x) || near(sample.y);
            for shift in [[0.0, 0.0], [TIE, 0.0], [-TIE, 0.0], [0.0, TIE], [0.0, -TIE], [TIE; 2], [-TIE; 2]] {
                let at = [sample.x + shift[0], sample.y + shift[1]].map(f64::floor);
                if !at.iter().all(|c| (0.0..SIDE as f64).contains(c)) {
                    continue;
                }
                let cell = at[1] as usize * SIDE + at[0] as usize;
                let off = (sample.z - level[cell]).abs() - LAYER_M;
                if off < TIE {
                    bits.set(cell, BevClass::RoadLine, !is_near && off < -TIE);
                }
            }
        }
    }
}

/// What an object has of a class.
#[derive(Default)]
struct Share {
    /// Cells that it covers: with the lowest and highest corner of the triangle, and whether the centre is near an edge.
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
        cover(&corners, |cell, _, near_edge| share.cells.push((cell, z, near_edge)));
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
