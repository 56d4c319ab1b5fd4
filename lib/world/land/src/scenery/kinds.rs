//! What is placed, and how large it is.

/// A kind of building and the ranges of its dimensions.
#[derive(Clone, Copy, Debug)]
pub struct BuildingKind {
    /// Model name.
    pub model: &'static str,
    /// Along the street, metres.
    pub width_m: [f64; 2],
    /// Away from the street, metres.
    pub depth_m: [f64; 2],
    /// Fewest and most storeys.
    pub storeys: [i64; 2],
}

const fn kind(model: &'static str, width_m: [f64; 2], depth_m: [f64; 2], storeys: [i64; 2]) -> BuildingKind {
    BuildingKind { model, width_m, depth_m, storeys }
}

/// Kinds of buildings. None has a diagonal of more than 42 m: what is placed around them depends on that
/// (`site::reach_m`).
pub const BUILDINGS: [BuildingKind; 5] = [
    kind("building.block", [14.0, 28.0], [11.0, 16.0], [3, 7]),
    kind("building.tower", [18.0, 30.0], [16.0, 24.0], [9, 20]),
    kind("building.house", [8.0, 13.0], [8.0, 11.0], [2, 3]),
    kind("building.shop", [12.0, 24.0], [10.0, 16.0], [1, 2]),
    kind("building.hall", [22.0, 34.0], [18.0, 24.0], [2, 3]),
];

/// Kinds of trees with their sizes: name, smallest and largest height, crown diameter as a share of the
/// height.
pub const TREES: [(&str, f64, f64, f64); 5] = [
    ("tree.broadleaf", 6.0, 13.0, 0.62),
    ("tree.round", 4.0, 8.0, 0.70),
    ("tree.poplar", 9.0, 16.0, 0.24),
    ("tree.conifer", 7.0, 15.0, 0.40),
    ("tree.palm", 6.0, 11.0, 0.48),
];
