//! What features of pictures cost: the same six cameras with each of them switched on, or off.

use schema::tables::Weather;
use settings::CameraSettings;

use crate::Taken;

/// One change of what is painted.
pub(crate) struct Variant {
    pub(crate) name: &'static str,
    /// To the camera's settings.
    pub(crate) camera: fn(&mut CameraSettings),
    /// To the weather.
    pub(crate) weather: fn(&mut Weather),
    /// Whether cabins of vehicles are there.
    pub(crate) cabins: bool,
    /// Whether it is known how much of the sky bodies see.
    pub(crate) with_ambient_occlusion: bool,
    /// Whether the sun stands still, so that what it sees of the still world is kept.
    pub(crate) is_steady: bool,
}

/// What painting with a change took.
pub(crate) struct Feature {
    pub(crate) name: &'static str,
    pub(crate) taken: Taken,
}

const PLAIN: Variant = Variant {
    name: "as by default",
    camera: |_| {},
    weather: |_| {},
    cabins: true,
    with_ambient_occlusion: true,
    is_steady: false,
};

/// The first is what the others are held against.
pub(crate) const VARIANTS: [Variant; 13] = [
    PLAIN,
    Variant { name: "a sun that stands still", is_steady: true, ..PLAIN },
    Variant { name: "no noise", camera: |c| c.noise = 0.0, ..PLAIN },
    Variant { name: "no bloom", camera: |c| c.bloom = 0.0, ..PLAIN },
    Variant { name: "no vignette", camera: |c| c.vignetting = 0.0, ..PLAIN },
    Variant { name: "no white balance", camera: |c| c.white_balance = 0.0, ..PLAIN },
    Variant { name: "nothing behind panes", cabins: false, ..PLAIN },
    Variant { name: "no sky's light on bodies", with_ambient_occlusion: false, ..PLAIN },
    Variant { name: "a shutter open for 20 ms", camera: |c| c.exposure_time_s = 0.02, ..PLAIN },
    Variant { name: "an aperture of 8 mm", camera: |c| c.aperture_mm = 8.0, ..PLAIN },
    Variant { name: "wet ground with puddles", weather: wet, ..PLAIN },
    Variant { name: "wet ground and rain", weather: rain, ..PLAIN },
    Variant { name: "fog", weather: |w| w.fog_density = 60.0, ..PLAIN },
];

fn wet(weather: &mut Weather) {
    (weather.wetness, weather.precipitation_deposits) = (80.0, 70.0);
}

fn rain(weather: &mut Weather) {
    wet(weather);
    (weather.precipitation, weather.cloudiness) = (80.0, 95.0);
}
