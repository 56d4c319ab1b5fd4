//! Pictures of small networks, looked at pixel by pixel: colours stand where the network says.

use mapview::{Picture, ViewOptions, Window, draw};
use opendrive::{
    Bridge, ContactPoint, Cubic, Junction, Lane, LaneSection, LaneType, Map, MarkColour, MarkType, Network,
    Object, Outline, Road, RoadMark, RoadType, Tunnel,
};
use testkit::{both_ways, lane, road_link};

const GROUND: [u8; 3] = [226, 234, 210];
const BUILT_UP: [u8; 3] = [240, 235, 224];
const ASPHALT: [u8; 3] = [118, 118, 124];
const JUNCTION: [u8; 3] = [126, 126, 131];
const SHOULDER: [u8; 3] = [148, 148, 148];
const SIDEWALK: [u8; 3] = [217, 208, 194];
const TUNNEL: [u8; 3] = [205, 202, 196];
const WATER: [u8; 3] = [168, 207, 229];

/// A straight road with a driving lane of 4 m and a sidewalk of 3 m on each side.
fn road(id: &str, start: [f64; 2], hdg_rad: f64, length_m: f64, z_m: f64) -> Road {
    let mut section = both_ways(&[(LaneType::Driving, 4.0), (LaneType::Sidewalk, 3.0)]);
    section.centre.marks = vec![RoadMark {
        mark_type: MarkType::Broken,
        colour: MarkColour::Yellow,
        width_m: Some(0.5),
        ..RoadMark::default()
    }];
    Road { elevation: vec![Cubic::constant(z_m)], ..testkit::road(id, start, hdg_rad, length_m, section) }
}

/// One road east at height 0, and one north over or under it.
fn crossing(z_m: f64) -> Network {
    let roads = vec![
        road("1", [-100.0, 0.0], 0.0, 200.0, 0.0),
        road("2", [0.0, -100.0], std::f64::consts::FRAC_PI_2, 200.0, z_m),
    ];
    Network { roads, ..Network::default() }
}

/// Ten pixels a metre around the origin.
const CLOSE: ViewOptions = ViewOptions {
    size_px: 800.0,
    window: Some(Window { centre_m: [0.0, 0.0], radius_m: 40.0 }),
    title: None,
};
const EDGE_PX: f64 = 14.0;

/// The pixels of a PNG, read by the png crate.
struct Pixels {
    width: usize,
    rgb: Vec<u8>,
}

impl Pixels {
    fn of(picture: &Picture) -> Self {
        let bytes = picture.to_png().expect("encodes");
        let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().expect("is a PNG");
        let mut rgb = vec![0; reader.output_buffer_size().expect("fits")];
        let info = reader.next_frame(&mut rgb).expect("decodes");
        assert_eq!([f64::from(info.width), f64::from(info.height)], picture.size_px().map(f64::ceil));
        Self { width: info.width as usize, rgb }
    }

    /// The colour at a place of the world on a sheet of [`CLOSE`].
    fn at(&self, x_m: f64, y_m: f64) -> [u8; 3] {
        let (column, row) = (EDGE_PX + (x_m + 40.0) * 10.0, EDGE_PX + (40.0 - y_m) * 10.0);
        let i = 3 * (row as usize * self.width + column as usize);
        [self.rgb[i], self.rgb[i + 1], self.rgb[i + 2]]
    }
}

fn close_up(network: Network) -> Pixels {
    Pixels::of(&draw(&Map::new(network), &CLOSE))
}

