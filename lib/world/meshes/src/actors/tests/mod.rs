use std::collections::BTreeMap;

use crate::people::{APPEARANCES, Bone, Walker};
use catalogue::{
    BaseType, Model,
    models::{MODELS, PARKED_TWO_WHEELERS},
    trains, works,
};
use frames::Aabb;
use glam::Vec3;
use land::scenery::{BUILDINGS, BuildingKind, FURNITURE, PLATES, TREES};
use schema::footprint::LightMount;
use schema::geometry::{Surface, TriMesh};
use schema::{Tag, lights};

use super::*;

mod cabins;
mod furniture;
mod vehicles;

/// Every model with a size and some variants.
fn everything() -> Vec<(String, [f64; 3], u32)> {
    let mut all: Vec<(String, [f64; 3], u32)> = Vec::new();
    for model in MODELS {
        let size_m = |variant| if walks(model) { standing_m(model, variant) } else { model.size_m };
        all.extend([0, 3, 17, 32].map(|variant| (model.name.to_owned(), size_m(variant), variant)));
    }
    // Every look of those who walk.
    for model in MODELS.iter().filter(|model| walks(model)) {
        all.extend((0..APPEARANCES).map(|look| (model.name.to_owned(), standing_m(model, look), look)));
    }
    all.extend(PARKED_TWO_WHEELERS.iter().map(|model| (model.name.to_owned(), model.size_m, 0)));
    all.extend(trains::sections().map(|model| (model.name.to_owned(), model.size_m, 0)));
    for BuildingKind { model, width_m, depth_m, storeys, .. } in BUILDINGS {
        for (share, variant) in [(0, 0), (1, 5), (1, 13), (0, 2), (1, 24)] {
            let size = [depth_m[share], width_m[share], 3.0 * storeys[share] as f64 + 2.0];
            all.push((model.to_owned(), size, variant));
        }
    }
    for kind in TREES {
        all.extend(
            [(0, 0), (1, 1), (2, 2)]
                .map(|(age, variant)| (kind.model.to_owned(), kind.size_m(age, variant), variant)),
        );
    }
    for kind in FURNITURE {
        all.extend((0..kind.variants).map(|variant| (kind.model.to_owned(), kind.size_m, variant)));
    }
    // Trees of earlier stores have names of their own, and any size.
    for name in ["tree.broadleaf", "tree.round", "tree.conifer"] {
        all.push((name.to_owned(), [5.5, 5.5, 9.0], 4));
    }
    // In winter.
    for name in ["tree.lime.bare", "tree.willow.bare"] {
        all.push((name.to_owned(), [9.0, 9.0, 15.0], 2));
    }
    let others = [
        ("plant.meadow", [4.0, 4.0, 0.5]),
        ("plant.reed", [4.0, 4.0, 2.0]),
        ("plant.flowers", [3.0, 1.0, 0.35]),
        ("plant.maize", [4.0, 4.0, 2.2]),
        ("plant.wheat", [4.0, 4.0, 0.8]),
        ("plant.vines", [4.0, 2.0, 1.8]),
        ("plant.shrubs", [4.0, 4.0, 2.0]),
        ("plant.climber", [4.0, 0.25, 6.0]),
        ("bush.round", [1.5, 1.5, 1.0]),
        ("bush.hedge", [5.0, 0.8, 1.2]),
        ("prop.bench", [0.55, 1.7, 0.85]),
        ("prop.bin", [0.42, 0.42, 0.95]),
        ("prop.rack", [1.0, 0.06, 0.85]),
        ("prop.fence", [6.0, 0.1, 1.1]),
        ("prop.wall", [6.0, 0.3, 1.4]),
        ("prop.boards", [3.0, 0.1, 1.75]),
        ("prop.wire", [3.0, 0.08, 1.5]),
        ("prop.forecourt", [4.0, 18.0, 0.3]),
        ("prop.tree_pit", [1.0, 1.0, 0.04]),
        ("prop.tree_stakes", [0.75, 0.75, 1.8]),
        ("prop.tree_grate", [1.0, 1.0, 0.03]),
        ("prop.rock", [1.0, 1.0, 0.7]),
        ("pole.lamp", [2.4, 0.28, 7.5]),
        ("rsu.pole", [0.4, 0.4, 3.5]),
        ("light.signal", [0.36, 0.42, 1.1]),
        ("light.walkers", [0.26, 0.25, 0.5]),
    ];
    all.extend(PLATES.iter().map(|plate| (plate.model.to_owned(), plate.size_m, 220)));
    all.extend(others.into_iter().chain(works::all()).map(|(name, size)| (name.to_owned(), size, 1)));
    all
}

