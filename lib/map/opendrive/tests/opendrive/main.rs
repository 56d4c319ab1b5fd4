//! Reading, writing and asking: against closed forms, made-up networks, real maps and broken files.

mod any;
mod any_network;
mod common;
mod coverage;
mod direct;
mod elements;
mod every_file;
mod faults;
mod generated;
mod hand_made;
mod queries;
mod real_maps;
mod round_trip;
mod structure;
