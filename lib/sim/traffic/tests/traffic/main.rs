//! Traffic in motion: drivers, signals, walkers, hazards; the facts that a log states; the report's measures.

mod common;
mod contact;
mod facts;
mod given;
mod hazards;
mod junctions;
mod motion;
mod overlook;
mod report;
mod simulation;
mod sleep;
mod start;
mod trains;
mod walkers;
