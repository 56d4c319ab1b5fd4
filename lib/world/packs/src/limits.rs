//! What a model may have at most. `docs/packs.md` states these numbers.

/// Bytes of a file.
pub(crate) const FILE_BYTES: u64 = 64 << 20;
/// Bytes of a model's page.
pub(crate) const SHEET_BYTES: u64 = 256 << 10;
/// Bytes of the JSON of a glTF file.
pub(crate) const JSON_BYTES: usize = 16 << 20;
/// Bytes of all files of a model.
pub(crate) const MODEL_BYTES: u64 = 128 << 20;
/// Triangles of a level of detail.
pub(crate) const TRIANGLES: usize = 60_000;
/// Buffers of a file.
pub(crate) const BUFFERS: usize = 64;
/// Height of a model, metres: shadows of what is higher would need wider margins.
pub(crate) const HEIGHT_M: f64 = 5.0;
/// Nodes of a file.
pub(crate) const NODES: usize = 4096;
/// Nodes below one another.
pub(crate) const DEPTH: usize = 64;
/// Skins of a file, and joints of each.
pub(crate) const SKINS: usize = 64;
pub(crate) const JOINTS: usize = 1024;
/// Texels along a side of a picture.
pub(crate) const IMAGE_SIDE: usize = 2048;
/// The same of pictures that are no colours: larger ones are kept at half their size.
pub(crate) const DETAIL_SIDE: u32 = 1024;
/// Texels of all pictures of a model as they are read.
pub(crate) const READ_TEXELS: usize = 48 << 20;
/// Texels of all that are used: each for every colour and wrapping.
pub(crate) const TEXELS: usize = 32 << 20;
/// Parts of different looks.
pub(crate) const PARTS: usize = 250;
/// Coarser levels of detail.
pub(crate) const LEVELS: usize = 4;
/// Models and other files of a folder.
pub(crate) const FOLDER_FILES: usize = 1000;
