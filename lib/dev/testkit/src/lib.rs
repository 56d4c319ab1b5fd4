//! What tests share: real maps, small roads, meshes and snapshots, random shapes, a renderer by brute force.
//! Only tests, benchmarks and examples depend on it.
//!
//! What a machine may lack (real maps, Python packages, npm, a browser) is asked for here, so that one rule
//! holds everywhere: the test prints that it skips, and fails instead where `CONVOY_REQUIRE` names what is
//! missing ([`Need`]).
//!
//! ```
//! use opendrive::LaneType;
//! use testkit::{both_ways, map, road};
//!
//! // 100 m to the east, a lane each way.
//! let map = map(vec![road("1", [0.0, 0.0], 0.0, 100.0, both_ways(&[(LaneType::Driving, 3.5)]))]);
//! let lane = map.lanes()[0].id;
//! assert_eq!(map.lane_width(lane, 50.0), Some(3.5));
//! ```

mod agreement;
mod brute;
pub mod bucket;
mod maps;
mod meshes;
mod need;
pub mod random_world;
mod roads;
mod town;

pub use agreement::{Agreement, PixelRays, camera_at};
pub use brute::BruteRenderer;
pub use maps::{map_files, maps_folder, real_map, real_maps};
pub use meshes::{MeshBuilder, block, instance, plane, snapshot};
pub use need::{Need, chromium, devkit, python, skip};
pub use roads::{
    both_ways, crossing, crossing_network, lane, map, map_from_text, one_way, road, road_link, straight,
    straight_road, town_street,
};
pub use town::{WorldBuilder, box_mesh, sheet, small_town};
