//! What is known of the species: sizes, crowns, boughs, leaves, colours.
//!
//! Sizes are those of street and park trees. Shapes are after Weber and Penn (1995), section 4.3, but closed
//! at both ends.

use frames::math::f32::sin_cos;
use std::f32::consts::PI;

/// Radius of a crown by height, as a share of its greatest (after the `ShapeRatio` of Weber and Penn).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    Conical,
    Spherical,
    Hemispherical,
    Spindle,
    TendFlame,
}

impl Shape {
    /// The share at a height in the crown, which is 0 at its base and 1 at its top.
    pub(super) fn at(self, height: f32) -> f32 {
        let height = height.clamp(0.0, 1.0);
        let down = 1.0 - height;
        let flame = if down <= 0.7 { down / 0.7 } else { (1.0 - down) / 0.3 };
        // Crowns are closed at both ends, which the published shapes are not.
        let closed = |share: f32| share * (height / 0.12).min(1.0).sqrt() * (down / 0.05).min(1.0).sqrt();
        match self {
            Self::Conical => 0.1 + 0.9 * down,
            Self::Spherical => (4.0 * height * down).sqrt(),
            Self::Hemispherical => {
                let above = (height - 0.15).max(0.0) / 0.85;
                closed((1.0 - above * above).max(0.0).sqrt())
            }
            Self::Spindle => closed(0.28 + 0.72 * sin_cos(PI * down.sqrt()).0),
            Self::TendFlame => closed(0.5 + 0.5 * flame),
        }
    }
}

/// How the leaves of a species are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaves {
    /// Side of a square as large as the leaves of a twig of a grown tree close by, metres.
    pub(super) cluster_m: f32,
    /// How much longer than wide a twig's leaves are.
    pub(super) longer: f32,
    /// Leaf area over the ground that the crown covers.
    pub(super) lai: f32,
    /// Share of the way from any direction to straight down in which twigs hang.
    pub(super) hang: f32,
    /// How much denser they are farther out in the crown: 0 alike, 1 at most.
    pub(super) shell: f32,
    /// Linear colour.
    pub(super) rgb: [f32; 3],
}

/// A species.
#[derive(Clone, Copy, Debug)]
pub(super) struct Species {
    /// Behind `tree.` in the model's name.
    pub(super) name: &'static str,
    pub(super) shape: Shape,
    /// Share of the height that is bare.
    pub(super) bare: f32,
    /// Share of the height at which the stem ends in boughs.
    pub(super) stem: f32,
    /// Boughs at the stem, and twigs on each.
    pub(super) boughs: [usize; 2],
    /// How far boughs rise on their way out, as a share of that way: at the crown's base and at its top.
    pub(super) rise: [f32; 2],
    pub(super) leaves: Leaves,
    /// Whether it has leaves in winter, too.
    pub(super) is_evergreen: bool,
    /// Linear colour.
    pub(super) bark: [f32; 3],
}

const fn leaves(cluster_m: f32, longer: f32, lai: f32, [hang, shell]: [f32; 2], rgb: [f32; 3]) -> Leaves {
    Leaves { cluster_m, longer, lai, hang, shell, rgb }
}

const GREY: [f32; 3] = [0.16, 0.14, 0.12];
const BROWN: [f32; 3] = [0.13, 0.09, 0.06];

