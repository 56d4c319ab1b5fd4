//! The pictures of a model: each is decoded once, and made once for every use.

use std::collections::BTreeMap;
use std::sync::Arc;

use gltf_json::texture::WrappingMode;
use gltf_json::validation::Checked;
use schema::mesh_textures::{Image, Wrap};

use crate::document::{Document, ModelFiles};
use crate::error::{PackError, Problem};
use crate::limits;
use crate::picture::{Curve, Decoded, Meaning, decode, image};
use crate::stencil::Stencil;

/// A picture as it is used: its number, bits of the factors of its colours, what is beyond its edges, what
/// its bytes mean.
type Use = (usize, [u32; 3], [u8; 2], u8);

/// All that were asked for.
pub(crate) struct Pictures<'a, 'f> {
    document: &'a Document,
    bag: &'a mut ModelFiles<'f>,
    place: String,
    curve: &'a Curve,
    decoded: BTreeMap<usize, Decoded>,
    read_texels: usize,
    made: BTreeMap<Use, Arc<Image>>,
    texels: usize,
}

impl<'a, 'f> Pictures<'a, 'f> {
    pub(crate) fn new(
        document: &'a Document,
        bag: &'a mut ModelFiles<'f>,
        place: String,
        curve: &'a Curve,
    ) -> Self {
        Self {
            document,
            bag,
            place,
            curve,
            decoded: BTreeMap::new(),
            read_texels: 0,
            made: BTreeMap::new(),
            texels: 0,
        }
    }

    /// The picture of a texture, its colours multiplied by factors.
    ///
    /// # Errors
    /// There is none, it cannot be decoded, or there are too many.
    pub(crate) fn of(
        &mut self,
        texture: usize,
        factors: [f32; 3],
        meaning: Meaning,
    ) -> Result<Arc<Image>, PackError> {
        let (index, wrap) = self.source(texture)?;
        let key = (index, factors.map(f32::to_bits), wrap.map(|wrap| wrap as u8), meaning as u8);
        if let Some(known) = self.made.get(&key) {
            return Ok(Arc::clone(known));
        }
        let curve = self.curve;
        let picture = &self.decoded(index)?.picture;
        let made = Arc::new(image(picture, factors, wrap, meaning, curve));
        self.texels += made.levels.first().map_or(0, |level| level.texels.len());
        if self.texels > limits::TEXELS {
            return Err(self.too_many_texels(index, limits::TEXELS));
        }
        self.made.insert(key, Arc::clone(&made));
        Ok(made)
    }

    /// The mean of a texture's green and blue, 0 to 1.
    ///
    /// # Errors
    /// As of [`Self::of`].
    pub(crate) fn mean_of_green_and_blue(&mut self, texture: usize) -> Result<[f32; 2], PackError> {
        let (index, _) = self.source(texture)?;
        let texels = &self.decoded(index)?.picture.texels;
        let sum = texels.iter().fold([0_u64; 2], |[g, b], t| [g + u64::from(t[1]), b + u64::from(t[2])]);
        Ok(sum.map(|v| v as f32 / (255.0 * texels.len().max(1) as f32)))
    }

    /// Where a texture's alpha times a factor is at least a share; none where that is everywhere.
    ///
    /// # Errors
    /// As of [`Self::of`].
    pub(crate) fn stencil(
        &mut self,
        texture: usize,
        factor: f32,
        least: f32,
    ) -> Result<Option<Stencil>, PackError> {
        let (index, wrap) = self.source(texture)?;
        let Decoded { picture, alpha } = self.decoded(index)?;
        let is_there: Vec<bool> = alpha.iter().map(|a| f32::from(*a) / 255.0 * factor >= least).collect();
        let is_cut = is_there.contains(&false);
        Ok(is_cut.then(|| Stencil::new(picture.width, wrap, is_there)))
    }

    /// The number of a texture's picture, and what is beyond its edges.
    fn source(&self, texture: usize) -> Result<(usize, [Wrap; 2]), PackError> {
        let root = &self.document.root;
        let missing =
            || PackError::file(&self.place, Problem::Broken(format!("there is no texture {texture}")));
        let texture = root.textures.get(texture).ok_or_else(missing)?;
        let sampler = texture.sampler.and_then(|sampler| root.samplers.get(sampler.value()));
        let wrap = sampler.map_or([Wrap::Repeat; 2], |s| [wrap(&s.wrap_s), wrap(&s.wrap_t)]);
        Ok((texture.source.value(), wrap))
    }

    fn decoded(&mut self, index: usize) -> Result<&Decoded, PackError> {
        if !self.decoded.contains_key(&index) {
            let bytes = self.document.picture(self.bag, index)?;
            let decoded = decode(&bytes).map_err(|e| {
                PackError::file(&self.place, Problem::Picture { index, problem: e.to_string() })
            })?;
            self.read_texels += decoded.picture.texels.len();
            if self.read_texels > limits::READ_TEXELS {
                return Err(self.too_many_texels(index, limits::READ_TEXELS));
            }
            self.decoded.insert(index, decoded);
        }
        // Just put there, if it was not.
        self.decoded.get(&index).ok_or_else(|| PackError::file(&self.place, Problem::NoData(index)))
    }

    fn too_many_texels(&self, index: usize, most: usize) -> PackError {
        let problem = format!("the model's pictures have more than {most} pixels together");
        PackError::file(&self.place, Problem::Picture { index, problem })
    }
}

fn wrap(mode: &Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}
