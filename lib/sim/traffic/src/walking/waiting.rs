//! Places where people stand and wait: at the kerb before a crosswalk, beside a bench, before a building.

use catalogue::benches;
use frames::{Object, Pose, World};
use nalgebra::{Point3, Vector2};
use random::Stream;
use schema::ActorKind;
use schema::tables::ActorRow;

use crate::grid::Grid;
use crate::walking::paths::Paths;
use crate::walking::seats::{self, Seat};

/// Pedestrians wait within this distance of where they were to start, metres.
const WITHIN_M: f64 = 60.0;
/// A building's front and a bench are within this distance of the way, metres.
const FRONT_M: f64 = 8.0;
const BENCH_M: f64 = 3.0;
/// How far across the way people stand, as a share of the free width: at the kerb, at the wall.
const AT_KERB: f64 = 0.8;
const AT_WALL: f64 = 0.95;
/// Those at a wall look this far to the sides at most, radians.
const LOOK_RAD: f64 = 1.0;

/// A place to wait.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WaitingPlace {
    pub(crate) way: usize,
    pub(crate) along_m: f64,
    /// Share of the free width left of the way's middle, -1 to 1.
    pub(crate) share: f64,
    /// Where people look there.
    pub(crate) yaw_rad: f64,
    /// The bench that it is beside, by number.
    pub(crate) bench: Option<usize>,
}

/// All of them.
#[derive(Debug)]
pub(crate) struct WaitingPlaces {
    places: Vec<WaitingPlace>,
    grid: Grid,
    benches: Vec<[Seat; 2]>,
}

impl WaitingPlaces {
    /// Those that a map has, and the objects beside its roads.
    pub(crate) fn new(paths: &Paths, fixed: &[ActorRow]) -> Self {
        let mut places: Vec<WaitingPlace> = Vec::new();
        for crossing in &paths.crossings {
            for side in 0..2 {
                let (way, along_m) = crossing.doors[side];
                let over = crossing.ends[1 - side] - crossing.ends[side];
                let left_m = paths.ways[way].cross(crossing.ends[side], along_m).1;
                let share = AT_KERB * left_m.signum();
                places.push(WaitingPlace { way, along_m, share, yaw_rad: heading(&over.xy()), bench: None });
            }
        }
        let mut benches = Vec::new();
        let waited_at = fixed.iter().filter_map(|actor| {
            let half_m = 0.5 * (actor.length_m.max(actor.width_m));
            match actor.kind {
                ActorKind::Building => Some((actor, half_m + FRONT_M)),
                ActorKind::Prop if actor.model == benches::MODEL => Some((actor, half_m + BENCH_M)),
                _ => None,
            }
        });
        for (actor, within_m) in waited_at {
            let middle = Point3::from(actor.xyz_m);
            let Some((way, along_m)) = paths.nearest(&middle, within_m) else { continue };
            let left_m = paths.ways[way].cross(middle, along_m).1;
            let out = paths.ways[way].place(along_m).point - middle;
            let pose = Pose::<World, Object>::from_xyz_wxyz(actor.xyz_m, actor.quaternion);
            // A building's long walls look along the way; beside a bench one stands next to its end.
            let aside_m = if actor.kind == ActorKind::Prop { 0.5 * actor.width_m + 0.6 } else { 0.0 };
            let along_m = (along_m + aside_m * frames::math::cos(pose.yaw()).signum())
                .clamp(0.0, paths.ways[way].length_m);
            let share = AT_WALL * left_m.signum();
            let bench = (actor.kind == ActorKind::Prop).then(|| {
                benches.push(seats::on_bench(actor, &pose));
                benches.len() - 1
            });
            places.push(WaitingPlace { way, along_m, share, yaw_rad: heading(&out.xy()), bench });
        }
        let mut grid = Grid::new(WITHIN_M);
        let at = |p: &WaitingPlace| paths.ways[p.way].place(p.along_m).point;
        grid.fill(places.iter().enumerate().map(|(i, p)| ([at(p).x, at(p).y], i)));
        Self { places, grid, benches }
    }

    /// One of those around a place, each as likely; where there is none, at the edge of the way there.
    pub(crate) fn draw(
        &self,
        paths: &Paths,
        (way, along_m): (usize, f64),
        draw: &mut Stream,
    ) -> WaitingPlace {
        let (at, heading_rad) = paths.point(way, along_m, 0.0);
        let near = |i: &usize| {
            let place = &self.places[*i];
            (paths.ways[place.way].place(place.along_m).point - at).norm() < WITHIN_M
        };
        let around: Vec<usize> = self.grid.around(at.x, at.y).filter(near).collect();
        let turn_rad = draw.uniform(-LOOK_RAD, LOOK_RAD);
        let chosen = draw.choose(&around).map(|i| self.places[*i]);
        let mut place = chosen.unwrap_or_else(|| {
            let share = if draw.chance(0.5) { AT_WALL } else { -AT_WALL };
            // Towards the middle.
            let yaw_rad = heading_rad - share.signum() * std::f64::consts::FRAC_PI_2;
            WaitingPlace { way, along_m, share, yaw_rad, bench: None }
        });
        place.yaw_rad = frames::wrap_pi(place.yaw_rad + turn_rad);
        place
    }
}

impl WaitingPlaces {
    /// The seats of the bench that a place is beside.
    pub(crate) fn seats(&self, place: &WaitingPlace) -> &[Seat] {
        place.bench.and_then(|bench| self.benches.get(bench)).map_or(&[], |seats| seats)
    }
}

fn heading(v: &Vector2<f64>) -> f64 {
    frames::math::atan2(v.y, v.x)
}