#[test]
fn surfaces_and_dashes_lie_where_the_network_says() {
    let pixels =
        close_up(Network { roads: vec![road("1", [-100.0, 0.0], 0.0, 200.0, 0.0)], ..Network::default() });
    assert_eq!(pixels.at(10.0, 2.0), ASPHALT);
    assert_eq!(pixels.at(10.0, -3.8), ASPHALT);
    assert_eq!(pixels.at(10.0, 4.2), SIDEWALK);
    assert_eq!(pixels.at(10.0, -6.8), SIDEWALK);
    assert_eq!(pixels.at(10.0, 7.2), BUILT_UP);
    assert_eq!(pixels.at(10.0, 39.0), GROUND);
    // Without a stated rhythm a slow road has 3 m of paint and 6 m of gap from its start on: x = -100 + 9 k.
    for k in 8..14 {
        let dash_m = -100.0 + 9.0 * f64::from(k);
        for (along_m, painted) in [(0.3, true), (2.7, true), (3.3, false), (8.7, false)] {
            let yellow = pixels.at(dash_m + along_m, 0.0);
            assert_eq!(yellow[2] < 100, painted, "{along_m} m after the start of dash {k}: {yellow:?}");
        }
    }
}

#[test]
fn the_higher_road_covers_the_lower_one() {
    // East and north cross at the origin: the upper road's sidewalk is seen on the lower one's lane.
    for (z_m, at_east_lane, at_north_lane) in [(6.0, SIDEWALK, ASPHALT), (-6.0, ASPHALT, SIDEWALK)] {
        let pixels = close_up(crossing(z_m));
        assert_eq!(pixels.at(5.5, 2.0), at_east_lane, "north road at {z_m} m");
        assert_eq!(pixels.at(2.0, 5.5), at_north_lane, "north road at {z_m} m");
    }
    // At the same height it is a plain crossing: lanes over sidewalks.
    let pixels = close_up(crossing(0.3));
    assert_eq!([pixels.at(5.5, 2.0), pixels.at(2.0, 5.5)], [ASPHALT, ASPHALT]);
}

#[test]
fn tunnels_are_hidden_and_bridges_have_edges() {
    let mut network = crossing(-6.0);
    network.roads[1].tunnels = vec![Tunnel { s: 70.0, length_m: 60.0, ..Tunnel::default() }];
    let pixels = close_up(network);
    assert_eq!(pixels.at(2.0, 20.0), TUNNEL, "inside the tunnel there is no asphalt");
    assert_eq!(pixels.at(2.0, 39.0), ASPHALT, "before its mouth there is");
    assert_eq!(pixels.at(2.0, 2.0), ASPHALT, "the road above goes on");

    let mut network =
        Network { roads: vec![road("1", [-100.0, 0.0], 0.0, 200.0, 0.0)], ..Network::default() };
    network.roads[0].bridges = vec![Bridge { s: 80.0, length_m: 40.0, ..Bridge::default() }];
    let pixels = close_up(network);
    let dark = |c: [u8; 3]| c.iter().all(|v| *v < 90);
    assert!(dark(pixels.at(5.0, 7.3)) && dark(pixels.at(5.0, -7.3)), "parapets along the bridge");
    assert!(!dark(pixels.at(35.0, 7.3)), "none where there is no bridge");
}

#[test]
fn water_lies_under_roads() {
    let corner = |u_m: f64, v_m: f64| opendrive::Corner::Local { u_m, v_m, z_m: 0.0, height_m: 0.0 };
    let mut network =
        Network { roads: vec![road("1", [-100.0, 0.0], 0.0, 200.0, 0.0)], ..Network::default() };
    network.roads[0].objects = vec![Object {
        name: "River".into(),
        s: 100.0,
        outlines: vec![Outline {
            closed: true,
            corners: vec![corner(-10.0, -50.0), corner(10.0, -50.0), corner(10.0, 50.0), corner(-10.0, 50.0)],
            ..Outline::default()
        }],
        ..Object::default()
    }];
    let pixels = close_up(network);
    assert_eq!(pixels.at(0.0, 20.0), WATER);
    assert_eq!(pixels.at(0.0, 2.0), ASPHALT);
}

