//! BEV masks.

use schema::BevClass;
use serde::Serialize;

use crate::key::{Name, choice, settings};
use crate::reader::Section;

choice! {
    /// How masks are drawn.
    pub enum BevRule {
        /// By the triangles that sensors see: a cell carries what its centre does.
        #[default]
        Exact = "exact",
        /// As SimBEV2X draws them, its rounding, closing and fallback at overpasses included.
        Simbev2x = "simbev2x",
    }
}

settings! {
    /// The BEV grid: square, centred on the agent, row 0 ahead, column 0 left.
    pub struct BevSettings {
        /// Write BEV masks.
        enabled: bool = true;
        /// Rows and columns of the grid.
        cells: u32 = 400, within(2..=4096), yaml("bev_dim");
        /// Cell size, m.
        cell_m: f64 = 0.4, within(0.01..=10.0), yaml("bev_res");
        /// `exact`: by the triangles that sensors see; `simbev2x`: as SimBEV2X draws masks.
        rule: BevRule = BevRule::Exact, choice();
        /// Channels of the masks, in their order.
        classes: Vec<BevClass> = BevClass::ALL.to_vec(), by(classes);
        /// With rule `simbev2x`: lanes are sampled at this distance along their roads, m.
        lane_step_m: f64 = 0.4, within(0.05..=10.0), yaml("waypoint_distance");
        /// With rule `simbev2x`: lanes this near to an agent's first place are collected, m.
        lane_radius_m: Option<f64> = None, within(1.0..=100_000.0),
            or("35 m for every second of the scene and its warm-up");
        /// With rule `simbev2x`: lanes this near to an agent are drawn, m.
        near_radius_m: Option<f64> = None, within(1.0..=100_000.0),
            or("140 m; for grids above 160 m 20 m more than to a corner"), yaml("nearby_mapping_area_radius");
        /// With rule `simbev2x`: a sidewalk seen from far above counts, too.
        sidewalks_from_above: bool = false, yaml("use_bev_for_sidewalks");
        /// Write masks of stop lines, parking spaces, arrows and words.
        paint: bool = false;
        /// Write the id of the object over each cell.
        ids: bool = false;
        /// Write the height of the ground in each cell.
        heights: bool = false;
        /// Masks are drawn at frames 0, n, 2 n, ...
        every_n_frames: u32 = 1, within(1..=1000);
    }
}

fn classes(section: &Section<'_>, name: &Name, default: Vec<BevClass>) -> Vec<BevClass> {
    let key = name.key;
    let all = BevClass::ALL.map(|class| class.name());
    let usual: Vec<String> = default.iter().map(|class| class.name().to_owned()).collect();
    let names = section.texts(key, &usual, name.doc);
    let mut classes = Vec::new();
    let path = section.path_of(key);
    for name in &names {
        match BevClass::from_name(name) {
            Some(class) if classes.contains(&class) => {
                section.fault_at(key, format!("`{path}` names `{name}` twice"));
            }
            Some(class) => classes.push(class),
            None => {
                let problem = format!("`{path}`: `{name}` is no class, expected some of {}", all.join(", "));
                section.fault_at(key, problem);
            }
        }
    }
    if names.is_empty() {
        section.fault_at(key, format!("`{path}` is empty: `bev.enabled = false` writes no masks"));
    }
    classes
}

impl BevSettings {
    /// What archives of masks say of themselves: a JSON object with rule, channels, grid and rate.
    ///
    /// # Errors
    /// It cannot be written as JSON, which is a bug.
    pub fn describe(&self) -> serde_json::Result<String> {
        #[derive(Serialize)]
        struct Description<'a> {
            rule: BevRule,
            classes: &'a [BevClass],
            cells: u32,
            cell_m: f64,
            every_n_frames: u32,
        }
        let Self { rule, cells, cell_m, every_n_frames, .. } = *self;
        serde_json::to_string(&Description { rule, classes: &self.classes, cells, cell_m, every_n_frames })
    }

    /// Half the grid's side, metres.
    #[must_use]
    pub fn half_extent_m(&self) -> f64 {
        0.5 * f64::from(self.cells) * self.cell_m
    }

    /// The ground beyond a mask counts this far where decks lie above one another, metres.
    pub const BEYOND_M: f64 = 60.0;

    /// How far from the agent the world counts for masks, across, metres.
    #[must_use]
    pub fn reach_m(&self) -> f64 {
        (self.half_extent_m() + Self::BEYOND_M) * std::f64::consts::SQRT_2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn archives_say_what_they_are() {
        let settings = BevSettings {
            rule: BevRule::Simbev2x,
            classes: vec![BevClass::RoadLine, BevClass::Car],
            ..BevSettings::default()
        };
        let said = settings.describe().expect("is JSON");
        assert_eq!(
            said,
            r#"{"rule":"simbev2x","classes":["road_line","car"],"cells":400,"cell_m":0.4,"every_n_frames":1}"#
        );
    }
}
