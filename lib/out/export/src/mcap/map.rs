//! The map near a scene's agents, as lines.

use schema::table::Row;
use schema::tables::{AgentRow, VectorKind, VectorMapRow};
use store::{Scope, keys};

use super::messages::{
    Color, KeyValuePair, LinePrimitive, LineType, Point3, Pose, Quaternion, SceneEntity, SceneUpdate,
    Timestamp,
};
use crate::{ExportError, SceneSource};

schema::columns! {
    /// What is drawn of a map.
    MapLine of VectorMapRow {
        kind: String,
        x_m: Vec<f64>,
        y_m: Vec<f64>,
        z_m: Vec<f64>,
        rings: Vec<u32>,
        width_m: Option<f64>,
        mark_color: Option<String>,
    }
}

/// Colour, opacity and width in metres of a kind; none for what is no line.
fn style(kind: VectorKind) -> Option<([u8; 3], f64, f64)> {
    Some(match kind {
        VectorKind::LaneCentreline => ([120, 120, 160], 0.5, 0.05),
        VectorKind::LaneBoundary => ([140, 140, 140], 0.6, 0.05),
        VectorKind::Divider => ([255, 255, 255], 1.0, 0.12),
        VectorKind::Kerb => ([190, 150, 110], 1.0, 0.15),
        VectorKind::Crosswalk => ([240, 196, 196], 1.0, 0.1),
        VectorKind::StopLine => ([240, 80, 80], 1.0, 0.3),
        VectorKind::Sidewalk => ([240, 196, 240], 0.6, 0.05),
        VectorKind::Junction => ([90, 160, 220], 0.5, 0.05),
        // Lights and signs have boxes.
        VectorKind::Signal => return None,
    })
}

/// The map of a scene, as far as the static world is there around its agents: one thing that is drawn for
/// each kind of lines.
///
/// # Errors
/// The map's table cannot be read.
pub(crate) fn lines_near(
    scene: &SceneSource,
    agents: &[Vec<AgentRow>],
    first_frame: u32,
) -> Result<SceneUpdate, ExportError> {
    let store = scene.reader().store();
    let info = scene.info();
    let plan = store.manifest(Scope::Plan, VectorMapRow::STAGE)?;
    let Some(plan) = plan.filter(|plan| plan.output(&keys::vector_map(&info.map)).is_some()) else {
        return Ok(SceneUpdate::default());
    };
    let places = agents.iter().flatten().map(|row| [row.xyz_m[0], row.xyz_m[1]]);
    let near = Rectangle::around(places, info.world_radius_m);
    let kinds: Vec<_> = VectorKind::ALL.iter().filter_map(|kind| Some((*kind, style(*kind)?))).collect();
    let mut lines: Vec<Vec<LinePrimitive>> = vec![Vec::new(); kinds.len()];
    for group in store.row_groups::<MapLine>(&plan, &keys::vector_map(&info.map))? {
        for row in group? {
            let Some(at) = kinds.iter().position(|(kind, _)| kind.name() == row.kind) else { continue };
            let own = Rectangle::around(row.x_m.iter().zip(&row.y_m).map(|(x, y)| [*x, *y]), 0.0);
            if own.meets(&near) {
                lines[at].extend(lines_of(&row, kinds[at].1));
            }
        }
    }
    let entities = kinds.iter().zip(lines).filter(|(_, lines)| !lines.is_empty());
    let entities = entities.map(|((kind, _), lines)| SceneEntity {
        timestamp: Timestamp::at(first_frame),
        frame_id: "world".into(),
        id: kind.name().into(),
        metadata: vec![KeyValuePair::of("map", &info.map)],
        lines,
        ..SceneEntity::default()
    });
    Ok(SceneUpdate { entities: entities.collect(), ..SceneUpdate::default() })
}

/// The lines of an element: one, or one a ring.
fn lines_of(row: &MapLine, (rgb, alpha, width_m): ([u8; 3], f64, f64)) -> Vec<LinePrimitive> {
    let rgb = if row.mark_color.as_deref() == Some("yellow") { [240, 200, 60] } else { rgb };
    let points: Vec<Point3> = row
        .x_m
        .iter()
        .zip(&row.y_m)
        .zip(&row.z_m)
        .map(|((x, y), z)| Point3 { x: *x, y: *y, z: *z })
        .collect();
    let starts: Vec<usize> = row.rings.iter().map(|start| *start as usize).collect();
    let starts = if starts.is_empty() { vec![0] } else { starts };
    let ends = starts.iter().skip(1).copied().chain([points.len()]);
    let rings = starts.iter().zip(ends).filter_map(|(start, end)| points.get(*start..end));
    let line = |ring: &[Point3]| LinePrimitive {
        r#type: LineType::Strip,
        pose: Pose { orientation: Quaternion::from_wxyz([1.0, 0.0, 0.0, 0.0]), ..Pose::default() },
        thickness: row.width_m.filter(|_| row.kind != VectorKind::LaneCentreline.name()).unwrap_or(width_m),
        points: ring.to_vec(),
        color: Color::of(rgb, alpha),
        ..LinePrimitive::default()
    };
    rings.filter(|ring| ring.len() > 1).map(line).collect()
}

/// An upright rectangle.
#[derive(Clone, Copy, Debug)]
struct Rectangle {
    low: [f64; 2],
    high: [f64; 2],
}

impl Rectangle {
    /// Around points, so much larger on each side.
    fn around(points: impl Iterator<Item = [f64; 2]>, margin_m: f64) -> Self {
        let none = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };
        let Self { low, high } = points.fold(none, |found, point| Self {
            low: [found.low[0].min(point[0]), found.low[1].min(point[1])],
            high: [found.high[0].max(point[0]), found.high[1].max(point[1])],
        });
        Self { low: low.map(|v| v - margin_m), high: high.map(|v| v + margin_m) }
    }

    fn meets(&self, other: &Self) -> bool {
        (0..2).all(|axis| self.low[axis] <= other.high[axis] && other.low[axis] <= self.high[axis])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_are_lines_of_their_own() {
        let row = MapLine {
            kind: "crosswalk".into(),
            x_m: vec![0.0, 1.0, 0.0, 5.0, 6.0, 5.0],
            y_m: vec![0.0; 6],
            z_m: vec![2.0; 6],
            rings: vec![0, 3],
            width_m: None,
            mark_color: Some("yellow".into()),
        };
        let lines = lines_of(&row, style(VectorKind::Crosswalk).expect("is drawn"));
        assert_eq!(lines.len(), 2);
        assert_eq!(lines[1].points[0], Point3 { x: 5.0, y: 0.0, z: 2.0 });
        assert_eq!((lines[0].color.clone(), lines[0].thickness), (Color::of([240, 200, 60], 1.0), 0.1));
        let line = MapLine { rings: Vec::new(), width_m: Some(0.3), ..row };
        let lines = lines_of(&line, style(VectorKind::Divider).expect("is drawn"));
        assert_eq!((lines.len(), lines[0].points.len(), lines[0].thickness), (1, 6, 0.3));
    }

    #[test]
    fn what_crosses_the_surroundings_belongs_to_them() {
        let near = Rectangle::around([[0.0, 0.0], [10.0, 0.0]].into_iter(), 5.0);
        let across = Rectangle::around([[-100.0, 1.0], [100.0, 1.0]].into_iter(), 0.0);
        assert!(across.meets(&near));
        assert!(!Rectangle::around([[0.0, 6.0]].into_iter(), 0.0).meets(&near));
        assert!(!Rectangle::around(std::iter::empty(), 0.0).meets(&near));
    }
}
