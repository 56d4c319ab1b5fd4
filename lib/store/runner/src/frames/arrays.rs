//! Labels that are arrays, one a frame in each archive.

use std::borrow::Cow;

use crate::{At, Job, Place, Progress, StageError, StageSettings};
use codecs::{DEFAULT_LEVEL, EncodedMember, NpzError, NpzWriter, Scalar, encode_member, frame_member};
use scene::SceneLog;
use schema::arrays::ArrayKind;
use schema::measures::counts::PartialCounts;
use schema::{AgentId, rate};
use store::{FileWriter, StoreError, Unit, keys};

use crate::frames::order::{FrameGroup, Writer, in_turn};
use crate::frames::pool::BufferPool;

/// An array of one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameArray<'a> {
    /// Type of its values.
    pub scalar: Scalar,
    /// Its shape, C order.
    pub shape: Vec<usize>,
    /// Its values, little-endian.
    pub bytes: Cow<'a, [u8]>,
}

/// A label of an agent: an array a frame in each of some archives. Any thread may ask for any frame.
pub trait FrameArrays: Sync {
    /// Working memory, which frames hand on to one another.
    type Memory: Send;

    /// It has arrays at frames 0, n, 2 n, ...
    fn every_n_frames(&self) -> u32;

    /// The archives, in the order of a frame's arrays.
    fn kinds(&self) -> Vec<&'static ArrayKind>;

    /// What the archives say of themselves, for readers without the configuration: a JSON object, or
    /// nothing.
    ///
    /// # Errors
    /// It cannot be written down.
    fn comment(&self) -> Result<String, StageError> {
        Ok(String::new())
    }

    /// Fresh working memory.
    ///
    /// # Errors
    /// The settings are impossible, or what is read cannot be opened.
    fn memory(&self) -> Result<Self::Memory, StageError>;

    /// The arrays of a frame, one of each kind; what is to be counted of them goes into `counts`.
    ///
    /// # Errors
    /// They cannot be computed.
    fn arrays<'m>(
        &self,
        memory: &'m mut Self::Memory,
        frame: u32,
        counts: &mut PartialCounts,
    ) -> Result<Vec<FrameArray<'m>>, StageError>;
}

/// A label gave other arrays than it said: a bug.
#[derive(Debug, thiserror::Error)]
#[error("a bug in Convoy: the label gave {found} arrays for its {expected} archives (please report it)")]
struct ArraysError {
    found: usize,
    expected: usize,
}

/// An archive in hand.
struct Archive {
    writer: NpzWriter<FileWriter>,
    location: String,
}

impl Archive {
    fn start(unit: &Unit<'_>, key: &str, comment: &str) -> Result<Self, StageError> {
        let file = unit.file(key)?;
        let location = file.location().to_owned();
        let mut writer = NpzWriter::new(file);
        writer.set_comment(comment).map_err(|e| failed(&location, None, e))?;
        Ok(Self { writer, location })
    }
}

fn failed(location: &str, frame: Option<u32>, error: NpzError) -> StageError {
    match error {
        NpzError::Io(source) => StoreError::write(location, "write", source).into(),
        refused => StageError::Failed {
            place: Box::new(Place { frame, ..Place::file(location) }),
            source: refused.into(),
        },
    }
}

/// An agent's label with the unit that its archives belong to.
#[derive(Debug)]
pub struct Labelled<'u, L> {
    /// A unit of its own.
    pub unit: Unit<'u>,
    /// The scene.
    pub scene: u32,
    /// The agent.
    pub agent: AgentId,
    /// Key of the table of what is counted, where that is wanted.
    pub counted: Option<String>,
    /// The label.
    pub label: L,
}

/// What any thread sees of an agent's label.
struct SharedLabel<L: FrameArrays> {
    label: L,
    locations: Vec<String>,
    pool: BufferPool<L::Memory>,
}

