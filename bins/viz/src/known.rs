//! Colours that would tell what nobody knows: of imported scenes some columns hold zeros that are no
//! readings.

use std::collections::BTreeMap;

use pictures::ColourBy;
use scene::SensorKind;
use schema::AgentId;
use schema::table::Row;
use schema::tables::CameraRow;

use crate::error::VizError;
use crate::feed::unknown_colours;
use crate::mode::{Mode, Source, Wanted};
use crate::session::Session;

/// Sensors whose points nobody can colour so, with what is wrong: by agent and name.
type Unknown = BTreeMap<(AgentId, String), (SensorKind, String)>;

/// Looks whether the points of some pictures can be coloured by something. A picture that was asked for by
/// its name and cannot is refused; others are left out, which is said once for each kind of sensor.
pub(crate) fn keep_known(
    session: &Session,
    wanted: &mut [Wanted],
    by: ColourBy,
    are_named: bool,
) -> Result<(), VizError> {
    let unknown = unknown(session, by)?;
    let mut told = BTreeMap::<&str, &str>::new();
    for (agent, modes) in wanted.iter_mut() {
        modes.retain(|mode| {
            let faults: Vec<_> = unknown
                .iter()
                .filter(|((a, name), (kind, _))| shows(mode, *agent, *a, name, *kind))
                .collect();
            told.extend(faults.iter().map(|((_, name), (_, why))| (name.as_str(), why.as_str())));
            faults.is_empty()
        });
    }
    let has_points = wanted.iter().flat_map(|(_, modes)| modes).any(Mode::has_points);
    match told.values().next() {
        Some(why) if are_named || !has_points => Err(VizError::Refused((*why).to_owned())),
        _ => {
            for why in told.values() {
                tracing::warn!("{why}; there are no pictures of it");
            }
            Ok(())
        }
    }
}

/// Whether a picture of an agent shows the points of a sensor.
fn shows(mode: &Mode, agent: AgentId, owner: AgentId, name: &str, kind: SensorKind) -> bool {
    match mode {
        Mode::Cloud { source: Source::Radars, .. } => owner == agent && kind == SensorKind::Radar,
        Mode::Cloud { source, .. } => owner == agent && source.name() == name,
        Mode::Together { .. } | Mode::Scene => kind == SensorKind::Lidar,
        Mode::Camera(..) | Mode::Voxels { .. } | Mode::Bev(_) => false,
    }
}

/// The sensors of which this is not known.
fn unknown(session: &Session, by: ColourBy) -> Result<Unknown, VizError> {
    let source = &session.source;
    let mut found = Unknown::new();
    if !source.has(CameraRow::STAGE) {
        return Ok(found);
    }
    for agent in source.agents() {
        for sensor in source.sensors(*agent)? {
            let colours = unknown_colours(source, *agent, &sensor)?;
            if colours.contains(&by) {
                let others = ColourBy::ALL.into_iter().filter(|other| {
                    !colours.contains(other)
                        && match other {
                            ColourBy::Velocity => sensor.kind == SensorKind::Radar,
                            ColourBy::Intensity => sensor.kind != SensorKind::Radar,
                            _ => true,
                        }
                });
                let others = others.map(ColourBy::name).collect::<Vec<_>>().join(", ");
                let why = format!(
                    "scene {}: nobody knows the {} of points of {}, as the scene was imported: colour them by {others}",
                    source.number(),
                    by.name(),
                    sensor.name
                );
                found.insert((*agent, sensor.name), (sensor.kind, why));
            }
        }
    }
    Ok(found)
}
