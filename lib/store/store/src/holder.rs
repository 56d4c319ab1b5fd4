//! Who holds a store.

use std::fmt;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use crate::process;

/// A process that works on a store, as other processes and people are told of it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Holder {
    /// What is done, for people.
    pub work: String,
    /// The user.
    pub owner: String,
    /// The machine.
    pub host: String,
    /// Number of the process.
    pub process: u32,
    /// When it began, by the clock of that machine, UTC. For people: no two clocks are compared.
    pub since: String,
    /// In what the process's number is unique; none where that machine does not tell.
    pub(crate) machine: Option<String>,
    /// When the process was started, in ticks of that machine.
    pub(crate) started: Option<u64>,
}

impl Holder {
    /// This process.
    pub(crate) fn this(work: &str) -> Self {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
        let process = std::process::id();
        Self {
            work: work.to_owned(),
            owner: owner(),
            host: process::host(),
            process,
            since: utc(now),
            machine: process::machine(),
            started: process::started(process),
        }
    }

    /// Whether the process still does anything; none where that cannot be told from here.
    pub(crate) fn is_running(&self) -> Option<bool> {
        if self.machine.is_none() || self.machine != process::machine() {
            return None;
        }
        Some(process::started(self.process).is_some_and(|started| Some(started) == self.started))
    }
}

impl fmt::Display for Holder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { work, owner, host, process, since, .. } = self;
        write!(f, "{owner} on {host}, process {process}, since {since} ({work})")
    }
}

/// The user's name, or number.
fn owner() -> String {
    let named = ["USER", "LOGNAME"].iter().find_map(|name| std::env::var(name).ok());
    named.filter(|name| !name.is_empty()).unwrap_or_else(|| {
        use std::os::unix::fs::MetadataExt;
        std::fs::metadata("/proc/self")
            .map_or_else(|_| "somebody".to_owned(), |about| format!("user {}", about.uid()))
    })
}

/// Seconds since 1970 as a date and a time. Days are counted from March of year 0 in eras of 400 years, so
/// that the day that leap years have more is the last one of a year.
fn utc(seconds: u64) -> String {
    let (days, of_day) = (seconds / 86400 + 719_468, seconds % 86400);
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    let (hour, minute, second) = (of_day / 3600, of_day / 60 % 60, of_day % 60);
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        for (seconds, date) in [
            (0, "1970-01-01 00:00:00 UTC"),
            (951_782_399, "2000-02-28 23:59:59 UTC"),
            (951_782_400, "2000-02-29 00:00:00 UTC"),
            (1_000_000_000, "2001-09-09 01:46:40 UTC"),
            (1_735_689_599, "2024-12-31 23:59:59 UTC"),
            (4_107_542_400, "2100-03-01 00:00:00 UTC"),
        ] {
            assert_eq!(utc(seconds), date);
        }
    }

    #[test]
    fn only_processes_of_this_machine_are_judged() {
        let this = Holder::this("a test");
        assert_eq!(this.is_running(), Some(true));
        assert_eq!(Holder { started: Some(1), ..this.clone() }.is_running(), Some(false), "another process");
        assert_eq!(Holder { machine: Some("elsewhere".into()), ..this.clone() }.is_running(), None);
        assert_eq!(Holder { machine: None, ..this.clone() }.is_running(), None);
        let named = Holder {
            owner: "ann".into(),
            host: "wolf".into(),
            process: 7,
            since: "2001-09-09 01:46:40 UTC".into(),
            ..this
        };
        assert_eq!(named.to_string(), "ann on wolf, process 7, since 2001-09-09 01:46:40 UTC (a test)");
    }
}
