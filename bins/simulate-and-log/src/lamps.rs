//! The lights of the scenery: which street lamps have failed, how bright the others are, the colour of
//! windows.

use random::Stream;
use schema::lights::{STREET_LAMP_LM, STREET_LAMP_RGB, WINDOW_RGB};
use schema::tables::{ActorRow, LampRow, PlanSceneRow};
use schema::{ActorKind, LampKind};
use settings::LightSettings;

/// One row per street lamp and building, ascending by id; failed lamps are marked among the actors, too.
///
/// Each lamp draws from its own stream, so one more house changes no lamp's fate but by the ids.
pub(crate) fn draw(actors: &mut [ActorRow], plan: &PlanSceneRow, settings: &LightSettings) -> Vec<LampRow> {
    let stream =
        |topic, actor: &ActorRow| Stream::new(plan.seed, u64::from(plan.scene), topic, u64::from(actor.id));
    let flux_lm = (STREET_LAMP_LM + plan.street_light_change_lm).max(settings.min_intensity_lm);
    let mut rows = Vec::new();
    for actor in actors.iter_mut() {
        if catalogue::street_lamps::is_street_lamp(actor) {
            let works = !stream("lights/failure", actor).chance(settings.street_lamp_failure);
            if !works {
                catalogue::street_lamps::mark_failed(actor);
            }
            let (kind, color) = (LampKind::Street, STREET_LAMP_RGB.to_vec());
            rows.push(LampRow { id: actor.id, kind, works, flux_lm: Some(flux_lm), color });
        } else if actor.kind == ActorKind::Building {
            let mut draw = stream("lights/building", actor);
            let color = if plan.random_building_colors {
                (0..3).map(|_| draw.int_inclusive(0, 255) as u8).collect()
            } else {
                WINDOW_RGB.to_vec()
            };
            rows.push(LampRow { id: actor.id, kind: LampKind::Building, works: true, flux_lm: None, color });
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lamps and buildings in turn.
    fn town(count: u16) -> Vec<ActorRow> {
        let actor = |id: u16| {
            let (kind, model) = if id % 2 == 1 {
                (ActorKind::Pole, "pole.lamp")
            } else {
                (ActorKind::Building, "building.a")
            };
            ActorRow { id, kind, model: model.into(), ..ActorRow::default() }
        };
        (1..=count)
            .map(actor)
            .chain([ActorRow { id: count + 1, kind: ActorKind::Sign, ..ActorRow::default() }])
            .collect()
    }

    fn plan(change_lm: f64, random_building_colors: bool) -> PlanSceneRow {
        PlanSceneRow {
            scene: 3,
            seed: 30,
            street_light_change_lm: change_lm,
            random_building_colors,
            ..PlanSceneRow::default()
        }
    }

    #[test]
    fn lamps_fail_at_their_rate_and_the_world_knows() {
        let mut actors = town(8000);
        let rows = draw(&mut actors, &plan(0.0, false), &LightSettings::default());
        assert_eq!(rows.len(), 8000);
        let failed: Vec<u16> = rows.iter().filter(|r| !r.works).map(|r| r.id).collect();
        // 4000 lamps at 10 %: 400, four standard errors are 76.
        assert!((324..=476).contains(&failed.len()), "{}", failed.len());
        let marked: Vec<u16> = actors.iter().filter(|a| a.variant != 0).map(|a| a.id).collect();
        assert_eq!(failed, marked);
        for (share, count) in [(0.0, 0), (1.0, 4000)] {
            let settings = LightSettings { street_lamp_failure: share, ..LightSettings::default() };
            let rows = draw(&mut town(8000), &plan(0.0, false), &settings);
            assert_eq!(rows.iter().filter(|r| !r.works).count(), count);
        }
    }

    #[test]
    fn the_change_is_common_and_has_a_floor() {
        let flux = |change: f64| {
            let rows = draw(&mut town(20), &plan(change, false), &LightSettings::default());
            let lamps: Vec<f64> = rows.iter().filter_map(|r| r.flux_lm).collect();
            assert!(lamps.len() == 10 && lamps.iter().all(|f| *f == lamps[0]));
            lamps[0]
        };
        assert_eq!([flux(0.0), flux(5000.0), flux(-5000.0), flux(-2e6)], [20e3, 25e3, 15e3, 10e3]);
    }

    #[test]
    fn windows_have_random_colours_when_planned_so() {
        let colors = |random| -> Vec<Vec<u8>> {
            let rows = draw(&mut town(4000), &plan(0.0, random), &LightSettings::default());
            rows.into_iter().filter(|r| r.kind == LampKind::Building).map(|r| r.color).collect()
        };
        assert!(colors(false).iter().all(|c| *c == WINDOW_RGB));
        let drawn = colors(true);
        for k in 0..3 {
            // Mean 127.5, standard deviation 73.9.
            let mean = drawn.iter().map(|c| f64::from(c[k])).sum::<f64>() / drawn.len() as f64;
            assert!((mean - 127.5).abs() < 6.7, "{mean}");
        }
        assert_ne!(drawn[0], drawn[1]);
    }
}
