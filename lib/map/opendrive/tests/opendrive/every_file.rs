//! Every real file at hand loads, holds what was counted in it by other means, and survives writing.

use std::collections::BTreeMap;
use std::path::Path;

use opendrive::*;
use testkit::map_files;

/// What was counted in a file: roads, junctions, kilometres of driving lanes in hundredths, signals, signal
/// references, controllers; and its lanes by type.
type Facts = (&'static str, [usize; 6], &'static str);

/// Files that must fail, and a word that the message must hold.
const BROKEN: [(&str, &str); 1] = [("SingleRoadNanValues", "nan")];

const CARLA: [Facts; 7] = [
    ("Town01", [122, 12, 640, 36, 72, 36], "driving 124, shoulder 88, sidewalk 88"),
    ("Town02", [84, 8, 292, 24, 48, 24], "driving 88, shoulder 64, sidewalk 64"),
    (
        "Town03",
        [369, 35, 1378, 38, 112, 38],
        "bidirectional 12, border 10, driving 417, median 12, none 149, parking 75, shoulder 576, sidewalk 320",
    ),
    ("Town04", [276, 27, 3345, 43, 121, 43], "driving 463, none 51, shoulder 326, sidewalk 84"),
    ("Town06", [200, 23, 2551, 19, 82, 19], "driving 467, median 10, none 85, shoulder 490"),
    ("Town10HD", [108, 9, 595, 21, 63, 16], "driving 168, median 4, none 2, shoulder 153, sidewalk 74"),
    ("Town11", [2222, 174, 71715, 602, 1363, 543], "driving 2357, shoulder 1493, sidewalk 1062"),
];

