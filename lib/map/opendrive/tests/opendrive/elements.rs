//! One of everything, read from a file written by hand.

use opendrive::*;

const FILE: &str = include_str!("../data/everything.xodr");

fn network() -> Network {
    Network::parse(FILE).expect("the file is good")
}

#[test]
fn nothing_is_unknown_and_writing_loses_nothing() {
    let network = network();
    let texts: Vec<String> = network.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(texts, [""; 0]);
    assert!(network.unknown_elements.is_empty(), "{:?}", network.unknown_elements);
    let text = write(&network);
    assert_eq!(Network::parse(&text).expect("our own file"), network);
    // Each attribute of the file is in the written one, but for ids that are only referred to, and user data.
    for value in [
        "CC0-1.0",
        "Do as you like.",
        "pothole.crg",
        "main.crg",
        "square.crg",
        "trafficLight",
        "1010",
        "0.015",
    ] {
        assert!(text.contains(value), "{value}");
    }
}

#[test]
fn roads_carry_what_the_file_says() {
    let network = network();
    let header = &network.header;
    assert_eq!((header.revision, header.kept.len()), ((1, 8), 2));
    assert_eq!(header.kept[0].attribute("spdxid"), Some("CC0-1.0"));
    assert_eq!(header.kept[0].children[0].text, "Do as you like.");
    let road = &network.roads[0];
    assert_eq!(
        road.neighbours[0],
        Neighbour { side: RoadSide::Left, id: "9".to_owned(), direction: NeighbourDirection::Opposite }
    );
    assert_eq!(
        (road.types[0].country.as_str(), road.types[1].speed.map(|s| s.max)),
        ("DE", Some(f64::INFINITY))
    );
    assert_eq!((road.crossfall[1].side, road.crossfall[1].angle_rad.a), (RoadSide::Right, 0.03));
    assert_eq!(road.cross_section_surface.len(), 1);
    assert_eq!(road.kept[0].name, "surface");
    let bridge = &road.bridges[0];
    assert_eq!(
        (bridge.kind.as_str(), bridge.s, bridge.length_m, bridge.validity.len()),
        ("brick", 30.0, 12.0, 1)
    );
    let tunnel = &road.tunnels[0];
    assert_eq!(
        (tunnel.kind, tunnel.lighting, tunnel.daylight),
        (TunnelType::Underpass, Some(0.5), Some(0.25))
    );
    let switch = &network.roads[3].switches[0];
    assert_eq!(
        (switch.main.road.as_str(), switch.main.s, switch.side.direction),
        ("9", 10.0, TrackDirection::Against)
    );
    assert_eq!(switch.partner.as_ref().map(|(_, id)| id.as_str()), Some("w2"));
    let segment = &network.stations[0].platforms[0].segments[0];
    assert_eq!((segment.s_start, segment.s_end, segment.side), (5.0, 35.0, RoadSide::Left));
}

#[test]
fn lanes_carry_what_the_file_says() {
    let network = network();
    let section = &network.roads[0].sections[0];
    let lane = section.lane(1).expect("there");
    assert_eq!((lane.direction, lane.advisory), (TravelDirection::Both, LaneAdvisory::Inner));
    assert!(lane.dynamic_type && lane.dynamic_direction && lane.road_works);
    assert_eq!(lane.materials[0].surface, "asphalt");
    assert_eq!((lane.materials[0].friction, lane.materials[1].roughness), (Some(0.8), None));
    assert_eq!(lane.rules[0].value, "no stopping at any time");
    assert_eq!(lane.kept[0].name, "visibility");
    // Two records of one place hold together; later ones replace them.
    for (user, here, there) in
        [("trucks", false, false), ("Bus", false, false), ("taxi", true, true), ("car", true, false)]
    {
        assert_eq!((lane.admits(user, 24.9), lane.admits(user, 25.0)), (here, there), "{user}");
    }
    assert!(section.lane(-1).expect("there").admits("anybody", 0.0));
    let mark = &lane.marks[0];
    assert_eq!((mark.bold, mark.material.as_str(), mark.sway[0].b), (true, "paint", 0.001));
    assert_eq!((mark.lines[0].rule, mark.lines[1].rule), (LineRule::NoPassing, LineRule::Caution));
    assert_eq!((mark.lines[1].width_m, mark.strokes[1].s_offset), (Some(0.13), 8.0));
    let walk = section.lane(2).expect("there");
    assert!(walk.level);
    assert_eq!((walk.heights[1].inner_m, walk.heights[1].outer_m), (0.1, 0.11));
}

