//! One file a picture.

use std::path::Path;

use arguments::viz::{Colour, ShownBoxes, VizArgs};
use pictures::{Canvas, ColourBy};
use runner::{OutputFile, SceneList, say};
use scene::SensorKind;
use schema::AgentId;
use schema::table::Row;
use schema::tables::CameraRow;

use crate::desk::Desk;
use crate::error::{Drawing, VizError};
use crate::feed::Wants;
use crate::known::keep_known;
use crate::mode::{Mode, Source, Wanted, modes_of};
use crate::session::{Session, for_frames};

/// Height of the text of scales and legends, as a share of a picture's width.
const TEXT: f64 = 0.014;
/// Quality of photographs.
const JPEG_QUALITY: u8 = 92;
/// Folder of the pictures that are of no agent.
const SCENE_FOLDER: &str = "scene";

pub(crate) fn run(args: &VizArgs) -> Result<(), VizError> {
    let session = Session::open(&args.common, args.scene)?;
    let wanted = wanted(&session, args)?;
    if args.list {
        for (agent, modes) in &wanted {
            let names: Vec<String> = modes.iter().map(Mode::name).collect();
            say(&format!("{agent}: {}", names.join(" ")));
        }
        return Ok(());
    }
    let dest = args.dest.as_deref().unwrap_or(Path::new("."));
    let frames = frames(&session, args.frames.as_ref(), args.every)?;
    let mut feeds = session.feeds(&wants(&session, &wanted, args.common.boxes())?)?;
    let colour = args.colour.map(colour_by);
    let mut written = 0_u64;
    let made = for_frames(
        &mut feeds,
        &frames,
        |frame, agents, rigs| {
            let desk = Desk { session: &session, frame, agents, rigs, colour, text: TEXT };
            let mut written = 0;
            for (agent, modes) in &wanted {
                let which = agents.iter().position(|a| a.agent == *agent).unwrap_or_default();
                for mode in modes {
                    if let Some(picture) = desk.draw(mode, which)? {
                        write(dest, &session, (frame, *agent), mode, &picture)?;
                        written += 1;
                    }
                }
            }
            Ok(written)
        },
        |_, count| {
            written += count;
            Ok(())
        },
    );
    made?;
    if written == 0 {
        let frames: Vec<String> = frames.iter().map(ToString::to_string).collect();
        return Err(VizError::Refused(format!(
            "none of these sensors and labels has anything at frames {}: choose others",
            frames.join(", ")
        )));
    }
    say(&format!("{}: {written} pictures of {} frames", dest.display(), frames.len()));
    Ok(())
}

fn colour_by(colour: Colour) -> ColourBy {
    match colour {
        Colour::Distance => ColourBy::Distance,
        Colour::Height => ColourBy::Height,
        Colour::Tag => ColourBy::Tag,
        Colour::Id => ColourBy::Id,
        Colour::Intensity => ColourBy::Intensity,
        Colour::Velocity => ColourBy::Velocity,
        Colour::Agent => ColourBy::Agent,
    }
}

/// The frames that are wanted.
fn frames(session: &Session, list: Option<&SceneList>, every: Option<u32>) -> Result<Vec<u32>, VizError> {
    let all: Vec<u32> = (0..session.frame_count()).collect();
    let named: Vec<u32> = match (list, every) {
        (None, None) => vec![session.middle_frame()],
        (None, Some(_)) => all,
        (Some(list), _) => {
            if let Some(frame) = list.outside(&all).first() {
                session.frame(*frame)?;
            }
            all.into_iter().filter(|frame| list.contains(*frame)).collect()
        }
    };
    Ok(named.into_iter().step_by(every.unwrap_or(1) as usize).collect())
}

