//! What pictures are drawn from.

use pictures::{BoxShape, Canvas, ColourBy};

use crate::feed::{AgentFrame, Rig};
use crate::session::Session;

/// Least height of text that is read without effort, and least width of a picture that has room for it,
/// pixels.
const TEXT_PX: f64 = 8.0;
const ROOM_PX: f64 = 240.0;

/// What pictures are drawn from.
#[derive(Clone, Copy)]
pub(crate) struct Desk<'a> {
    pub(crate) session: &'a Session,
    pub(crate) frame: u32,
    /// All agents that were read, and their rigs.
    pub(crate) agents: &'a [AgentFrame],
    pub(crate) rigs: &'a [Rig],
    /// What the colours of points tell, where it was said.
    pub(crate) colour: Option<ColourBy>,
    /// Height of the text of scales and legends, as a share of a picture's width.
    pub(crate) text: f64,
}

impl Desk<'_> {
    /// Height of the text on a picture, pixels.
    pub(crate) fn text_px(&self, canvas: &Canvas) -> f64 {
        let width = f64::from(canvas.size()[0]);
        let text_px = self.text * width;
        if width < ROOM_PX { text_px } else { text_px.max(TEXT_PX) }
    }

    /// Width of the thinnest lines of boxes on a picture, pixels.
    pub(crate) fn line_px(&self, canvas: &Canvas) -> f64 {
        (0.09 * self.text * f64::from(canvas.size()[0])).max(0.5)
    }
}

/// The boxes of all agents, each object once: as easy as it is to whom it is easiest.
pub(crate) fn boxes_of_all(agents: &[AgentFrame]) -> Vec<BoxShape> {
    let mut boxes: Vec<BoxShape> = agents.iter().flat_map(|a| a.boxes.iter().map(|(b, _)| *b)).collect();
    boxes.sort_by_key(|shape| (shape.id, shape.difficulty));
    boxes.dedup_by_key(|shape| shape.id);
    boxes
}
