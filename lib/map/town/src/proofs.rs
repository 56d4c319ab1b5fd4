//! Small layouts, each a proof of some kinds of nodes, judged by the independent checker.

use opendrive::{LaneType, Map, Network, RoadLink};

use crate::TownError;
use crate::assemble::build;
use crate::check::check;
use crate::layout::{Control, Edge, Layout, Node, NodeId, NodeKind};
use crate::section::{CrossSection, Ending, Median, Pocket, Side};
use crate::terrain::{Channel, Hill, Terrain, Wave};

fn street() -> CrossSection {
    CrossSection::both_ways(Side::town(1, 3.5).with_sidewalk(2.5), 50.0)
}

fn built(layout: &Layout) -> Network {
    let network = match build(layout) {
        Ok(network) => network,
        Err(error) => panic!("{}: {error}", layout.name),
    };
    if let Ok(folder) = std::env::var("PROOFS") {
        std::fs::write(format!("{folder}/{}.xodr", layout.name), opendrive::write(&network))
            .expect("writable");
    }
    check(&layout.name, &network);
    network
}

fn circle(layout: &mut Layout, at_m: [f64; 2]) -> NodeId {
    layout.node(Node::new(at_m, NodeKind::DeadEnd { radius_m: 12.0 }))
}

/// A crossing of streets at these headings (degrees), each with a turning circle at its end.
fn star(name: &str, control: Control, arms: &[(f64, CrossSection)]) -> Layout {
    let mut layout = Layout::new(name, Terrain::flat());
    let middle = layout.node(Node::new([0.0, 0.0], NodeKind::Crossing(control)));
    for (degrees, shape) in arms {
        let (s, c) = frames::math::sin_cos(frames::deg(*degrees));
        let end = circle(&mut layout, [110.0 * c, 110.0 * s]);
        layout.edge(Edge::new(format!("arm {degrees}"), middle, end, *shape));
    }
    layout
}

#[test]
fn crossings_at_any_angle_under_any_control() {
    for (i, control) in
        [Control::Signals, Control::AllStop, Control::MinorStop, Control::MinorYield].into_iter().enumerate()
    {
        let plain = |degrees: &[f64]| -> Vec<(f64, CrossSection)> {
            degrees.iter().map(|d| (*d, street())).collect()
        };
        for (name, arms) in [
            ("four", plain(&[3.0, 88.0, 185.0, 262.0])),
            ("five", plain(&[0.0, 55.0, 130.0, 200.0, 290.0])),
            ("three", plain(&[10.0, 120.0, 230.0])),
            ("tee", plain(&[0.0, 180.0, 250.0])),
            ("acute", plain(&[0.0, 42.0, 180.0])),
        ] {
            built(&star(&format!("{name}-{i}"), control, &arms));
        }
    }
}

#[test]
fn kerbless_and_narrow_roads_meet_streets() {
    let rural = CrossSection::rural(Side::open(1, 3.0, 0.8), 80.0);
    let verge =
        CrossSection::both_ways(Side::town(1, 3.2).with_verge(1.5).with_sidewalk(2.0).with_bike(1.6), 50.0);
    let network = built(&star(
        "mixed",
        Control::MinorStop,
        &[(0.0, rural), (95.0, street()), (180.0, rural), (270.0, verge)],
    ));
    let stops = network.roads.iter().flat_map(|r| &r.signals).filter(|s| s.kind == "206").count();
    assert_eq!(stops, 2, "the faster road has priority");
}

#[test]
fn one_way_streets_meet() {
    let mut layout = Layout::new("one-way", Terrain::flat());
    let one_way = CrossSection {
        left: Side { lanes: 0, ..Side::town(0, 3.5).with_sidewalk(2.5) },
        ..CrossSection::one_way(Side::town(2, 3.5).with_sidewalk(2.5), 0.5, 40.0)
    };
    // A block of four corners, round which the traffic goes.
    let corners = [[0.0, 0.0], [120.0, 0.0], [120.0, 100.0], [0.0, 100.0]];
    let nodes: Vec<NodeId> =
        corners.iter().map(|at| layout.node(Node::new(*at, NodeKind::Crossing(Control::Signals)))).collect();
    for i in 0..4 {
        layout.edge(Edge::new(format!("side {i}"), nodes[i], nodes[(i + 1) % 4], one_way));
        let [x, y] = corners[i];
        let end = circle(&mut layout, [x + 1.2 * (x - 60.0), y + 1.2 * (y - 50.0)]);
        layout.edge(Edge::new(format!("out {i}"), nodes[i], end, street()));
    }
    built(&layout);
}

