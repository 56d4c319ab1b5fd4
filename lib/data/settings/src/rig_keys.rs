//! What an agent carries, as a configuration writes it.

use std::collections::BTreeSet;

use schema::tables::{BOXES_2D_TABLE, GNSS_TABLE, IMU_TABLE, VISIBLE_TABLE};
use schema::{AgentId, AgentKind, ImageKind};

use crate::camera::{CameraSettings, CameraSpec};
use crate::inertial::{GnssSpec, ImuSpec};
use crate::key::{Key, Name, Settings, settings};
use crate::lidar::LidarSpec;
use crate::mount::Mount;
use crate::occupancy::OccupancySettings;
use crate::optics::Optics;
use crate::pictures::{Pictures, optics};
use crate::radar::{RadarPlace, RadarSpec};
use crate::reader::Section;
use crate::rig::{OwnRig, Rig};
use crate::table_names::TableNames;

/// Names the file that a rig is read from.
pub(crate) const FILE_KEY: &str = "rig";

/// The rig in the table of a kind of agents.
pub(crate) fn rig(root: &Section<'_>, name: &Name, default: Rig) -> Rig {
    carried(&over_file(root.section(name.key, kind_doc(name.key))), &default)
}

/// The voxel grid there.
pub(crate) fn grid(root: &Section<'_>, name: &Name, default: OccupancySettings) -> OccupancySettings {
    occupancy(&over_file(root.section(name.key, kind_doc(name.key))), &default)
}

fn kind_doc(key: &str) -> &'static str {
    if key == "rsu" {
        "Sensors and voxel grid of every RSU."
    } else {
        "Sensors and voxel grid of every data-collection vehicle."
    }
}

/// Lays a rig over the file that it names.
fn over_file(section: Section<'_>) -> Section<'_> {
    let doc = "A file with keys of this table, beside this file; those that stand here go before its own (lists as a whole).";
    section.over_file(FILE_KEY, doc)
}

/// Rigs that single agents carry instead of those of their kind.
pub(crate) fn own(root: &Section<'_>, name: &Name, _: Vec<OwnRig>) -> Vec<OwnRig> {
    let list = root.sections(name.key, name.absent, name.doc).unwrap_or_default();
    agents_of(&over_file(root.describe_item(name.key)));
    let mut carriers = BTreeSet::new();
    let read = |item: Section<'_>| {
        let item = &over_file(item);
        let (agents, kind) = carried_by(item, &mut carriers);
        let usual = if kind == AgentKind::Rsu { Rig::rsu() } else { Rig::vehicle() };
        let rig = carried(item, &usual);
        OwnRig { agents, rig, occupancy: occupancy(item, &OccupancySettings::default()) }
    };
    list.into_iter().map(read).collect()
}

fn agents_of(item: &Section<'_>) -> Vec<String> {
    Key::new("agents", "The agents that carry it: `vehicle_0`, `rsu_1`, ... of one kind.")
        .read(item, &Vec::new())
}

/// The agents of a rig of their own, and their kind; `carriers` are all so far.
fn carried_by(item: &Section<'_>, carriers: &mut BTreeSet<String>) -> (Vec<String>, AgentKind) {
    let written = agents_of(item);
    let path = item.path_of("agents");
    let fault = |problem: String| item.fault_at("agents", problem);
    let (mut agents, mut kinds) = (Vec::new(), BTreeSet::new());
    for agent in &written {
        match agent.parse::<AgentId>() {
            Ok(id) => {
                kinds.insert(id.kind);
                agents.push(id.to_string());
            }
            Err(_) => fault(format!("`{path}`: `{agent}` is no agent, expected vehicle_N or rsu_N")),
        }
        if !carriers.insert(agent.clone()) {
            fault(format!("`{path}`: `{agent}` carries another rig already"));
        }
    }
    if written.is_empty() {
        fault(format!("`{path}` is empty: say which agents carry this rig, such as [\"vehicle_1\"]"));
    }
    if kinds.len() > 1 {
        fault(format!("`{path}` names vehicles and RSUs: a rig is for one kind"));
    }
    (agents, if kinds.contains(&AgentKind::Rsu) { AgentKind::Rsu } else { AgentKind::Vehicle })
}

fn carried(s: &Section<'_>, d: &Rig) -> Rig {
    // Taken on every rig, whatever is switched on: a flag must not turn a good name into a bad one.
    let fixed = [GNSS_TABLE, IMU_TABLE, VISIBLE_TABLE, BOXES_2D_TABLE].map(str::to_owned);
    let lidars_tables = d.lidars.iter().flat_map(|l| [l.name.clone(), l.semantic().name]);
    let mut tables = TableNames::new(lidars_tables.chain(fixed));
    let shared = s.section("camera", "What all cameras share.");
    let has_cameras = Key::new("enabled", "Write the cameras' images.").read(&shared, &true);
    let pictures = Pictures::read(&shared, &Pictures::default());
    let all = cameras(s, (&d.cameras, &pictures), &mut tables);
    Rig {
        camera: CameraSettings::read(&shared, &d.camera),
        cameras: if has_cameras { all } else { Vec::new() },
        lidars: lidars(s, &d.lidars[0], &mut tables),
        radars: radars(s, &d.radars, &mut tables),
        gnss: gnss(&s.section("gnss", "GNSS receiver."), d.gnss.is_some()),
        imu: imu(&s.section("imu", "Inertial measurement unit."), d.imu.is_some()),
    }
}

/// Names, as a default in words.
fn names<'a>(names: impl Iterator<Item = &'a String>) -> String {
    names.map(String::as_str).collect::<Vec<_>>().join(", ")
}

