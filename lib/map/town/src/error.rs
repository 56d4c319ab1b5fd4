//! What can go wrong.

/// Why a town can't be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TownError {
    /// A parameter is out of its range.
    #[error("town parameter `{name}` is {value}, must be {range}")]
    Parameter {
        /// The key, with its table.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// The text is no TOML, names a key that does not exist, or a value has the wrong type.
    #[error("town parameters: {0}")]
    Toml(String),
    /// The junctions at the ends of a street leave no room for it.
    #[error("street `{street}` has {left_m:.1} m left between its junctions, needs {needed_m:.1} m")]
    TooTight {
        /// Name of the street.
        street: String,
        /// Length that is left, metres (negative: the junctions overlap).
        left_m: f64,
        /// Least length, metres.
        needed_m: f64,
    },
    /// A street would have to climb more steeply than its traffic can.
    #[error("street `{street}` would have a grade of {grade:.3}, its limit is {limit:.3}")]
    TooSteep {
        /// Name of the street.
        street: String,
        /// Rise over run.
        grade: f64,
        /// Largest rise over run.
        limit: f64,
    },
    /// A bend has no room for its radius.
    #[error("street `{street}` would bend with a radius of {radius_m:.1} m, needs {needed_m:.1} m")]
    Bend {
        /// Name of the street.
        street: String,
        /// Radius that there is room for, metres.
        radius_m: f64,
        /// Least radius, metres.
        needed_m: f64,
    },
    /// Two roads cross that neither meet nor clear one another.
    #[error("`{over}` crosses `{under}` only {gap_m:.2} m above it, needs 5 m (or a junction)")]
    Clearance {
        /// Name of the upper road.
        over: String,
        /// Name of the lower road.
        under: String,
        /// Height between them, metres.
        gap_m: f64,
    },
    /// A layout asks for something that can't be.
    #[error("{place}: {problem}")]
    Layout {
        /// Name of the street or node.
        place: String,
        /// What is wrong.
        problem: String,
    },
}
