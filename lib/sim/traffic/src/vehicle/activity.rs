//! How much of a vehicle is simulated.

/// How awake a vehicle is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Activity {
    #[default]
    Awake,
    /// Far from all agents: it drives on to where it may sleep.
    Drowsy,
    /// It brakes to sleep.
    Halting,
    Asleep,
}
