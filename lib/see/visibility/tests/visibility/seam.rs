//! Two renderers behind one seam: the processor's trees, tiles and packets against every triangle one by one.

use glam::{Affine3A, Vec3};
use renderer::{Alone, AloneRays, RayBatch, RenderError, Renderer, SKY, Scene, Surfaces};
use schema::Tag;
use schema::geometry::{Snapshot, Surface};
use testkit::BruteRenderer;
use visibility::CpuRenderer;

use crate::common::*;

/// Calls with both renderers' scenes of a world.
fn with_both(world: &Snapshot, run: impl FnOnce(&dyn Scene, &dyn Scene)) {
    let mut renderers: [Box<dyn Renderer>; 2] =
        [Box::<CpuRenderer>::default(), Box::<BruteRenderer>::default()];
    for renderer in &mut renderers {
        // In two parts, as tiles of a world come one after the other.
        let (some, others) = world.meshes.split_at(1);
        renderer.prepare(some).unwrap();
        assert!(matches!(renderer.place(world), Err(RenderError::Unprepared { prepared: 1, .. })));
        renderer.prepare(others).unwrap();
    }
    let [cpu, brute] = &renderers;
    run(&*cpu.place(world).unwrap(), &*brute.place(world).unwrap());
}

#[test]
fn both_see_the_same_ids_depths_and_surfaces() {
    let (mut covered, mut alone) = (0, 0);
    for number in 0..2 {
        let world = world(number);
        let mut s = stream("seam/cameras", number);
        // A batch of unlike cameras.
        let cameras: Vec<_> = (0..3)
            .map(|i| {
                let from = point(&mut s, 14.0) * Vec3::new(1.0, 1.0, 0.2);
                look(from, unit(&mut s) * Vec3::new(1.0, 1.0, 0.3), 40 + 7 * i, 26, uniform(&mut s, 0.5, 2.2))
            })
            .collect();
        with_both(&world, |cpu, brute| {
            let (ours, theirs) = (cpu.look(&cameras).unwrap(), brute.look(&cameras).unwrap());
            assert_eq!([ours.len(), theirs.len()], [3; 2]);
            for (ours, theirs) in ours.iter().zip(&theirs) {
                assert_eq!(ours.camera, theirs.camera);
                assert_eq!(ours.instance, theirs.instance);
                assert_eq!(ours.triangle, theirs.triangle);
                for (a, b) in ours.depth_m.iter().zip(&theirs.depth_m) {
                    assert!(a == b || (a / b - 1.0).abs() < 1e-4, "{a} {b}");
                }
                assert_eq!(cpu.depths(&ours.camera, None).unwrap(), ours.depth_m);
                // Surface points come from ids alone, where planes are not seen edge-on.
                let (a, b) = (Surfaces::new(ours, &world), Surfaces::new(theirs, &world));
                assert_eq!(a.at(20, 13), b.at(20, 13));
                covered += ours.instance.iter().filter(|&&i| i != SKY).count();
            }
            let some: Vec<u32> = (0..world.instances.len() as u32).step_by(3).collect();
            let shots: Vec<Alone<'_>> =
                cameras.iter().map(|&camera| Alone { camera, instances: &some }).collect();
            for (ours, theirs) in cpu.look_at(&shots).unwrap().iter().zip(&brute.look_at(&shots).unwrap()) {
                assert_eq!((&ours.instance, &ours.triangle), (&theirs.instance, &theirs.triangle));
                assert!(ours.instance.iter().all(|&i| i == SKY || i % 3 == 0));
                assert_eq!(cpu.depths(&ours.camera, Some(&some)).unwrap(), ours.depth_m);
                alone += ours.instance.iter().filter(|&&i| i != SKY).count();
            }
        });
    }
    assert!(covered > 1500 && alone > 300, "{covered} {alone}");
}

