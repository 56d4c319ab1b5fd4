//! What cameras see by a device, against the CPU: the same bits of ids and depths.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use gpu::{Answered, Eyes, GpuRenderer};
use random::Stream;
use render::cpu::CpuRenderer;
use render::{CameraQuery, Outputs, PinholeCamera, Renderer, Stipple};
use schema::geometry::{Snapshot, Surface, TriMesh};
use testkit::random_world::{grid, mesh, point, pose, soup_with_slivers, uniform};
use testkit::{camera_at, instance, snapshot};

use crate::common::{with_each, with_eyes};

/// Up, but for a hair: what is exactly up has no right and left.
const UP: Vec3 = Vec3::new(0.02, 0.0, 1.0);

fn stream(topic: &str, number: u64) -> Stream {
    Stream::new(7, 0, topic, number)
}

/// The queries' answers by both have to be equal, and come from the device. How many pixels see something.
#[track_caller]
fn hold(eyes: &Arc<Eyes>, world: &Snapshot, queries: &[CameraQuery<'_>]) -> usize {
    let (covered, seen) = compared(eyes, world, queries);
    assert_eq!(seen, Answered { by_gpu: queries.len() as u64, by_cpu: 0 });
    covered
}

#[track_caller]
fn compared(eyes: &Arc<Eyes>, world: &Snapshot, queries: &[CameraQuery<'_>]) -> (usize, Answered) {
    let mut ours = GpuRenderer::new(Arc::clone(eyes));
    ours.prepare(&world.meshes).expect("keeps meshes");
    let mut cpu = CpuRenderer::default();
    cpu.prepare(&world.meshes).expect("has no device");
    let found = ours.place(world).expect("is prepared").render(queries).expect("falls back");
    let expected = cpu.place(world).expect("is prepared").render(queries).expect("has no device");
    let mut covered = 0;
    for (number, (found, expected)) in found.iter().zip(&expected).enumerate() {
        let bits = |depth_m: &[f32]| depth_m.iter().map(|d| d.to_bits()).collect::<Vec<_>>();
        let (ours, theirs) = (bits(&found.depth_m), bits(&expected.depth_m));
        let wrong = (0..theirs.len()).find(|&i| {
            let ids = |b: &render::VisibilityBuffer| (b.instance.get(i).copied(), b.triangle.get(i).copied());
            ours[i] != theirs[i] || ids(found) != ids(expected)
        });
        if let Some(i) = wrong {
            let at = |b: &render::VisibilityBuffer| {
                (b.instance.get(i).copied(), b.triangle.get(i).copied(), b.depth_m[i])
            };
            let width = expected.width as usize;
            panic!(
                "query {number}, column {}, row {}: {:?}, not {:?}",
                i % width,
                i / width,
                at(found),
                at(expected)
            );
        }
        assert_eq!(found.instance.len(), expected.instance.len());
        assert_eq!((found.width, found.height), (expected.width, expected.height));
        covered += expected.depth_m.iter().filter(|d| d.is_finite()).count();
    }
    (covered, ours.work().views)
}

/// Cameras at random places, of sizes that fill no tile.
fn cameras(stream: &mut Stream, count: u32, reach: f32) -> Vec<PinholeCamera> {
    let camera = |i: u32| {
        let (from, along) = (point(stream, reach), point(stream, 1.0).normalize_or(Vec3::X));
        camera_at(from, along, 90 + 47 * i, 33 + 40 * (i % 3), uniform(stream, 0.4, 2.2))
    };
    (0..count).map(camera).collect()
}

#[test]
fn loose_triangles_and_shared_edges_are_seen_alike() {
    with_eyes(|eyes| {
        for number in 0..4 {
            let s = &mut stream("gpu/soup", number);
            let meshes = vec![
                soup_with_slivers(s, 300, 20.0, 4.0),
                grid(24, 30.0, Surface::Plain),
                soup_with_slivers(s, 9, 3.0, 1.0),
            ];
            let mut instances = vec![instance(1, 1, Affine3A::IDENTITY)];
            for i in 0..40 {
                instances.push(instance([0, 2, 2][i % 3], 2, pose(s, 25.0)));
            }
            let world = snapshot(meshes, instances);
            let cameras = cameras(s, 4, 15.0);
            let all = cameras.iter().flat_map(|camera| {
                let query = CameraQuery::of(*camera);
                [query, CameraQuery { outputs: Outputs::Depths, ..query }]
            });
            assert!(hold(eyes, &world, &all.collect::<Vec<_>>()) > 10_000);
        }
    });
}

#[test]
fn surfaces_in_one_plane_are_told_apart_by_their_numbers() {
    with_eyes(|eyes| {
        let meshes = vec![grid(8, 4.0, Surface::Plain), grid(5, 4.0, Surface::Plain)];
        let at = |z: f32| Affine3A::from_translation(Vec3::new(0.0, 0.0, z));
        // Twice the same, one within the other, and one exactly at the far end.
        let instances = vec![
            instance(1, 1, at(8.0)),
            instance(0, 2, at(8.0)),
            instance(0, 3, at(8.0)),
            instance(0, 4, at(20.0)),
        ];
        let world = snapshot(meshes, instances);
        let mut camera = camera_at(Vec3::ZERO, UP, 150, 100, 1.4);
        let straight = CameraQuery::of(camera);
        camera.far_m = 20.0;
        let ended = CameraQuery::of(camera);
        let depths = CameraQuery { outputs: Outputs::Depths, ..ended };
        let [some, others] = [&[1u32, 3][..], &[3]].map(|among| CameraQuery { among: Some(among), ..ended });
        assert!(hold(eyes, &world, &[straight, ended, depths, some, others]) > 10_000);
    });
}

/// Straight ahead along x, one pixel a metre at 64 m, whose depths end there.
fn straight(local_m: Vec3) -> PinholeCamera {
    let camera = camera_at(local_m, Vec3::X, 150, 90, 1.0);
    PinholeCamera { fx: 64.0, fy: 64.0, cx: 75.0, cy: 45.0, far_m: 64.0, ..camera }
}

#[test]
fn edges_through_pixel_centres_are_seen_alike() {
    with_eyes(|eyes| {
        // Upright in x = 0, corners at halves of metres; each triangle twice.
        let upright = |half: f32, n: u32| {
            let flat = grid(n, half, Surface::Plain);
            let turned = |p: &Vec3| Vec3::new(0.0, p.x + 0.5, p.y + 0.5);
            let twice = [flat.triangles.clone(), flat.triangles.clone()].concat();
            mesh(flat.positions.iter().map(turned).collect(), twice, Surface::Plain)
        };
        let meshes = vec![upright(32.0, 64), upright(24.0, 16)];
        // Exactly, and so that rounding decides on which side of an edge a centre is.
        for off in [Vec3::ZERO, Vec3::new(0.1, 0.7, -0.3), Vec3::new(1000.1, -700.7, 3.3)] {
            let at = |x: f32| Affine3A::from_translation(off + Vec3::new(x, 0.0, 0.0));
            let instances =
                vec![instance(1, 1, at(64.0)), instance(0, 2, at(64.0)), instance(0, 3, at(32.0))];
            let world = snapshot(meshes.clone(), instances);
            let query = CameraQuery::of(straight(off));
            let of = |among| CameraQuery { among: Some(among), ..query };
            let depths = CameraQuery { outputs: Outputs::Depths, ..of(&[1]) };
            let covered = hold(eyes, &world, &[query, of(&[0]), of(&[0, 1]), of(&[1]), of(&[2]), depths]);
            assert!(covered > 10_000, "{covered}");
        }
    });
}

#[test]
fn planes_through_the_camera_are_seen_alike() {
    with_eyes(|eyes| {
        let s = &mut stream("gpu/steep", 1);
        let world = snapshot(vec![grid(40, 60.0, Surface::Plain)], vec![instance(0, 1, Affine3A::IDENTITY)]);
        let cameras: Vec<PinholeCamera> = (0..12)
            .map(|i| {
                let height_m = [1.0, 0.1, 0.01, 1e-3, 1e-4, 1e-5][i / 2];
                let from = Vec3::new(uniform(s, -9.0, 9.0), uniform(s, -9.0, 9.0), height_m);
                let along = Vec3::new(1.0, uniform(s, -1.0, 1.0), uniform(s, -0.01, 0.01));
                camera_at(from, along, 160, 64, 1.5)
            })
            .collect();
        let queries: Vec<_> = cameras.iter().map(|camera| CameraQuery::of(*camera)).collect();
        assert!(hold(eyes, &world, &queries) > 10_000);
    });
}

#[test]
fn places_far_off_and_triangles_through_the_camera_are_seen_alike() {
    with_eyes(|eyes| {
        let s = &mut stream("gpu/far", 1);
        let meshes = vec![soup_with_slivers(s, 100, 8.0, 30.0), grid(3, 2000.0, Surface::Plain)];
        for off in [Vec3::ZERO, Vec3::new(3000.0, -7000.0, 20.0)] {
            let place = |s: &mut Stream| Affine3A::from_translation(off) * pose(s, 6.0);
            let mut instances: Vec<_> = (0..6).map(|i| instance(0, 1 + i, place(s))).collect();
            instances.push(instance(1, 9, Affine3A::from_translation(off - Vec3::Z)));
            let world = snapshot(meshes.clone(), instances);
            let mut all = cameras(s, 4, 5.0);
            all.iter_mut().for_each(|camera| camera.local_from_optical.translation += glam::Vec3A::from(off));
            let queries: Vec<_> = all.iter().map(|camera| CameraQuery::of(*camera)).collect();
            assert!(hold(eyes, &world, &queries) > 10_000);
        }
    });
}

#[test]
fn many_instances_and_panes_are_seen_alike() {
    with_eyes(|eyes| {
        let s = &mut stream("gpu/many", 1);
        let meshes = vec![
            soup_with_slivers(s, 2, 0.3, 2.0),
            grid(2, 1.5, Surface::Window),
            grid(1, 1.5, Surface::Plain),
        ];
        let mut instances: Vec<_> = (0..100_000).map(|_| instance(0, 1, pose(s, 120.0))).collect();
        let mut cabins = Vec::new();
        for object in 10..40 {
            let at = pose(s, 20.0);
            instances.push(instance(1, object, at));
            cabins.push(instance(2, object, at));
        }
        let world = Snapshot { cabins, ..snapshot(meshes, instances) };
        let camera = camera_at(Vec3::ZERO, Vec3::X, 320, 180, 1.6);
        let stippled = CameraQuery {
            panes: Stipple::new([[true, false], [false, true]]),
            outputs: Outputs::Depths,
            ..CameraQuery::of(camera)
        };
        let covered = hold(eyes, &world, &[CameraQuery::of(camera), stippled]);
        assert!(covered > 20_000, "{covered}");
    });
}

#[test]
fn nothing_and_hostile_meshes_are_seen_alike() {
    with_eyes(|eyes| {
        let nan = Vec3::new(f32::NAN, 0.0, 0.0);
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, nan, Vec3::splat(f32::INFINITY), Vec3::X * 1e-30];
        let triangles = vec![[0, 1, 2], [0, 0, 1], [0, 1, 3], [1, 2, 4], [0, 5, 1]];
        let at = Affine3A::from_translation(UP * 3.0);
        let (flat, bad) = (mesh(corners, triangles, Surface::Plain), Affine3A::from_translation(nan));
        let meshes = vec![flat, TriMesh::default().into()];
        let world =
            snapshot(meshes.clone(), vec![instance(0, 1, at), instance(1, 2, at), instance(0, 3, bad)]);
        let one = camera_at(Vec3::ZERO, UP, 1, 1, 1.0);
        let away = camera_at(Vec3::ZERO, -UP, 70, 70, 1.0);
        let large = camera_at(Vec3::ZERO, UP, 200, 150, 1.0);
        assert!(hold(eyes, &world, &[one, away, large].map(CameraQuery::of)) > 1000);
        // 300 times the same: no cut divides them, the tree is a list, which kernels have no room for.
        let same = mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]; 300], Surface::Plain);
        let listed = snapshot([meshes, vec![same]].concat(), vec![instance(0, 1, at), instance(2, 2, at)]);
        let (covered, seen) = compared(eyes, &listed, &[one, away, large].map(CameraQuery::of));
        assert!(covered > 1000);
        // What shows no such mesh is the device's all the same.
        assert_eq!(seen, Answered { by_gpu: 1, by_cpu: 2 });
        hold(eyes, &world, &[]);
        hold(eyes, &snapshot(Vec::new(), Vec::new()), &[CameraQuery::of(large)]);
    });
}

