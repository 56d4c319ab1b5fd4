//! A picture from what was seen: painted row by row, then what air and lens do to it.

use glam::Vec3;
use rayon::prelude::*;
use render::panes::Panes;
use render::{CameraView, RenderError, Scene, Surfaces, VisibilityBuffer};

use super::antialias::smooth_edges;
use super::bloom::{blocks, bloom};
use super::mirror::{Dry, Mirror, WetSpan};
use super::picture::Picture;
use super::rain::{Rain, draw_rain};
use super::shade::{Row, Shader};
use super::soften::soften;
use super::spray::Spray;
use crate::light::Lighting;

impl Picture {
    /// Lights and colours what was seen, and what is behind panes.
    ///
    /// # Errors
    /// The renderer failed.
    pub fn new(
        scene: &dyn Scene,
        view: &CameraView,
        buffer: &VisibilityBuffer,
        lighting: &Lighting,
    ) -> Result<Self, RenderError> {
        let width = buffer.width as usize;
        let mut rgb = vec![0u8; 3 * buffer.instance.len()];
        let blocks = blocks(width);
        let mut bright = vec![Vec3::ZERO; blocks * buffer.height as usize];
        let mut shader = Shader::new(view, buffer, lighting);
        let surfaces = Surfaces::new(buffer, scene.snapshot());
        let panes = Panes::of(scene);
        let rows = rgb.par_chunks_mut(3 * width).zip(bright.par_chunks_mut(blocks)).enumerate();
        let wet: Result<Vec<Vec<WetSpan>>, RenderError> = rows
            .map(|(y, (rgb, bright))| {
                shader.paint_dry(&surfaces, panes.as_ref(), Row { y: y as u32, rgb, bright })
            })
            .collect();
        let wet = wet?;
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
        Ok(picture)
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
        bloom(self, film, bright, view.settings.bloom as f32);
        smooth_edges(self);
        soften(self, film, snapshot, view, buffer);
        if lighting.rain > 0.0 {
            let world_from_local_m = lighting.around.world_from_local_m;
            let rain = Rain { strength: lighting.rain, frame: lighting.frame, world_from_local_m };
            draw_rain(self, view, buffer, rain);
        }
    }
}
