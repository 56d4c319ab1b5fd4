//! A glTF file with the bytes of its buffers and pictures.

use std::collections::BTreeMap;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf_json::Root;

use crate::error::{PackError, Problem};
use crate::files::{Files, inside};
use crate::limits;

/// A model's files while they are read: each is read once, and all together stay below a limit.
pub(crate) struct ModelFiles<'f> {
    files: &'f dyn Files,
    pub(crate) read: BTreeMap<String, Vec<u8>>,
    bytes: u64,
}

impl<'f> ModelFiles<'f> {
    pub(crate) fn new(files: &'f dyn Files) -> Self {
        Self { files, read: BTreeMap::new(), bytes: 0 }
    }

    pub(crate) fn location(&self, path: &str) -> String {
        self.files.location(path)
    }

    /// The bytes of a file; `None`: there is none.
    pub(crate) fn get(&mut self, path: &str, most: u64) -> Result<Option<&[u8]>, Problem> {
        if !self.read.contains_key(path) {
            let Some(bytes) = self.files.read(path, most).map_err(Problem::Unreadable)? else {
                return Ok(None);
            };
            if bytes.len() as u64 > most {
                return Err(Problem::TooLarge(most));
            }
            self.bytes += bytes.len() as u64;
            if self.bytes > limits::MODEL_BYTES {
                return Err(Problem::ModelTooLarge(limits::MODEL_BYTES));
            }
            self.read.insert(path.to_owned(), bytes);
        }
        Ok(self.read.get(path).map(Vec::as_slice))
    }
}

/// A glTF file.
pub(crate) struct Document {
    pub(crate) root: Root,
    path: String,
    /// What each buffer holds; those of pictures are there as well.
    buffers: Vec<Vec<u8>>,
}

impl Document {
    pub(crate) fn read(bag: &mut ModelFiles<'_>, path: &str) -> Result<Self, PackError> {
        let place = bag.location(path);
        let at = |problem| PackError::file(&place, problem);
        let bytes = bag.get(path, limits::FILE_BYTES).map_err(at)?.ok_or_else(|| at(Problem::Missing))?;
        let (json, binary) = split(bytes).map_err(at)?;
        let mut binary = binary.to_vec();
        let root: Root = serde_json::from_slice(json).map_err(|e| at(Problem::Broken(e.to_string())))?;
        check(&root).map_err(at)?;
        let mut buffers = Vec::new();
        // Many may name one file, and each holds its own copy.
        let mut held = 0;
        for (number, buffer) in root.buffers.iter().enumerate() {
            let mut bytes = match &buffer.uri {
                // The first may be the chunk of a .glb.
                None if number == 0 && !binary.is_empty() => std::mem::take(&mut binary),
                None => return Err(at(Problem::NoBuffer(number))),
                Some(uri) => external(bag, path, uri)?,
            };
            let length = usize::try_from(buffer.byte_length.0).unwrap_or(usize::MAX);
            if bytes.len() < length {
                return Err(at(Problem::NoBuffer(number)));
            }
            bytes.truncate(length);
            bytes.shrink_to_fit();
            held += length as u64;
            if held > limits::MODEL_BYTES {
                return Err(at(Problem::ModelTooLarge(limits::MODEL_BYTES)));
            }
            buffers.push(bytes);
        }
        Ok(Self { root, path: path.to_owned(), buffers })
    }

    /// The bytes of a buffer view.
    pub(crate) fn view(&self, index: usize) -> Option<&[u8]> {
        let view = self.root.buffer_views.get(index)?;
        let from = usize::try_from(view.byte_offset.map_or(0, |offset| offset.0)).ok()?;
        let length = usize::try_from(view.byte_length.0).ok()?;
        self.buffers.get(view.buffer.value())?.get(from..from.checked_add(length)?)
    }