fn walks(model: &Model) -> bool {
    model.base == BaseType::Pedestrian && model.wheel_radius_m == 0.0
}

fn standing_m(model: &Model, look: u32) -> [f64; 3] {
    Walker::new(model, look).size_m().to_array().map(f64::from)
}

fn made(name: &str, size: [f64; 3], variant: u32) -> ActorMesh {
    actor_mesh(name, size, variant).unwrap_or_else(|| panic!("no mesh for {name}"))
}

/// Where a mesh's vertices are in the object frame at some pose of its joints.
fn bounds(actor: &ActorMesh, phase_rad: f32, keep: impl Fn(Tag) -> bool) -> Aabb {
    let mut found = Aabb::EMPTY;
    let posture = actor.posed(Posture { phase_rad, ..Posture::default() });
    for piece in &actor.pieces {
        let Some(pose) = piece.joint.object_from_piece(&posture) else { continue };
        for i in 0..piece.mesh.triangles.len() {
            if keep(piece.mesh.part(i).tag) {
                found = piece.mesh.corners(i).iter().fold(found, |b, p| b.with(pose.transform_point3(*p)));
            }
        }
    }
    found
}

/// Six times the signed volume of all but leaves, and whether every directed edge has its opposite as often.
fn closed_volume(mesh: &TriMesh) -> (f64, bool) {
    let key = |p: Vec3| p.to_array().map(|v| (f64::from(v) * 1e5).round() as i64);
    let mut edges: BTreeMap<([i64; 3], [i64; 3]), i32> = BTreeMap::new();
    let mut volume = 0.0;
    for i in 0..mesh.triangles.len() {
        if matches!(mesh.part(i).surface, Surface::Foliage | Surface::Grass) {
            continue;
        }
        let p = mesh.corners(i);
        volume += f64::from(p[0].dot(p[1].cross(p[2])));
        for k in 0..3 {
            let (a, b) = (key(p[k]), key(p[(k + 1) % 3]));
            if a < b {
                *edges.entry((a, b)).or_default() += 1;
            } else if b < a {
                *edges.entry((b, a)).or_default() -= 1;
            }
        }
    }
    (volume, edges.values().all(|n| *n == 0))
}

#[test]
fn meshes_are_closed_face_outward_and_have_valid_indices() {
    for (name, size, variant) in everything() {
        for piece in made(&name, size, variant).pieces {
            let mesh = &piece.mesh;
            assert_eq!(mesh.triangles.len(), mesh.triangle_part.len());
            assert!(mesh.triangles.iter().flatten().all(|v| (*v as usize) < mesh.positions.len()), "{name}");
            assert!(mesh.positions.iter().all(|p| p.is_finite()), "{name}");
            let (volume, closed) = closed_volume(mesh);
            assert!(closed, "{name} variant {variant} is open");
            let is_low = name.starts_with("bush") || name.starts_with("plant");
            assert!(volume > 0.0 || is_low, "{name} is inside out: {volume}");
        }
    }
}

#[test]
fn meshes_stay_inside_their_boxes() {
    for (name, size, variant) in everything() {
        let actor = made(&name, size, variant);
        let half = Vec3::new(0.5 * size[0] as f32, 0.5 * size[1] as f32, 0.0);
        // Poles of lights and signs are not part of the box.
        let boxed = |tag: Tag| tag != Tag::Pole || name.starts_with("pole.");
        for phase in [0.0, 0.9, 2.2, 4.4, 11.0] {
            let b = bounds(&actor, phase, boxed);
            let slack = 0.012;
            // The box of a pedestrian who stands and moves a little follows the pose.
            let (high, half) = match actor.rig.as_deref() {
                Some(Rig::Walks(walker)) => {
                    let size = walker.box_m(phase, 0.0);
                    (size.z, 0.5 * size * Vec3::new(1.0, 1.0, 0.0))
                }
                _ => (size[2] as f32, half),
            };
            let inside = b.min.cmpge(-half - slack).all() && b.max.cmple(half + Vec3::Z * high + slack).all();
            assert!(inside, "{name} {size:?} variant {variant}: {b:?}");
            if phase == 0.0 {
                assert!(b.min.z > -1e-3 && b.max.z < size[2] as f32 + 1e-4, "{name}: {b:?}");
            }
        }
    }
}

