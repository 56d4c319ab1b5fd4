//! Colour pictures of a built-in town, to look at:
//! `cargo run -p convoy-tests --example streets -- FOLDER [WEATHER [TOWN [X Y]]]`.

use device::{Choice, Device};
use std::error::Error;
use std::fs::File;
use std::path::PathBuf;

use frames::{Agent, Pose, World, deg};
use land::tiles::{Surroundings, TileMaker};
use opendrive::Map;
use render::{CameraQuery, Renderer};
use schema::tables::{FrameRow, Weather};
use sensors::Camera;
use settings::{CameraSettings, CameraSpec, Mount, Optics, SceneryRules};
use shading::{FrameWeather, Shot};
use world::{Light, Moment, OwnModels, SceneWorld};

/// Name, height over the road, sideways from the middle of the lane, pitch downwards, yaw to the left, field
/// of view, in degrees and metres.
const VIEWS: [(&str, [f64; 5]); 6] = [
    ("ahead", [1.6, 0.0, 2.0, 0.0, 80.0]),
    ("moved", [1.6, 0.03, 2.0, 0.0, 80.0]),
    ("left", [1.6, 0.0, -8.0, 65.0, 80.0]),
    ("right", [1.6, 0.0, 6.0, -40.0, 80.0]),
    ("kerb", [1.6, -2.0, 30.0, -30.0, 60.0]),
    ("above", [14.0, 2.0, 28.0, 20.0, 90.0]),
];

fn weathers() -> [(&'static str, Weather); 4] {
    let day =
        Weather { sun_azimuth_deg: 150.0, sun_altitude_deg: 42.0, cloudiness: 25.0, ..Weather::default() };
    let rain = Weather {
        cloudiness: 95.0,
        precipitation: 60.0,
        wetness: 80.0,
        precipitation_deposits: 60.0,
        fog_density: 4.0,
        ..day
    };
    let night = Weather { sun_altitude_deg: -30.0, cloudiness: 20.0, ..day };
    [("day", day), ("overcast", Weather { cloudiness: 95.0, ..day }), ("rain", rain), ("night", night)]
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = PathBuf::from(arguments.first().map_or(".", String::as_str));
    let town = arguments.get(2).map_or("convoy/demo", String::as_str);
    let map = Map::new(town::generate(&town::named(town).ok_or("there is no such town")?)?);
    let number = |k: usize| arguments.get(k).and_then(|v| v.parse::<f64>().ok()).unwrap_or_default();
    let near = nalgebra::Point3::new(number(3), number(4), 0.0);
    let hit = map.nearest_driving_lane(near).ok_or("there is no lane")?;
    let here = map.lane_point(hit.lane, hit.s, 0.0).ok_or("the lane has no such point")?;
    let centre: [f64; 3] = here.position.coords.into();
    let rules = SceneryRules::default();
    let Surroundings { actors, ground } =
        TileMaker::new(&map, &rules, catalogue::Catalogue::built_in()).around(&[centre], 300.0, 1)?;
    let world = SceneWorld::with_models(&actors, ground, &OwnModels::new(), Light::AmbientOcclusion)?;
    let name = std::env::var("CONVOY_DEVICE").unwrap_or_default();
    let mut renderer = Device::open(&Choice::from(&*name), None)?.renderer();
    renderer.prepare(&world.meshes())?;
    for (name, weather) in weathers() {
        if arguments.get(1).is_some_and(|wanted| wanted != "all" && wanted != name) {
            continue;
        }
        let night = weather.is_night();
        let frame = FrameRow {
            street_lamps: night,
            building_lights: night,
            sun_altitude_deg: weather.sun_altitude_deg,
            ..FrameRow::default()
        };
        let moment = Moment { states: &[], previous: &[], signals: &[], frame: &frame };
        let snapshot = world.snapshot(&moment, centre, 400.0);
        let scene = renderer.place(&snapshot)?;
        let painter = renderer.painter(None);
        let when = FrameWeather { frame: 0, time_s: 0.0, weather, is_steady: false };
        for (view, [height_m, aside_m, down_deg, yaw_deg, fov_deg]) in VIEWS {
            let (sin, cos) = frames::math::sin_cos(here.heading_rad);
            let [x, y, z] = centre;
            let place = [x - sin * aside_m, y + cos * aside_m, z + height_m];
            let yaw = here.heading_rad + deg(yaw_deg);
            let pose = Pose::<World, Agent>::from_xyz_rpy(place, [0.0, deg(down_deg), yaw]);
            let mount = Mount::upright([0.0; 3], 0.0);
            let spec =
                CameraSpec { name: "CAM".into(), mount, optics: Optics::pinhole(1600, 900, deg(fov_deg)) };
            let view_of =
                Camera::new(&spec, &CameraSettings::default())?.view(&snapshot.origin, &pose, &pose);
            let seen = scene.render(&[CameraQuery::of(view_of.pinhole())])?;
            let place = snapshot.origin.local_from_world(centre);
            let shot = Shot { view: &view_of, seen: &seen[0] };
            let picture = painter.paint(&*scene, &when, place, &[shot])?.remove(0);
            let file = File::create(folder.join(format!("{name}-{view}.png")))?;
            let mut encoder = png::Encoder::new(file, picture.width, picture.height);
            encoder.set_color(png::ColorType::Rgb);
            encoder.write_header()?.write_image_data(&picture.rgb)?;
        }
    }
    Ok(())
}
