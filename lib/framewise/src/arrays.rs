//! Labels that are arrays, one a frame in each archive.

use std::borrow::Cow;

use counts::PartialCounts;
use formats::{DEFAULT_LEVEL, NpzError, NpzWriter, Scalar, encode_member, frame_member};
use pipeline::{At, Job, Place, Progress, StageError, StageSettings};
use scene::SceneLog;
use schema::arrays::ArrayKind;
use schema::{AgentId, rate};
use store::{FileWriter, StoreError, Unit, keys};

use crate::order::in_frame_order;
use crate::pool::BufferPool;

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

    /// What the archives say of themselves, for who reads them without the configuration: a JSON object, or nothing.
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

/// Writes the arrays of those of the frames `0..frames` at which an agent has some, an archive of each kind among a unit's
/// files. Returns what was counted.
///
/// # Errors
/// The first error in frame order, a wish to stop, or an archive cannot be written.
pub fn write_arrays<A: FrameArrays>(
    unit: &mut Unit<'_>,
    (scene, agent): (u32, AgentId),
    frames: u32,
    progress: &Progress,
    arrays: &A,
) -> Result<PartialCounts, StageError> {
    let (kinds, comment) = (arrays.kinds(), arrays.comment()?);
    let mut archives = Vec::with_capacity(kinds.len());
    for kind in &kinds {
        archives.push(Archive::start(unit, &keys::array(scene, kind, agent), &comment)?);
    }
    let locations: Vec<String> = archives.iter().map(|archive| archive.location.clone()).collect();
    let pool = BufferPool::default();
    let one = |frame: u32| {
        let mut memory = pool.take(|| arrays.memory())?;
        let mut counts = PartialCounts::new();
        let mut members = Vec::with_capacity(locations.len());
        for (array, location) in arrays.arrays(&mut memory, frame, &mut counts)?.into_iter().zip(&locations) {
            let FrameArray { scalar, shape, bytes } = array;
            let member = encode_member(&frame_member(frame), scalar, &shape, &bytes, DEFAULT_LEVEL);
            members.push(member.at(|| Place::file(location).frame(frame))?);
        }
        pool.give(memory);
        Ok((members, counts))
    };
    let mut counts = PartialCounts::new();
    let due: Vec<u32> = rate::due(frames, arrays.every_n_frames()).collect();
    in_frame_order((&due, frames), progress, one, |number, (members, of_frame)| {
        counts.merge(of_frame);
        for (archive, member) in archives.iter_mut().zip(members) {
            archive.writer.append(member).map_err(|e| failed(&archive.location, Some(number), e))?;
        }
        Ok(())
    })?;
    for Archive { writer, location } in archives {
        let file = writer.finish().map_err(|e| failed(&location, None, e))?;
        unit.add(file.finish(due.len() as u64)?);
    }
    Ok(counts)
}

/// A label stage: the arrays of every agent, each agent's archives and counts a unit of their own. `label` gives an agent's
/// label by its position in the log, or `None` where it is not wanted.
///
/// # Errors
/// As [`write_arrays`].
pub fn label_agents<S: StageSettings, L: FrameArrays>(
    job: &mut Job<'_, S>,
    log: &SceneLog,
    mut label: impl FnMut(usize, AgentId) -> Option<L>,
) -> Result<(), StageError> {
    let (scene, frames, progress) = (job.scene(), log.frame_count(), job.progress());
    progress.set_total(u64::from(frames) * log.agent_ids().len() as u64);
    for (position, &agent) in log.agent_ids().iter().enumerate() {
        let Some(label) = label(position, agent) else { continue };
        let Some(mut unit) = job.unit(&agent.to_string())? else { continue };
        let counts = write_arrays(&mut unit, (scene, agent), frames, &progress, &label)?;
        let stats = keys::partial_stats(scene, &format!("{}.{agent}", S::STAGE));
        unit.rows(&stats, &counts.rows())?;
        unit.finish()?;
    }
    Ok(())
}