#[test]
fn roundabouts_of_one_and_two_lanes() {
    let wide =
        CrossSection::both_ways(Side::town(2, 3.3).with_sidewalk(2.5), 50.0).with_median(Median::raised(3.0));
    for (name, lanes, island_m, arms) in [
        ("round-3", 1, 13.0, vec![(0.0, street()), (110.0, street()), (230.0, street())]),
        ("round-4", 1, 15.0, vec![(5.0, street()), (90.0, street()), (185.0, street()), (268.0, street())]),
        (
            "round-5",
            2,
            26.0,
            vec![(0.0, wide), (75.0, street()), (150.0, wide), (215.0, street()), (290.0, wide)],
        ),
    ] {
        let mut layout = Layout::new(
            name,
            Terrain {
                waves: vec![Wave { amplitude_m: 3.0, period_m: 300.0, heading_rad: 0.3, phase_rad: 0.0 }],
                ..Terrain::flat()
            },
        );
        let middle =
            layout.node(Node::new([0.0, 0.0], NodeKind::Roundabout { island_m, lanes }).named("round"));
        for (degrees, shape) in arms {
            let (s, c) = frames::math::sin_cos(frames::deg(degrees));
            let radius_m = if shape == wide { 16.0 } else { 9.0 };
            let end = layout.node(Node::new([160.0 * c, 160.0 * s], NodeKind::DeadEnd { radius_m }));
            layout.edge(Edge::new(format!("arm {degrees}"), middle, end, shape));
        }
        let network = built(&layout);
        let map = Map::new(network);
        let yields = map.signals().iter().filter(|s| s.kind == "205").count();
        assert_eq!(
            yields,
            if name == "round-3" {
                3
            } else if name == "round-4" {
                4
            } else {
                5
            }
        );
    }
}

/// A ring of motorway with a diamond interchange over it, and what is at the ends of its ramps.
fn interchange(name: &str, kind: NodeKind) -> Layout {
    let mut layout = Layout::new(name, Terrain::flat());
    let seam = |x: f64| Node::new([x, 0.0], NodeKind::Seam { length_m: 70.0 });
    let [drop_west, west, east, drop_east] = [-640.0, -330.0, 330.0, 640.0].map(|x| layout.node(seam(x)));
    let top = layout.node(Node::new([0.0, 700.0], NodeKind::Seam { length_m: 60.0 }));
    let two = Side::open(2, 3.6, 2.5);
    let three = Side { lanes: 3, ..two };
    let main = CrossSection::motorway(two, 4.0, 110.0);
    let exit = Ending { right: Some(Pocket::one(140.0, 60.0)), ..Ending::default() };
    // Along the road's s the traffic goes east; each direction has its entry where the other has its exit.
    layout.edge(Edge::new("A1 west", drop_west, west, CrossSection { left: three, ..main }).end(exit));
    layout.edge(Edge::new("A1 middle", west, east, main));
    layout.edge(Edge::new("A1 east", east, drop_east, CrossSection { right: three, ..main }).start(exit));
    layout.edge(Edge::new("A1 loop", drop_east, top, main).via([1000.0, 0.0], 300.0, 60.0).via(
        [1000.0, 700.0],
        300.0,
        60.0,
    ));
    layout.edge(Edge::new("A1 loop", top, drop_west, main).via([-1000.0, 700.0], 300.0, 60.0).via(
        [-1000.0, 0.0],
        300.0,
        60.0,
    ));

    let terminal = |y: f64| Node::new([0.0, y], kind).lifted(3.0);
    let [south, north] = [-130.0, 130.0].map(|y| layout.node(terminal(y)));
    let ramp = CrossSection::ramp(1, 4.0, 60.0);
    layout.edge(
        Edge::new("exit east", west, south, ramp).via([-90.0, -125.0], 70.0, 30.0).leaves_by_ramp(true),
    );
    layout.edge(
        Edge::new("entry east", south, east, ramp).via([90.0, -125.0], 70.0, 30.0).enters_by_ramp(true),
    );
    layout
        .edge(Edge::new("exit west", east, north, ramp).via([90.0, 125.0], 70.0, 30.0).leaves_by_ramp(false));
    layout.edge(
        Edge::new("entry west", north, west, ramp).via([-90.0, 125.0], 70.0, 30.0).enters_by_ramp(false),
    );
    layout.edge(Edge::new("overpass", south, north, street()).lifted([0.0, 0.0], 7.0));
    for (node, y) in [(south, -330.0), (north, 330.0)] {
        let end = circle(&mut layout, [0.0, y]);
        layout.edge(Edge::new("street", node, end, street()));
    }
    layout
}

