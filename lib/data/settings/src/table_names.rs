//! Every sensor of a rig fills tables of its own.

use std::collections::BTreeMap;

use crate::reader::Section;

/// Longest name of a sensor: with a prefix and an ending it is a file name on every disk.
const MAX_NAME: usize = 64;

/// The tables of a rig so far, by their names in lower case: some disks take `LIDAR` and `lidar` for one
/// file.
pub(crate) struct TableNames {
    taken: BTreeMap<String, String>,
}

impl TableNames {
    /// With tables whose names no configuration chooses.
    pub(crate) fn new(fixed: impl IntoIterator<Item = String>) -> Self {
        Self { taken: fixed.into_iter().map(|table| (table.to_ascii_lowercase(), table)).collect() }
    }

    /// Gives a sensor its tables. Faults (at the sensor's `name`): no plain name, or a table that another
    /// sensor has.
    pub(crate) fn take(&mut self, sensor: &Section<'_>, name: &str, tables: Vec<String>) {
        let path = sensor.path_of("name");
        let plain = name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-'));
        if !plain || !(1..=MAX_NAME).contains(&name.len()) {
            sensor.fault_at(
                "name",
                format!("`{path}` is \"{name}\", expected 1 to {MAX_NAME} letters, digits, _ and -"),
            );
            return;
        }
        let mut clash = None;
        for table in tables {
            if let Some(other) = self.taken.insert(table.to_ascii_lowercase(), table.clone()) {
                clash = clash.or(Some((table, other)));
            }
        }
        if let Some((table, other)) = clash {
            let message = format!(
                "`{path}` is \"{name}\": its table `{table}` would take the place of another sensor's `{other}`"
            );
            sensor.fault_at("name", message);
        }
    }
}
