//! Small inputs with answers that can be worked out by hand, and the published figures.

use std::collections::BTreeMap;

use analysis::{
    DatasetFacts, MeasureTotals, SceneCard, Tables, compute_tables, draw_figures, published_html,
    report_html, to_csv,
};
use proptest::prelude::*;
use schema::measures;
use schema::scene_info::{AgentInfo, SceneInfo};
use schema::tables::PartialRow;

fn row(agent: &str, measure: &str, class: &str, bin: i32, count: u64) -> PartialRow {
    PartialRow { agent: agent.into(), measure: measure.into(), class: class.into(), bin, count }
}

fn scene(number: u32, vehicles: u16, rsus: u16) -> SceneInfo {
    let agent = |agent: String| AgentInfo { agent, ..AgentInfo::default() };
    SceneInfo {
        scene: number,
        split: "train".into(),
        map: "Town01".into(),
        duration_s: 10.0,
        frames: 200,
        agents: (0..vehicles)
            .map(|i| agent(format!("vehicle_{i}")))
            .chain((0..rsus).map(|i| agent(format!("rsu_{i}"))))
            .collect(),
        ..SceneInfo::default()
    }
}

fn weather(scene: SceneInfo, parameter: &str, initial: f64, last: Option<f64>) -> SceneInfo {
    let one = |value: f64| BTreeMap::from([(parameter.to_owned(), value)]);
    SceneInfo { initial_weather: one(initial), final_weather: last.map(one).unwrap_or_default(), ..scene }
}

fn tables_of(scenes: &[SceneInfo], rows: &[PartialRow]) -> Tables {
    let mut counts = MeasureTotals::default();
    counts.add(rows);
    compute_tables(&facts(scenes.len()), scenes, &counts)
}

fn facts(planned: usize) -> DatasetFacts {
    DatasetFacts {
        name: "demo".into(),
        planned_scenes: planned as u64,
        bev_cells: 400,
        bev_cell_m: 0.4,
        ..DatasetFacts::default()
    }
}

#[test]
fn statistics_say_which_part_of_the_dataset_they_cover() {
    let counts = MeasureTotals::default();
    let whole = compute_tables(&facts(2), &[scene(0, 1, 0), scene(1, 1, 0)], &counts);
    assert!(
        !csv(&whole, "overview").contains("planned")
            && report_html(&whole, &[], &[], []).contains("of the dataset<")
    );
    let part = compute_tables(&facts(3), &[scene(0, 1, 0), scene(1, 1, 0)], &counts);
    assert!(csv(&part, "overview").starts_with("quantity,value\nscenes,2\nplanned_scenes,3\nmaps,1\n"));
    assert!(report_html(&part, &[], &[], []).contains("Statistics of 2 of 3 scenes"));
}

fn csv(tables: &Tables, name: &str) -> String {
    to_csv(tables.get(name).expect("a table of that name"))
}

#[test]
fn scenes_are_counted_by_their_agents_and_size() {
    let mut scenes = vec![scene(2, 3, 0), scene(0, 1, 2), scene(1, 3, 0)];
    scenes[0].n_vehicles = 400;
    scenes[1].n_vehicles = 399;
    scenes[2].n_vehicles = 1000;
    scenes[0].split = "val".into();
    scenes[1].map = "Town02".into();
    scenes[2].duration_s = 11.999_999_9;
    let tables = tables_of(&scenes, &[]);
    assert_eq!(csv(&tables, "scenes_by_vehicles"), "bin,lower,scenes\n1,1,1\n2,2,0\n3,3,2\n");
    assert_eq!(csv(&tables, "scenes_by_rsus"), "bin,lower,scenes\n0,0,2\n1,1,0\n2,2,1\n");
    assert_eq!(csv(&tables, "scenes_by_duration"), "bin,lower,scenes\n10,10,2\n11,11,0\n12,12,1\n");
    assert_eq!(
        csv(&tables, "scenes_by_background_vehicles"),
        "bin,lower,scenes\n380-399,380,1\n400+,400,2\n"
    );
    assert_eq!(csv(&tables, "scenes_by_pedestrians"), "bin,lower,scenes\n0-19,0,3\n");
    assert_eq!(
        csv(&tables, "scenes_by_map"),
        "map,train,val,test,total\nTown01,1,1,0,2\nTown02,1,0,0,1\ntotal,2,1,0,3\n"
    );
    assert_eq!(tables.get("scenes").expect("there").counts("scene"), [0, 1, 2]);
}

