//! Sensors and pictures of small worlds made by hand.

mod blur;
mod cameras;
mod colour;
mod common;
mod gutters;
mod hostile;
mod inertial;
mod panes;
mod ranging;
mod seam;
mod still;
mod wet;
