//! Paint on the road: lane markings, crosswalks, stop lines, parking spaces, arrows, words.

use earcut::Earcut;
use nalgebra::{Point3, Vector3};
use opendrive::{Map, MarkColour, RoadSymbol, StopLine, Stripe};
use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use crate::surfaces::blocks::Blocks;
use crate::surfaces::cover::Cover;
use crate::surfaces::region::Region;
use crate::surfaces::sections::{Ground, Section, WIDEST_M};
use schema::Layer;

/// Paint lies this high over the road, metres: more than any chord's error, less than can be seen.
const PAINT_M: f64 = 0.006;
/// Stripes of a crosswalk and the gaps between them, metres.
const ZEBRA_M: [f64; 2] = [0.5, 0.6];
/// Painted areas are cut to pieces of this length to follow the road, metres.
const PIECE_M: f64 = 1.5;
const THIN_LINE_M: f64 = 0.1;
const MAX_DASHES: usize = 20_000;

const WHITE: MeshPart = MeshPart::new(Tag::RoadLine, Surface::RoadMarking, [0.72, 0.72, 0.70]);
const YELLOW: MeshPart = MeshPart::new(Tag::RoadLine, Surface::RoadMarking, [0.72, 0.50, 0.06]);

/// Draws the paint whose pieces have their middles in an area.
pub(crate) fn build(
    map: &Map,
    (stop_lines, symbols): (&[StopLine], &[RoadSymbol]),
    sections: &[&Section],
    area: &Region,
    cover: &Cover,
    blocks: &mut Blocks,
) {
    let near = area.grown(WIDEST_M);
    for section in sections {
        if !(0..section.s.len() - 1).any(|i| section.inside(i, &near)) {
            continue;
        }
        for stripe in map.stripes_of(section.road, section.section) {
            if stripe.mark_type.is_painted() {
                lane_marking(section, stripe, area, cover, blocks);
            }
        }
    }
    let mut painter = Painter { area, cover, blocks };
    crosswalks(map, &mut painter);
    parking_spaces(map, &mut painter);
    read(symbols, &mut painter);
    for line in stop_lines {
        painter.band(WHITE, line.ends[0], line.ends[1], line.width_m);
    }
}

fn colour(stripe: &Stripe) -> MeshPart {
    match stripe.colour {
        MarkColour::Yellow | MarkColour::Orange => YELLOW,
        _ => WHITE,
    }
}

/// Points of a lane border and the direction of larger t at each.
type Border = (Vec<Point3<f64>>, Vec<Vector3<f64>>);

/// The line along a lane border that carries a stripe, and the direction of larger t at each sample.
fn border(section: &Section, border_of: i16) -> Option<Border> {
    let at = |lane: i16| section.strips.iter().find(|s| s.lane.lane == lane);
    let (strip, left_side) = match border_of {
        0 => at(-1).map(|s| (s, true)).or_else(|| at(1).map(|s| (s, false)))?,
        lane if lane < 0 => (at(lane)?, false),
        lane => (at(lane)?, true),
    };
    // The lane on the other side may be the lower one: paint lies on the road, not on the kerb.
    let step = if left_side { 1 } else { -1 };
    let beyond = match strip.lane.lane + step {
        0 => step,
        lane => lane,
    };
    let raised = |s: &super::sections::Strip| s.ground.raised() || s.ground == Ground::Land;
    if raised(strip) && at(beyond).is_none_or(raised) {
        return None;
    }
    let line = if left_side { &strip.left } else { &strip.right };
    let points = line.iter().zip(&strip.raise).map(|(p, raise)| {
        let up = if left_side { raise[0] } else { raise[1] };
        Point3::new(p.x, p.y, p.z - up)
    });
    let across = (0..line.len()).map(|i| {
        let width = strip.left[i] - strip.right[i];
        let flat = Vector3::new(width.x, width.y, 0.0).norm();
        if flat > 0.02 {
            return width / flat;
        }
        let forward = line[(i + 1).min(line.len() - 1)] - line[i.saturating_sub(1)];
        Vector3::new(-forward.y, forward.x, 0.0).try_normalize(1e-9).unwrap_or_else(Vector3::zeros)
    });
    Some((points.collect(), across.collect()))
}

