//! Drivers, signals and walkers on rapier3d.
