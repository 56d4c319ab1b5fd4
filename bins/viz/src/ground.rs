//! The map of a scene as lines.

use export_core::SceneSource;
use nalgebra::Point3;
use pictures::{GroundLine, GroundStyle};
use schema::table::Row;
use schema::tables::VectorMapRow;
use store::{Scope, keys};

use crate::error::VizError;

schema::columns! {
    /// What of a map's elements is drawn.
    Element of VectorMapRow {
        kind: String,
        x_m: Vec<f64>,
        y_m: Vec<f64>,
        z_m: Vec<f64>,
        rings: Vec<u32>,
        is_edge: bool,
    }
}

/// The elements of a scene's map that are drawn; none where the store has no vector map.
pub(crate) fn ground_of(source: &SceneSource) -> Result<Vec<GroundLine>, VizError> {
    let store = source.reader().store();
    let Some(plan) = store.manifest(Scope::Plan, VectorMapRow::STAGE)? else { return Ok(Vec::new()) };
    let key = keys::vector_map(&source.info().map);
    if plan.output(&key).is_none() {
        return Ok(Vec::new());
    }
    let elements: Vec<Element> = store.read_rows(&plan, &key)?;
    Ok(elements.iter().filter_map(line_of).collect())
}

fn line_of(element: &Element) -> Option<GroundLine> {
    let style = match element.kind.as_str() {
        "junction" => GroundStyle::Junction,
        "sidewalk" => GroundStyle::Sidewalk,
        "crosswalk" => GroundStyle::Crosswalk,
        "lane_boundary" if element.is_edge => GroundStyle::Edge,
        "lane_boundary" => GroundStyle::LaneBorder,
        "divider" => GroundStyle::Paint,
        "stop_line" => GroundStyle::StopLine,
        _ => return None,
    };
    let places = element.x_m.iter().zip(&element.y_m).zip(&element.z_m);
    let points: Vec<Point3<f64>> = places.map(|((&x, &y), &z)| Point3::new(x, y, z)).collect();
    let mut starts: Vec<usize> = element.rings.iter().map(|&start| start as usize).collect();
    if starts.is_empty() {
        starts.push(0);
    }
    starts.push(points.len());
    let chains_m = starts.windows(2).filter_map(|pair| points.get(pair[0]..pair[1])).map(<[_]>::to_vec);
    Some(GroundLine { style, chains_m: chains_m.collect() })
}
