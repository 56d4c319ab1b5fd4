//! BEV masks.

use serde::Serialize;

use schema::BevClass;

/// How masks are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum BevRule {
    /// By the triangles that sensors see: a cell carries what its centre does.
    #[default]
    Exact,
    /// As SimBEV2X draws them, its rounding, closing and fallback at overpasses included.
    Simbev2x,
}

impl BevRule {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Exact, Self::Simbev2x];

    /// Name in configurations, archives and reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Simbev2x => "simbev2x",
        }
    }
}

/// The BEV grid: square, centred on the agent, row 0 ahead, column 0 left.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BevSettings {
    /// Write BEV masks.
    pub enabled: bool,
    /// Rows and columns (400).
    pub cells: u32,
    /// Cell size, metres (0.4).
    pub cell_m: f64,
    /// How masks are drawn (exactly).
    pub rule: BevRule,
    /// Channels, in their order in the arrays (all 14).
    pub classes: Vec<BevClass>,
    /// With rule `simbev2x`: lanes are sampled every so many metres along their roads (0.4).
    pub lane_step_m: f64,
    /// With rule `simbev2x`: lanes this near to an agent's first place are collected, metres; without it 35 for every second of
    /// the scene and its warm-up.
    pub lane_radius_m: Option<f64>,
    /// With rule `simbev2x`: lanes this near to an agent are drawn, metres; without it 140, or 20 more than to the corner of a
    /// grid of more than 160 m.
    pub near_radius_m: Option<f64>,
    /// With rule `simbev2x`: a sidewalk seen from far above counts, too.
    pub sidewalks_from_above: bool,
    /// Write masks of paint that is no lane marking: stop lines, parking spaces, arrows.
    pub paint: bool,
    /// Write whose each cell is.
    pub ids: bool,
    /// Write how high the ground is.
    pub heights: bool,
    /// Masks are drawn at frames 0, n, 2 n, ... (1).
    pub every_n_frames: u32,
}

impl Default for BevSettings {
    fn default() -> Self {
        Self {
            enabled: true,
            cells: 400,
            cell_m: 0.4,
            rule: BevRule::Exact,
            classes: BevClass::ALL.to_vec(),
            lane_step_m: 0.4,
            lane_radius_m: None,
            near_radius_m: None,
            sidewalks_from_above: false,
            paint: false,
            ids: false,
            heights: false,
            every_n_frames: 1,
        }
    }
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
