//! What one sees through the panes of vehicles.

use catalogue::models;
use schema::geometry::DOOR_M;

use super::vehicles::{roots, times_inside};
use super::*;

/// Colour of undersides.
const UNDER: [f32; 3] = [0.022, 0.022, 0.023];

/// The triangles of a mesh.
fn triangles(mesh: &TriMesh) -> Vec<[Vec3; 3]> {
    (0..mesh.triangles.len()).map(|i| mesh.corners(i)).collect()
}

/// Where a ray meets a triangle, and whether it comes from its outer side (Möller and Trumbore 1997).
fn meets([a, b, c]: [Vec3; 3], from: Vec3, along: Vec3) -> Option<(f32, bool)> {
    let (u, v) = (b - a, c - a);
    let across = along.cross(v);
    let det = u.dot(across);
    if det.abs() < 1e-12 {
        return None;
    }
    let to = from - a;
    let first = to.dot(across) / det;
    let second_axis = to.cross(u);
    let second = along.dot(second_axis) / det;
    let t = v.dot(second_axis) / det;
    (first >= 0.0 && second >= 0.0 && first + second <= 1.0 && t > 1e-4).then_some((t, det > 0.0))
}

#[test]
fn all_vehicles_with_panes_have_a_cabin_inside_their_body() {
    for model in models::vehicles().chain(trains::sections()) {
        let actor = made(model.name, model.size_m, 0);
        let two_wheels = matches!(model.base, BaseType::Motorcycle | BaseType::Bicycle);
        let Some(cabin) = actor.cabin else {
            assert!(two_wheels || model.name.starts_with("trailer."), "{} has no cabin", model.name);
            continue;
        };
        let body = triangles(&actor.pieces[0].mesh);
        // Off the plane of symmetry, where edges are.
        let aside = Vec3::new(0.0013, 0.0017, 0.0);
        let driver = cabin.driver.clone();
        let is_towed = trains::of_towed(model.name).is_some();
        assert_eq!(driver.is_none(), is_towed, "{}", model.name);
        for mesh in std::iter::once(&cabin.seats).chain(&driver) {
            for p in &mesh.positions {
                assert!(times_inside(&body, *p + aside) > 0, "{}: {p} is outside", model.name);
            }
        }
        let seats = cabin.seats.triangles.len();
        assert!((300..=1800).contains(&seats), "{}: {seats}", model.name);
        if let Some(driver) = driver {
            let count = driver.triangles.len();
            assert!((200..=1500).contains(&count), "{}: {count}", model.name);
            assert!(driver.corner_normals.len() == count);
        }
    }
}

