//! What is said of plans that other settings are not meant for.

use plan::Plan;
use plan::suspicions::unfelt_weather;
use schema::tables::{PlanSceneRow, PlanWeatherRow, Weather};
use settings::{DatasetSettings, OwnRig, Rig, WeatherSpec};

/// A plan of scenes with these initial and final weathers.
fn plan_of(weathers: &[[Weather; 2]]) -> Plan {
    let scene = |(number, [initial, last]): (u32, &[Weather; 2])| PlanSceneRow {
        scene: number,
        initial_weather: *initial,
        final_weather: *last,
        ..PlanSceneRow::default()
    };
    Plan { scenes: (0..).zip(weathers).map(scene).collect(), ..Plan::default() }
}

fn said(all: &DatasetSettings, plan: &Plan) -> Option<String> {
    let suspicion = unfelt_weather(&|_| &all.scenario, plan).into_iter().next()?;
    assert!(suspicion.message.contains(&format!("`{}`", suspicion.key)), "{suspicion:?}");
    Some(suspicion.message)
}

#[test]
fn rain_and_fog_that_no_lidar_feels_are_said() {
    let fair = Weather::default();
    let rain = Weather { precipitation: 20.0, ..fair };
    let fog = Weather { fog_density: 15.0, ..fair };
    let plan = plan_of(&[[fair; 2], [rain, fair], [fair; 2], [fair, fog]]);
    let mut all = DatasetSettings::default();
    insta::assert_snapshot!(said(&all, &plan).expect("is odd"), @"`vehicle.lidar.weather`, `rsu.lidar.weather` are false, and 2 of 4 scenes have rain or fog (1, 3): these lidars do not feel it; switch it on, or fix `precipitation` and `fog_density` at 0");
    let mut showery = plan_of(&[[fair; 2]]);
    assert_eq!(said(&all, &showery), None);
    showery.weather = vec![PlanWeatherRow { scene: 0, at_s: 1.0, weather: rain }];
    assert!(said(&all, &showery).expect("is odd").contains("1 of 1 scenes have rain or fog (0)"));
    all.scenario.agents.max_rsus = 0;
    let many = plan_of(&[[rain, fair]; 12]);
    insta::assert_snapshot!(said(&all, &many).expect("is odd"), @"`vehicle.lidar.weather` is false, and 12 of 12 scenes have rain or fog (0, 1, 2, 3, 4, 5, 6, 7, ...): these lidars do not feel it; switch it on, or fix `precipitation` and `fog_density` at 0");
    all.scenario.vehicle_rig.lidars[0].weather = Some(WeatherSpec::default());
    assert_eq!(said(&all, &plan), None);
    let own = |rig: Rig| OwnRig { agents: vec!["vehicle_1".into()], rig, occupancy: Default::default() };
    all.scenario.own_rigs = vec![own(all.scenario.vehicle_rig.clone()), own(Rig::vehicle())];
    assert_eq!(
        unfelt_weather(&|_| &all.scenario, &plan).into_iter().next().map(|s| s.key).as_deref(),
        Some("rigs[1].lidar.weather")
    );
    // Labels alone feel no weather, and need not.
    all.scenario.own_rigs[1].rig.lidars[0] = all.scenario.own_rigs[1].rig.lidars[0].semantic();
    assert_eq!(said(&all, &plan), None);
}
