//! Accidents and road works: how many, where and how long.

use std::collections::BTreeMap;

use catalogue::{Special, models::find};
use nalgebra::Point3;
use opendrive::{LaneType, Map};
use plan::{Plan, PlanMap, SpawnPool, plan};
use schema::HazardKind;
use schema::tables::PlanHazardRow;
use settings::stages::PlanSettings;
use settings::{SceneCount, Split};
use testkit::both_ways;

/// A straight road to the east with a lane each way.
fn road(length_m: f64) -> Map {
    testkit::map(vec![testkit::road(
        "main street",
        [0.0; 2],
        0.0,
        length_m,
        both_ways(&[(LaneType::Driving, 3.5)]),
    )])
}

fn planned(map: Map, scenes: u32, change: impl FnOnce(&mut PlanSettings)) -> Plan {
    let maps = BTreeMap::from([("road".to_owned(), PlanMap { map, hash: String::new() })]);
    let wish = SceneCount { split: Split::Train, map: "road".into(), count: scenes };
    let mut settings = PlanSettings::with_scenes(vec![wish]);
    settings.agents.max_rsus = 0;
    change(&mut settings);
    plan(&settings, &maps).expect("a plan")
}

/// Metres from back to front along the road, in the direction of travel.
fn length_m(hazard: &PlanHazardRow) -> f64 {
    let way = hazard.front_xyz_m[0] - hazard.back_xyz_m[0];
    if hazard.back_lane < 0 { way } else { -way }
}

fn stretch_m(model: &str) -> f64 {
    match model.split('.').next() {
        Some("car") => 6.0,
        Some("truck" | "van") => 10.0,
        Some("bus") => 12.0,
        Some("motorcycle") => 4.0,
        Some("bicycle") => 2.0,
        other => panic!("{other:?} is no vehicle"),
    }
}

#[test]
fn as_many_are_tried_as_the_places_say() {
    let map = road(3000.0);
    let pool = SpawnPool::new(&map, 24.0);
    let plan = planned(map, 60, |s| s.hazards.share = 0.1);
    for scene in &plan.scenes {
        let agents: Vec<Point3<f64>> =
            plan.agents.iter().filter(|a| a.scene == scene.scene).map(|a| a.xyz_m.into()).collect();
        let fits = |p: &Point3<f64>| {
            let nearest = agents.iter().map(|a| (a - p).norm()).fold(f64::INFINITY, f64::min);
            nearest > 12.0 && nearest < scene.spawn_radius_m
        };
        let places = pool.points.iter().filter(|p| fits(&p.xyz_m)).count();
        assert_eq!(scene.hazard_attempts, (places as f64 * 0.1).round_ties_even() as u32);
        let hazards: Vec<_> = plan.hazards.iter().filter(|h| h.scene == scene.scene).collect();
        assert!(hazards.len() <= scene.hazard_attempts as usize);
        for (i, hazard) in hazards.iter().enumerate() {
            assert_eq!(hazard.hazard, i as u32);
            // No end lies on another hazard's opposite end.
            for other in
                hazards.iter().filter(|o| o.hazard != hazard.hazard && o.back_lane == hazard.back_lane)
            {
                let apart = |a: [f64; 3], b: [f64; 3]| (a[0] - b[0]).abs();
                let accident = hazard.kind == HazardKind::Accident && other.hazard < hazard.hazard;
                assert!(!accident || apart(hazard.front_xyz_m, other.back_xyz_m) >= 12.0 - 1e-9);
                assert!(!accident || apart(hazard.back_xyz_m, other.front_xyz_m) >= 12.0 - 1e-9);
            }
        }
    }
    assert!(plan.hazards.len() > 300);
    assert!(planned(road(3000.0), 5, |s| s.hazards.share = 0.0).hazards.is_empty());
}

