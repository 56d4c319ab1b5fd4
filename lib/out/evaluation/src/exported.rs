//! An export to nuScenes: what its samples are, and its tables row by row.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt;
use std::fs::File;
use std::io::BufReader;
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use serde::de::{DeserializeOwned, Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::EvaluationError;
use crate::boxes::SampleId;

/// What the samples of a nuScenes export are called, and where its global frames lie.
#[derive(Clone, Debug, Default)]
pub struct ExportedSamples {
    /// Folders of its versions.
    versions: Vec<PathBuf>,
    samples: BTreeMap<String, SampleId>,
    /// By scene.
    global_from_world_m: BTreeMap<u32, [f64; 3]>,
}

/// A row of `cooperation.json`.
#[derive(Deserialize)]
struct Moment {
    scene: String,
    frame: u32,
    samples: BTreeMap<String, String>,
}

/// A row of `map.json`.
#[derive(Deserialize)]
struct Map {
    location: String,
    global_from_world_m: [f64; 3],
}

impl ExportedSamples {
    /// Reads `cooperation.json` and `map.json` of an export's versions: of the folder itself, or of those in
    /// it. `map_of` names the map of a scene.
    ///
    /// # Errors
    /// It is no export of ours, or a table cannot be read.
    pub fn read(folder: &Path, map_of: impl Fn(u32) -> Option<String>) -> Result<Self, EvaluationError> {
        let mut versions = Vec::new();
        if folder.join("cooperation.json").is_file() {
            versions.push(folder.to_owned());
        } else {
            let entries =
                std::fs::read_dir(folder).map_err(|e| fault(folder, format!("cannot be read: {e}")))?;
            let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
            versions.extend(paths.filter(|path| path.join("cooperation.json").is_file()));
            versions.sort();
        }
        if versions.is_empty() {
            let problem =
                "has no VERSION/cooperation.json: it is no export to nuScenes (convoy export nuscenes)";
            return Err(fault(folder, problem.into()));
        }
        let mut all = Self::default();
        for version in &versions {
            let mut maps = BTreeMap::new();
            each_row(&version.join("map.json"), |map: Map| {
                maps.insert(map.location, map.global_from_world_m);
                Ok(())
            })?;
            each_row(&version.join("cooperation.json"), |moment: Moment| all.add(moment, &maps, &map_of))?;
        }
        all.versions = versions;
        Ok(all)
    }

    fn add(
        &mut self,
        Moment { scene: number, frame, samples }: Moment,
        maps: &BTreeMap<String, [f64; 3]>,
        map_of: impl Fn(u32) -> Option<String>,
    ) -> Result<(), String> {
        let scene: u32 = number.parse().map_err(|_| format!("scene `{number}` is no number"))?;
        for (agent, token) in samples {
            let ego = agent.parse().map_err(|e| format!("{e}"))?;
            self.samples.insert(token, SampleId { scene, frame, ego });
        }
        if let Entry::Vacant(shift) = self.global_from_world_m.entry(scene) {
            let name = map_of(scene).ok_or_else(|| {
                format!("has scene {scene}, which the store has not finished: it is of another store")
            })?;
            let map = maps.get(&name);
            shift.insert(*map.ok_or_else(|| format!("map.json has no map {name}, of scene {scene}"))?);
        }
        Ok(())
    }

    /// Folders of its versions.
    pub(crate) fn versions(&self) -> &[PathBuf] {
        &self.versions
    }

    /// All samples.
    pub(crate) fn samples(&self) -> impl Iterator<Item = SampleId> {
        self.samples.values().copied()
    }

    /// The sample of a token, and how far its global frame is from the world, m.
    pub(crate) fn sample(&self, token: &str) -> Option<(SampleId, [f64; 3])> {
        let sample = self.samples.get(token)?;
        Some((*sample, *self.global_from_world_m.get(&sample.scene)?))
    }
}

/// What is wrong with a file of an export.
pub(crate) fn fault(path: &Path, problem: String) -> EvaluationError {
    EvaluationError::Predictions { path: path.display().to_string(), problem }
}

/// Reads a table of an export, of which one row is in memory at a time.
pub(crate) fn each_row<T: DeserializeOwned>(
    path: &Path,
    mut take: impl FnMut(T) -> Result<(), String>,
) -> Result<(), EvaluationError> {
    let file = File::open(path).map_err(|e| fault(path, format!("cannot be read: {e}")))?;
    let mut json = serde_json::Deserializer::from_reader(BufReader::with_capacity(1 << 20, file));
    json.deserialize_seq(Each { take: &mut take, row: PhantomData })
        .and_then(|()| json.end())
        .map_err(|e| fault(path, e.to_string()))
}

/// A list whose elements are taken one by one.
struct Each<'a, T, F> {
    take: &'a mut F,
    row: PhantomData<T>,
}

impl<'de, T: DeserializeOwned, F: FnMut(T) -> Result<(), String>> Visitor<'de> for Each<'_, T, F> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of rows")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        while let Some(row) = list.next_element()? {
            (self.take)(row).map_err(A::Error::custom)?;
        }
        Ok(())
    }
}