#[test]
fn whoever_looks_through_a_pane_sees_the_cabin_or_out_of_another_one() {
    for model in models::vehicles().chain(trains::sections()) {
        let actor = made(model.name, model.size_m, 0);
        let Some(cabin) = actor.cabin else { continue };
        let body = &actor.pieces[0].mesh;
        let inside = triangles(&cabin.seats);
        let panes: Vec<usize> =
            (0..body.triangles.len()).filter(|i| body.part(*i).surface.is_window()).collect();
        // The skin is the first solid; above the wheels its underside lies over the floor between them.
        let roots = roots(body);
        let skin: Vec<[Vec3; 3]> = (0..body.triangles.len())
            .filter(|i| roots[body.triangles[*i][0] as usize] == roots[0])
            .filter(|i| body.part(*i).rgb != UNDER && !body.part(*i).surface.is_window())
            .map(|i| body.corners(i))
            .collect();
        let nearest = |of: &mut dyn Iterator<Item = [Vec3; 3]>, from: Vec3, along: Vec3, outer: bool| {
            let hits =
                of.filter_map(|corners| meets(corners, from, along)).filter(|hit| hit.1 == outer || outer);
            hits.min_by(|p, q| p.0.total_cmp(&q.0))
        };
        let (mut looks, mut leaks) = (0, Vec::new());
        let (mut whole_m2, mut behind_m2) = (0.0, 0.0);
        for pane in &panes {
            let [a, b, c] = body.corners(*pane);
            let middle = (a + b + c) / 3.0;
            let twice = (b - a).cross(c - a);
            let outward = twice.normalize_or_zero();
            for aside in [Vec3::new(0.0, 0.0, 0.25), Vec3::new(0.4, 0.1, 0.1), Vec3::new(-0.4, -0.1, 0.05)] {
                let along = -(outward + aside).normalize();
                looks += 1;
                whole_m2 += twice.length();
                let seen = nearest(&mut inside.iter().copied(), middle, along, true);
                // What of the body would be seen from inside.
                let reach = seen.map_or(f32::INFINITY, |(t, _)| t);
                let bare =
                    nearest(&mut skin.iter().copied(), middle, along, false).filter(|hit| hit.0 < reach);
                let out = nearest(&mut panes.iter().map(|k| body.corners(*k)), middle, along, false);
                let fine = match (seen, bare) {
                    // Lining and skin are a little apart where a pane ends.
                    (_, Some((t, _))) => out.is_some_and(|pane| pane.0 < t + 0.1),
                    (Some((t, from_front)), None) => {
                        if !from_front {
                            behind_m2 += twice.length();
                        }
                        from_front || t < 0.12 || out.is_some_and(|pane| pane.0 < t + 0.1)
                    }
                    (None, None) => out.is_some(),
                };
                if !fine {
                    leaks.push((middle, along, seen, bare));
                }
            }
        }
        assert!(looks > 30, "{} has no panes", model.name);
        // No lining hangs before a pane.
        let hung = behind_m2 / whole_m2;
        assert!(hung < 0.06, "{}: {hung:.3} of its panes", model.name);
        let share = leaks.len() as f64 / f64::from(looks);
        let some: Vec<_> = leaks.iter().step_by(1 + leaks.len() / 6).collect();
        assert!(share < 0.03, "{}: {share:.3} of {looks}: {some:?}", model.name);
    }
}

#[test]
fn ways_in_hold_what_a_closed_door_has_within_the_depth_that_is_looked_past() {
    for model in models::vehicles().chain(trains::sections()) {
        let actor = made(model.name, model.size_m, 0);
        for piece in actor.pieces.iter().filter(|p| matches!(p.joint, Joint::Doorway { .. })) {
            let slab = piece.mesh.aabb();
            assert!(piece.mesh.parts.iter().any(|part| part.surface == Surface::Opening));
            let cabin = actor.cabin.as_ref().expect("doors lead somewhere");
            // Lining of its side, in the middle of the opening: no deeper than what is looked past.
            let inside = triangles(&cabin.seats);
            let left = slab.min.y + slab.max.y > 0.0;
            let (z, x) = (slab.min.z + 0.30 * (slab.max.z - slab.min.z), 0.5 * (slab.min.x + slab.max.x));
            let from = Vec3::new(x, if left { slab.max.y + 1.0 } else { slab.min.y - 1.0 }, z);
            let along = if left { Vec3::NEG_Y } else { Vec3::Y };
            let first = |of: &[[Vec3; 3]], least: f32| {
                let hits = of.iter().filter_map(|c| meets(*c, from, along)).map(|hit| hit.0);
                hits.filter(|t| *t > least).min_by(f32::total_cmp)
            };
            let face = first(&triangles(&piece.mesh), 0.0).expect("the slab is there");
            let skin = first(&triangles(&actor.pieces[0].mesh), 0.0).expect("the body is there");
            let card = first(&inside, 0.0).expect("there is a lining");
            assert!(face < skin && skin < face + DOOR_M - 0.05, "{}: {face} {skin}", model.name);
            assert!(card < face + DOOR_M - 0.02, "{}: {face} {card}", model.name);
            let seat = first(&inside, face + DOOR_M);
            assert!(seat.is_some_and(|t| t > face + DOOR_M + 0.01), "{}: nothing is in it", model.name);
        }
    }
}
