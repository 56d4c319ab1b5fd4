//! Keys that many things have.

use crate::Mount;
use frames::{deg, to_deg};

use crate::reader::Section;

/// At which frames something is made.
pub(crate) fn every_n_frames(section: &Section<'_>, what: &str) -> u32 {
    section.integer("every_n_frames", 1, 1, 1000, &format!("{what} at frames 0, n, 2 n, ...")) as u32
}

/// Where a sensor sits on its agent.
pub(crate) fn mount(s: &Section<'_>, d: &Mount) -> Mount {
    Mount {
        xyz_m: s.triple("xyz_m", d.xyz_m, "position on the agent: forward, left, up, m"),
        rpy_rad: s
            .triple("rpy_deg", d.rpy_rad.map(to_deg), "roll, pitch (nose down), yaw (left), degrees")
            .map(deg),
    }
}

/// Names, as a default in words.
pub(crate) fn names<'a>(names: impl Iterator<Item = &'a String>) -> String {
    names.map(String::as_str).collect::<Vec<_>>().join(", ")
}
