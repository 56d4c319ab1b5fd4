//! What rays meet by a device, against the CPU: the same bits of distances, ids and weights.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use gpu::{Answered, Eyes, GpuRenderer};
use random::Stream;
use render::cpu::CpuRenderer;
use render::{Hits, RayBatch, RayQuery, Renderer};
use schema::geometry::{Instance, Snapshot, Surface, TriMesh};
use testkit::random_world::{ball, grid, mesh, point, pose, soup_with_slivers, uniform};
use testkit::{instance, snapshot};

use crate::common::with_eyes;

const FAR_M: [f32; 2] = [0.0, f32::INFINITY];

fn stream(topic: &str, number: u64) -> Stream {
    Stream::new(9, 0, topic, number)
}

/// Both have to answer the same bits, the device all of it. How many rays meet something.
#[track_caller]
fn hold(eyes: &Arc<Eyes>, world: &Snapshot, queries: &[RayQuery<'_>]) -> usize {
    let (met, rays) = compared(eyes, world, queries);
    let asked: usize = queries.iter().map(|query| query.rays.directions.len()).sum();
    assert_eq!(rays, Answered { by_gpu: asked as u64, by_cpu: 0 });
    met
}

#[track_caller]
fn compared(eyes: &Arc<Eyes>, world: &Snapshot, queries: &[RayQuery<'_>]) -> (usize, Answered) {
    let mut ours = GpuRenderer::new(Arc::clone(eyes));
    ours.prepare(&world.meshes).expect("keeps meshes");
    let mut cpu = CpuRenderer::default();
    cpu.prepare(&world.meshes).expect("has no device");
    let found = ours.place(world).expect("is prepared").trace(queries).expect("falls back");
    let expected = cpu.place(world).expect("is prepared").trace(queries).expect("has no device");
    assert_eq!(found.len(), expected.len());
    for (number, (found, expected)) in found.iter().zip(&expected).enumerate() {
        assert_eq!(found.len(), expected.len());
        let bits = |hits: &Hits, i: usize| {
            let floats = [hits.t[i], hits.u[i], hits.v[i]].map(f32::to_bits);
            (floats, hits.instance[i], hits.triangle[i])
        };
        if let Some(i) = (0..expected.len()).find(|&i| bits(found, i) != bits(expected, i)) {
            let direction = queries[number].rays.directions[i];
            panic!("query {number}, ray {i}, {direction}: {:?}, not {:?}", found.get(i), expected.get(i));
        }
    }
    (expected.iter().flat_map(Hits::iter).flatten().count(), ours.work().rays)
}

/// So many directions to all sides.
fn directions(stream: &mut Stream, count: usize) -> Vec<Vec3> {
    (0..count).map(|_| point(stream, 1.0).normalize_or(Vec3::X)).collect()
}

/// A world of loose triangles, balls and a floor, of which every third instance moves.
fn world(stream: &mut Stream) -> Snapshot {
    let meshes = vec![
        grid(12, 40.0, Surface::Plain),
        ball(stream, 7, 12, 1.5),
        ball(stream, 20, 30, 4.0),
        soup_with_slivers(stream, 60, 6.0, 2.0),
        grid(2, 1.5, Surface::Window),
    ];
    let mut instances = vec![instance(0, 1, Affine3A::from_translation(Vec3::Z * -2.0))];
    for i in 0..60u16 {
        let now = pose(stream, 30.0);
        let previous_local_from_object = match i % 3 {
            0 => Affine3A::from_translation(point(stream, 1.0)) * now * pose(stream, 0.2),
            1 => Affine3A::from_translation(Vec3::NAN),
            _ => now,
        };
        let there = instance(1 + u32::from(i) % 4, 2 + i, now);
        instances.push(Instance { previous_local_from_object, ..there });
    }
    let mut cabin = |i: u16| {
        let now = pose(stream, 30.0);
        let previous_local_from_object = Affine3A::from_translation(Vec3::X * f32::from(i % 2)) * now;
        Instance { previous_local_from_object, ..instance(1, 2 + 4 * i, now) }
    };
    let cabins = (0..24u16).map(&mut cabin).collect();
    Snapshot { cabins, ..snapshot(meshes, instances) }
}

#[test]
fn rays_to_all_sides_meet_the_same() {
    with_eyes(|eyes| {
        for number in 0..3 {
            let s = &mut stream("gpu/rays", number);
            let world = world(s);
            let all = directions(s, 3000);
            let nearest_m: Vec<f32> = (0..all.len()).map(|_| uniform(s, -1.0, 20.0)).collect();
            let origins: Vec<Vec3> = (0..4).map(|_| point(s, 20.0)).collect();
            let batch = |k: usize, range_m| RayBatch {
                origin: origins[k],
                directions: &all,
                range_m,
                nearest_m: &[],
            };
            let after = RayBatch { nearest_m: &nearest_m, ..batch(0, [0.0, 25.0]) };
            let among: Vec<u32> = (0..70).filter(|i| i % 3 != 1).collect();
            let queries = [
                RayQuery::of(batch(0, FAR_M)),
                RayQuery::of(batch(1, [3.0, 12.5])),
                RayQuery::of(after),
                RayQuery { cabins: true, ..RayQuery::of(batch(2, FAR_M)) },
                RayQuery { before: 0.4, ..RayQuery::of(batch(3, FAR_M)) },
                RayQuery { before: 0.9, cabins: true, ..RayQuery::of(batch(2, [0.0, 30.0])) },
                RayQuery { among: Some(&among), ..RayQuery::of(batch(1, FAR_M)) },
                RayQuery { among: Some(&among), before: 0.7, ..RayQuery::of(batch(3, FAR_M)) },
                RayQuery { among: Some(&[]), ..RayQuery::of(batch(1, FAR_M)) },
                RayQuery::of(RayBatch { directions: &[], ..batch(0, FAR_M) }),
            ];
            let met = hold(eyes, &world, &queries);
            assert!(met > 5_000, "{met}");
        }
    });
}

#[test]
fn rays_through_edges_and_corners_meet_the_same() {
    with_eyes(|eyes| {
        // Corners at whole metres in x = 64; each triangle twice, and twice the same instance.
        let flat = grid(32, 32.0, Surface::Plain);
        let upright = flat.positions.iter().map(|p| Vec3::new(0.0, p.x, p.y)).collect();
        let twice = [flat.triangles.clone(), flat.triangles.clone()].concat();
        let meshes = vec![mesh(upright, twice, Surface::Plain)];
        for off in [Vec3::ZERO, Vec3::new(0.1, 0.7, -0.3), Vec3::new(3000.1, -7000.7, 3.3)] {
            let at = |x: f32| Affine3A::from_translation(off + Vec3::new(x, 0.0, 0.0));
            let world = snapshot(
                meshes.clone(),
                vec![instance(0, 1, at(64.0)), instance(0, 2, at(64.0)), instance(0, 3, at(96.0))],
            );
            // Through corners, along edges and diagonals; some not of unit length, so that t is exact.
            let places = (-64..=64).flat_map(|i| (-64..=64).map(move |j| (i as f32 * 0.5, j as f32 * 0.5)));
            let all: Vec<Vec3> = places.map(|(y, z)| Vec3::new(64.0, y, z)).collect();
            let batch = RayBatch { origin: off, directions: &all, range_m: [0.0, 1.0], nearest_m: &[] };
            let met = hold(eyes, &world, &[RayQuery::of(batch)]);
            assert!(met > 8_000, "{met}");
            // Within the plane, and along its edges.
            let within: Vec<Vec3> = (0..2500)
                .map(|i| {
                    Vec3::new(
                        if i % 2 == 0 { 0.0 } else { 1e-7 },
                        (i % 50) as f32 - 25.0,
                        (i / 50) as f32 - 25.0,
                    )
                })
                .collect();
            let origin = off + Vec3::new(64.0, 0.0, 0.0);
            let batch = RayBatch { origin, directions: &within, range_m: FAR_M, nearest_m: &[] };
            hold(eyes, &world, &[RayQuery::of(batch)]);
        }
    });
}

#[test]
fn hostile_rays_and_meshes_are_met_alike() {
    with_eyes(|eyes| {
        let s = &mut stream("gpu/hostile", 1);
        let nan = Vec3::new(f32::NAN, 0.0, 0.0);
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, nan, Vec3::splat(f32::INFINITY), Vec3::X * 1e-30];
        let triangles = vec![[0, 1, 2], [0, 0, 1], [0, 1, 3], [1, 2, 4], [0, 5, 1]];
        let meshes = vec![mesh(corners, triangles, Surface::Plain), TriMesh::default().into()];
        let at = Affine3A::from_translation(Vec3::Z * 3.0);
        let bad = Affine3A::from_translation(nan);
        let world =
            snapshot(meshes.clone(), vec![instance(0, 1, at), instance(1, 2, at), instance(0, 3, bad)]);
        let mut all: Vec<Vec3> = (0..2500)
            .map(|_| Vec3::new(uniform(s, -0.1, 0.4), uniform(s, -0.1, 0.4), 1.0).normalize())
            .collect();
        all.extend([
            nan,
            Vec3::splat(f32::INFINITY),
            Vec3::ZERO,
            Vec3::Z,
            -Vec3::Z,
            Vec3::X,
            Vec3::splat(1e-25),
        ]);
        let batch = RayBatch { origin: Vec3::ZERO, directions: &all, range_m: FAR_M, nearest_m: &[] };
        let within = RayBatch { origin: Vec3::Z * 3.0, ..batch };
        let never = RayBatch { range_m: [5.0, -1.0], ..batch };
        assert!(hold(eyes, &world, &[batch, within, never].map(RayQuery::of)) > 500);
        // Kernels have no room for a tree that is a list, nor for a world that is too large.
        let same = mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]; 300], Surface::Plain);
        let listed = snapshot([meshes, vec![same]].concat(), vec![instance(0, 1, at), instance(2, 2, at)]);
        let away = Affine3A::from_translation(Vec3::Z * 2e9);
        let queries = [RayQuery::of(batch), RayQuery { among: Some(&[0]), ..RayQuery::of(batch) }];
        let (met, rays) = compared(eyes, &listed, &queries);
        let each = all.len() as u64;
        assert_eq!((met > 500, rays), (true, Answered { by_gpu: each, by_cpu: each }));
        let large = snapshot(listed.meshes.to_vec(), vec![instance(0, 1, away)]);
        assert_eq!(compared(eyes, &large, &queries[..1]).1, Answered { by_gpu: 0, by_cpu: each });
        hold(eyes, &snapshot(Vec::new(), Vec::new()), &[RayQuery::of(batch)]);
    });
}

#[test]
fn many_instances_and_small_questions_are_met_alike() {
    with_eyes(|eyes| {
        let s = &mut stream("gpu/many-rays", 1);
        let meshes = vec![soup_with_slivers(s, 2, 0.3, 2.0)];
        let instances = (0..100_000).map(|_| instance(0, 1, pose(s, 120.0))).collect();
        let world = snapshot(meshes, instances);
        let all = directions(s, 4000);
        let batch = RayBatch { origin: Vec3::ZERO, directions: &all, range_m: FAR_M, nearest_m: &[] };
        let met = hold(eyes, &world, &[RayQuery::of(batch)]);
        assert!(met > 500, "{met}");
        // Few rays are not worth a call.
        let few = RayQuery::of(RayBatch { directions: &all[..100], ..batch });
        assert_eq!(compared(eyes, &world, &[few]).1, Answered::default());
    });
}