#[test]
fn vehicles_and_people_fill_their_boxes() {
    for model in MODELS
        .iter()
        .filter(|m| m.wheelbase_m > 0.0 || m.base == BaseType::Pedestrian)
        .chain(PARKED_TWO_WHEELERS)
        .chain(trains::sections())
    {
        let size_m = if walks(model) { standing_m(model, 5) } else { model.size_m };
        let b = bounds(&made(model.name, size_m, 5), 0.0, |_| true);
        let [l, w, h] = size_m.map(|v| v as f32);
        for (got, want) in [
            (b.min.x, -0.5 * l),
            (b.max.x, 0.5 * l),
            (b.min.y, -0.5 * w),
            (b.max.y, 0.5 * w),
            (b.min.z, 0.0),
            (b.max.z, h),
        ] {
            assert!((got - want).abs() < 0.02, "{}: {got} not {want}", model.name);
        }
    }
}

#[test]
fn sizes_in_triangles_are_moderate() {
    for (name, size, variant) in everything() {
        // Doors are there only while they stand open.
        let actor = made(&name, size, variant);
        let posture = actor.posed(Posture::default());
        let seen = |p: &&Piece| p.joint.object_from_piece(&posture).is_some();
        let count: usize = actor.pieces.iter().filter(seen).map(|p| p.mesh.triangles.len()).sum();
        let drives = models::find(&name).is_some_and(|model| model.wheelbase_m > 0.0)
            || models::find_parked(&name).is_some()
            || trains::find(&name).is_some();
        let most = if drives {
            9500
        } else if name.starts_with("tree") {
            14_000
        } else if actor.rig.is_some() {
            7400
        } else if name.starts_with("bush") {
            3500
        } else if name.starts_with("plant") {
            1600
        } else if name.starts_with("building") {
            5500
        } else {
            1500
        };
        assert!((12..=most).contains(&count), "{name}: {count}");
    }
}

#[test]
fn furniture_has_the_tags_that_its_rows_say() {
    for kind in &land::scenery::FURNITURE {
        for variant in 0..kind.variants {
            for piece in &made(kind.model, kind.size_m, variant).pieces {
                for triangle in 0..piece.mesh.triangles.len() {
                    let tag = piece.mesh.part(triangle).tag;
                    assert!(tag == kind.tag || kind.also.contains(&tag), "{}: {tag:?}", kind.model);
                }
            }
        }
    }
}

#[test]
fn riders_and_machines_have_their_tags() {
    for model in MODELS.iter().filter(|m| matches!(m.base, BaseType::Motorcycle | BaseType::Bicycle)) {
        let actor = made(model.name, model.size_m, 1);
        for tag in model.base.tags() {
            assert!(
                actor.pieces.iter().any(|p| p.mesh.parts.iter().any(|part| part.tag == *tag)),
                "{}",
                model.name
            );
        }
    }
}

#[test]
fn a_traffic_light_has_red_on_top_and_a_pole_to_the_ground() {
    let mount = LightMount { height_m: 5.2, arm_m: 4.0, pole_right: true, hangs: false };
    assert_eq!(LightMount::from_variant(mount.to_variant()), mount);
    let actor = made("light.signal", [0.36, 0.42, 1.1], mount.to_variant());
    let mesh = &actor.pieces[0].mesh;
    let middle = |bit: u32| {
        let of = |i: &usize| mesh.part(*i).surface == Surface::Lamp(bit);
        let z: Vec<f32> = (0..mesh.triangles.len()).filter(of).map(|i| mesh.corners(i)[0].z).collect();
        z.iter().sum::<f32>() / z.len() as f32
    };
    assert!(middle(lights::SIGNAL_RED) > middle(lights::SIGNAL_YELLOW));
    assert!(middle(lights::SIGNAL_YELLOW) > middle(lights::SIGNAL_GREEN));
    let pole = bounds(&actor, 0.0, |tag| tag == Tag::Pole);
    assert!(pole.min.z <= -5.2 && pole.max.y > 3.9, "{pole:?}");
}

