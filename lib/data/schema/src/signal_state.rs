//! What a traffic light shows.

use crate::text::words;

/// What a traffic light shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum SignalState {
    Red,
    Yellow,
    Green,
    #[default]
    Off,
}

words! {
    SignalState, "signal state":
    Red = "Red",
    Yellow = "Yellow",
    Green = "Green",
    Off = "Off",
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_of_the_format() {
        assert_eq!(
            SignalState::ALL.iter().map(|s| s.name()).collect::<Vec<_>>().join(" "),
            "Red Yellow Green Off"
        );
        for state in SignalState::ALL {
            assert_eq!(state.to_string().parse(), Ok(*state));
        }
        let error = "green".parse::<SignalState>().expect_err("words are as written").to_string();
        assert_eq!(error, "`green` is no signal state, expected one of Red, Yellow, Green, Off");
    }
}
