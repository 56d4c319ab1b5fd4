//! People: what they look like, how they are built, and how they move.
//!
//! A [`Appearance`] follows from a model of the catalogue and a variant, a [`Figure`] from the look and the
//! stature: the lengths of its bones and a closed mesh for each. [`Figure::walking`] says where the bones are
//! of somebody who stands, walks or runs; [`Figure::seated`] of somebody who sits on or in something. A pram
//! or a dog on a lead is part of its walker. The box about a [`Walker`] follows its pose.

mod appearance;
mod body;
mod dog;
mod figure;
mod gait;
mod joints;
mod palette;
mod pram;
mod reach;
mod sitting;
mod walk;
mod walker;

pub use appearance::{APPEARANCES, Appearance, Beard, Bottom, Build, Carried, Hair, Hat, Shoe, Stance, Top};
pub use figure::{BONES, Bone, Bones, Figure, Measures, Side};
pub use joints::{about_y, about_z};
pub use reach::Seat;
pub use walker::Walker;

#[cfg(test)]
mod tests;
