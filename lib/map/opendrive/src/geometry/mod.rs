//! The curves of OpenDRIVE: cubics of s, the reference line in plan, and the road surface built on them.

mod cubic;
mod lateral;
mod plan;
mod surface;
mod widths;

pub(crate) use cubic::{between, record_at, value_and_slope};
pub(crate) use plan::Plan;
pub(crate) use surface::{RoadFrame, Surface};
pub(crate) use widths::lane_width;
