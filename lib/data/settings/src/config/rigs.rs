//! The keys that say what an agent carries.

use std::collections::BTreeSet;

use crate::{
    FillingRule, GnssSpec, ImuSpec, LidarSpec, Mount, OccupancySettings, OwnRig, RadarSpec, Rig, ScanPattern,
    SweepSettings, ZFill,
};
use frames::{deg, to_deg};
use schema::tables::{GNSS_TABLE, IMU_TABLE, VISIBLE_TABLE};
use schema::{AgentId, AgentKind};

use super::cameras::{PICTURES, camera, cameras, pictures};
use super::lidar_scan;
use super::parts::{every_n_frames, mount, names};
use super::table_names::TableNames;
use crate::reader::Section;

/// Names the file that a rig is read from.
pub(crate) const FILE_KEY: &str = "rig";

/// All vehicles, all RSUs.
pub(crate) fn of_kinds(root: &Section<'_>) -> [(Rig, OccupancySettings); 2] {
    let section = |key, doc| over_file(root.section(key, doc));
    [
        vehicle(&section("vehicle", "sensors and voxel grid of every data-collection vehicle")),
        rsu(&section("rsu", "sensors and voxel grid of every RSU")),
    ]
}

/// Lays a rig over the file that it names.
fn over_file(section: Section<'_>) -> Section<'_> {
    let doc = "a file with keys of this table, beside this file; those that stand here go before its own (lists as a whole)";
    section.over_file(FILE_KEY, doc)
}

fn vehicle(s: &Section<'_>) -> (Rig, OccupancySettings) {
    with_grid(s, common(s, &Rig::vehicle()))
}

fn rsu(s: &Section<'_>) -> (Rig, OccupancySettings) {
    with_grid(s, common(s, &Rig::rsu()))
}

fn with_grid(s: &Section<'_>, rig: Rig) -> (Rig, OccupancySettings) {
    let grid = occupancy(s, &rig);
    (rig, grid)
}

/// Rigs that single agents carry instead of those of their kind.
pub(crate) fn own(root: &Section<'_>) -> Vec<OwnRig> {
    let doc = "agents with sensors and voxel grid of their own; besides `agents` all keys of `vehicle` or `rsu`, with \
               the same defaults";
    let agents_of = |item: &Section<'_>| {
        item.texts("agents", &[], "who carries it: `vehicle_0`, `rsu_1`, ... of one kind")
    };
    agents_of(&over_file(root.describe_item("rigs")));
    let mut carriers = BTreeSet::new();
    let read = |item: Section<'_>| {
        let item = &over_file(item);
        let written = agents_of(item);
        let mut agents = Vec::new();
        let path = item.path_of("agents");
        let mut kinds = BTreeSet::new();
        for agent in &written {
            match agent.parse::<AgentId>() {
                Ok(id) => {
                    kinds.insert(id.kind);
                    agents.push(id.to_string());
                }
                Err(_) => {
                    item.fault_at(
                        "agents",
                        format!("`{path}`: `{agent}` is no agent, expected vehicle_N or rsu_N"),
                    );
                }
            }
            if !carriers.insert(agent.clone()) {
                item.fault_at("agents", format!("`{path}`: `{agent}` carries another rig already"));
            }
        }
        if written.is_empty() {
            let problem = "is empty: say which agents carry this rig, such as [\"vehicle_1\"]";
            item.fault_at("agents", format!("`{path}` {problem}"));
        }
        if kinds.len() > 1 {
            item.fault_at("agents", format!("`{path}` names vehicles and RSUs: a rig is for one kind"));
        }
        let (rig, occupancy) = if kinds.contains(&AgentKind::Rsu) { rsu(item) } else { vehicle(item) };
        OwnRig { agents, rig, occupancy }
    };
    root.sections("rigs", "none", doc).unwrap_or_default().into_iter().map(read).collect()
}

fn common(s: &Section<'_>, d: &Rig) -> Rig {
    // Taken on every rig, whatever is switched on: a flag must not turn a good name into a bad one.
    let fixed = [GNSS_TABLE, IMU_TABLE, VISIBLE_TABLE].map(str::to_owned);
    let lidars_tables = d.lidars.iter().flat_map(|l| [l.name.clone(), l.semantic().name]);
    let mut tables = TableNames::new(lidars_tables.chain(fixed));
    let shared = s.section("camera", "what all cameras share");
    let pictures = pictures(&shared, &PICTURES);
    Rig {
        camera: camera(&shared, &d.camera),
        cameras: cameras(s, (&d.cameras, &pictures), &mut tables),
        lidars: lidars(s, &d.lidars[0], &mut tables),
        radars: radars(s, &d.radars, &mut tables),
        gnss: gnss(&s.section("gnss", "GNSS receiver"), d.gnss.is_some()),
        imu: imu(&s.section("imu", "inertial measurement unit"), d.imu.is_some()),
    }
}

