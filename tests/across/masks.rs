//! Bird's-eye-view masks against polygons, by the angle that a polygon turns about a cell's centre.

use frames::{Agent, Pose, World};
use nalgebra::Point2;
use schema::BevClass;
use schema::tables::AgentRow;

/// Nearer to an edge than this, rounding decides on which side a cell's centre lies, metres.
const EDGE_M: f64 = 0.002;

/// Signed turn of a polygon about a point, in full turns: not 0 inside.
fn turns(polygon: &[Point2<f64>], at: Point2<f64>) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    let angle = |(a, b): (&Point2<f64>, &Point2<f64>)| {
        let (a, b) = (a - at, b - at);
        frames::math::atan2(a.perp(&b), a.dot(&b))
    };
    polygon.iter().zip(next).map(angle).sum::<f64>() / std::f64::consts::TAU
}

/// Distance of a point from a polygon's outline.
fn edge_m(polygon: &[Point2<f64>], at: Point2<f64>) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    let away = |(a, b): (&Point2<f64>, &Point2<f64>)| {
        let (along, to) = (b - a, at - a);
        let share = (to.dot(&along) / along.norm_squared().max(1e-12)).clamp(0.0, 1.0);
        (to - along * share).norm()
    };
    polygon.iter().zip(next).map(away).fold(f64::INFINITY, f64::min)
}

/// Compares a mask's channel with the union of polygons in the world, cell by cell, and says how many cells
/// carry it. Masks have 400 x 400 cells of 0.4 m.
pub(crate) fn mask_is_the_polygons(
    polygons: &[&[[f64; 3]]],
    class: BevClass,
    agent: &AgentRow,
    mask: &[u8],
) -> usize {
    const CELLS: usize = 400;
    const CELL_M: f64 = 0.4;
    let pose = Pose::<World, Agent>::from_xyz_wxyz(agent.xyz_m, agent.quaternion);
    let (sin, cos) = frames::math::sin_cos(pose.yaw());
    // Polygons in the grid: columns and rows as real numbers.
    let polygons: Vec<Vec<Point2<f64>>> = polygons
        .iter()
        .map(|polygon| {
            let corner = |p: &[f64; 3]| {
                let (dx, dy) = (p[0] - agent.xyz_m[0], p[1] - agent.xyz_m[1]);
                let (ahead, left) = (dx * cos + dy * sin, dy * cos - dx * sin);
                Point2::new(0.5 * CELLS as f64 - left / CELL_M, 0.5 * CELLS as f64 - ahead / CELL_M)
            };
            polygon.iter().map(corner).collect()
        })
        .collect();
    // Nothing is near a polygon outside its bounds and one cell more.
    let span = |p: &[Point2<f64>], k: usize| {
        let values = || p.iter().map(move |c| c[k]);
        values().fold(f64::INFINITY, f64::min) - 1.0..values().fold(f64::NEG_INFINITY, f64::max) + 1.0
    };
    let bounds: Vec<_> = polygons.iter().map(|p| [span(p, 0), span(p, 1)]).collect();
    let channel = &mask[class as usize * CELLS * CELLS..][..CELLS * CELLS];
    let mut carried = 0;
    for (i, got) in channel.iter().enumerate() {
        let at = Point2::new((i % CELLS) as f64 + 0.5, (i / CELLS) as f64 + 0.5);
        let near: Vec<&Vec<Point2<f64>>> = polygons
            .iter()
            .zip(&bounds)
            .filter(|(_, [columns, rows])| columns.contains(&at.x) && rows.contains(&at.y))
            .map(|(p, _)| p)
            .collect();
        if near.iter().any(|p| edge_m(p, at) < EDGE_M / CELL_M) {
            continue;
        }
        let inside = near.iter().any(|p| turns(p, at).abs() > 0.5);
        assert_eq!(*got != 0, inside, "{} frame {}: cell {at}", agent.agent, agent.frame);
        carried += usize::from(inside);
    }
    carried
}
