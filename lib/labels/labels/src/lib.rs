#![doc = include_str!("../README.md")]

pub mod annotation;
pub mod bev;
pub mod bev_map;
pub mod carve;
pub mod culling;
pub mod fill;
pub mod tracks;
pub mod validity;
pub mod vector_map;
pub mod voxel_grid;
pub mod voxels;
