//! The boxes of an agent or of all, frame by frame, with what its sensors saw of each.

use schema::AgentId;
use schema::table::{Framed, Row};
use schema::tables::{BoxRow, ValidBoxRow};
use store::{RowGroups, keys};

use crate::{SceneError, SceneReader};

/// A box and what the agent's sensors saw of it.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelledBox {
    /// The box.
    pub raw: BoxRow,
    /// What was seen of it; none where `postprocess-valid` has not been run.
    pub seen: Option<ValidBoxRow>,
}

/// The boxes of an agent, or of all of them, in frame order. A few thousand rows are in memory at a time.
pub struct BoxFrames {
    boxes: Rows<BoxRow>,
    seen: Option<Rows<ValidBoxRow>>,
    agent: Option<String>,
    held: Option<LabelledBox>,
}

impl BoxFrames {
    /// Opens the boxes of an agent; with `seen`, and what its sensors saw of them.
    ///
    /// # Errors
    /// A stage has not made its part, or a table is not as its manifest says.
    pub fn open(scene: &SceneReader, agent: AgentId, seen: bool) -> Result<Self, SceneError> {
        Ok(Self { agent: Some(agent.to_string()), ..Self::open_all(scene, seen)? })
    }

    /// Opens the boxes of all agents, likewise: a frame has those of one after those of another.
    ///
    /// # Errors
    /// As [`BoxFrames::open`].
    pub fn open_all(scene: &SceneReader, seen: bool) -> Result<Self, SceneError> {
        let seen = if seen { Some(Rows::open(scene)?) } else { None };
        Ok(Self { boxes: Rows::open(scene)?, seen, agent: None, held: None })
    }

    /// The boxes of a frame. Frames must be asked for in ascending order; those between are passed over.
    ///
    /// # Errors
    /// A table cannot be read, or the two do not go together.
    pub fn at(&mut self, frame: u32) -> Result<Vec<LabelledBox>, SceneError> {
        let mut found = Vec::new();
        loop {
            let next = match self.held.take() {
                Some(held) => held,
                None => match self.next_row()? {
                    Some(row) => row,
                    None => return Ok(found),
                },
            };
            if next.raw.frame > frame {
                self.held = Some(next);
                return Ok(found);
            }
            if next.raw.frame == frame {
                found.push(next);
            }
        }
    }

    /// The next row that is wanted.
    fn next_row(&mut self) -> Result<Option<LabelledBox>, SceneError> {
        while let Some(raw) = self.boxes.next_row()? {
            let seen = match &mut self.seen {
                None => None,
                Some(seen) => {
                    let row = seen.next_row()?;
                    let same = |row: &ValidBoxRow| {
                        (row.frame, row.id) == (raw.frame, raw.id) && row.agent == raw.agent
                    };
                    match row.filter(same) {
                        Some(row) => Some(row),
                        None => return Err(seen.unlike(raw.frame())),
                    }
                }
            };
            if self.agent.as_ref().is_none_or(|agent| *agent == raw.agent) {
                return Ok(Some(LabelledBox { raw, seen }));
            }
        }
        Ok(None)
    }
}

/// The rows of a table, one by one.
struct Rows<R> {
    path: String,
    groups: RowGroups<R>,
    ready: std::vec::IntoIter<R>,
}

impl<R: Row> Rows<R> {
    fn open(scene: &SceneReader) -> Result<Self, SceneError> {
        let key = keys::scene(scene.scene(), &format!("{}.parquet", R::TABLE));
        let groups = scene.store().row_groups(scene.manifest(R::STAGE)?, &key)?;
        Ok(Self { path: scene.store().location(&key), groups, ready: Vec::new().into_iter() })
    }

    fn next_row(&mut self) -> Result<Option<R>, SceneError> {
        loop {
            if let Some(row) = self.ready.next() {
                return Ok(Some(row));
            }
            match self.groups.next() {
                Some(group) => self.ready = group?.into_iter(),
                None => return Ok(None),
            }
        }
    }

    /// This table has not a row for each of the other.
    fn unlike(&self, frame: i64) -> SceneError {
        SceneError::Unlike { path: self.path.clone(), frame }
    }
}