fn lane_marking(section: &Section, stripe: &Stripe, area: &Region, cover: &Cover, blocks: &mut Blocks) {
    let Some((line, across)) = border(section, stripe.border_of) else { return };
    let offsets = [stripe.t_offset_m - 0.5 * stripe.width_m, stripe.t_offset_m + 0.5 * stripe.width_m];
    let paint = colour(stripe);
    let mut spans = vec![[stripe.s_start, stripe.s_end]];
    if let Some([on, off]) = stripe.dash.filter(|[on, off]| *on > 0.0 && *off > 0.0) {
        let count = (((stripe.s_end - stripe.s_start) / (on + off)).ceil().max(0.0) as usize).min(MAX_DASHES);
        spans = (0..count)
            .map(|i| stripe.s_start + i as f64 * (on + off))
            .map(|s| [s, (s + on).min(stripe.s_end)])
            .filter(|[from, to]| to - from > 0.05)
            .collect();
    }
    // The road is straight between samples, so paint is, too: points in between lie on the chord.
    let at = |s: f64| -> [Point3<f64>; 2] {
        let k = section.s.partition_point(|v| *v <= s).clamp(1, section.s.len() - 1);
        let (s0, s1) = (section.s[k - 1], section.s[k]);
        let share = if s1 > s0 { ((s - s0) / (s1 - s0)).clamp(0.0, 1.0) } else { 0.0 };
        let point = line[k - 1] + (line[k] - line[k - 1]) * share;
        let side = across[k - 1] + (across[k] - across[k - 1]) * share;
        offsets.map(|o| point + side * o + Vector3::z() * PAINT_M)
    };
    for [from, to] in spans {
        let first = section.s.partition_point(|v| *v <= from);
        let last = section.s.partition_point(|v| *v < to);
        let mut stops = vec![from];
        stops.extend(section.s.get(first..last).unwrap_or_default());
        stops.push(to);
        let mut before = at(from);
        for s in &stops[1..] {
            let after = at(*s);
            let middle = Point3::from(0.5 * (before[0].coords + after[1].coords));
            // In a junction other connecting lanes run across: their asphalt has no lines.
            let hidden = || {
                section.junction
                    && cover
                        .at(middle.x, middle.y)
                        .any(|(f, z)| f.is_driven_by_others(section.road) && (z - middle.z).abs() < 1.0)
            };
            if area.contains(middle.x, middle.y) && !hidden() {
                blocks.quad(Layer::Marking, paint, [before[0], after[0], after[1], before[1]]);
            }
            before = after;
        }
    }
}

/// Paints areas of the plan onto the road under them.
struct Painter<'a> {
    area: &'a Region,
    cover: &'a Cover,
    blocks: &'a mut Blocks,
}

impl Painter<'_> {
    /// Whether the box around some points reaches into the area.
    fn reaches(&self, points: &[Point3<f64>]) -> bool {
        let fold =
            |pick: fn(f64, f64) -> f64, from| [0, 1].map(|k| points.iter().map(|p| p[k]).fold(from, pick));
        let bounds = Region { min: fold(f64::min, f64::INFINITY), max: fold(f64::max, f64::NEG_INFINITY) };
        bounds.grown(1.0).meets(self.area)
    }

    /// A flat convex polygon near height `z`, counter-clockwise from above, laid on the road.
    fn polygon(&mut self, paint: MeshPart, polygon: &[[f64; 2]], z: f64) {
        let count = polygon.len() as f64;
        let [x, y] = [0, 1].map(|k| polygon.iter().map(|p| p[k]).sum::<f64>() / count);
        if polygon.len() < 3 || !self.area.contains(x, y) {
            return;
        }
        let lift = |p: &[f64; 2]| {
            let road = self.cover.road_near(p[0], p[1], z);
            Point3::new(p[0], p[1], road.unwrap_or(z) + PAINT_M)
        };
        let mut points: Vec<Point3<f64>> = polygon.iter().map(lift).collect();
        // Where the surfaces of two ways through a junction meet, the road may rise between the corners.
        let middle = points.iter().map(|p| p.coords).sum::<Vector3<f64>>() / points.len() as f64;
        let rise = (lift(&[middle.x, middle.y]).z - middle.z).max(0.0);
        points.iter_mut().for_each(|p| p.z += rise);
        for i in 1..points.len() - 1 {
            self.blocks.triangle(Layer::Marking, paint, [points[0], points[i], points[i + 1]]);
        }
    }

    /// A band of some width along a line, in pieces.
    fn band(&mut self, paint: MeshPart, from: Point3<f64>, to: Point3<f64>, width_m: f64) {
        let along = Vector3::new(to.x - from.x, to.y - from.y, 0.0);
        let Some(dir) = along.try_normalize(1e-6) else { return };
        let side = Vector3::new(-dir.y, dir.x, 0.0) * (0.5 * width_m);
        let pieces = (along.norm() / PIECE_M).ceil().clamp(1.0, 1000.0) as usize;
        for i in 0..pieces {
            let ends = [i, i + 1].map(|k| from + (to - from) * (k as f64 / pieces as f64));
            let corners = [ends[0] - side, ends[1] - side, ends[1] + side, ends[0] + side];
            self.polygon(paint, &corners.map(|p| [p.x, p.y]), 0.5 * (ends[0].z + ends[1].z));
        }
    }
}