#[test]
fn a_motorway_has_exits_entries_and_an_overpass() {
    let network = built(&interchange("interchange", NodeKind::Crossing(Control::Signals)));
    let bridges: Vec<&str> =
        network.roads.iter().filter(|r| !r.bridges.is_empty()).map(|r| r.name.as_str()).collect();
    assert_eq!(bridges, ["overpass"]);
    // The seam at the far side joins equal roads: no junction there.
    let direct = |link: &Option<RoadLink>| matches!(link, Some(RoadLink::Road { .. }));
    let loops = network.roads.iter().filter(|r| r.name == "A1 loop");
    assert_eq!(loops.filter(|r| direct(&r.predecessor) != direct(&r.successor)).count(), 2);
    // Fast curves are banked.
    let banked = network.roads.iter().filter(|r| !r.superelevation.is_empty()).count();
    assert_eq!(banked, 2);
}

#[test]
fn ramps_lead_to_roundabouts() {
    for island_m in [14.0, 16.0, 24.0] {
        let kind = NodeKind::Roundabout { island_m, lanes: 1 };
        let network = built(&interchange(&format!("interchange-{island_m}"), kind));
        // Two streets and an exit enter each of the two, all of them yield.
        let yields = network.roads.iter().flat_map(|r| &r.signals).filter(|s| s.kind == "205").count();
        assert_eq!(yields, 6);
    }
}

#[test]
fn too_little_height_over_a_road_is_refused() {
    let mut layout = interchange("interchange", NodeKind::Crossing(Control::Signals));
    if let Some(edge) = layout.edges.iter_mut().find(|e| e.name == "overpass") {
        edge.anchors[0].lift_m = 4.5;
    }
    assert!(matches!(build(&layout), Err(TownError::Clearance { .. })));
}

#[test]
fn michigan_lefts_lead_back_through_the_median() {
    let mut layout = Layout::new("michigan", Terrain::flat());
    let side = Side::town(3, 3.5).with_sidewalk(2.5);
    let boulevard = CrossSection::both_ways(side, 70.0).with_median(Median::raised(15.0));
    let west = layout.node(Node::new([-420.0, 0.0], NodeKind::Roundabout { island_m: 30.0, lanes: 2 }));
    let east = layout.node(Node::new([420.0, 0.0], NodeKind::Roundabout { island_m: 30.0, lanes: 2 }));
    let cross = layout.node(Node::new([0.0, 0.0], NodeKind::Crossing(Control::Signals)).kerbs(9.0));
    let turns: Vec<NodeId> =
        [-200.0, 200.0].iter().map(|x| layout.node(Node::new([*x, 0.0], NodeKind::Crossover))).collect();
    let pocket = Ending { left: Some(Pocket::one(50.0, 30.0)), ..Ending::default() };
    let none = Ending::default();
    for (name, from, to, start, end) in [
        ("a", west, turns[0], none, pocket),
        ("b", turns[0], cross, pocket, none),
        ("c", cross, turns[1], none, pocket),
        ("d", turns[1], east, pocket, none),
    ] {
        layout.edge(Edge::new(format!("boulevard {name}"), from, to, boulevard).start(start).end(end));
    }
    for (node, at) in
        [(cross, [0.0, 150.0]), (cross, [0.0, -150.0]), (west, [-420.0, 170.0]), (east, [420.0, -170.0])]
    {
        let end = circle(&mut layout, at);
        layout.edge(Edge::new("street", node, end, street()));
    }
    let network = built(&layout);
    let turned = network.roads.iter().filter(|r| match (&r.predecessor, &r.successor) {
        (Some(RoadLink::Road { id: a, .. }), Some(RoadLink::Road { id: b, .. })) => {
            a == b && r.junction.is_some()
        }
        _ => false,
    });
    // Four U-turns, and a turning circle at each of four streets.
    assert_eq!(turned.count(), 8);
}

