//! What people look like: how much looks differ, and what may not be seen on them.

use std::collections::BTreeSet;

use catalogue::{BaseType, Model, models::MODELS};
use glam::Vec3;
use schema::Tag;
use schema::geometry::{Surface, TriMesh};

use crate::people::{APPEARANCES, Appearance, Beard, Bone, Bottom, Figure, Hair, Hat, Side, Walker};
use crate::solids::Detail;

fn walkers() -> impl Iterator<Item = &'static Model> {
    MODELS.iter().filter(|m| m.base == BaseType::Pedestrian && m.wheel_radius_m == 0.0)
}

fn figures() -> impl Iterator<Item = (String, Figure)> {
    walkers().flat_map(|m| (0..APPEARANCES).map(|k| (format!("{} {k}", m.name), *Walker::new(m, k).figure())))
}

fn mesh(figure: &Figure, bone: Bone) -> TriMesh {
    let made = figure.meshes(Tag::Pedestrian, Detail::Full).into_iter();
    made.filter(|(of, _)| *of == bone).map(|(_, mesh)| mesh).next().expect("has that bone")
}

#[test]
fn of_two_hundred_looks_hardly_two_are_alike() {
    let models = MODELS
        .iter()
        .filter(|m| matches!(m.base, BaseType::Pedestrian | BaseType::Bicycle | BaseType::Motorcycle));
    let all: Vec<Appearance> =
        models.flat_map(|m| (0..APPEARANCES).map(|k| Appearance::new(m, k))).take(200).collect();
    assert_eq!(all.len(), 200);
    let count = |of: &dyn Fn(&Appearance) -> String| all.iter().map(of).collect::<BTreeSet<_>>().len();
    let shapes = count(&|a| {
        format!(
            "{:?} {:?} {:?} {:?} {:?} {:?} {:?}",
            a.build, a.top, a.bottom, a.hair, a.hat, a.beard, a.shoe
        )
    });
    assert!(shapes > 150, "{shapes} shapes");
    assert!(count(&|a| format!("{:?}", a.face)) > 180, "faces are alike");
    assert!(count(&|a| format!("{:?} {:?}", a.top_rgb, a.bottom_rgb)) > 80, "clothes are alike");
    assert!(count(&|a| format!("{:?}", a.skin_rgb)) >= 7);
    // Nothing that is known how to be made is never worn.
    assert_eq!(count(&|a| format!("{:?}", a.hair)), 13);
    assert_eq!(count(&|a| format!("{:?}", a.beard)), 5);
    assert_eq!(count(&|a| format!("{:?}", a.shoe)), 3);
    let share = |is: &dyn Fn(&Appearance) -> bool| all.iter().filter(|a| is(a)).count();
    assert!((15..80).contains(&share(&|a| a.glasses)), "glasses");
    assert!((20..90).contains(&share(&|a| a.beard != Beard::None)), "beards");
    assert!(share(&|a| a.bottom == Bottom::Skirt) >= 15, "skirts");
    // Riders' helmets and jackets.
    let riders = MODELS.iter().filter(|m| m.base == BaseType::Motorcycle);
    let dressed: Vec<Appearance> =
        riders.flat_map(|m| (0..APPEARANCES).map(|k| Appearance::new(m, k).riding(true))).collect();
    let colours: BTreeSet<String> =
        dressed.iter().map(|a| format!("{:?} {:?}", a.extra_rgb, a.top_rgb)).collect();
    assert!(colours.len() > 40, "{} of {}", colours.len(), dressed.len());
}

#[test]
fn faces_have_relief() {
    let mut seen = 0;
    for (name, figure) in figures() {
        let look = figure.look;
        if look.beard != Beard::None || matches!(look.hat, Hat::Scarf | Hat::SunHat) || look.glasses {
            continue;
        }
        let head = mesh(&figure, Bone::Head);
        let skin: Vec<Vec3> = (0..head.triangles.len())
            .filter(|t| head.part(*t).rgb == look.skin_rgb)
            .flat_map(|t| head.corners(t))
            .collect();
        let m = figure.head;
        // How far ahead the skin reaches at a height and a distance from the middle, shares of the head.
        let ahead = |t: f32, y: f32| {
            let near = skin.iter().filter(|p| {
                (p.z - figure.neck_m - t * m).abs() < 0.022 * m && (p.y.abs() - y * m).abs() < 0.035 * m
            });
            near.map(|p| p.x / m).fold(f32::NEG_INFINITY, f32::max)
        };
        let (nose, lip, brow) = (ahead(0.340, 0.0), ahead(0.250, 0.0), ahead(0.555, 0.14));
        let (socket, chin, below) = (ahead(0.475, 0.14), ahead(0.055, 0.0), ahead(0.115, 0.0));
        assert!(nose - lip > 0.035, "{name}: a nose {nose} before {lip}");
        assert!(brow - socket > 0.012, "{name}: a brow {brow} over {socket}");
        assert!(chin - below > -0.030, "{name}: a chin {chin} below {below}");
        seen += 1;
    }
    assert!(seen > 50, "{seen}");
}

