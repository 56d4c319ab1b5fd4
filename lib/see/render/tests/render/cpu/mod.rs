//! The rasteriser and the ray tracer against closed forms, brute force and each other.
#![allow(clippy::unwrap_used, reason = "tests may stop")]

mod common;
mod raster;
mod rays;
mod seam;
