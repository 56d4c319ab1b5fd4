//! Street furniture: a file for each family, all parts closed. Everything looks along +x and lies in the box
//! of its size; what is said of it here and of where it stands is told by its kind in `land`.
//!
//! Clear glass is left out: light and rays go through it, and frames and printed bands show where it is.

mod bins;
mod boxes;
mod greens;
mod outline;
mod parts;
mod picture;
mod poles;
mod posters;
mod posts;
mod rails;
mod seats;
mod shelter;

use std::sync::Arc;

use glam::Vec3;
use schema::geometry::{MeshPart, Surface, TriMesh};

use crate::actors::pieces::{ActorMesh, Coarser, Joint, Piece};
use crate::solids::{Detail, MeshBuilder};
use parts::{CONCRETE, block, still};
use picture::Skin;

/// Things of more triangles than this have a coarser level, from so far away on, metres.
const MANY: usize = 300;
const COARSER_FROM_M: f64 = 40.0;

/// Adds the solids of a thing of a size and a variant.
type Maker = fn(&mut MeshBuilder, Vec3, u32);
/// The picture on its textured parts.
type Painter = fn(Vec3, u32) -> Skin;

/// How a kind is made, by family and name.
fn maker(family: &str, kind: &str) -> Option<(Maker, Option<Painter>)> {
    let plain = |maker: Maker| Some((maker, None));
    let painted = |maker: Maker, painter: Painter| Some((maker, Some(painter)));
    match (family, kind) {
        ("prop", "bollards") => plain(posts::bollards),
        ("prop", "hydrant_barrel") => plain(posts::hydrant_barrel),
        ("prop", "hydrant_pillar") => plain(posts::hydrant_pillar),
        ("prop", "hydrant_post") => plain(posts::hydrant_post),
        ("prop", "delineator") => plain(posts::delineator),
        ("prop", "parking_meter") => plain(posts::parking_meter),
        ("prop", "bicycle_pump") => plain(posts::bicycle_pump),
        ("prop", "postbox_round_top") => plain(boxes::postbox_round_top),
        ("prop", "postbox_pillar") => plain(boxes::postbox_pillar),
        ("prop", "postbox_on_post") => plain(boxes::postbox_on_post),
        ("prop", "letterbox") => plain(boxes::letterbox),
        ("prop", "pay_machine") => painted(boxes::pay_machine, boxes::pay_machine_face),
        ("prop", "cabinet" | "cabinet_small") => plain(boxes::cabinet),
        ("prop", "phone_box") => plain(boxes::phone_box),
        ("prop", "charger") => plain(boxes::charger),
        ("prop", "newspaper_boxes") => plain(boxes::newspaper_boxes),
        ("prop", "grit_bin") => plain(bins::grit_bin),
        ("prop", "wheelie_bins") => plain(bins::wheelie_bins),
        ("prop", "container") => plain(bins::container),
        ("prop", "dumpster") => plain(bins::dumpster),
        ("prop", "skip") => plain(bins::skip),
        ("prop", "recycling") => plain(bins::recycling),
        ("prop", "crates") => plain(bins::crates),
        ("prop", "bags") => plain(bins::bags),
        ("prop", "planter") => plain(greens::planter),
        ("prop", "flower_tub") => plain(greens::flower_tub),
        ("prop", "cafe") => plain(seats::cafe),
        ("prop", "a_board") => painted(posters::a_board, posters::a_board_face),
        ("prop", "kiosk") => painted(posters::kiosk, posters::kiosk_face),
        ("prop", "advert_column") => painted(posters::advert_column, posters::advert_column_face),
        ("prop", "city_light") => painted(posters::city_light, posters::city_light_face),
        ("prop", "billboard") => painted(posters::billboard, posters::billboard_face),
        ("prop", "info_board") => painted(posters::info_board, posters::info_board_face),
        ("prop", "bus_shelter") => painted(shelter::bus_shelter, shelter::bus_shelter_face),
        ("prop", "guard_rail") => plain(rails::guard_rail),
        ("pole", "bus_stop") => painted(poles::bus_stop, poles::bus_stop_face),
        ("pole", "utility") => plain(poles::utility),
        ("pole", "flag") => plain(poles::flag),
        ("pole", "clock") => plain(poles::clock),
        _ => None,
    }
}

/// Height and stuff of the slab that a kind stands on, metres.
fn slab(kind: &str) -> Option<(f32, MeshPart)> {
    match kind {
        "bus_shelter" | "dumpster" => Some((0.30, CONCRETE)),
        "kiosk" => Some((0.48, CONCRETE)),
        "recycling" => Some((0.25, CONCRETE)),
        "container" => Some((0.20, CONCRETE)),
        "cafe" => Some((0.46, still(Surface::Wood, [0.30, 0.20, 0.12]))),
        _ => None,
    }
}

/// A thing by family and name.
pub(crate) fn thing(family: &str, kind: &str, size: Vec3, variant: u32) -> Option<ActorMesh> {
    let (make, paint) = maker(family, kind)?;
    let slab = slab(kind);
    let up = Vec3::Z * slab.map_or(0.0, |(height, _)| height);
    let skin = paint.map(|paint| {
        let skin = paint(size - up, variant);
        Skin { low: skin.low + up, high: skin.high + up, ..skin }
    });
    let pieces = |detail: Detail| {
        let mut b = MeshBuilder::at(detail);
        make(&mut b, size - up, variant);
        if let Some((height, part)) = slab {
            b.reshape(|p| p + up);
            block(&mut b, part, [0.0; 2], [0.5 * size.x, 0.5 * size.y], [0.0, height]);
        }
        let mut mesh = b.finish();
        if let Some(skin) = &skin {
            skin.lay_on(&mut mesh);
        }
        vec![Piece { mesh: Arc::new(mesh), joint: Joint::Fixed }]
    };
    let near = pieces(Detail::Full);
    let triangles: usize = near.iter().map(|piece: &Piece| count(&piece.mesh)).sum();
    let coarser =
        (triangles > MANY).then(|| Coarser { from_m: COARSER_FROM_M, pieces: pieces(Detail::Coarse) });
    Some(ActorMesh { coarser: coarser.into_iter().collect(), ..ActorMesh::of(near) })
}

fn count(mesh: &TriMesh) -> usize {
    mesh.triangles.len()
}
