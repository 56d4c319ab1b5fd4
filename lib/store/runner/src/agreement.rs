//! Whether finished work may be made again: it is said, and asked about where it is much.

use crate::error::StageError;
use crate::foresight::{Blame, Foresight};
use crate::question::confirmed;

/// On which terms finished work is made again.
pub(crate) struct Terms<'a> {
    /// Whether a stage's work is made again by this run; else it only becomes stale.
    pub(crate) makes: &'a dyn Fn(&str) -> bool,
    /// From so much estimated work on it is asked about, seconds of one core.
    pub(crate) ask_beyond_s: f64,
    /// Into how many shares the scenes are cut. Shares of one store are one wish: each stands for all.
    pub(crate) shares: u32,
    /// What is asked about at least.
    pub(crate) least: Blame,
    /// Whether it was agreed beforehand.
    pub(crate) redo: bool,
    /// Whether somebody may sit before it.
    pub(crate) may_ask: bool,
}

/// Says what would be made again; whether there is any.
///
/// # Errors
/// It is much, and nobody agreed to it; or a signal came.
pub(crate) fn agree(foresight: &Foresight, terms: &Terms<'_>) -> Result<bool, StageError> {
    let told = foresight.lines();
    if told.is_empty() {
        return Ok(false);
    }
    let verb = |stage: &str| if (terms.makes)(stage) { "makes again" } else { "makes stale" };
    let lines = told.into_iter().map(|(stage, line)| format!("{} {line}", verb(stage)));
    let added = foresight.added().map(|scenes| format!("adds {scenes}"));
    let lines: Vec<String> = lines.chain(added).chain(foresight.changed()).collect();
    let of_all = |share_s: f64| share_s * f64::from(terms.shares);
    let is_much = foresight.blamed_s(terms.least).is_some_and(|s| of_all(s) >= terms.ask_beyond_s);
    if terms.redo || !is_much || (terms.may_ask && confirmed(&lines)?) {
        lines.iter().for_each(|line| tracing::info!("{line}"));
        return Ok(true);
    }
    let mut ways = vec!["--redo makes it again"];
    if foresight.blames(Blame::Code) {
        ways.push("--accept-code keeps what older code made");
    }
    if foresight.blames(Blame::Configuration) {
        ways.push("--grow leaves it, and makes further scenes alone by this configuration");
    }
    Err(StageError::usage(format!(
        "nothing was touched, as this\n  {}\n{}; another --store keeps what is there, too (asked beyond \
         store.ask_beyond_s = {} s)",
        lines.join("\n  "),
        ways.join("; "),
        terms.ask_beyond_s
    )))
}