#[test]
fn hair_stands_off_the_skull() {
    for (name, figure) in figures() {
        let look = figure.look;
        if look.hat != Hat::None || matches!(look.hair, Hair::Bald | Hair::Thin | Hair::Crew) {
            continue;
        }
        let head = mesh(&figure, Bone::Head);
        let of = |is_hair: bool| {
            let all = (0..head.triangles.len())
                .filter(|t| (head.part(*t).rgb == look.hair_rgb) == is_hair)
                .flat_map(|t| head.corners(t));
            // Behind, over the neck.
            let back = all.filter(|p| p.z > figure.neck_m + 0.45 * figure.head);
            back.map(|p| -p.x).fold(0.0, f32::max)
        };
        let thick = of(true) - of(false);
        assert!(thick > 0.015 * figure.head, "{name} {:?}: {thick}", look.hair);
    }
}

#[test]
fn hands_have_fingers_and_shoes_have_soles() {
    for (name, figure) in figures().step_by(7) {
        let arm = mesh(&figure, Bone::ForearmLeft);
        // A cut through the fingers meets one closed outline for each.
        let z = -figure.forearm - 0.62 * figure.hand;
        let crossing = |t: usize| {
            let corners = arm.corners(t);
            corners.iter().any(|p| p.z > z) && corners.iter().any(|p| p.z < z)
        };
        let cut = (0..arm.triangles.len()).filter(|t| crossing(*t)).count();
        assert!(cut >= 4 * 8, "{name}: {cut} triangles across the fingers");
        let foot = mesh(&figure, Bone::FootLeft);
        let colours: BTreeSet<String> = foot.parts.iter().map(|part| format!("{:?}", part.rgb)).collect();
        assert!(colours.len() >= 2, "{name}: a shoe without a sole");
    }
}

#[test]
fn clothes_have_no_bands_along_limbs() {
    for (name, figure) in figures() {
        for bone in Side::BOTH.into_iter().flat_map(|side| [side.leg()[0], side.leg()[1], side.arm()[0]]) {
            let limb = mesh(&figure, bone);
            // Of clothes there is one colour; skin, socks, boots and the tails of a coat are others.
            let worn = limb.parts.iter().filter(|part| matches!(part.surface, Surface::Clothes(_)));
            let most = if figure.look.hangs() { 2 } else { 1 };
            assert!(worn.count() <= most, "{name} {bone:?}: {:?}", limb.parts);
        }
    }
}

#[test]
fn light_goes_on_over_knees_and_elbows() {
    for (name, figure) in figures() {
        for side in Side::BOTH {
            let [thigh, shin, ..] = side.leg();
            let [upper, lower] = side.arm();
            for (above, below, length) in [(thigh, shin, figure.thigh), (upper, lower, figure.upper_arm)] {
                let tilt = |bone: Bone, z: f32| {
                    let mesh = mesh(&figure, bone);
                    let near = |p: Vec3| (p.z - z).abs() < 1e-4;
                    let normals = mesh.corner_normals.iter().zip(0..).flat_map(|(normals, t)| {
                        let corners = mesh.corners(t);
                        let kept: Vec<f32> =
                            (0..3).filter(|k| near(corners[*k])).map(|k| normals[k].get().z.abs()).collect();
                        kept
                    });
                    normals.fold(0.0, f32::max)
                };
                let (above, below) = (tilt(above, -length), tilt(below, 0.0));
                assert!(above < 0.02 && below < 0.02, "{name}: normals lean by {above} and {below}");
            }
        }
    }
}
