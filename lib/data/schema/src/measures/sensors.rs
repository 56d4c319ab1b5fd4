//! What `render-sensors` counts.

/// Lidar points. Class: sensor name. Rows carry the agent, and exist even when nothing was hit.
pub const LIDAR_POINTS: &str = "lidar_points";
/// Radar points. Class: sensor name. Rows carry the agent, and exist even when nothing was hit.
pub const RADAR_POINTS: &str = "radar_points";
/// Readings of lidars and radars. Class: sensor name. Rows carry the agent.
pub const SWEEPS: &str = "sweeps";
/// Images. Class: kind (`RGB`, `SEG`, ...).
pub const IMAGES: &str = "images";
/// Bytes of the finished tables of sensors. Class: sensor name, or kind of image, or the name of another
/// table (`visible`). Rows carry the agent.
pub const SENSOR_BYTES: &str = "sensor_bytes";