/// Keeps the part of a convex polygon where `normal . p <= limit` (Sutherland and Hodgman, 1974).
fn clip(polygon: &[[f64; 2]], normal: [f64; 2], limit: f64) -> Vec<[f64; 2]> {
    let side = |p: &[f64; 2]| normal[0] * p[0] + normal[1] * p[1] - limit;
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, a) in polygon.iter().enumerate() {
        let b = &polygon[(i + 1) % polygon.len()];
        let (da, db) = (side(a), side(b));
        if da <= 0.0 {
            kept.push(*a);
        }
        if (da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0) {
            let share = da / (da - db);
            kept.push([a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share]);
        }
    }
    kept
}

/// Zebra stripes along the direction of traffic, across the way of the walkers.
fn crosswalks(map: &Map, painter: &mut Painter<'_>) {
    for crosswalk in map.crosswalks() {
        let n = crosswalk.polygon.len();
        if n < 3 || !painter.reaches(&crosswalk.polygon) {
            continue;
        }
        let Some(pose) = map.road_pose(crosswalk.road, crosswalk.s, 0.0, 0.0) else { continue };
        let mut ring: Vec<[f64; 2]> = crosswalk.polygon.iter().map(|p| [p.x, p.y]).collect();
        let area: f64 =
            (0..n).map(|i| ring[i][0] * ring[(i + 1) % n][1] - ring[(i + 1) % n][0] * ring[i][1]).sum();
        if area < 0.0 {
            ring.reverse();
        }
        // Traffic runs along the polygon's short sides: of its edges' directions, take the one nearest to the
        // road's.
        let road = pose.forward();
        let mut best = ([road.x, road.y], -1.0);
        for i in 0..n {
            let edge = [ring[(i + 1) % n][0] - ring[i][0], ring[(i + 1) % n][1] - ring[i][1]];
            let length = (edge[0] * edge[0] + edge[1] * edge[1]).sqrt();
            let score = (edge[0] * road.x + edge[1] * road.y).abs() / length.max(1e-6);
            if length > 0.5 && score > best.1 {
                best = ([edge[0] / length, edge[1] / length], score);
            }
        }
        let along = best.0;
        let across = [-along[1], along[0]];
        let dot = |p: &[f64; 2], d: [f64; 2]| p[0] * d[0] + p[1] * d[1];
        let range = |d: [f64; 2]| {
            ring.iter()
                .map(|p| dot(p, d))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
        };
        let (low, high) = range(across);
        let (near, far) = range(along);
        let z = crosswalk.polygon.iter().map(|p| p.z).sum::<f64>() / n as f64;
        let pitch = ZEBRA_M[0] + ZEBRA_M[1];
        let stripes = ((high - low - ZEBRA_M[0]) / pitch).floor().clamp(0.0, 500.0) as usize;
        let first = low + 0.5 * (high - low - ZEBRA_M[0] - stripes as f64 * pitch);
        for i in 0..=stripes {
            let c = first + i as f64 * pitch;
            let stripe = clip(&clip(&ring, across, c + ZEBRA_M[0]), across.map(|v| -v), -c);
            let pieces = ((far - near) / PIECE_M).ceil().clamp(1.0, 50.0) as usize;
            for k in 0..pieces {
                let at = |k: usize| near + (far - near) * k as f64 / pieces as f64;
                let piece = clip(&clip(&stripe, along, at(k + 1)), along.map(|v| -v), -at(k));
                painter.polygon(WHITE, &piece, z);
            }
        }
    }
}

