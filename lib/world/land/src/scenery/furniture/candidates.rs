//! Where things of the table would stand along a street.

use std::collections::BTreeMap;

use frames::OrientedRect;
use nalgebra::Point3;
use opendrive::{LaneId, LaneInfo};
use random::Stream;
use schema::ActorKind;

use super::doorways::doorway;
use super::kinds::{FURNITURE, FurnitureFront, FurnitureKind, FurniturePlace};
use super::street::{WIDE_WALK_M, street};
use crate::scenery::claims::{Candidate, Rank, rank};
use crate::scenery::draft::Draft;
use crate::scenery::forecourts::Forecourts;
use crate::scenery::frontage::{Frontage, Spot};
use crate::scenery::land::Land;
use crate::scenery::lots::House;
use crate::scenery::site::{FOOT_M, Site, reach_m};
use crate::scenery::style::FurnitureStyle;
use crate::scenery::swept::is_swept;
use crate::surfaces::{Ground, beside_edge};

/// Of such a sidewalk at least so much stays free for walkers, metres.
const CLEAR_M: f64 = 1.5;
/// Sidewalks are looked for within this distance of a thing, metres.
const WIDEST_M: f64 = 4.0;
/// From the kerb to the middle of a thing and to its near side at least, metres.
const FROM_KERB_M: f64 = 0.5;
const BEHIND_KERB_M: f64 = 0.3;
/// From the outer edge of the street to the near side of what stands beyond it, metres.
const BEYOND_M: f64 = 0.25;
/// The same of what stands on a slab, and of what stands where the grass beside the street ends, metres.
const SLAB_BEYOND_M: f64 = 0.1;
const YARD_M: f64 = 3.3;
/// Slabs stand out of the ground at the street by so much, metres.
const SLAB_OUT_M: f64 = 0.02;
/// What is deeper than this looks at the road where it stands beyond the outer edge, metres.
const DEEP_M: f64 = 1.0;
/// Around a thing at the kerb so much is sidewalk, too, metres, and the kerb turns from its street by so much
/// at most, as a sine.
const MARGIN_M: f64 = 0.15;
const ASKEW: f64 = 0.05;
/// What is higher than this hides people from drivers, metres.
const LOW_M: f64 = 0.8;
/// Such things at the kerb keep this far from crosswalks and from where a street meets another one; others
/// and what stands beyond the sidewalk keep less, metres.
const SIGHT_M: f64 = 10.0;
const LOW_SIGHT_M: f64 = 3.0;
const END_M: f64 = 3.0;
/// The ground under an upright thing differs by so much at most, metres; under a row, which leans with the
/// street, by so much of its length.
const LEVEL_M: f64 = 0.16;
const STEEPEST: f64 = 0.12;
/// A thing is at most so much lower or higher than the edge of the street, metres.
const STEP_M: f64 = 1.0;
/// Things at least so long lean with the street, if they are narrow, metres.
const ROW_M: f64 = 3.0;
const NARROW_M: f64 = 0.5;

/// A thing that would stand somewhere.
pub(super) struct Thing {
    pub(super) kind: &'static FurnitureKind,
    pub(super) size_m: [f64; 3],
    pub(super) z_m: f64,
    pub(super) roll_rad: f64,
    pub(super) yaw_rad: f64,
    pub(super) variant: u32,
}

impl Thing {
    pub(super) fn draft(&self, [x, y]: [f64; 2]) -> Draft {
        let Self { kind, size_m, z_m, roll_rad, yaw_rad, variant } = *self;
        let mut draft = Draft::new(kind.actor_kind(), kind.model, kind.tag, size_m, [x, y, z_m], yaw_rad);
        draft.tags.extend(kind.also);
        draft.rpy_rad = [roll_rad, 0.0, yaw_rad];
        draft.variant = variant;
        draft
    }
}

/// The place of a thing before it is known whether it fits.
pub(super) struct Wanted<'a> {
    /// Number and kind.
    pub(super) kind: (usize, &'static FurnitureKind),
    pub(super) front: &'a Frontage,
    pub(super) along_m: f64,
    /// Middle beyond the outer edge, metres.
    pub(super) beyond_m: f64,
    pub(super) variant: u32,
    pub(super) slot: u64,
}

/// What placing a thing looks at.
pub(super) struct Placer<'a> {
    pub(super) site: &'a Site<'a>,
    pub(super) land: &'a Land<'a>,
    paved: &'a Forecourts,
    /// Ways to doors.
    ways: Land<'a>,
    /// Corners of crosswalks.
    crosswalks: Vec<Point3<f64>>,
    style: FurnitureStyle,
}

