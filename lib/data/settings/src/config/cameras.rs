//! The keys of cameras: size, intrinsics, lens, images.

use crate::{CameraSettings, CameraSpec, Lens, Optics};
use frames::deg;
use schema::{ImageKind, ImageSet};

use super::parts::{every_n_frames, mount, names};
use super::table_names::TableNames;
use crate::reader::Section;

/// Size and width of view, where no camera says otherwise.
pub(crate) struct Pictures {
    width: u32,
    height: u32,
    fov_deg: f64,
}

/// The published ones.
pub(crate) const PICTURES: Pictures = Pictures { width: 1600, height: 900, fov_deg: 80.0 };

/// Size and width of view of all cameras.
pub(crate) fn pictures(s: &Section<'_>, d: &Pictures) -> Pictures {
    Pictures {
        width: s.integer("width", d.width.into(), 16, 8192, "image width, pixels") as u32,
        height: s.integer("height", d.height.into(), 16, 8192, "image height, pixels") as u32,
        fov_deg: s.number("fov_deg", d.fov_deg, 1.0, 170.0, "horizontal field of view, degrees"),
    }
}

/// The same, intrinsics and lens of one camera; what it does not say is as in `shared`.
fn optics(s: &Section<'_>, shared: &Pictures) -> Optics {
    let absent = "that of camera";
    let side = |key, doc| s.optional_integer(key, absent, 16, 8192, doc).map(|pixels| pixels as u32);
    let width = side("width", "image width, pixels").unwrap_or(shared.width);
    let height = side("height", "image height, pixels").unwrap_or(shared.height);
    let doc = "horizontal field of view, degrees, if `fx` does not say it; beyond 170 of fisheyes alone";
    let fov_deg = s.optional_number("fov_deg", absent, 1.0, 350.0, doc);
    let lens = lens(s);
    if fov_deg.is_some_and(|fov| fov > 170.0) && !matches!(lens, Lens::Fisheye { .. }) {
        let path = s.path_of("fov_deg");
        s.fault_at("fov_deg", format!("`{path}` is more than 170: that takes `lens = \"fisheye\"`"));
    }
    let fov_rad = deg(fov_deg.unwrap_or(shared.fov_deg));
    let by_angle = Optics::by_angle(width, height, fov_rad, &lens);
    let focal = |key, absent, doc| s.optional_number(key, absent, 1.0, 1e6, doc);
    let fx = focal("fx", "by the field of view", "focal length in columns, pixels");
    let fy = focal("fy", "fx", "focal length in rows, pixels");
    if fx.is_some() && fov_deg.is_some() {
        let problem = format!("`{}` and fx say the same: name one of them", s.path_of("fov_deg"));
        s.fault_at("fov_deg", problem);
    }
    let axis = |key, middle: f64, doc| {
        s.optional_number(key, "the middle", -8192.0, 16_384.0, doc).unwrap_or(middle)
    };
    let fx = fx.unwrap_or(by_angle.fx);
    let optics = Optics {
        fx,
        fy: fy.unwrap_or(fx),
        cx: axis("cx", by_angle.cx, "column of the optical axis; the middle of the first pixel is at 0.5"),
        cy: axis("cy", by_angle.cy, "row of the optical axis"),
        ..by_angle
    };
    if let Some(problem) = optics.problem() {
        s.fault_at_any(&["distortion", "fx", "fov_deg", "lens"], format!("`{}`: {problem}", s.path()));
    }
    optics
}

/// What bends a camera's rays.
fn lens(s: &Section<'_>) -> Lens {
    let doc = "`brown`: radial and tangential distortion; `fisheye`: equidistant, by Kannala and Brandt";
    let options = [
        ("pinhole", Lens::Pinhole),
        ("brown", Lens::Brown { k: [0.0; 3], p: [0.0; 2] }),
        ("fisheye", Lens::Fisheye { k: [0.0; 4] }),
    ];
    let plain = s.choice("lens", &options, 0, doc);
    let doc = "coefficients of the lens as OpenCV orders them: k1, k2, p1, p2, k3 of `brown`, k1 to k4 of `fisheye`";
    let Some(numbers) = s.numbers("distortion", "zeros", doc) else { return plain };
    match (plain, numbers.as_slice()) {
        (Lens::Brown { .. }, &[k1, k2, p1, p2]) => Lens::Brown { k: [k1, k2, 0.0], p: [p1, p2] },
        (Lens::Brown { .. }, &[k1, k2, p1, p2, k3]) => Lens::Brown { k: [k1, k2, k3], p: [p1, p2] },
        (Lens::Fisheye { .. }, &[k1, k2, k3, k4]) => Lens::Fisheye { k: [k1, k2, k3, k4] },
        (_, numbers) => {
            let wanted = match plain {
                Lens::Pinhole => "none: a pinhole bends nothing",
                Lens::Brown { .. } => "k1, k2, p1, p2 and perhaps k3",
                Lens::Fisheye { .. } => "k1, k2, k3, k4",
            };
            let path = s.path_of("distortion");
            s.fault_at("distortion", format!("`{path}` has {} numbers, expected {wanted}", numbers.len()));
            plain
        }
    }
}

