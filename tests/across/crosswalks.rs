//! A crosswalk from the map's file to the masks.

use std::fs::File;
use std::io::BufReader;

use codecs::NpzReader;
use convoy_tests::{Bench, SMALL};
use opendrive::{Corner, LaneType, Network, Object, Outline};
use schema::BevClass;
use schema::tables::AgentRow;
use store::{Scope, Store, keys};

use crate::masks::mask_is_the_polygons;

/// At 78 to 82 m of a street of 200 m to the east, half a metre short of its edges. (Masks show crosswalks
/// where there is road.)
const CROSSWALK_M: [[f64; 3]; 4] = [[78.0, -3.0, 0.0], [82.0, -3.0, 0.0], [82.0, 3.0, 0.0], [78.0, 3.0, 0.0]];

fn network() -> Network {
    let corner = |u_m: f64, v_m: f64| Corner::Local { u_m, v_m, z_m: 0.0, height_m: 0.0 };
    let mut road = testkit::straight_road(200.0, &[(LaneType::Driving, 3.5), (LaneType::Sidewalk, 3.0)]);
    road.objects = vec![Object {
        id: "7".into(),
        kind: "crosswalk".into(),
        s: 80.0,
        t: 1.0,
        outlines: vec![Outline {
            corners: vec![corner(-2.0, -4.0), corner(2.0, -4.0), corner(2.0, 2.0), corner(-2.0, 2.0)],
            ..Outline::default()
        }],
        ..Object::default()
    }];
    let mut network = Network { roads: vec![road], ..Network::default() };
    network.header.revision = (1, 7);
    network
}

#[test]
fn a_crosswalk_of_the_map_is_in_the_mask() {
    let config = SMALL
        .replace("convoy/demo", "street")
        .replace("rsus = 1", "rsus = 0")
        .replace("vehicles = 12", "vehicles = 0")
        .replace("count = 12", "count = 0");
    let starts = "\n[[agents.starts]]\nmap = \"street\"\nxyz_m = [60, -1.75, 0]\n";
    let bench = Bench::new(&(config + starts));
    let maps = bench.folder.path().join("maps");
    std::fs::create_dir(&maps).expect("makes the folder");
    std::fs::write(maps.join("street.xodr"), opendrive::write(&network())).expect("writes");
    bench.run("spawn-planner", &["--maps", maps.to_str().expect("is UTF-8")]).expect_done();
    for stage in ["simulate-and-log", "bev-gt"] {
        bench.run(stage, &[]).expect_done();
    }
    let store = Store::open(bench.store()).expect("is a folder");
    let log = store.manifest(Scope::Scene(0), "simulate-and-log").expect("reads").expect("is done");
    let agents: Vec<AgentRow> = store.read_rows(&log, &keys::scene(0, "agents.parquet")).expect("reads");
    let file = File::open(bench.store().join("scenes/0000/bev/vehicle_0.npz")).expect("opens");
    let mut masks = NpzReader::new(BufReader::new(file)).expect("is npz");
    assert_eq!(agents.len(), 20);
    for row in &agents {
        // It is ahead, and nothing but the vehicle itself is there.
        assert!((50.0..75.0).contains(&row.xyz_m[0]), "{row:?}");
        let mask = masks.read(&format!("{:04}.npy", row.frame)).expect("is there");
        let cells = mask_is_the_polygons(&[&CROSSWALK_M], BevClass::Crosswalk, row, &mask.bytes);
        // 4 m by 6 m in cells of 0.4 m.
        assert!((135..=165).contains(&cells), "{cells}");
    }
}
