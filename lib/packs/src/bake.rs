//! Meshes as everyone sees them: triangles with parts and pictures.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use gltf_json::Material;
use gltf_json::material::AlphaMode;
use gltf_json::texture::WrappingMode;
use gltf_json::validation::Checked;
use schema::geometry::{Part, Surface, TriMesh};
use schema::skin::{Finish, Image, Level, Skin, Wrap};

use crate::document::{Bag, Document};
use crate::error::{PackError, Problem};
use crate::limits;
use crate::normals;
use crate::picture::{Curve, decode, image};
use crate::sheet::{Sheet, Stuff};
use crate::soup::{PartKey, Triangle};

/// How a material looks.
#[derive(Clone)]
struct Look {
    surface: Surface,
    /// Linear RGB, where no picture lies on it.
    rgb: [f32; 3],
    picture: Option<Arc<Image>>,
}

/// A picture as it is used: its number, bits of its colour, what is beyond its edges.
type Use = (usize, [u32; 3], [u8; 2]);

/// Makes meshes of triangles; pictures are shared among them.
pub(crate) struct Baker<'a, 'f> {
    document: &'a Document,
    sheet: &'a Sheet,
    bag: &'a mut Bag<'f>,
    place: String,
    curve: Curve,
    decoded: BTreeMap<usize, Level>,
    read_texels: usize,
    pictures: BTreeMap<Use, Arc<Image>>,
    texels: usize,
    looks: Vec<(PartKey, Look)>,
}

impl<'a, 'f> Baker<'a, 'f> {
    /// # Errors
    /// A picture cannot be used.
    pub(crate) fn new(
        document: &'a Document,
        sheet: &'a Sheet,
        bag: &'a mut Bag<'f>,
        parts: &[PartKey],
        place: String,
    ) -> Result<Self, PackError> {
        let mut baker = Self {
            document,
            sheet,
            bag,
            place,
            curve: Curve::new(),
            decoded: BTreeMap::new(),
            read_texels: 0,
            pictures: BTreeMap::new(),
            texels: 0,
            looks: Vec::new(),
        };
        for part in parts {
            let look = baker.look(part)?;
            baker.looks.push((*part, look));
        }
        baker.decoded.clear();
        Ok(baker)
    }

    fn decoded(&mut self, index: usize) -> Result<&Level, PackError> {
        if !self.decoded.contains_key(&index) {
            let bytes = self.document.picture(self.bag, index)?;
            let picture = decode(&bytes)
                .map_err(|problem| PackError::file(&self.place, Problem::Picture { index, problem }))?;
            self.read_texels += picture.texels.len();
            if self.read_texels > limits::TEXELS {
                return Err(self.too_many_texels(index));
            }
            self.decoded.insert(index, picture);
        }
        // Just put there, if it was not.
        self.decoded.get(&index).ok_or_else(|| PackError::file(&self.place, Problem::NoData(index)))
    }

    fn too_many_texels(&self, index: usize) -> PackError {
        let problem = format!("the model's pictures have more than {} pixels together", limits::TEXELS);
        PackError::file(&self.place, Problem::Picture { index, problem })
    }

    /// The picture of a texture in a colour.
    fn picture(&mut self, texture: usize, rgb: [f32; 3]) -> Result<Option<Arc<Image>>, PackError> {
        let root = &self.document.root;
        let missing =
            || PackError::file(&self.place, Problem::Broken(format!("there is no texture {texture}")));
        let texture = root.textures.get(texture).ok_or_else(missing)?;
        let index = texture.source.value();
        let sampler = texture.sampler.and_then(|sampler| root.samplers.get(sampler.value()));
        let wrap = sampler.map_or([Wrap::Repeat; 2], |s| [wrap(&s.wrap_s), wrap(&s.wrap_t)]);
        let key = (index, rgb.map(f32::to_bits), wrap.map(|wrap| wrap as u8));
        if let Some(known) = self.pictures.get(&key) {
            return Ok(Some(Arc::clone(known)));
        }
        let picture = self.decoded(index)?;
        let texels = picture.texels.len();
        if self.texels + texels > limits::TEXELS {
            return Err(self.too_many_texels(index));
        }
        self.texels += texels;
        let made = self.decoded.get(&index).map(|picture| Arc::new(image(picture, rgb, wrap, &self.curve)));
        if let Some(made) = &made {
            self.pictures.insert(key, Arc::clone(made));
        }
        Ok(made)
    }

    /// How a part looks.
    fn look(&mut self, part: &PartKey) -> Result<Look, PackError> {
        let materials = &self.document.root.materials;
        let material = part.material.and_then(|m| materials.get(m)).cloned().unwrap_or_default();
        let pbr = &material.pbr_metallic_roughness;
        let [r, g, b, alpha] = pbr.base_color_factor.0;
        let rgb = [r, g, b].map(|v| if v.is_finite() { v.clamp(0.0, 1.0) } else { 1.0 });
        let picture = match &pbr.base_color_texture {
            Some(texture) => self.picture(texture.index.value(), rgb)?,
            None => None,
        };
        let [mut roughness, mut metallic] = [pbr.roughness_factor.0, pbr.metallic_factor.0]
            .map(|v| if v.is_finite() { v.clamp(0.0, 1.0) } else { 1.0 });
        if let Some(texture) = &pbr.metallic_roughness_texture {
            // The mean of its picture stands for it.
            if let Some(texture) = self.document.root.textures.get(texture.index.value()) {
                let picture = self.decoded(texture.source.value())?;
                let [g, b] = mean_of_green_and_blue(picture);
                (roughness, metallic) = (roughness * g, metallic * b);
            }
        }
        let surface = match part.lamp {
            Some((bits, _)) => Surface::Lamp(bits),
            None => match stuff(&material, alpha, self.sheet) {
                Some(Stuff::Paint) => Surface::Paint,
                Some(Stuff::Glass) => Surface::Glass,
                Some(Stuff::Rubber) => Surface::Rubber,
                Some(Stuff::Metal) => Surface::Metal,
                Some(Stuff::Cloth) => Surface::Cloth,
                Some(Stuff::Plain) => Surface::Plain,
                None => Surface::Skin(Finish { image: None, roughness, metallic }),
            },
        };
        Ok(Look { surface, rgb, picture })
    }

