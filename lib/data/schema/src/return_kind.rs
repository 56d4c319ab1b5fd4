//! What sent light back to a lidar.

/// What sent a lidar's light back: the numbers of the column `return_kind`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum ReturnKind {
    /// A surface.
    #[default]
    Surface = 0,
    /// Fog between the sensor and what is behind it: nobody's, so its object id and its tag are 0.
    Fog = 1,
    /// A drop of rain, likewise.
    Rain = 2,
    /// A surface behind a pane of glass, or within a car whose door stands open.
    BehindGlass = 3,
}

impl ReturnKind {
    /// All kinds, by number.
    pub const ALL: [Self; 4] = [Self::Surface, Self::Fog, Self::Rain, Self::BehindGlass];

    /// Whether an object sent it back, not the air.
    #[must_use]
    pub fn is_of_surface(kind: u8) -> bool {
        kind == Self::Surface as u8 || kind == Self::BehindGlass as u8
    }
}
