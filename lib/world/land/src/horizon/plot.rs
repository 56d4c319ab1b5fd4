//! Plots of the horizon.

/// Side of a plot of one use, metres: two by two are a piece.
pub(super) const PLOT_M: f64 = 64.0;
/// Side of the squares that the ground is made of, metres.
pub(super) const SQUARE_M: f64 = 32.0;
/// Nothing stands nearer to a road, metres.
pub(super) const STREET_M: f64 = 20.0;

/// How a piece of land is used, as one sees from afar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    Town,
    Village,
    Wood,
    Field,
    Meadow,
}
