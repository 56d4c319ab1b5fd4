use glam::Vec3;
use schema::geometry::{Surface, TriMesh};

use super::{KINDS, patch};
use crate::actors::ActorMesh;

/// Sizes of patches of each kind: the usual one, a small one and a large one.
fn sizes(kind: &str) -> [Vec3; 3] {
    match kind {
        "meadow" => [[4.0, 4.0, 0.5], [2.0, 1.0, 0.3], [6.0, 4.0, 0.8]],
        "flowers" => [[3.0, 1.0, 0.35], [0.8, 0.5, 0.3], [6.0, 1.5, 0.5]],
        "wheat" => [[4.0, 4.0, 0.8], [1.0, 1.0, 0.7], [8.0, 4.0, 0.9]],
        "vines" => [[4.0, 2.0, 1.8], [1.0, 0.5, 1.5], [6.0, 2.5, 2.0]],
        "climber" => [[4.0, 0.25, 6.0], [1.0, 0.15, 2.5], [8.0, 0.3, 12.0]],
        _ => [[4.0, 4.0, 2.2], [1.5, 1.0, 1.0], [6.0, 5.0, 2.5]],
    }
    .map(Vec3::from_array)
}

fn levels(made: &ActorMesh) -> impl Iterator<Item = &TriMesh> {
    // From far enough off the lowest are not there.
    let all = std::iter::once(&made.pieces).chain(made.coarser.iter().map(|level| &level.pieces));
    all.filter_map(|pieces| pieces.first()).map(|piece| &*piece.mesh)
}

fn leaf_area_m2(mesh: &TriMesh) -> f32 {
    let of = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        0.5 * (b - a).cross(c - a).length()
    };
    let is_leaf = |t: &usize| mesh.part(*t).surface != Surface::Wood;
    (0..mesh.triangles.len()).filter(is_leaf).map(of).sum()
}

fn all() -> impl Iterator<Item = (&'static str, Vec3, u32)> {
    let of = |kind| sizes(kind).into_iter().flat_map(move |size| (0..4).map(move |v| (kind, size, v)));
    KINDS.into_iter().flat_map(of)
}

#[test]
fn patches_stay_in_their_boxes_and_reach_all_over_them() {
    for (kind, size, variant) in all() {
        let half = Vec3::new(0.5 * size.x, 0.5 * size.y, 0.0);
        let made = patch(kind, size, variant).expect("is one");
        for (level, mesh) in levels(&made).enumerate() {
            let name = format!("{kind} of {size} m, {variant}, level {level}");
            assert!(mesh.positions.iter().all(|p| p.is_finite()), "{name}");
            let b = mesh.aabb();
            assert!(b.min.cmpge(-half).all() && b.max.cmple(half + Vec3::Z * size.z).all(), "{name}: {b:?}");
            let reach = (b.max - b.min) / size;
            // Vines stand in a row, and a narrow strip has one of maize.
            let across = match kind {
                "vines" => 0.2,
                "maize" if size.y < 1.5 => 0.5,
                _ => 0.65,
            };
            let high = if kind == "vines" { 0.4 } else { 0.6 };
            let least = Vec3::new(0.7, across, high) * if level < 3 { 1.0 } else { 0.75 };
            assert!(reach.cmpge(least).all(), "{name}: {reach} of the box");
        }
    }
}

#[test]
fn levels_keep_the_area_of_leaves_and_cost_less_and_less() {
    for (kind, size, variant) in all() {
        let made = patch(kind, size, variant).expect("is one");
        let near = leaf_area_m2(&made.pieces[0].mesh);
        let mut last = usize::MAX;
        for (level, mesh) in levels(&made).enumerate() {
            let name = format!("{kind} of {size} m, {variant}, level {level}");
            let area = leaf_area_m2(mesh);
            let within = if level < 3 { 0.2 } else { 0.5 };
            assert!((area / near - 1.0).abs() < within, "{name}: {area} of {near} m2");
            let count = mesh.triangles.len();
            // Larger ones have more.
            let usual = sizes(kind)[0];
            let share = (size.x * size.y / (usual.x * usual.y)).max(1.0) * (size.z / usual.z).max(1.0);
            let most = [1610.0, 660.0, 190.0, 56.0][level] * share;
            assert!(count < last && count as f32 <= most, "{name}: {count} triangles");
            last = count;
            assert_eq!(mesh.corner_normals.len(), count, "{name}");
            assert_eq!(mesh.corner_visibility.len(), count, "{name}");
        }
    }
}

#[test]
fn patches_are_the_same_each_time_and_differ_by_variant() {
    for kind in KINDS {
        let size = sizes(kind)[0];
        let made = |variant| patch(kind, size, variant).expect("is one").pieces[0].mesh.clone();
        assert_eq!(made(3), made(3), "{kind}");
        // The shape by the remainder by four, the colour by the rest.
        assert_ne!(made(0).positions, made(1).positions, "{kind}");
        assert_eq!(made(1).positions, made(5).positions, "{kind}");
        assert_ne!(made(1).parts, made(5).parts, "{kind}");
        assert_eq!(made(1), made(17), "{kind}");
    }
    assert!(patch("fern", Vec3::ONE, 0).is_none());
}

#[test]
fn meadows_maize_and_shrubs_touch_as_many_cells_as_grow_there() {
    for (kind, size, wanted) in [
        // Cells of 0.1 m over a square metre, or of the volume.
        ("meadow", Vec3::new(4.0, 4.0, 0.5), 150.0..250.0),
        ("maize", Vec3::new(4.0, 4.0, 2.2), 0.15..0.26),
        ("shrubs", Vec3::new(4.0, 4.0, 2.0), 0.15..0.27),
    ] {
        let made = patch(kind, size, 1).expect("is one");
        let mesh = &made.pieces[0].mesh;
        let mut cells = std::collections::BTreeSet::new();
        for t in 0..mesh.triangles.len() {
            let [a, b, c] = mesh.corners(t);
            let longest = (b - a).length().max((c - a).length()).max((c - b).length());
            let n = (longest / 0.02).ceil().max(1.0) as i32;
            for (i, j) in (0..=n).flat_map(|i| (0..=n - i).map(move |j| (i, j))) {
                let p = a + (b - a) * (i as f32 / n as f32) + (c - a) * (j as f32 / n as f32);
                cells.insert((p * 10.0).floor().to_array().map(|v| v as i32));
            }
        }
        let per_m2 = cells.len() as f32 / (size.x * size.y);
        let got = if kind == "meadow" { per_m2 } else { 0.001 * per_m2 / size.z };
        assert!(wanted.contains(&got), "{kind}: {got}");
    }
}