#[test]
fn objects_and_signals_carry_what_the_file_says() {
    let network = network();
    let [bay, crosswalk, fence, tree, ..] = &network.roads[0].objects[..] else { panic!("four objects") };
    assert_eq!(bay.parking.as_ref().map(|p| p.access.as_str()), Some("women"));
    assert_eq!(
        (bay.materials[0].paint, bay.dynamic, bay.valid_length_m),
        (Some(MarkColour::Blue), true, Some(5.0))
    );
    assert_eq!((bay.markings[0].side, bay.markings[0].stop_offset_m), (Some(BoxSide::Left), 0.3));
    // Ids of corners may repeat from outline to outline: that of the marking's own outline is meant.
    let corner = |outline, corner| CornerReference { outline, corner };
    assert_eq!(crosswalk.markings[0].corners, [corner(0, 0), corner(0, 3)]);
    assert_eq!(crosswalk.borders[1].corners, [corner(0, 1), corner(0, 2)]);
    assert_eq!((crosswalk.borders[0].outline, crosswalk.borders[0].complete), (1, true));
    assert_eq!((crosswalk.outlines[0].fill.as_str(), crosswalk.outlines[1].outer), ("paint", false));
    assert_eq!(fence.repeats[1].t_cubic, Some([0.1, 0.0, 0.0]));
    assert_eq!((fence.repeats[1].object_length_m, fence.repeats[1].detached), (Some([0.1, 0.4]), true));
    assert_eq!(fence.repeats[2].t_m, [6.0, 6.0]);
    assert!(tree.skeleton[0].vertices[0].on_ground && !tree.skeleton[0].vertices[1].on_ground);
    assert_eq!(network.roads[0].object_references[0].validity, [LaneValidity { from: 1, to: 1 }]);
    let [light, sign] = &network.roads[0].signals[..] else { panic!("two signals") };
    assert_eq!((light.other_unit.as_str(), light.unit, light.text.as_str()), ("t", None, "go\non"));
    assert_eq!((light.dependencies[0].id.as_str(), light.references[0].id.as_str()), ("s2", "x1"));
    assert!(
        matches!(&light.position, Some(SignalPosition::Road { road, t, .. }) if road == "2" && *t == 3.0)
    );
    assert!(matches!(sign.position, Some(SignalPosition::Inertial { xyz_m: [94.0, 7.0, 4.0], .. })));
    assert_eq!((light.kept[0].name.as_str(), sign.kept[0].name.as_str()), ("semantics", "staticBoard"));
    let controller = &network.controllers[0];
    assert_eq!(controller.signals, ["s1", "s2"]);
    assert_eq!(controller.control_types.get("s1").map(String::as_str), Some("0"));
}

#[test]
fn junctions_carry_what_the_file_says() {
    let network = network();
    let [yard, crossing, square, slip] = &network.junctions[..] else { panic!("four junctions") };
    let main = yard.main_road.as_ref().expect("there");
    assert_eq!(
        (main.road.as_str(), main.s_start, main.s_end, main.orientation),
        ("1", 110.0, 130.0, Orientation::Along)
    );
    let by_nothing = &yard.connections[1];
    assert_eq!((by_nothing.kind, by_nothing.incoming_road.as_str()), (ConnectionKind::Virtual, ""));
    assert!(matches!(
        by_nothing.predecessor,
        Some(RoadLink::Along { s: 110.0, direction: TrackDirection::Against, .. })
    ));
    assert_eq!((yard.cross_paths[0].start.from, yard.cross_paths[0].end.from), (-2, 2));
    assert_eq!(yard.priorities[0].high.as_deref(), Some("1"));
    assert_eq!((crossing.crossing[1].road.as_str(), crossing.crossing[1].s_end), ("9", 44.0));
    assert_eq!(square.boundary.len(), 4);
    assert_eq!(
        square.boundary[0],
        BoundarySegment::Lane {
            road: "1".to_owned(),
            lane: -2,
            from: SegmentEnd::Begin,
            to: SegmentEnd::At(42.5),
        }
    );
    let grid = square.elevation_grid.as_ref().expect("there");
    assert_eq!(
        (grid.spacing_m, grid.rows[0].right_m.as_slice(), grid.rows[1].centre_m),
        (4.0, &[5.0, 4.75, 4.5][..], 5.75)
    );
    assert_eq!(slip.connections[0].lane_links[0].overlap_m, Some(12.5));
    assert_eq!(network.junction_groups[0].junctions, ["v", "d"]);
}
