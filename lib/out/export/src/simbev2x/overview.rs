//! The picture of a scene from above, at its beginning.

use frames::math::{sin_cos, tan};
use frames::{Agent, Object, Pose, World};
use mapview::{ActorStyle, Film, MapActor, ViewOptions, Window};
use scene::SceneReader;
use schema::table::Row;
use schema::tables::{ActorRow, AgentRow, StateRow};
use schema::{ActorKind, ActorRole, AgentId, AgentKind};
use store::keys;

use super::masks::jpeg;
use crate::{ExportError, SceneSource};

/// Pixels a side.
const SIDE: usize = 2000;
/// Height of the camera over the world's zero, m, and what it sees, degrees.
const HEIGHT_M: f64 = 1000.0;
const FOV_DEG: f64 = 27.0;
const QUALITY: u8 = 95;

schema::columns! {
    /// Where things are.
    Place of StateRow { frame: i32, id: u16, xyz_m: [f64; 3], quaternion: [f64; 4] }
}

/// What a camera far above the first vehicle sees, drawn as a map with what stands and moves on it; up is
/// where that vehicle goes.
///
/// # Errors
/// Map or log cannot be read, or there is no memory for the picture.
pub(super) fn picture(scene: &SceneSource, first: &AgentRow) -> Result<Vec<u8>, ExportError> {
    let info = scene.info();
    let store = scene.reader().store();
    let map = replay::maps::read(store, &info.map, &info.map_hash)
        .map_err(|e| ExportError::Refused(format!("scene {}: {e}", info.scene)))?;
    let things = things(scene.reader())?;
    let wrong =
        |problem: String| ExportError::Content { scene: info.scene, frame: None, agent: None, problem };
    let view = View::of(first);
    let options = ViewOptions {
        size_px: (view.reach_m / view.m_per_px * 2.0).ceil(),
        window: Some(Window { centre_m: view.centre_m, radius_m: view.reach_m }),
        title: None,
    };
    let film =
        Film::new(&map, &options, &things).map_err(|e| wrong(format!("the picture from above: {e}")))?;
    let page = Page { rgba: film.frame(&[], &[], ""), size: film.size_px() };
    let mut rgb = Vec::with_capacity(3 * SIDE * SIDE);
    for row in 0..SIDE {
        for column in 0..SIDE {
            let at_px = film.at_px(view.world_of([column as f64 + 0.5, row as f64 + 0.5]));
            rgb.extend_from_slice(&page.at(at_px));
        }
    }
    jpeg(&rgb, SIDE, QUALITY).map_err(|e| wrong(format!("the picture from above: {e}")))
}

/// Where a pixel of the picture lies in the world.
struct View {
    centre_m: [f64; 2],
    heading_rad: f64,
    m_per_px: f64,
    /// From the middle to the corners, m.
    reach_m: f64,
}

impl View {
    fn of(first: &AgentRow) -> Self {
        let [x, y, z] = first.xyz_m;
        let half_m = (HEIGHT_M - z) * tan(frames::deg(0.5 * FOV_DEG));
        let heading_rad = Pose::<World, Agent>::from_xyz_wxyz(first.xyz_m, first.quaternion).yaw();
        Self {
            centre_m: [x, y],
            heading_rad,
            m_per_px: 2.0 * half_m / SIDE as f64,
            reach_m: half_m * std::f64::consts::SQRT_2,
        }
    }

    fn world_of(&self, [column, row]: [f64; 2]) -> [f64; 2] {
        let right_m = (column - 0.5 * SIDE as f64) * self.m_per_px;
        let ahead_m = (0.5 * SIDE as f64 - row) * self.m_per_px;
        let (sin, cos) = sin_cos(self.heading_rad);
        [self.centre_m[0] + ahead_m * cos + right_m * sin, self.centre_m[1] + ahead_m * sin - right_m * cos]
    }
}

/// The map as pixels.
struct Page {
    rgba: Vec<u8>,
    size: [u32; 2],
}

impl Page {
    /// The colour at a place, between the four pixels around it.
    fn at(&self, [x, y]: [f64; 2]) -> [u8; 3] {
        let [width, height] = self.size.map(|v| v as usize);
        let low = |v: f64, most: usize| ((v - 0.5).floor().max(0.0) as usize).min(most.saturating_sub(2));
        let (left, top) = (low(x, width), low(y, height));
        let (across, down) =
            ((x - 0.5 - left as f64).clamp(0.0, 1.0), (y - 0.5 - top as f64).clamp(0.0, 1.0));
        let value = |column: usize, row: usize, channel: usize| {
            let at = 4 * (row * width + column) + channel;
            self.rgba.get(at).copied().map_or(0.0, f64::from)
        };
        std::array::from_fn(|channel| {
            let upper = (1.0 - across) * value(left, top, channel) + across * value(left + 1, top, channel);
            let lower =
                (1.0 - across) * value(left, top + 1, channel) + across * value(left + 1, top + 1, channel);
            ((1.0 - down) * upper + down * lower).round() as u8
        })
    }
}

