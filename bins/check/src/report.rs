//! What a person reads.

use std::fmt::Write;

use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::standing::Standing;

/// What no check looks at in any store.
const NEVER: [&str; 9] = [
    "pictures: colours (of RGB images only the size)",
    "boxes 2d: occlusion but for an upper bound",
    "point ids: intensities, cross-sections and signal to noise but for their ranges",
    "voxels: that cells without a return are occupied or free, and which of several objects in a cell is told",
    "bev map: ground that lies over or under other lanes, or beyond such places; lines in junctions",
    "bev heights: ground that is no lane or sidewalk, but where the agent stands",
    "bev paint: parking spaces and arrows, of which the vector map has none",
    "bev hazards: that all of an area is set",
    "units: map records, lamps and weather but for their ranges; tiles, plan and vector map themselves",
];

/// The report on a store.
pub(crate) fn report(heading: &str, ledger: &Ledger, standing: &Standing) -> String {
    let mut text = format!("{heading}\n\n{:16}{:>14}{:>12}  what must hold\n", "check", "looked at", "off");
    for &rule in Rule::ALL {
        let tally = ledger.tally(rule);
        if tally.looked > 0 {
            let _ =
                writeln!(text, "{:16}{:>14}{:>12}  {}", rule.name(), tally.looked, tally.off, rule.says());
        }
    }
    let never: Vec<&str> =
        Rule::ALL.iter().filter(|rule| ledger.tally(**rule).looked == 0).map(|rule| rule.name()).collect();
    let _ = writeln!(text, "\nNot checked");
    for (rule, why) in ledger.unchecked() {
        let _ = writeln!(text, "  {}: {why}", rule.name());
    }
    if !never.is_empty() {
        let _ = writeln!(text, "  nothing at all of: {}", never.join(", "));
    }
    let _ = writeln!(text, "Never checked");
    for what in NEVER {
        let _ = writeln!(text, "  {what}");
    }
    for &rule in Rule::ALL {
        let tally = ledger.tally(rule);
        if tally.off > 0 {
            let _ = writeln!(
                text,
                "\n{}: {} of {} are off, the first of them:",
                rule.name(),
                tally.off,
                tally.looked
            );
            for told in &tally.told {
                let _ = match told.things {
                    1 => writeln!(text, "  {}", told.words),
                    things => writeln!(text, "  {} ({things} in all)", told.words),
                };
            }
        }
    }
    let tables = ledger.shares.tables();
    if !tables.is_empty() {
        let _ = write!(text, "\n{tables}");
    }
    text += &standing.lines();
    let off = Rule::ALL.iter().filter(|rule| ledger.tally(**rule).off > 0).count();
    let _ = match off {
        0 if standing.is_whole() => writeln!(text, "\nNothing is wrong."),
        0 => writeln!(
            text,
            "\nUNFINISHED: what is there is right, but something is not there ({}): `convoy run` makes it.",
            standing.words()
        ),
        off => writeln!(text, "\n{off} checks found something wrong."),
    };
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_never_checked_is_told_under_the_name_of_a_rule() {
        for what in NEVER {
            let rule = what.split(':').next().unwrap_or_default();
            assert!(Rule::ALL.iter().any(|known| known.name() == rule), "{what}");
        }
        let text = report("x", &Ledger::default(), &Standing::default());
        assert!(NEVER.iter().all(|what| text.contains(what)), "{text}");
    }
}