#[test]
fn accidents_are_as_long_as_their_vehicles() {
    let plan = planned(road(3000.0), 1500, |s| s.hazards.accident_share = 1.0);
    let (mut emergencies, count) = (0, plan.hazards.len());
    assert!(count > 1000, "{count}");
    for hazard in &plan.hazards {
        assert_eq!((hazard.kind, hazard.items), (HazardKind::Accident, 0));
        let special = |m: &String| find(m).expect("a model").special == Special::Emergency;
        let [front, rear] = [&hazard.models[0], &hazard.models[1]];
        assert!(!special(front) && !special(rear));
        let tail_m = match hazard.models.get(2) {
            Some(vehicle) => {
                assert!(special(vehicle));
                emergencies += 1;
                stretch_m(vehicle)
            }
            None => 2.0,
        };
        let expected = stretch_m(front) + stretch_m(rear) + tail_m;
        assert!((length_m(hazard) - expected).abs() < 1e-6, "{hazard:?}");
        assert_eq!((hazard.back_road.as_str(), hazard.front_lane), ("main street", hazard.back_lane));
        assert!((hazard.back_s_m - hazard.back_xyz_m[0]).abs() < 1e-6);
    }
    // Half of them; four standard errors.
    let share = f64::from(emergencies) / count as f64;
    assert!((share - 0.5).abs() < 2.0 / (count as f64).sqrt(), "{share}");
}

#[test]
fn road_works_are_as_long_as_published() {
    // One try a scene on a road where nothing is in the way.
    let plan = planned(road(6000.0), 4000, |s| {
        s.hazards.accident_share = 0.0;
        s.hazards.share = 0.02;
        s.traffic.spawn_radius_m = Some(500.0);
        (s.agents.min_vehicles, s.agents.max_vehicles) = (1, 1);
    });
    let clear: Vec<&PlanHazardRow> = plan
        .hazards
        .iter()
        .filter(|h| {
            let alone = plan.scenes[h.scene as usize].hazard_attempts <= 2;
            let agent = plan.agents.iter().find(|a| a.scene == h.scene).expect("an agent");
            let ahead_m = (agent.xyz_m[0] - h.back_xyz_m[0]) * if h.back_lane < 0 { 1.0 } else { -1.0 };
            let to_end_m = if h.back_lane < 0 { 6000.0 - h.back_xyz_m[0] } else { h.back_xyz_m[0] };
            alone && h.hazard == 0 && ahead_m < -12.0 && to_end_m > 500.0
        })
        .collect();
    let n = clear.len() as f64;
    assert!(n > 1000.0, "{n}");
    let items = clear.iter().map(|h| f64::from(h.items)).sum::<f64>() / n;
    // Geometric with 26 in 27: mean 26, standard deviation 26.5.
    assert!((items - 26.0).abs() < 4.0 * 26.5 / n.sqrt(), "{items}");
    let mut lengths: Vec<f64> = clear.iter().map(|h| length_m(h)).collect();
    lengths.sort_by(f64::total_cmp);
    let mean = lengths.iter().sum::<f64>() / n;
    // 2 m and 26 items of (19 x 1.0 + 7 x 2.4) / 26 m on the average: 37.8 m.
    assert!((mean - 37.8).abs() < 4.0 * 37.0 / n.sqrt(), "{mean}");
    let at = |share: f64| lengths[(share * n) as usize];
    assert!((at(0.5) - 26.0).abs() < 3.5 && (at(0.9) - 85.0).abs() < 10.0, "{} {}", at(0.5), at(0.9));
}

#[test]
fn hazards_of_both_kinds_keep_their_share() {
    let plan = planned(road(3000.0), 2000, |_| {});
    let accidents = plan.hazards.iter().filter(|h| h.kind == HazardKind::Accident).count() as f64;
    let works = plan.hazards.iter().filter(|h| h.kind == HazardKind::RoadWorks).count() as f64;
    let tried: u32 = plan.scenes.iter().map(|s| s.hazard_attempts).sum();
    // Equally likely; the two kinds find room alike on this road.
    assert!((accidents / (accidents + works) - 0.5).abs() < 0.04, "{accidents} {works}");
    assert!(accidents + works > 0.85 * f64::from(tried), "{tried}");
}
