//! The lining of a cabin: floor, sides up to the windows, pillars and roof, seen from inside; open where
//! panes are.

use crate::solids::MeshBuilder;
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use super::plan::Plan;
use super::room::Room;
use crate::actors::skin::Place;

/// From where to where a pane of its own reaches between roof and deck, as shares of the way down.
pub(crate) const REAR_PANE: [f32; 2] = [0.25, 0.68];
/// Rows of the sides and columns of the roof that it is cut at.
const ROWS: [f32; 3] = [1.06, 1.9, 2.0];
const COLUMNS: [f32; 2] = [0.93, 0.0];

/// Adds the lining; `pane` says where the skin is one, at a place along it, on the left or on the right.
pub(super) fn lining(
    b: &mut MeshBuilder,
    room: &Room<'_>,
    plan: &Plan,
    stuff: impl Fn(Surface, [f32; 3]) -> MeshPart,
    pane: &dyn Fn(f32, Place, bool) -> bool,
) {
    let carpet = stuff(Surface::Cloth, [0.022, 0.022, 0.023]);
    let dark = stuff(Surface::Plain, [0.045, 0.044, 0.043]);
    let roof = stuff(Surface::Cloth, [0.16, 0.155, 0.15]);
    let stations = stations(room, plan);
    let rings: Vec<[Vec<Vec3>; 2]> =
        stations.iter().map(|f| [true, false].map(|left| half_ring(room, plan, *f, left))).collect();
    for (pair, f) in rings.windows(2).zip(stations.windows(2)) {
        let f = 0.5 * (f[0] + f[1]);
        for (side, left) in [(0, true), (1, false)] {
            let (ahead, behind) = (&pair[0][side], &pair[1][side]);
            for i in 0..ahead.len() - 1 {
                let place = match i {
                    0..3 => Place::Under,
                    3 => Place::Side(0.6),
                    4 | 5 => Place::Side(0.5 * (ROWS[i - 4] + ROWS[i - 3])),
                    6 => Place::Top(0.5 * (1.0 + COLUMNS[0])),
                    _ => Place::Top(0.5 * COLUMNS[0]),
                };
                if pane(f, place, left) {
                    continue;
                }
                let part = match i {
                    0..3 => carpet,
                    3 | 4 => dark,
                    _ => roof,
                };
                let part = b.part_index(part);
                let corners = [ahead[i], ahead[i + 1], behind[i + 1], behind[i]].map(|p| b.vertex(p));
                let [p, q, r, s] = corners;
                b.quad(part, if left { [p, q, r, s] } else { [s, r, q, p] });
            }
        }
    }
    // The wall behind it all.
    let Some([left, right]) = rings.last() else { return };
    let outline = left.iter().chain(right.iter().rev().skip(1));
    let ids: Vec<u32> = outline.map(|p| b.vertex(*p)).collect();
    let part = b.part_index(dark);
    for pair in ids[1..].windows(2) {
        b.triangle(part, [ids[0], pair[0], pair[1]]);
    }
}

/// Places along the hull from the windscreen to the rear where the lining is cut.
fn stations(room: &Room<'_>, plan: &Plan) -> Vec<f32> {
    let (hull, style) = (room.hull, &room.hull.style);
    let last = hull.f_of(plan.rear_x);
    let (cowl, roof, deck) = (style.cowl.0, style.roof, style.deck.0);
    // Just inside the roof's ends, where it does not yet fall off.
    let near = hull.share(0.03);
    let mut f =
        vec![cowl, 0.5 * (cowl + roof.0), roof.0 + near, 0.5 * (roof.0 + roof.1), roof.1 - near, deck];
    if !style.rear_glass {
        f.extend(REAR_PANE.map(|share| roof.1 + share * (deck - roof.1)));
    }
    f.extend([style.windows.0, style.windows.1, last]);
    f.extend(style.pillars.iter().flat_map(|p| [p - 0.009, p + 0.009]));
    for axle in &hull.axles {
        f.extend([-1.041, -1.03, 0.0, 1.03, 1.041].map(|share| hull.f_of(axle - share * hull.arch)));
    }
    f.extend(plan.cover_x.iter().flat_map(|x| [x + 0.01, x - 0.01]).map(|x| hull.f_of(x)));
    f.retain(|f| (cowl..=last).contains(f));
    f.sort_by(f32::total_cmp);
    f.dedup_by(|a, b| *a - *b < hull.share(0.004));
    f
}

/// From the middle of the floor up a side to the middle of the roof.
fn half_ring(room: &Room<'_>, plan: &Plan, f: f32, left: bool) -> Vec<Vec3> {
    let (hull, x) = (room.hull, room.hull.x_of(f));
    let at = hull.section(f);
    let covered = plan.cover_x.is_some_and(|from| x < from);
    let floor_z = if covered { at.belt_z - 0.05 } else { plan.floor_z.min(at.belt_z - 0.05) };
    let beside = room.over_wheels(x).filter(|(z, _)| *z > floor_z);
    let (step_y, step_z) = beside.map_or((0.5 * hull.half_width, floor_z), |(z, y)| (y - 0.04, z));
    let sign = if left { 1.0 } else { -1.0 };
    let place = |y: f32, z: f32| Vec3::new(x, sign * y, z);
    let wall = hull.aside(&at, step_z.min(at.belt_z));
    let floor = [place(0.0, floor_z), place(step_y, floor_z), place(step_y, step_z), place(wall, step_z)];
    let sides = ROWS.map(|row| hull.side(&at, row, left).with_x(x));
    let top = COLUMNS.map(|s| hull.top(&at, sign * s).with_x(x));
    floor.into_iter().chain(sides).chain(top).map(|p| room.held(p)).collect()
}
