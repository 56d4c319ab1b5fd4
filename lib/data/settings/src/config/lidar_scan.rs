//! The keys that say how a lidar's beams leave and what comes back of them.

use crate::{BeamSpec, Returned, RollingScan, WeatherSpec};

use crate::reader::Section;

/// Moments of a rolling scan where nothing else is said.
const SLICES: u32 = 64;
/// Reflectance that is just detected at the reach where nothing else is said.
const DETECTED: f64 = 0.1;

pub(super) fn rolling(s: &Section<'_>, columns: u32) -> Option<RollingScan> {
    let doc = "rays leave over the frame, the last column at the frame's time, while agent and objects move; else all at once";
    let rolls = s.flag("rolling", false, doc);
    let doc =
        "with `rolling`: moments at which rays leave, at most one a column; neighbouring columns share one";
    let slices = s.integer("rolling_slices", SLICES.into(), 1, 65_536, doc) as u32;
    let doc = "with `rolling`: points are given from where the sensor is at the frame's time (its motion taken out), not from \
               where it was when the ray left";
    let compensated = s.flag("rolling_compensated", true, doc);
    if rolls && slices > columns {
        let message = format!("`{}` is {slices}, there are {columns} columns", s.path_of("rolling_slices"));
        s.fault_at_any(&["rolling_slices", "columns"], message);
    }
    rolls.then_some(RollingScan { slices, compensated })
}

pub(super) fn beam(s: &Section<'_>, d: &BeamSpec, has_echoes: bool) -> BeamSpec {
    let doc = "rays a beam: 1 along its axis, or 7 over its cross-section, whose surfaces 1 m apart make echoes of their own";
    let rays = s.integer("beam_rays", d.rays.into(), 1, 7, doc) as u32;
    if !BeamSpec::RAYS.contains(&rays) {
        s.fault_at("beam_rays", format!("`{}` is {rays}, expected 1 or 7", s.path_of("beam_rays")));
    }
    let divergence_mrad = s.number(
        "beam_divergence_mrad",
        1e3 * d.divergence_rad,
        0.01,
        50.0,
        "full angle of a beam with `beam_rays` 7 or `weather`, mrad",
    );
    let doc = "which echoes of a beam are returned: `first`, `strongest`, `last`; one that is several of these comes once";
    let words = s.texts("returns", &["strongest".to_owned()], doc);
    let path = s.path_of("returns");
    let wanted = |word: &str| words.iter().any(|w| w == word);
    let returned = Returned { first: wanted("first"), strongest: wanted("strongest"), last: wanted("last") };
    let known = |word: &String| ["first", "strongest", "last"].contains(&word.as_str());
    if let Some(word) = words.iter().find(|word| !known(word)) {
        s.fault_at("returns", format!("`{path}`: `{word}` is none of first, strongest, last"));
    } else if words.is_empty() {
        s.fault_at("returns", format!("`{path}` is empty: the lidar would return nothing"));
    } else if returned != d.returned && rays == 1 && !has_echoes {
        let message =
            format!("`{path}`: a beam has one echo; set beam_rays = 7, weather = true or glass = true, too");
        s.fault_at("returns", message);
    }
    BeamSpec { rays, divergence_rad: 1e-3 * divergence_mrad, returned }
}

pub(super) fn weather(s: &Section<'_>) -> Option<WeatherSpec> {
    let doc = "rain and fog of the scene weaken echoes and send light back themselves, and wet ground sends back less; not for the \
               semantic lidar";
    let feels = s.flag("weather", false, doc);
    let doc = "with `weather`: reflectance of the surface, met straight on in clear air at `range_m`, whose echo is just detected";
    let detected = s.number("weather_detected", DETECTED, 0.001, 1.0, doc);
    feels.then_some(WeatherSpec { detected })
}

pub(super) fn glass(s: &Section<'_>) -> bool {
    let doc = "light passes the panes of vehicles within 50 m of the agent; returns from behind them are of a kind of their own";
    s.flag("glass", false, doc)
}