/// A world, and a query that sees it.
fn small_world() -> (Snapshot, CameraQuery<'static>) {
    let s = &mut stream("gpu/small", 1);
    let world = snapshot(vec![soup_with_slivers(s, 50, 5.0, 3.0)], vec![instance(0, 1, Affine3A::IDENTITY)]);
    (world, CameraQuery::of(camera_at(Vec3::new(-9.0, 0.0, 0.0), Vec3::X, 100, 60, 1.2)))
}

#[test]
fn a_device_that_is_lost_is_opened_again_once_for_a_renderer() {
    with_eyes(|eyes| {
        let (world, query) = small_world();
        let renderer = || {
            let mut ours = GpuRenderer::new(Arc::clone(eyes));
            ours.prepare(&world.meshes).expect("keeps meshes");
            ours
        };
        let see = |ours: &GpuRenderer| {
            ours.place(&world).expect("is prepared").render(&[query]).expect("falls back")
        };
        let (first, second, third) = (renderer(), renderer(), renderer());
        let before = [see(&first), see(&second)].concat();
        assert!(before[0] == before[1]);
        for by_cpu in 1..=2 {
            eyes.lose();
            // What was in hand is the CPU's; the first loss is made good, the second is not.
            for _ in 0..3 {
                assert!(see(&first) == before[..1]);
            }
            let expected = [Answered { by_gpu: 3, by_cpu: 1 }, Answered { by_gpu: 3, by_cpu: 4 }];
            assert_eq!(first.work().views, expected[by_cpu - 1]);
        }
        // Another renderer has lost its device with the first, and finds that it was given up.
        assert!(see(&second) == before[..1] && see(&third) == before[..1]);
        assert_eq!(second.work().views, Answered { by_gpu: 1, by_cpu: 1 });
        assert_eq!(third.work().views, Answered { by_gpu: 0, by_cpu: 1 });
    });
}

#[test]
fn what_does_not_fit_into_memory_is_seen_view_by_view_or_by_the_cpu() {
    // Meshes of some 10 kB; a view of four tiles answers 98 kB, and these are there twice.
    for (memory_kb, by_gpu) in [(1_000, 4), (250, 4), (120, 1), (60, 1), (40, 0), (3, 0)] {
        let open = |adapter: &gpu::Adapter| gpu::eyes(adapter, Some(memory_kb * 1000));
        with_each(open, |eyes| {
            let (world, query) = small_world();
            let small = CameraQuery::of(camera_at(Vec3::new(-9.0, 0.0, 0.0), Vec3::X, 60, 30, 1.2));
            let (covered, seen) = compared(&eyes, &world, &[query, query, small, query]);
            assert!(covered > 1000);
            assert_eq!(seen, Answered { by_gpu, by_cpu: 4 - by_gpu }, "{memory_kb} kB");
        });
    }
}
