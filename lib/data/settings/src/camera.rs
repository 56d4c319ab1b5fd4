//! Cameras.

use schema::{ImageKind, ImageSet};

use crate::config_key::YamlName;
use crate::key::{Name, settings};
use crate::mount::Mount;
use crate::optics::Optics;
use crate::pictures::Pictures;
use crate::reader::Section;

settings! {
    /// What all cameras of a rig share, besides the size of their pictures.
    pub struct CameraSettings {
        /// Aperture of the RGB images.
        f_stop: f64 = 1.8, within(0.5..=64.0), yaml_in("rgb_camera_properties", "fstop");
        /// Share of the light that RGB images lose in their corners.
        vignetting: f64 = 0.2, within(0.0..=0.9);
        /// How far the colour of the light is taken out of RGB images.
        white_balance: f64 = 0.6, share();
        /// Share of the light beyond white that the lens scatters over RGB images.
        bloom: f64 = 0.03, within(0.0..=0.5);
        /// Noise of RGB images, times that of a usual chip.
        noise: f64 = 1.0, within(0.0..=10.0);
        /// How long the shutter of RGB images is open, until the frame's time, s: what moves is smeared; 0
        /// leaves it sharp.
        exposure_time_s: f64 = 0.0, within(0.0..=0.05);
        /// Width of the opening that blurs RGB images where they are out of focus, mm (brightness follows
        /// `f_stop`); 0 leaves all sharp.
        aperture_mm: f64 = 0.0, within(0.0..=100.0);
        /// Distance at which an `aperture_mm` leaves RGB images sharp, m.
        focus_m: f64 = 20.0, within(0.1..=10_000.0);
        /// Drops on the glass before the lens in RGB images when it rains, times a usual number; 0 keeps it
        /// dry.
        lens_drops: f64 = 0.0, within(0.0..=10.0);
        /// JPEG quality of the RGB images.
        jpeg_quality: u8 = 80, within(1..=100);
        /// Write the boxes of objects in the pictures.
        boxes_2d: bool = false;
        /// Keep flow as 16-bit floats: half the bytes, a 2048th of the value off at most.
        flow_half: bool = false;
        /// Pictures are taken at frames 0, n, 2 n, ...
        every_n_frames: u32 = 1, within(1..=1000);
        /// Which images are written: a flag a kind.
        #[serde(flatten)]
        images: ImageSet = ImageSet::default(), by(images);
    }
}

/// Kinds of images name their flags, here and in SimBEV2X.
fn images(s: &Section<'_>, _: &Name, d: ImageSet) -> ImageSet {
    let mut images = ImageSet::NONE;
    for &kind in ImageKind::ALL {
        let spec = kind.spec();
        images.set(kind, s.flag(spec.flag, d.has(kind), &format!("Write {}.", spec.plural)));
        s.named_there(spec.flag, &[YamlName::Camera(spec.flag)]);
    }
    images
}

settings! {
    /// One camera.
    pub struct CameraSpec {
        /// Camera name, part of the file names: `CAM_FRONT` and so on.
        name: String = "CAM_FRONT".into();
        /// Where it sits (FLU; it looks along the mount's x axis).
        mount: Mount = Mount::default(), flat();
        /// Size and intrinsics of its pictures (1600 x 900, 80 degrees).
        optics: Optics = Pictures::default().optics(), apart();
    }
}