#[test]
fn lights_for_walkers_show_who_stands_over_who_walks() {
    let post = LightMount { height_m: 2.1, arm_m: 0.0, pole_right: true, hangs: false };
    let size_m = [0.26, 0.25, 0.5];
    let [on_post, hung] = [post, LightMount { hangs: true, ..post }]
        .map(|mount| made("light.walkers", size_m, mount.to_variant()));
    for pieces in std::iter::once(&on_post.pieces).chain(on_post.coarser.iter().map(|far| &far.pieces)) {
        let mesh = &pieces[0].mesh;
        let heights = |bit: u32| {
            let lit = (0..mesh.triangles.len()).filter(|i| mesh.part(*i).surface == Surface::Lamp(bit));
            let z = lit.flat_map(|i| mesh.corners(i)).map(|p| p.z);
            z.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], z| [low.min(z), high.max(z)])
        };
        let [stands, walks] = [lights::SIGNAL_RED, lights::SIGNAL_GREEN].map(heights);
        assert!(stands[0] > walks[1] && stands[1] < 0.5 && walks[0] > 0.0, "{stands:?} {walks:?}");
    }
    assert!(bounds(&on_post, 0.0, |tag| tag == Tag::Pole).min.z <= -2.1);
    assert!(bounds(&hung, 0.0, |tag| tag == Tag::Pole).min.z >= 0.0, "it has no pole of its own");
}

#[test]
fn wheels_roll_forward_and_steer_left() {
    let wheel = Joint::Wheel { at: Vec3::new(1.4, 0.8, 0.33), steered: true, right: false };
    for (joint, top) in [
        (wheel, Vec3::Z * 0.33),
        (Joint::Wheel { at: Vec3::new(1.4, -0.8, 0.33), steered: true, right: true }, Vec3::Z * 0.33),
    ] {
        let turned = |steer_rad: f32, phase_rad: f32| {
            let posture = Posture { steer_rad, phase_rad, ..Posture::default() };
            joint.object_from_piece(&posture).expect("wheels are always there")
        };
        let rest = turned(0.0, 0.0).transform_point3(top);
        let rolled = turned(0.0, 0.1).transform_point3(top);
        assert!(rolled.x > rest.x + 0.03, "the top of a rolling wheel moves forward");
        let ahead = turned(0.2, 0.0).transform_vector3(Vec3::X);
        assert!(ahead.x.abs() > 0.97 && (ahead.y * ahead.x) > 0.1, "{ahead}");
    }
}

#[test]
fn feet_stay_on_the_pedals_and_hands_on_the_rims() {
    for name in ["bicycle.city", "bicycle.road", "walker.wheelchair"] {
        let actor = made(name, catalogue::models::find(name).expect("a model").size_m, 3);
        let rig = actor.rig.clone().expect("somebody rides");
        for step in 0..24 {
            let phase_rad = 0.5 * step as f32;
            let posture = actor.posed(Posture { phase_rad, ..Posture::default() });
            let bones = posture.bones.expect("posed");
            match &*rig {
                Rig::Rides(rider) => {
                    let steps = actor.pieces.iter().filter(|p| matches!(p.joint, Joint::Pedal { .. }));
                    for (pedal, foot) in steps.zip([Bone::FootLeft, Bone::FootRight]) {
                        let pedal = pedal.joint.object_from_piece(&posture).expect("is there").translation;
                        let ball = Vec3::new(rider.figure.ball, 0.0, -rider.figure.ankle);
                        let ball = bones.object_from_bone(foot).transform_point3(ball);
                        let off = (ball - Vec3::from(pedal)).length();
                        assert!(off < 0.03, "{name} at {phase_rad}: {off}");
                    }
                }
                Rig::Pushes(pusher) => {
                    // Never inside the rim; while it pushes, at it.
                    let figure = &pusher.figure;
                    let palm = Vec3::NEG_Z * (figure.forearm + 0.45 * figure.hand);
                    let hand = bones.object_from_bone(Bone::ForearmLeft).transform_point3(palm);
                    let off = (hand - pusher.axle) * Vec3::new(1.0, 0.0, 1.0);
                    let off = off.length() - pusher.rim_m;
                    assert!((-0.01..0.08).contains(&off), "{name} at {phase_rad}: {off}");
                }
                Rig::Walks(_) => unreachable!("they sit"),
            }
        }
    }
}