#[test]
fn a_railway_crosses_a_street() {
    let mut layout = Layout::new(
        "railway",
        Terrain {
            waves: vec![Wave { amplitude_m: 2.0, period_m: 400.0, heading_rad: 0.0, phase_rad: 1.0 }],
            ..Terrain::flat()
        },
    );
    let cross = layout.node(Node::new([0.0, 0.0], NodeKind::RailCrossing));
    let ends = [[-300.0, -20.0], [300.0, 40.0]].map(|at| layout.node(Node::new(at, NodeKind::MapEdge)));
    let rail = CrossSection::railway(true);
    layout.edge(Edge::new("railway", ends[0], cross, rail));
    layout.edge(Edge::new("railway", cross, ends[1], rail).via([150.0, 10.0], 300.0, 40.0));
    for at in [[20.0, 140.0], [-10.0, -140.0]] {
        let end = circle(&mut layout, at);
        layout.edge(Edge::new("street", cross, end, street()));
    }
    let network = built(&layout);
    let crosses = network.roads.iter().flat_map(|r| &r.signals).filter(|s| s.kind == "201").count();
    assert_eq!(crosses, 2);
    let map = Map::new(network);
    assert!(map.lanes().iter().any(|l| l.lane_type == LaneType::Rail));
}

#[test]
fn roads_bridge_rivers_and_tunnel_hills() {
    let terrain = Terrain {
        hills: vec![Hill { at_m: [500.0, 0.0], height_m: 60.0, radius_m: 60.0 }],
        channels: vec![Channel {
            line_m: vec![[150.0, -300.0], [170.0, 0.0], [150.0, 300.0]],
            width_m: 30.0,
            slope_m: 12.0,
            depth_m: 5.0,
        }],
        ..Terrain::flat()
    };
    let mut layout = Layout::new("river", terrain);
    let ends = [[0.0, 0.0], [800.0, 0.0]].map(|at| circle(&mut layout, at));
    let shape = CrossSection::rural(Side::open(1, 3.5, 1.0), 80.0);
    layout.edge(Edge::new("road", ends[0], ends[1], shape).evenly([330.0, 0.0], [670.0, 0.0]));
    let network = built(&layout);
    let road = &network.roads[0];
    assert_eq!((road.bridges.len(), road.tunnels.len()), (1, 1), "{:?} {:?}", road.bridges, road.tunnels);
    let (bridge, tunnel) = (&road.bridges[0], &road.tunnels[0]);
    let start = road.plan_view[0].x_m;
    assert!(start + bridge.s < 152.0 && start + bridge.s + bridge.length_m > 184.0, "{bridge:?}");
    assert!(start + tunnel.s < 470.0 && start + tunnel.s + tunnel.length_m > 530.0, "{tunnel:?}");
}

#[test]
fn seams_change_lanes_and_split_carriageways() {
    let mut layout = Layout::new(
        "seams",
        Terrain {
            waves: vec![Wave { amplitude_m: 6.0, period_m: 600.0, heading_rad: 0.0, phase_rad: 0.0 }],
            ..Terrain::flat()
        },
    );
    let side = |lanes| Side::open(lanes, 3.5, 1.5);
    let at = |x: f64| Node::new([x, 0.0], NodeKind::Seam { length_m: 50.0 });
    let [a, b, c, d] = [-400.0, -200.0, 0.0, 400.0].map(|x| layout.node(at(x)));
    let (west, east) = (
        circle(&mut layout, [-600.0, 0.0]),
        layout.node(Node::new([650.0, 0.0], NodeKind::DeadEnd { radius_m: 16.0 })),
    );
    layout.edge(Edge::new("village", west, a, street()));
    layout.edge(Edge::new("narrow", a, b, CrossSection::rural(side(1), 70.0)));
    layout.edge(Edge::new("wide", b, c, CrossSection::rural(side(2), 90.0).with_median(Median::raised(4.0))));
    // Between c and d each direction has a road of its own; they part and meet again.
    let lone = CrossSection { banked: false, ..CrossSection::one_way(side(2), 1.0, 90.0) };
    layout.edge(
        Edge::new("south way", c, d, lone)
            .via([100.0, -9.0], 300.0, 0.0)
            .via([200.0, -40.0], 200.0, 0.0)
            .via([300.0, -9.0], 300.0, 0.0),
    );
    layout.edge(
        Edge::new("north way", d, c, lone).via([300.0, 9.0], 300.0, 0.0).via([200.0, 40.0], 200.0, 0.0).via(
            [100.0, 9.0],
            300.0,
            0.0,
        ),
    );
    layout.edge(Edge::new(
        "wide",
        d,
        east,
        CrossSection::rural(side(2), 90.0).with_median(Median::raised(4.0)),
    ));
    built(&layout);
}
