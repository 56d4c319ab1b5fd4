//! What a driver wants of the lanes beside, as the others see it.

/// The outcome of a driver's last look at the lanes beside.
#[derive(Debug, Default)]
pub(crate) struct LaneChoice {
    /// The lane beside that it must change to and finds no gap on.
    wanted: Option<usize>,
    /// It stands too near behind a wreck to get past it.
    boxed_in: bool,
}

impl LaneChoice {
    /// The lane that it asks to be let in to.
    pub(crate) fn wanted(&self) -> Option<usize> {
        self.wanted
    }

    /// Whether it stands too near behind a wreck to get past it.
    pub(crate) fn is_boxed_in(&self) -> bool {
        self.boxed_in
    }

    /// It has no wish, or its wish is granted.
    pub(crate) fn settle(&mut self) {
        *self = Self::default();
    }

    /// It must change and cannot: it asks to be let in to a lane, if that would help, or is boxed in.
    pub(crate) fn ask(&mut self, wanted: Option<usize>, boxed_in: bool) {
        *self = Self { wanted, boxed_in };
    }
}