#[test]
fn doors_swing_outward_about_their_front_edge() {
    for model in MODELS.iter().filter(|m| m.wheelbase_m > 0.0) {
        let actor = made(model.name, model.size_m, 0);
        let leaves: Vec<&Piece> =
            actor.pieces.iter().filter(|p| matches!(p.joint, Joint::Door { .. })).collect();
        assert_eq!(leaves.len(), usize::from(model.doors), "{}", model.name);
        let half_width = 0.5 * model.size_m[1] as f32;
        for (number, leaf) in leaves.iter().enumerate() {
            let Joint::Door { at, door } = leaf.joint else { unreachable!("a door") };
            assert_eq!(door, number);
            // Left ones are even; rear ones lie behind front ones.
            assert_eq!(at.y > 0.0, door % 2 == 0, "{}", model.name);
            let span = |angle: f32| {
                let mut posture = Posture::default();
                posture.door_rad[door] = angle;
                let pose = leaf.joint.object_from_piece(&posture).expect("it is open");
                leaf.mesh.positions.iter().fold(Aabb::EMPTY, |b, p| b.with(pose.transform_point3(*p)))
            };
            assert!(leaf.joint.object_from_piece(&Posture::default()).is_none());
            let (closed, open) = (span(1e-4), span(1.1));
            // A leaf in the skin, of a door's size.
            let size = closed.max - closed.min;
            assert!(
                closed.min.y.abs().max(closed.max.y.abs()) < half_width + 0.01,
                "{}: {closed:?}",
                model.name
            );
            assert!((0.5..1.7).contains(&size.x) && (0.7..2.2).contains(&size.z), "{}: {size}", model.name);
            // Opened by 63 degrees its rear edge is out by 0.89 of its length, and its front edge where it
            // was.
            let outside = if at.y > 0.0 { open.max.y } else { -open.min.y };
            assert!(outside > half_width + 0.6 * size.x, "{}: {open:?}", model.name);
            assert!((open.max.x - closed.max.x).abs() < 0.12, "{}: {open:?} {closed:?}", model.name);
            let frame = actor.pieces.iter().filter(|p| p.joint == Joint::Doorway { door }).count();
            assert_eq!(frame, 1);
        }
    }
}

#[test]
fn nobody_sits_on_a_parked_two_wheeler() {
    for model in PARKED_TWO_WHEELERS {
        let pieces = made(model.name, model.size_m, 0).pieces;
        let tags: Vec<Tag> = pieces.iter().flat_map(|p| p.mesh.parts.iter().map(|part| part.tag)).collect();
        assert!(tags.iter().all(|tag| Some(tag) == model.base.tags().last()), "{}: {tags:?}", model.name);
        let b = bounds(&made(model.name, model.size_m, 0), 0.0, |_| true);
        assert!(
            b.min.z.abs() < 0.01 && (b.max.z - model.size_m[2] as f32).abs() < 0.01,
            "{}: {b:?}",
            model.name
        );
    }
}

#[test]
fn unknown_models_have_no_mesh() {
    for name in ["", "car", "car.spaceship", "building.castle", "sign", "prop.ufo", "surface.road"] {
        assert!(actor_mesh(name, [1.0; 3], 0).is_none(), "{name}");
    }
}

#[test]
fn models_without_variants_are_alike() {
    let meshes = |name: &str, size_m: [f64; 3], variant: u32| -> Vec<TriMesh> {
        let made = made(name, size_m, variant);
        let coarser = made.coarser.into_iter().flat_map(|level| level.pieces);
        let cabin = made.cabin.into_iter().flat_map(|cabin| std::iter::once(cabin.seats).chain(cabin.driver));
        let pieces = made.pieces.into_iter().chain(coarser).map(|piece| piece.mesh);
        pieces.chain(cabin).map(|mesh| TriMesh::clone(&mesh)).collect()
    };
    let names: BTreeMap<String, [f64; 3]> =
        everything().into_iter().map(|(name, size_m, _)| (name, size_m)).collect();
    let alike: Vec<_> = names.iter().filter(|(name, _)| !has_variants(name)).collect();
    assert!(alike.len() > 50 && names.len() > alike.len());
    for (name, size_m) in alike {
        let first = meshes(name, *size_m, 0);
        assert!([1, 2, 3, 17, 1 << 9].iter().all(|v| meshes(name, *size_m, *v) == first), "{name}");
    }
}