/// The lidar that every rig has, and further ones.
fn lidars(s: &Section<'_>, d: &LidarSpec, tables: &mut TableNames) -> Vec<LidarSpec> {
    let mut lidars = lidar(&s.section("lidar", "lidar"), d);
    let doc = "further lidars, each with rays of its own: besides `name` all keys of `lidar`, with the same defaults";
    let sections = s.sections("lidars", "none", doc);
    let further = |item: &Section<'_>| {
        let name =
            item.text("name", "LIDAR_2", "lidar name, part of the file names (semantic: `SEG-` before it)");
        (name.clone(), lidar(item, &LidarSpec { name, ..d.clone() }))
    };
    further(&s.describe_item("lidars"));
    for item in sections.unwrap_or_default() {
        let (name, made) = further(&item);
        tables.take(&item, &name, vec![name.clone(), format!("SEG-{name}")]);
        lidars.extend(made);
    }
    lidars
}

/// A lidar and the semantic one with its rays, as far as they are wanted.
fn lidar(s: &Section<'_>, d: &LidarSpec) -> Vec<LidarSpec> {
    let enabled = s.flag("enabled", true, "write the lidar");
    let semantic = s.flag("semantic", false, "write a semantic lidar with the same rays");
    let channels = s.integer("channels", d.scan.channels.into(), 1, 1024, "beams") as u32;
    let columns =
        s.integer("columns", d.scan.columns.into(), 1, 65_536, "azimuth steps per beam and frame") as u32;
    let degrees = |key, value: f64, low, high, doc| deg(s.number(key, to_deg(value), low, high, doc));
    let upper_rad =
        degrees("upper_fov_deg", d.scan.upper_rad, -90.0, 90.0, "highest beam, degrees above the horizon");
    let lower_rad =
        degrees("lower_fov_deg", d.scan.lower_rad, -90.0, 90.0, "lowest beam, degrees above the horizon");
    let horizontal_fov_rad = degrees(
        "horizontal_fov_deg",
        d.scan.horizontal_fov_rad,
        1.0,
        360.0,
        "horizontal field of view, degrees",
    );
    if lower_rad > upper_rad {
        let keys = ["lower_fov_deg", "upper_fov_deg"];
        s.fault_at_any(&keys, format!("`{}` is above upper_fov_deg", s.path_of("lower_fov_deg")));
    }
    let scan = ScanPattern { channels, columns, upper_rad, lower_rad, horizontal_fov_rad };
    if let Some(problem) = scan.problem() {
        s.fault_at_any(&["columns", "channels"], format!("`{}`: {problem}", s.path()));
    }
    let weather = lidar_scan::weather(s);
    let glass = lidar_scan::glass(s);
    let beam = lidar_scan::beam(s, &d.beam, weather.is_some() || glass);
    let lidar = LidarSpec {
        name: d.name.clone(),
        mount: mount(s, &d.mount),
        scan,
        range_m: s.number("range_m", d.range_m, 1.0, 1000.0, "reach, m"),
        dropoff_rate: s.number("dropoff_rate", d.dropoff_rate, 0.0, 1.0, "share of rays that return nothing"),
        dropoff_intensity_limit: s.number(
            "dropoff_intensity_limit",
            d.dropoff_intensity_limit,
            0.0,
            1.0,
            "returns stronger than this are never dropped for weakness",
        ),
        dropoff_zero_intensity: s.number(
            "dropoff_zero_intensity",
            d.dropoff_zero_intensity,
            0.0,
            1.0,
            "chance that a return of no intensity is dropped",
        ),
        attenuation_per_m: s.number(
            "attenuation_per_m",
            d.attenuation_per_m,
            0.0,
            1.0,
            "loss of intensity, per m",
        ),
        noise_m: s.number("noise_m", d.noise_m, 0.0, 10.0, "standard deviation of the distance, m"),
        semantic: false,
        every_n_frames: every_n_frames(s, "it sweeps"),
        rolling: lidar_scan::rolling(s, columns),
        glass,
        beam,
        weather,
    };
    let doc = "the same of the semantic lidar";
    let semantic_every = s.optional_integer("semantic_every_n_frames", "that of the lidar", 1, 1000, doc);
    let mut lidars = Vec::new();
    if semantic {
        let every_n_frames = semantic_every.map_or(lidar.every_n_frames, |n| n as u32);
        lidars.push(LidarSpec { every_n_frames, ..lidar.semantic() });
    }
    if enabled {
        lidars.insert(0, lidar);
    }
    lidars
}

