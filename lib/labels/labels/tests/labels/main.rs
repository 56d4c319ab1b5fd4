//! Tests of `labels`, one program for all its modules.

mod bev;
mod vector_map;
mod voxels;
