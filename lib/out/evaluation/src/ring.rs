//! How far from the ego something is.

/// How far something is from the ego in the plane: three rings, each up to its outer edge and with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Ring {
    /// Up to 20 m.
    Near,
    /// Farther, up to 40 m.
    Middle,
    /// Farther than 40 m.
    Far,
}

impl Ring {
    /// All of them, the nearest first.
    pub const ALL: [Self; 3] = [Self::Near, Self::Middle, Self::Far];

    /// The ring of a distance, m.
    #[must_use]
    pub fn of(distance_m: f64) -> Self {
        match distance_m {
            d if d <= 20.0 => Self::Near,
            d if d <= 40.0 => Self::Middle,
            _ => Self::Far,
        }
    }

    /// Its name in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Near => "0-20 m",
            Self::Middle => "20-40 m",
            Self::Far => "over 40 m",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_belong_to_the_inner_ring() {
        assert_eq!([0.0, 20.0, 20.001, 40.0, 40.001].map(|d| Ring::of(d) as usize), [0, 0, 1, 1, 2]);
    }
}
