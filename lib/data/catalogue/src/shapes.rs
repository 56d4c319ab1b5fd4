//! Shapes that many cars and vans start from.

use crate::body::Shape;

/// A nose whose bumper stands out below the bonnet.
const LOW_NOSE: &[(f32, f32)] =
    &[(0.20, 0.09), (0.34, 0.02), (0.50, 0.0), (0.66, 0.015), (0.80, 0.045), (0.92, 0.09), (1.0, 0.17)];
/// An upright one.
const HIGH_NOSE: &[(f32, f32)] =
    &[(0.20, 0.07), (0.34, 0.015), (0.45, 0.0), (0.75, 0.012), (0.88, 0.035), (0.95, 0.07), (1.0, 0.12)];
/// A tail with a boot's lid above the bumper.
const BOOT: &[(f32, f32)] =
    &[(0.20, 0.10), (0.34, 0.025), (0.46, 0.0), (0.60, 0.004), (0.66, 0.04), (0.92, 0.05), (1.0, 0.07)];
/// A straight one.
const HATCH: &[(f32, f32)] =
    &[(0.20, 0.08), (0.36, 0.015), (0.50, 0.0), (0.66, 0.006), (0.72, 0.035), (0.90, 0.045), (1.0, 0.055)];
/// That of a van.
const UPRIGHT: &[(f32, f32)] = &[(0.2, 0.03), (0.36, 0.0), (0.62, 0.004), (0.70, 0.025), (1.0, 0.03)];

/// A saloon: the shape that all others start from.
pub const SEDAN: Shape = Shape {
    nose_z: 0.50,
    cowl: (0.27, 0.67),
    roof: (0.43, 0.69),
    deck: (0.85, 0.70),
    tail_z: 0.66,
    windows: (0.30, 0.77),
    pillars: &[0.52],
    roof_width: 0.70,
    clearance: 0.12,
    rear_glass: true,
    roof_z: 1.0,
    bow_m: [0.30, 0.22],
    glass_bow_m: [0.16, 0.12],
    tuck: 0.05,
    ends_width: [0.86, 0.88],
    nose_lean: LOW_NOSE,
    tail_lean: BOOT,
    belt: [0.90, 0.90],
    crown_m: 0.055,
    falls: [0.035, 0.028],
};

/// A car with a steep tail.
pub(crate) const HATCHBACK: Shape = Shape {
    bow_m: [0.28, 0.16],
    glass_bow_m: [0.15, 0.09],
    ends_width: [0.86, 0.90],
    tail_lean: HATCH,
    ..SEDAN
};

/// Cars that stand high.
pub(crate) const TALL: Shape = Shape {
    bow_m: [0.22, 0.14],
    glass_bow_m: [0.13, 0.08],
    ends_width: [0.90, 0.92],
    nose_lean: HIGH_NOSE,
    tuck: 0.045,
    crown_m: 0.05,
    ..HATCHBACK
};

/// A van.
pub(crate) const VAN: Shape = Shape {
    bow_m: [0.26, 0.04],
    glass_bow_m: [0.16, 0.03],
    ends_width: [0.88, 0.965],
    tail_lean: UPRIGHT,
    tuck: 0.025,
    belt: [0.88, 0.86],
    crown_m: 0.06,
    falls: [0.022, 0.006],
    ..TALL
};
