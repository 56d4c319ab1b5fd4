//! Parked vehicles that reach into lanes, and how much of the lane they leave.

use std::collections::BTreeMap;

use nalgebra::Point3;

use crate::outline::outline;
use crate::road::net::Net;

/// A vehicle that reaches less far into a lane than this is beside it, metres.
const REACHES_M: f64 = 0.02;
/// Vehicles that pass go over the other edge of their lane by this at most, metres.
const OVER_EDGE_M: f64 = 0.3;
/// Room that they need on either side, and that they leave where there is so much, metres.
const LEAST_ASIDE_M: f64 = 0.1;
const ASIDE_M: f64 = 0.4;

/// A length of lane beside a parked vehicle that reaches into it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Intrusion {
    /// From and to, metres along the lane.
    pub(crate) along_m: [f64; 2],
    /// The right and the left end of what is left to drive on, metres left of the lane's middle.
    strip_m: [f64; 2],
}

impl Intrusion {
    /// Whether a vehicle of a width gets past.
    pub(crate) fn lets_by(&self, width_m: f64) -> bool {
        self.strip_m[1] - self.strip_m[0] >= width_m + 2.0 * LEAST_ASIDE_M
    }

    /// Where the middle of a vehicle of a width may be that gets past: the rightmost and the leftmost place,
    /// metres left of the lane's middle.
    pub(crate) fn room_m(&self, width_m: f64) -> [f64; 2] {
        let [right, left] = self.strip_m;
        let half_m = 0.5 * (left - right).min(width_m + 2.0 * ASIDE_M);
        [right + half_m, left - half_m]
    }
}

/// All of them, by lane.
#[derive(Debug, Default)]
pub(crate) struct Kerbside(BTreeMap<usize, Vec<Intrusion>>);

impl Kerbside {
    /// Adds a parked vehicle, if it reaches into a lane.
    pub(crate) fn add(&mut self, net: &Net, at: &Point3<f64>, yaw_rad: f64, size_m: [f64; 3]) {
        // For each lane where along it and across it, and half its width.
        let mut covered: BTreeMap<usize, ([f64; 2], [f64; 2], f64)> = BTreeMap::new();
        for point in outline(*at, yaw_rad, size_m) {
            for (lane, along_m) in net.lanes_at(&point, 0.0) {
                let place = net.lanes[lane].centre.place(along_m);
                let left_m = place.local(&point)[1];
                let entry = covered.entry(lane).or_insert(([along_m; 2], [left_m; 2], 0.5 * place.width_m));
                for (range, value) in [(&mut entry.0, along_m), (&mut entry.1, left_m)] {
                    *range = [range[0].min(value), range[1].max(value)];
                }
                entry.2 = entry.2.min(0.5 * place.width_m);
            }
        }
        for (lane, (along_m, [right, left], half)) in covered {
            if right > half - REACHES_M || left < REACHES_M - half {
                continue;
            }
            // What it leaves to its right, and to its left.
            let strips = [[-half - OVER_EDGE_M, right], [left, half + OVER_EDGE_M]];
            let wider = usize::from(strips[1][1] - strips[1][0] > strips[0][1] - strips[0][0]);
            self.0.entry(lane).or_default().push(Intrusion { along_m, strip_m: strips[wider] });
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Those on a lane.
    pub(crate) fn on_lane(&self, lane: usize) -> &[Intrusion] {
        self.0.get(&lane).map_or(&[], Vec::as_slice)
    }

    /// Those on a lane that a vehicle of a width cannot pass: where their middles are, and half their
    /// lengths, metres.
    pub(crate) fn blocking(&self, lane: usize, width_m: f64) -> impl Iterator<Item = (f64, f64)> {
        let all = self.on_lane(lane).iter().filter(move |i| !i.lets_by(width_m));
        all.map(|i| (0.5 * (i.along_m[0] + i.along_m[1]), 0.5 * (i.along_m[1] - i.along_m[0])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The intrusions of a parked vehicle on the lanes of a straight road: -1 is from 0 to -3.5, +1 from 0 to
    /// 3.5.
    fn around(at: [f64; 2], yaw_rad: f64) -> (Net, Kerbside) {
        let net = Net::new(&testkit::straight(300.0));
        let mut kerbside = Kerbside::default();
        kerbside.add(&net, &Point3::new(at[0], at[1], 0.0), yaw_rad, [4.0, 2.0, 1.5]);
        (net, kerbside)
    }

    #[test]
    fn what_a_parked_car_leaves_of_the_lane_is_known() {
        // From -2.9 to -4.9: 0.6 m of the right lane.
        let (net, kerbside) = around([100.0, -3.9], 0.0);
        let lane = net.lanes_at(&Point3::new(100.0, -1.75, 0.0), 0.0)[0].0;
        let [found] = kerbside.on_lane(lane) else { panic!("{kerbside:?}") };
        for (got, wanted) in found.along_m.iter().chain(&found.strip_m).zip([98.0, 102.0, -1.15, 2.05]) {
            assert!((got - wanted).abs() < 1e-6, "{found:?}");
        }
        // 3.2 m: a vehicle of 2 m keeps 0.4 m off, one of 2.8 m as much on either side, one of 3.1 m does not
        // get by.
        for (width_m, room_m) in [(2.0, [0.25, 0.65]), (2.8, [0.45, 0.45])] {
            assert!(found.lets_by(width_m));
            let got = found.room_m(width_m);
            assert!(got.iter().zip(room_m).all(|(a, b)| (a - b).abs() < 1e-6), "{got:?}");
        }
        assert!(!found.lets_by(3.1) && kerbside.blocking(lane, 3.1).count() == 1);
        assert_eq!(kerbside.0.len(), 1);
    }

    #[test]
    fn who_stands_beside_lanes_is_in_nobodys_way_and_who_stands_on_one_leaves_the_wider_side() {
        assert!(around([100.0, -4.51], 0.0).1.is_empty());
        let (net, kerbside) = around([100.0, -1.25], std::f64::consts::FRAC_PI_2);
        // Across the road, from 0.75 to -3.25.
        let lane = net.lanes_at(&Point3::new(100.0, -1.75, 0.0), 0.0)[0].0;
        let [found] = kerbside.on_lane(lane) else { panic!("{kerbside:?}") };
        assert!(!found.lets_by(0.7) && (found.along_m[1] - found.along_m[0] - 2.0).abs() < 0.5, "{found:?}");
        assert_eq!(kerbside.0.len(), 2);
    }
}