#[test]
fn transitions_follow_the_half_open_bins() {
    let clouds = [(9.999, Some(10.0)), (39.999, Some(40.0)), (69.999, Some(70.0)), (100.0, None)];
    let mut scenes: Vec<SceneInfo> =
        clouds.iter().map(|&(a, b)| weather(scene(0, 1, 0), "cloudiness", a, b)).collect();
    // Without weather, or with one that is no number, a scene is in no matrix.
    scenes.push(scene(9, 1, 0));
    scenes.push(weather(scene(9, 1, 0), "cloudiness", f64::NAN, None));
    let tables = tables_of(&scenes, &[]);
    let table = tables.get("weather_cloudiness").expect("there");
    let mut want = [0_u64; 16];
    for (initial, last) in [(0, 1), (1, 2), (2, 3), (3, 3)] {
        want[4 * initial + last] = 1;
    }
    assert_eq!(table.counts("scenes"), want);
    assert!(csv(&tables, "weather_cloudiness").contains("none,low,1,0.2500\n"));

    let sun = [(-0.001, 0.0), (5.999, 6.0), (90.0, -90.0)];
    let scenes: Vec<SceneInfo> =
        sun.iter().map(|&(a, b)| weather(scene(0, 1, 0), "sun_altitude_deg", a, Some(b))).collect();
    let tables = tables_of(&scenes, &[]);
    let table = tables.get("weather_sun_altitude").expect("there");
    assert_eq!(table.counts("scenes"), [0, 1, 0, 0, 0, 1, 1, 0, 0]);
    // No scene has rain: counts are 0, and there is nothing to divide by.
    assert!(csv(&tables, "weather_precipitation").ends_with("heavy,heavy,0,\n"));
}

#[test]
fn boxes_have_shares_and_means() {
    let tables = tables_of(
        &[],
        &[
            row("", measures::tracks::FRAMES, "", 0, 100),
            row("", measures::tracks::FRAMES, "", 0, 100),
            row("", measures::tracks::BOXES, "car", 0, 1000),
            row("", measures::tracks::BOXES_VALID, "car", 0, 581),
            row("", measures::tracks::BOXES, "bus", 0, 8),
            row("", measures::tracks::BOXES, "hovercraft", 0, 2),
        ],
    );
    let csv = csv(&tables, "boxes_per_class");
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines[0], "class,all,valid,valid_percent,all_per_frame,valid_per_frame");
    assert_eq!(lines[1], "traffic_light,0,0,,0.00,0.00");
    assert!(lines.contains(&"car,1000,581,58.1,5.00,2.90"), "{csv}");
    assert!(lines.contains(&"bus,8,0,0.0,0.04,0.00"), "{csv}");
    assert_eq!(lines[lines.len() - 2], "hovercraft,2,0,0.0,0.01,0.00");
    assert_eq!(lines[lines.len() - 1], "total,1010,581,57.5,5.05,2.90");
}

#[test]
fn frames_without_valid_objects_are_frames() {
    let tables = tables_of(
        &[scene(0, 1, 0)],
        &[
            row("", measures::tracks::VALID_PER_FRAME, "car", 0, 50),
            row("", measures::tracks::VALID_PER_FRAME, "car", 100, 20),
            row("", measures::tracks::VALID_PER_FRAME, "bus", 5, 1),
        ],
    );
    let table = tables.get("valid_per_frame").expect("there");
    assert_eq!(table.len(), 21);
    assert_eq!(table.strings("bin")[..2], ["0-4", "5-9"]);
    assert_eq!(table.strings("bin")[20], "100+");
    // 200 frames by the scene's own count.
    assert_eq!((table.counts("car")[0], table.counts("car")[20]), (180, 20));
    assert_eq!((table.counts("bus")[0], table.counts("bus")[1]), (199, 1));
    assert_eq!(table.counts("barrier")[0], 200);
    for class in ["car", "bus", "barrier"] {
        assert_eq!(table.counts(class).iter().sum::<u64>(), 200);
    }
}

