//! Ranges of parameters.

use crate::error::TownError;

/// Checks that a value is in its range (NaN never is).
pub(super) fn within(
    name: &'static str,
    value: f64,
    [low, high]: [f64; 2],
    range: &'static str,
) -> Result<(), TownError> {
    if value >= low && value <= high { Ok(()) } else { Err(TownError::Parameter { name, value, range }) }
}
