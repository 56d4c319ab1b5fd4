//! Roads as their OpenDRIVE file states them, evaluated anew: the reference line, heights, lanes, markings,
//! crossings.
//!
//! What the maps of these tests do not have (lateral shapes, crossfall, one-sided sections, cubic lines) is
//! refused.

use frames::math::{atan2, sin, sin_cos};
use nalgebra::{Point3, Vector3};
use roxmltree::{Document, Node};

/// A polynomial that holds from `s` on.
#[derive(Clone, Copy)]
struct Cubic {
    s: f64,
    abcd: [f64; 4],
}

impl Cubic {
    fn at(&self, s: f64) -> (f64, f64) {
        let ([a, b, c, d], x) = (self.abcd, s - self.s);
        (a + x * (b + x * (c + x * d)), b + x * (2.0 * c + x * 3.0 * d))
    }
}

/// Value and slope at `s`; what has no record is zero.
fn value(records: &[Cubic], s: f64) -> (f64, f64) {
    let holding = records.iter().rev().find(|r| r.s <= s).or(records.first());
    holding.map_or((0.0, 0.0), |r| if r.s <= s { r.at(s) } else { (r.abcd[0], 0.0) })
}

enum Curve {
    /// Curvature at both ends: lines, arcs, spirals.
    Bent([f64; 2]),
    /// Coordinates ahead and to the left, over the share of the length or over metres.
    Cubics { ahead: Cubic, left: Cubic, by_share: bool },
}

struct Piece {
    s: f64,
    length: f64,
    start: [f64; 3],
    curve: Curve,
}

impl Piece {
    /// Place and heading `ds` metres along.
    fn at(&self, ds: f64) -> [f64; 3] {
        let [x, y, heading] = self.start;
        match &self.curve {
            Curve::Bent([from, to]) => {
                let angle = |d: f64| heading + d * (from + 0.5 * (to - from) * d / self.length);
                // Simpson's rule over the heading.
                let steps = 2 * (ds.abs() / 0.4).ceil() as usize + 4;
                let width = ds / steps as f64;
                let mut sum = [0.0; 2];
                for k in 0..=steps {
                    let weight = if k == 0 || k == steps { 1.0 } else { 2.0 + 2.0 * (k % 2) as f64 };
                    let (sin, cos) = sin_cos(angle(k as f64 * width));
                    sum = [sum[0] + weight * cos, sum[1] + weight * sin];
                }
                [x + sum[0] * width / 3.0, y + sum[1] * width / 3.0, angle(ds)]
            }
            Curve::Cubics { ahead, left, by_share } => {
                let p = if *by_share { ds / self.length } else { ds };
                let ((u, du), (v, dv)) = (ahead.at(p), left.at(p));
                let (sin, cos) = sin_cos(heading);
                [x + u * cos - v * sin, y + u * sin + v * cos, heading + atan2(dv, du)]
            }
        }
    }
}

struct Mark {
    s: f64,
    kind: String,
    width_m: f64,
    /// Lines stated one by one: offsets along and across.
    lines: Vec<[f64; 2]>,
}

struct Lane {
    id: i32,
    kind: String,
    widths: Vec<Cubic>,
    marks: Vec<Mark>,
}

impl Lane {
    fn is_paved(&self) -> bool {
        !["none", "median", "curb", "sidewalk", "walking"].contains(&self.kind.as_str())
    }
}

struct Section {
    from: f64,
    to: f64,
    lanes: Vec<Lane>,
}

impl Section {
    fn lane(&self, id: i32) -> Option<&Lane> {
        self.lanes.iter().find(|lane| lane.id == id)
    }

    /// Distance of a lane's outer border from the middle lane, to the left.
    fn border(&self, id: i32, s: f64) -> f64 {
        let inside = self.lanes.iter().filter(|l| l.id * id.signum() > 0 && l.id.abs() <= id.abs());
        f64::from(id.signum()) * inside.map(|l| value(&l.widths, s - self.from).0.max(0.0)).sum::<f64>()
    }
}

