//! The annotations of an export to nuScenes, as nuscenes-devkit holds results against them.

use std::collections::BTreeMap;
use std::path::Path;

use scene::SceneReader;
use schema::{AgentId, Difficulty, nuscenes_class};
use serde::Deserialize;

use crate::EvaluationError;
use crate::boxes::{SampleId, Sighting, Target};
use crate::class::BoxClass;
use crate::exported::{ExportedSamples, each_row, fault};
use crate::mode::Mode;
use crate::predictions::{FoundBox, PredictionFile, PredictionRow};
use crate::sample::range_of;
use crate::scratch::{ForeignBox, Scratch};

/// Velocities are taken from boxes at most so far apart in time, and twice as far over both neighbours, s
/// (`NuScenes.box_velocity`).
const MOST_APART_S: f64 = 1.5;

/// A row of a small table.
#[derive(Deserialize)]
struct Named {
    token: String,
    name: String,
}

/// A row of `instance.json`.
#[derive(Deserialize)]
struct Instance {
    token: String,
    category_token: String,
}

/// A row of `sample.json`.
#[derive(Deserialize)]
struct Sample {
    token: String,
    timestamp: u64,
}

/// A row of `sample_annotation.json`.
#[derive(Deserialize)]
struct Annotation {
    token: String,
    sample_token: String,
    instance_token: String,
    attribute_tokens: Vec<String>,
    translation: [f64; 3],
    size: [f64; 3],
    rotation: [f64; 4],
    prev: String,
    next: String,
    num_lidar_pts: u64,
    num_radar_pts: u64,
}

/// Reads what each agent has annotated and has a point of, into a file of our own form; rows without a box
/// name samples that have none.
///
/// # Errors
/// A table cannot be read, or names what is not there; the temporary file cannot be written.
pub fn read_annotations(exported: &ExportedSamples) -> Result<PredictionFile, EvaluationError> {
    let mut rows = Scratch::new()?;
    let mut names = Vec::new();
    for version in exported.versions() {
        let path = version.join("sample_annotation.json");
        let tables = Tables::read(version, exported)?;
        let mut group: Option<(SampleId, Vec<Annotation>)> = None;
        each_row(&path, |row: Annotation| {
            let (sample, _) = exported.sample(&row.sample_token).ok_or_else(|| {
                format!("`{}`: its sample `{}` is not in cooperation.json", row.token, row.sample_token)
            })?;
            match &mut group {
                // An agent's annotations stand together: chains of boxes do not leave them.
                Some((first, rows)) if (first.scene, first.ego) == (sample.scene, sample.ego) => {
                    rows.push(row)
                }
                _ => {
                    let before = group.replace((sample, vec![row]));
                    before.map_or(Ok(()), |(_, whole)| tables.write(&whole, exported, &mut rows))?;
                }
            }
            Ok(())
        })?;
        let last = group.map_or(Ok(()), |(_, whole)| tables.write(&whole, exported, &mut rows));
        last.map_err(|problem| fault(&path, problem))?;
        names.push(path.display().to_string());
    }
    for sample in exported.samples() {
        rows.push(sample, None, [0.0; 3]);
    }
    rows.finish(names.join(", "))
}

/// What annotations of a version refer to.
struct Tables {
    /// Classes by instance; none of those that are not evaluated.
    classes: BTreeMap<String, Option<BoxClass>>,
    attributes: BTreeMap<String, String>,
    /// Moments of samples, microseconds.
    times_us: BTreeMap<String, u64>,
}

impl Tables {
    fn read(version: &Path, exported: &ExportedSamples) -> Result<Self, EvaluationError> {
        let (mut categories, mut attributes) = (BTreeMap::new(), BTreeMap::new());
        each_row(&version.join("category.json"), |row: Named| {
            categories.insert(row.token, nuscenes_class(&row.name).and_then(BoxClass::from_name));
            Ok(())
        })?;
        each_row(&version.join("attribute.json"), |row: Named| {
            attributes.insert(row.token, row.name);
            Ok(())
        })?;
        let (mut classes, mut times_us) = (BTreeMap::new(), BTreeMap::new());
        each_row(&version.join("instance.json"), |row: Instance| {
            let class = categories.get(&row.category_token);
            let class =
                class.ok_or_else(|| format!("`{}`: its category is not in category.json", row.token))?;
            classes.insert(row.token, *class);
            Ok(())
        })?;
        each_row(&version.join("sample.json"), |row: Sample| {
            if exported.sample(&row.token).is_some() {
                times_us.insert(row.token, row.timestamp);
            }
            Ok(())
        })?;
        Ok(Self { classes, attributes, times_us })
    }

