//! What a layout has to say.

use std::collections::BTreeMap;
use std::path::Path;

use scene::{SensorEntry, SensorKind};

use crate::unit::UnitName;
use crate::{ExportError, SceneSource, Source, UnitFiles};

/// What a unit will come to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Frames of agents, for progress.
    pub agent_frames: u64,
    /// Bytes to be written, about.
    pub bytes: u64,
    /// Seconds of one core, about.
    pub cpu_s: f64,
}

impl std::ops::AddAssign for Cost {
    fn add_assign(&mut self, other: Self) {
        self.agent_frames += other.agent_frames;
        self.bytes += other.bytes;
        self.cpu_s += other.cpu_s;
    }
}

/// Something of the store that is not in the export, or not as a reader may expect it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Omission {
    /// What: `SEG-* images`, `radar cross-sections`.
    pub what: String,
    /// Why: `the layout has no place for them`.
    pub why: String,
    /// Whether it is in the export nevertheless, in another way.
    pub is_note: bool,
}

impl Omission {
    /// Something that is left out, and why.
    #[must_use]
    pub fn new(what: impl Into<String>, why: impl Into<String>) -> Self {
        Self { what: what.into(), why: why.into(), is_note: false }
    }

    /// Something that is not as a reader may expect it though nothing is left out, and why.
    #[must_use]
    pub fn note(what: impl Into<String>, why: impl Into<String>) -> Self {
        Self { is_note: true, ..Self::new(what, why) }
    }

    /// A sensor that is left out, and why: of images the kind is told, of others the name.
    #[must_use]
    pub fn sensor(sensor: &SensorEntry, why: impl Into<String>) -> Self {
        match sensor.kind {
            SensorKind::Image(kind) => Self::new(kind.spec().plural, why),
            _ => Self::new(&sensor.name, why),
        }
    }
}

/// A layout in which stores are exported.
///
/// Units, and the pieces of one, are written in parallel (unless [`Layout::is_parallel_inside`]), each piece
/// by one call; what one writes depends on the store and the layout's options alone. What is common to all
/// (lists of scenes, tables that name tokens of several) is made of the units' fragments at the end.
pub trait Layout: Sync {
    /// Its name: `kitti`.
    fn name(&self) -> &'static str;

    /// All its options, from which the export's identity is made: what was exported with others is not gone
    /// on with.
    fn options(&self) -> serde_json::Value;

    /// The same as people give them: what each option has, by its name on the command line.
    fn by_option(&self) -> BTreeMap<String, String>;

    /// What a user should know of a destination before anything is written.
    fn caution(&self, _dest: &Path) -> Option<String> {
        None
    }

    /// Where the user does not say, it takes frames 0, n, 2 n, ...
    fn every_n_frames(&self) -> u32 {
        1
    }

    /// Whether a unit of it keeps all threads busy: then units are made one after another.
    fn is_parallel_inside(&self) -> bool {
        false
    }

    /// The stages that it cannot do without.
    fn needs(&self) -> Vec<&'static str>;

    /// What it leaves out of these scenes, and why; is called before anything is written.
    ///
    /// # Errors
    /// It cannot hold what is asked for: with what to do.
    fn preflight(&self, source: &Source) -> Result<Vec<Omission>, ExportError>;

    /// The units of a scene, in order.
    fn units(&self, scene: &SceneSource) -> Vec<UnitName> {
        let number = scene.number();
        scene.agents().iter().map(|agent| UnitName { scene: number, agent: Some(*agent) }).collect()
    }

    /// What other scenes of the store decide of a unit, in words that stay the same; nothing where it follows
    /// from its own scene. Is asked after [`Layout::preflight`].
    ///
    /// # Errors
    /// The store cannot be read.
    fn of_others(&self, _scene: &SceneSource, _unit: UnitName) -> Result<Option<String>, ExportError> {
        Ok(None)
    }

    /// In how many pieces a unit is written. More than one keep all threads busy also where there are few
    /// units.
    fn pieces(&self, _scene: &SceneSource, _unit: UnitName) -> u32 {
        1
    }

    /// What a unit will come to.
    ///
    /// # Errors
    /// The store cannot be read.
    fn cost(&self, scene: &SceneSource, unit: UnitName) -> Result<Cost, ExportError>;

    /// Writes a piece of a unit, `0..pieces`, at any time before or after the others. What they return is
    /// kept with the unit, put together in their order, for [`Layout::finish`]. `files` is told of every
    /// frame that is done.
    ///
    /// # Errors
    /// The store cannot be read, the destination not be written, or a signal came.
    fn write_piece(
        &self,
        scene: &SceneSource,
        unit: UnitName,
        piece: u32,
        files: &mut UnitFiles<'_>,
    ) -> Result<Vec<u8>, ExportError>;

    /// Writes what is common to all, from the fragments of all units that the destination holds, in their
    /// order. Scenes of earlier runs are among them; `source` has the ones of this run.
    ///
    /// # Errors
    /// As [`Layout::write_piece`].
    fn finish(
        &self,
        source: &Source,
        units: &[(UnitName, Vec<u8>)],
        files: &mut UnitFiles<'_>,
    ) -> Result<(), ExportError>;
}
