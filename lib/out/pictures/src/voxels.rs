//! Voxel grids as cubes in light.

use frames::math;
use nalgebra::{Isometry3, Point3, Vector3};
use rayon::prelude::*;
use schema::Tag;

use crate::grid::{Hit, VoxelGrid};
use crate::{Camera, Canvas, PictureError, Rgb};

/// Behind everything.
const BACKGROUND: Rgb = [235, 235, 235];
/// Cubes nearer to the camera than this are not shown, metres: it may stand in a tree.
const NEAR_M: f64 = 1.5;
/// Where light comes from: behind, left and above.
const SUN: [f64; 3] = [-0.42, 0.46, 0.78];
/// Shares of the light that come from the sun and from the sky.
const SUN_SHARE: f64 = 0.62;
const SKY_SHARE: f64 = 0.46;
/// Light that each occupied neighbour of a face's corner takes away.
const CORNER_SHADE: f64 = 0.17;
/// Tags' colours are raised to this power; screens undo another one.
const TAG_POWER: f64 = 1.8;
const SCREEN_POWER: f64 = 1.0 / 2.2;
/// Haze: share of the background in what is this far away, metres.
const HAZE: f64 = 0.5;
const HAZE_M: f64 = 150.0;
/// Cubes of at least so many pixels show their edges.
const EDGE_PX: f64 = 9.0;
const EDGE_SHARE: f64 = 0.05;
const EDGE_LIGHT: f64 = 0.82;

/// Draws a grid (in its agent's frame) through a pinhole camera in a space: cubes in the colours of their
/// tags, nearer ones before farther ones, lit by a sun that throws shadows, darker where they meet.
///
/// # Errors
/// The picture is too large.
pub fn draw_voxels(
    grid: &VoxelGrid,
    camera: &Camera,
    agent_from_space: &Isometry3<f64>,
) -> Result<Canvas, PictureError> {
    let mut canvas = Canvas::new(camera.size(), BACKGROUND)?;
    let light = Light::new(grid);
    let eye = grid.in_cells(agent_from_space * camera.position());
    let colours = Tag::ALL.map(|tag| tag.viewer_rgb().map(|v| math::pow(f64::from(v) / 255.0, TAG_POWER)));
    let mut rows: Vec<&mut [u8]> = canvas.rows_mut().collect();
    rows.par_iter_mut().enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.chunks_exact_mut(4).enumerate() {
            let direction = agent_from_space * camera.direction([x as f64 + 0.5, y as f64 + 0.5]);
            // Directions are 1 long along the axis: a cell is `focal / along` pixels large.
            let length = direction.norm();
            let Some(hit) = grid.first_hit(eye, direction / grid.voxel_m(), NEAR_M / length) else {
                continue;
            };
            let colour = colours[usize::from(grid.tag(hit.cell)) % Tag::COUNT];
            let pixels = camera.focal_px() * grid.voxel_m() / hit.along;
            let at = eye + direction / grid.voxel_m() * hit.along;
            let shade = light.on(&hit, at, pixels);
            let haze = HAZE * (hit.along * length / HAZE_M).min(1.0);
            for k in 0..3 {
                let lit = 255.0 * math::pow((colour[k] * shade).min(1.0), SCREEN_POWER);
                let seen = lit + (f64::from(BACKGROUND[k]) - lit) * haze;
                pixel[k] = seen.round().clamp(0.0, 255.0) as u8;
            }
        }
    });
    Ok(canvas)
}

/// How light falls on faces.
struct Light<'g> {
    grid: &'g VoxelGrid,
    sun: Vector3<f64>,
}

impl<'g> Light<'g> {
    fn new(grid: &'g VoxelGrid) -> Self {
        Self { grid, sun: Vector3::from(SUN).normalize() }
    }

