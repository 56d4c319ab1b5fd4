//! Lanes as the rule draws them, and which of them it keeps.

use nalgebra::Point3;

/// Samples of a lane that make one polygon: 16 m.
const PIECE: usize = 40;
/// Midline points that differ this much in height are on two levels, metres.
const LEVELS_M: f64 = 6.4;
/// Two levels that come as near as this in plan mix, metres.
const LEVELS_APART_M: f64 = 48.0;

/// A lane of one section, sampled every 0.4 m along its road, in the world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LaneStrip {
    /// Border points on one side.
    pub left: Vec<Point3<f64>>,
    /// As many on the other.
    pub right: Vec<Point3<f64>>,
    /// The first, every tenth and the last point of the middle.
    pub midline: Vec<Point3<f64>>,
    /// Points of the markings within the lane's borders.
    pub markings: Vec<Point3<f64>>,
}

/// What an agent's masks may show of the map: collected about it once a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LaneAreas {
    /// Lanes that count as road.
    pub roads: Vec<LaneStrip>,
    /// Sidewalks.
    pub sidewalks: Vec<LaneStrip>,
    /// Outlines of pedestrian crossings.
    pub crosswalks: Vec<Vec<Point3<f64>>>,
    /// Whether the map has roads above one another anywhere: only there overpasses are looked for.
    pub multi_level: bool,
}

impl LaneStrip {
    /// Whether a midline point lies in a ball.
    pub(crate) fn is_near(&self, centre: Point3<f64>, radius_m: f64) -> bool {
        self.midline.iter().any(|p| (p - centre).norm() <= radius_m)
    }

    /// The lane's pieces: the left border of each, then the right one back. Pieces share no corner.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = impl Iterator<Item = Point3<f64>>> {
        let pairs = self.left.chunks(PIECE).zip(self.right.chunks(PIECE));
        pairs.map(|(left, right)| left.iter().chain(right.iter().rev()).copied())
    }
}

/// Whether points of the midlines lie on two levels so near to one another that masks would mix them.
pub(crate) fn levels_mix(midline: &[Point3<f64>]) -> bool {
    let low = midline.iter().fold(f64::INFINITY, |low, p| low.min(p.z));
    let high = midline.iter().fold(f64::NEG_INFINITY, |high, p| high.max(p.z));
    // Also where there is no point at all.
    if high - low < LEVELS_M || midline.is_empty() {
        return false;
    }
    let middle = 0.5 * (low + high);
    let upper: Vec<&Point3<f64>> = midline.iter().filter(|p| p.z > middle + 0.5 * LEVELS_M).collect();
    let lower: Vec<&Point3<f64>> = midline.iter().filter(|p| p.z < middle - 0.5 * LEVELS_M).collect();
    upper.iter().any(|a| lower.iter().any(|b| (*a - *b).xy().norm() <= LEVELS_APART_M))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(places: &[[f64; 3]]) -> Vec<Point3<f64>> {
        places.iter().map(|&p| p.into()).collect()
    }

    #[test]
    fn levels_mix_where_they_are_near_in_plan() {
        let mix = |places: &[[f64; 3]]| levels_mix(&points(places));
        assert!(!mix(&[]));
        assert!(!mix(&[[0.0, 0.0, 0.0], [1.0, 0.0, 6.3]]), "one level");
        assert!(mix(&[[0.0, 0.0, 0.0], [48.0, 0.0, 6.5]]));
        assert!(!mix(&[[0.0, 0.0, 0.0], [48.1, 0.0, 6.5]]), "far apart");
        // Exactly 6.4 m: nobody is above or below the middle by more than half of it.
        assert!(!mix(&[[0.0, 0.0, 0.0], [1.0, 0.0, 6.4]]));
        // The test is symmetric about the middle: 3 m and 9.5 m differ by more than 6.4 m, but the middle is
        // at 10.
        assert!(!mix(&[[0.0, 0.0, 3.0], [1.0, 0.0, 9.5], [500.0, 0.0, 17.0]]));
    }

    #[test]
    fn pieces_have_forty_samples_a_side() {
        let side = |y: f64| (0..90).map(|k| Point3::new(0.4 * f64::from(k), y, 0.0)).collect::<Vec<_>>();
        let strip = LaneStrip { left: side(1.75), right: side(-1.75), ..LaneStrip::default() };
        let pieces: Vec<Vec<Point3<f64>>> = strip.pieces().map(Iterator::collect).collect();
        assert_eq!(pieces.iter().map(Vec::len).collect::<Vec<_>>(), [80, 80, 20]);
        // The first ends at 15.6 m, the second begins at 16 m.
        let ends = [pieces[0][39].x, pieces[0][40].x, pieces[1][0].x];
        assert!(ends.iter().zip([15.6, 15.6, 16.0]).all(|(x, want)| (x - want).abs() < 1e-9), "{ends:?}");
        assert_eq!(pieces[0][79], Point3::new(0.0, -1.75, 0.0));
    }
}