/// The outlines of parking spaces that the map holds as objects.
fn parking_spaces(map: &Map, painter: &mut Painter<'_>) {
    for object in map.objects().iter().filter(|o| o.kind.eq_ignore_ascii_case("parkingspace")) {
        let Some(ring) = object.outlines.first().filter(|o| o.base.len() >= 3) else { continue };
        if !painter.reaches(&ring.base) {
            continue;
        }
        let n = ring.base.len();
        for i in 0..n {
            painter.band(WHITE, ring.base[i], ring.base[(i + 1) % n], THIN_LINE_M);
        }
    }
}

/// Arrows and words that the map holds.
fn read(symbols: &[RoadSymbol], painter: &mut Painter<'_>) {
    let mut earcut = Earcut::new();
    let mut corners: Vec<u32> = Vec::new();
    for area in symbols.iter().flat_map(|symbol| &symbol.areas) {
        if !painter.reaches(area) {
            continue;
        }
        earcut.earcut(area.iter().map(|p| [p.x, p.y]), &[], &mut corners);
        for triangle in corners.chunks_exact(3) {
            let mut ends: Vec<[f64; 2]> = Vec::with_capacity(3);
            ends.extend(triangle.iter().filter_map(|i| area.get(*i as usize)).map(|p| [p.x, p.y]));
            let [a, b, c] = ends[..] else { continue };
            if (b[0] - a[0]) * (c[1] - a[1]) < (b[1] - a[1]) * (c[0] - a[0]) {
                ends.reverse();
            }
            let z = triangle.iter().filter_map(|i| area.get(*i as usize)).map(|p| p.z).sum::<f64>() / 3.0;
            painter.polygon(WHITE, &ends, z);
        }
    }
}

#[cfg(test)]
mod tests {
    use schema::geometry::SurfaceMesh;

    use super::*;
    use crate::surfaces::Atlas;

    #[test]
    fn arrows_are_painted_as_far_as_their_outlines_go() {
        let text = r#"<OpenDRIVE><header/><road id="1" length="60" junction="-1">
            <planView><geometry s="0" x="0" y="0" hdg="0" length="60"><line/></geometry></planView>
            <lanes><laneSection s="0"><center><lane id="0" type="none"/></center>
            <right><lane id="-1" type="driving"><width sOffset="0" a="4" b="0" c="0" d="0"/></lane></right></laneSection></lanes>
            <objects>
            <object id="1" type="roadMark" name="ArrowStraight" s="20" t="-2" zOffset="0" hdg="0"><outlines>
            <outline closed="true"><cornerLocal u="-2" v="-0.1" z="0" height="0"/><cornerLocal u="1" v="-0.1" z="0" height="0"/>
            <cornerLocal u="1" v="-0.5" z="0" height="0"/><cornerLocal u="2" v="0" z="0" height="0"/>
            <cornerLocal u="1" v="0.5" z="0" height="0"/><cornerLocal u="1" v="0.1" z="0" height="0"/>
            <cornerLocal u="-2" v="0.1" z="0" height="0"/></outline></outlines></object>
            <object id="2" type="roadMark" name="arrow of no outline" s="40" t="-2" zOffset="0" hdg="0" length="3" width="1"/>
            </objects></road></OpenDRIVE>"#;
        let map = testkit::map_from_text(text);
        let area = Region { min: [0.0, -16.0], max: [64.0, 16.0] };
        let painted = |from: f32, to: f32| -> f32 {
            let area_m2 = |surface: &SurfaceMesh| -> f32 {
                let mesh = &surface.mesh;
                let x = |p: glam::Vec3| p.x + surface.origin_m[0] as f32;
                let triangles = (0..mesh.triangles.len()).map(|i| mesh.corners(i));
                let inside = triangles.filter(|t| t.iter().all(|p| (from..to).contains(&x(*p))));
                inside.map(|[a, b, c]| 0.5 * (b - a).cross(c - a).z).sum()
            };
            let surfaces = Atlas::new(&map).ground(&area).surfaces();
            surfaces.iter().filter(|s| s.layer == Layer::Marking).map(area_m2).sum()
        };
        // A shaft of 3 m x 0.2 m and a head of 1 m x 1 m; a rectangle.
        assert!((painted(17.9, 22.1) - (0.6 + 0.5)).abs() < 1e-3, "{}", painted(17.9, 22.1));
        assert!((painted(38.4, 41.6) - 3.0).abs() < 1e-3, "{}", painted(38.4, 41.6));
        assert!((painted(0.0, 60.0) - 4.1).abs() < 1e-3, "{}", painted(0.0, 60.0));
    }
}