pub(super) struct Road {
    pub(super) id: String,
    is_junction: bool,
    plan: Vec<Piece>,
    height: Vec<Cubic>,
    bank: Vec<Cubic>,
    offset: Vec<Cubic>,
    sections: Vec<Section>,
    pub(super) crossings: Vec<Vec<Vector3<f64>>>,
}

/// The middle of a painted line.
pub(super) struct Line<'r> {
    pub(super) road: &'r Road,
    section: &'r Section,
    pub(super) border_of: i32,
    t_m: f64,
    /// From where to where it runs, metres of s.
    span: [f64; 2],
}

impl Line<'_> {
    pub(super) fn at(&self, s: f64) -> Vector3<f64> {
        // What begins where the section ends is no part of it.
        let s = s.min(self.section.to.next_down());
        self.road.point(s, value(&self.road.offset, s).0 + self.section.border(self.border_of, s) + self.t_m)
    }

    /// The part of it that has all places which are near, metres of s; to a metre.
    pub(super) fn near(&self, is_near: impl Fn(&Vector3<f64>) -> bool) -> Option<[f64; 2]> {
        let [from, to] = self.span;
        let steps = (to - from).ceil().max(1.0);
        let at = |k: usize| from + (to - from) * k as f64 / steps;
        let mut near = (0..=steps as usize).filter(|k| is_near(&self.at(at(*k))));
        let first = near.next()?;
        let last = near.last().unwrap_or(first);
        Some([at(first.saturating_sub(1)), at(last + 1).min(to)])
    }

    pub(super) fn is_in_junction(&self) -> bool {
        self.road.is_junction
    }
}

/// A thin slice of a lane: its four corners, left and right border in turn at either end.
pub(super) type Slice = [Vector3<f64>; 4];

impl Road {
    /// A point of the surface, `t` metres to the left of the reference line.
    fn point(&self, s: f64, t: f64) -> Vector3<f64> {
        let piece = self.plan.iter().rev().find(|p| p.s <= s).unwrap_or(&self.plan[0]);
        let [x, y, heading] = piece.at(s - piece.s);
        let (sin_h, cos_h) = sin_cos(heading);
        let ((z, slope), bank) = (value(&self.height, s), value(&self.bank, s).0);
        // Across a banked road that climbs: its normal leans back.
        let up = Vector3::new(-slope * cos_h, -slope * sin_h, 1.0).normalize();
        let across = Vector3::new(-sin_h, cos_h, 0.0) * sin_cos(bank).1 + up * sin(bank);
        Vector3::new(x, y, z) + across * t
    }

    /// All painted lines beside lanes for vehicles.
    pub(super) fn lines(&self) -> Vec<Line<'_>> {
        let mut lines = Vec::new();
        for section in &self.sections {
            for lane in &section.lanes {
                let beside = if lane.id == 0 { [-1, 1] } else { [lane.id, lane.id + lane.id.signum()] };
                let mut beside = beside.iter().filter_map(|id| section.lane(*id));
                let drivable = |l: &Lane| l.is_paved() && l.kind != "tram" && l.kind != "rail";
                if !beside.any(drivable) {
                    continue;
                }
                for (k, mark) in lane.marks.iter().enumerate() {
                    let until = lane.marks.get(k + 1).map_or(section.to, |next| section.from + next.s);
                    let span = [section.from + mark.s.max(0.0), until.min(section.to)];
                    let line = |along: f64, t_m: f64| Line {
                        road: self,
                        section,
                        border_of: lane.id,
                        t_m,
                        span: [span[0] + along, span[1]],
                    };
                    match mark.kind.as_str() {
                        "none" | "grass" | "curb" | "edge" => {}
                        _ if !mark.lines.is_empty() => {
                            lines.extend(mark.lines.iter().map(|[s, t]| line(*s, *t)));
                        }
                        double if double.contains(' ') => {
                            lines.extend([mark.width_m, -mark.width_m].map(|t| line(0.0, t)));
                        }
                        _ => lines.push(line(0.0, 0.0)),
                    }
                }
            }
        }
        lines.retain(|line| line.span[1] > line.span[0]);
        lines
    }

    /// Slices of the paved lanes where the reference line is near, a quarter of a metre long, narrower by
    /// `inset_m` on either side.
    pub(super) fn slices(&self, inset_m: f64, is_near: impl Fn(&Vector3<f64>) -> bool) -> Vec<Slice> {
        let mut slices = Vec::new();
        for section in &self.sections {
            let steps = ((section.to - section.from) / 0.25).ceil().max(1.0) as usize;
            let s = |k: usize| section.from + (section.to - section.from) * k as f64 / steps as f64;
            let near: Vec<usize> = (0..steps).filter(|k| is_near(&self.point(s(*k), 0.0))).collect();
            for lane in section.lanes.iter().filter(|lane| lane.id != 0 && lane.is_paved()) {
                let side = lane.id.signum();
                let ends = |k: usize| {
                    let s = s(k);
                    let middle = value(&self.offset, s).0;
                    let inner = section.border(lane.id - side, s) * f64::from(i32::from(lane.id != side));
                    let borders = [inner, section.border(lane.id, s)];
                    let width = (borders[1] - borders[0]).abs();
                    let inset = f64::from(side) * inset_m;
                    (width > 2.0 * inset_m)
                        .then(|| [borders[0] + inset, borders[1] - inset].map(|t| self.point(s, middle + t)))
                };
                for &k in &near {
                    if let (Some([a, b]), Some([c, d])) = (ends(k), ends(k + 1)) {
                        slices.push([a, b, d, c]);
                    }
                }
            }
        }
        slices
    }
}