#[test]
fn values_outside_the_bins_have_rows_of_their_own() {
    let rate = |bin, count| row("", measures::tracks::YAW_RATE_DPS, "car", bin, count);
    let inside = tables_of(&[], &[rate(-50, 1), rate(45, 2)]);
    let table = inside.get("yaw_rate").expect("there");
    assert_eq!((table.len(), table.strings("bin")[0].as_str()), (20, "-50..-45"));
    assert_eq!((table.counts("car")[0], table.counts("car")[19]), (1, 2));
    let outside = tables_of(&[], &[rate(-55, 1), rate(0, 5), rate(50, 2), rate(400, 3)]);
    let table = outside.get("yaw_rate").expect("there");
    assert_eq!(table.strings("bin").first().map(String::as_str), Some("<-50"));
    assert_eq!(table.strings("bin").last().map(String::as_str), Some("50+"));
    assert_eq!((table.counts("car")[0], table.counts("car")[21]), (1, 5));
    let headings = tables_of(&[], &[row("", measures::tracks::YAW_DEG, "barrier", -180, 7)]);
    assert_eq!(headings.get("yaw").expect("there").len(), 36);
    assert_eq!(headings.get("yaw").expect("there").counts("barrier")[0], 7);
}

#[test]
fn grids_reproduce_the_published_arithmetic() {
    // Roads and riders over 588,520 masks, and three labels of the voxel grids, as published.
    let tables = tables_of(
        &[],
        &[
            row("vehicle_0", measures::bev::BEV_GRIDS, "exact", 0, 588_520),
            row("vehicle_0", measures::bev::BEV_CELLS, "road", 0, 18_423_410_070),
            row("vehicle_0", measures::bev::BEV_CELLS, "rider", 0, 4_059_365),
            row("vehicle_0", measures::voxels::VOXEL_GRIDS, "", 0, 588_520),
            row("vehicle_0", measures::voxels::VOXEL_CELLS, "unlabeled", 0, 74_041_651_379_126),
            row("vehicle_0", measures::voxels::VOXEL_CELLS, "building", 0, 900_817_475_055),
            row("vehicle_0", measures::voxels::VOXEL_CELLS, "pole", 0, 8_579_662_196),
            row("vehicle_0", measures::voxels::VOXEL_CELLS_FILLED, "unlabeled", 0, 72_503_458_309_399),
            row("vehicle_0", measures::voxels::VOXEL_CELLS_FILLED, "building", 0, 1_674_330_702_776),
            row("vehicle_0", measures::voxels::VOXEL_CELLS_FILLED, "pole", 0, 8_989_939_222),
        ],
    );
    assert_eq!(csv(&tables, "bev_rules"), "rule,masks\nexact,588520\n");
    let bev = csv(&tables, "bev_cells");
    assert!(bev.contains("\nroad,18423410070,31304.65,19.5654\n"), "{bev}");
    assert!(bev.contains("\nrider,4059365,6.90,0.0043\n"), "{bev}");
    assert!(bev.ends_with("\ntotal,18427469435,31311.54,19.5697\n"), "{bev}");
    let voxels = csv(&tables, "voxel_cells");
    assert!(voxels.contains("\nbuilding,900817475055,1674330702776,1.859,"), "{voxels}");
    assert!(voxels.contains("\npole,8579662196,8989939222,1.048,"), "{voxels}");
    assert!(!voxels.contains("unlabeled"));
    let table = tables.get("voxel_cells").expect("there");
    assert_eq!(table.counts("unfilled").last(), Some(&(900_817_475_055 + 8_579_662_196)));
}

