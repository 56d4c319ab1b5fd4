//! Masks' ground and the arrays beside masks, against the vector map.

use schema::BevClass;

use super::mask::Mask;
use super::raster::{Cover, Sums};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::space::{Motion, V3};
use crate::vector_map::{Line, Shape, VectorMap};

/// Gaps and islands in junctions are paved up to some size: road cells lie this near to a lane or a junction,
/// m.
const PAVED_M: f64 = 7.0;
/// Corners between sidewalks are closed, and forecourts up to the houses are paved: cells of sidewalks lie
/// this near to one, m.
const FORECOURT_M: f64 = 9.0;
/// Sidewalks are not judged this near to where lanes of others run over them, m.
const CROSSED_M: f64 = 8.0;
/// Where heights of the map in a cell and its neighbours differ by more, decks may lie above one another, m.
const LEVEL_M: f64 = 0.8;
/// From the agent the map's ground is followed by steps between cells of at most this height, m...
const STEP_M: f64 = 0.5;
/// ...beginning with what is this near to it, across and up, m.
const START_M: f64 = 3.0;
/// The shown ground is at most this far below the map's and above it, where kerbs are raised and lanes lie on
/// others, m.
pub(super) const HEIGHT_M: [f64; 2] = [0.3, 0.5];

/// The map about an agent, in the cells of its mask.
pub(super) struct Mapped {
    /// Lanes and sidewalks together.
    pub(super) ground: Cover,
    /// Cells that the agent's own level leads to over it.
    pub(super) own_level: Vec<bool>,
    road: Sums,
    paved: Sums,
    sidewalk: Sums,
    /// Cells of both roads and sidewalks.
    contested: Sums,
    crosswalk: Sums,
    dividers: Cover,
    /// Dividers that are surely painted.
    certain: Cover,
    stop_lines: Cover,
}

impl Mapped {
    pub(super) fn of(map: &VectorMap, mask: &Mask, agent: &Motion) -> Self {
        let cells = mask.cells;
        let margin = (PAVED_M.max(FORECOURT_M) / mask.cell_m).ceil() as usize + 2;
        let place = |p: &V3| {
            let [row, column] = mask.place(p[0], p[1]);
            [row, column, p[2] - agent.origin[2]]
        };
        let reach = std::f64::consts::SQRT_2 * (0.5 * cells as f64 + margin as f64) * mask.cell_m;
        let is_near = |[low, high]: &[[f64; 2]; 2]| {
            (0..2).all(|i| low[i] <= agent.origin[i] + reach && high[i] >= agent.origin[i] - reach)
        };
        let draw = |shapes: &[Shape], into: &mut Cover| {
            for shape in shapes.iter().filter(|shape| is_near(&shape.bounds)) {
                let rings = shape.rings.iter().map(|ring| ring.iter().map(place).collect());
                into.fill(&rings.collect::<Vec<_>>());
            }
        };
        let lines = |lines: &[Line], certain: bool| {
            let mut cover = Cover::new(cells, margin);
            for line in lines.iter().filter(|l| is_near(&l.bounds) && (l.is_certain || !certain)) {
                cover.draw(&line.points.iter().map(place).collect::<Vec<_>>());
            }
            cover
        };
        let empty = || Cover::new(cells, margin);
        let (mut road, mut sidewalk, mut crosswalk) = (empty(), empty(), empty());
        draw(&map.lanes, &mut road);
        draw(&map.walks, &mut sidewalk);
        draw(&map.sidewalks, &mut sidewalk);
        draw(&map.crosswalks, &mut crosswalk);
        let mut paved = road.clone();
        draw(&map.junctions, &mut paved);
        // Areas have no heights of their own within.
        let mut ground = road.clone();
        draw(&map.walks, &mut ground);
        let near = (0..ground.covered.len()).filter(|&cell| {
            let middle = 0.5 * (ground.side as f64 - 1.0);
            let way = [cell / ground.side, cell % ground.side].map(|at| (at as f64 - middle) * mask.cell_m);
            way.iter().all(|way| way.abs() <= START_M) && ground.low[cell].abs() <= START_M
        });
        let own_level = ground.reached(&near.collect::<Vec<_>>(), STEP_M);
        Self {
            own_level,
            road: road.sums(),
            paved: paved.sums(),
            contested: Sums::of(
                road.side,
                &road.covered.iter().zip(&sidewalk.covered).map(|(a, b)| *a && *b).collect::<Vec<_>>(),
            ),
            sidewalk: sidewalk.sums(),
            crosswalk: crosswalk.sums(),
            dividers: lines(&map.dividers, false),
            certain: lines(&map.dividers, true),
            stop_lines: lines(&map.stop_lines, false),
            ground,
        }
    }

    /// The mask's cells whose ground the map knows to be on the agent's level, with their numbers here.
    pub(super) fn known<'a>(&'a self, mask: &'a Mask) -> impl Iterator<Item = (usize, usize)> + 'a {
        self.cells(mask).filter(|&(_, here)| self.own_level[here] && self.ground.is_level(here, LEVEL_M))
    }

