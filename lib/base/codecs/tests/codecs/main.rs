//! Archives: read by numpy, broken on purpose.

mod hostile;
mod numpy;
mod records;