#[test]
fn small_scales_show_roads_as_lines_and_decks_above() {
    let mut network = crossing(6.0);
    network.roads[0].types = vec![RoadType { kind: "motorway".into(), ..RoadType::default() }];
    let options = ViewOptions {
        size_px: 120.0,
        window: Some(Window { centre_m: [0.0; 2], radius_m: 150.0 }),
        title: None,
    };
    let picture = draw(&Map::new(network), &options);
    let svg = picture.to_svg();
    assert!(svg.contains("Motorway") && svg.contains("Street") && svg.contains("Bridge"), "{svg}");
    assert!(!svg.contains("Sidewalk"), "lanes are too fine for this scale");
}

/// A way through a junction, 20 m to the east, with a shoulder of 3 m that goes on from a road and one that
/// is of no road.
fn way() -> Road {
    let mut own = road("2", [0.0, 0.0], 0.0, 20.0, 0.0);
    let shoulder = Lane { predecessors: vec![-2], ..lane(-2, LaneType::Shoulder, 3.0) };
    own.sections = vec![LaneSection {
        left: vec![lane(1, LaneType::Shoulder, 3.0)],
        right: vec![lane(-1, LaneType::Driving, 4.0), shoulder],
        ..LaneSection::default()
    }];
    own.junction = Some("9".into());
    own.predecessor = road_link("1", ContactPoint::End);
    own
}

#[test]
fn mere_paving_looks_like_the_ways_through_a_junction() {
    let junctions = vec![Junction { id: "9".into(), ..Junction::default() }];
    let pixels = close_up(Network { roads: vec![way()], junctions, ..Network::default() });
    assert_eq!(pixels.at(10.0, 1.5), JUNCTION);
    assert_eq!(pixels.at(10.0, -2.0), JUNCTION);
    assert_eq!(pixels.at(10.0, -5.5), SHOULDER);
}

#[test]
fn on_small_scales_ways_through_junctions_are_of_the_kind_of_their_roads() {
    // The way has no sidewalks: by itself it would be one of the country.
    let options = ViewOptions {
        size_px: 120.0,
        window: Some(Window { centre_m: [0.0; 2], radius_m: 150.0 }),
        title: None,
    };
    let sheet =
        |roads: Vec<Road>| draw(&Map::new(Network { roads, ..Network::default() }), &options).to_svg();
    let street = road("1", [-100.0, 0.0], 0.0, 100.0, 0.0);
    assert!(!sheet(vec![street.clone(), way()]).contains("Country road"));
    assert!(sheet(vec![street, Road { predecessor: None, ..way() }]).contains("Country road"));
}

#[test]
fn every_svg_is_well_formed_and_the_same_each_time() {
    let network = town::generate(&town::named("convoy/demo").expect("has a name")).expect("builds");
    let map = Map::new(network);
    let options =
        ViewOptions { title: Some("a <town> & \"more\"\u{1}it's".into()), ..ViewOptions::default() };
    let svg = draw(&map, &options).to_svg();
    let document = roxmltree::Document::parse(&svg).expect("is XML");
    let title = document.descendants().find(|n| n.has_tag_name("title")).and_then(|n| n.text());
    assert_eq!(title, Some("a <town> & \"more\" it's"));
    assert!(svg.len() < 1_000_000);
    assert_eq!(svg, draw(&map, &options).to_svg());
    for path in document.descendants().filter(|n| n.has_tag_name("path")) {
        let data = path.attribute("d").expect("has data");
        assert!(data.bytes().all(|b| b"Mlz -0123456789".contains(&b)), "{data}");
    }
}

#[test]
fn maps_without_roads_and_far_windows_are_empty_sheets() {
    let empty = draw(&Map::new(Network::default()), &ViewOptions::default());
    assert!(empty.to_svg().contains("Road network"));
    let options = ViewOptions { window: Some(Window { centre_m: [1e6, 1e6], radius_m: 50.0 }), ..CLOSE };
    let svg = draw(&Map::new(crossing(0.0)), &options).to_svg();
    assert!(!svg.contains("Sidewalk"));
}
