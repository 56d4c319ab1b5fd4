//! The boxes of an agent or of all, frame by frame, with what its sensors saw of each.

use std::ops::Range;

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
    held: Option<LabelledBox>,
}

impl BoxFrames {
    /// Opens the boxes of an agent; with `seen`, and what its sensors saw of them. Those of others are not
    /// decoded.
    ///
    /// # Errors
    /// A stage has not made its part, or a table is not as its manifest says.
    pub fn open(scene: &SceneReader, agent: AgentId, seen: bool) -> Result<Self, SceneError> {
        let (agent, mut whose) = (agent.to_string(), Rows::<Whose>::open(scene, None)?);
        let (mut row, mut own): (usize, Vec<Range<usize>>) = (0, Vec::new());
        while let Some(next) = whose.next_row()? {
            match own.last_mut() {
                _ if next.agent != agent => {}
                Some(range) if range.end == row => range.end += 1,
                _ => own.push(row..row + 1),
            }
            row += 1;
        }
        let seen = if seen { Some(Rows::open(scene, Some(own.clone()))?) } else { None };
        Ok(Self { boxes: Rows::open(scene, Some(own))?, seen, held: None })
    }

    /// Opens the boxes of all agents, likewise: a frame has those of one after those of another.
    ///
    /// # Errors
    /// As [`BoxFrames::open`].
    pub fn open_all(scene: &SceneReader, seen: bool) -> Result<Self, SceneError> {
        let seen = if seen { Some(Rows::open(scene, None)?) } else { None };
        Ok(Self { boxes: Rows::open(scene, None)?, seen, held: None })
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

    fn next_row(&mut self) -> Result<Option<LabelledBox>, SceneError> {
        let Some(raw) = self.boxes.next_row()? else { return Ok(None) };
        let Some(table) = &mut self.seen else { return Ok(Some(LabelledBox { raw, seen: None })) };
        let row = table.next_row()?;
        let same = |row: &ValidBoxRow| (row.frame, row.id) == (raw.frame, raw.id) && row.agent == raw.agent;
        match row.filter(same) {
            Some(row) => Ok(Some(LabelledBox { raw, seen: Some(row) })),
            None => Err(table.unlike(raw.frame())),
        }
    }
}

schema::columns! {
    /// Which agent a box is one of.
    Whose of BoxRow { agent: String }
}

/// The rows of a table, one by one.
struct Rows<R> {
    path: String,
    groups: RowGroups<R>,
    ready: std::vec::IntoIter<R>,
}

impl<R: Row> Rows<R> {
    /// Opens a table; all rows are wanted where none are named.
    fn open(scene: &SceneReader, wanted: Option<Vec<Range<usize>>>) -> Result<Self, SceneError> {
        let key = keys::table::<R>(scene.scene());
        let (store, manifest) = (scene.store(), scene.manifest(R::STAGE)?);
        let groups = match wanted {
            Some(wanted) => store.rows_at(manifest, &key, wanted)?,
            None => store.row_groups(manifest, &key)?,
        };
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