    /// The mesh of triangles, moved by `shift_m`.
    pub(crate) fn mesh(&self, triangles: &[Triangle], shift_m: DVec3) -> TriMesh {
        let mut mesh = TriMesh::default();
        let mut vertices: BTreeMap<[u32; 3], u32> = BTreeMap::new();
        let mut parts: Vec<Option<u8>> = vec![None; self.looks.len()];
        // Light times area, and area, of each part.
        let mut sums: Vec<([f32; 3], f32)> = Vec::new();
        let mut skin = Skin::default();
        let mut given = Vec::new();
        for triangle in triangles {
            let (key, look) = &self.looks[triangle.part];
            let part = *parts[triangle.part].get_or_insert_with(|| {
                mesh.parts.push(Part::new(key.tag, with_picture(look, &mut skin), look.rgb));
                sums.push(([0.0; 3], 0.0));
                (mesh.parts.len() - 1) as u8
            });
            let corners = triangle.corners_m.map(|corner| {
                // Adding 0 makes one zero of two.
                let at = (corner + shift_m).as_vec3() + Vec3::ZERO;
                *vertices.entry(at.to_array().map(f32::to_bits)).or_insert_with(|| mesh.add_vertex(at))
            });
            let before = mesh.triangles.len();
            mesh.add_triangle(part, corners);
            if mesh.triangles.len() == before {
                continue;
            }
            given.push(triangle.normals);
            skin.corners.push(triangle.uv);
            let [a, b, c] = mesh.corners(before);
            let area = (b - a).cross(c - a).length();
            let seen = look.picture.as_deref().map_or(look.rgb, |picture| self.seen(picture, triangle.uv));
            let sum = &mut sums[usize::from(part)];
            (0..3).for_each(|k| sum.0[k] += seen[k] * area);
            sum.1 += area;
        }
        for (index, part) in parts.iter().enumerate() {
            let Some(part) = part.map(usize::from) else { continue };
            let (light, area) = sums[part];
            if area > 0.0 {
                mesh.parts[part].rgb = light.map(|v| v / area);
            }
            if let Some((_, Some(rgb))) = self.looks[index].0.lamp {
                mesh.parts[part].rgb = rgb;
            }
        }
        normals::set(&mut mesh, &given, self.sheet.crease_rad);
        mesh.skin = (!skin.images.is_empty()).then(|| Arc::new(skin));
        mesh
    }

    /// The mean colour that a triangle shows, by a coarse copy of the picture at its middle.
    fn seen(&self, picture: &Image, uv: [Vec2; 3]) -> [f32; 3] {
        let coarse = picture.levels.iter().find(|level| level.width.max(level.height) <= 64);
        let Some(level) = coarse.or(picture.levels.last()) else { return [0.5; 3] };
        let at = (uv[0] + uv[1] + uv[2]) / 3.0;
        let x = picture.wrap[0].texel((at.x * level.width as f32).floor() as i32, level.width);
        let y = picture.wrap[1].texel((at.y * level.height as f32).floor() as i32, level.height);
        self.curve.linear(level.texels[(y * level.width + x) as usize])
    }
}

/// What the page says that a material is, or what glass is by itself.
fn stuff(material: &Material, alpha: f32, sheet: &Sheet) -> Option<Stuff> {
    let said = material.name.as_ref().and_then(|name| sheet.materials.get(name)).copied();
    let is_glass = material.alpha_mode == Checked::Valid(AlphaMode::Blend) && alpha < 0.9;
    said.or(is_glass.then_some(Stuff::Glass))
}

/// The surface of a look, its picture put among those of a skin.
fn with_picture(look: &Look, skin: &mut Skin) -> Surface {
    let (Surface::Skin(finish), Some(picture)) = (look.surface, &look.picture) else { return look.surface };
    let known = skin.images.iter().position(|image| Arc::ptr_eq(image, picture));
    let index = known.unwrap_or_else(|| {
        skin.images.push(Arc::clone(picture));
        skin.images.len() - 1
    });
    // There are no more pictures than parts.
    Surface::Skin(Finish { image: u8::try_from(index).ok(), ..finish })
}

fn wrap(mode: &Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

fn mean_of_green_and_blue(picture: &Level) -> [f32; 2] {
    let sum = picture.texels.iter().fold([0_u64; 2], |[g, b], t| [g + u64::from(t[1]), b + u64::from(t[2])]);
    sum.map(|v| v as f32 / (255.0 * picture.texels.len().max(1) as f32))
}
