//! Background vehicles and drivers.

use serde::Serialize;

/// Background vehicles and drivers. Probabilities are 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrafficSettings {
    /// Background vehicles per scene; drawn when absent.
    pub vehicles: Option<u32>,
    /// Speed below the limit as a share of it, for every driver; drawn per driver from -0.4..0.2 when absent.
    pub speed_difference: Option<f64>,
    /// Gap to a standing leader, metres; drawn per driver from N(4.2, 1) when absent.
    pub standstill_gap_m: Option<f64>,
    /// Green time of every signal, seconds; drawn per signal from 4..28 when absent.
    pub green_time_s: Option<f64>,
    /// Yellow time, seconds (3).
    pub yellow_time_s: f64,
    /// All-red time between two greens, seconds (2).
    pub all_red_time_s: f64,
    /// Chance that a data-collection driver is reckless (0.01): sees no lights, signs, vehicles, walkers.
    pub reckless_agent: f64,
    /// The same for background drivers (0.01).
    pub reckless_background: f64,
    /// Chance that a data-collection driver who is not reckless is distracted (0.02): sees no lights, signs.
    pub distracted_agent: f64,
    /// The same for background drivers (0.02).
    pub distracted_background: f64,
    /// Whether traffic is under way when the simulation begins, each vehicle at its speed, rather than at rest (false).
    pub moving_start: bool,
    /// Whether the cycles of traffic lights begin at drawn times before the simulation, each junction at its own, rather than
    /// all with it (false).
    pub signal_offsets: bool,
    /// Chances that a driver overlooks, drawn anew in every step of 50 ms: lights (0.001),
    pub ignore_lights: f64,
    /// signs, lines without lights, and what lies about in road works (0.001),
    pub ignore_signs: f64,
    /// vehicles (0.001),
    pub ignore_vehicles: f64,
    /// walkers (0.001). What asks for hard braking is seen, and no line passed, until it has been overlooked for a second.
    pub ignore_walkers: f64,
    /// Chance that an emergency vehicle in traffic has its lights flashing (0.5).
    pub emergency_lights: f64,
    /// Chance that a background vehicle that comes to a stop opens a door (0.1).
    pub door_open: f64,
    /// Chance that a background vehicle is a tractor unit with a semi-trailer, where the way on is wide enough for one (0.02).
    pub articulated_lorries: f64,
    /// Chance that a bus in the background is an articulated one, there (0.3).
    pub articulated_buses: f64,
    /// Actors are placed within this distance of any agent, metres; from the duration when absent.
    pub spawn_radius_m: Option<f64>,
    /// Background vehicles and walkers farther than this from every agent vehicle sleep, metres (1600).
    pub active_distance_m: f64,
}

impl Default for TrafficSettings {
    fn default() -> Self {
        Self {
            vehicles: None,
            speed_difference: None,
            standstill_gap_m: None,
            green_time_s: None,
            yellow_time_s: 3.0,
            all_red_time_s: 2.0,
            reckless_agent: 0.01,
            reckless_background: 0.01,
            distracted_agent: 0.02,
            distracted_background: 0.02,
            moving_start: false,
            signal_offsets: false,
            ignore_lights: 0.001,
            ignore_signs: 0.001,
            ignore_vehicles: 0.001,
            ignore_walkers: 0.001,
            emergency_lights: 0.5,
            door_open: 0.1,
            articulated_lorries: 0.02,
            articulated_buses: 0.3,
            spawn_radius_m: None,
            active_distance_m: 1600.0,
        }
    }
}
