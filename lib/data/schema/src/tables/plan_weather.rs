//! Weather that a scene has between its beginning and its end.

use super::plan::PlanSceneRow;
use super::weather::Weather;
use crate::table;

table! {
    /// One row per keyframe of a scene's weather between its beginning and its end; there is none without
    /// `weather.keyframes`. Values move evenly from `initial_weather` of `plan/scenes` over these rows to
    /// `final_weather`.
    PlanWeatherRow in "plan/weather" by "spawn-planner" {
        /// Scene number.
        scene: u32,
        /// When, s: `initial_weather` is at 0, `final_weather` at `duration_s`, frame k at 0.05 (k + 1).
        at_s: f64,
        /// Weather then: fields named as the weather columns of `log/frames`.
        weather: Weather,
    }
}

impl PlanSceneRow {
    /// The weather of a frame, -1 being the one before frame 0. `between` are the scene's keyframes, by time.
    #[must_use]
    pub fn weather_at(&self, between: &[PlanWeatherRow], frame: i32) -> Weather {
        let (initial, last) = (self.initial_weather, self.final_weather);
        if !self.dynamic_weather {
            return initial;
        }
        // Frame 0 has moved one part already; the last frame has the final weather.
        let share = (f64::from(frame) + 1.0) / f64::from(self.frames.max(1));
        if between.is_empty() {
            return initial.mix(&last, share);
        }
        let at_s = share * self.duration_s;
        let inner = between.iter().map(|row| (row.at_s, row.weather));
        let course: Vec<(f64, Weather)> =
            std::iter::once((0.0, initial)).chain(inner).chain([(self.duration_s, last)]).collect();
        let leg = course.windows(2).find(|leg| at_s <= leg[1].0);
        let leg = leg.unwrap_or(&course[course.len() - 2..]);
        let ((from_s, from), (to_s, to)) = (leg[0], leg[1]);
        let share = if to_s > from_s { (at_s - from_s) / (to_s - from_s) } else { 1.0 };
        from.mix(&to, share.clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloudy(cloudiness: f64) -> Weather {
        Weather { cloudiness, ..Weather::default() }
    }

    fn scene() -> PlanSceneRow {
        PlanSceneRow {
            duration_s: 2.0,
            frames: 40,
            dynamic_weather: true,
            initial_weather: cloudy(10.0),
            final_weather: cloudy(50.0),
            ..PlanSceneRow::default()
        }
    }

    #[test]
    fn weather_goes_over_its_keyframes() {
        let row = |at_s, cloudiness| PlanWeatherRow { scene: 0, at_s, weather: cloudy(cloudiness) };
        let between = [row(0.5, 90.0), row(1.5, 0.0)];
        let at = |frame| scene().weather_at(&between, frame).cloudiness;
        // Frames 9 and 29 are 0.5 and 1.5 s after the initial weather.
        for (frame, want) in [(-1, 10.0), (4, 50.0), (9, 90.0), (19, 45.0), (29, 0.0), (34, 25.0), (39, 50.0)]
        {
            assert!((at(frame) - want).abs() < 1e-9, "frame {frame}: {}", at(frame));
        }
        let still = PlanSceneRow { dynamic_weather: false, ..scene() };
        assert_eq!(still.weather_at(&between, 20).cloudiness, 10.0);
    }

    #[test]
    fn without_keyframes_it_goes_straight_from_one_to_the_other() {
        for frame in -1..40 {
            let want = cloudy(10.0).mix(&cloudy(50.0), (f64::from(frame) + 1.0) / 40.0);
            assert_eq!(scene().weather_at(&[], frame), want);
        }
    }
}
