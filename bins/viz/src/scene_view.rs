//! All agents of a scene on its map.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use pictures::{
    Anchor, Canvas, ColourBar, ColourBy, PictureError, Rgb, Tone, View, agent_rgb, draw_boxes, draw_cloud,
    draw_ego, draw_ground, draw_plate, draw_scale_bar,
};
use scene::SensorKind;

use crate::desk::{Desk, boxes_of_all};

/// Side of the picture, pixels.
const SIDE_PX: u32 = 2000;
/// Ground shown around the agents, and the least side of the picture, metres.
const MARGIN_M: f64 = 60.0;
const LEAST_M: f64 = 160.0;
const PAPER: Rgb = [255; 3];

/// Draws the scene from above, north up: the map, lidar points by agent, boxes by class, each agent's place,
/// heading and name.
pub(crate) fn draw_scene(desk: &Desk<'_>) -> Result<Canvas, PictureError> {
    let places: Vec<Point3<f64>> =
        desk.agents.iter().map(|a| Point3::from(a.world_from_agent.translation.vector)).collect();
    let (centre, side_m) = window(&places);
    // Views have their x up: north.
    let north_up = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -std::f64::consts::FRAC_PI_2);
    let lowest = places.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    let view_from_world = Isometry3::from_parts(nalgebra::Translation3::identity(), north_up)
        * Isometry3::translation(-centre[0], -centre[1], 0.0);
    let px_per_m = f64::from(SIDE_PX) / side_m;
    let view = View::Above { centre_m: [0.0; 2], size: [SIDE_PX; 2], px_per_m };
    let (mut canvas, mut depth) = (Canvas::new([SIDE_PX; 2], PAPER)?, Vec::new());
    let text_px = desk.text_px(&canvas);
    draw_ground(&mut canvas, &view, &view_from_world, &desk.session.ground, text_px / 16.0);
    let by = desk.colour.unwrap_or(ColourBy::Agent);
    for (agent, rig) in desk.agents.iter().zip(desk.rigs) {
        for name in rig.names(SensorKind::Lidar) {
            let Some(cloud) = agent.clouds.get(name) else { continue };
            let placed = view_from_world * agent.world_from_agent * rig.agent_from(name);
            let how = (by, lowest, agent.position);
            draw_cloud(&mut canvas, &mut depth, &view, (cloud, &placed), how, 2)?;
        }
    }
    draw_boxes(&mut canvas, &view, &view_from_world, &boxes_of_all(desk.agents), 0.045 * text_px);
    for agent in desk.agents {
        let pose = view_from_world * agent.world_from_agent;
        let body = agent.body.map(|corners| corners.map(|corner| view_from_world * corner));
        draw_ego(&mut canvas, &view, &pose, body.as_ref(), 0.5 * text_px);
        mark(&mut canvas, &view, &pose, agent_rgb(agent.position), (&agent.agent.to_string(), text_px));
    }
    draw_scale_bar(&mut canvas, px_per_m, text_px, true);
    if let Some(bar) = ColourBar::of(by) {
        bar.draw(&mut canvas, Tone::Light, text_px);
    }
    Ok(canvas)
}

/// Middle and side of a square around the agents, metres, so that it does not jump from frame to frame: its
/// middle moves with them, its side grows in steps.
fn window(places: &[Point3<f64>]) -> ([f64; 2], f64) {
    if places.is_empty() {
        return ([0.0; 2], LEAST_M);
    }
    let range = |k: usize| {
        let along = places.iter().map(move |p| p[k]);
        [along.clone().fold(f64::INFINITY, f64::min), along.fold(f64::NEG_INFINITY, f64::max)]
    };
    let (x, y) = (range(0), range(1));
    let needed = (x[1] - x[0]).max(y[1] - y[0]) + 2.0 * MARGIN_M;
    let side = (needed.max(LEAST_M) / 20.0).ceil() * 20.0;
    ([0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])], side)
}

/// An agent: an arrow ahead from its middle, and its name.
fn mark(canvas: &mut Canvas, view: &View, pose: &Isometry3<f64>, rgb: Rgb, (name, text_px): (&str, f64)) {
    let Some((at, _)) = view.project(Point3::from(pose.translation.vector)) else { return };
    let ahead = pose.rotation * Vector3::x();
    // On the picture: x of space up, y to the left.
    let (dx, dy) = (-ahead.y, -ahead.x);
    let tip = [at[0] + 1.7 * text_px * dx, at[1] + 1.7 * text_px * dy];
    let (back, aside) = (0.5 * text_px, 0.34 * text_px);
    let wing = |side: f64| [tip[0] - back * dx - side * aside * dy, tip[1] - back * dy + side * aside * dx];
    let lines = [vec![at, tip], vec![wing(1.0), tip, wing(-1.0)]];
    for (width, rgb) in [(0.32 * text_px, PAPER), (0.18 * text_px, rgb)] {
        canvas.lines(lines.iter().map(Vec::as_slice), width, rgb);
    }
    let label_at = [at[0] + 0.7 * text_px, at[1] - 0.6 * text_px];
    draw_plate(canvas, label_at, Anchor::Start, text_px, rgb, name);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_agents_are_in_the_window() {
        let places = [[0.0, 0.0, 0.0], [130.0, 40.0, 3.0]].map(Point3::from);
        let (centre, side) = window(&places);
        assert_eq!((centre, side), ([65.0, 20.0], 260.0));
        assert_eq!(window(&places[..1]), ([0.0, 0.0], LEAST_M));
        assert_eq!(window(&[]), ([0.0; 2], LEAST_M));
    }
}