impl<'a> Placer<'a> {
    pub(super) fn new(
        site: &'a Site<'a>,
        (houses, paved): (&[Candidate<House<'_>>], &'a Forecourts),
        land: &'a Land<'a>,
    ) -> Self {
        let mut ways = land.without_things();
        houses.iter().for_each(|house| ways.take(doorway(house)));
        let corners = site.map.crosswalks().iter().flat_map(|crosswalk| &crosswalk.polygon);
        let near = |p: &&Point3<f64>| site.near(p.x, p.y, 2.0 * reach_m::FURNITURE + SIGHT_M);
        Self {
            site,
            land,
            paved,
            ways,
            crosswalks: corners.filter(near).copied().collect(),
            style: site.style(),
        }
    }

    /// The kinds that the town has, with their numbers.
    pub(super) fn kinds(&self) -> impl Iterator<Item = (usize, &'static FurnitureKind)> + use<> {
        let style = self.style;
        FURNITURE
            .iter()
            .enumerate()
            .filter(move |(_, kind)| kind.style == FurnitureStyle::Any || kind.style == style)
    }

    /// A kind's own numbers for a side of a road.
    pub(super) fn stream(&self, kind: &FurnitureKind, entity: u64) -> Stream {
        Stream::new(self.site.rules.seed, 0, kind.model, entity)
    }

    /// Decides between candidates: lines and rails come first, then what is large.
    pub(super) fn rank(&self, wanted: &Wanted<'_>) -> Rank {
        let (number, kind) = wanted.kind;
        let slot = (number as u64) << 32 | wanted.slot;
        let (draw, entity, slot) =
            rank(self.site.rules.seed, "world/furniture/kinds/rank", wanted.front.entity, slot);
        let class = match kind.place {
            FurniturePlace::Rail(_) => 3,
            FurniturePlace::Line { .. } => 2,
            _ if kind.size_m[0] * kind.size_m[1] > 1.0 => 1,
            _ => 0,
        };
        (draw >> 2 | class << 30, entity, slot)
    }

    /// Things of a kind at random distances along a side of a road.
    pub(super) fn along(
        &self,
        kind: (usize, &'static FurnitureKind),
        front: &Frontage,
        candidates: &mut Vec<Candidate<Thing>>,
    ) {
        let most = kind.1.often.into_iter().fold(0.0, f64::max);
        if most <= 0.0 || (kind.1.place == FurniturePlace::Parking && !front.traffic.parks) {
            return;
        }
        let mut random = self.stream(kind.1, front.entity);
        let apart_m = 1000.0 / (most * self.site.rules.density);
        let mut along_m = random.uniform(0.0, apart_m);
        for slot in 0.. {
            if along_m >= front.length_m() {
                break;
            }
            let (chance, variant, share) =
                (random.unit(), random.next_u32() % kind.1.variants, random.unit());
            let here_m = along_m;
            along_m += apart_m * random.uniform(0.5, 1.5);
            let Some(spot) = front.at(here_m) else { break };
            if chance * most >= kind.1.often[street(&spot)] {
                continue;
            }
            let Some(beyond_m) = self.beyond_m(kind.1, &spot, share) else { continue };
            let wanted = Wanted { kind, front, along_m: here_m, beyond_m, variant, slot };
            candidates.extend(self.candidate(&wanted, &spot));
        }
    }

    /// How far beyond the outer edge the middle of a thing would be; none where there is no place for it.
    fn beyond_m(&self, kind: &FurnitureKind, spot: &Spot, share: f64) -> Option<f64> {
        let half_m = 0.5 * extent_m(kind, kind.front)[0];
        let from_kerb_m = FROM_KERB_M.max(BEHIND_KERB_M + half_m);
        let has_room = spot.walk_m >= WIDE_WALK_M && spot.walk_m - from_kerb_m - half_m >= CLEAR_M;
        let at_kerb = has_room.then_some(from_kerb_m - spot.walk_m);
        match kind.place {
            FurniturePlace::Kerb => at_kerb,
            FurniturePlace::KerbOrBeyond | FurniturePlace::Parking => {
                Some(at_kerb.unwrap_or_else(|| beyond_edge_m(kind)))
            }
            FurniturePlace::Verge([from, to]) => Some(from + share * (to - from)),
            _ => Some(beyond_edge_m(kind)),
        }
    }

    /// A thing at a place, if it may stand there.
    pub(super) fn candidate(&self, wanted: &Wanted<'_>, spot: &Spot) -> Option<Candidate<Thing>> {
        let kind = wanted.kind.1;
        let at = spot.beside(wanted.beyond_m, 0.0);
        if !self.site.near(at.x, at.y, reach_m::FURNITURE) {
            return None;
        }
        let front = front_at(kind, wanted.beyond_m);
        let [_, width_m] = extent_m(kind, front);
        let yaw_rad = match front {
            FurnitureFront::Road => spot.facing_yaw(),
            FurnitureFront::Traffic => spot.facing_traffic_rad(wanted.front),
        };
        let rect = OrientedRect::new([at.x, at.y], yaw_rad, [0.5 * kind.size_m[0], 0.5 * kind.size_m[1]]);
        let stands = if wanted.beyond_m < 0.0 {
            self.stands_at_kerb(wanted, spot, &rect, width_m)
        } else {
            self.stands_beyond(wanted, &rect, width_m)
        };
        if !stands {
            return None;
        }
        let (z_m, roll_rad) = self.on_the_ground(kind, wanted, spot, &rect)?;
        // Arms and flags are overhead.
        let takes =
            if kind.model.starts_with("pole.") { OrientedRect { half_m: [FOOT_M; 2], ..rect } } else { rect };
        let size_m = kind.size_m;
        let what = Thing { kind, size_m, z_m, roll_rad, yaw_rad, variant: wanted.variant };
        Some(Candidate { takes, needs: takes, rank: self.rank(wanted), what })
    }

    /// Whether a thing lies on a sidewalk alone, off the ways of long vehicles, and hides nobody who crosses.
    fn stands_at_kerb(&self, wanted: &Wanted<'_>, spot: &Spot, rect: &OrientedRect, width_m: f64) -> bool {
        let sight_m = if wanted.kind.1.size_m[2] > LOW_M { SIGHT_M } else { LOW_SIGHT_M };
        let end_m = wanted.along_m.min(wanted.front.length_m() - wanted.along_m);
        let reach_m = 0.5 * width_m;
        let [x, y] = rect.centre_m;
        let off_m = |p: &Point3<f64>| ((p.x - x) * (p.x - x) + (p.y - y) * (p.y - y)).sqrt();
        if end_m < sight_m + reach_m || self.crosswalks.iter().any(|p| off_m(p) < sight_m + reach_m) {
            return false;
        }
        // Where a lane widens the kerb runs askew.
        let around = [-1.0, 1.0].map(|side| wanted.front.at(wanted.along_m + side * (reach_m + 1.0)));
        let [Some(before), Some(after)] = around else { return false };
        let way = after.point - before.point;
        if way.dot(&spot.away).abs() > ASKEW * way.norm() {
            return false;
        }
        let with_margin = rect.grown(MARGIN_M);
        self.land.unused(rect)
            && self.leaves_room(spot, rect)
            && shares().all(|[u, v]| {
                let [x, y] = with_margin.at(u, v);
                let level = |z: f64| (z - spot.point.z).abs() < STEP_M;
                let mut here = self.site.levels().cover.at(x, y).filter(|(_, z)| level(*z)).peekable();
                here.peek().is_some()
                    && here.all(|(facet, _)| facet.ground == Ground::Walk)
                    && !is_swept(self.site.map, Point3::new(x, y, spot.point.z), 0.05)
            })
    }

    /// Whether walkers have room beside a thing, as the map says it.
    fn leaves_room(&self, spot: &Spot, rect: &OrientedRect) -> bool {
        let mut reached: BTreeMap<LaneId, [f64; 3]> = BTreeMap::new();
        for [u, v] in shares() {
            let [x, y] = rect.at(u, v);
            let walks = |lane: &LaneInfo| lane.lane_type.is_walkable();
            for hit in self.site.map.lanes_within(Point3::new(x, y, spot.point.z), WIDEST_M, walks) {
                if hit.is_inside() {
                    let [low, high, _] =
                        *reached.entry(hit.lane).or_insert([f64::INFINITY, f64::NEG_INFINITY, 0.0]);
                    reached.insert(hit.lane, [low.min(hit.t_m), high.max(hit.t_m), hit.width_m]);
                }
            }
        }
        reached.values().all(|[low, high, width]| (0.5 * width - high).max(0.5 * width + low) >= CLEAR_M)
    }

    /// Whether a thing lies on free land, before no door.
    fn stands_beyond(&self, wanted: &Wanted<'_>, rect: &OrientedRect, width_m: f64) -> bool {
        let end_m = wanted.along_m.min(wanted.front.length_m() - wanted.along_m);
        end_m >= END_M + 0.5 * width_m
            && self.land.free(rect)
            && (matches!(wanted.kind.1.place, FurniturePlace::Line { .. }) || self.ways.unused(rect))
    }

    /// How high a thing stands, and how it leans along the street; none where the ground is not level enough.
    fn on_the_ground(
        &self,
        kind: &FurnitureKind,
        wanted: &Wanted<'_>,
        spot: &Spot,
        rect: &OrientedRect,
    ) -> Option<(f64, f64)> {
        let height = |u: f64, v: f64| {
            let [x, y] = rect.at(u, v);
            self.height_m(wanted.front, wanted.along_m, spot, [x, y])
        };
        let middle_m = height(0.0, 0.0);
        if (middle_m - spot.point.z).abs() > STEP_M {
            return None;
        }
        let [depth_m, width_m, _] = kind.size_m;
        if width_m >= ROW_M && depth_m <= NARROW_M {
            let rise_m = height(0.0, 1.0) - height(0.0, -1.0);
            let leans = rise_m.abs() <= STEEPEST * width_m;
            return leans.then(|| (middle_m, frames::math::atan2(rise_m, width_m)));
        }
        if kind.model.starts_with("pole.") {
            return Some((middle_m, 0.0));
        }
        let heights = shares().map(|[u, v]| height(u, v));
        let (low, high) =
            heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
        if kind.foot_m > 0.0 {
            let z_m = high + SLAB_OUT_M - kind.foot_m;
            return (z_m <= low).then_some((z_m, 0.0));
        }
        (high - low <= LEVEL_M).then_some((low, 0.0))
    }

    /// The height of the ground on a sidewalk or beside the edge of a road.
    pub(super) fn height_m(&self, front: &Frontage, along_m: f64, spot: &Spot, [x, y]: [f64; 2]) -> f64 {
        if let Some(paved_m) = self.paved.height(x, y) {
            return paved_m;
        }
        let land_m = self.site.levels().height(x, y, spot.point.z);
        let off = Point3::new(x, y, spot.point.z) - spot.point;
        let beyond_m = off.dot(&spot.away);
        if beyond_m <= 0.0 {
            return land_m;
        }
        // The edge climbs along the street.
        let [before, after] = [-2.0, 2.0].map(|by| front.at(along_m + by).map(|spot| spot.point));
        let climb_m = before.zip(after).map_or(0.0, |(before, after)| {
            let way = after - before;
            let flat = way.xy().norm_squared();
            if flat > 0.01 { way.z * way.xy().dot(&off.xy()) / flat } else { 0.0 }
        });
        beside_edge(land_m, spot.point.z + climb_m, beyond_m)
    }
}

/// Places all over a rectangle, as shares of its half sides.
fn shares() -> impl Iterator<Item = [f64; 2]> {
    let steps = [-1.0, -0.5, 0.0, 0.5, 1.0];
    [-1.0, 0.0, 1.0].into_iter().flat_map(move |u| steps.into_iter().map(move |v| [u, v]))
}

/// How far beyond the outer edge the middle of a kind is that stands next to it, metres.
pub(super) fn beyond_edge_m(kind: &FurnitureKind) -> f64 {
    let near_m = match kind.place {
        FurniturePlace::Yard(_) => YARD_M,
        _ if kind.foot_m > 0.0 => SLAB_BEYOND_M,
        _ => BEYOND_M,
    };
    near_m + 0.5 * extent_m(kind, front_at(kind, near_m))[0]
}

/// Which way a thing looks that stands so far beyond the outer edge, metres.
fn front_at(kind: &FurnitureKind, beyond_m: f64) -> FurnitureFront {
    let is_deep = kind.size_m[1] > DEEP_M && kind.actor_kind() == ActorKind::Prop;
    let is_near = beyond_m > 0.0 && !matches!(kind.place, FurniturePlace::Verge(_));
    if is_near && is_deep { FurnitureFront::Road } else { kind.front }
}

/// How far a thing that looks some way reaches across the street and along it, metres.
pub(super) fn extent_m(kind: &FurnitureKind, front: FurnitureFront) -> [f64; 2] {
    let [x, y, _] = kind.size_m;
    if front == FurnitureFront::Road { [x, y] } else { [y, x] }
}