#[test]
fn sweeps_are_counted_by_sensor() {
    let tables = tables_of(
        &[],
        &[
            row("vehicle_0", measures::simulation::AGENT_FRAMES, "", 0, 100),
            row("rsu_0", measures::simulation::AGENT_FRAMES, "", 0, 40),
            row("vehicle_0", measures::sensors::LIDAR_POINTS, "LIDAR", 0, 1000),
            row("rsu_0", measures::sensors::LIDAR_POINTS, "LIDAR", 0, 400),
            row("vehicle_0", measures::sensors::RADAR_POINTS, "RAD_BACK", 0, 50),
            row("vehicle_0", measures::sensors::SWEEPS, "LIDAR", 0, 50),
            row("rsu_0", measures::sensors::SWEEPS, "LIDAR", 0, 40),
            row("vehicle_0", measures::sensors::SWEEPS, "RAD_BACK", 0, 100),
            row("vehicle_0", measures::sensors::IMAGES, "RGB", 0, 600),
            row("vehicle_0", measures::sensors::SENSOR_BYTES, "RGB", 0, 3000),
            row("vehicle_0", measures::sensors::SENSOR_BYTES, "LIDAR", 0, 1000),
        ],
    );
    assert_eq!(
        csv(&tables, "points_per_sensor"),
        "sensor,kind,sweeps,points,points_per_sweep\nLIDAR,lidar,90,1400,15.6\nRAD_BACK,radar,100,50,0.5\n"
    );
    assert_eq!(csv(&tables, "images_per_kind"), "kind,images,images_per_agent_frame\nRGB,600,4.29\n");
    assert_eq!(csv(&tables, "bytes_per_sensor"), "sensor,bytes,percent\nLIDAR,1000,25.00\nRGB,3000,75.00\n");
    let overview = csv(&tables, "overview");
    assert!(overview.contains("\nvehicle_frames,100\nrsu_frames,40\n"), "{overview}");
}

#[test]
fn wheelchairs_are_counted_among_all_and_valid() {
    let tables = tables_of(
        &[],
        &[
            row("", measures::tracks::PEDESTRIANS, "", 0, 150),
            row("", measures::tracks::PEDESTRIANS, "all", 0, 50),
            row("", measures::tracks::WHEELCHAIR, "all", 0, 10),
            row("", measures::tracks::PEDESTRIANS, "valid", 0, 80),
            row("", measures::tracks::WHEELCHAIR, "valid", 0, 2),
        ],
    );
    assert_eq!(
        csv(&tables, "wheelchairs"),
        "objects,pedestrians,wheelchair_users,percent\nall,200,10,5.00\nvalid,80,2,2.50\n"
    );
}

#[test]
fn the_report_of_nothing_is_a_page() {
    let tables = tables_of(&[], &[]);
    let figures = draw_figures(&tables);
    assert!(figures.is_empty());
    let html = report_html(&tables, &figures, &[], []);
    assert!(html.contains("<span>scenes</span>"));
    assert!(!html.contains("Occupancy labels"));
    assert_eq!(published_html(&tables, &figures), None);
}

#[test]
fn scenes_are_cards_that_say_what_to_filter_them_by() {
    let tables = tables_of(&[scene(3, 1, 0)], &[]);
    let card = |scene: u32, split: &str, picture: Option<&str>| SceneCard {
        scene,
        split: split.into(),
        map: "Town<1>".into(),
        kind: String::new(),
        words: "10 s".into(),
        picture: picture.map(str::to_owned),
    };
    let cards = [card(3, "train", Some("scenes/0003.jpg")), card(4, "val", None)];
    let html = report_html(&tables, &[], &cards, []);
    let page = parse(&html);
    let found: Vec<_> = page.descendants().filter(|n| n.attribute("class") == Some("card")).collect();
    let attribute =
        |name: &str| found.iter().map(|n| n.attribute(name).unwrap_or_default()).collect::<Vec<_>>();
    assert_eq!(attribute("data-scene"), ["0003", "0004"]);
    assert_eq!(attribute("data-split"), ["train", "val"]);
    assert_eq!(attribute("data-map"), ["Town<1>"; 2]);
    let images: Vec<_> = page.descendants().filter_map(|n| n.attribute("src")).collect();
    assert_eq!(images, ["scenes/0003.jpg"]);
    let select =
        |name| page.descendants().find(|n| n.has_tag_name("select") && n.attribute("name") == Some(name));
    let options =
        |name| select(name).map_or(0, |s| s.descendants().filter(|n| n.has_tag_name("option")).count());
    assert_eq!((options("split"), options("map")), (3, 2), "each value and `all`");
}

