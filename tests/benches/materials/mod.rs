//! Where shading goes: each material by itself.

use std::collections::BTreeMap;

use render::CameraView;
use render::{SKY, Surfaces, VisibilityBuffer};
use schema::geometry::{Snapshot, Surface};

use crate::{Taken, best};

/// What one material takes.
pub(crate) struct Material {
    pub(crate) name: &'static str,
    pub(crate) pixels: u64,
    /// Neighbours in a row that see one triangle.
    pub(crate) spans: u64,
    pub(crate) taken: Taken,
}

fn name_of(surface: &Surface) -> &'static str {
    match surface {
        Surface::Plain => "plain",
        Surface::Paint => "paint",
        Surface::Glass => "glass",
        Surface::Window => "window",
        Surface::Opening => "opening",
        Surface::Metal => "metal",
        Surface::Reflector => "reflector",
        Surface::Rubber => "rubber",
        Surface::Cloth => "cloth",
        Surface::Clothes(_) => "clothes",
        Surface::Asphalt | Surface::KerbedAsphalt(_) => "asphalt",
        Surface::RoadMarking => "road marking",
        Surface::Concrete | Surface::Paving(_) => "concrete",
        Surface::Grass => "grass",
        Surface::Foliage => "foliage",
        Surface::Wood => "wood",
        Surface::Gravel => "gravel",
        Surface::RoofTiles => "roof tiles",
        Surface::Facade(_) => "facade",
        Surface::Lamp(_) => "lamp",
        Surface::Textured(_) => "textures of a pack",
    }
}

/// The sky and every material that cameras see, those with most pixels first. A material's time is that of
/// pictures in which sky is painted where others are, less what this sky takes; so are the edges between
/// materials, which differ in such pictures.
pub(crate) fn shares(
    snapshot: &Snapshot,
    views: &[CameraView],
    seen: &[VisibilityBuffer],
    paint: impl Fn(&[VisibilityBuffer]),
) -> Vec<Material> {
    let mut found: BTreeMap<&'static str, (u64, u64)> = BTreeMap::new();
    let mut names: Vec<Vec<&'static str>> = Vec::new();
    for buffer in seen {
        let surfaces = Surfaces::new(buffer, snapshot);
        let mut of_pixels = Vec::with_capacity(buffer.instance.len());
        for y in 0..buffer.height {
            surfaces.for_each_span(y, |columns, facet| {
                let name = facet.map_or("sky", |facet| name_of(&facet.part.surface));
                let (pixels, spans) = found.entry(name).or_default();
                *pixels += u64::from(columns.end - columns.start);
                *spans += 1;
                of_pixels.extend(columns.map(|_| name));
            });
        }
        names.push(of_pixels);
    }
    let all: u64 = seen.iter().map(|buffer| buffer.instance.len() as u64).sum();
    let empty: Vec<VisibilityBuffer> =
        views.iter().map(|view| VisibilityBuffer::empty(&view.pinhole())).collect();
    let sky = best(5, || paint(&empty));
    let share = |taken: Taken, share: f64| Taken { wall_s: taken.wall_s * share, cpu_s: taken.cpu_s * share };
    let mut materials: Vec<Material> = found
        .into_iter()
        .map(|(name, (pixels, spans))| {
            let part = pixels as f64 / all as f64;
            if name == "sky" {
                return Material { name, pixels, spans, taken: share(sky, part) };
            }
            let alone: Vec<VisibilityBuffer> = seen
                .iter()
                .zip(&names)
                .map(|(buffer, names)| {
                    let mut alone = buffer.clone();
                    for (i, _) in names.iter().enumerate().filter(|(_, other)| **other != name) {
                        (alone.instance[i], alone.triangle[i]) = (SKY, SKY);
                        alone.depth_m[i] = f32::INFINITY;
                    }
                    alone
                })
                .collect();
            let (taken, beside) = (best(5, || paint(&alone)), share(sky, 1.0 - part));
            let taken = Taken { wall_s: taken.wall_s - beside.wall_s, cpu_s: taken.cpu_s - beside.cpu_s };
            Material { name, pixels, spans, taken }
        })
        .collect();
    materials.sort_by_key(|material| std::cmp::Reverse(material.pixels));
    materials
}
