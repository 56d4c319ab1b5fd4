//! Draws a small street in several weathers: `cargo run -p convoy-sensors --example pictures -- FOLDER`.

#[path = "../tests/sensors/common/mod.rs"]
mod common;

use std::error::Error;
use std::fs::File;
use std::path::PathBuf;

use frames::{Agent, Pose, World, deg};
use schema::tables::Weather;
use settings::{CameraSettings, Mount};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".into()));
    let day = Weather { sun_azimuth_deg: 150.0, sun_altitude_deg: 52.0, ..Weather::default() };
    let weathers = [
        ("noon", Weather { cloudiness: 25.0, ..day }),
        ("overcast", Weather { cloudiness: 95.0, ..day }),
        (
            "rain",
            Weather {
                cloudiness: 95.0,
                precipitation: 80.0,
                wetness: 80.0,
                precipitation_deposits: 70.0,
                fog_density: 5.0,
                ..day
            },
        ),
        (
            "fog",
            Weather { cloudiness: 70.0, fog_density: 60.0, fog_distance_m: 5.0, fog_falloff: 0.5, ..day },
        ),
        ("dusk", Weather { sun_altitude_deg: 4.0, sun_azimuth_deg: 70.0, cloudiness: 35.0, ..day }),
        ("night", Weather { sun_altitude_deg: -30.0, cloudiness: 20.0, ..day }),
    ];
    for (name, weather) in weathers {
        let snapshot = common::street(weather.is_night());
        let pose = Pose::<World, Agent>::from_xyz_rpy([0.0, -5.2, 0.0], [0.0, 0.0, deg(4.0)]);
        let settings = CameraSettings::default();
        let optics = common::optics(1600, 900);
        for (side, yaw) in [("front", 0.0), ("left", 55.0)] {
            let mount = Mount::upright([0.6, 0.0, 1.6], yaw);
            let view = common::camera(mount, optics.clone(), &settings).view(&snapshot.origin, &pose, &pose);
            let picture = common::picture(&snapshot, &view, &weather);
            let file = File::create(folder.join(format!("{name}-{side}.png")))?;
            let mut encoder = png::Encoder::new(file, picture.width, picture.height);
            encoder.set_color(png::ColorType::Rgb);
            encoder.write_header()?.write_image_data(&picture.rgb)?;
        }
    }
    Ok(())
}
