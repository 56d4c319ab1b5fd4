//! nuScenes' files of results, put into the form of our own predictions.

use std::collections::BTreeSet;
use std::fmt;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use serde::de::{DeserializeSeed, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::EvaluationError;
use crate::attribute::number_of_attribute;
use crate::boxes::SampleId;
use crate::class::BoxClass;
use crate::exported::{ExportedSamples, fault};
use crate::predictions::PredictionFile;
use crate::scratch::{ForeignBox, Scratch};

/// Reads a file of nuScenes' results (`meta`, `results` by sample token), box by box, into predictions of our
/// own form, which lie in a temporary file of about a tenth of its size.
///
/// # Errors
/// The file cannot be read, or a box or a sample in it is none; the temporary file cannot be written.
pub fn read_results(path: &Path, exported: &ExportedSamples) -> Result<PredictionFile, EvaluationError> {
    let file = File::open(path).map_err(|e| fault(path, format!("cannot be read: {e}")))?;
    let mut rows = Scratch::new()?;
    let mut json = serde_json::Deserializer::from_reader(BufReader::with_capacity(1 << 20, file));
    let whole = Whole { exported, rows: &mut rows };
    whole.deserialize(&mut json).and_then(|()| json.end()).map_err(|e| {
        let hint =
            if e.is_syntax() { " (NaN is no JSON: write null for a velocity that is not known)" } else { "" };
        fault(path, format!("is no file of nuScenes' results: {e}{hint}"))
    })?;
    rows.finish(path.display().to_string())
}

/// The whole file.
struct Whole<'a> {
    exported: &'a ExportedSamples,
    rows: &'a mut Scratch,
}

impl<'de> DeserializeSeed<'de> for Whole<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Whole<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object with `meta` and `results`")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let mut has_results = false;
        while let Some(key) = map.next_key::<String>()? {
            if key == "results" && !has_results {
                has_results = true;
                map.next_value_seed(Results { exported: self.exported, rows: self.rows })?;
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        if has_results { Ok(()) } else { Err(A::Error::missing_field("results")) }
    }
}

/// Boxes by sample.
struct Results<'a> {
    exported: &'a ExportedSamples,
    rows: &'a mut Scratch,
}

impl<'de> DeserializeSeed<'de> for Results<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Results<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object of lists of boxes by sample token")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let mut known = BTreeSet::new();
        while let Some(token) = map.next_key::<String>()? {
            let Some((sample, shift)) = self.exported.sample(&token) else {
                return Err(A::Error::custom(format!("sample `{token}` is none of the export's")));
            };
            if !known.insert(sample) {
                return Err(A::Error::custom(format!("sample `{token}` comes twice")));
            }
            let rows = &mut *self.rows;
            map.next_value_seed(Boxes { token: &token, sample, shift, rows })?;
        }
        Ok(())
    }
}

/// The boxes of a sample.
struct Boxes<'a> {
    token: &'a str,
    sample: SampleId,
    shift: [f64; 3],
    rows: &'a mut Scratch,
}

impl<'de> DeserializeSeed<'de> for Boxes<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Boxes<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of boxes")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let mut number = 0_usize;
        while let Some(found) = list.next_element::<ResultBox>()? {
            let fault = |problem: String| {
                A::Error::custom(format!("sample `{}`, box {number}: {problem}", self.token))
            };
            if found.sample_token.as_ref().is_some_and(|token| token != self.token) {
                return Err(fault("its `sample_token` is another".into()));
            }
            if let Some(problem) = found.fault() {
                return Err(fault(problem));
            }
            let class = BoxClass::from_name(&found.detection_name).ok_or_else(|| {
                fault(format!("`detection_name` is `{}`, which is no class", found.detection_name))
            })?;
            let found = ForeignBox {
                class,
                score: found.detection_score,
                translation: found.translation,
                size: found.size,
                rotation: found.rotation,
                velocity: found.velocity.map(|v| v.unwrap_or(f64::NAN)),
                attribute: &found.attribute_name,
            };
            self.rows.push(self.sample, Some(&found), self.shift);
            number += 1;
        }
        if number == 0 {
            self.rows.push(self.sample, None, self.shift);
        }
        Ok(())
    }
}

/// A box as the devkit's `DetectionBox` has it.
#[derive(Deserialize)]
struct ResultBox {
    sample_token: Option<String>,
    translation: [f64; 3],
    /// Width, length, height.
    size: [f64; 3],
    rotation: [f64; 4],
    #[serde(default)]
    velocity: [Option<f64>; 2],
    detection_name: String,
    detection_score: f64,
    #[serde(default)]
    attribute_name: String,
}

impl ResultBox {
    /// What of it cannot be.
    fn fault(&self) -> Option<String> {
        if !self.size.iter().all(|side| *side > 0.0) {
            return Some(format!("`size` is {:?}, expected lengths above 0", self.size));
        }
        if !self.attribute_name.is_empty() && number_of_attribute(&self.attribute_name).is_none() {
            return Some(format!("`attribute_name` is `{}`, which is no attribute", self.attribute_name));
        }
        let norm: f64 = self.rotation.iter().map(|part| part * part).sum();
        (norm < 1e-12).then(|| format!("`rotation` is {:?}, which is no rotation", self.rotation))
    }
}