#[rustfmt::skip]
const OTHERS: &[Facts] = &[
    ("carla2019/Town01", [98, 12, 640, 0, 0, 0], "driving 202, shoulder 52, sidewalk 52"),
    ("esmini/circle_300m", [1, 0, 60, 0, 0, 0], "border 2, driving 2, shoulder 2"),
    ("esmini/connected_junctions_simple", [6, 2, 0, 0, 0, 0], "offRamp 8"),
    ("esmini/curve_r100", [1, 0, 151, 0, 0, 0], "border 2, driving 2"),
    ("esmini/curves", [1, 0, 231, 0, 0, 0], "border 4, driving 2"),
    ("esmini/curves_elevation", [1, 0, 231, 0, 0, 0], "border 4, driving 2"),
    ("esmini/direct_junction_simple", [4, 1, 70, 0, 0, 0], "driving 8, border 5"),
    ("esmini/e6mini", [1, 0, 879, 0, 0, 0], "border 6, driving 6, stop 2"),
    ("esmini/fabriksgatan", [16, 1, 122, 0, 0, 0], "driving 20, border 12, sidewalk 12"),
    ("esmini/fabriksgatan_mixed_id_types", [16, 1, 122, 0, 0, 0], "driving 20, border 12, sidewalk 12"),
    ("esmini/fade_roadmarks", [1, 0, 30, 0, 0, 0], "driving 6"),
    ("esmini/highway_example_with_merge_and_split", [9, 2, 302, 0, 0, 0], "driving 53"),
    ("esmini/jolengatan", [1, 0, 159, 0, 0, 0], "border 2, driving 2, none 2"),
    ("esmini/junction_simple_unordered_road_elements", [5, 1, 0, 0, 0, 0], "offRamp 6"),
    ("esmini/lane_offset_intersection", [10, 1, 50, 2, 0, 0], "driving 17, border 8"),
    ("esmini/lane_width_and_offset", [1, 0, 1, 0, 0, 0], "driving 1"),
    ("esmini/mixed_roads", [5, 0, 64, 0, 0, 0], "driving 11"),
    ("esmini/multi_intersections", [63, 5, 643, 127, 0, 23], "driving 86, border 59, sidewalk 59, none 38"),
    ("esmini/multi_lanesections", [1, 0, 160, 0, 0, 0], "driving 16"),
    ("esmini/mw_100m", [1, 0, 600, 0, 0, 0], "border 6, driving 6, stop 2, restricted 1"),
    ("esmini/offset", [1, 0, 20, 0, 0, 0], "driving 2"),
    ("esmini/roadmarks", [1, 0, 96, 0, 0, 0], "driving 36"),
    ("esmini/some_signs", [1, 0, 100, 12, 0, 0], "border 4, driving 2"),
    ("esmini/star", [24, 0, 240, 0, 0, 0], "driving 48"),
    ("esmini/stationary_objects", [1, 0, 5, 1, 0, 0], "driving 1"),
    ("esmini/straight_500_superelevation_elevation", [1, 0, 100, 0, 0, 0], "border 4, driving 2"),
    ("esmini/straight_500_superelevation_elevation_curve", [1, 0, 100, 0, 0, 0], "border 4, driving 2"),
    ("esmini/straight_500m", [1, 0, 100, 0, 0, 0], "border 2, driving 2, shoulder 2"),
    ("esmini/straight_500m_roadmarks", [1, 0, 100, 0, 0, 0], "border 4, driving 2"),
    ("esmini/straight_500m_signs", [1, 0, 100, 19, 0, 0], "border 4, driving 2"),
    ("esmini/straight_500m_signs_lht", [1, 0, 100, 3, 0, 0], "border 4, driving 2"),
    ("esmini/tilted_crest", [1, 0, 2, 0, 0, 0], "driving 1"),
    ("esmini/two_pitched_and_rolled_roads", [2, 0, 4, 0, 0, 0], "driving 4"),
    ("esmini/two_plus_one", [1, 0, 160, 0, 0, 0], "driving 17"),
    ("esmini/two_roads_overhang", [2, 0, 2, 0, 0, 0], "driving 2"),
    ("esmini/velodrome", [1, 0, 600, 0, 0, 0], "driving 3"),
    ("maliput/ArcLaneRolledAndOffset", [1, 0, 20, 0, 0, 0], "driving 2"),
    ("maliput/BikingLineLane", [1, 0, 20, 0, 0, 0], "driving 2, shoulder 2, sidewalk 2, biking 1"),
    ("maliput/ComplexLaneSection", [1, 0, 2, 0, 0, 0], "none 4, driving 3"),
    ("maliput/Crossing8Course", [18, 1, 241, 20, 0, 4], "driving 24, border 20, none 20, sidewalk 16"),
    ("maliput/DisconnectedRoadInJunction", [2, 1, 10, 0, 0, 0], "driving 2"),
    ("maliput/Figure8", [22, 1, 291, 0, 0, 0], "driving 48, sidewalk 40, shoulder 20"),
    ("maliput/GapInElevationNonDrivableRoad", [1, 0, 0, 0, 0, 0], "shoulder 1"),
    ("maliput/GapInLaneWidthDrivableLane", [1, 0, 10, 0, 0, 0], "driving 1"),
    ("maliput/GapInSuperelevationNonDrivableRoad", [1, 0, 0, 0, 0, 0], "sidewalk 1"),
    ("maliput/LeftRightSidedRoads", [2, 0, 40, 0, 0, 0], "driving 4, sidewalk 2"),
    ("maliput/LineMultipleSpeeds", [1, 0, 10, 0, 0, 0], "driving 3"),
    ("maliput/LineVariableOffset", [1, 0, 60, 0, 0, 0], "driving 6"),
    ("maliput/LineVariableWidth", [1, 0, 60, 0, 0, 0], "driving 6"),
    ("maliput/MultipleLanesRoadDifferentMarkings", [1, 0, 20, 0, 0, 0], "driving 2, shoulder 2, sidewalk 2"),
    ("maliput/ParametricCubicCurveRoad", [1, 0, 26, 0, 0, 0], "driving 2"),
    ("maliput/ParkingGarageRamp", [1, 0, 25, 0, 0, 0], "driving 2"),
    ("maliput/RoadWithAllDeviceTypes", [1, 0, 40, 2, 0, 0], "driving 2"),
    ("maliput/RoadWithRoadMarkings", [1, 0, 20, 0, 0, 0], "driving 2"),
    ("maliput/RoadWithStopLine", [1, 0, 20, 0, 0, 0], "driving 2"),
    ("maliput/SShapeSuperelevatedRoad", [1, 0, 109, 0, 0, 0], "driving 4"),
    ("maliput/ShortStraightLanes", [1, 0, 1, 0, 0, 0], "driving 24, border 6"),
    ("maliput/SingleRoadBidirectionalLanes", [1, 0, 20, 3, 0, 0], "driving 2"),
    ("maliput/SingleRoadComplexDescription", [1, 0, 6, 0, 0, 0], "driving 4, shoulder 1"),
    ("maliput/SingleRoadHighCoefficients", [1, 0, 10, 0, 0, 0], "driving 1"),
    ("maliput/SingleRoadOrientationAttributes", [1, 0, 20, 2, 0, 0], "driving 2"),
    ("maliput/SingleRoadPedestrianCrosswalk", [1, 0, 12, 0, 0, 0], "driving 8"),
    ("maliput/SingleRoadTinyGeometry", [1, 0, 4, 0, 0, 0], "driving 3"),
    ("maliput/SpiralRoad", [1, 0, 20, 0, 0, 0], "driving 2"),
    ("maliput/StraightRoadMultipleLaneDirections", [3, 0, 24, 0, 0, 0], "driving 24"),
    ("maliput/TwoRoadsWithRoadObjects", [2, 0, 40, 0, 0, 0], "driving 4"),
    ("maliput/TwoRoadsWithTrafficSigns", [2, 0, 36, 2, 2, 0], "driving 4"),
    ("maliput/curved_intersection", [28, 1, 185, 12, 24, 0], "driving 119, shoulder 41, sidewalk 41, bidirectional 5"),
    ("maliput/figure8_trafficlights", [26, 1, 294, 4, 8, 2], "driving 96, shoulder 48, sidewalk 28"),
    ("scenic/Issue189", [50, 3, 2942, 144, 0, 33], "driving 284, border 74, sidewalk 74, none 32"),
    ("scenic/Issue274", [1, 0, 40, 0, 0, 0], "driving 4"),
    ("scenic/cubetown", [11, 2, 111, 6, 0, 2], "driving 18, sidewalk 2"),
    ("scenic/sample1.1", [36, 3, 992, 15, 0, 0], "border 120, driving 74, parking 6"),
];

