//! Arrays of an agent, one a frame or every so many frames.

use codecs::{Array, NpzError, NpzReader, PackedArray, frame_member};
use schema::AgentId;
use schema::arrays::ArrayKind;
use store::{ShardStream, StoreError, keys};

use crate::{SceneError, SceneReader};

/// The most that is fetched in one go, bytes.
const SMALL_BYTES: u64 = 16 << 20;

/// An open archive of arrays.
pub struct ArrayReader {
    archive: NpzReader<ShardStream>,
    path: String,
    scene: u32,
    stage: &'static str,
}

impl ArrayReader {
    /// Opens the archive of an agent's arrays of a kind. Arrays of more than `max_bytes` are refused.
    ///
    /// # Errors
    /// The stage has not made it, or it is not as the manifest says.
    pub fn open(
        scene: &SceneReader,
        kind: &ArrayKind,
        agent: AgentId,
        max_bytes: u64,
    ) -> Result<Self, SceneError> {
        Self::open_for(scene, kind, agent, max_bytes, false)
    }

    /// The same for who reads all of it: a small archive is fetched in one go.
    ///
    /// # Errors
    /// As [`ArrayReader::open`].
    pub fn open_whole(
        scene: &SceneReader,
        kind: &ArrayKind,
        agent: AgentId,
        max_bytes: u64,
    ) -> Result<Self, SceneError> {
        Self::open_for(scene, kind, agent, max_bytes, true)
    }

    fn open_for(
        scene: &SceneReader,
        kind: &ArrayKind,
        agent: AgentId,
        max_bytes: u64,
        reads_all: bool,
    ) -> Result<Self, SceneError> {
        let key = keys::array(scene.scene(), kind, agent);
        let stream = scene.store().stream_output(scene.manifest(kind.stage)?, &key)?;
        if reads_all {
            stream.will_read_all(SMALL_BYTES);
        }
        let (path, scene, stage) = (scene.store().location(&key), scene.scene(), kind.stage);
        let archive = NpzReader::new(stream).map_err(|e| wrong(&path, scene, stage, None, e))?;
        Ok(Self { archive: archive.with_max_bytes(max_bytes), path, scene, stage })
    }

    /// The frames that have an array, in the archive's order.
    pub fn frames(&self) -> impl Iterator<Item = u32> {
        self.archive.members().filter_map(|name| name.strip_suffix(".npy")?.parse().ok())
    }

    /// Reads the array of a frame.
    ///
    /// # Errors
    /// There is none, or it is broken.
    pub fn read(&mut self, frame: u32) -> Result<Array, SceneError> {
        self.read_into(frame, Vec::new())
    }

    /// As [`ArrayReader::read`], with the memory of an array that is no longer needed.
    ///
    /// # Errors
    /// As [`ArrayReader::read`].
    pub fn read_into(&mut self, frame: u32, memory: Vec<u8>) -> Result<Array, SceneError> {
        let found = self.archive.read_into(&frame_member(frame), memory);
        found.map_err(|e| wrong(&self.path, self.scene, self.stage, Some(frame), e))
    }

    /// Takes the array of a frame out still compressed.
    ///
    /// # Errors
    /// There is none, or it is broken, as far as its header shows.
    pub fn read_packed(&mut self, frame: u32) -> Result<PackedArray, SceneError> {
        let found = self.archive.read_packed(&frame_member(frame));
        found.map_err(|e| wrong(&self.path, self.scene, self.stage, Some(frame), e))
    }

    /// Where the archive is, for messages.
    #[must_use]
    pub fn path(&self) -> &str {
        &self.path
    }
}

/// A failing disk is not a broken archive.
fn wrong(path: &str, scene: u32, stage: &'static str, frame: Option<u32>, error: NpzError) -> SceneError {
    match error {
        NpzError::Io(source) => StoreError::read(path, "read", source).into(),
        other => SceneError::Array { path: path.to_owned(), scene, frame, stage, source: Box::new(other) },
    }
}
