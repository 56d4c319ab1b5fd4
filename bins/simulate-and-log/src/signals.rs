//! What boxes say of traffic lights: the times of their program, and their number at their junction.

use std::collections::BTreeMap;

use opendrive::Map;
use schema::scene_info::SignalGroupInfo;
use schema::tables::ActorRow;
use schema::{ActorKind, Attribute};
use settings::TrafficSettings;

/// Adds the facts of their programs to the traffic lights among some actors.
pub(crate) fn describe(
    map: &Map,
    programs: &[SignalGroupInfo],
    settings: &TrafficSettings,
    actors: &mut [ActorRow],
) {
    let greens: BTreeMap<&str, f64> = programs
        .iter()
        .flat_map(|program| program.signals.iter().map(|id| (id.as_str(), program.green_time_s)))
        .collect();
    let mut at_junction: BTreeMap<Option<usize>, u32> = BTreeMap::new();
    let mut numbers: BTreeMap<&str, u32> = BTreeMap::new();
    for signal in map.signals().iter().filter(|s| s.dynamic) {
        let next = at_junction.entry(signal.junction).or_default();
        numbers.insert(&signal.id, *next);
        *next += 1;
    }
    for actor in actors.iter_mut().filter(|a| a.kind == ActorKind::TrafficLight) {
        let Some(id) = actor.opendrive_id.as_deref() else { continue };
        let facts = &mut actor.attributes;
        if let Some(green_s) = greens.get(id) {
            facts.say(Attribute::GreenTime, format_args!("{green_s:.3}"));
            facts.say(Attribute::YellowTime, settings.yellow_time_s);
            facts.say(Attribute::RedTime, settings.all_red_time_s);
        }
        if let Some(number) = numbers.get(id) {
            facts.say(Attribute::PoleIndex, number);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_say_their_times_and_numbers() {
        let map = testkit::crossing(true);
        let lights: Vec<_> = map.signals().iter().filter(|s| s.dynamic).collect();
        assert!(lights.len() > 2);
        let mut actors: Vec<ActorRow> = lights
            .iter()
            .map(|s| ActorRow {
                kind: ActorKind::TrafficLight,
                opendrive_id: Some(s.id.clone()),
                ..ActorRow::default()
            })
            .collect();
        let program = SignalGroupInfo {
            signals: vec![lights[1].id.clone()],
            green_time_s: 12.34567,
            ..SignalGroupInfo::default()
        };
        let settings =
            TrafficSettings { yellow_time_s: 3.0, all_red_time_s: 2.5, ..TrafficSettings::default() };
        describe(&map, &[program], &settings, &mut actors);
        let facts = |i: usize| actors[i].attributes.to_string();
        assert_eq!(
            facts(1),
            r#"{"green_time":"12.346","yellow_time":"3","red_time":"2.5","pole_index":"1"}"#
        );
        assert_eq!(facts(0), r#"{"pole_index":"0"}"#, "no program, no times");
    }
}
