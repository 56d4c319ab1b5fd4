//! Areas of the plan.

/// An area of the plan, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// South-western corner.
    pub min: [f64; 2],
    /// North-eastern corner.
    pub max: [f64; 2],
}

impl Region {
    /// Whether a point lies in it; its northern and eastern borders belong to its neighbours.
    #[must_use]
    pub fn contains(&self, x: f64, y: f64) -> bool {
        x >= self.min[0] && x < self.max[0] && y >= self.min[1] && y < self.max[1]
    }

    /// Whether it shares a point with another one.
    #[must_use]
    pub fn meets(&self, other: &Self) -> bool {
        (0..2).all(|k| self.min[k] <= other.max[k] && self.max[k] >= other.min[k])
    }

    /// The area with a margin on all sides.
    #[must_use]
    pub fn grown(&self, by_m: f64) -> Self {
        Self { min: self.min.map(|v| v - by_m), max: self.max.map(|v| v + by_m) }
    }
}
