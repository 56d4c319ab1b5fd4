//! Vertical lines through the centres of cells, and all that they meet, in f64.

use frames::{Agent, Pose, World};
use nalgebra::{Point2, Point3};
use schema::geometry::Snapshot;
use schema::{ObjectId, Tag};

/// Nearer to an edge than this, rounding decides on which side a cell's centre lies, cells.
pub(crate) const EDGE: f64 = 2e-3;

/// A grid about an agent.
#[derive(Clone, Copy)]
pub(crate) struct Grid {
    pub(crate) cells: usize,
    pub(crate) cell_m: f64,
    pub(crate) pose: Pose<World, Agent>,
}

impl Grid {
    /// Column and row (real numbers) and height above the agent of a place of the world, by its yaw alone.
    pub(crate) fn level(&self, p: Point3<f64>) -> Point3<f64> {
        let [x, y, z] = self.pose.xyz();
        let (sin, cos) = frames::math::sin_cos(self.pose.yaw());
        let (dx, dy) = (p.x - x, p.y - y);
        let half = 0.5 * self.cells as f64;
        let (ahead, left) = (cos * dx + sin * dy, cos * dy - sin * dx);
        Point3::new(half - left / self.cell_m, half - ahead / self.cell_m, p.z - z)
    }
}

/// A triangle in the grid.
pub(crate) struct Piece {
    pub(crate) object: ObjectId,
    pub(crate) tag: Tag,
    pub(crate) corners: [Point3<f64>; 3],
}

/// All triangles of a snapshot, by a map of the world to the grid.
pub(crate) fn pieces(snapshot: &Snapshot, to_grid: impl Fn(Point3<f64>) -> Point3<f64>) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for instance in &snapshot.instances {
        let mesh = snapshot.mesh(instance);
        for t in 0..mesh.triangles.len() {
            let corners = mesh.corners(t).map(|c| {
                let world = snapshot.origin.world_from_local(instance.local_from_object.transform_point3(c));
                to_grid(Point3::from(world))
            });
            pieces.push(Piece { object: instance.object, tag: mesh.part(t).tag, corners });
        }
    }
    pieces
}

/// Where a vertical line meets a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    pub(crate) object: ObjectId,
    pub(crate) tag: Tag,
    pub(crate) z: f64,
    /// Lowest and highest corner of the triangle.
    pub(crate) range: [f64; 2],
    /// Whether rounding may decide whether it is met.
    pub(crate) near_edge: bool,
}

/// All that the vertical lines through the centres of the cells meet, cell by cell.
pub(crate) fn cast(pieces: &[Piece], cells: usize) -> Vec<Vec<Hit>> {
    let mut hits = vec![Vec::new(); cells * cells];
    for piece in pieces {
        let [a, b, c] = piece.corners;
        let low = |k: usize| a[k].min(b[k]).min(c[k]);
        let high = |k: usize| a[k].max(b[k]).max(c[k]);
        let around = |k: usize| {
            let first = (low(k) - 1.0).floor().max(0.0) as usize;
            first..((high(k) + 1.0).ceil().clamp(0.0, cells as f64) as usize).max(first)
        };
        for row in around(1) {
            for column in around(0) {
                let at = Point2::new(column as f64 + 0.5, row as f64 + 0.5);
                let (inside, edge) = inside([a.xy(), b.xy(), c.xy()], at);
                if inside || edge < EDGE {
                    let z = height(piece.corners, at).clamp(low(2), high(2));
                    hits[row * cells + column].push(Hit {
                        object: piece.object,
                        tag: piece.tag,
                        z,
                        range: [low(2), high(2)],
                        near_edge: edge < EDGE,
                    });
                }
            }
        }
    }
    hits
}

/// Whether a point is in a triangle, by the angles under which it sees the edges; and its distance from the
/// nearest edge.
fn inside(corners: [Point2<f64>; 3], at: Point2<f64>) -> (bool, f64) {
    let (mut turn, mut nearest) = (0.0, f64::INFINITY);
    for e in 0..3 {
        let (a, b) = (corners[e] - at, corners[(e + 1) % 3] - at);
        turn += frames::math::atan2(a.perp(&b), a.dot(&b));
        let along = b - a;
        let share = (-a.dot(&along) / along.norm_squared().max(1e-30)).clamp(0.0, 1.0);
        nearest = nearest.min((a + along * share).norm());
    }
    (turn.abs() > std::f64::consts::PI, nearest)
}

/// Height of a triangle's plane over a point of the plan; its top where it stands upright.
fn height([a, b, c]: [Point3<f64>; 3], at: Point2<f64>) -> f64 {
    let normal = (b - a).cross(&(c - a));
    if normal.z.abs() < 1e-12 {
        return a.z.max(b.z).max(c.z);
    }
    a.z - (normal.x * (at.x - a.x) + normal.y * (at.y - a.y)) / normal.z
}
