//! What lies about in road works, and the signs before hazards: names and dimensions. `world` makes the
//! meshes, `traffic` puts them on the road.

use crate::roadside::CONCRETE;

/// Name of the mesh, and length, width, height in metres.
pub type Item = (&'static str, [f64; 3]);

/// Small things of road works.
pub const SMALL: [Item; 19] = [
    ("prop.barrel", [0.58, 0.58, 0.88]),
    ("prop.sandbag_closed", [0.62, 0.40, 0.18]),
    ("prop.concrete_piece_1", [0.90, 0.45, 0.40]),
    ("prop.concrete_slab_1", [1.00, 0.60, 0.10]),
    ("prop.cylinder", [0.30, 0.30, 1.25]),
    ("prop.electrical_box", [0.45, 0.80, 1.10]),
    ("prop.floor_grill", [0.90, 0.60, 0.06]),
    ("prop.gutter", [1.20, 0.30, 0.22]),
    ("prop.hand_truck", [0.50, 0.52, 1.25]),
    ("prop.sandbag_open", [0.55, 0.50, 0.55]),
    ("prop.pallet", [1.20, 0.80, 0.15]),
    ("prop.shovel", [1.25, 0.26, 0.12]),
    ("prop.stone_ring", [0.90, 0.90, 0.35]),
    ("prop.toolbox", [0.55, 0.28, 0.30]),
    ("prop.wheelbarrow", [1.40, 0.62, 0.66]),
    ("prop.wooden_wheel", [0.90, 0.60, 0.90]),
    ("prop.bucket", [0.34, 0.34, 0.36]),
    ("prop.concrete_piece_2", [0.60, 0.50, 0.35]),
    ("prop.concrete_slab_2", [0.80, 0.80, 0.16]),
];

/// Large things of road works; the barrier is one of [`crate::models::MODELS`].
pub const LARGE: [Item; 6] = [
    ("prop.iron_plank", [2.60, 0.24, 0.22]),
    (CONCRETE.name, CONCRETE.size_m),
    ("prop.pipe", [2.00, 0.80, 0.80]),
    ("prop.construction_light", [1.00, 1.00, 2.10]),
    ("prop.pile", [1.70, 1.40, 0.70]),
    ("prop.floorboard", [2.40, 0.90, 0.05]),
];

/// The sign before an accident, and those before road works.
pub const ACCIDENT_SIGN: Item = ("sign.accident", [0.70, 0.90, 1.25]);
/// Road works lie ahead.
pub const WORKS_SIGN: Item = ("sign.road_works", [0.70, 1.00, 1.40]);
/// Some danger lies ahead.
pub const DANGER_SIGN: Item = ("sign.danger", [0.70, 0.90, 1.25]);

/// Everything above.
pub fn all() -> impl Iterator<Item = Item> {
    SMALL.into_iter().chain(LARGE).chain([ACCIDENT_SIGN, WORKS_SIGN, DANGER_SIGN])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models;

    #[test]
    fn names_are_unique_and_models_have_one_size() {
        let names: Vec<&str> = all().map(|(name, _)| name).collect();
        for (i, (name, size_m)) in all().enumerate() {
            assert_eq!(names.iter().position(|n| *n == name), Some(i));
            assert!(models::find(name).is_none_or(|m| m.size_m == size_m), "{name}");
        }
    }
}
