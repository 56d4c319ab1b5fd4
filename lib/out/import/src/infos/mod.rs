//! `infos/simbev2x_infos_{split}.json`: which scenes there are, and which files hold what of them.

mod index;
mod scene;

pub use index::{Index, IndexError, scan};
pub use scene::{Record, Scene};

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::PathBuf;

use settings::Split;

use crate::error::ImportError;
use crate::folder::Folder;
use crate::json;
use crate::value::Value;

/// Most bytes of a scene's part: of 12 agents and 320 frames it has some 16 MB.
const MAX_SCENE_BYTES: u64 = 256 << 20;
/// Most bytes of what is said of all sensors.
const MAX_METADATA_BYTES: u64 = 1 << 20;

/// A scene of a dataset, not read yet.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its number.
    pub number: u32,
    /// Its split.
    pub split: Split,
    path: PathBuf,
    range: Range<u64>,
}

/// What the infos of a dataset hold.
#[derive(Debug)]
pub struct Infos {
    /// `metadata`: the same in all files.
    pub metadata: Value,
    /// The text of that.
    pub metadata_text: Vec<u8>,
    /// The file that it stands in.
    pub metadata_path: PathBuf,
    /// The scenes of all splits, by number.
    pub entries: Vec<Entry>,
}

impl Infos {
    /// Looks through the infos of a dataset. The files are read once, in small pieces.
    ///
    /// # Errors
    /// There are none; one is no JSON of such infos; the files say different things of the sensors; two
    /// scenes have one number.
    pub fn open(folder: &Folder) -> Result<Self, ImportError> {
        let mut found: Option<Self> = None;
        for split in Split::ALL {
            let path = folder.root().join(format!("infos/simbev2x_infos_{}.json", split.name()));
            if std::fs::symlink_metadata(&path).is_err() {
                continue;
            }
            let path = folder.inside(&path)?;
            let file = File::open(&path).map_err(|e| ImportError::source(&path, e))?;
            let Index { metadata, scenes } = scan(file).map_err(|e| ImportError::source(&path, e))?;
            let text = slice(&path, &metadata, MAX_METADATA_BYTES)?;
            let value = parse(&path, &metadata, &text)?;
            let entries =
                scenes.into_iter().map(|(number, range)| Entry { number, split, path: path.clone(), range });
            match &mut found {
                None => {
                    let (metadata_text, metadata_path) = (text, path.clone());
                    found = Some(Self {
                        metadata: value,
                        metadata_text,
                        metadata_path,
                        entries: entries.collect(),
                    });
                }
                Some(known) if known.metadata_text == text => known.entries.extend(entries),
                Some(known) => {
                    let first = known.metadata_path.display();
                    let problem =
                        format!("says other things of the sensors than {first}: import them one by one");
                    return Err(ImportError::source(&path, problem));
                }
            }
        }
        let mut found = found.ok_or_else(|| {
            let root = folder.root().display();
            ImportError::Refused(format!("{root}/infos: holds no simbev2x_infos_{{train,val,test}}.json"))
        })?;
        found.entries.sort_by_key(|entry| entry.number);
        if let Some(pair) = found.entries.windows(2).find(|pair| pair[0].number == pair[1].number) {
            let problem = format!("scene {} stands in {}, too", pair[1].number, pair[0].path.display());
            return Err(ImportError::source(&pair[1].path, problem));
        }
        Ok(found)
    }
}

impl Entry {
    /// The text of the scene's part of its file.
    ///
    /// # Errors
    /// The file cannot be read, or the part is larger than a scene's can be.
    pub fn text(&self) -> Result<Vec<u8>, ImportError> {
        slice(&self.path, &self.range, MAX_SCENE_BYTES)
            .map_err(|e| e.within(format!("scene {}", self.number)))
    }

    /// Reads the scene from its text.
    ///
    /// # Errors
    /// It is no JSON, or something is missing in it.
    pub fn read(&self, text: &[u8]) -> Result<Scene, ImportError> {
        let place = |e: ImportError| e.within(format!("scene {}", self.number));
        let value = parse(&self.path, &self.range, text).map_err(place)?;
        Scene::of(value, self.number).map_err(|problem| place(ImportError::source(&self.path, problem)))
    }

    /// The file that it stands in.
    #[must_use]
    pub fn path(&self) -> &std::path::Path {
        &self.path
    }
}

fn slice(path: &std::path::Path, range: &Range<u64>, most: u64) -> Result<Vec<u8>, ImportError> {
    let wrong = |e: std::io::Error| ImportError::source(path, e);
    let length = range.end - range.start;
    if length > most {
        return Err(ImportError::source(
            path,
            format!("has a part of {length} bytes, at most {most} are possible"),
        ));
    }
    let mut file = File::open(path).map_err(wrong)?;
    file.seek(SeekFrom::Start(range.start)).map_err(wrong)?;
    let mut bytes = vec![0; length as usize];
    file.read_exact(&mut bytes).map_err(wrong)?;
    Ok(bytes)
}

fn parse(path: &std::path::Path, range: &Range<u64>, text: &[u8]) -> Result<Value, ImportError> {
    json::parse(text).map_err(|e| {
        let at = range.start + e.offset as u64;
        ImportError::source(path, format!("byte {at}: {}", e.problem))
    })
}