/// The name under which the tables list a file: `Town01`, or `folder/name`.
fn listed_name(path: &Path) -> String {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let stem = name.trim_end_matches(".gz").trim_end_matches(".xodr").to_owned();
    match path.parent().and_then(Path::file_name).map(|n| n.to_string_lossy().into_owned()) {
        Some(folder) if folder != "carla" => format!("{folder}/{stem}"),
        _ => stem,
    }
}

#[test]
fn every_file_loads_and_survives_writing_or_says_what_is_wrong() {
    for path in map_files() {
        let name = listed_name(&path);
        let bytes = std::fs::read(&path).expect("readable");
        let broken = BROKEN.iter().find(|(stem, _)| name.ends_with(stem));
        let network = match (read_bytes(&bytes), broken) {
            (Ok(network), None) => network,
            (Err(error), Some((_, word))) => {
                assert!(error.to_string().contains(word), "{name}: {error}");
                continue;
            }
            (Ok(_), Some(_)) => panic!("{name}: must fail"),
            (Err(error), None) => panic!("{name}: {error}"),
        };
        assert!(network.unknown_elements.is_empty(), "{name}: {:?}", network.unknown_elements);
        let again = Network::parse(&write(&network)).expect("our own file");
        let again = Network { warnings: network.warnings.clone(), ..again };
        assert!(again == network, "{name}: not the same after writing");
        // Equality takes 0 and -0 for one, print does not.
        assert!(format!("{again:?}") == format!("{network:?}"), "{name}: not the same to the bit");
    }
}

#[test]
fn every_file_holds_what_was_counted_in_it() {
    let all = map_files();
    if all.is_empty() {
        return;
    }
    let facts: BTreeMap<&str, &Facts> = CARLA.iter().chain(OTHERS).map(|f| (f.0, f)).collect();
    let mut looked_at = 0;
    for path in all {
        let name = listed_name(&path);
        let Some((_, counts, lanes)) = facts.get(name.as_str()) else { continue };
        let network = read_bytes(&std::fs::read(&path).expect("readable")).expect("checked elsewhere");
        looked_at += 1;
        let mut by_type: BTreeMap<&str, usize> = BTreeMap::new();
        let mut driving_m = 0.0;
        for road in &network.roads {
            let ends = road.sections.iter().skip(1).map(|s| s.s).chain([road.length_m]);
            for (section, end) in road.sections.iter().zip(ends) {
                for lane in section.lanes() {
                    *by_type.entry(lane.lane_type.xml()).or_default() += 1;
                    if lane.lane_type == LaneType::Driving {
                        driving_m += end - section.s;
                    }
                }
            }
        }
        let found = [
            network.roads.len(),
            network.junctions.len(),
            // The count was rounded to 10 m, perhaps the other way.
            if (driving_m / 10.0 - counts[2] as f64).abs() < 0.501 {
                counts[2]
            } else {
                driving_m as usize / 10
            },
            network.roads.iter().map(|r| r.signals.len()).sum(),
            network.roads.iter().map(|r| r.signal_references.len()).sum(),
            network.controllers.len(),
        ];
        assert_eq!(
            found, *counts,
            "{name}: roads, junctions, 10 m of driving lane, signals, references, controllers"
        );
        let mut listed: Vec<&str> = lanes.split(", ").collect();
        listed.sort_unstable();
        let mut seen: Vec<String> = by_type.iter().map(|(kind, count)| format!("{kind} {count}")).collect();
        seen.sort_unstable();
        assert_eq!(seen, listed, "{name}");
    }
    assert!(looked_at >= 70, "only {looked_at} files are listed");
}
