//! The room inside a hull.

use glam::Vec3;

use crate::actors::hull::Hull;

/// What is inside stays so far from the skin, metres.
const MARGIN_M: f32 = 0.022;
/// The same along it, where the skin is steep.
const AHEAD_M: f32 = 0.015;
/// The same from nose and tail.
const ENDS_M: f32 = 0.05;

/// The room inside a hull, without its wheel houses.
pub(crate) struct Room<'a> {
    pub(crate) hull: &'a Hull,
    /// How far from the middle the wheel houses of each axle begin, metres.
    pub(crate) inner_y: Vec<f32>,
}

impl Room<'_> {
    /// Height of the floor above the road where nothing is in the way, metres.
    pub(crate) fn least_z(&self) -> f32 {
        self.hull.style.clearance * self.hull.height + MARGIN_M
    }

    /// The least height over a place along the hull that is clear of its wheels, if they stand there: and how
    /// far aside it holds.
    pub(crate) fn over_wheels(&self, x: f32) -> Option<(f32, f32)> {
        let hull = self.hull;
        let (axle, inner_y) =
            hull.axles.iter().zip(&self.inner_y).find(|(axle, _)| (x - **axle).abs() < 1.04 * hull.arch)?;
        // A chord of the arch's polygon is no higher than the arch.
        let d = ((x - axle).abs() - AHEAD_M).max(0.0);
        let rise = (hull.arch * hull.arch - d * d).max(0.0).sqrt();
        Some((hull.radius + rise + MARGIN_M, *inner_y))
    }

    /// The place next to `p` that lies well inside.
    pub(crate) fn held(&self, p: Vec3) -> Vec3 {
        let hull = self.hull;
        let end = |f: f32, by: f32| hull.x_of(f) + hull.lean(f, p.z) + by;
        let x = p.x.clamp(end(1.0, ENDS_M), end(0.0, -ENDS_M));
        let mut y = p.y.abs();
        let mut z = p.z;
        for ahead_m in [0.0, AHEAD_M, -AHEAD_M] {
            let at = hull.section(hull.f_of(x + ahead_m - hull.lean(hull.f_of(x), z)));
            let belt_y = hull.aside(&at, at.belt_z);
            // The side is convex: a straight line from belt to roof lies inside.
            let wide = if z <= at.belt_z {
                hull.aside(&at, z)
            } else {
                let t = ((z - at.belt_z) / (at.edge.1 - at.belt_z).max(1e-3)).min(1.0);
                belt_y + t * (at.edge.0 - belt_y)
            };
            y = y.min((wide - MARGIN_M).max(0.0));
            let s = (y / at.edge.0.max(1e-3)).min(1.0);
            let crown = at.edge.1 + (at.top_z - at.edge.1) * (1.0 - s * s * s.sqrt());
            z = z.min(crown - MARGIN_M);
        }
        z = z.max(self.least_z());
        if let Some((least, inner_y)) = self.over_wheels(x)
            && y > inner_y - MARGIN_M
        {
            if z < least - 0.25 { y = inner_y - MARGIN_M } else { z = z.max(least) }
        }
        Vec3::new(x, y.copysign(p.y), z)
    }
}
