//! What is wrong with a file that can be used all the same.

use std::fmt;

/// Something wrong in a file that the reader put up with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Warning {
    /// Line, from 1; 0 where no single line is to blame.
    pub line: u32,
    /// Id of the road it is in.
    pub road: Option<String>,
    /// Metres along that road.
    pub s: Option<f64>,
    /// What is wrong, and what was done about it.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}", self.line)?;
        if let Some(road) = &self.road {
            write!(f, ", road {road}")?;
        }
        if let Some(s) = self.s {
            write!(f, ", s {s:.3}")?;
        }
        write!(f, ": {}", self.message)
    }
}
