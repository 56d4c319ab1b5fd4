//! What bird's-eye-view masks take from the map, as plain values of `bev`: `paint.rs` gives the middles of
//! lane markings and the paint that is none (stop lines, parking spaces, arrows, words) about some places,
//! for the rule `exact`; `lanes.rs` the lanes as the rule `simbev2x` samples them about an agent.

mod lanes;
mod paint;

pub use lanes::LaneCollector;
pub use paint::{Paint, Reach, road_lines};