/// All of them but palms, which have fronds.
pub(super) const SPECIES: [Species; 14] = [
    Species {
        name: "lime",
        shape: Shape::Spherical,
        bare: 0.25,
        stem: 0.8,
        boughs: [22, 7],
        rise: [0.5, 1.6],
        leaves: leaves(0.24, 1.5, 4.0, [0.1, 0.3], [0.096, 0.16, 0.065]),
        is_evergreen: false,
        bark: GREY,
    },
    Species {
        name: "maple",
        shape: Shape::Spherical,
        bare: 0.25,
        stem: 0.7,
        boughs: [20, 7],
        rise: [0.7, 1.8],
        leaves: leaves(0.26, 1.2, 4.0, [0.0, 0.4], [0.106, 0.17, 0.072]),
        is_evergreen: false,
        bark: GREY,
    },
    Species {
        name: "plane",
        shape: Shape::Hemispherical,
        bare: 0.25,
        stem: 0.6,
        boughs: [18, 8],
        rise: [0.7, 1.6],
        leaves: leaves(0.3, 1.2, 3.0, [0.0, 0.3], [0.146, 0.201, 0.092]),
        is_evergreen: false,
        bark: [0.36, 0.33, 0.22],
    },
    Species {
        name: "chestnut",
        shape: Shape::Spherical,
        bare: 0.2,
        stem: 0.75,
        boughs: [20, 7],
        rise: [0.4, 1.5],
        leaves: leaves(0.32, 1.3, 5.0, [0.15, 0.3], [0.062, 0.113, 0.048]),
        is_evergreen: false,
        bark: BROWN,
    },
    Species {
        name: "robinia",
        shape: Shape::TendFlame,
        bare: 0.3,
        stem: 0.65,
        boughs: [15, 6],
        rise: [1.0, 2.2],
        leaves: leaves(0.2, 2.2, 2.0, [0.2, 0.4], [0.139, 0.2, 0.091]),
        is_evergreen: false,
        bark: BROWN,
    },
    Species {
        name: "oak",
        shape: Shape::Hemispherical,
        bare: 0.22,
        stem: 0.55,
        boughs: [16, 9],
        rise: [0.35, 1.4],
        leaves: leaves(0.26, 1.4, 4.0, [0.0, 0.5], [0.071, 0.122, 0.051]),
        is_evergreen: false,
        bark: BROWN,
    },
    Species {
        name: "ash",
        shape: Shape::Spherical,
        bare: 0.28,
        stem: 0.75,
        boughs: [16, 6],
        rise: [1.0, 2.0],
        leaves: leaves(0.24, 1.9, 2.7, [0.15, 0.4], [0.1, 0.161, 0.076]),
        is_evergreen: false,
        bark: GREY,
    },
    Species {
        name: "birch",
        shape: Shape::TendFlame,
        bare: 0.22,
        stem: 0.92,
        boughs: [22, 5],
        rise: [0.7, 1.6],
        leaves: leaves(0.16, 1.6, 2.05, [0.6, 0.5], [0.151, 0.219, 0.097]),
        is_evergreen: false,
        bark: [0.62, 0.61, 0.57],
    },
    Species {
        name: "hornbeam",
        shape: Shape::TendFlame,
        bare: 0.18,
        stem: 0.85,
        boughs: [26, 5],
        rise: [1.8, 3.0],
        leaves: leaves(0.17, 1.3, 4.3, [0.0, 0.7], [0.078, 0.132, 0.057]),
        is_evergreen: false,
        bark: GREY,
    },
    Species {
        name: "cherry",
        shape: Shape::Hemispherical,
        bare: 0.25,
        stem: 0.5,
        boughs: [14, 6],
        rise: [0.9, 1.6],
        leaves: leaves(0.22, 1.4, 2.5, [0.1, 0.5], [0.105, 0.152, 0.071]),
        is_evergreen: false,
        bark: [0.14, 0.08, 0.06],
    },
    Species {
        name: "poplar",
        shape: Shape::Spindle,
        bare: 0.07,
        stem: 0.95,
        boughs: [36, 4],
        rise: [4.0, 5.0],
        leaves: leaves(0.14, 1.4, 3.4, [0.0, 1.0], [0.09, 0.151, 0.066]),
        is_evergreen: false,
        bark: GREY,
    },
    Species {
        name: "willow",
        shape: Shape::Hemispherical,
        bare: 0.16,
        stem: 0.55,
        boughs: [20, 9],
        rise: [0.6, 1.3],
        leaves: leaves(0.3, 4.5, 2.5, [0.9, 0.3], [0.162, 0.202, 0.097]),
        is_evergreen: false,
        bark: BROWN,
    },
    Species {
        name: "spruce",
        shape: Shape::Conical,
        bare: 0.06,
        stem: 0.96,
        boughs: [90, 4],
        rise: [-0.25, 0.5],
        leaves: leaves(0.22, 2.4, 6.8, [0.1, 0.3], [0.043, 0.08, 0.053]),
        is_evergreen: true,
        bark: [0.09, 0.06, 0.045],
    },
    Species {
        name: "pine",
        shape: Shape::Hemispherical,
        bare: 0.52,
        stem: 0.93,
        boughs: [18, 6],
        rise: [0.2, 0.8],
        leaves: leaves(0.2, 1.5, 2.5, [0.0, 0.3], [0.064, 0.104, 0.06]),
        is_evergreen: true,
        bark: [0.21, 0.125, 0.08],
    },
];

/// Names of trees in stores of earlier versions, and what stands for them.
const EARLIER: [(&str, &str); 3] = [("broadleaf", "lime"), ("round", "maple"), ("conifer", "spruce")];

impl Species {
    /// Whether it has a stem that is kept clear.
    pub(super) fn is_pruned(&self) -> bool {
        self.bare > 0.17
    }

    /// A species by name.
    pub(super) fn named(name: &str) -> Option<&'static Self> {
        let name = EARLIER.iter().find(|(earlier, _)| *earlier == name).map_or(name, |(_, now)| now);
        SPECIES.iter().find(|species| species.name == name)
    }
}
