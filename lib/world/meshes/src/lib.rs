#![doc = include_str!("../README.md")]

pub mod actors;
pub mod people;
pub mod solids;
