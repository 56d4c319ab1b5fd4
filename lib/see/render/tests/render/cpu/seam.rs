//! Two renderers behind one seam: the processor's trees, tiles and packets against every triangle one by one.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use render::cpu::CpuRenderer;
use render::{
    CameraModel, CameraQuery, CameraView, Hits, Outputs, PinholeCamera, RayBatch, RayQuery, RenderError,
    Renderer, SKY, Scene, Stipple, Surfaces, ViewQuery, VisibilityBuffer, render_views,
};
use schema::Tag;
use schema::geometry::{Snapshot, Surface};
use testkit::BruteRenderer;

use crate::cpu::common::*;

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

/// Depths alone.
fn depths(scene: &dyn Scene, camera: &PinholeCamera, among: Option<&[u32]>, panes: Stipple) -> Vec<f32> {
    let query = CameraQuery { camera: *camera, among, outputs: Outputs::Depths, panes };
    let seen = scene.render(&[query]).unwrap().remove(0);
    assert!(seen.instance.is_empty() && seen.triangle.is_empty());
    seen.depth_m
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
                camera_at(
                    from,
                    unit(&mut s) * Vec3::new(1.0, 1.0, 0.3),
                    40 + 7 * i,
                    26,
                    uniform(&mut s, 0.5, 2.2),
                )
            })
            .collect();
        with_both(&world, |cpu, brute| {
            let queries: Vec<_> = cameras.iter().map(|&camera| CameraQuery::of(camera)).collect();
            let (ours, theirs) = (cpu.render(&queries).unwrap(), brute.render(&queries).unwrap());
            assert_eq!([ours.len(), theirs.len()], [3; 2]);
            for (ours, theirs) in ours.iter().zip(&theirs) {
                assert_eq!(ours.camera, theirs.camera);
                assert_eq!(ours.instance, theirs.instance);
                assert_eq!(ours.triangle, theirs.triangle);
                for (a, b) in ours.depth_m.iter().zip(&theirs.depth_m) {
                    assert!(a == b || (a / b - 1.0).abs() < 1e-4, "{a} {b}");
                }
                assert_eq!(depths(cpu, &ours.camera, None, Stipple::OPAQUE), ours.depth_m);
                // Surface points come from ids alone, where planes are not seen edge-on.
                let (a, b) = (Surfaces::new(ours, &world), Surfaces::new(theirs, &world));
                assert_eq!(a.at(20, 13), b.at(20, 13));
                covered += ours.instance.iter().filter(|&&i| i != SKY).count();
            }
            let some: Vec<u32> = (0..world.instances.len() as u32).step_by(3).collect();
            let queries: Vec<_> =
                queries.iter().map(|query| CameraQuery { among: Some(&some), ..*query }).collect();
            for (ours, theirs) in cpu.render(&queries).unwrap().iter().zip(&brute.render(&queries).unwrap()) {
                assert_eq!((&ours.instance, &ours.triangle), (&theirs.instance, &theirs.triangle));
                assert!(ours.instance.iter().all(|&i| i == SKY || i % 3 == 0));
                assert_eq!(depths(cpu, &ours.camera, Some(&some), Stipple::OPAQUE), ours.depth_m);
                alone += ours.instance.iter().filter(|&&i| i != SKY).count();
            }
        });
    }
    assert!(covered > 1500 && alone > 300, "{covered} {alone}");
}