    /// The bytes of a picture's file.
    pub(crate) fn picture(&self, bag: &mut ModelFiles<'_>, index: usize) -> Result<Vec<u8>, PackError> {
        let at = |problem: &str| {
            let problem = Problem::Picture { index, problem: problem.to_owned() };
            PackError::file(bag.location(&self.path), problem)
        };
        let image = self.root.images.get(index).ok_or_else(|| at("there is none"))?;
        match (&image.buffer_view, &image.uri) {
            (Some(view), _) => {
                let bytes = self.view(view.value()).ok_or_else(|| at("reaches beyond its buffer"))?;
                Ok(bytes.to_vec())
            }
            (None, Some(uri)) => external(bag, &self.path, uri),
            (None, None) => Err(at("has no data")),
        }
    }
}

/// The JSON and the binary chunk of a file, which may be JSON alone.
fn split(bytes: &[u8]) -> Result<(&[u8], &[u8]), Problem> {
    let broken = |why: &str| Problem::Broken(why.to_owned());
    let small = |json: &[u8]| json.len() <= limits::JSON_BYTES;
    let too_large = || broken(&format!("its JSON has more than {} bytes", limits::JSON_BYTES));
    let Some(rest) = bytes.strip_prefix(b"glTF") else {
        return if small(bytes) { Ok((bytes, &[])) } else { Err(too_large()) };
    };
    let word = |at: usize| {
        let four: [u8; 4] = rest.get(at..at.checked_add(4)?)?.try_into().ok()?;
        Some(u32::from_le_bytes(four))
    };
    if word(0) != Some(2) {
        return Err(broken("its version is not 2"));
    }
    // Each chunk: length, kind, bytes.
    let chunk = |at: usize, kind: &[u8; 4]| {
        let length = word(at)? as usize;
        (rest.get(at + 4..at + 8)? == kind).then_some(())?;
        rest.get(at + 8..at.checked_add(8 + length)?)
    };
    let json = chunk(8, b"JSON").ok_or_else(|| broken("its first chunk is cut off or no JSON"))?;
    let after = 16 + json.len();
    let binary = match rest.get(after..) {
        Some(tail) if tail.len() >= 8 => {
            chunk(after, b"BIN\0").ok_or_else(|| broken("its second chunk is cut off or not binary"))?
        }
        _ => &[],
    };
    if small(json) { Ok((json, binary)) } else { Err(too_large()) }
}

/// What holds of every glTF file, and what is not read. Whether numbers of other things are in range is
/// looked at where they are used: `gltf-json`'s own check panics over some that are not.
fn check(root: &Root) -> Result<(), Problem> {
    if let Some(extension) = root.extensions_required.first() {
        return Err(Problem::Extension(extension.clone()));
    }
    if root.nodes.len() > limits::NODES {
        return Err(Problem::TooManyNodes(limits::NODES));
    }
    if root.buffers.len() > limits::BUFFERS {
        return Err(Problem::Broken(format!("it has more than {} buffers", limits::BUFFERS)));
    }
    if !root.asset.version.starts_with("2.") {
        return Err(Problem::Broken("its version is not 2".into()));
    }
    Ok(())
}

/// The bytes that a URI in a file names: in the URI itself, or a file of the pack.
fn external(bag: &mut ModelFiles<'_>, beside: &str, uri: &str) -> Result<Vec<u8>, PackError> {
    let at = |bag: &ModelFiles<'_>, problem| PackError::file(bag.location(beside), problem);
    if let Some(data) = uri.strip_prefix("data:") {
        let text = data.split_once(";base64,").map(|(_, text)| text);
        let bytes = text.and_then(|text| STANDARD.decode(text).ok());
        return bytes.ok_or_else(|| at(bag, Problem::Broken("a data URI is no base64".into())));
    }
    let Some(path) = inside(beside, uri) else {
        return Err(at(bag, Problem::Outside(uri.chars().take(80).collect())));
    };
    match bag.get(&path, limits::FILE_BYTES) {
        Ok(Some(bytes)) => Ok(bytes.to_vec()),
        Ok(None) => Err(PackError::file(bag.location(&path), Problem::Missing)),
        Err(problem) => Err(PackError::file(bag.location(&path), problem)),
    }
}