/// Half of a light passes panes with something behind them, in a chequer; all others stop it.
#[test]
fn panes_are_chequered_for_light() {
    let [glass, wall, seat] =
        [([2.0, 30.0, 30.0], Surface::Window), ([1.0, 9.0, 9.0], Surface::Plain), ([0.5; 3], Surface::Plain)]
            .map(|(size, surface)| testkit::block(size, Tag::Car, surface));
    // A block of glass before half of a wall, the edge in the middle of the picture.
    let there = |mesh, object, x, y| {
        testkit::instance(mesh, object, Affine3A::from_translation(Vec3::new(x, y, -4.0)))
    };
    let bare =
        testkit::snapshot(vec![glass, wall, seat], vec![there(0, 1, 20.0, 15.0), there(1, 2, 30.0, 0.0)]);
    let with_cabin = Snapshot { cabins: vec![there(2, 1, 20.0, 3.0)], ..bare.clone() };
    // More than a tile.
    let camera = look(Vec3::ZERO, Vec3::X, 150, 80, 0.3);
    let mut renderer = CpuRenderer::default();
    renderer.prepare(&bare.meshes).unwrap();
    let of = |world: &Snapshot| {
        let scene = renderer.place(world).unwrap();
        assert_eq!(scene.depths(&camera, None).unwrap(), scene.look(&[camera]).unwrap()[0].depth_m);
        [Some(&[0, 1][..]), None].map(|among| scene.depths_through_panes(&camera, among).unwrap())
    };
    let opaque = renderer.place(&bare).unwrap().depths(&camera, None).unwrap();
    let clear = renderer.place(&bare).unwrap().depths(&camera, Some(&[1])).unwrap();
    assert!(of(&bare).iter().all(|depths| *depths == opaque), "nothing stands behind them");
    let [some, all] = of(&with_cabin);
    assert!(some == all);
    let mut behind = 0;
    for (pixel, depth) in all.iter().enumerate() {
        let stops = (pixel % 150 + pixel / 150) % 2 == 1;
        assert_eq!(*depth, if stops { opaque[pixel] } else { clear[pixel] }, "{pixel}");
        behind += u32::from(opaque[pixel] != clear[pixel]);
    }
    assert!(behind > 2000, "{behind}");
}

#[test]
fn both_hit_the_same_triangles() {
    let (mut found, mut alone_found) = (0, 0);
    for number in 10..14 {
        let world = world(number);
        let mut s = stream("seam/rays", number);
        let fans: Vec<(Vec3, Vec<Vec3>)> = [1, 0, 40, 7]
            .into_iter()
            .map(|rays| (point(&mut s, 20.0), (0..rays).map(|_| unit(&mut s)).collect()))
            .collect();
        // Every other fan asks for another nearest distance along each ray.
        let mut nearest_of = |rays: usize| (0..rays).map(|_| uniform(&mut s, 0.0, 40.0)).collect();
        let nearest_m: Vec<Vec<f32>> = fans
            .iter()
            .enumerate()
            .map(|(n, (_, rays))| nearest_of(if n % 2 == 0 { rays.len() } else { 0 }))
            .collect();
        let batches: Vec<RayBatch<'_>> = fans
            .iter()
            .zip(&nearest_m)
            .map(|((origin, directions), nearest_m)| RayBatch {
                origin: *origin,
                directions,
                range_m: [9.0, 60.0],
                nearest_m,
            })
            .collect();
        with_both(&world, |cpu, brute| {
            let (ours, theirs) = (cpu.trace(&batches).unwrap(), brute.trace(&batches).unwrap());
            for ((ours, theirs), (_, directions)) in ours.iter().zip(&theirs).zip(&fans) {
                assert_eq!(ours.len(), directions.len());
                assert_eq!((&ours.instance, &ours.triangle), (&theirs.instance, &theirs.triangle));
                for (a, b) in ours.iter().zip(theirs.iter()).filter_map(|(a, b)| Some((a?, b?))) {
                    assert!(
                        (a.t / b.t - 1.0).abs() < 1e-4 && (a.u - b.u).abs().max((a.v - b.v).abs()) < 2e-3
                    );
                    found += 1;
                }
            }
            // The same rays past every other instance.
            let some: Vec<u32> = (0..world.instances.len() as u32).step_by(2).collect();
            let alone: Vec<_> =
                batches.iter().map(|rays| AloneRays { rays: *rays, instances: &some }).collect();
            let (ours, theirs) = (cpu.trace_at(&alone).unwrap(), brute.trace_at(&alone).unwrap());
            for (ours, theirs) in ours.iter().zip(&theirs) {
                assert_eq!((&ours.instance, &ours.triangle), (&theirs.instance, &theirs.triangle));
                assert!(ours.instance.iter().all(|&i| i == SKY || i % 2 == 0));
                alone_found += ours.iter().flatten().count();
            }
        });
    }
    assert!(found > 50 && alone_found > 20, "{found} {alone_found}");
}

