//! Optical flow: where each pixel's surface was one frame ago.

use render::flow;
use schema::ImageKind;
use schema::geometry::Snapshot;
use schema::images::{Flow, OfKind};
use schema::table::Halves;
use schema::tables::{FlowRow, HalfFlowRow};

use super::image::Image;
use crate::error::SensorError;
use shading::Sight;

/// Current minus previous position on the screen of the surface at each pixel, x right, y up, the picture
/// being 2 units wide and high.
///
/// "Previous" is one frame period earlier, however seldom pictures are taken. The sky is infinitely far: it
/// moves with the camera's rotation alone. Each component is limited to +-2, which a surface that was beside
/// or behind the camera a frame ago exceeds, and rounded to a multiple of 2^-17. Static objects before a
/// camera that stands still has flow 0 exactly.
impl Image for Flow {
    type Row = FlowRow;

    fn of(snapshot: &Snapshot, sight: &Sight, frame: u32) -> Result<FlowRow, SensorError> {
        let (dx, dy) = flow(snapshot, &sight.view, &sight.seen);
        let (width, height) = (sight.seen.width, sight.seen.height);
        Ok(FlowRow { frame, time_s: crate::frame_time_s(frame), width, height, dx, dy })
    }
}

/// Flow that is kept as half floats.
#[derive(Debug)]
pub(crate) enum HalfFlow {}

impl OfKind for HalfFlow {
    const KIND: ImageKind = ImageKind::Flow;
}

impl Image for HalfFlow {
    type Row = HalfFlowRow;

    fn of(snapshot: &Snapshot, sight: &Sight, frame: u32) -> Result<HalfFlowRow, SensorError> {
        let FlowRow { frame, time_s, width, height, dx, dy } = Flow::of(snapshot, sight, frame)?;
        Ok(HalfFlowRow { frame, time_s, width, height, dx: Halves(dx), dy: Halves(dy) })
    }
}