/// Panes with something behind them are opaque where the pattern says so; all other surfaces stop everything.
#[test]
fn panes_are_stippled_if_asked_for() {
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
    let camera = camera_at(Vec3::ZERO, Vec3::X, 150, 80, 0.3);
    let mut renderer = CpuRenderer::default();
    renderer.prepare(&bare.meshes).unwrap();
    let (scene, cabin) = (renderer.place(&bare).unwrap(), renderer.place(&with_cabin).unwrap());
    let opaque = depths(&*scene, &camera, None, Stipple::OPAQUE);
    let clear = depths(&*scene, &camera, Some(&[1]), Stipple::OPAQUE);
    assert_eq!(depths(&*cabin, &camera, None, Stipple::OPAQUE), opaque);
    for pattern in [[[false, true], [true, false]], [[true, true], [false, true]], [[false; 2]; 2]] {
        let panes = Stipple::new(pattern);
        for among in [Some(&[0, 1][..]), None] {
            assert_eq!(depths(&*scene, &camera, among, panes), opaque, "nothing is behind them");
            let stippled = depths(&*cabin, &camera, among, panes);
            let query = CameraQuery { among, panes, ..CameraQuery::of(camera) };
            let seen = cabin.render(&[query]).unwrap().remove(0);
            assert_eq!(seen.depth_m, stippled);
            let mut behind = 0;
            for (pixel, depth) in stippled.iter().enumerate() {
                let stops = pattern[pixel / 150 % 2][pixel % 150 % 2];
                assert_eq!(*depth, if stops { opaque[pixel] } else { clear[pixel] }, "{pixel}");
                let is_glass = opaque[pixel] != clear[pixel];
                assert!(seen.instance[pixel] == u32::from(!(stops && is_glass)) || depth.is_infinite());
                behind += u32::from(is_glass);
            }
            assert!(behind > 2000, "{behind}");
        }
    }
    let mut brute = BruteRenderer::default();
    brute.prepare(&with_cabin.meshes).unwrap();
    let query =
        CameraQuery { panes: Stipple::new([[false, true], [true, false]]), ..CameraQuery::of(camera) };
    let [ours, theirs] = [cabin.render(&[query]), brute.place(&with_cabin).unwrap().render(&[query])]
        .map(|seen| seen.unwrap().remove(0));
    assert_eq!((ours.instance, ours.triangle), (theirs.instance, theirs.triangle));
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
        let batches: Vec<RayQuery<'_>> = fans
            .iter()
            .zip(&nearest_m)
            .map(|((origin, directions), nearest_m)| {
                RayQuery::of(RayBatch { origin: *origin, directions, range_m: [9.0, 60.0], nearest_m })
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
                batches.iter().map(|query| RayQuery { among: Some(&some), ..*query }).collect();
            let (ours, theirs) = (cpu.trace(&alone).unwrap(), brute.trace(&alone).unwrap());
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
        let fan =
            RayQuery::of(RayBatch { origin, directions: &directions, range_m: [0.0, 15.0], nearest_m: &[] });
        let some: Vec<u32> = (0..world.instances.len() as u32).step_by(2).collect();
        with_both(&world, |cpu, brute| {
            let now = cpu.trace(&[fan]).unwrap().remove(0);
            // Many moments in one call.
            let queries = [0.25, 0.7, 1.0, 0.7].map(|before| RayQuery { before, ..fan });
            let queries = [queries.as_slice(), &[RayQuery { among: Some(&some), ..queries[1] }]].concat();
            let answers = cpu.trace(&queries).unwrap();
            assert_eq!(answers[1], answers[3]);
            for ((query, ours), theirs) in queries.iter().zip(answers).zip(brute.trace(&queries).unwrap()) {
                assert_eq!(cpu.trace(&[*query]).unwrap()[0], ours);
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
        let origin = point(&mut s, 10.0);
        let fan =
            RayQuery::of(RayBatch { origin, directions: &directions, range_m: [0.0, 15.0], nearest_m: &[] });
        let alone = Snapshot { cabins: Vec::new(), ..world.clone() };
        with_both(&world, |cpu, brute| {
            let without = cpu.trace(&[fan]).unwrap().remove(0);
            with_both(&alone, |cpu, _| assert_eq!(cpu.trace(&[fan]).unwrap().remove(0), without));
            for before in [0.0, 0.4, 1.0] {
                let queries = [true, false].map(|cabins| RayQuery { before, cabins, ..fan });
                let answers = cpu.trace(&queries).unwrap();
                with_both(&alone, |cpu, _| assert_eq!(cpu.trace(&queries[1..]).unwrap()[0], answers[1]));
                let ours = &answers[0];
                let theirs = brute.trace(&queries).unwrap().remove(0);
                assert_eq!((&ours.instance, &ours.triangle), (&theirs.instance, &theirs.triangle));
                behind += ours.instance.iter().filter(|i| (40..SKY).contains(i)).count();
                before_it += ours.instance.iter().filter(|i| **i < 40).count();
            }
        });
    }
    assert!(behind > 50 && before_it > 50, "{behind} {before_it}");
}

/// Answers all cameras but the last.
struct Forgetful<'a>(&'a dyn Scene);

impl Scene for Forgetful<'_> {
    fn snapshot(&self) -> &Snapshot {
        self.0.snapshot()
    }

    fn render(&self, queries: &[CameraQuery<'_>]) -> Result<Vec<VisibilityBuffer>, RenderError> {
        self.0.render(&queries[1..])
    }

    fn trace(&self, queries: &[RayQuery<'_>]) -> Result<Vec<Hits>, RenderError> {
        self.0.trace(queries)
    }
}

#[test]
fn a_question_without_an_answer_is_an_error() {
    let rig = settings::Rig::vehicle();
    let view = CameraView {
        local_from_optical: camera_at(Vec3::ZERO, Vec3::X, 8, 6, 1.0).local_from_optical,
        previous_local_from_optical: Affine3A::IDENTITY,
        model: Arc::new(CameraModel::new(&rig.cameras[0].optics).unwrap()),
        settings: rig.camera,
    };
    let query = ViewQuery::of(&view);
    with_both(&world(0), |cpu, _| {
        assert_eq!(render_views(cpu, &[query, query]).unwrap().len(), 2);
        let forgotten = render_views(&Forgetful(cpu), &[query, query]);
        assert!(matches!(forgotten, Err(RenderError::Unanswered { asked: 2, answered: 1 })));
    });
}
