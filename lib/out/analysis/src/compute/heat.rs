//! Where BEV masks show what.

use schema::BevClass;
use schema::measures::bev::{BEV_GRIDS, BEV_HEAT, bin_of_block, heat_block, heat_blocks};

use crate::table::{Section, Table};
use crate::totals::MeasureTotals;

/// One row a block of cells, one column a class: how often its cells carry it, percent. Masks have so many
/// cells along each side, of so many metres.
pub(super) fn bev_heat(counts: &MeasureTotals, cells: usize, cell_m: f64) -> Table {
    let side = if counts.has(BEV_HEAT) { heat_blocks(cells) } else { 0 };
    let mut sizes = vec![0_u64; side];
    if side > 0 {
        (0..cells).for_each(|cell| sizes[heat_block(cell, cells)] += 1);
    }
    // From the first edge to the middle of each block, in cells.
    let middles: Vec<f64> = (0..side)
        .map(|block| sizes[..block].iter().sum::<u64>() as f64 + 0.5 * sizes[block] as f64)
        .collect();
    let from_middle = |block: usize| Some((0.5 * cells as f64 - middles[block]) * cell_m);
    let blocks = || (0..side * side).map(|bin| (bin / side, bin % side));
    let grids = counts.total(BEV_GRIDS);
    let known = BevClass::ALL.map(BevClass::name);
    let note = "Percent of the cells in a block that carry a class, over all masks; the place of a block's middle from the agent.";
    let mut table = Table::new("bev_heat", Section::Bev, "BEV labels by place", note)
        .with_numbers("ahead_m", 2, blocks().map(|(row, _)| from_middle(row)))
        .with_numbers("left_m", 2, blocks().map(|(_, column)| from_middle(column)));
    for class in counts.classes_in_order(&[BEV_HEAT], &known) {
        let mut found = vec![0_u64; side * side];
        for (bin, count) in counts.bins(BEV_HEAT, class) {
            if let Some(place) = usize::try_from(bin).ok().and_then(|bin| found.get_mut(bin)) {
                *place = place.saturating_add(count);
            }
        }
        let share = |(row, column): (usize, usize)| {
            let all = grids.saturating_mul(sizes[row] * sizes[column]);
            (all > 0).then(|| 100.0 * found[bin_of_block(row, column, cells)] as f64 / all as f64)
        };
        table = table.with_numbers(class, 4, blocks().map(share));
    }
    table
}
