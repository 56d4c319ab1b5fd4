//! Packs as people make them, whole and damaged.

mod example;
mod faults;
mod gltf;
mod person;
mod reading;
mod rigs;
mod walking;