#[test]
fn our_numbers_stand_beside_the_published_ones() {
    let mut scenes = vec![scene(0, 4, 1), scene(1, 2, 0)];
    scenes[0].n_accident_hazards = 3;
    // 400 frames with 20,392 valid cars: 50.98 a frame, as in the published dataset.
    let rows = [
        row("", measures::tracks::FRAMES, "", 0, 400),
        row("", measures::tracks::BOXES, "car", 0, 30_000),
        row("", measures::tracks::BOXES_VALID, "car", 0, 20_392),
        row("vehicle_0", measures::bev::BEV_GRIDS, "exact", 0, 10),
        row("vehicle_0", measures::bev::BEV_CELLS, "road", 0, 320_000),
    ];
    let tables = tables_of(&scenes, &rows);
    assert!(csv(&tables, "beside_boxes").contains("\ncar,50.98,50.98,1.000\n"));
    assert!(csv(&tables, "beside_boxes").contains("\nbus,0.00,1.43,0.000\n"));
    assert!(csv(&tables, "beside_valid_share").contains("\ncar,68.0,58.1,1.170\n"));
    // A fifth of the grid, beside 19.565 %.
    assert!(csv(&tables, "beside_bev").contains("\nroad,20.0000,19.5654,1.022\n"));
    let of_scenes = csv(&tables, "beside_scene_means");
    assert!(of_scenes.contains("data-collection vehicles,3.00,4.84,0.620\n"), "{of_scenes}");
    assert!(of_scenes.contains("accidents,1.50,2.89,0.519\n"), "{of_scenes}");
    assert!(csv(&tables, "beside_size").contains("\nboxes,30000,27337066,0.001097\n"));
    assert!(csv(&tables, "beside_scenes_by_vehicles").contains("\n2,50.0,17.8\n3,0.0,12.4\n4,50.0,15.1\n"));
    assert!(tables.get("beside_voxels").expect("there").is_empty());
    let figures = draw_figures(&tables);
    let html = published_html(&tables, &figures).expect("has numbers");
    parse(&html);
    assert!(html.contains("Valid objects in a frame") && html.contains("href=\"report.html\""));
    // The report leads there, and leaves the numbers to it.
    let report = report_html(&tables, &figures, &[], []);
    assert!(report.contains("href=\"published.html\"") && !report.contains("ours by published"));
}

#[test]
fn points_and_places_have_tables_and_figures() {
    use measures::sightings::{LIDAR_POINTS_AT, PLACES, SEEN_BY_VEHICLES, bin_of_points};
    let points = |distance_m, points| bin_of_points(distance_m, points).expect("has a bin");
    // 30 to 35 m ahead, up to 5 m to the left.
    let ahead = 33 * PLACES + 39;
    let rows = [
        row("", LIDAR_POINTS_AT, "car", points(3.0, 1000), 8),
        row("", LIDAR_POINTS_AT, "car", points(3.0, 1), 2),
        row("", LIDAR_POINTS_AT, "car", points(62.0, 10), 1),
        row("", SEEN_BY_VEHICLES, "car", ahead, 11),
    ];
    let tables = tables_of(&[scene(0, 1, 0)], &rows);
    // 1000 points lie on the edge of a level that ends at 1334: 1154 in the middle; 10 in one that ends at
    // 13.3.
    let wanted = "class,from_m,objects,tenth,median,nine_tenths\ncar,0,10,1,1154,1154\ncar,60,1,11,11,11\n";
    assert_eq!(csv(&tables, "lidar_points_by_distance"), wanted);
    assert_eq!(csv(&tables, "seen_by_vehicles").lines().nth(1), Some("32.5,2.5,0,0,0,11,0,0,0,0,0,0"));
    let spread = csv(&tables, "lidar_points_spread");
    let rows: Vec<&str> = spread.lines().skip(1).collect();
    assert_eq!(
        rows,
        ["0,1.0,0,0,0,2,0,0,0,0,0,0", "0,1000.0,0,0,0,8,0,0,0,0,0,0", "60,10.0,0,0,0,1,0,0,0,0,0,0"]
    );
    let names: Vec<String> = draw_figures(&tables).into_iter().map(|figure| figure.name).collect();
    assert!(
        names.contains(&"lidar_points_by_distance".to_owned())
            && names.contains(&"seen_by_vehicles_car".into())
    );
    assert!(!names.iter().any(|name| name.contains("rsus_") || name.starts_with("radar")), "{names:?}");
}

