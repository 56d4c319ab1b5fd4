//! Benches: where one sits on them. `actors` makes their mesh, `traffic` seats people.

/// Their model's name.
pub const MODEL: &str = "prop.bench";
/// Height of the seat's top, as a share of the bench's.
pub const SEAT: f64 = 0.50;
/// The front of the back rest is so far before the bench's rear end, metres.
pub const BACK_M: f64 = 0.09;
/// Where people sit, as shares of the bench's width from its middle to the left: two have room.
pub const PLACES: [f64; 2] = [0.22, -0.22];
/// The middle of a sitting person's box is about this far before the back rest, metres; bodies that lean at
/// it say how far.
pub const SITS_M: f64 = 0.33;
