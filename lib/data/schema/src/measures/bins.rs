//! Bins of histograms.

/// Half-open bins `[lower, lower + width)`, ..., `[upper - width, upper)`, each named by its lower edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bins {
    /// Lower edge of the first bin.
    pub lower: i32,
    /// Upper edge of the last bin, and name of the bin for all values from there on.
    pub upper: i32,
    /// Width of a bin.
    pub width: i32,
}

impl Bins {
    /// Name (lower edge) of the bin that holds a value: `lower - width` for all values below, `upper` for all
    /// values above. NaN counts as above.
    #[must_use]
    pub fn bin_of(&self, value: f64) -> i32 {
        if value < f64::from(self.lower) {
            self.lower - self.width
        } else if value < f64::from(self.upper) {
            self.lower + ((value - f64::from(self.lower)) / f64::from(self.width)).floor() as i32 * self.width
        } else {
            self.upper
        }
    }

    /// Lower edges of the bins between the limits, in order.
    pub fn edges(&self) -> impl Iterator<Item = i32> + use<> {
        (self.lower..self.upper).step_by(self.width.unsigned_abs() as usize)
    }
}
