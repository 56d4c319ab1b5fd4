//! Contacts between vehicles, people and obstacles.

use std::collections::{BTreeMap, BTreeSet};

use frames::math::sin_cos;

use super::film::{Body, Film, Snap};

/// Walkers that touch one another by less than this do not, and vehicles that miss something by less do
/// touch: rounding, and what the solver keeps free between bodies that push each other, metres.
const ROUNDING_M: f64 = 0.02;
/// Wrecks push people and vehicles nearer than this, metres.
const PUSHED_M: f64 = 0.1;
/// Side of a cell, metres: more than the longest body.
const CELL_M: f64 = 16.0;

/// Pairs that touch at some time, each counted once.
#[derive(Debug, Default)]
pub(crate) struct Touching {
    /// Two ordinary drivers, neither of whom had touched anything before: (state, ids).
    pub(crate) ordinary: Vec<(usize, u16, u16)>,
    /// Vehicles of which one is driven recklessly or absently, or had crashed before.
    pub(crate) unruly: usize,
    /// Ordinary vehicles, not crashed before, and walkers.
    pub(crate) vehicle_walker: Vec<(usize, u16, u16)>,
    /// Ordinary vehicles, not crashed before, and the objects in hazards, people too.
    pub(crate) hazards: Vec<(usize, u16, u16)>,
    /// Walkers and other walkers.
    pub(crate) walker_walker: usize,
}

/// Whether two footprints overlap (separating axes in the plane), decks apart.
fn touch((sa, a_m): (Snap, [f64; 2]), (sb, b_m): (Snap, [f64; 2]), margin_m: f64) -> bool {
    if (sa.at.z - sb.at.z).abs() > 3.0 {
        return false;
    }
    let away = sb.at - sa.at;
    [
        sa.yaw_rad,
        sa.yaw_rad + std::f64::consts::FRAC_PI_2,
        sb.yaw_rad,
        sb.yaw_rad + std::f64::consts::FRAC_PI_2,
    ]
    .iter()
    .all(|&axis| {
        let reach = |yaw: f64, size: [f64; 2]| {
            let (sin, cos) = sin_cos(yaw - axis);
            0.5 * (size[0] * cos.abs() + size[1] * sin.abs())
        };
        let (sin, cos) = sin_cos(axis);
        (away.x * cos + away.y * sin).abs() < reach(sa.yaw_rad, a_m) + reach(sb.yaw_rad, b_m) + margin_m
    })
}

/// Finds all pairs, and notes in the film when each first touched something.
pub(crate) fn find(film: &mut Film<'_>) -> Touching {
    let mut result = Touching::default();
    let mut seen: BTreeSet<(u16, u16)> = BTreeSet::new();
    let count = film.vehicles.len();
    for i in 0..film.states {
        let mut cells: BTreeMap<(i32, i32), Vec<usize>> = BTreeMap::new();
        let (mut pairs, mut pushed) = (Vec::new(), Vec::new());
        let all: Vec<&Body> = film.vehicles.iter().chain(&film.walkers).collect();
        let at = |body: &Body| (body.track[i], body.size_m);
        for (n, body) in all.iter().enumerate() {
            let here = body.track[i].at;
            let (x, y) = ((here.x / CELL_M).floor() as i32, (here.y / CELL_M).floor() as i32);
            for other in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (x + dx, y + dy))) {
                for &m in cells.get(&other).into_iter().flatten() {
                    if body.is_coupled(all[m]) {
                        continue;
                    }
                    let near =
                        (all[m].track[i].at - here).norm() < 0.6 * (all[m].size_m[0] + body.size_m[0] + 2.0);
                    let margin_m = if m < count { ROUNDING_M } else { -ROUNDING_M };
                    if near && touch(at(body), at(all[m]), margin_m) && seen.insert((all[m].id, body.id)) {
                        pairs.push((m, n));
                    }
                    let wrecked =
                        body.is_wrecked(i) || all[m].is_wrecked(i) || !body.ordinary || !all[m].ordinary;
                    if near && m < count && n < count && wrecked && touch(at(body), at(all[m]), PUSHED_M) {
                        pushed.extend([m, n]);
                    }
                }
            }
            cells.entry((x, y)).or_default().push(n);
        }
        for &(m, n) in &pairs {
            let (a, b) = (all[m], all[n]);
            let innocent = |body: &Body| body.ordinary && body.touched.is_none_or(|t| t >= i);
            match (m < count, n < count) {
                (true, true) if innocent(a) && innocent(b) => result.ordinary.push((i, a.id, b.id)),
                (true, true) => result.unruly += 1,
                (false, false) => result.walker_walker += 1,
                _ if innocent(if m < count { a } else { b }) => result.vehicle_walker.push((i, a.id, b.id)),
                _ => result.unruly += 1,
            }
        }
        let mut struck = Vec::new();
        for (n, body) in film.vehicles.iter().enumerate() {
            for thing in &film.obstacles {
                let reach = 0.6 * (body.size_m[0] + thing.size_m[0] + 2.0);
                let near = (thing.snap.at - body.track[i].at).norm() < reach;
                let touches = near && touch(at(body), (thing.snap, thing.size_m), -ROUNDING_M);
                if touches && seen.insert((body.id, thing.id)) {
                    match body.ordinary && body.touched.is_none_or(|t| t >= i) {
                        true => result.hazards.push((i, body.id, thing.id)),
                        false => result.unruly += 1,
                    }
                    struck.push(n);
                }
            }
        }
        let touched = pairs.into_iter().filter(|&(m, _)| m < count).flat_map(|(m, n)| [m, n]);
        for n in touched.chain(pushed).chain(struck) {
            let body = if n < count { film.vehicles.get_mut(n) } else { film.walkers.get_mut(n - count) };
            if let Some(body) = body {
                body.touched.get_or_insert(i);
            }
        }
    }
    result
}
