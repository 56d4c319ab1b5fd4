//! Background vehicles and drivers.

use crate::key::settings;

settings! {
    /// Background vehicles and drivers. Probabilities are 0 to 1.
    pub struct TrafficSettings {
        /// Background vehicles in a scene.
        vehicles: Option<u32> = None, within(0..=20_000), or("drawn from the free spawn points"), yaml("n_vehicles");
        /// Speed below the limit as a share of it (negative: faster), for every driver.
        speed_difference: Option<f64> = None, within(-2.0..=0.95), or("drawn per driver, -0.4 to 0.2"), yaml_percent("speed_difference");
        /// Gap to a standing leader, m. No vehicle comes nearer than 0.5.
        standstill_gap_m: Option<f64> = None, within(0.0..=50.0), or("drawn per driver, N(4.2, 1)"), yaml("distance_to_leading");
        /// Green time of every signal, s.
        green_time_s: Option<f64> = None, within(1.0..=600.0), or("drawn per signal, 4 to 28"), yaml("green_time");
        /// Yellow time, s.
        yellow_time_s: f64 = 3.0, within(0.5..=10.0);
        /// All-red time between two greens, s.
        all_red_time_s: f64 = 2.0, within(0.0..=20.0);
        /// Share of data-collection drivers who see no lights, signs, vehicles, walkers.
        reckless_agent: f64 = 0.01, share(), yaml_percent("reckless_ego_percentage");
        /// The same for background drivers.
        reckless_background: f64 = 0.01, share(), yaml_percent("reckless_npc_percentage");
        /// Share of the other data-collection drivers who see no lights and signs.
        distracted_agent: f64 = 0.02, share(), yaml_percent("distracted_ego_percentage");
        /// The same for background drivers.
        distracted_background: f64 = 0.02, share(), yaml_percent("distracted_npc_percentage");
        /// Traffic is under way when the simulation begins, each vehicle at its speed, rather than at rest.
        moving_start: bool = false;
        /// The lights of each junction begin their cycle at a drawn time before the simulation, rather than
        /// all with it.
        signal_offsets: bool = false;
        /// Chance that a driver overlooks a light in a step of 50 ms: it then drives on for the step, but
        /// passes no line, and still sees what asks for hard braking, until it has overlooked lights for 1 s
        /// on end; at 1 it sees none.
        ignore_lights: f64 = 0.001, share(), yaml_percent("ignore_lights_percentage");
        /// The same for signs, lines without lights, and cones, barriers and all else that lies in road
        /// works.
        ignore_signs: f64 = 0.001, share(), yaml_percent("ignore_signs_percentage");
        /// The same for other vehicles.
        ignore_vehicles: f64 = 0.001, share(), yaml_percent("ignore_vehicles_percentage");
        /// The same for walkers.
        ignore_walkers: f64 = 0.001, share(), yaml_percent("ignore_walkers_percentage");
        /// Chance that an emergency vehicle in traffic has its lights flashing.
        emergency_lights: f64 = 0.5, share(), yaml_percent("emergency_lights_percentage");
        /// Chance that a background vehicle opens a door when it comes to a stop.
        door_open: f64 = 0.1, share(), yaml_percent("door_open_percentage");
        /// Chance that a background vehicle is a tractor unit with a semi-trailer, where the way on is wide
        /// enough for one.
        articulated_lorries: f64 = 0.02, share();
        /// Chance that a bus in the background is an articulated one, there.
        articulated_buses: f64 = 0.3, share();
        /// Background actors start within this distance of a data-collection vehicle, m.
        spawn_radius_m: Option<f64> = None, within(10.0..=20_000.0), or("from the duration");
        /// Background actors farther than this from every data-collection vehicle stand still, on any map, m.
        active_distance_m: f64 = 1600.0, within(1.0..=100_000.0);
    }
}