/// The pictures that are wanted, agent by agent; that of the scene is with the first one.
fn wanted(session: &Session, args: &VizArgs) -> Result<Vec<Wanted>, VizError> {
    let agents = session.agents(&args.agents)?;
    let mut there = Vec::new();
    for (i, (_, agent)) in agents.into_iter().enumerate() {
        let mut modes = modes_of(&session.source, agent)?;
        modes.extend((i == 0).then_some(Mode::Scene));
        there.push((agent, modes));
    }
    for pattern in &args.modes {
        if !there.iter().flat_map(|(_, modes)| modes).any(|mode| export_core::matches(pattern, &mode.name()))
        {
            let mut names: Vec<String> = there.iter().flat_map(|(_, modes)| modes).map(Mode::name).collect();
            names.sort_unstable();
            names.dedup();
            return Err(VizError::Refused(format!(
                "there is no picture `{pattern}` of these agents; there are {}",
                names.join(", ")
            )));
        }
    }
    if !args.modes.is_empty() {
        for (_, modes) in &mut there {
            modes.retain(|mode| args.modes.iter().any(|p| export_core::matches(p, &mode.name())));
        }
        there.retain(|(_, modes)| !modes.is_empty());
    } else if let Some(colour) = args.colour.map(colour_by) {
        // Without a choice of pictures it is those that can be coloured so.
        for (_, modes) in &mut there {
            modes.retain(|mode| may_have(mode, colour));
        }
    }
    if let Some(colour) = args.colour.map(colour_by) {
        keep_known(session, &mut there, colour, !args.modes.is_empty())?;
        there.retain(|(_, modes)| !modes.is_empty());
    }
    Ok(there)
}

/// Whether the points of a picture may be coloured by something; of what has no points nothing is asked.
fn may_have(mode: &Mode, by: ColourBy) -> bool {
    let of = |source: &Source| match by {
        ColourBy::Velocity => *source == Source::Radars,
        ColourBy::Intensity => *source != Source::Radars,
        _ => true,
    };
    match mode {
        Mode::Cloud { source, .. } => of(source),
        Mode::Together { .. } | Mode::Scene => by != ColourBy::Velocity,
        _ => true,
    }
}

/// What must be read for some pictures: of all agents, where one of them shows all.
fn wants(session: &Session, wanted: &[Wanted], boxes: ShownBoxes) -> Result<Vec<(AgentId, Wants)>, VizError> {
    let shows_all = wanted.iter().flat_map(|(_, modes)| modes).any(Mode::is_of_all);
    let mut wants = Vec::new();
    for agent in session.source.agents() {
        let modes = wanted.iter().find(|(a, _)| a == agent).map_or(&[][..], |(_, modes)| modes);
        if modes.is_empty() && !shows_all {
            continue;
        }
        let mut names: Vec<String> = Vec::new();
        for mode in modes {
            match mode {
                Mode::Camera(_, table) => names.push(table.clone()),
                Mode::Cloud { source: Source::Radars, .. } => {
                    names.extend(sensor_names(session, *agent, SensorKind::Radar)?);
                }
                Mode::Cloud { source, .. } => names.push(source.name().to_owned()),
                _ => {}
            }
        }
        if shows_all {
            names.extend(sensor_names(session, *agent, SensorKind::Lidar)?);
        }
        wants.push((*agent, Wants { sensors: names, boxes }));
    }
    Ok(wants)
}

/// Names of an agent's sensors of a kind; none where no sensor was read yet.
pub(crate) fn sensor_names(
    session: &Session,
    agent: AgentId,
    kind: SensorKind,
) -> Result<Vec<String>, VizError> {
    if !session.source.has(CameraRow::STAGE) {
        return Ok(Vec::new());
    }
    let sensors = session.source.sensors(agent)?;
    Ok(sensors.into_iter().filter(|s| s.kind == kind).map(|s| s.name).collect())
}

/// Writes a picture: `vehicle_0/LIDAR-FAR/scene-0003-frame-0120-vehicle_0-LIDAR-FAR.png`.
fn write(
    dest: &Path,
    session: &Session,
    (frame, agent): (u32, AgentId),
    mode: &Mode,
    picture: &Canvas,
) -> Result<(), VizError> {
    let name = mode.name();
    let owner = if *mode == Mode::Scene { SCENE_FOLDER.to_owned() } else { agent.to_string() };
    let (ending, bytes) =
        if mode.is_photograph() { ("jpg", picture.to_jpeg(JPEG_QUALITY)) } else { ("png", picture.to_png()) };
    let file = format!("scene-{:04}-frame-{frame:04}-{owner}-{name}.{ending}", session.source.number());
    let path = dest.join(owner).join(&name).join(file);
    let bytes = bytes.drawing(|| path.display().to_string())?;
    OutputFile::save(&path, &bytes).map_err(|source| VizError::Write { path, source })
}
