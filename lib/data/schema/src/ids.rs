//! Numbers of objects.

/// Number of one object in a scene: 1..=65535, never reused, static things too. 0 is "no object".
pub type ObjectId = u16;
