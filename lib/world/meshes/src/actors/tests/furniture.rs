//! Street furniture of the table of `land`.

use land::scenery::{FURNITURE, FurnitureKind};

use super::*;

/// All kinds in all variants, with every level of detail.
fn everywhere(mut look: impl FnMut(&FurnitureKind, u32, usize, &TriMesh)) {
    for kind in &FURNITURE {
        for variant in 0..kind.variants {
            let actor = made(kind.model, kind.size_m, variant);
            let levels = std::iter::once(&actor.pieces).chain(actor.coarser.iter().map(|c| &c.pieces));
            for (level, pieces) in levels.enumerate() {
                assert_eq!(pieces.len(), 1, "{}", kind.model);
                look(kind, variant, level, &pieces[0].mesh);
            }
        }
    }
}

#[test]
fn furniture_fills_its_box_and_stays_in_it_at_every_level() {
    let mut bad = Vec::new();
    everywhere(|kind, variant, level, mesh| {
        let b = mesh.aabb();
        let [x, y, z] = kind.size_m.map(|m| m as f32);
        let half = Vec3::new(0.5 * x, 0.5 * y, 0.0);
        let inside = b.min.cmpge(-half - 1e-3).all()
            && b.min.z > -1e-4
            && b.max.cmple(half + Vec3::Z * z + 1e-3).all();
        // Nothing floats, and boxes are no larger than things: one side of each pair is reached.
        let spare = if level == 0 { 0.04 } else { 0.13 };
        let stands = b.min.z < 1e-3 && b.max.z > z - spare;
        let overhead = ["pole.utility", "pole.flag"].contains(&kind.model);
        let full = (0..2).all(|axis| {
            let reached = b.max[axis].max(-b.min[axis]);
            overhead || reached > half[axis] - spare.max(0.08 * half[axis])
        });
        if !(inside && stands && full) {
            bad.push(format!("{} {variant} at level {level}: {b:?}", kind.model));
        }
    });
    assert!(bad.is_empty(), "{bad:#?}");
}

#[test]
fn furniture_is_closed_at_every_level_and_cheaper_far_away() {
    let mut fine: usize = 0;
    let mut bad = Vec::new();
    everywhere(|kind, variant, level, mesh| {
        let (volume, closed) = closed_volume(mesh);
        assert!(closed && volume > 0.0, "{} {variant} at level {level}: {volume}", kind.model);
        let count = mesh.triangles.len();
        if level == 0 {
            fine = count;
        }
        if !(12..=600).contains(&count) || (level > 0 && 10 * count > 8 * fine) {
            bad.push(format!("{} {variant} at level {level}: {count} of {fine} triangles", kind.model));
        }
    });
    assert!(bad.is_empty(), "{bad:#?}");
}

#[test]
fn furniture_has_the_tags_of_its_table() {
    everywhere(|kind, variant, level, mesh| {
        let count = |tag: Tag| (0..mesh.triangles.len()).filter(|i| mesh.part(*i).tag == tag).count();
        // Plants, parasols and flags are what they are; of a terrace, chairs are loose and tables stand.
        let others = count(Tag::Vegetation) + count(Tag::Other) + count(Tag::Static);
        let own = count(kind.tag);
        let all = mesh.triangles.len();
        assert!(own > 0, "{} {variant} at level {level}", kind.model);
        assert!(own == all || own + others >= all, "{} {variant}: {own} of {all}", kind.model);
        let green = kind.model == "prop.planter" || kind.model == "prop.flower_tub";
        assert_eq!(count(Tag::Vegetation) > 0, green, "{} {variant}", kind.model);
    });
}

#[test]
fn slabs_are_as_high_as_the_table_says() {
    // The top of a slab is the largest flat face, and so high; a column's foot is round and goes on above.
    for kind in FURNITURE.iter().filter(|kind| kind.foot_m > 0.0 && kind.model != "prop.advert_column") {
        let mesh = &made(kind.model, kind.size_m, 0).pieces[0].mesh;
        let area_m2: f32 = (0..mesh.triangles.len())
            .map(|i| mesh.corners(i))
            .filter(|corners| corners.iter().all(|p| (p.z - kind.foot_m as f32).abs() < 1e-4))
            .map(|[a, b, c]| 0.5 * (b - a).cross(c - a).z.max(0.0))
            .sum();
        let all_m2 = (kind.size_m[0] * kind.size_m[1]) as f32;
        assert!(area_m2 > 0.99 * all_m2, "{}: {area_m2} of {all_m2}", kind.model);
    }
}

#[test]
fn pictures_are_upright_and_whole() {
    // Where the printed faces are, places in the picture run over all of it, and downwards.
    for kind in &FURNITURE {
        let actor = made(kind.model, kind.size_m, 0);
        let mesh = &actor.pieces[0].mesh;
        let Some(textures) = &mesh.textures else { continue };
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for (i, places) in textures.corners.iter().enumerate() {
            if !matches!(mesh.part(i).surface, Surface::Textured(_)) {
                continue;
            }
            let corners = mesh.corners(i);
            let out = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            // The front, or all round.
            let is_front = out.z.abs() < 0.6 * out.length() && out.length() > 0.02;
            for (k, place) in places.iter().enumerate().filter(|_| is_front) {
                (low, high) = (
                    [low[0].min(place.x), low[1].min(place.y)],
                    [high[0].max(place.x), high[1].max(place.y)],
                );
                let other = (k + 1) % 3;
                let (rise, fall) = (corners[other].z - corners[k].z, places[other].y - place.y);
                assert!(rise * fall <= 1e-6, "{}", kind.model);
            }
        }
        assert!(
            low[0] < 0.02 && low[1].abs() < 0.03 && high[0] > 0.98 && (high[1] - 1.0).abs() < 0.03,
            "{}: {low:?} {high:?}",
            kind.model
        );
    }
}