/// Reads all roads.
pub(super) fn read(text: &str) -> Vec<Road> {
    let file = Document::parse(text).expect("is XML");
    file.root_element().children().filter(|n| n.has_tag_name("road")).map(road).collect()
}

fn all<'a, 'i>(node: Node<'a, 'i>, path: &str) -> Vec<Node<'a, 'i>> {
    let step = |nodes: Vec<Node<'a, 'i>>, name: &str| {
        nodes.iter().flat_map(|n| n.children().filter(|c| c.has_tag_name(name)).collect::<Vec<_>>()).collect()
    };
    path.split('/').fold(vec![node], step)
}

fn number(node: Node, name: &str) -> f64 {
    node.attribute(name).and_then(|text| text.trim().parse().ok()).unwrap_or(0.0)
}

fn cubic(node: Node, s: &str) -> Cubic {
    Cubic { s: number(node, s), abcd: ["a", "b", "c", "d"].map(|name| number(node, name)) }
}

fn road(node: Node) -> Road {
    for other in ["lateralProfile/shape", "lateralProfile/crossfall"] {
        let flat = |n: &Node| ["a", "b", "c", "d"].iter().all(|name| number(*n, name) == 0.0);
        assert!(all(node, other).iter().all(flat), "{other} is not read here");
    }
    let cubics = |path: &str| all(node, path).into_iter().map(|n| cubic(n, "s")).collect::<Vec<_>>();
    let starts: Vec<f64> = all(node, "lanes/laneSection").iter().map(|n| number(*n, "s")).collect();
    let ends = starts.iter().skip(1).copied().chain([number(node, "length")]);
    let sections = all(node, "lanes/laneSection").into_iter().zip(ends).map(|(n, to)| section(n, to));
    let mut road = Road {
        id: node.attribute("id").unwrap_or_default().to_owned(),
        is_junction: node.attribute("junction").is_some_and(|id| id != "-1"),
        plan: all(node, "planView/geometry").into_iter().map(piece).collect(),
        height: cubics("elevationProfile/elevation"),
        bank: cubics("lateralProfile/superelevation"),
        offset: cubics("lanes/laneOffset"),
        sections: sections.collect(),
        crossings: Vec::new(),
    };
    let crossings = all(node, "objects/object");
    let crossings = crossings.into_iter().filter(|n| n.attribute("type") == Some("crosswalk"));
    road.crossings = crossings.map(|n| crossing(&road, n)).collect();
    road
}