/// What all cameras of a rig share, besides.
pub(crate) fn camera(s: &Section<'_>, d: &CameraSettings) -> CameraSettings {
    CameraSettings {
        f_stop: s.number("f_stop", d.f_stop, 0.5, 64.0, "aperture of the RGB images"),
        vignetting: s.number(
            "vignetting",
            d.vignetting,
            0.0,
            0.9,
            "share of the light that RGB images lose in their corners",
        ),
        white_balance: s.number(
            "white_balance",
            d.white_balance,
            0.0,
            1.0,
            "how far the colour of the light is taken out of RGB images",
        ),
        bloom: s.number(
            "bloom",
            d.bloom,
            0.0,
            0.5,
            "share of the light beyond white that the lens scatters over RGB images",
        ),
        noise: s.number("noise", d.noise, 0.0, 10.0, "noise of RGB images, times that of a usual chip"),
        exposure_time_s: s.number(
            "exposure_time_s",
            d.exposure_time_s,
            0.0,
            0.05,
            "how long the shutter of RGB images is open, until the frame's time, seconds: what moves is smeared; 0 leaves it sharp",
        ),
        aperture_mm: s.number(
            "aperture_mm",
            d.aperture_mm,
            0.0,
            100.0,
            "width of the opening that blurs RGB images where they are out of focus, millimetres (brightness follows `f_stop`); 0 leaves all sharp",
        ),
        focus_m: s.number("focus_m", d.focus_m, 0.1, 10_000.0, "distance at which an `aperture_mm` leaves RGB images sharp, metres"),
        lens_drops: s.number(
            "lens_drops",
            d.lens_drops,
            0.0,
            10.0,
            "drops on the glass before the lens in RGB images when it rains, times a usual number; 0 keeps it dry",
        ),
        jpeg_quality: s.integer(
            "jpeg_quality",
            d.jpeg_quality.into(),
            1,
            100,
            "JPEG quality of the RGB images",
        ) as u8,
        boxes_2d: s.flag("boxes_2d", d.boxes_2d, "write the boxes of objects in the pictures"),
        flow_half: s.flag(
            "flow_half",
            d.flow_half,
            "keep flow as 16-bit floats: half the bytes, a 2048th of the value off at most",
        ),
        every_n_frames: every_n_frames(s, "pictures are taken"),
        images: images(s, d.images),
    }
}

fn images(s: &Section<'_>, d: ImageSet) -> ImageSet {
    let mut images = ImageSet::NONE;
    for &kind in ImageKind::ALL {
        let spec = kind.spec();
        images.set(kind, s.flag(spec.flag, d.has(kind), &format!("write {}", spec.plural)));
    }
    images
}

/// The cameras of a rig.
pub(crate) fn cameras(
    s: &Section<'_>,
    (d, shared): (&[CameraSpec], &Pictures),
    tables: &mut TableNames,
) -> Vec<CameraSpec> {
    let read = |item: &Section<'_>| CameraSpec {
        name: item.text("name", "CAM_FRONT", "camera name, part of the file names"),
        mount: mount(item, &d[0].mount),
        optics: optics(item, shared),
    };
    let sections =
        s.sections("cameras", &names(d.iter().map(|c| &c.name)), "the cameras; replaces the default list");
    read(&s.describe_item("cameras"));
    let tables_of = |name: &str| ImageKind::ALL.iter().map(|kind| kind.table(name)).collect();
    match sections {
        None => {
            d.iter().for_each(|camera| tables.take(s, &camera.name, tables_of(&camera.name)));
            let optics = Optics::pinhole(shared.width, shared.height, deg(shared.fov_deg));
            d.iter().map(|camera| CameraSpec { optics: optics.clone(), ..camera.clone() }).collect()
        }
        Some(list) => list
            .iter()
            .map(|item| {
                let camera = read(item);
                tables.take(item, &camera.name, tables_of(&camera.name));
                camera
            })
            .collect(),
    }
}
