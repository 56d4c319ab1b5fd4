//! Groups that stand and talk when a scene begins: two face each other, three stand in a ring.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use frames::math::{atan2, cos, sin};
use nalgebra::Point3;

use crate::walking::crowd::Crowd;
use crate::walking::fixtures::Fixtures;
use crate::walking::paths::Paths;
use crate::walking::waiting::WaitingPlace;

/// Two stand across the way, along it, or anything between.
pub(crate) const TURNS_RAD: [f64; 2] = [-FRAC_PI_2, FRAC_PI_2];

/// Between the circles about those who talk, metres, and the least of it where the way bends.
const GAP_M: f64 = 0.25;
const LEAST_GAP_M: f64 = 0.15;
/// The ring is moved along the way by up to half as many half metres to where there is room.
const TRIES: u32 = 60;

/// Places for a group of some size about a place where people wait, all on its way and looking at one
/// another, the first of them at an angle from the way's direction; none where there is no room for all.
/// `radius_m` is the largest of theirs.
pub(crate) fn ring(
    paths: &Paths,
    fixtures: &Fixtures,
    crowd: &Crowd,
    middle: &WaitingPlace,
    (size, radius_m, turn_rad): (usize, f64, f64),
) -> Option<Vec<WaitingPlace>> {
    let ring_m = (2.0 * radius_m + GAP_M) / (2.0 * sin(PI / size.max(2) as f64));
    let length_m = paths.ways[middle.way].length_m;
    let shifts = (0..TRIES).map(|i| 0.5 * f64::from(i.div_ceil(2)) * if i % 2 == 0 { 1.0 } else { -1.0 });
    shifts.map(|shift_m| middle.along_m + shift_m).find_map(|along_m| {
        let room_m = paths.room_m(middle.way, along_m).max(1e-3);
        // Two turn along the way where that is narrow.
        let share = (room_m / ring_m).min(1.0);
        let most_rad = if size == 2 { atan2(share, (1.0 - share * share).sqrt()) } else { PI };
        let first_rad = turn_rad.clamp(-most_rad, most_rad);
        let turns: Vec<f64> = (0..size).map(|k| first_rad + TAU * k as f64 / size as f64).collect();
        let reach_m = turns.iter().map(|turn| ring_m * sin(*turn).abs()).fold(0.0, f64::max);
        let inside_m = room_m + 1e-9 - reach_m;
        if inside_m < 0.0 {
            return None;
        }
        let left_m = (middle.share * room_m).clamp(-inside_m, inside_m);
        let mut places: Vec<WaitingPlace> = turns
            .iter()
            .map(|turn| WaitingPlace {
                along_m: along_m + ring_m * cos(*turn),
                share: (left_m + ring_m * sin(*turn)) / room_m,
                ..*middle
            })
            .collect();
        let points: Vec<Point3<f64>> =
            places.iter().map(|p| paths.point(p.way, p.along_m, p.share).0).collect();
        let free = (0..size).all(|k| {
            let apart = |p: &Point3<f64>| (p - points[k]).xy().norm() > 2.0 * radius_m + LEAST_GAP_M;
            (0.0..=length_m).contains(&places[k].along_m)
                && points[..k].iter().all(apart)
                && crowd.is_free(points[k], radius_m, fixtures)
        });
        let mean = points.iter().fold(Point3::origin(), |sum, p| sum + p.coords / size as f64);
        for (place, point) in places.iter_mut().zip(&points) {
            place.yaw_rad = atan2(mean.y - point.y, mean.x - point.x);
        }
        free.then_some(places)
    })
}
