//! Tables over BEV masks and voxel grids.

use schema::{BevClass, Tag, measures};

use super::share::{percent, ratio};
use crate::table::{Section, Table};
use crate::totals::MeasureTotals;

pub(super) fn bev(counts: &MeasureTotals, cells_per_grid: u64) -> Table {
    let known = BevClass::ALL.map(BevClass::name);
    let grids = counts.total(measures::bev::BEV_GRIDS);
    let mut rows: Vec<(&str, u64)> = Vec::new();
    if counts.has(measures::bev::BEV_CELLS) {
        let classes = counts.classes_in_order(&[measures::bev::BEV_CELLS], &known);
        rows.extend(classes.into_iter().map(|class| (class, counts.of(measures::bev::BEV_CELLS, class))));
        rows.push(("total", counts.total(measures::bev::BEV_CELLS)));
    }
    let all_cells = grids.saturating_mul(cells_per_grid);
    let note =
        "A cell with several labels counts for each of them, so the percentages need not add up to 100.";
    Table::new("bev_cells", Section::Bev, "Cells by class", note)
        .with_strings("class", rows.iter().map(|row| row.0))
        .with_counts("cells", rows.iter().map(|row| row.1))
        .with_numbers("mean_per_grid", 2, rows.iter().map(|row| ratio(row.1, grids)))
        .with_numbers("percent_of_grid", 4, rows.iter().map(|row| percent(row.1, all_cells)))
}

/// The rules by which masks were drawn.
pub(super) fn bev_rules(counts: &MeasureTotals) -> Table {
    let rules: Vec<&str> = counts.classes(measures::bev::BEV_GRIDS).filter(|rule| !rule.is_empty()).collect();
    let note = "exact: by the triangles that sensors see; simbev2x: as SimBEV2X draws masks.";
    Table::new("bev_rules", Section::Bev, "Masks by rule", note)
        .with_strings("rule", rules.iter().copied())
        .with_counts("masks", rules.iter().map(|rule| counts.of(measures::bev::BEV_GRIDS, rule)))
}

/// Labels that occur, without free space.
pub(super) fn occupancy(counts: &MeasureTotals) -> Table {
    const FREE: &str = "unlabeled";
    debug_assert_eq!(FREE, Tag::Unlabeled.name());
    let known = Tag::ALL.map(Tag::name);
    let both = [measures::voxels::VOXEL_CELLS, measures::voxels::VOXEL_CELLS_FILLED];
    let grids = counts.total(measures::voxels::VOXEL_GRIDS);
    let mut rows: Vec<(&str, u64, u64)> = counts
        .classes_in_order(&both, &known)
        .into_iter()
        .filter(|class| *class != FREE)
        .map(|class| (class, counts.of(both[0], class), counts.of(both[1], class)))
        .filter(|(_, unfilled, filled)| *unfilled > 0 || *filled > 0)
        .collect();
    if !rows.is_empty() {
        let sum = |of: fn(&(&str, u64, u64)) -> u64| rows.iter().map(of).fold(0, u64::saturating_add);
        let total = ("total", sum(|row| row.1), sum(|row| row.2));
        rows.push(total);
    }
    let all_cells = both.map(|measure| counts.total(measure));
    let note = "Free space is not counted. Filled: the inside of closed objects is labelled too.";
    Table::new("voxel_cells", Section::Occupancy, "Cells by label", note)
        .with_strings("label", rows.iter().map(|row| row.0))
        .with_counts("unfilled", rows.iter().map(|row| row.1))
        .with_counts("filled", rows.iter().map(|row| row.2))
        // Without filled grids there is no ratio, rather than one of 0.
        .with_numbers(
            "filled_by_unfilled",
            3,
            rows.iter().map(|row| if counts.has(both[1]) { ratio(row.2, row.1) } else { None }),
        )
        .with_numbers("mean_per_grid", 1, rows.iter().map(|row| ratio(row.1, grids)))
        .with_numbers(
            "percent_of_grid",
            4,
            rows.iter().map(|row| {
                // A share of the grid needs the free cells counted too.
                let free = counts.of(both[0], FREE);
                if free > 0 { percent(row.1, all_cells[0]) } else { None }
            }),
        )
}
