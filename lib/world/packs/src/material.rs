//! What materials say about looks.

use gltf_json::Material;
use gltf_json::material::AlphaMode;
use gltf_json::texture::Info;
use gltf_json::validation::Checked;
use schema::geometry::Surface;
use schema::mesh_textures::{Glow, PbrFactors, Relief, TextureSet};

use crate::error::PackError;
use crate::manifest::{MaterialOverride, ModelManifest};
use crate::picture::Meaning;
use crate::pictures::Pictures;
use crate::stencil::Stencil;

/// What blends in with less alpha is not there.
const LEAST_BLENDED: f32 = 0.1;

/// How a material looks.
pub(crate) struct PackMaterial {
    pub(crate) surface: Surface,
    /// Linear RGB, where no picture lies on it.
    pub(crate) rgb: [f32; 3],
    pub(crate) texture_set: Option<TextureSet>,
    /// Where it is there, if that is not everywhere.
    pub(crate) stencil: Option<Stencil>,
}

/// How a part of a material looks: `lamp` says with which [`schema::lights`] it burns, if it is one.
///
/// # Errors
/// A picture cannot be used.
pub(crate) fn material_of(
    material: &Material,
    lamp: Option<u32>,
    sheet: &ModelManifest,
    pictures: &mut Pictures<'_, '_>,
) -> Result<PackMaterial, PackError> {
    let pbr = &material.pbr_metallic_roughness;
    let [r, g, b, alpha] = pbr.base_color_factor.0;
    let share = |v: f32| if v.is_finite() { v.clamp(0.0, 1.0) } else { 1.0 };
    let rgb = [r, g, b].map(share);
    let [mut roughness, mut metallic] = [pbr.roughness_factor.0, pbr.metallic_factor.0].map(share);
    let mut texture_set = TextureSet::default();
    let mut stencil = None;
    if let Some(texture) = &pbr.base_color_texture {
        if let Some((factor, least)) = cut_at(material, share(alpha)) {
            stencil = pictures.stencil(texture.index.value(), factor, least)?;
        }
        texture_set.colour = Some(pictures.of(texture.index.value(), rgb, Meaning::Colour)?);
    }
    // Pictures that lie elsewhere than the first are left out, but for their means.
    let set = places(material);
    let lies_there = |of: u32| set == Some(of);
    if let Some(texture) = &pbr.metallic_roughness_texture {
        let index = texture.index.value();
        if lies_there(texture.tex_coord) {
            texture_set.specular = Some(pictures.of(index, [0.0, roughness, metallic], Meaning::Numbers)?);
        }
        let [g, b] = pictures.mean_of_green_and_blue(index)?;
        (roughness, metallic) = (roughness * g, metallic * b);
    }
    if let Some(texture) = material.normal_texture.as_ref().filter(|t| lies_there(t.tex_coord)) {
        let image = pictures.of(texture.index.value(), [1.0; 3], Meaning::Numbers)?;
        let strength = if texture.scale.is_finite() { texture.scale.clamp(-4.0, 4.0) } else { 1.0 };
        texture_set.relief = Some(Relief { image, strength });
    }
    let shines = material.emissive_factor.0.map(|v| if v.is_finite() { v.clamp(0.0, 1.0) } else { 0.0 });
    if shines != [0.0; 3] {
        texture_set.glow = match &material.emissive_texture {
            None => Some(Glow::Even(shines)),
            Some(texture) if lies_there(texture.tex_coord) => {
                Some(Glow::Picture(pictures.of(texture.index.value(), shines, Meaning::Glow)?))
            }
            Some(_) => None,
        };
    }
    let surface = match lamp {
        Some(bits) => Surface::Lamp(bits),
        None => match stuff(material, alpha, sheet) {
            Some(MaterialOverride::Paint) => Surface::Paint,
            Some(MaterialOverride::Glass) => Surface::Glass,
            Some(MaterialOverride::Rubber) => Surface::Rubber,
            Some(MaterialOverride::Metal) => Surface::Metal,
            Some(MaterialOverride::Cloth) => Surface::Cloth,
            Some(MaterialOverride::Plain) => Surface::Plain,
            None => Surface::Textured(PbrFactors { texture_set: None, roughness, metallic }),
        },
    };
    Ok(PackMaterial {
        surface,
        rgb,
        texture_set: (texture_set != TextureSet::default()).then_some(texture_set),
        stencil,
    })
}

/// What alphas in the picture of a material are multiplied by, and the least that is there then. Of materials
/// that blend what is next to invisible is cut out: panes may be drawn by alpha as well.
fn cut_at(material: &Material, alpha: f32) -> Option<(f32, f32)> {
    match material.alpha_mode {
        Checked::Valid(AlphaMode::Mask) => {
            Some((alpha, material.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0)))
        }
        Checked::Valid(AlphaMode::Blend) => Some((1.0, LEAST_BLENDED)),
        _ => None,
    }
}

/// What the page says that a material is, or what glass is by itself.
fn stuff(material: &Material, alpha: f32, sheet: &ModelManifest) -> Option<MaterialOverride> {
    let said = material.name.as_ref().and_then(|name| sheet.materials.get(name)).copied();
    let is_glass = material.alpha_mode == Checked::Valid(AlphaMode::Blend) && alpha < 0.9;
    said.or(is_glass.then_some(MaterialOverride::Glass))
}

/// Which of a mesh's lists of places the pictures of a material go by: that of the first of them.
pub(crate) fn places(material: &Material) -> Option<u32> {
    let pbr = &material.pbr_metallic_roughness;
    let set = |texture: &Option<Info>| texture.as_ref().map(|texture| texture.tex_coord);
    set(&pbr.base_color_texture)
        .or(material.normal_texture.as_ref().map(|texture| texture.tex_coord))
        .or(set(&pbr.metallic_roughness_texture))
        .or(set(&material.emissive_texture))
}