/// The cameras of a rig.
fn cameras(
    s: &Section<'_>,
    (d, shared): (&[CameraSpec], &Pictures),
    tables: &mut TableNames,
) -> Vec<CameraSpec> {
    // One that does not say where it looks looks ahead, not where the first one of the default list does.
    let mount = Mount::upright(d[0].mount.xyz_m, 0.0);
    let first = CameraSpec { name: CameraSpec::default().name, mount, ..d[0].clone() };
    let read = |item: &Section<'_>| {
        let camera = CameraSpec::read(item, &first);
        CameraSpec { optics: optics(item, shared), ..camera }
    };
    let doc = "The cameras; replaces the default list.";
    let sections = s.sections("cameras", &names(d.iter().map(|c| &c.name)), doc);
    read(&s.describe_item("cameras"));
    let tables_of = |name: &str| ImageKind::ALL.iter().map(|kind| kind.table(name)).collect();
    match sections {
        None => {
            d.iter().for_each(|camera| tables.take(s, &camera.name, tables_of(&camera.name)));
            let optics: Optics = shared.optics();
            d.iter().map(|camera| CameraSpec { optics: optics.clone(), ..camera.clone() }).collect()
        }
        Some(list) => list
            .iter()
            .map(|item| {
                let camera = read(item);
                tables.take(item, &camera.name, tables_of(&camera.name));
                camera
            })
            .collect(),
    }
}

settings! {
    /// Whether a lidar is written.
    pub(crate) struct LidarSwitches {
        /// Write the lidar.
        enabled: bool = true, yaml("use_lidar");
        /// Write a semantic lidar with the same rays.
        semantic: bool = false, yaml("use_semantic_lidar");
        /// The same as `every_n_frames` of the semantic lidar.
        semantic_every_n_frames: Option<u32> = None, within(1..=1000), or("that of the lidar");
    }
}

/// The lidar that every rig has, and further ones.
fn lidars(s: &Section<'_>, d: &LidarSpec, tables: &mut TableNames) -> Vec<LidarSpec> {
    let mut lidars = lidar(&s.section("lidar", "Lidar."), d);
    let doc = "Further lidars, each with rays of its own: besides `name` all keys of `lidar`, with the same defaults.";
    let sections = s.sections("lidars", "none", doc);
    let further = |item: &Section<'_>| {
        let name = Key::new("name", "Lidar name, part of the file names (semantic: `SEG-` before it).");
        let name: String = name.read(item, &"LIDAR_2".to_owned());
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
    let switches = LidarSwitches::read(s, &LidarSwitches::default());
    let lidar = LidarSpec::read(s, d);
    let mut lidars = Vec::new();
    if switches.semantic {
        let every_n_frames = switches.semantic_every_n_frames.unwrap_or(lidar.every_n_frames);
        lidars.push(LidarSpec { every_n_frames, ..lidar.semantic() });
    }
    if switches.enabled {
        lidars.insert(0, lidar);
    }
    lidars
}

fn radars(s: &Section<'_>, d: &[RadarSpec], tables: &mut TableNames) -> Vec<RadarSpec> {
    let shared = s.section("radar", "What all radars share.");
    let enabled = Key::new("enabled", "Write the radars.").yaml("use_radar").read(&shared, &true);
    let first = &d[0];
    let spec = RadarSpec::read(&shared, first);
    let usual = RadarPlace { mount: Mount::upright(first.mount.xyz_m, 0.0), ..RadarPlace::default() };
    let read = |item: &Section<'_>| RadarPlace::read(item, &usual);
    let doc = "Radar positions; replaces the default list.";
    let sections = s.sections("radars", &names(d.iter().map(|r| &r.name)), doc);
    read(&s.describe_item("radars"));
    let mut take = |item: &Section<'_>, place: RadarPlace| {
        tables.take(item, &place.name, vec![place.name.clone()]);
        place
    };
    let places: Vec<RadarPlace> = match sections {
        None => d.iter().map(|r| take(s, RadarPlace { name: r.name.clone(), mount: r.mount })).collect(),
        Some(list) => list.iter().map(|item| take(item, read(item))).collect(),
    };
    if !enabled {
        return Vec::new();
    }
    let radar = |RadarPlace { name, mount }| RadarSpec { name, mount, ..spec.clone() };
    places.into_iter().map(radar).collect()
}

fn gnss(s: &Section<'_>, carried: bool) -> Option<GnssSpec> {
    let enabled = Key::new("enabled", "Write GNSS fixes.").yaml("use_gnss").read(s, &carried);
    let spec = GnssSpec::read(s, &GnssSpec::default());
    enabled.then_some(spec)
}

fn imu(s: &Section<'_>, carried: bool) -> Option<ImuSpec> {
    let enabled = Key::new("enabled", "Write IMU readings.").yaml("use_imu").read(s, &carried);
    let spec = ImuSpec::read(s, &ImuSpec::default());
    enabled.then_some(spec)
}

fn occupancy(parent: &Section<'_>, d: &OccupancySettings) -> OccupancySettings {
    OccupancySettings::read(&parent.section("occupancy", "Voxel grid."), d)
}

/// Grids of what lidars saw are at frames 0, n, 2 n, ...: one lidar must sweep at all of them. (Several that
/// each miss some of them miss some together: every n times a number that shares no divisor with their
/// rates.)
pub(crate) fn check_observers(parent: &Section<'_>, rig: &Rig, grid: &OccupancySettings) {
    if !grid.observed {
        return;
    }
    let s = parent.section("occupancy", "");
    let every_n_frames = grid.every_n_frames;
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
