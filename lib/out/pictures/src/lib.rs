#![doc = include_str!("../README.md")]

mod bev;
mod boxes;
mod camera;
mod canvas;
mod cloud;
mod codec;
mod colours;
mod error;
mod flow;
mod grid;
mod ground;
mod images;
mod legend;
mod marks;
mod sheet;
mod view;
mod voxels;

pub use bev::{BevPalette, draw_bev};
pub use boxes::{BoxShape, draw_boxes};
pub use camera::Camera;
pub use canvas::{Anchor, Canvas, Rgb};
pub use cloud::{Cloud, ColourBy, draw_cloud};
pub use codec::{decode_jpeg, decode_png};
pub use colours::{
    agent_rgb, box_rgb, depth_rgb, distance_rgb, flow_rgb, height_rgb, id_rgb, intensity_rgb, velocity_rgb,
};
pub use error::PictureError;
pub use flow::draw_flow;
pub use grid::VoxelGrid;
pub use ground::{GroundLine, GroundStyle, draw_ground};
pub use images::{draw_depth, draw_instances};
pub use legend::{ColourBar, agent_names, draw_names, draw_wheel};
pub use marks::{Tone, draw_ego, draw_plate, draw_rings, draw_scale_bar, label_rings};
pub use sheet::{Panel, Sheet, draw_sheet};
pub use view::{Reach, View};
pub use voxels::draw_voxels;