fn radars(s: &Section<'_>, d: &[RadarSpec], tables: &mut TableNames) -> Vec<RadarSpec> {
    let shared = s.section("radar", "what all radars share");
    let first = &d[0];
    let enabled = shared.flag("enabled", true, "write the radars");
    let range_m = shared.number("range_m", first.range_m, 1.0, 1000.0, "reach, m");
    let degrees = |key, value: f64, doc| deg(shared.number(key, to_deg(value).round(), 0.1, 179.0, doc));
    let horizontal_fov_rad =
        degrees("horizontal_fov_deg", first.horizontal_fov_rad, "width of the cone, degrees");
    let vertical_fov_rad = degrees("vertical_fov_deg", first.vertical_fov_rad, "height of the cone, degrees");
    let rays = shared.integer("rays", first.rays.into(), 1, 1_000_000, "rays per frame") as u32;
    let micro_motion = shared.flag(
        "micro_motion",
        first.micro_motion,
        "velocities are those of the surfaces hit, turning wheels and swinging limbs too, not of the bodies",
    );
    let doc = "signal to noise of a target of 1 m2 at 100 m, dB";
    let snr_db = shared.number("snr_db", first.snr_db, -50.0, 100.0, doc);
    let every_n_frames = every_n_frames(&shared, "they measure");
    let read = |item: &Section<'_>| {
        (item.text("name", "RAD_FRONT", "radar name, part of the file names"), mount(item, &first.mount))
    };
    let sections =
        s.sections("radars", &names(d.iter().map(|r| &r.name)), "radar positions; replaces the default list");
    read(&s.describe_item("radars"));
    let mut take = |item: &Section<'_>, place: (String, Mount)| {
        tables.take(item, &place.0, vec![place.0.clone()]);
        place
    };
    let places: Vec<(String, Mount)> = match sections {
        None => d.iter().map(|r| take(s, (r.name.clone(), r.mount))).collect(),
        Some(list) => list.iter().map(|item| take(item, read(item))).collect(),
    };
    if !enabled {
        return Vec::new();
    }
    places
        .into_iter()
        .map(|(name, mount)| RadarSpec {
            name,
            mount,
            range_m,
            horizontal_fov_rad,
            vertical_fov_rad,
            rays,
            micro_motion,
            snr_db,
            every_n_frames,
        })
        .collect()
}

fn gnss(s: &Section<'_>, carried: bool) -> Option<GnssSpec> {
    let d = GnssSpec::default();
    let enabled = s.flag("enabled", carried, "write GNSS fixes");
    let spec = GnssSpec {
        mount: mount(s, &d.mount),
        noise_deg: [
            s.number(
                "noise_latitude_deg",
                d.noise_deg[0],
                0.0,
                1.0,
                "standard deviation of the latitude, degrees",
            ),
            s.number(
                "noise_longitude_deg",
                d.noise_deg[1],
                0.0,
                1.0,
                "standard deviation of the longitude, degrees",
            ),
        ],
        noise_altitude_m: s.number(
            "noise_altitude_m",
            d.noise_altitude_m,
            0.0,
            100.0,
            "standard deviation of the altitude, m",
        ),
        every_n_frames: every_n_frames(s, "fixes are taken"),
    };
    enabled.then_some(spec)
}

fn imu(s: &Section<'_>, carried: bool) -> Option<ImuSpec> {
    let d = ImuSpec::default();
    let enabled = s.flag("enabled", carried, "write IMU readings");
    let spec = ImuSpec {
        mount: mount(s, &d.mount),
        noise_accel_mps2: s.number(
            "noise_accel_mps2",
            d.noise_accel_mps2,
            0.0,
            10.0,
            "standard deviation of each acceleration, m/s2",
        ),
        gyro_bias_radps: s.number(
            "gyro_bias_radps",
            d.gyro_bias_radps,
            0.0,
            1.0,
            "constant bias of each rate, rad/s",
        ),
        noise_gyro_radps: s.number(
            "noise_gyro_radps",
            d.noise_gyro_radps,
            0.0,
            1.0,
            "standard deviation of each rate, rad/s",
        ),
        every_n_frames: every_n_frames(s, "it is read"),
    };
    enabled.then_some(spec)
}

