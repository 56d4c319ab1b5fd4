//! Plans: rules that hold in each of them, shares and means over many.

mod given;
mod hazards;
mod plan;
mod statistics;
mod suspicions;