#[test]
fn bev_labels_have_places() {
    use measures::bev::{BEV_CELLS, BEV_GRIDS, BEV_HEAT};
    // Ten masks of 400 by 400 cells: blocks of 8 by 8, 3.2 m. The last block of the first row is far ahead on
    // the right.
    let rows = [
        row("rsu_0", BEV_GRIDS, "exact", 0, 10),
        row("rsu_0", BEV_CELLS, "road", 0, 336),
        row("", BEV_HEAT, "road", 49, 320),
        row("", BEV_HEAT, "road", 50 * 25 + 24, 16),
    ];
    let tables = tables_of(&[scene(0, 1, 0)], &rows);
    let heat = csv(&tables, "bev_heat");
    let lines: Vec<&str> = heat.lines().collect();
    assert_eq!(lines.len(), 2501);
    assert!(lines[50].starts_with("78.40,-78.40,50.0000,0.0000,"), "{}", lines[50]);
    // Just behind the agent and to its left.
    assert!(lines[1 + 50 * 25 + 24].starts_with("-1.60,1.60,2.5000,"), "{}", lines[1 + 50 * 25 + 24]);
    let figures = draw_figures(&tables);
    let drawn: Vec<&str> =
        figures.iter().map(|f| f.name.as_str()).filter(|n| n.starts_with("bev_heat")).collect();
    assert_eq!(drawn, ["bev_heat_road"], "classes that no cell carries have no figure");
    // The long table stays in its file.
    let html = report_html(&tables, &figures, &[], []);
    assert!(html.contains("href=\"bev_heat.csv\">2,500 rows") && !html.contains("<td>78.40</td>"));
}

#[test]
fn hazards_have_histograms() {
    let mut scenes: Vec<SceneInfo> = (0..3).map(|i| scene(i, 1, 0)).collect();
    scenes[1].n_accident_hazards = 2;
    scenes[2].n_accident_hazards = 14;
    let tables = tables_of(&scenes, &[]);
    let wanted =
        "bin,lower,scenes\n0,0,1\n1,1,0\n2,2,1\n3,3,0\n4,4,0\n5,5,0\n6,6,0\n7,7,0\n8,8,0\n9,9,0\n10+,10,1\n";
    assert_eq!(csv(&tables, "scenes_by_accidents"), wanted);
    assert_eq!(csv(&tables, "scenes_by_road_works"), "bin,lower,scenes\n0,0,3\n");
}

/// The cells of a CSV file by RFC 4180, character by character: another reader than the writer's own crate.
fn cells(csv: &str) -> Vec<Vec<String>> {
    let (mut lines, mut line, mut cell) = (Vec::new(), Vec::new(), String::new());
    let (mut quoted, mut chars) = (false, csv.chars().peekable());
    while let Some(c) = chars.next() {
        match c {
            '"' if quoted && chars.next_if_eq(&'"').is_some() => cell.push('"'),
            '"' => quoted = !quoted,
            ',' if !quoted => line.push(std::mem::take(&mut cell)),
            '\n' if !quoted => {
                line.push(std::mem::take(&mut cell));
                lines.push(std::mem::take(&mut line));
            }
            c => cell.push(c),
        }
    }
    assert!(!quoted && cell.is_empty() && line.is_empty(), "every line ends: {csv:?}");
    lines
}

