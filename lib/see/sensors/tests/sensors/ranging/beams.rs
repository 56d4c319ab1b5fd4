//! Beams that meet more than one surface, against shares counted by hand.

use glam::Affine3A;
use render::Renderer;
use schema::geometry::{Instance, Snapshot, Surface};
use schema::{ReturnKind, Tag};
use sensors::{Lidar, LidarMoment, LidarSweep, OfBeam};
use settings::{BeamSpec, LidarSpec, Returned, ScanPattern};

use super::stream;
use crate::common::{at, block, instance, prepared, snapshot, street};

const ALL: Returned = Returned { first: true, strongest: true, last: true };

/// One beam of seven rays straight ahead.
fn beam(returned: Returned) -> LidarSpec {
    LidarSpec {
        scan: ScanPattern {
            channels: 1,
            columns: 1,
            upper_rad: 0.0,
            lower_rad: 0.0,
            horizontal_fov_rad: 0.0,
        },
        beam: BeamSpec { rays: 7, divergence_rad: 0.003, returned },
        dropoff_rate: 0.0,
        dropoff_zero_intensity: 0.0,
        noise_m: 0.0,
        ..LidarSpec::vehicle()
    }
}

/// A grey board (object 4) that covers all to the left of the beam's axis and ends a hair before it, and a
/// concrete wall (object 5) behind it.
fn sweep(board_m: f32, wall_m: f32, returned: Returned) -> LidarSweep {
    let behind = |m: f32, left: f32| at(m + 0.05, left, -20.0, 0.0);
    let instances: Vec<Instance> =
        vec![instance(0, 4, behind(board_m, 10.001)), instance(1, 5, behind(wall_m, 0.0))];
    let world = snapshot(
        vec![
            block([0.1, 20.0, 40.0], Tag::Car, Surface::Plain),
            block([0.1, 40.0, 40.0], Tag::Building, Surface::Concrete),
        ],
        instances,
    );
    let renderer = prepared(&world);
    let scene = &*renderer.place(&world).expect("all meshes are prepared");
    let lidar = Lidar::new(&beam(returned)).expect("is small");
    lidar.sweep(scene, &LidarMoment::standing(0, Affine3A::IDENTITY), &stream()).expect("has no device")
}

fn of_beam(number: &[u8]) -> Option<OfBeam> {
    let count = vec![number.len() as u8; number.len()];
    Some(OfBeam { number: number.to_vec(), count, kind: vec![ReturnKind::Surface as u8; number.len()] })
}

fn near(got: &[f32], wanted: &[f64]) {
    assert_eq!(got.len(), wanted.len());
    for (got, wanted) in got.iter().zip(wanted) {
        assert!((f64::from(*got) / wanted - 1.0).abs() < 1e-5, "{got} {wanted}");
    }
}

#[test]
fn a_half_covered_beam_gives_two_returns() {
    let both = sweep(20.0, 40.0, ALL);
    assert_eq!((both.id.as_slice(), &both.of_beam), ([4, 5].as_slice(), &of_beam(&[1, 2])));
    near(&both.x_m, &[20.0, 40.0]);
    assert_eq!(both.y_m, [0.0; 2], "a lidar does not know where in its beam a surface was");
    // Three of seven rays go to the left; the axis and three others pass the board.
    let board = 0.39 * 3.0 / 7.0 * frames::math::exp(-0.004 * 20.0);
    let wall = 0.35 * 4.0 / 7.0 * frames::math::exp(-0.004 * 40.0);
    near(&both.intensity, &[board, wall]);
    assert_eq!(both.tag, [Tag::Car as u8, Tag::Building as u8]);
}

#[test]
fn echoes_are_chosen_by_distance_and_power() {
    let none = Returned { first: false, strongest: false, last: false };
    let of = |returned| (sweep(20.0, 40.0, returned).id, sweep(20.0, 22.0, returned).id);
    assert_eq!(of(Returned { first: true, ..none }), (vec![4], vec![4]));
    assert_eq!(of(Returned { last: true, ..none }), (vec![5], vec![5]));
    // Light over squared distance: 0.167 / 400 against 0.2 / 1600 or 0.2 / 484.
    assert_eq!(of(Returned { strongest: true, ..none }), (vec![4], vec![4]));
    assert_eq!(of(Returned { first: true, strongest: true, ..none }), (vec![4], vec![4]), "once");
    assert_eq!(sweep(20.0, 40.0, Returned { strongest: true, ..none }).of_beam, of_beam(&[1]));
}

#[test]
fn surfaces_less_than_a_metre_apart_make_one_echo() {
    let one = sweep(20.0, 20.2, ALL);
    // The wall sends more of the light (0.2 against 0.193): its place and name, and the light of both.
    assert_eq!((one.id.as_slice(), &one.of_beam), ([5].as_slice(), &of_beam(&[1])));
    near(&one.x_m, &[20.2]);
    near(&one.intensity, &[(0.39 * 3.0 + 0.35 * 4.0) / 7.0 * frames::math::exp(-0.004 * 20.2)]);
}