    /// Writes the annotations of an agent of a scene.
    fn write(
        &self,
        whole: &[Annotation],
        exported: &ExportedSamples,
        rows: &mut Scratch,
    ) -> Result<(), String> {
        let by_token: BTreeMap<&str, &Annotation> =
            whole.iter().map(|row| (row.token.as_str(), row)).collect();
        for row in whole {
            let missing = |what: &str| format!("`{}`: its {what} is not in the export", row.token);
            let (sample, shift) = exported.sample(&row.sample_token).ok_or_else(|| missing("sample"))?;
            let class = self.classes.get(&row.instance_token).ok_or_else(|| missing("instance"))?;
            let Some(class) = class.filter(|_| row.num_lidar_pts + row.num_radar_pts > 0) else { continue };
            let attribute = match row.attribute_tokens.as_slice() {
                [] => "",
                [one] => self.attributes.get(one).ok_or_else(|| missing("attribute"))?,
                more => {
                    return Err(format!(
                        "`{}` has {} attributes, expected one at most",
                        row.token,
                        more.len()
                    ));
                }
            };
            let found = ForeignBox {
                class,
                score: 1.0,
                translation: row.translation,
                size: row.size,
                rotation: row.rotation,
                velocity: self.velocity_mps(row, &by_token)?,
                attribute,
            };
            rows.push(sample, Some(&found), shift);
        }
        Ok(())
    }

    /// The velocity of an annotated object in the global frame, m/s, from its boxes before and after; NaN
    /// where these are too far apart. Rounded as the devkit rounds, which takes times in seconds since 1970.
    fn velocity_mps(
        &self,
        of: &Annotation,
        by_token: &BTreeMap<&str, &Annotation>,
    ) -> Result<[f64; 2], String> {
        let beside = |token: &String| match token.is_empty() {
            true => Ok(None),
            false => by_token.get(token.as_str()).copied().map(Some).ok_or_else(|| {
                format!(
                    "`{}`: `{token}`, before or after it, is none of the same agent's annotations",
                    of.token
                )
            }),
        };
        let (before, after) = (beside(&of.prev)?, beside(&of.next)?);
        let most_s = if before.is_some() && after.is_some() { 2.0 * MOST_APART_S } else { MOST_APART_S };
        let (first, last) = (before.unwrap_or(of), after.unwrap_or(of));
        let time_s = |row: &Annotation| {
            let time_us = self.times_us.get(&row.sample_token);
            let time_us =
                time_us.ok_or_else(|| format!("`{}`: its sample is not in sample.json", row.token))?;
            Ok::<f64, String>(1e-6 * *time_us as f64)
        };
        let apart_s = time_s(last)? - time_s(first)?;
        if before.or(after).is_none() || apart_s > most_s {
            return Ok([f64::NAN; 2]);
        }
        Ok([0, 1].map(|axis| (last.translation[axis] - first.translation[axis]) / apart_s))
    }
}

/// The annotations of a scene.
pub(crate) struct SceneAnnotations {
    /// By agent and frame.
    rows: Vec<PredictionRow>,
}

impl SceneAnnotations {
    /// Reads those of a scene.
    pub(crate) fn read(file: &PredictionFile, scene: &SceneReader) -> Result<Self, EvaluationError> {
        let mut rows = file.rows(scene.scene())?;
        rows.sort_by_key(|row| (row.agent, row.frame));
        Ok(Self { rows })
    }

    /// The targets of a sample, whose ego is somewhere; none of a sample that the export has not.
    pub(crate) fn targets(&self, frame: u32, ego: AgentId, ego_m: [f64; 3]) -> Option<Vec<Target>> {
        let rows = &self.rows[range_of(&self.rows, ego, frame, Mode::Unsaid)];
        let target = |found: &FoundBox| {
            let (class, range_m) = found.class.in_nuscenes()?;
            let target = Target {
                class,
                solid: found.solid,
                distance_m: found.solid.away_m(ego_m),
                difficulty: Difficulty::Easy,
                sighting: Sighting::Nobody,
                attribute: found.attribute,
            };
            Some(target).filter(|target| target.distance_m < range_m)
        };
        let targets = rows.iter().filter_map(|row| target(row.found.as_ref()?)).collect();
        (!rows.is_empty()).then_some(targets)
    }
}
