//! A picture from what was seen: painted row by row, then what air and lens do to it.

use glam::Vec3;
use rayon::prelude::*;
use render::panes::Panes;
use render::{CameraView, RenderError, Scene, Surfaces, VisibilityBuffer};

use super::antialias::smooth_edges;
use super::bloom::{blocks, bloom};
use super::dazzle::halos;
use super::mirror::{Dry, Mirror, WetSpan};
use super::picture::Picture;
use super::rain::{Rain, draw_rain};
use super::shade::{BehindPanes, Row};
use super::shader::Shader;
use super::soften::soften;
use super::spray::Spray;
use crate::light::Lighting;

/// What one camera saw, to be painted.
#[derive(Clone, Copy, Debug)]
pub struct Shot<'a> {
    /// The camera.
    pub view: &'a CameraView,
    /// What it saw.
    pub seen: &'a VisibilityBuffer,
}

/// Lights and colours what cameras saw, and what is behind panes.
///
/// # Errors
/// The renderer failed.
pub fn compose(
    scene: &dyn Scene,
    shots: &[Shot<'_>],
    lighting: &Lighting,
) -> Result<Vec<Picture>, RenderError> {
    let panes = Panes::of(scene);
    let buffers: Vec<&VisibilityBuffer> = shots.iter().map(|shot| shot.seen).collect();
    let behind = BehindPanes::of(panes.as_ref(), &buffers)?;
    let picture = |(shot, behind)| Picture::new(scene, shot, (panes.as_ref(), behind), lighting);
    Ok(shots.par_iter().zip(&behind).map(picture).collect())
}

impl Picture {
    fn new(
        scene: &dyn Scene,
        shot: &Shot<'_>,
        behind: (Option<&Panes<'_>>, &BehindPanes),
        lighting: &Lighting,
    ) -> Self {
        let Shot { view, seen: buffer } = *shot;
        let width = buffer.width as usize;
        let mut rgb = vec![0u8; 3 * buffer.instance.len()];
        let blocks = blocks(width);
        let mut bright = vec![Vec3::ZERO; blocks * buffer.height as usize];
        let mut shader = Shader::new(view, buffer, lighting);
        let surfaces = Surfaces::new(buffer, scene.snapshot());
        let rows = rgb.par_chunks_mut(3 * width).zip(bright.par_chunks_mut(blocks)).enumerate();
        let wet: Vec<Vec<WetSpan>> = rows
            .map(|(y, (rgb, bright))| shader.paint_dry(&surfaces, behind, Row { y: y as u32, rgb, bright }))
            .collect();
        if wet.iter().any(|row| !row.is_empty()) {
            let dry = rgb.clone();
            let dry = Dry {
                view,
                buffer,
                rgb: dry.as_chunks::<3>().0,
                wet: &wet,
                film: &shader.film,
                vignette: shader.vignette,
                balance: shader.balance,
                sky: &lighting.sky,
                environment_map: &lighting.environment_map,
                exposure: shader.exposure,
            };
            let mirror = Mirror::new(&dry, &surfaces);
            shader.mirror = Some(mirror);
            let rows = rgb.par_chunks_mut(3 * width).zip(bright.par_chunks_mut(blocks)).zip(&wet).enumerate();
            rows.for_each(|(y, ((rgb, bright), wet))| {
                shader.paint_wet(&surfaces, wet, Row { y: y as u32, rgb, bright });
            });
        }
        let electrons = lighting.exposure.electrons();
        let mut picture = Self { width: buffer.width, height: buffer.height, rgb, electrons };
        picture.add_air_and_lens(&shader, scene, view, &bright);
        picture
    }

    /// What is between the camera and what it sees, and what the lens makes of bright and sharp things:
    /// spray, bloom, smooth edges, blur and rain, in this order.
    fn add_air_and_lens(
        &mut self,
        shader: &Shader<'_>,
        scene: &dyn Scene,
        view: &CameraView,
        bright: &[Vec3],
    ) {
        let Shader { buffer, lighting, ref film, vignette, balance, exposure, .. } = *shader;
        let snapshot = scene.snapshot();
        if lighting.around.are_wet() {
            let spray = Spray { snapshot, lighting, film, vignette, balance, exposure };
            spray.draw(self, view, buffer);
        }
        bloom(self, film, (bright, &halos(shader, view)), view.settings.bloom as f32);
        smooth_edges(self);
        soften(self, film, snapshot, view, buffer);
        if lighting.rain > 0.0 {
            let world_from_local_m = lighting.around.world_from_local_m;
            let rain = Rain { strength: lighting.rain, frame: lighting.frame, world_from_local_m };
            draw_rain(self, view, buffer, rain);
        }
    }
}
