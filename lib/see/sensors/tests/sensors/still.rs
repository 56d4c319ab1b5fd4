//! Shadow maps of static objects are kept: pictures are as without them, and never depend on which camera
//! asked first.

use crate::common::{first_frame, optics, standing_view, street, with_scene};
use frames::{LocalOrigin, Pose, World};
use glam::{DVec3, Vec3A};
use render::cpu::CpuRenderer;
use render::{CameraQuery, Renderer};
use schema::ObjectId;
use schema::geometry::Snapshot;
use schema::tables::Weather;
use shading::{CpuPainter, FrameWeather, Painter, Shot, StillWorld};

/// A street of which every third object moves.
struct Street {
    all: Snapshot,
    /// What it tells of them, to be wrong on purpose.
    tells: Tells,
}

#[derive(Clone, Copy, PartialEq)]
enum Tells {
    Truth,
    NothingStands,
    NothingMoves,
}

impl Street {
    /// The street in the local frame of another place.
    fn seen_from(&self, place_m: [f64; 3]) -> Snapshot {
        let origin = LocalOrigin::near(place_m);
        let by = DVec3::from_array(self.all.origin.world_xyz()) - DVec3::from_array(origin.world_xyz());
        let mut all = self.all.clone();
        all.origin = origin;
        for instance in &mut all.instances {
            instance.local_from_object.translation += Vec3A::from(by.as_vec3());
            instance.previous_local_from_object = instance.local_from_object;
        }
        all
    }
}

impl StillWorld for Street {
    fn around(&self, centre_world_m: [f64; 3], _nearer_m: f64, _detail_m: f64) -> Snapshot {
        let mut all = self.seen_from(centre_world_m);
        all.instances.retain(|i| !i.object.is_multiple_of(3) && self.tells != Tells::NothingStands);
        all
    }

    fn moves(&self, object: ObjectId) -> bool {
        object.is_multiple_of(3) && self.tells != Tells::NothingMoves
    }
}

/// The picture of an agent that stands somewhere in the street.
fn painted(street: &Street, painter: &dyn Painter, when: &FrameWeather, x_m: f64) -> Vec<u8> {
    let place_m = [x_m, -5.2, 0.0];
    let snapshot = street.seen_from(place_m);
    let pose = Pose::<World, frames::Agent>::from_xyz_rpy(place_m, [0.0; 3]);
    let view = standing_view(place_m, [0.0; 3], optics(320, 180));
    let camera = render::CameraView {
        local_from_optical: {
            // The common view is in the frame of the world's origin.
            let mut moved = view.local_from_optical;
            moved.translation -= Vec3A::from(DVec3::from_array(snapshot.origin.world_xyz()).as_vec3());
            moved
        },
        ..view
    };
    with_scene(&snapshot, |scene| {
        let seen = scene.render(&[CameraQuery::of(camera.pinhole())]).expect("has no device").remove(0);
        let place = snapshot.origin.local_from_world(pose.xyz());
        let shots = [Shot { view: &camera, seen: &seen }];
        painter.paint(scene, when, place, &shots).expect("has no device").remove(0).rgb
    })
}

#[test]
fn kept_maps_cast_the_shadows_of_the_moment() {
    let world = Street { all: street(false), tells: Tells::Truth };
    assert!(world.all.instances.iter().any(|i| world.moves(i.object)));
    let mut renderer = CpuRenderer::default();
    renderer.prepare(&world.all.meshes).expect("has no device");
    let keeping = CpuPainter::new(&renderer, &world);
    let forgetful = CpuPainter::default();
    let weather = Weather { sun_altitude_deg: 40.0, sun_azimuth_deg: 150.0, ..Weather::default() };
    let wrong = [Tells::NothingStands, Tells::NothingMoves].map(|tells| Street { all: street(false), tells });
    for is_steady in [false, true] {
        let when = FrameWeather { is_steady, ..first_frame(&weather) };
        for x_m in [0.0, 6.3] {
            let plain = painted(&world, &forgetful, &when, x_m);
            let far_off = |painter: &dyn Painter| {
                let kept = painted(&world, painter, &when, x_m);
                kept.iter().zip(&plain).filter(|(a, b)| a.abs_diff(**b) > 8).count() * 200 / kept.len()
            };
            // Rounded light moves edges of shadows by a few centimetres: less than half a percent.
            assert_eq!(far_off(&keeping), 0, "{is_steady} {x_m}");
            for wrong in wrong.iter().filter(|_| is_steady) {
                assert!(far_off(&CpuPainter::new(&renderer, wrong)) > 0, "{x_m}");
            }
        }
    }
}

#[test]
fn pictures_do_not_depend_on_who_asked_before() {
    let world = Street { all: street(false), tells: Tells::Truth };
    let mut renderer = CpuRenderer::default();
    renderer.prepare(&world.all.meshes).expect("has no device");
    let when = FrameWeather { is_steady: true, ..first_frame(&Weather::default()) };
    let places = [0.0, 0.4, 3.7, 9.9, -21.0];
    let one_by_one: Vec<Vec<u8>> =
        places.iter().map(|x| painted(&world, &CpuPainter::new(&renderer, &world), &when, *x)).collect();
    for order in [[0, 1, 2, 3, 4], [4, 2, 0, 3, 1]] {
        let painter = CpuPainter::new(&renderer, &world);
        for i in order {
            assert_eq!(painted(&world, &painter, &when, places[i]), one_by_one[i], "{order:?}: {i}");
        }
    }
    // Many threads at once, which want the same maps.
    let painter = CpuPainter::new(&renderer, &world);
    std::thread::scope(|scope| {
        let at_once: Vec<_> =
            places.iter().map(|x| scope.spawn(|| painted(&world, &painter, &when, *x))).collect();
        for (i, picture) in at_once.into_iter().enumerate() {
            assert_eq!(picture.join().expect("paints"), one_by_one[i], "{i}");
        }
    });
}