    /// Light on a place (in cells) of a face, where a cube is so many pixels large.
    fn on(&self, hit: &Hit, at: Point3<f64>, pixels: f64) -> f64 {
        let (u, v) = ((hit.axis + 1) % 3, (hit.axis + 2) % 3);
        let share = [u, v].map(|k| (at[k] - hit.cell[k] as f64).clamp(0.0, 1.0));
        // The sky is above: faces that look down see the ground's reflection of it.
        let sky = match (hit.axis, hit.outwards) {
            (2, 1) => 1.0,
            (2, _) => 0.55,
            _ => 0.8,
        };
        let facing = self.sun[hit.axis] * hit.outwards as f64;
        let mut sun = 0.0;
        if facing > 0.0 {
            // A little off the face, so that it throws no shadow on itself.
            let mut start = at;
            let face = hit.cell[hit.axis] + i64::from(hit.outwards > 0);
            start[hit.axis] = face as f64 + 1e-3 * hit.outwards as f64;
            if self.grid.first_hit(start, self.sun, 0.0).is_none() {
                sun = facing;
            }
        }
        let edge = share.iter().any(|s| *s < EDGE_SHARE || *s > 1.0 - EDGE_SHARE);
        let lines = if edge && pixels >= EDGE_PX { EDGE_LIGHT } else { 1.0 };
        lines * self.openness(hit, (u, v), share) * (SKY_SHARE * sky + SUN_SHARE * sun)
    }

    /// 1 in the open, less towards corners of the face beside which other cubes stand: evenly between its
    /// four corners.
    fn openness(&self, hit: &Hit, (u, v): (usize, usize), share: [f64; 2]) -> f64 {
        let mut outside = hit.cell;
        outside[hit.axis] += hit.outwards;
        let is_full = |du: i64, dv: i64| {
            let mut cell = outside;
            cell[u] += du;
            cell[v] += dv;
            self.grid.tag(cell) != 0
        };
        let corner = |du: i64, dv: i64| {
            let (a, b) = (is_full(du, 0), is_full(0, dv));
            // Between two walls it does not matter what is behind their corner.
            let around = if a && b { 3 } else { u8::from(a) + u8::from(b) + u8::from(is_full(du, dv)) };
            1.0 - CORNER_SHADE * f64::from(around)
        };
        let [s, t] = share;
        let low = corner(-1, -1) + (corner(1, -1) - corner(-1, -1)) * s;
        let high = corner(-1, 1) + (corner(1, 1) - corner(-1, 1)) * s;
        low + (high - low) * t
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Reach, View};

    /// A floor of road with a car-sized block of cells 6 m ahead.
    fn grid() -> VoxelGrid {
        let shape = [80, 40, 16];
        let mut tags = vec![0; shape.iter().product()];
        for x in 0..shape[0] {
            for y in 0..shape[1] {
                let column = &mut tags[(x * shape[1] + y) * shape[2]..][..shape[2]];
                column[0] = Tag::Road as u8;
                if (50..60).contains(&x) && (16..24).contains(&y) {
                    column[1..8].fill(Tag::Car as u8);
                }
            }
        }
        VoxelGrid::new(shape, tags, [-8.0, -4.0, -0.2], 0.2).expect("fits")
    }

    fn draw() -> Canvas {
        let View::Through(camera) = View::behind(Reach::Near) else { unreachable!("a camera") };
        draw_voxels(&grid(), &camera, &Isometry3::translation(0.0, 0.0, 1.8)).expect("fits")
    }

    #[test]
    fn blocks_stand_before_the_floor_and_throw_shadows() {
        let canvas = draw();
        assert_eq!(canvas.size(), [1600, 900]);
        assert_eq!(canvas.pixel([800, 10]), Some(BACKGROUND));
        let View::Through(camera) = View::behind(Reach::Near) else { unreachable!("a camera") };
        let seen = |x: f64, y: f64, z: f64| {
            let ([u, v], _) = camera.project(Point3::new(x, y, z - 1.8)).expect("is ahead");
            canvas.pixel([u as u32, v as u32]).expect("is inside")
        };
        let [r, g, b] = seen(2.0, 0.0, 0.7);
        assert!(b > 100 && r < 60 && g < 60, "the back of the car is blue: {r} {g} {b}");
        let floor = seen(-5.0, 0.0, 0.0);
        assert!(floor[0] > floor[1] && floor[2] > floor[1], "the road is purple: {floor:?}");
        // The sun is to the left: right of the car the floor is darker than on its left.
        let (sunny, shaded) = (seen(2.9, 1.9, 0.0), seen(2.9, -1.1, 0.0));
        assert!(u32::from(shaded[0]) + 20 < u32::from(sunny[0]), "{sunny:?} {shaded:?}");
    }

    #[test]
    fn threads_change_nothing() {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("starts");
            pool.install(draw).to_rgb()
        };
        assert!(on(1) == on(3));
    }
}
