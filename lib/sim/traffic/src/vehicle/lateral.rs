//! Where a vehicle is across its lane: on the way over from another one, or off a seam of the map.

use crate::road::sides::Side;

/// After this share of the way over, a vehicle has left its old lane.
pub(crate) const OUT: f64 = 0.62;

/// What a vehicle is off its way after a seam wears off with this sideways acceleration, m/s2, over so many
/// seconds and metres at least.
const WEARS_OFF_MPS2: f64 = 1.2;
const WEARS_OFF_S: f64 = 1.0;
const WEARS_OFF_M: f64 = 3.0;

/// A way from beside a lane's middle to the middle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LateralTransition {
    /// Place to the left of the middle at the beginning, metres.
    from_m: f64,
    /// Way over and way gone, metres.
    span_m: f64,
    gone_m: f64,
}

impl LateralTransition {
    /// Begins so far to the left of the middle, to be over after some metres of way.
    pub(crate) fn new(from_m: f64, span_m: f64) -> Self {
        Self { from_m, span_m, gone_m: 0.0 }
    }

    /// Goes on; whether the middle is not reached yet.
    fn advance(&mut self, step_m: f64) -> bool {
        self.gone_m += step_m;
        self.gone_m < self.span_m
    }

    /// Place to the left of the lane's middle after some more metres of way, and its change per metre of way:
    /// a quintic whose slope and curvature are zero at both ends.
    fn offset_after(&self, on_m: f64) -> [f64; 2] {
        let u = ((self.gone_m + on_m) / self.span_m).clamp(0.0, 1.0);
        let share = u * u * u * (10.0 - u * (15.0 - 6.0 * u));
        let slope = 30.0 * u * u * (1.0 - u) * (1.0 - u);
        [self.from_m * (1.0 - share), -self.from_m * slope / self.span_m]
    }

    /// The second derivative of that place by metres of way.
    fn bend_after(&self, on_m: f64) -> f64 {
        -self.from_m * share_bend(self.gone_m + on_m, self.span_m)
    }
}

/// The second derivative by metres of way of a quintic from 0 to 1 over a span.
fn share_bend(gone_m: f64, span_m: f64) -> f64 {
    let u = (gone_m / span_m).clamp(0.0, 1.0);
    60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / (span_m * span_m)
}

/// A way from some offset and slope to another offset, which is kept then.
#[derive(Clone, Copy, Debug)]
struct Swerve {
    from_m: f64,
    slope: f64,
    to_m: f64,
    span_m: f64,
    gone_m: f64,
}

impl Swerve {
    /// Place to the left after some more metres of way, and its change per metre of way: a quintic without
    /// curvature at both ends and without slope at the second one.
    fn offset_after(&self, on_m: f64) -> [f64; 2] {
        let u = ((self.gone_m + on_m) / self.span_m).clamp(0.0, 1.0);
        let (square, v) = (u * u, 1.0 - u);
        let share = square * u * (10.0 - u * (15.0 - 6.0 * u));
        let share_slope = 30.0 * square * v * v;
        // As long as it goes on the way it went: u (1 - u)^3 (1 + 3 u).
        let on = u * v * v * v * (1.0 + 3.0 * u);
        let on_slope = 1.0 - square * (18.0 - u * (32.0 - 15.0 * u));
        let way = self.to_m - self.from_m;
        let rise = if u < 1.0 { self.slope * on_slope } else { 0.0 };
        [self.from_m + way * share + self.slope * self.span_m * on, way * share_slope / self.span_m + rise]
    }

    /// The second derivative of that place by metres of way.
    fn bend_after(&self, on_m: f64) -> f64 {
        let u = ((self.gone_m + on_m) / self.span_m).clamp(0.0, 1.0);
        let on_bend = -12.0 * u * (1.0 - u) * (3.0 - 5.0 * u) / self.span_m;
        let way = self.to_m - self.from_m;
        way * share_bend(self.gone_m + on_m, self.span_m) + self.slope * on_bend
    }

    /// The shortest way from an offset and slope to the middle whose sideways acceleration is bearable at a
    /// speed, metres.
    fn least_span_m(from_m: f64, slope: f64, speed_mps: f64) -> f64 {
        // The two parts of the quintic bend by at most 5.77 and 3.94 in units of the span.
        let over_m = speed_mps * (5.77 * from_m.abs() / WEARS_OFF_MPS2).sqrt();
        let turned_m = speed_mps * speed_mps * 3.94 * slope.abs() / WEARS_OFF_MPS2;
        over_m.max(turned_m).max(WEARS_OFF_S * speed_mps).max(WEARS_OFF_M)
    }
}

