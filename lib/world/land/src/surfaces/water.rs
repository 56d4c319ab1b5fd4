//! Rivers and lakes: level water in a bed that is cut into the land.

use opendrive::Map;

use crate::surfaces::region::Region;

/// A level surface of water, as an object of the map outlines it.
#[derive(Clone, Debug)]
pub struct Water {
    ring: Vec<[f64; 2]>,
    bounds: Region,
    pub(crate) z_m: f64,
}

/// The waters of a map.
pub(crate) fn waters(map: &Map) -> Vec<Water> {
    let objects = map.objects().iter().filter(|o| o.is_water());
    let outlines = objects.flat_map(|o| &o.outlines).filter(|o| o.closed && o.base.len() > 2);
    let found = outlines.map(|outline| {
        let z_m = outline.base.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
        Water::new(outline.base.iter().map(|p| [p.x, p.y]).collect(), z_m)
    });
    found.filter(|w| w.z_m.is_finite()).collect()
}

impl Water {
    fn new(ring: Vec<[f64; 2]>, z_m: f64) -> Self {
        let fold =
            |axis: usize, pick: fn(f64, f64) -> f64, start| ring.iter().map(|p| p[axis]).fold(start, pick);
        let min = [0, 1].map(|k| fold(k, f64::min, f64::INFINITY));
        let max = [0, 1].map(|k| fold(k, f64::max, f64::NEG_INFINITY));
        Self { bounds: Region { min, max }, ring, z_m }
    }

    /// Whether it comes within some metres of a region.
    pub(crate) fn is_near(&self, region: &Region, reach_m: f64) -> bool {
        self.bounds.grown(reach_m).meets(region)
    }

    /// Distance from its edge, metres: positive on land, negative in the water (even-odd rule). Infinite for
    /// what is farther than `reach_m` from the box around it.
    #[must_use]
    pub fn clearance_m(&self, x: f64, y: f64, reach_m: f64) -> f64 {
        if !self.bounds.grown(reach_m).contains(x, y) {
            return f64::INFINITY;
        }
        let (mut inside, mut least) = (false, f64::INFINITY);
        for (i, a) in self.ring.iter().enumerate() {
            let b = self.ring[(i + 1) % self.ring.len()];
            let leg = [b[0] - a[0], b[1] - a[1]];
            let to = [x - a[0], y - a[1]];
            if (a[1] > y) != (b[1] > y) && to[0] < to[1] / leg[1] * leg[0] {
                inside = !inside;
            }
            let along = (to[0] * leg[0] + to[1] * leg[1]) / (leg[0] * leg[0] + leg[1] * leg[1]).max(1e-12);
            let u = along.clamp(0.0, 1.0);
            let off = [to[0] - u * leg[0], to[1] - u * leg[1]];
            least = least.min(off[0] * off[0] + off[1] * off[1]);
        }
        if inside { -least.sqrt() } else { least.sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clearances_of_an_ell() {
        // An L of two arms, 2 m wide.
        let ring = [[0.0, 0.0], [6.0, 0.0], [6.0, 2.0], [2.0, 2.0], [2.0, 6.0], [0.0, 6.0]];
        for ring in [ring.to_vec(), ring.iter().rev().copied().collect()] {
            let water = Water::new(ring, 0.0);
            let is = |x: f64, y: f64, wanted: f64| {
                let found = water.clearance_m(x, y, 10.0);
                assert!((found - wanted).abs() < 1e-12, "{found} instead of {wanted} at {x}, {y}");
            };
            is(1.0, 1.0, -1.0);
            is(1.5, 4.0, -0.5);
            is(5.0, 1.25, -0.75);
            is(3.0, 4.0, 1.0);
            is(9.0, 6.0, 5.0);
            is(-1.0, 2.0, 1.0);
            assert_eq!(water.clearance_m(17.0, 1.0, 10.0), f64::INFINITY);
        }
    }
}