#[test]
fn seven_rays_find_what_one_does_and_more() {
    let world = street(false);
    let renderer = prepared(&world);
    let scene = &*renderer.place(&world).expect("all meshes are prepared");
    let base = LidarSpec {
        scan: ScanPattern { channels: 32, columns: 256, ..LidarSpec::vehicle().scan },
        ..LidarSpec::vehicle().semantic()
    };
    let of = |spec: LidarSpec| {
        let moment = LidarMoment::standing(0, at(0.0, -5.0, 1.8, 0.2));
        Lidar::new(&spec).expect("is small").sweep(scene, &moment, &stream()).expect("has no device")
    };
    let one = of(base.clone());
    let seven =
        of(LidarSpec { beam: BeamSpec { rays: 7, divergence_rad: 0.003, returned: ALL }, ..base.clone() });
    let told = seven.of_beam.as_ref().expect("is told");
    // Numbers count up to the count, the nearest first.
    let (mut k, mut beams, mut several) = (0, 0, 0);
    while k < seven.len() {
        let count = usize::from(told.count[k]);
        for number in 0..count {
            assert_eq!((told.number[k + number], told.count[k + number]), (number as u8 + 1, count as u8));
        }
        several += usize::from(count > 1);
        (k, beams) = (k + count, beams + 1);
    }
    assert!(beams >= one.len() && beams < one.len() + one.len() / 10, "{beams} {}", one.len());
    assert!(several > 50 && several * 5 < beams, "{several} of {beams}");
    // A beam too narrow to meet two things is a ray.
    let narrow = of(LidarSpec { beam: BeamSpec { rays: 7, divergence_rad: 1e-9, returned: ALL }, ..base });
    assert_eq!((&narrow.x_m, &narrow.id), (&one.x_m, &one.id));
}

/// A shell of glass (object 6) from 10 to 14 m ahead, with a seat in it from 11.5 m on unless it stands
/// aside, and a wall (object 5) 25 m ahead.
fn through_glass(spec: &LidarSpec, seat_left_m: f32) -> LidarSweep {
    through(Surface::Window, spec, seat_left_m)
}

fn through(shell: Surface, spec: &LidarSpec, seat_left_m: f32) -> LidarSweep {
    let world = snapshot(
        vec![
            block([4.0, 3.0, 3.0], Tag::Car, shell),
            block([1.0, 1.0, 2.0], Tag::Car, Surface::Rubber),
            block([0.1, 40.0, 40.0], Tag::Building, Surface::Concrete),
        ],
        vec![instance(0, 6, at(12.0, 0.0, -1.5, 0.0)), instance(2, 5, at(25.05, 0.0, -20.0, 0.0))],
    );
    let world = Snapshot { cabins: vec![instance(1, 6, at(12.0, seat_left_m, -1.0, 0.0))], ..world };
    let renderer = prepared(&world);
    let scene = &*renderer.place(&world).expect("all meshes are prepared");
    let lidar = Lidar::new(spec).expect("is small");
    lidar.sweep(scene, &LidarMoment::standing(0, Affine3A::IDENTITY), &stream()).expect("has no device")
}

#[test]
fn light_passes_panes_there_and_back() {
    let bare = |range_m: f64| frames::math::exp(-0.004 * range_m);
    // Mirrored straight back, and what little glass scatters.
    let glass = bare(10.0) * 0.35;
    for rays in BeamSpec::RAYS {
        let mut spec = beam(ALL);
        spec.beam.rays = rays;
        spec.glass = true;
        let seat = through_glass(&spec, 0.0);
        near(&seat.x_m, &[10.0, 11.5]);
        if rays == 1 {
            near(&seat.intensity, &[glass, bare(11.5) * 0.06 * 0.49]);
        }
        let told = seat.of_beam.expect("returns are told apart");
        assert_eq!((told.number, told.kind), (vec![1, 2], vec![0, ReturnKind::BehindGlass as u8]));
        assert_eq!((seat.id, seat.tag), (vec![6, 6], vec![Tag::Car as u8; 2]));

        // Nothing in the way: the wall behind two panes, of which only the first is seen.
        let wall = through_glass(&spec, 1.0);
        near(&wall.x_m, &[10.0, 25.0]);
        if rays == 1 {
            near(&wall.intensity, &[glass, bare(25.0) * 0.35 * 0.49 * 0.49]);
        }
        assert_eq!((wall.id, wall.of_beam.expect("told").kind), (vec![6, 5], vec![0, 3]));
    }
    // A lidar that does not see through glass sees a shell of it.
    let mut spec = beam(ALL);
    spec.beam.rays = 1;
    let shell = through_glass(&spec, 0.0);
    near(&shell.x_m, &[10.0]);
    assert_eq!((shell.id, shell.of_beam), (vec![6], None));
}

#[test]
fn light_passes_open_doors_and_leaves_nothing_there() {
    let bare = |range_m: f64| frames::math::exp(-0.004 * range_m);
    for rays in BeamSpec::RAYS {
        let mut spec = beam(ALL);
        spec.beam.rays = rays;
        spec.glass = true;
        for (seat_left_m, x_m, share) in [(0.0, 11.5, 0.06), (1.0, 25.0, 0.35)] {
            let seen = through(Surface::Opening, &spec, seat_left_m);
            near(&seen.x_m, &[x_m]);
            if rays == 1 {
                near(&seen.intensity, &[bare(x_m) * share]);
            }
        }
    }
    // Without `glass` it is a dark slab.
    let mut spec = beam(ALL);
    spec.beam.rays = 1;
    near(&through(Surface::Opening, &spec, 0.0).x_m, &[10.0]);
}
