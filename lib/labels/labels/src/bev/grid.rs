//! Where the grid lies.

use frames::{Agent, Pose, World, math};
use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use nalgebra::Point3;
use schema::geometry::Snapshot;

/// Grid coordinates: x the column, y the row (both in cells, from the far left corner), z metres above the
/// agent.
#[derive(Debug)]
pub(crate) struct GridFrame {
    half_cells: f64,
    per_m: f64,
    agent_m: [f64; 3],
    sin_cos: (f64, f64),
}

impl GridFrame {
    pub(crate) fn new(cells: usize, cell_m: f64, world_from_agent: &Pose<World, Agent>) -> Self {
        Self {
            half_cells: 0.5 * cells as f64,
            per_m: 1.0 / cell_m,
            agent_m: world_from_agent.xyz(),
            sin_cos: math::sin_cos(world_from_agent.yaw()),
        }
    }

    /// Column and row of a point of the world, cut off towards zero: points up to a cell beyond the first row
    /// or column count as in it.
    pub(crate) fn whole_cell(&self, point: Point3<f64>) -> [i64; 2] {
        let (column, row) = self.column_and_row(point);
        [column as i64, row as i64]
    }

    /// A point of the world.
    pub(crate) fn of_world_point(&self, point: Point3<f64>) -> Vec3 {
        let (column, row) = self.column_and_row(point);
        Vec3::new(column as f32, row as f32, (point.z - self.agent_m[2]) as f32)
    }

    fn column_and_row(&self, point: Point3<f64>) -> (f64, f64) {
        let (sin, cos) = self.sin_cos;
        let (dx, dy) = (point.x - self.agent_m[0], point.y - self.agent_m[1]);
        let (ahead, left) = (cos * dx + sin * dy, cos * dy - sin * dx);
        (self.half_cells - left * self.per_m, self.half_cells - ahead * self.per_m)
    }

    /// From the snapshot's local frame to a grid that turns fully with the agent.
    pub(crate) fn tilted_from_local(
        &self,
        snapshot: &Snapshot,
        world_from_agent: &Pose<World, Agent>,
    ) -> Affine3A {
        let (half, per_m) = (self.half_cells as f32, self.per_m as f32);
        let grid_from_agent = Affine3A {
            matrix3: Mat3A::from_cols(
                Vec3A::new(0.0, -per_m, 0.0),
                Vec3A::new(-per_m, 0.0, 0.0),
                Vec3A::new(0.0, 0.0, 1.0),
            ),
            translation: Vec3A::new(half, half, 0.0),
        };
        grid_from_agent * snapshot.origin.local_from_body(world_from_agent).inverse()
    }

    /// From the snapshot's local frame.
    pub(crate) fn grid_from_local(&self, snapshot: &Snapshot) -> Affine3A {
        let (sin, cos) = self.sin_cos;
        let (sin, cos) = ((sin * self.per_m) as f32, (cos * self.per_m) as f32);
        let origin = snapshot.origin.world_xyz();
        Affine3A {
            matrix3: Mat3A::from_cols(
                Vec3A::new(sin, -cos, 0.0),
                Vec3A::new(-cos, -sin, 0.0),
                Vec3A::new(0.0, 0.0, 1.0),
            ),
            translation: self.of_world_point(Point3::from(origin)).into(),
        }
    }
}
