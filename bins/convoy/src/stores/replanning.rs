//! What the next run would plan: the planner says it, without writing.

use std::io::Write;
use std::path::Path;

use runner::Graph;

/// How the planner is asked.
#[derive(Debug)]
pub(crate) struct Replanning {
    arguments: Vec<std::ffi::OsString>,
    has_maps: bool,
}

impl Replanning {
    /// For a configuration and a store, with the folder of maps and the place among the editions that a run
    /// would be given.
    pub(crate) fn new(
        config: &Path,
        store: &Path,
        maps: Option<&Path>,
        (grow, edition): (bool, Option<u32>),
    ) -> Self {
        let mut arguments: Vec<std::ffi::OsString> = vec!["--config".into(), config.into()];
        arguments.extend(["--store".into(), store.into()]);
        if let Some(maps) = maps {
            arguments.extend(["--maps".into(), maps.into()]);
        }
        if grow {
            arguments.push("--grow".into());
        }
        if let Some(edition) = edition {
            arguments.extend(["--edition".into(), edition.to_string().into()]);
        }
        arguments.extend(["--dry-run", "--progress", "none"].map(Into::into));
        Self { arguments, has_maps: maps.is_some() }
    }

    /// Whether the planner has to be asked: not where the plan stands, unless a folder of maps is named, in
    /// which something could have changed.
    pub(crate) fn is_wanted(&self, is_planned: bool) -> bool {
        !is_planned || self.has_maps
    }

    /// Lines for people on what would be made again and added, and whether the plan stands. None where the
    /// planner cannot say it: then it has said why.
    pub(crate) fn lines(&self) -> Option<(Vec<String>, bool)> {
        let mut planner = runner::program_beside(Graph::get().planner().name).ok()?;
        let outcome = planner.args(&self.arguments).output().ok()?;
        if !outcome.status.success() {
            // What is only suspicious, a run says.
            let _ = std::io::stderr().write_all(&outcome.stderr);
            return None;
        }
        let said = String::from_utf8_lossy(&outcome.stdout).into_owned();
        let planner = Graph::get().planner().name;
        let anew = format!("would run {planner} (");
        let line = |line: &str| {
            if let Some(why) = line.strip_prefix(&anew).and_then(|rest| rest.strip_suffix(')')) {
                // Without maps the table says so.
                return self.has_maps.then(|| format!("plan {planner}: {why}"));
            }
            if let Some(rest) = line.strip_prefix("would make again ") {
                return Some(format!("the next run makes again {rest}"));
            }
            if let Some(rest) = line.strip_prefix("would add ") {
                return Some(format!("the next run adds {rest}"));
            }
            line.starts_with("changed: ").then(|| line.to_owned())
        };
        let is_kept = !said.lines().any(|line| line.starts_with(&anew));
        Some((said.lines().filter_map(line).collect(), is_kept))
    }
}
