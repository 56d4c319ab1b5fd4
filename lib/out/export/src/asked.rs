//! What is asked of an export, and how that differs from what was asked of another one.

use std::collections::{BTreeMap, BTreeSet};

use clap::{ArgAction, Args, Command};
use serde::Serialize;
use serde_json::Value;

use crate::{Layout, Selection};

/// What an option that was not given has.
const NOTHING: &str = "nothing";

/// The options of an export and of its selection.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Asked {
    /// In words that stay the same: part of what makes two exports the same.
    pub(crate) identity: String,
    /// In words for people, by the option's name on the command line.
    pub(crate) by_option: BTreeMap<String, String>,
}

impl Asked {
    pub(crate) fn of(layout: &dyn Layout, selection: &Selection) -> Self {
        let identity = format!("{}; {}; {}", layout.name(), layout.options(), selection.identity());
        let list = |names: &[String]| if names.is_empty() { "all".to_owned() } else { names.join(",") };
        let mut by_option = layout.by_option();
        by_option.insert("--agents".to_owned(), list(&selection.agents));
        by_option.insert("--sensors".to_owned(), list(&selection.sensors));
        by_option.insert("--every".to_owned(), selection.every_n_frames.max(1).to_string());
        Self { identity, by_option }
    }
}

/// What a layout's options have, by their names on the command line.
pub(crate) fn by_option<O: Args + Serialize>(options: &O) -> BTreeMap<String, String> {
    // Options are texts, numbers and lists of them: they can always be written down.
    let values = serde_json::to_value(options).unwrap_or_default();
    let command = O::augment_args(Command::new("export"));
    let of = |argument: &clap::Arg| {
        let is_off = matches!(argument.get_action(), ArgAction::SetFalse);
        let value = values.get(argument.get_id().as_str())?;
        Some((format!("--{}", argument.get_long()?), words(value, is_off)))
    };
    command.get_arguments().filter_map(of).collect()
}

fn words(value: &Value, is_off: bool) -> String {
    match value {
        Value::Null => NOTHING.to_owned(),
        Value::Bool(on) => if *on == is_off { "no" } else { "yes" }.to_owned(),
        Value::Array(all) if all.is_empty() => NOTHING.to_owned(),
        Value::Array(all) => all.iter().map(|one| words(one, false)).collect::<Vec<_>>().join(","),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// How options differ, option by option.
pub(crate) fn changes(old: &BTreeMap<String, String>, new: &BTreeMap<String, String>) -> String {
    let said = |options: &BTreeMap<String, String>, name: &str| {
        options.get(name).cloned().unwrap_or_else(|| NOTHING.to_owned())
    };
    let names: BTreeSet<&String> =
        if old.is_empty() { BTreeSet::new() } else { old.keys().chain(new.keys()).collect() };
    let changed = names.into_iter().filter(|name| old.get(*name) != new.get(*name));
    let changed: Vec<String> =
        changed.map(|name| format!("{name}: {} -> {}", said(old, name), said(new, name))).collect();
    if changed.is_empty() {
        return "an earlier version made it, which did not note them one by one".to_owned();
    }
    changed.join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::usual;
    use crate::mcap::McapOptions;
    use crate::nuscenes::NuScenesOptions;
    use crate::opv2v::Opv2vOptions;

    #[test]
    fn options_are_told_by_their_names_on_the_command_line() {
        let told = by_option(&usual::<NuScenesOptions>());
        let told: Vec<String> = told.iter().map(|(name, value)| format!("{name} {value}")).collect();
        let expected = [
            "--empty-boxes no",
            "--no-lidarseg no",
            "--no-map-mask no",
            "--radius 60.0",
            "--sample-every 10",
            "--sweeps nothing",
            "--version-name nothing",
        ];
        assert_eq!(told, expected);
        let off = NuScenesOptions { lidarseg: false, ..usual() };
        assert_eq!(by_option(&off)["--no-lidarseg"], "yes");
        let names: Vec<String> = by_option(&usual::<Opv2vOptions>()).into_keys().collect();
        assert_eq!(names, ["--all-rsus", "--cameras", "--classes", "--lidar"]);
    }

    #[test]
    fn what_differs_is_told_old_and_new() {
        let old = by_option(&usual::<McapOptions>());
        let new = by_option(&McapOptions { voxel_block: 2, depth: true, ..usual() });
        assert_eq!(changes(&old, &new), "--depth: no -> yes; --voxel-block: 4 -> 2");
        assert!(changes(&BTreeMap::new(), &new).starts_with("an earlier version made it"));
    }
}