impl<L: FrameArrays> SharedLabel<L> {
    fn frame(&self, frame: u32) -> Result<OfFrame, StageError> {
        let mut memory = self.pool.take(|| self.label.memory())?;
        let mut counts = PartialCounts::new();
        let mut members = Vec::with_capacity(self.locations.len());
        let arrays = self.label.arrays(&mut memory, frame, &mut counts)?;
        let (found, expected) = (arrays.len(), self.locations.len());
        if found != expected {
            // The first that is too few, or the last that there is.
            let location = self.locations.get(found).or(self.locations.last()).cloned().unwrap_or_default();
            let place = || Place::file(&location).frame(frame);
            return Err(ArraysError { found, expected }).at(place);
        }
        for (array, location) in arrays.into_iter().zip(&self.locations) {
            let FrameArray { scalar, shape, bytes } = array;
            let member = encode_member(&frame_member(frame), scalar, &shape, &bytes, DEFAULT_LEVEL);
            members.push(member.at(|| Place::file(location).frame(frame))?);
        }
        self.pool.give(memory);
        Ok((members, counts))
    }
}

/// Compressed arrays of a frame, and what was counted of it.
type OfFrame = (Vec<EncodedMember>, PartialCounts);

/// The open archives of an agent.
struct Archives<'u> {
    unit: Unit<'u>,
    archives: Vec<Archive>,
    frames: u64,
    counts: PartialCounts,
    counted: Option<String>,
}

/// Starts the archives of a label.
fn open<L: FrameArrays>(
    labelled: Labelled<'_, L>,
    frames: u32,
) -> Result<FrameGroup<SharedLabel<L>, Archives<'_>>, StageError> {
    let Labelled { unit, scene, agent, counted, label } = labelled;
    let (kinds, comment) = (label.kinds(), label.comment()?);
    let mut archives = Vec::with_capacity(kinds.len());
    for kind in &kinds {
        archives.push(Archive::start(&unit, &keys::array(scene, kind, agent), &comment)?);
    }
    let locations = archives.iter().map(|archive| archive.location.clone()).collect();
    let due: Vec<u32> = rate::due(frames, label.every_n_frames()).collect();
    let seen = SharedLabel { label, locations, pool: BufferPool::default() };
    let (frames, counts) = (due.len() as u64, PartialCounts::new());
    Ok(FrameGroup { due, seen, writer: Archives { unit, archives, frames, counts, counted } })
}

impl Writer<OfFrame> for Archives<'_> {
    fn take(&mut self, frame: u32, (members, counts): OfFrame) -> Result<(), StageError> {
        self.counts.merge(counts);
        for (archive, member) in self.archives.iter_mut().zip(members) {
            archive.writer.append(member).map_err(|e| failed(&archive.location, Some(frame), e))?;
        }
        Ok(())
    }

    fn finish(self) -> Result<(), StageError> {
        let Self { mut unit, archives, frames, counts, counted } = self;
        for Archive { writer, location } in archives {
            let file = writer.finish().map_err(|e| failed(&location, None, e))?;
            unit.add(file.finish(frames)?);
        }
        if let Some(key) = counted {
            unit.rows(&key, &counts.rows())?;
        }
        unit.finish()?;
        Ok(())
    }
}

/// Writes labels one after the other: the arrays of those of the frames `0..frames` at which each has some,
/// an archive of each kind among its unit's files, and what was counted.
///
/// # Errors
/// The first error in order, a wish to stop, or an archive cannot be written.
pub fn write_labels<'u, L: FrameArrays + Send>(
    labels: impl IntoIterator<Item = Result<Labelled<'u, L>, StageError>>,
    frames: u32,
    progress: &Progress,
) -> Result<(), StageError> {
    let parts = labels.into_iter().map(|labelled| open(labelled?, frames));
    in_turn(parts, frames, progress, SharedLabel::frame)
}

/// A label stage: the arrays of every agent, each agent's archives and counts a unit of their own. `label`
/// gives an agent's label by its position in the log, or `None` where it is not wanted.
///
/// # Errors
/// As [`write_labels`].
pub fn label_agents<S: StageSettings, L: FrameArrays + Send>(
    job: &Job<'_, S>,
    log: &SceneLog,
    mut label: impl FnMut(usize, AgentId) -> Option<L>,
) -> Result<(), StageError> {
    let (scene, frames, progress) = (job.scene(), log.frame_count(), job.progress());
    progress.set_total(u64::from(frames) * log.agent_ids().len() as u64);
    let labels = log.agent_ids().iter().enumerate().filter_map(|(position, &agent)| {
        let label = label(position, agent)?;
        let counted = Some(keys::partial_stats(scene, &format!("{}.{agent}", S::STAGE)));
        let labelled = |unit| Labelled { unit, scene, agent, counted, label };
        job.unit(&agent.to_string()).map(|unit| unit.map(labelled)).transpose()
    });
    write_labels(labels, frames, &progress)
}
