//! The roads as drivers see them: lanes, how they lead on, meet and lie beside each other, and their lights.

pub(crate) mod centreline;
pub(crate) mod kerbside;
mod links;
pub(crate) mod net;
pub(crate) mod sides;
pub(crate) mod signals;
