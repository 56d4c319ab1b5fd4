//! What a person reads.

use std::fmt::Write;

use crate::ledger::Ledger;
use crate::rules::Rule;

/// The report on a store.
pub(crate) fn report(heading: &str, ledger: &Ledger) -> String {
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
    if !never.is_empty() || ledger.unchecked().next().is_some() {
        let _ = writeln!(text, "\nNot checked");
        for (rule, why) in ledger.unchecked() {
            let _ = writeln!(text, "  {}: {why}", rule.name());
        }
        if !never.is_empty() {
            let _ = writeln!(text, "  nothing at all of: {}", never.join(", "));
        }
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
    let off = Rule::ALL.iter().filter(|rule| ledger.tally(**rule).off > 0).count();
    let _ = match off {
        0 => writeln!(text, "\nNothing is wrong."),
        off => writeln!(text, "\n{off} checks found something wrong."),
    };
    text
}
