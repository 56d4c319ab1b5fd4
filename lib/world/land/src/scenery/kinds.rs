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
    /// The front wall stands so far behind the front of the box, metres: in between are steps, balconies and
    /// awnings.
    pub recess_m: f64,
}

const fn kind(
    model: &'static str,
    width_m: [f64; 2],
    depth_m: [f64; 2],
    storeys: [i64; 2],
    recess_m: f64,
) -> BuildingKind {
    BuildingKind { model, width_m, depth_m, storeys, recess_m }
}

/// Kinds of buildings. None has a diagonal of more than 42 m: what is placed around them depends on that
/// (`site::reach_m`).
pub const BUILDINGS: [BuildingKind; 5] = [
    kind("building.block", [14.0, 28.0], [11.0, 16.0], [3, 7], 0.8),
    kind("building.tower", [18.0, 30.0], [16.0, 24.0], [9, 20], 0.2),
    kind("building.house", [8.0, 13.0], [8.0, 11.0], [2, 3], 0.4),
    kind("building.shop", [12.0, 24.0], [10.0, 16.0], [1, 2], 0.8),
    kind("building.hall", [22.0, 34.0], [18.0, 24.0], [2, 3], 0.05),
];

/// A kind of tree and how large it is young, grown and old.
#[derive(Clone, Copy, Debug)]
pub struct TreeKind {
    /// Model name.
    pub model: &'static str,
    /// Name of the same tree without leaves; that of evergreens is their own.
    pub bare: &'static str,
    /// Height, metres.
    pub height_m: [f64; 3],
    /// Diameter of the crown, metres.
    pub crown_m: [f64; 3],
}

const fn tree([model, bare]: [&'static str; 2], height_m: [f64; 3], crown_m: [f64; 3]) -> TreeKind {
    TreeKind { model, bare, height_m, crown_m }
}

/// Kinds of trees as they grow in streets and parks.
pub const TREES: [TreeKind; 15] = [
    tree(["tree.lime", "tree.lime.bare"], [6.0, 15.0, 22.0], [3.0, 9.0, 13.0]),
    tree(["tree.maple", "tree.maple.bare"], [6.0, 14.0, 20.0], [3.0, 9.0, 13.0]),
    tree(["tree.plane", "tree.plane.bare"], [7.0, 18.0, 26.0], [4.0, 12.0, 16.0]),
    tree(["tree.chestnut", "tree.chestnut.bare"], [6.0, 16.0, 23.0], [3.0, 11.0, 15.0]),
    tree(["tree.robinia", "tree.robinia.bare"], [6.0, 14.0, 21.0], [3.0, 8.0, 12.0]),
    tree(["tree.oak", "tree.oak.bare"], [5.0, 16.0, 25.0], [3.0, 12.0, 16.0]),
    tree(["tree.ash", "tree.ash.bare"], [6.0, 17.0, 26.0], [3.0, 10.0, 15.0]),
    tree(["tree.birch", "tree.birch.bare"], [6.0, 15.0, 21.0], [2.0, 6.0, 9.0]),
    tree(["tree.hornbeam", "tree.hornbeam.bare"], [4.0, 10.0, 15.0], [1.5, 4.0, 6.0]),
    tree(["tree.cherry", "tree.cherry.bare"], [4.0, 7.0, 10.0], [3.0, 6.0, 8.0]),
    tree(["tree.poplar", "tree.poplar.bare"], [8.0, 20.0, 28.0], [1.5, 3.0, 5.0]),
    tree(["tree.willow", "tree.willow.bare"], [5.0, 12.0, 17.0], [4.0, 11.0, 15.0]),
    tree(["tree.spruce", "tree.spruce"], [5.0, 16.0, 27.0], [2.5, 5.0, 8.0]),
    tree(["tree.pine", "tree.pine"], [5.0, 15.0, 24.0], [3.0, 6.0, 9.0]),
    tree(["tree.palm", "tree.palm"], [5.0, 12.0, 18.0], [4.0, 5.0, 6.0]),
];

impl TreeKind {
    /// So many trees of a kind and age differ.
    pub const VARIANTS: u32 = 3;

    /// The box of one of them at an age (0 young, 1 grown, 2 old), metres.
    #[must_use]
    pub fn size_m(&self, age: usize, variant: u32) -> [f64; 3] {
        let of =
            |sizes: [f64; 3]| (4.0 * sizes[age.min(2)] * (0.92 + 0.08 * f64::from(variant))).round() / 4.0;
        let crown = of(self.crown_m);
        [crown, crown, of(self.height_m)]
    }
}