/// A lane change under way.
#[derive(Clone, Debug)]
pub(crate) struct LaneChange {
    transition: LateralTransition,
    passed: Option<usize>,
}

impl LaneChange {
    /// `passed`: the vehicle that was ahead.
    pub(crate) fn new(transition: LateralTransition, passed: Option<usize>) -> Self {
        Self { transition, passed }
    }

    /// Whether it has left its old lane.
    fn is_out(&self) -> bool {
        self.transition.gone_m > OUT * self.transition.span_m
    }

    /// The side it goes to.
    pub(crate) fn side(&self) -> Side {
        if self.transition.from_m > 0.0 { Side::Right } else { Side::Left }
    }

    /// The vehicle that was ahead on the old lane, as long as that is not left.
    pub(crate) fn passing(&self) -> Option<usize> {
        self.passed.filter(|_| !self.is_out())
    }
}

/// What a vehicle is off the middle of its lane.
#[derive(Debug, Default)]
pub(crate) struct Lateral {
    change: Option<LaneChange>,
    /// What it is off its way since a seam where two ways do not quite meet.
    seam: Option<Swerve>,
    /// Out of the way of what reaches into the lane, and back.
    swerve: Option<Swerve>,
}

impl Lateral {
    /// The lane change under way.
    pub(crate) fn change(&self) -> Option<&LaneChange> {
        self.change.as_ref()
    }

    /// Place to the left of the lane's middle after some more metres of way, metres, and its change per metre
    /// of way.
    pub(crate) fn offset_after(&self, on_m: f64) -> [f64; 2] {
        let change = self.change.iter().map(|c| c.transition.offset_after(on_m));
        let after = change.chain(self.swerves().map(|s| s.offset_after(on_m)));
        after.fold([0.0; 2], |sum, o| [sum[0] + o[0], sum[1] + o[1]])
    }

    fn swerves(&self) -> impl Iterator<Item = &Swerve> {
        self.seam.iter().chain(&self.swerve)
    }

    /// How its way bends to the left beside the lane's own bend, after some more metres of way, per metre.
    pub(crate) fn bend_after(&self, on_m: f64) -> f64 {
        let change = self.change.iter().map(|c| c.transition.bend_after(on_m));
        change.chain(self.swerves().map(|s| s.bend_after(on_m))).sum()
    }

    /// Way left until it goes along the lane again, metres; none where it does.
    pub(crate) fn rest_m(&self) -> Option<f64> {
        let change = self.change.iter().map(|c| c.transition.span_m - c.transition.gone_m);
        let rest = change.chain(self.swerves().map(|s| s.span_m - s.gone_m)).fold(0.0, f64::max);
        (rest > 0.0).then_some(rest)
    }

    /// Begins a lane change: places are to the left of the new lane's middle from now on.
    pub(crate) fn begin(&mut self, change: LaneChange) {
        self.change = Some(change);
        (self.seam, self.swerve) = (None, None);
    }

    /// Where it keeps to the left of the middle, or is about to, for what reaches into the lane, metres.
    pub(crate) fn kept_aside_m(&self) -> f64 {
        self.swerve.map_or(0.0, |s| s.to_m)
    }

    /// From now on keeps so far to the left of the middle, over a way of some metres.
    pub(crate) fn keep_aside(&mut self, to_m: f64, span_m: f64) {
        let [from_m, slope] = self.swerve.map_or([0.0; 2], |s| s.offset_after(0.0));
        self.swerve = Some(Swerve { from_m, slope, to_m, span_m, gone_m: 0.0 });
    }

    /// The lane goes on beside where the vehicle is, which is `left_m` left of its middle and heads away from
    /// it by so many metres per metre: what no lane change explains of that wears off.
    pub(crate) fn cross_seam(&mut self, [left_m, slope]: [f64; 2], speed_mps: f64) {
        self.seam = None;
        let [known_m, known_slope] = self.offset_after(0.0);
        let (from_m, slope) = (left_m - known_m, slope - known_slope);
        let span_m = Swerve::least_span_m(from_m, slope, speed_mps);
        self.seam = Some(Swerve { from_m, slope, to_m: 0.0, span_m, gone_m: 0.0 });
    }

