//! Size and lens of pictures as a configuration writes them.

use frames::deg;
use schema::lens::Lens;

use crate::key::{Settings, choice, settings};
use crate::optics::Optics;
use crate::reader::Section;

settings! {
    /// Size and width of view of all cameras of a rig, where a camera does not say otherwise.
    pub(crate) struct Pictures {
        /// Image width, pixels.
        width: u32 = 1600, within(16..=8192), yaml("camera_width");
        /// Image height, pixels.
        height: u32 = 900, within(16..=8192), yaml("camera_height");
        /// Horizontal field of view, degrees.
        fov_deg: f64 = 80.0, within(1.0..=170.0), yaml("camera_fov");
    }
}

impl Pictures {
    /// The same as optics of a pinhole.
    pub(crate) fn optics(&self) -> Optics {
        Optics::pinhole(self.width, self.height, deg(self.fov_deg))
    }
}

choice! {
    /// What bends rays.
    pub(crate) enum LensWord {
        /// Nothing.
        #[default]
        Pinhole = "pinhole",
        /// Brown's formula.
        Brown = "brown",
        /// Kannala and Brandt's formula.
        Fisheye = "fisheye",
    }
}

settings! {
    /// Size, intrinsics and lens of one camera.
    pub(crate) struct CameraOptics {
        /// Image width, pixels.
        width: Option<u32> = None, within(16..=8192), or("that of camera");
        /// Image height, pixels.
        height: Option<u32> = None, within(16..=8192), or("that of camera");
        /// Horizontal field of view, degrees, if `fx` does not say it; beyond 170 of fisheyes alone.
        fov_deg: Option<f64> = None, within(1.0..=350.0), or("that of camera");
        /// `brown`: radial and tangential distortion; `fisheye`: equidistant, by Kannala and Brandt.
        lens: LensWord = LensWord::Pinhole, choice();
        /// Coefficients of the lens as OpenCV orders them: k1, k2, p1, p2, k3 of `brown`, k1 to k4 of
        /// `fisheye`.
        distortion: Option<Vec<f64>> = None, or("zeros");
        /// Focal length in columns, pixels.
        fx: Option<f64> = None, within(1.0..=1e6), or("by the field of view");
        /// Focal length in rows, pixels.
        fy: Option<f64> = None, within(1.0..=1e6), or("fx");
        /// Column of the optical axis; the middle of the first pixel is at 0.5.
        cx: Option<f64> = None, within(-8192.0..=16_384.0), or("the middle");
        /// Row of the optical axis.
        cy: Option<f64> = None, within(-8192.0..=16_384.0), or("the middle");
    }
    rule consistent;
}

fn consistent(s: &Section<'_>, read: &CameraOptics) {
    if read.fov_deg.is_some_and(|fov| fov > 170.0) && read.lens != LensWord::Fisheye {
        let path = s.path_of("fov_deg");
        s.fault_at("fov_deg", format!("`{path}` is more than 170: that takes `lens = \"fisheye\"`"));
    }
    if read.fx.is_some() && read.fov_deg.is_some() {
        let problem = format!("`{}` and fx say the same: name one of them", s.path_of("fov_deg"));
        s.fault_at("fov_deg", problem);
    }
}

/// Optics of one camera; what it does not say is as in `shared`.
pub(crate) fn optics(s: &Section<'_>, shared: &Pictures) -> Optics {
    let read = CameraOptics::read(s, &CameraOptics::default());
    let lens = lens(s, read.lens, read.distortion.as_deref());
    let (width, height) = (read.width.unwrap_or(shared.width), read.height.unwrap_or(shared.height));
    let fov_rad = deg(read.fov_deg.unwrap_or(shared.fov_deg));
    let by_angle = Optics::by_angle(width, height, fov_rad, &lens);
    let fx = read.fx.unwrap_or(by_angle.fx);
    let optics = Optics {
        fx,
        fy: read.fy.unwrap_or(fx),
        cx: read.cx.unwrap_or(by_angle.cx),
        cy: read.cy.unwrap_or(by_angle.cy),
        ..by_angle
    };
    if let Some(problem) = optics.problem() {
        s.fault_at_any(&["distortion", "fx", "fov_deg", "lens"], format!("`{}`: {problem}", s.path()));
    }
    optics
}

/// A lens with its coefficients.
fn lens(s: &Section<'_>, word: LensWord, distortion: Option<&[f64]>) -> Lens {
    let plain = match word {
        LensWord::Pinhole => Lens::Pinhole,
        LensWord::Brown => Lens::Brown { k: [0.0; 3], p: [0.0; 2] },
        LensWord::Fisheye => Lens::Fisheye { k: [0.0; 4] },
    };
    let Some(numbers) = distortion else { return plain };
    match (word, numbers) {
        (LensWord::Brown, &[k1, k2, p1, p2]) => Lens::Brown { k: [k1, k2, 0.0], p: [p1, p2] },
        (LensWord::Brown, &[k1, k2, p1, p2, k3]) => Lens::Brown { k: [k1, k2, k3], p: [p1, p2] },
        (LensWord::Fisheye, &[k1, k2, k3, k4]) => Lens::Fisheye { k: [k1, k2, k3, k4] },
        _ => {
            let wanted = match word {
                LensWord::Pinhole => "none: a pinhole bends nothing",
                LensWord::Brown => "k1, k2, p1, p2 and perhaps k3",
                LensWord::Fisheye => "k1, k2, k3, k4",
            };
            let path = s.path_of("distortion");
            s.fault_at("distortion", format!("`{path}` has {} numbers, expected {wanted}", numbers.len()));
            plain
        }
    }
}