fn occupancy(parent: &Section<'_>, rig: &Rig) -> OccupancySettings {
    let s = parent.section("occupancy", "voxel grid");
    let d = OccupancySettings::default();
    let settings = OccupancySettings {
        enabled: s.flag("enabled", d.enabled, "write voxel grids"),
        range_m: s.number("range_m", d.range_m, 1.0, 500.0, "reach ahead, behind, left and right, m"),
        voxel_m: s.number("voxel_m", d.voxel_m, 0.02, 5.0, "cell size, m"),
        lower_m: s.number("lower_m", d.lower_m, -100.0, 100.0, "lower face above the grid's origin, m"),
        upper_m: s.number("upper_m", d.upper_m, -100.0, 100.0, "upper face above the grid's origin, m"),
        mount_z_m: s.number(
            "mount_z_m",
            d.mount_z_m,
            -10.0,
            100.0,
            "grid origin above the agent's origin, m",
        ),
        ignore_self: s.flag("ignore_self", d.ignore_self, "leave out the carrying agent's own body"),
        full_sweep: s.flag(
            "full_sweep",
            d.full_sweep,
            "test every cell for what touches it; else sweeps along the grid's axes find what is met first",
        ),
        sweeps: sweeps(&s, &d.sweeps),
        sparse: s.flag(
            "sparse",
            d.sparse,
            "list occupied cells (`occupancy_cells/`) instead of writing whole grids; they are not filled then",
        ),
        ids: s.flag("ids", d.ids, "write whose each occupied cell is (`occupancy_ids/`)"),
        flow: s.flag("flow", d.flow, "write the velocity of each occupied cell (`occupancy_flow/`)"),
        fill_rule: s.choice(
            "fill_rule",
            &FillingRule::ALL.map(|rule| (rule.name(), rule)),
            0,
            "how insides are filled: `chunk` by class in chunks, as SimBEV2X does; `paper` where all six directions meet one \
             label first; `solid` whatever is closed",
        ),
        observed: s.flag(
            "observed",
            d.observed,
            "write which cells the agent's lidars saw free, occupied or not at all (`occupancy_observed/`); one of them must \
             sweep at every frame that has a grid",
        ),
        every_n_frames: every_n_frames(&s, "grids are made"),
    };
    if settings.observed {
        check_observers(parent, &s, rig, settings.every_n_frames);
    }
    if settings.lower_m >= settings.upper_m {
        s.fault_at_any(&["lower_m", "upper_m"], format!("`{}` is not below upper_m", s.path_of("lower_m")));
    } else if let Some(problem) = settings.problem() {
        let keys = ["voxel_m", "range_m", "upper_m", "lower_m"];
        s.fault_at_any(&keys, format!("`{}`: {problem}", s.path()));
    }
    settings
}

/// Grids of what lidars saw are at frames 0, n, 2 n, ...: one lidar must sweep at all of them. (Several that each miss some of them
/// miss some together: every n times a number that shares no divisor with their rates.)
fn check_observers(parent: &Section<'_>, s: &Section<'_>, rig: &Rig, every_n_frames: u32) {
    let plain: Vec<&LidarSpec> = rig.lidars.iter().filter(|lidar| !lidar.semantic).collect();
    if plain.is_empty() {
        s.fault_at("observed", format!("`{}` needs a lidar without labels", s.path_of("observed")));
    } else if !plain.iter().any(|lidar| every_n_frames.is_multiple_of(lidar.every_n_frames)) {
        let rates: Vec<String> = plain.iter().map(|l| format!("{}: {}", l.name, l.every_n_frames)).collect();
        let problem = format!(
            "`{}` ({every_n_frames}) is no multiple of `{}.every_n_frames` ({}): there is no sweep at some frames for `{}`",
            s.path_of("every_n_frames"),
            parent.path_of("lidar"),
            rates.join(", "),
            s.path_of("observed")
        );
        s.fault_at_any(&["every_n_frames", "observed"], problem);
    }
}

fn sweeps(s: &Section<'_>, d: &SweepSettings) -> SweepSettings {
    let from = |key: &str, default: bool, from: &str| {
        s.flag(key, default, &format!("without `full_sweep`: sweep columns from the {from}"))
    };
    SweepSettings {
        z_top: from("use_z_top", d.z_top, "top"),
        z_bottom: from("use_z_bottom", d.z_bottom, "bottom"),
        x_front: from("use_x_front", d.x_front, "front"),
        x_back: from("use_x_back", d.x_back, "back"),
        y_left: from("use_y_left", d.y_left, "left"),
        y_right: from("use_y_right", d.y_right, "right"),
        z_fill: s.choice(
            "z_fill_mode",
            &ZFill::ALL.map(|mode| (mode.name(), mode)),
            0,
            "between what sweeps from top and bottom meet: nothing; `scanline` one label where both have it; `boxsweep` what \
             touches each cell",
        ),
    }
}