fn parse(xml: &str) -> roxmltree::Document<'_> {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    roxmltree::Document::parse_with_options(xml, options).expect("well-formed")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn matrices_sum_to_one_and_histograms_to_the_scenes(
        specs in proptest::collection::vec((-120.0..120.0_f64, -120.0..120.0_f64, 1_u16..9, 0_u16..5, 0_u32..3000), 1..40),
    ) {
        let scenes: Vec<SceneInfo> = specs
            .iter()
            .enumerate()
            .map(|(i, &(a, b, vehicles, rsus, background))| {
                let mut scene = scene(i as u32, vehicles, rsus);
                for parameter in ["cloudiness", "precipitation", "fog_density", "sun_altitude_deg"] {
                    scene.initial_weather.insert(parameter.into(), a);
                    scene.final_weather.insert(parameter.into(), b);
                }
                SceneInfo { n_vehicles: background, n_walkers: background / 2, ..scene }
            })
            .collect();
        let tables = tables_of(&scenes, &[]);
        for table in &tables.tables {
            if table.name.starts_with("weather_") {
                let sum: f64 = table.numbers("fraction").iter().flatten().sum();
                prop_assert!((sum - 1.0).abs() < 1e-9, "{}: {}", table.name, sum);
            }
            if table.column("bin").is_some() && !table.counts("scenes").is_empty() {
                prop_assert_eq!(table.counts("scenes").iter().sum::<u64>(), scenes.len() as u64);
            }
        }
        let mut reversed = scenes.clone();
        reversed.reverse();
        prop_assert_eq!(&tables_of(&reversed, &[]), &tables, "the order of scenes makes no difference");
    }

    #[test]
    fn any_counts_make_well_formed_pages(
        rows in proptest::collection::vec(
            (
                proptest::sample::select(vec![
                    "frames", "agent_frames", "boxes", "boxes_valid", "valid_per_frame", "yaw_deg", "speed_mps",
                    "yaw_rate_dps", "bev_cells", "bev_grids", "bev_heat", "lidar_points_at", "radar_points_at",
                    "seen_by_vehicles", "seen_by_rsus", "voxel_cells", "voxel_cells_filled", "lidar_points",
                    "sensor_bytes", "pedestrians",
                ]),
                proptest::sample::select(vec!["", "car", "road", "a<b>&\"c\u{1}", "one, two\n\"three\"", "unlabeled", "vehicle_0"]),
                any::<i32>(),
                proptest::sample::select(vec![0, 1, 77, u64::MAX]),
            ),
            0..30,
        ),
        name in "\\PC{0,12}",
    ) {
        let rows: Vec<PartialRow> = rows.iter().map(|(m, class, bin, n)| row("vehicle_0", m, class, *bin, *n)).collect();
        let mut tables = tables_of(&[scene(0, 1, 1)], &rows);
        tables.dataset = name;
        let figures = draw_figures(&tables);
        for figure in &figures {
            parse(&figure.svg);
            prop_assert!(!figure.svg.contains("NaN") && !figure.svg.contains("inf\""));
        }
        let html = report_html(&tables, &figures, &[], []);
        let page = parse(&html);
        // Every link within the page has its target.
        for link in page.descendants().filter_map(|node| node.attribute("href")) {
            // Others lead to the page beside this one, or to the file of a long table.
            let Some(target) = link.strip_prefix('#') else {
                let is_table = link.strip_suffix(".csv").is_some_and(|name| tables.get(name).is_some());
                prop_assert!(["published.html", "data:,"].contains(&link) || is_table, "{}", link);
                continue;
            };
            prop_assert!(page.descendants().any(|node| node.attribute("id") == Some(target)));
        }
        for table in &tables.tables {
            let names = table.columns.iter().map(|column| column.name.clone()).collect();
            let rows = (0..table.len()).map(|row| table.columns.iter().map(|column| column.values.text(row)).collect());
            let want: Vec<Vec<String>> = std::iter::once(names).chain(rows).collect();
            prop_assert_eq!(cells(&to_csv(table)), want, "{}", table.name);
        }
    }
}