    /// Numbers of the mask's cells, in it and here.
    fn cells<'a>(&'a self, mask: &'a Mask) -> impl Iterator<Item = (usize, usize)> + 'a {
        let cells = mask.cells;
        (0..cells * cells).map(move |cell| (cell, self.ground.cell(cell / cells, cell % cells)))
    }

    /// Cells amid lanes, sidewalks and crosswalks and on lines are set; those far from all are not.
    pub(super) fn check(&self, mask: &Mask, frame: usize, ledger: &mut Ledger) {
        let reach_of = |way_m: f64| (way_m / mask.cell_m).ceil() as usize;
        let [road, sidewalk, crosswalk, line] =
            [BevClass::Road, BevClass::Sidewalk, BevClass::Crosswalk, BevClass::RoadLine]
                .map(|c| mask.channel(c));
        let dividers = self.dividers.sums();
        let lines_set = mask_sums(mask, line);
        let cells = mask.cells;
        for (class, set, sums) in [
            ("road", road, &self.road),
            ("sidewalk", sidewalk, &self.sidewalk),
            ("crosswalk", crosswalk, &self.crosswalk),
        ] {
            let amid = self.known(mask).filter(|&(cell, here)| {
                sums.all(here, 1)
                    && match class {
                        // Pieces of sidewalks that others drive over are left out.
                        "sidewalk" => !self.contested.any(here, reach_of(CROSSED_M)),
                        // A crosswalk is shown where there is road.
                        "crosswalk" => road[cell] == 1,
                        _ => true,
                    }
            });
            // Where triangles of two roads meet, a cell's middle may fall between them.
            let shown = mask_sums(mask, set);
            let holds = |cell: usize| set[cell] == 1 || shown.is_lone_gap(cell);
            tell(Rule::BevMapped, amid.map(|(cell, _)| (cell, holds(cell))), ledger, |cell| {
                format!(
                    "frame {frame}: the cell {:?} amid a {class} of the map is not set",
                    [cell / cells, cell % cells]
                )
            });
        }
        let painted =
            self.known(mask).filter(|&(cell, here)| self.certain.covered[here] && mask.is_inner(cell));
        tell(Rule::BevMapped, painted.map(|(cell, _)| (cell, lines_set.any(cell, 1))), ledger, |cell| {
            format!(
                "frame {frame}: there is no line about {:?}, where the map has one",
                [cell / cells, cell % cells]
            )
        });
        for (class, set, sums, reach) in [
            ("road", road, &self.paved, reach_of(PAVED_M)),
            ("sidewalk", sidewalk, &self.sidewalk, reach_of(FORECOURT_M)),
            ("crosswalk", crosswalk, &self.crosswalk, 1),
            ("road_line", line, &dividers, 1),
        ] {
            let shown = self.cells(mask).filter(|&(cell, _)| set[cell] == 1);
            tell(Rule::BevStray, shown.map(|(cell, here)| (cell, sums.any(here, reach))), ledger, |cell| {
                format!(
                    "frame {frame}: the {class} cell {:?} is far from any of the map",
                    [cell / cells, cell % cells]
                )
            });
        }
    }

    /// Stop lines of the paint beside a mask.
    pub(super) fn check_stop_lines(&self, mask: &Mask, set: &[u8], frame: usize, ledger: &mut Ledger) {
        let (cells, of_map, of_paint) = (mask.cells, self.stop_lines.sums(), mask_sums(mask, set));
        let painted =
            self.known(mask).filter(|&(cell, here)| self.stop_lines.covered[here] && mask.is_inner(cell));
        tell(Rule::BevPaint, painted.map(|(cell, _)| (cell, of_paint.any(cell, 1))), ledger, |cell| {
            format!(
                "frame {frame}: there is no stop line about {:?}, where the map has one",
                [cell / cells, cell % cells]
            )
        });
        let shown = self.cells(mask).filter(|&(cell, _)| set[cell] == 1);
        tell(Rule::BevPaint, shown.map(|(cell, here)| (cell, of_map.any(here, 1))), ledger, |cell| {
            format!(
                "frame {frame}: the stop line's cell {:?} is far from any of the map",
                [cell / cells, cell % cells]
            )
        });
    }
}

fn mask_sums(mask: &Mask, set: &[u8]) -> Sums {
    Sums::of(mask.cells, &set.iter().map(|&bit| bit == 1).collect::<Vec<_>>())
}

/// Counts the cells that hold, and tells the first of the others.
pub(super) fn tell(
    rule: Rule,
    cells: impl Iterator<Item = (usize, bool)>,
    ledger: &mut Ledger,
    words: impl FnOnce(usize) -> String,
) {
    let (mut fine, mut off, mut first) = (0, 0, None);
    for (cell, holds) in cells {
        if holds {
            fine += 1;
        } else {
            off += 1;
            first = first.or(Some(cell));
        }
    }
    ledger.fine(rule, fine);
    ledger.all_off(rule, off, "", || format!("{} ({off} such cells)", words(first.unwrap_or(0))));
}
