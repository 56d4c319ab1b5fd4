//! Sensor readings: one row a frame. The file's metadata holds the sensor's pose and intrinsics as JSON.

use crate::table::{Blob, Halves};
use crate::{framed, table};

/// Table of the GNSS receiver.
pub const GNSS_TABLE: &str = "GNSS";
/// Table of the IMU.
pub const IMU_TABLE: &str = "IMU";
/// Table of [`VisibleRow`].
pub const VISIBLE_TABLE: &str = "visible";
/// Table of [`Box2dRow`].
pub const BOXES_2D_TABLE: &str = "boxes_2d";

table! {
    /// Encoded images of one camera, of one of the kinds listed below; PNG with 8-bit red, green and blue.
    CameraRow in "sensors/{agent}/{kind}-{camera}" by "render-sensors" {
        /// Frame number.
        frame: u32,
        /// Time since frame 0, s.
        time_s: f64,
        /// The encoded image.
        image: Blob,
    }
}

table! {
    /// Optical flow of one camera. With `camera.flow_half` `dx` and `dy` are lists of f16.
    FlowRow in "sensors/{agent}/FLW-{camera}" by "render-sensors" {
        /// Frame number.
        frame: u32,
        /// Time since frame 0, s.
        time_s: f64,
        /// Image width, pixels.
        width: u32,
        /// Image height, pixels.
        height: u32,
        /// Motion to the right since the last frame, row by row; the image is 2 units wide. A multiple of
        /// 2^-17.
        dx: Vec<f32>,
        /// Motion up since the last frame, row by row; the image is 2 units high. A multiple of 2^-17.
        dy: Vec<f32>,
    }
}

table! {
    /// The same as half floats: what is read of it are [`FlowRow`]s, too.
    HalfFlowRow in "sensors/{agent}/FLW-{camera}" by "render-sensors" {
        /// Frame number.
        frame: u32,
        /// Time since frame 0, s.
        time_s: f64,
        /// Image width, pixels.
        width: u32,
        /// Image height, pixels.
        height: u32,
        /// As in [`FlowRow`], to 11 binary digits.
        dx: Halves,
        /// As in [`FlowRow`], to 11 binary digits.
        dy: Halves,
    }
}

table! {
    /// Sweeps of one lidar, highest beam first, each beam by azimuth. Own-body returns are cut out.
    LidarRow in "sensors/{agent}/LIDAR" by "render-sensors" {
        /// Frame number.
        frame: u32,
        /// Time since frame 0, s.
        time_s: f64,
        /// Forward, m, sensor frame.
        x: Vec<f32>,
        /// Left, m.
        y: Vec<f32>,
        /// Up, m.
        z: Vec<f32>,
        /// Returned intensity, 0 to 1.
        intensity: Vec<f32>,
        /// Beam number, 0 is the highest.
        ring: Vec<u16>,
        /// Seconds after the frame's time at which the ray was fired: 0, or with `lidar.rolling` between
        /// minus a frame period and 0.
        time_offset_s: Vec<f32>,
        /// Cosine of the angle between ray and surface normal, 0 to 1.
        cos_angle: Vec<f32>,
        /// Object id of what was hit.
        id: Vec<u16>,
        /// Semantic tag of what was hit.
        tag: Vec<u8>,
    }
}

table! {
    /// Sweeps of one semantic lidar: no loss, no noise.
    SemanticLidarRow in "sensors/{agent}/SEG-LIDAR" by "render-sensors" {
        /// Frame number.
        frame: u32,
        /// Time since frame 0, s.
        time_s: f64,
        /// Forward, m, sensor frame.
        x: Vec<f32>,
        /// Left, m.
        y: Vec<f32>,
        /// Up, m.
        z: Vec<f32>,
        /// Cosine of the angle between ray and surface normal, 0 to 1.
        cos_angle: Vec<f32>,
        /// Returned intensity, 0 to 1, by the lidar's attenuation.
        intensity: Vec<f32>,
        /// Beam number, 0 is the highest.
        ring: Vec<u16>,
        /// As in `LIDAR`.
        time_offset_s: Vec<f32>,
        /// Object id of what was hit.
        id: Vec<u16>,
        /// Semantic tag of what was hit.
        tag: Vec<u8>,
    }
}

