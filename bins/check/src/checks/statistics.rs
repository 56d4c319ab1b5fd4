//! The dataset's tables against what was counted here.

use std::path::Path;

use schema::{BevClass, DetectionClass, Tag};

use crate::files::{Table, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;

/// Checks the tables in `stats/` of a store whose scenes were all looked at, frame by frame.
pub(crate) fn check(store: &Path, ledger: &mut Ledger) {
    let shares = ledger.shares.clone();
    let boxes = DetectionClass::ALL.into_iter().zip(shares.boxes);
    let boxes = boxes.map(|(class, [all, valid, _])| (class.name(), vec![("all", all), ("valid", valid)]));
    let cells = BevClass::ALL.into_iter().zip(shares.bev_cells);
    let cells = cells.map(|(class, cells)| (class.name(), vec![("cells", cells)]));
    let voxels = Tag::ALL.into_iter().zip(shares.voxels.into_iter().zip(shares.filled)).skip(1);
    let voxels =
        voxels.map(|(tag, (plain, filled))| (tag.name(), vec![("unfilled", plain), ("filled", filled)]));
    let mut looked = |table: &str, key: &str, wanted: Vec<(&str, Vec<(&str, u64)>)>| {
        let path = store.join(format!("stats/{table}.parquet"));
        let checked = compare(&path, key, &wanted, ledger);
        ledger.read(checked);
    };
    if shares.frames > 0 {
        looked("boxes_per_class", "class", boxes.collect());
    }
    if shares.bev_grids > 0 {
        looked("bev_cells", "class", cells.collect());
    }
    if shares.voxel_grids > 0 {
        looked("voxel_cells", "label", voxels.collect());
    }
}

/// Columns of the rows that a key names; a class that has no row has none of anything.
fn compare(
    path: &Path,
    key: &str,
    wanted: &[(&str, Vec<(&str, u64)>)],
    ledger: &mut Ledger,
) -> Result<(), Unreadable> {
    let table = Table::open(path)?;
    let batches = table.batches()?;
    for (class, columns) in wanted {
        for (column, count) in columns {
            let mut said = 0;
            for rows in &batches {
                let named = rows.texts(key)?.into_iter().zip(rows.ints(column)?);
                said += named.filter(|(name, _)| name == class).map(|(_, n)| n.unsigned_abs()).sum::<u64>();
            }
            ledger.expect(Rule::Statistics, said == *count, || {
                format!("{}: {column} of {class} is {said}, counted {count}", path.display())
            });
        }
    }
    Ok(())
}
