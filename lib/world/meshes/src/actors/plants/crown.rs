//! Where the crown of a tree is.

use std::f32::consts::PI;

use glam::Vec3;

use super::leaves::Draws;
use super::species::Species;

/// Share of the area of leaves that does not hide behind other leaves of its twig.
const UNHIDDEN: f32 = 0.8;
/// From this height on a tree is grown, and how high a crown begins that is pruned, metres.
const GROWN_M: f32 = 8.5;
const OVER_LORRIES_M: f32 = 4.75;
const OVER_PEOPLE_M: f32 = 2.4;
/// The shape is known at so many heights.
const SLICES: usize = 48;

/// Where a crown is: a body that is round seen from above, with the shape of its species seen from aside.
#[derive(Clone, Debug)]
pub(super) struct Crown {
    pub(super) species: &'static Species,
    pub(super) half_m: Vec3,
    pub(super) base_m: f32,
    pub(super) top_m: f32,
    /// The volume, m3.
    pub(super) volume_m3: f32,
    /// Radius by height, as a share of the greatest.
    shares: [f32; SLICES + 1],
    /// The height, from 0 to 1, below which so many of [`SLICES`] parts of the volume are.
    heights: [f32; SLICES + 1],
    /// Nothing grows beyond this share of the way from the stem to the crown's edge.
    edge: f32,
}

/// The value of a table at a share of its length.
fn between(table: &[f32; SLICES + 1], share: f32) -> f32 {
    let at = share.clamp(0.0, 1.0) * SLICES as f32;
    let i = (at as usize).min(SLICES - 1);
    table[i] + (table[i + 1] - table[i]) * (at - i as f32)
}

impl Crown {
    pub(super) fn new(species: &'static Species, size: Vec3) -> Self {
        // Street trees are pruned: lorries drive below the grown ones, people walk below the young ones.
        let clear_m = match (species.is_pruned(), size.z > GROWN_M) {
            (true, true) => OVER_LORRIES_M,
            (true, false) => OVER_PEOPLE_M,
            (false, _) => 0.0,
        };
        let base_m = (species.bare * size.z).max(clear_m).min(0.6 * size.z);
        let half_m = 0.5 * size;
        let shares = std::array::from_fn(|i| species.shape.at(i as f32 / SLICES as f32));
        let mut below = [0.0; SLICES + 1];
        for i in 0..SLICES {
            let [a, b] = [shares[i], shares[i + 1]];
            // Of a frustum.
            below[i + 1] = below[i] + (a * a + a * b + b * b) / 3.0;
        }
        let (whole, mut i) = (below[SLICES], 0);
        let heights = std::array::from_fn(|k| {
            let wanted = whole * k as f32 / SLICES as f32;
            while i + 1 < SLICES && below[i + 1] < wanted {
                i += 1;
            }
            let part = (wanted - below[i]) / (below[i + 1] - below[i]).max(1e-9);
            (i as f32 + part.clamp(0.0, 1.0)) / SLICES as f32
        });
        let volume_m3 = PI * half_m.x * half_m.y * (size.z - base_m) * whole / SLICES as f32;
        // Leaves reach beyond their middles.
        let edge = (1.0 - 0.4 * species.leaves.cluster_m / half_m.x).clamp(0.8, 0.97);
        Self { species, half_m, base_m, top_m: size.z, volume_m3, shares, heights, edge }
    }

    pub(super) fn height_m(&self) -> f32 {
        self.top_m - self.base_m
    }

    /// Its radius at a height, as a share of its greatest one.
    pub(super) fn share(&self, z: f32) -> f32 {
        if z < self.base_m || z > self.top_m {
            return 0.0;
        }
        between(&self.shares, (z - self.base_m) / self.height_m())
    }

    /// How far from the stem a place is, as a share of the way to the crown's edge.
    pub(super) fn out(&self, p: Vec3) -> f32 {
        let [x, y] = [p.x / self.half_m.x, p.y / self.half_m.y];
        (x * x + y * y).sqrt() / self.share(p.z).max(1e-3)
    }

    /// The nearest place in the crown, at the same height if that is one of it.
    pub(super) fn within(&self, p: Vec3) -> Vec3 {
        let z = p.z.clamp(self.base_m + 0.01 * self.top_m, self.top_m - 0.01 * self.top_m);
        let p = Vec3::new(p.x, p.y, z);
        let (out, edge) = (self.out(p), self.edge);
        if out > edge { Vec3::new(p.x * edge / out, p.y * edge / out, z) } else { p }
    }

    /// A place in it above so much of its volume, all alike but for more of them farther out where `shell` is
    /// above 0 (at most 1).
    pub(super) fn anywhere(&self, below: f32, shell: f32, draws: &mut Draws) -> Vec3 {
        let z = self.base_m + self.height_m() * between(&self.heights, 0.01 + 0.98 * below);
        let ([x, y], square) = draws.disc();
        let reach = self.share(z) * self.edge * (1.0 + shell * (1.0 - square.sqrt()));
        Vec3::new(x * reach * self.half_m.x, y * reach * self.half_m.y, z)
    }

    /// A place in it near some place.
    pub(super) fn around(&self, place: Vec3, spread_m: f32, draws: &mut Draws) -> Vec3 {
        let mut p = place + draws.around() * spread_m;
        let low = self.base_m + 0.01 * self.height_m();
        p.z = p.z.max(2.0 * low - p.z).clamp(low, self.top_m - 0.01 * self.height_m());
        let out = self.out(p);
        if out > self.edge {
            // As far inside as it was outside.
            let by = (2.0 * self.edge - out).max(0.5 * self.edge) / out;
            p = Vec3::new(p.x * by, p.y * by, p.z);
        }
        p
    }

    /// The area of all triangles of leaves, m2.
    pub(super) fn area_m2(&self) -> f32 {
        UNHIDDEN * self.species.leaves.lai * PI * self.half_m.x * self.half_m.y
    }

    /// The way out at a place (unit): that of an ellipsoid as large as the crown.
    pub(super) fn outward(&self, p: Vec3) -> Vec3 {
        let middle = 0.5 * (self.base_m + self.top_m);
        let half_z = 0.5 * self.height_m();
        let [x, y] = [self.half_m.x, self.half_m.y];
        Vec3::new(p.x / (x * x), p.y / (y * y), (p.z - middle) / (half_z * half_z)).normalize_or(Vec3::Z)
    }

    /// What of the light of sky and ground gets to a place, 0 to 1: less where more leaves are around it.
    pub(super) fn open(&self, p: Vec3) -> f32 {
        let density = self.area_m2() / self.volume_m3;
        let [x, y] = [p.x / self.half_m.x, p.y / self.half_m.y];
        let inside = (self.share(p.z) - (x * x + y * y).sqrt()).max(0.0) * self.half_m.x;
        let deep_m = inside.min(self.top_m - p.z).max(0.0);
        let high = ((p.z - self.base_m) / self.height_m()).clamp(0.0, 1.0);
        (0.72 + 0.28 * high) * (0.3 + 0.7 / (1.0 + 1.3 * density * deep_m))
    }

    /// The same of a place on wood, which is in the open below the crown.
    pub(super) fn open_wood(&self, p: Vec3) -> f32 {
        if p.z < self.base_m { 0.9 } else { self.open(p) }
    }
}
