//! All agents of a scene on its map.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use pictures::{
    Anchor, Canvas, ColourBy, PictureError, Rgb, View, agent_rgb, draw_boxes, draw_cloud, draw_ground,
};
use scene::SensorKind;

use crate::desk::{Desk, boxes_of_all};

/// Side of the picture, pixels.
const SIDE_PX: u32 = 2000;
/// Ground shown around the agents, and the least side of the picture, metres.
const MARGIN_M: f64 = 60.0;
const LEAST_M: f64 = 160.0;
const PAPER: Rgb = [255; 3];
const INK: Rgb = [28, 32, 38];
/// Length of an agent's arrow, and sizes of texts, pixels.
const ARROW_PX: f64 = 46.0;
const LABEL_PX: f64 = 30.0;
const SCALE_PX: f64 = 26.0;

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
    draw_ground(&mut canvas, &view, &view_from_world, &desk.session.ground);
    for (agent, rig) in desk.agents.iter().zip(desk.rigs) {
        for name in rig.names(SensorKind::Lidar) {
            let Some(cloud) = agent.clouds.get(name) else { continue };
            let placed = view_from_world * agent.world_from_agent * rig.agent_from(name);
            let how = (desk.colour.unwrap_or(ColourBy::Agent), lowest, agent.position);
            draw_cloud(&mut canvas, &mut depth, &view, (cloud, &placed), how, 2)?;
        }
    }
    draw_boxes(&mut canvas, &view, &view_from_world, &boxes_of_all(desk.agents), 1.2);
    for agent in desk.agents {
        let pose = view_from_world * agent.world_from_agent;
        mark(&mut canvas, &view, &pose, agent_rgb(agent.position), &agent.agent.to_string());
    }
    scale_bar(&mut canvas, px_per_m);
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

/// An agent: a disc with an arrow ahead, and its name.
fn mark(canvas: &mut Canvas, view: &View, pose: &Isometry3<f64>, rgb: Rgb, name: &str) {
    let Some((at, _)) = view.project(Point3::from(pose.translation.vector)) else { return };
    let ahead = pose.rotation * Vector3::x();
    // On the picture: x of space up, y to the left.
    let (dx, dy) = (-ahead.y, -ahead.x);
    let tip = [at[0] + ARROW_PX * dx, at[1] + ARROW_PX * dy];
    let wing = |side: f64| [tip[0] - 14.0 * dx - side * 9.0 * dy, tip[1] - 14.0 * dy + side * 9.0 * dx];
    let lines = [vec![at, tip], vec![wing(1.0), tip, wing(-1.0)], vec![at, at]];
    for (width, rgb) in [(9.0, PAPER), (5.0, rgb)] {
        canvas.lines(lines[..2].iter().map(Vec::as_slice), width, rgb);
    }
    let [x, y] = at;
    let ring: Vec<[f64; 2]> = (0..32)
        .map(|i| {
            let (sin, cos) = frames::math::sin_cos(f64::from(i) * std::f64::consts::PI / 16.0);
            [x + 10.0 * cos, y + 10.0 * sin]
        })
        .collect();
    canvas.area([ring.as_slice()], rgb, 255);
    let text_at = [x + 18.0, y - 16.0];
    let length = mapview::Lettering::new(name, LABEL_PX).length_px;
    canvas.rectangle([text_at[0] - 6.0, text_at[1] - LABEL_PX + 2.0], [length + 12.0, LABEL_PX + 4.0], PAPER);
    canvas.text(text_at, Anchor::Start, LABEL_PX, rgb, name);
}

/// How long 20 m are, at the bottom left, and where north is.
fn scale_bar(canvas: &mut Canvas, px_per_m: f64) {
    let [_, height] = canvas.size().map(f64::from);
    let (left, base, length) = (40.0, height - 44.0, 20.0 * px_per_m);
    canvas.rectangle([left - 16.0, base - 56.0], [length + 100.0, 82.0], PAPER);
    let bar = [
        vec![[left, base], [left + length, base]],
        vec![[left, base - 8.0], [left, base + 8.0]],
        vec![[left + length, base - 8.0], [left + length, base + 8.0]],
    ];
    canvas.lines(bar.iter().map(Vec::as_slice), 4.0, INK);
    canvas.text([left, base - 18.0], Anchor::Start, SCALE_PX, INK, "20 m");
    let x = left + length + 50.0;
    let arrow = [
        vec![[x, base + 10.0], [x, base - 26.0]],
        vec![[x - 8.0, base - 14.0], [x, base - 26.0], [x + 8.0, base - 14.0]],
    ];
    canvas.lines(arrow.iter().map(Vec::as_slice), 4.0, INK);
    canvas.text([x, base - 32.0], Anchor::Middle, 0.8 * SCALE_PX, INK, "N");
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
