//! Labels that are one array a frame.

use std::borrow::Cow;

use counts::PartialCounts;
use formats::{DEFAULT_LEVEL, NpzError, NpzWriter, Scalar, encode_member, frame_member};
use pipeline::{At, Job, Place, Progress, StageError, StageSettings};
use scene::SceneLog;
use schema::AgentId;
use schema::arrays::ArrayKind;
use store::{StoreError, Unit, keys};

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

/// A label of an agent: one array a frame. Any thread may ask for any frame.
pub trait FrameArrays: Sync {
    /// Working memory, which frames hand on to one another.
    type Memory: Send;

    /// Fresh working memory.
    ///
    /// # Errors
    /// The settings are impossible, or what is read cannot be opened.
    fn memory(&self) -> Result<Self::Memory, StageError>;

    /// The array of a frame; what is to be counted of it goes into `counts`.
    ///
    /// # Errors
    /// It cannot be computed.
    fn array<'m>(
        &self,
        memory: &'m mut Self::Memory,
        frame: u32,
        counts: &mut PartialCounts,
    ) -> Result<FrameArray<'m>, StageError>;
}

/// Writes the arrays of frames `0..frames` as one archive among a unit's files. Returns what was counted.
///
/// # Errors
/// The first error in frame order, a wish to stop, or the archive cannot be written.
pub fn write_arrays<A: FrameArrays>(
    unit: &mut Unit<'_>,
    key: &str,
    frames: u32,
    progress: &Progress,
    arrays: &A,
) -> Result<PartialCounts, StageError> {
    let file = unit.file(key)?;
    let location = file.location().to_owned();
    let failed = |frame: Option<u32>, error: NpzError| match error {
        NpzError::Io(source) => StoreError::write(&location, "write", source).into(),
        refused => StageError::Failed {
            place: Box::new(Place { frame, ..Place::file(&location) }),
            source: refused.into(),
        },
    };
    let pool = BufferPool::default();
    let one = |frame: u32| {
        let mut memory = pool.take(|| arrays.memory())?;
        let mut counts = PartialCounts::new();
        let FrameArray { scalar, shape, bytes } = arrays.array(&mut memory, frame, &mut counts)?;
        let member = encode_member(&frame_member(frame), scalar, &shape, &bytes, DEFAULT_LEVEL)
            .at(|| Place::file(&location).frame(frame))?;
        drop(bytes);
        pool.give(memory);
        Ok((member, counts))
    };
    let mut writer = NpzWriter::new(file);
    let mut counts = PartialCounts::new();
    in_frame_order(frames, progress, one, |number, (member, of_frame)| {
        counts.merge(of_frame);
        writer.append(member).map_err(|e| failed(Some(number), e))
    })?;
    let file = writer.finish().map_err(|e| failed(None, e))?;
    unit.add(file.finish(frames.into())?);
    Ok(counts)
}

/// A label stage: the arrays of every agent, each agent's archive and counts a unit of their own. `label` gives an agent's
/// label by its position in the log, or `None` where it is not wanted.
///
/// # Errors
/// As [`write_arrays`].
pub fn label_agents<S: StageSettings, L: FrameArrays>(
    job: &mut Job<'_, S>,
    log: &SceneLog,
    kind: &ArrayKind,
    label: impl Fn(usize, AgentId) -> Option<L>,
) -> Result<(), StageError> {
    let (scene, frames, progress) = (job.scene(), log.frame_count(), job.progress());
    progress.set_total(u64::from(frames) * log.agent_ids().len() as u64);
    for (position, &agent) in log.agent_ids().iter().enumerate() {
        let Some(label) = label(position, agent) else { continue };
        let Some(mut unit) = job.unit(&agent.to_string())? else { continue };
        let counts = write_arrays(&mut unit, &keys::array(scene, kind, agent), frames, &progress, &label)?;
        let stats = keys::partial_stats(scene, &format!("{}.{agent}", S::STAGE));
        unit.rows(&stats, &counts.rows())?;
        unit.finish()?;
    }
    Ok(())
}
