//! Radar cross-sections of whole things, by the side that they show.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use meshes::actors::{Posture, actor_mesh};
use render::Renderer;
use sensors::RadarMotion;
use settings::{RadarSpec, Rig};

use super::radar;
use crate::common::{at, instance, prepared, snapshot};

/// All returns of a model together, dBsm: from 25 m off and 0.6 m up, over angles 5 degrees to either side of
/// a view.
fn section_dbsm(model: &str, size_m: [f64; 3], view_deg: f32) -> f64 {
    let made = actor_mesh(model, size_m, 3).expect("there is such a model");
    let posture = made.posed(Posture::default());
    let meshes: Vec<_> = made.pieces.iter().map(|piece| Arc::clone(&piece.mesh)).collect();
    let views = 11;
    let seen = |k: i32| {
        // The thing turns, the radar looks along x.
        let turn = 180.0 - (view_deg - 5.0 + k as f32);
        let place = at(25.0, 0.0, 0.0, turn.to_radians());
        let pieces = (0..).zip(&made.pieces);
        let shown = pieces
            .filter_map(|(i, piece)| Some(instance(i, 2, place * piece.joint.object_from_piece(&posture)?)));
        let snapshot = snapshot(meshes.clone(), shown.collect());
        let renderer = prepared(&snapshot);
        let scene = &*renderer.place(&snapshot).expect("all meshes are prepared");
        let pose = Affine3A::from_translation(Vec3::new(0.0, 0.0, 0.6));
        let motion = RadarMotion { local_from_sensor: pose, previous_local_from_sensor: pose, own: None };
        let spec = RadarSpec { rays: 30_000, ..Rig::vehicle().radars[1].clone() };
        let returns = radar(scene, &spec, &motion, 0);
        returns.rcs_dbsm.iter().map(|dbsm| frames::math::pow(10.0, 0.1 * f64::from(*dbsm))).sum::<f64>()
    };
    10.0 * frames::math::log10((0..views).map(seen).sum::<f64>() / f64::from(views))
}

#[test]
fn cars_show_most_to_who_looks_at_a_side() {
    let model = catalogue::models::vehicles().find(|m| m.name == "car.sedan").expect("is a model");
    let [front, corner, side, rear] =
        [0.0, 45.0, 90.0, 180.0].map(|view| section_dbsm("car.sedan", model.size_m, view));
    let all = format!("front {front:.1}, corner {corner:.1}, side {side:.1}, rear {rear:.1}");
    assert!(side > rear.max(front) + 5.0 && side > corner + 8.0 && rear.min(front) > corner, "{all}");
    // As `echo.rs` says.
    for (got, want) in [(front, 3.0), (corner, 2.5), (side, 14.0), (rear, 7.0)] {
        assert!((got - want).abs() < 1.0, "{all}");
    }
}

#[test]
fn people_are_where_measured_ones_are() {
    // -8 dBsm on average, whichever way they are turned.
    let model = catalogue::models::walkers().next().expect("is one");
    for view in [0.0, 90.0] {
        let got = section_dbsm(model.name, [0.5, 0.6, 1.75], view);
        assert!((got + 8.0).abs() < 2.5, "{view}: {got:.1}");
    }
}