#[test]
fn both_hit_the_same_triangles_between_frames() {
    let (mut found, mut moved) = (0, 0);
    for number in 20..23 {
        let mut world = world(number);
        let mut s = stream("seam/between", number);
        // Two of three move and turn; one of them came from nowhere.
        for (i, instance) in world.instances.iter_mut().enumerate().filter(|(i, _)| i % 3 != 0) {
            let turn = glam::Quat::from_axis_angle(unit(&mut s), uniform(&mut s, -1.0, 1.0));
            let step = glam::Affine3A::from_rotation_translation(turn, point(&mut s, 2.0));
            instance.previous_local_from_object = instance.local_from_object * step;
            if i == 4 {
                instance.previous_local_from_object.translation = glam::Vec3A::NAN;
            }
        }
        let directions: Vec<Vec3> = (0..400).map(|_| unit(&mut s)).collect();
        let origin = point(&mut s, 10.0);
        let fan = [RayBatch { origin, directions: &directions, range_m: [0.0, 15.0], nearest_m: &[] }];
        with_both(&world, |cpu, brute| {
            let now = cpu.trace(&fan).unwrap().remove(0);
            assert_eq!(cpu.trace_before(0.0, &fan).unwrap().remove(0), now);
            for before in [0.25, 0.7, 1.0] {
                let ours = cpu.trace_before(before, &fan).unwrap().remove(0);
                let theirs = brute.trace_before(before, &fan).unwrap().remove(0);
                assert_eq!((&ours.instance, &ours.triangle), (&theirs.instance, &theirs.triangle));
                for (a, b) in ours.t.iter().zip(&theirs.t).filter(|(a, _)| a.is_finite()) {
                    assert!((a / b - 1.0).abs() < 1e-4);
                    found += 1;
                }
                moved += ours.t.iter().zip(&now.t).filter(|(then, now)| then != now).count();
            }
        });
    }
    assert!(found > 300 && moved > 100, "{found} {moved}");
}

#[test]
fn both_meet_what_stands_behind_panes_if_asked_to() {
    let (mut behind, mut before_it) = (0, 0);
    for number in 30..33 {
        let mut world = world(number);
        let mut s = stream("seam/behind", number);
        // A third of all, every other one of which moves.
        world.cabins = world.instances.split_off(40);
        for instance in world.cabins.iter_mut().step_by(2) {
            let step = glam::Affine3A::from_translation(point(&mut s, 2.0));
            instance.previous_local_from_object = instance.local_from_object * step;
        }
        let directions: Vec<Vec3> = (0..400).map(|_| unit(&mut s)).collect();
        let fan = [RayBatch {
            origin: point(&mut s, 10.0),
            directions: &directions,
            range_m: [0.0, 15.0],
            nearest_m: &[],
        }];
        let alone = Snapshot { cabins: Vec::new(), ..world.clone() };
        with_both(&world, |cpu, brute| {
            let without = cpu.trace(&fan).unwrap().remove(0);
            with_both(&alone, |cpu, _| assert_eq!(cpu.trace(&fan).unwrap().remove(0), without));
            assert_eq!(cpu.trace_before(0.0, &fan).unwrap().remove(0), without);
            for before in [0.0, 0.4, 1.0] {
                let ours = cpu.trace_behind(before, &fan).unwrap().remove(0);
                let theirs = brute.trace_behind(before, &fan).unwrap().remove(0);
                assert_eq!((&ours.instance, &ours.triangle), (&theirs.instance, &theirs.triangle));
                behind += ours.instance.iter().filter(|i| (40..SKY).contains(i)).count();
                before_it += ours.instance.iter().filter(|i| **i < 40).count();
            }
        });
    }
    assert!(behind > 50 && before_it > 50, "{behind} {before_it}");
}
