//! Worlds of maps and actors, looked at triangle by triangle.

mod common;
mod footprint;
mod ground;
mod lean;
mod town;