    /// Goes on by some metres of way.
    pub(crate) fn advance(&mut self, step_m: f64) {
        if self.change.as_mut().is_some_and(|change| !change.transition.advance(step_m)) {
            self.change = None;
        }
        if let Some(seam) = &mut self.seam {
            seam.gone_m += step_m;
            if seam.gone_m >= seam.span_m {
                self.seam = None;
            }
        }
        if let Some(swerve) = &mut self.swerve {
            swerve.gone_m += step_m;
            if swerve.to_m == 0.0 && swerve.gone_m >= swerve.span_m {
                self.swerve = None;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swerve_goes_on_as_it_went_and_ends_along_the_lane() {
        let swerve = Swerve { from_m: 0.2, slope: 0.05, to_m: -0.6, span_m: 30.0, gone_m: 0.0 };
        let [first, last] = [0.0, 30.0].map(|on_m| swerve.offset_after(on_m));
        assert!((first[0] - 0.2).abs() < 1e-12 && (first[1] - 0.05).abs() < 1e-12, "{first:?}");
        assert!((last[0] + 0.6).abs() < 1e-12 && last[1].abs() < 1e-12, "{last:?}");
        assert_eq!(swerve.offset_after(90.0), swerve.offset_after(30.0));
        for k in 1..300 {
            let on_m = 0.1 * f64::from(k);
            let offset = |d: f64| swerve.offset_after(on_m + d)[0];
            let slope = (offset(1e-5) - offset(-1e-5)) / 2e-5;
            assert!((swerve.offset_after(on_m)[1] - slope).abs() < 1e-8, "{slope} at {on_m}");
        }
        // The bend is the slope's slope, and none at either end.
        for k in 1..60 {
            let on_m = 0.5 * f64::from(k) - 0.2;
            let bend = (swerve.offset_after(on_m + 1e-5)[1] - swerve.offset_after(on_m - 1e-5)[1]) / 2e-5;
            assert!((swerve.bend_after(on_m) - bend).abs() < 1e-7, "{bend} at {on_m}");
        }
        for on_m in [0.0, 30.0 - 1e-4] {
            let bend = (swerve.offset_after(on_m + 1e-4)[1] - swerve.offset_after(on_m)[1]) / 1e-4;
            assert!(bend.abs() < 1e-5, "{bend}");
        }
    }

    #[test]
    fn what_a_seam_leaves_wears_off_at_ease_and_goes_on_as_it_went() {
        for (left_m, slope, speed_mps) in [(0.4, 0.0, 30.0), (0.0, 0.02, 33.0), (-1.0, 0.01, 15.0)] {
            let mut lateral = Lateral::default();
            lateral.cross_seam([left_m, slope], speed_mps);
            let [first_m, first_slope] = lateral.offset_after(0.0);
            assert!((first_m - left_m).abs() < 1e-12 && (first_slope - slope).abs() < 1e-12);
            let rest_m = lateral.rest_m().expect("a way back");
            let most = (0..=400).map(|k| lateral.bend_after(rest_m * f64::from(k) / 400.0).abs());
            let most_mps2 = speed_mps * speed_mps * most.fold(0.0, f64::max);
            assert!((0.1..2.0 * WEARS_OFF_MPS2 + 0.01).contains(&most_mps2), "{most_mps2}");
            lateral.advance(rest_m);
            assert_eq!((lateral.offset_after(0.0), lateral.rest_m()), ([0.0; 2], None));
        }
    }

    #[test]
    fn the_way_over_begins_and_ends_along_the_lanes() {
        let at = |gone_m: f64| LateralTransition::new(-3.5, 40.0).offset_after(gone_m);
        assert_eq!(at(0.0), [-3.5, 0.0]);
        assert_eq!(at(40.0)[0].abs(), 0.0);
        assert!((at(20.0)[0] + 1.75).abs() < 1e-12);
        for k in 1..400 {
            let gone = 0.1 * f64::from(k);
            let slope = (at(gone + 1e-5)[0] - at(gone - 1e-5)[0]) / 2e-5;
            assert!((at(gone)[1] - slope).abs() < 1e-8, "at {gone}: {} instead of {slope}", at(gone)[1]);
            assert!((0.0..=1.875 * 3.5 / 40.0 + 1e-12).contains(&at(gone)[1]));
            let bend = (at(gone + 1e-5)[1] - at(gone - 1e-5)[1]) / 2e-5;
            let known = LateralTransition::new(-3.5, 40.0).bend_after(gone);
            assert!((known - bend).abs() < 1e-7, "at {gone}: {known} instead of {bend}");
        }
    }
}