table! {
    /// Further columns of the tables of lidars and semantic lidars with `beam_rays` above 1, `weather` or
    /// `glass`; of others every return is the only one of its beam, from a surface. Returns of a beam stand
    /// together, the nearest first.
    LidarReturnsRow in "sensors/{agent}/{lidar}" by "render-sensors" {
        /// Number of the return among those of its beam, from 1.
        return_number: Vec<u8>,
        /// Returns of its beam.
        return_count: Vec<u8>,
        /// What sent the light back: 0 a surface, 1 fog, 2 a drop of rain, 3 a surface behind a pane or an
        /// open door. Fog and rain have object id, tag and `cos_angle` 0.
        return_kind: Vec<u8>,
    }
}

table! {
    /// Returns of one radar.
    RadarRow in "sensors/{agent}/RAD_*" by "render-sensors" {
        /// Frame number.
        frame: u32,
        /// Time since frame 0, s.
        time_s: f64,
        /// Distance, m.
        depth: Vec<f32>,
        /// Angle above the sensor's horizon, rad.
        altitude: Vec<f32>,
        /// Angle to the left of the sensor's axis, rad.
        azimuth: Vec<f32>,
        /// Radial velocity of the body hit relative to the sensor, m/s, positive receding; with
        /// `radar.micro_motion` of the surface hit: of turning wheels and swinging limbs, too.
        velocity: Vec<f32>,
        /// Cross-section of the patch that the ray stands for, dB of 1 m2; those of an object's returns add
        /// up (as m2) to its own.
        rcs_dbsm: Vec<f32>,
        /// Signal to noise, dB.
        snr_db: Vec<f32>,
        /// Object id of what was hit.
        id: Vec<u16>,
        /// Semantic tag of what was hit.
        tag: Vec<u8>,
    }
}

table! {
    /// Fixes of the GNSS receiver, noise included: spherical Mercator about the map's origin.
    GnssRow in "sensors/{agent}/GNSS" by "render-sensors" {
        /// Frame number.
        frame: u32,
        /// Time since frame 0, s.
        time_s: f64,
        /// Latitude, degrees.
        latitude_deg: f64,
        /// Longitude, degrees.
        longitude_deg: f64,
        /// Altitude, m.
        altitude_m: f64,
    }
}

table! {
    /// Readings of the IMU, noise included, in its body frame (FLU).
    ImuRow in "sensors/{agent}/IMU" by "render-sensors" {
        /// Frame number.
        frame: u32,
        /// Time since frame 0, s.
        time_s: f64,
        /// Specific force x, y, z, m/s2 (at rest z is +9.81).
        acceleration_mps2: [f64; 3],
        /// Angular velocity about x, y, z, rad/s.
        gyroscope_radps: [f64; 3],
        /// Heading, rad clockwise from north (+y of the world), 0 to 2 pi.
        compass_rad: f64,
    }
}

table! {
    /// Objects in an agent's instance images, all cameras together: one row per frame, object and tag.
    VisibleRow in "sensors/{agent}/visible" by "render-sensors" {
        /// Frame number.
        frame: u32,
        /// Object id.
        id: u16,
        /// Semantic tag of a part of it (a traffic light's pole is no traffic light).
        tag: u8,
        /// Pixels of the object with this tag.
        pixels: u32,
    }
}

table! {
    /// Boxes in the pictures: one row per frame, camera and object with a detection class that the camera
    /// shows. A box is left, top, right, bottom in pixels from the picture's corner; pixel (0, 0) reaches
    /// from 0 to 1. Parts of other tags (the pole of a traffic light) are not in it.
    Box2dRow in "sensors/{agent}/boxes_2d" by "render-sensors" {
        /// Frame number.
        frame: u32,
        /// Name of the camera.
        camera: String,
        /// Object id.
        id: u16,
        /// Detection class.
        class: String,
        /// Pixels that show it.
        pixels: u32,
        /// Box around these pixels.
        visible_px: [f32; 4],
        /// Box around all of the object that is before the camera and that its lens may show, hidden or
        /// outside of the picture or not; no farther outside than the picture is wide and high.
        amodal_px: [f32; 4],
        /// Share of its pixels in the picture that others hide, 0 to 1.
        occlusion: f32,
        /// Share of the amodal box that lies outside of the picture, 0 to 1.
        truncation: f32,
    }
}

framed!(
    Box2dRow,
    CameraRow,
    FlowRow,
    HalfFlowRow,
    LidarRow,
    SemanticLidarRow,
    RadarRow,
    GnssRow,
    ImuRow,
    VisibleRow
);
