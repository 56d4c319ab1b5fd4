//! Road networks: how fast a large one loads, and how fast the nearest lane is found.

use std::path::PathBuf;

use nalgebra::Point3;
use opendrive::{Map, Network, read_bytes};
use random::Stream;

use crate::{Row, best};

/// Places that lanes are looked for at.
const PLACES: u32 = 1_000_000;

/// The bytes of a CARLA map where it is at hand, else of our own town; and its name.
fn file(name: &str) -> (String, Vec<u8>) {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/maps/carla"));
    match std::fs::read(folder.join(name)) {
        Ok(bytes) => (name.to_owned(), bytes),
        Err(_) => {
            let network: Network =
                town::generate(&town::named("convoy/demo").expect("is named")).expect("is generated");
            (format!("convoy/demo, for want of {name}"), opendrive::write(&network).into_bytes())
        }
    }
}

/// Both rows, on one core.
pub(crate) fn measure(rows: &mut Vec<Row>) {
    let load = |bytes: &[u8]| Map::new(read_bytes(bytes).expect("is a map"));
    let (name, bytes) = file("Town11.xodr.gz");
    rows.push(Row { part: format!("load {name}"), taken: best(3, || load(&bytes)), budget_s: 3.0 });
    let (name, bytes) = file("Town03.xodr");
    let map = load(&bytes);
    let places = places(&map);
    let nearest =
        || places.iter().filter_map(|p| map.nearest_driving_lane(*p)).map(|h| h.distance_m).sum::<f64>();
    rows.push(Row {
        part: format!("nearest lane of {PLACES} places on {name}"),
        taken: best(3, nearest),
        budget_s: 2.0,
    });
}

/// Half of them on the lanes or up to 10 m beside them, half anywhere over the network.
fn places(map: &Map) -> Vec<Point3<f64>> {
    let mut draw = Stream::new(1, 0, "bench/places", 0);
    let far = Point3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY);
    let ends = map.lanes().iter().filter_map(|l| Some(map.lane_point(l.id, l.s_start, 0.0)?.position));
    let (low, high) = ends.fold((far, -far), |(low, high), p| (low.inf(&p), high.sup(&p)));
    let size = high - low;
    (0..PLACES)
        .map(|i| {
            let [a, b, c] = [draw.unit(), draw.unit(), draw.unit()];
            let lane = &map.lanes()[(a * map.lanes().len() as f64) as usize % map.lanes().len()];
            let beside = map.lane_point(lane.id, lane.s_start + b * lane.s_length(), 20.0 * c - 10.0);
            match beside {
                Some(place) if i % 2 == 0 => place.position,
                _ => Point3::new(low.x + a * size.x, low.y + b * size.y, low.z + c * size.z),
            }
        })
        .collect()
}