fn piece(node: Node) -> Piece {
    let shape = node.children().find(Node::is_element).expect("a geometry has a shape");
    let curve = match shape.tag_name().name() {
        "line" => Curve::Bent([0.0; 2]),
        "arc" => Curve::Bent([number(shape, "curvature"); 2]),
        "spiral" => Curve::Bent(["curvStart", "curvEnd"].map(|name| number(shape, name))),
        "paramPoly3" => {
            let along = |axis: &str| ["a", "b", "c", "d"].map(|name| number(shape, &format!("{name}{axis}")));
            let [ahead, left] = ["U", "V"].map(|axis| Cubic { s: 0.0, abcd: along(axis) });
            Curve::Cubics { ahead, left, by_share: shape.attribute("pRange") != Some("arcLength") }
        }
        other => panic!("a {other} is not read here"),
    };
    let start = ["x", "y", "hdg"].map(|name| number(node, name));
    Piece { s: number(node, "s"), length: number(node, "length"), start, curve }
}

fn section(node: Node, to: f64) -> Section {
    assert!(
        node.attribute("singleSide").is_none_or(|v| v == "false"),
        "one-sided sections are not read here"
    );
    let lanes = ["left/lane", "center/lane", "right/lane"].into_iter().flat_map(|path| all(node, path));
    let lane = |n: Node| {
        assert!(all(n, "border").is_empty(), "lanes by their borders are not read here");
        Lane {
            id: number(n, "id") as i32,
            kind: n.attribute("type").unwrap_or("none").to_owned(),
            widths: all(n, "width").into_iter().map(|w| cubic(w, "sOffset")).collect(),
            marks: all(n, "roadMark").into_iter().map(mark).collect(),
        }
    };
    Section { from: number(node, "s"), to, lanes: lanes.map(lane).collect() }
}

fn mark(node: Node) -> Mark {
    let width = Some(number(node, "width")).filter(|w| *w > 0.0);
    let usual = if node.attribute("weight") == Some("bold") { 0.25 } else { 0.12 };
    let lines = all(node, "type/line").into_iter();
    Mark {
        s: number(node, "sOffset"),
        kind: node.attribute("type").unwrap_or("none").to_owned(),
        width_m: width.unwrap_or(usual),
        lines: lines.map(|n| ["sOffset", "tOffset"].map(|name| number(n, name))).collect(),
    }
}

/// The outline of a crossing in the world.
fn crossing(road: &Road, node: Node) -> Vec<Vector3<f64>> {
    let outlines = [all(node, "outline"), all(node, "outlines/outline")].concat();
    let outline = *outlines.first().expect("a crossing has an outline");
    let (s, t) = (number(node, "s"), number(node, "t"));
    let (foot, beside) = (road.point(s, t), road.point(s, t + 1.0));
    let left = beside - foot;
    let heading = atan2(-left.x, left.y) + number(node, "hdg");
    let (sin, cos) = sin_cos(heading);
    let local = all(outline, "cornerLocal").into_iter().map(|n| {
        let [u, v, z] = ["u", "v", "z"].map(|name| number(n, name));
        foot + Vector3::new(u * cos - v * sin, u * sin + v * cos, z + number(node, "zOffset"))
    });
    let along = all(outline, "cornerRoad")
        .into_iter()
        .map(|n| road.point(number(n, "s"), number(n, "t")) + Vector3::z() * number(n, "dz"));
    let corners: Vec<Vector3<f64>> = local.chain(along).collect();
    assert!(corners.len() >= 3, "a crossing has corners");
    corners
}

/// Whether a slice covers a point: in plan, and within a storey's height.
pub(super) fn covers(slice: &Slice, point: &Vector3<f64>) -> bool {
    let plane = |p: &Vector3<f64>| Point3::new(p.x, p.y, 0.0);
    let at = plane(point);
    let turn = |k: usize| {
        let (a, b) = (plane(&slice[k]), plane(&slice[(k + 1) % 4]));
        (b - a).cross(&(at - a)).z
    };
    let turns = [turn(0), turn(1), turn(2), turn(3)];
    let inside = turns.iter().all(|z| *z >= 0.0) || turns.iter().all(|z| *z <= 0.0);
    inside && (slice[0].z - point.z).abs() < 1.0
}
