//! What the log tells about drivers and lights is what they do.

use crate::common::{agents_on, crossing, run, scene, settings};
use opendrive::Map;
use schema::{ActorRole, Attribute, SignalState};
use traffic::SimulationLog;

fn logged(map: &Map, seconds: f64) -> SimulationLog {
    let mut scene = scene(seconds);
    scene.background_vehicles = Some(30);
    let mut settings = settings();
    settings.traffic.reckless_background = 0.2;
    settings.traffic.distracted_background = 0.2;
    run(map, &scene, &agents_on(map, 2, 1), &settings)
}

#[test]
fn signal_groups_foretell_every_light() {
    let town = town::generate(&town::named("convoy/demo").expect("our town")).expect("a town");
    for map in [crossing(true), Map::new(town)] {
        let log = logged(&map, 60.0);
        let all: Vec<&String> = log.signal_groups.iter().flat_map(|g| &g.signals).collect();
        assert!(log.signal_groups.iter().all(|g| (4.0..28.0).contains(&g.green_time_s)));
        assert_eq!(all.len(), map.signals().iter().filter(|s| s.dynamic).count());
        let mut green = 0;
        for row in &log.signals {
            let group = log.signal_groups.iter().find(|g| g.signals.contains(&row.opendrive_id));
            let group = group.expect("a group");
            // The warm-up of 2 s comes before frame 0.
            let since = (2.0 + 0.05 * f64::from(row.frame)) % group.cycle_s - group.start_s;
            let edge =
                [0.0, group.green_time_s, group.green_time_s + 3.0].iter().any(|e| (since - e).abs() < 1e-6);
            let want = match since {
                s if s < 0.0 => SignalState::Red,
                s if s < group.green_time_s => SignalState::Green,
                s if s < group.green_time_s + 3.0 => SignalState::Yellow,
                _ => SignalState::Red,
            };
            assert!(row.state == want || edge, "{row:?} in {group:?}");
            green += u32::from(want == SignalState::Green);
        }
        assert!(green > 500, "{green}");
    }
}

#[test]
fn drivers_are_those_of_the_background_vehicles() {
    let map = crossing(true);
    let log = logged(&map, 1.0);
    let vehicles: Vec<_> = log.actors.iter().filter(|a| a.role == ActorRole::Background).collect();
    assert!(vehicles.len() > 10 && log.drivers.len() == vehicles.len());
    for (driver, vehicle) in log.drivers.iter().zip(vehicles) {
        let says = |word: Attribute| vehicle.attributes.is_true(&word);
        assert_eq!(driver.id, vehicle.id);
        assert_eq!(
            (driver.reckless, driver.distracted),
            (says(Attribute::Reckless), says(Attribute::Distracted))
        );
        assert!((-0.4..0.2).contains(&driver.speed_difference) && driver.standstill_gap_m >= 1.0);
    }
    let count =
        |of: fn(&schema::scene_info::DriverInfo) -> bool| log.drivers.iter().filter(|d| of(d)).count();
    assert_eq!(count(|d| d.reckless), log.n_reckless as usize);
    assert_eq!(count(|d| d.distracted), log.n_distracted as usize);
}