/// All that stands or moves at frame 0.
fn things(scene: &SceneReader) -> Result<Vec<MapActor>, ExportError> {
    let actors: Vec<ActorRow> = scene.rows()?;
    let key = keys::table::<StateRow>(scene.scene());
    let mut places: Vec<Place> = Vec::new();
    for group in scene.store().row_groups::<Place>(scene.manifest(StateRow::STAGE)?, &key)? {
        let group = group?;
        let is_over = group.last().is_some_and(|place| place.frame > 0);
        places.extend(group.into_iter().filter(|place| place.frame == 0));
        if is_over {
            break;
        }
    }
    places.sort_by_key(|place| place.id);
    let mut things: Vec<MapActor> = actors
        .iter()
        .filter_map(|actor| {
            let style = style_of(actor)?;
            let moved = places.binary_search_by_key(&actor.id, |place| place.id).ok().map(|i| &places[i]);
            let (xyz_m, quaternion) =
                moved.map_or((actor.xyz_m, actor.quaternion), |place| (place.xyz_m, place.quaternion));
            Some(thing(actor, style, xyz_m, quaternion))
        })
        .collect();
    // Moving objects are drawn over static ones.
    things.sort_by_key(|thing| match thing.style {
        ActorStyle::Plant | ActorStyle::Furniture | ActorStyle::Building => 0,
        ActorStyle::Agent | ActorStyle::Station => 2,
        _ => 1,
    });
    Ok(things)
}

fn style_of(actor: &ActorRow) -> Option<ActorStyle> {
    Some(match (actor.kind, actor.role) {
        (_, ActorRole::Agent(AgentId { kind: AgentKind::Vehicle, .. })) => ActorStyle::Agent,
        (ActorKind::Rsu, _) => ActorStyle::Station,
        (ActorKind::Vehicle | ActorKind::Parked, _) => ActorStyle::Vehicle,
        (ActorKind::Walker, _) => ActorStyle::Walker,
        (ActorKind::Prop | ActorKind::Sign, ActorRole::Hazard) => ActorStyle::Obstacle,
        (ActorKind::Prop, _) => ActorStyle::Furniture,
        (ActorKind::Building, _) => ActorStyle::Building,
        (ActorKind::Vegetation, _) => ActorStyle::Plant,
        (ActorKind::Sign | ActorKind::TrafficLight | ActorKind::Pole | ActorKind::Surface, _) => return None,
    })
}

fn thing(actor: &ActorRow, style: ActorStyle, xyz_m: [f64; 3], quaternion: [f64; 4]) -> MapActor {
    let mut rgb = [150; 3];
    rgb.iter_mut().zip(&actor.color).for_each(|(to, from)| *to = *from);
    MapActor {
        style,
        at_m: [xyz_m[0], xyz_m[1]],
        heading_rad: Pose::<World, Object>::from_xyz_wxyz(xyz_m, quaternion).yaw(),
        size_m: [actor.length_m, actor.width_m],
        rgb,
        covered: false,
        brakes: false,
        blinks: [false; 2],
        label: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_is_where_the_vehicle_goes_and_the_picture_is_480_m_wide() {
        // At the origin of the world, to the north: the picture's middle top is 240 m north, its middle right
        // 240 m east.
        let north = [0.5_f64.sqrt(), 0.0, 0.0, 0.5_f64.sqrt()];
        let view = View::of(&AgentRow { quaternion: north, ..AgentRow::default() });
        let half_m = 1000.0 * tan(frames::deg(13.5));
        assert!((half_m - 240.079).abs() < 1e-3, "{half_m}");
        for (pixel, expected) in [
            ([1000.0, 0.0], [0.0, half_m]),
            ([2000.0, 1000.0], [half_m, 0.0]),
            ([1000.0, 1000.0], [0.0, 0.0]),
        ] {
            let found = view.world_of(pixel);
            assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-9), "{pixel:?} is at {found:?}");
        }
        // From 100 m up it sees less.
        let high = View::of(&AgentRow { xyz_m: [0.0, 0.0, 100.0], quaternion: north, ..AgentRow::default() });
        assert!((high.m_per_px / view.m_per_px - 0.9).abs() < 1e-12);
    }

    #[test]
    fn colours_between_pixels_are_mixed() {
        let page =
            Page { rgba: vec![0, 0, 0, 255, 200, 100, 0, 255, 0, 0, 0, 255, 200, 100, 0, 255], size: [2, 2] };
        assert_eq!(page.at([0.5, 0.5]), [0, 0, 0]);
        assert_eq!(page.at([1.0, 1.0]), [100, 50, 0]);
        assert_eq!(page.at([1.5, 0.5]), [200, 100, 0]);
    }
}
