//! A contact sheet of a frame.

use std::path::Path;

use arguments::viz::{PreviewArgs, ShownBoxes};
use export_core::SceneSource;
use pictures::{Canvas, Panel, Reach, Sheet, draw_sheet};
use runner::{OutputFile, say};
use scene::SensorKind;
use schema::table::Row;
use schema::tables::{FrameRow, ValidBoxRow};
use schema::{AgentId, DetectionClass, FRAME_PERIOD_S, ImageKind};

use crate::desk::{Desk, boxes_of_all};
use crate::error::{Drawing, VizError};
use crate::feed::{AgentFrame, Wants};
use crate::mode::{Mode, modes_of};
use crate::session::{Session, for_frames};
use crate::stills::sensor_names;

schema::columns! {
    /// The weather of a frame.
    WeatherAt of FrameRow {
        frame: u32,
        cloudiness: f64,
        precipitation: f64,
        fog_density: f64,
        sun_altitude_deg: f64,
    }
}

/// Pictures of cameras in a row.
const CAMERAS: usize = 3;
/// Height of the text of scales and legends, as a share of a picture's width: a third of the sheet's.
const TEXT: f64 = 0.019;
const JPEG_QUALITY: u8 = 90;

pub(crate) fn run(args: &PreviewArgs) -> Result<(), VizError> {
    let ending = args.out.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    if !["png", "jpg", "jpeg"].contains(&ending.as_str()) {
        return Err(VizError::Refused(format!("{}: a sheet must end in .png or .jpg", args.out.display())));
    }
    let session = Session::open(&args.common, args.scene)?;
    let (_, agent) = session.agent(args.agent)?;
    let frame = session.frame(args.frame.unwrap_or(session.middle_frame()))?;
    let modes = modes_of(&session.source, agent)?;
    let mut feeds = session.feeds(&wants(&session, agent, args.common.boxes())?)?;
    let make = |frame: u32, agents: &[AgentFrame], rigs: &[crate::feed::Rig]| {
        let desk = Desk { session: &session, frame, agents, rigs, colour: None, text: TEXT };
        sheet_of(&desk, agent, &modes, args.width)
    };
    for_frames(&mut feeds, &[frame], make, |_, canvas| write(&args.out, &ending, &canvas))
}

fn write(path: &Path, ending: &str, canvas: &Canvas) -> Result<(), VizError> {
    let bytes = if ending == "png" { canvas.to_png() } else { canvas.to_jpeg(JPEG_QUALITY) };
    let bytes = bytes.drawing(|| path.display().to_string())?;
    OutputFile::save(path, &bytes).map_err(|source| VizError::Write { path: path.to_owned(), source })?;
    let [width, height] = canvas.size();
    say(&format!("{} ({width} x {height} pixels)", path.display()));
    Ok(())
}

/// The agent's colour images, and the lidars of all.
fn wants(session: &Session, agent: AgentId, boxes: ShownBoxes) -> Result<Vec<(AgentId, Wants)>, VizError> {
    let mut wants = Vec::new();
    for other in session.source.agents() {
        let mut sensors = sensor_names(session, *other, SensorKind::Lidar)?;
        if *other == agent {
            sensors.extend(sensor_names(session, *other, SensorKind::Image(ImageKind::Rgb))?);
        }
        wants.push((*other, Wants { sensors, boxes }));
    }
    Ok(wants)
}

fn sheet_of(desk: &Desk<'_>, agent: AgentId, modes: &[Mode], width: u32) -> Result<Canvas, VizError> {
    let which = desk.agents.iter().position(|a| a.agent == agent).unwrap_or_default();
    let panel = |desk: &Desk<'_>, mode: &Mode, name: &str| -> Result<Option<Panel>, VizError> {
        Ok(desk.draw(mode, which)?.map(|picture| Panel { name: name.to_owned(), picture }))
    };
    let mut cameras = Vec::new();
    for mode in modes.iter().filter(|mode| mode.is_photograph()) {
        cameras.extend(panel(desk, mode, &mode.name())?);
    }
    cameras.sort_by_key(|panel| camera_order(&panel.name));
    let mut rows: Vec<Vec<Panel>> = Vec::new();
    while !cameras.is_empty() {
        let rest = cameras.split_off(CAMERAS.min(cameras.len()));
        rows.push(std::mem::replace(&mut cameras, rest));
    }
    let named = |name: &str| modes.iter().find(|mode| mode.name() == name);
    let mut add = |desk: &Desk<'_>, wanted: &[(&Mode, &str)]| -> Result<(), VizError> {
        let mut row = Vec::new();
        for (mode, name) in wanted {
            row.extend(panel(desk, mode, name)?);
        }
        if !row.is_empty() {
            rows.push(row);
        }
        Ok(())
    };
    let from_above = [
        named("LIDARwBBOX-FAR").map(|m| (m, "Lidar with boxes, 160 m by 160 m, ahead is up")),
        named("BEV").map(|m| (m, "BEV masks, ahead is up")),
        Some((&Mode::Scene, "All agents, lidar points by agent, boxes by class, north is up")),
    ];
    add(desk, &from_above.into_iter().flatten().collect::<Vec<_>>())?;
    let voxels = modes.iter().find(|mode| matches!(mode, Mode::Voxels { reach: Reach::Near, .. }));
    let from_behind = [
        named("LIDAR3DwBBOX-NEAR").map(|m| (m, "Lidar with boxes, from behind")),
        voxels.map(|m| (m, "Voxels, from behind")),
    ];
    // Two in a row are larger than three.
    let wider = Desk { text: TEXT * 2.0 / 3.0, ..*desk };
    add(&wider, &from_behind.into_iter().flatten().collect::<Vec<_>>())?;
    let sheet = Sheet { rows, legend: legend(desk), ..caption(desk, which)? };
    draw_sheet(&sheet, width).drawing(|| "the sheet".to_owned())
}

/// As eyes go: the row ahead from left to right, then the row behind.
pub(crate) fn camera_order(name: &str) -> (usize, String) {
    const ORDER: [&str; 6] = ["FRONT_LEFT", "FRONT", "FRONT_RIGHT", "BACK_LEFT", "BACK", "BACK_RIGHT"];
    let place = ORDER.iter().position(|end| name.ends_with(&format!("CAM_{end}")));
    (place.unwrap_or(ORDER.len()), name.to_owned())
}

/// Classes that have a box, with their colours.
fn legend(desk: &Desk<'_>) -> Vec<(String, [u8; 3])> {
    let boxes = boxes_of_all(desk.agents);
    let classes = DetectionClass::ALL.into_iter().filter(|class| boxes.iter().any(|b| b.class == *class));
    classes.map(|class| (class.name().replace('_', " "), class.rgb())).collect()
}

/// What the sheet says in words.
fn caption(desk: &Desk<'_>, which: usize) -> Result<Sheet, VizError> {
    let source = &desk.session.source;
    let info = source.info();
    let agent = &desk.agents[which];
    let time_s = f64::from(desk.frame) * FRAME_PERIOD_S;
    let heading = format!(
        "{}  scene {:04}  frame {} ({time_s:.2} s)  {}",
        desk.session.dataset, info.scene, desk.frame, agent.agent
    );
    let seen = agent.boxes.iter().filter(|(_, is_seen)| *is_seen).count();
    let boxes = agent.box_count;
    let sight = match source.has(ValidBoxRow::STAGE) {
        true => format!("sees {seen} of {boxes} boxes. Lines: thick easy, thin and dark hard to detect."),
        false => format!("lists {boxes} boxes, seen or not: nobody has looked."),
    };
    let origin = if source.is_imported() { ", imported" } else { "" };
    let place = agent.world_from_agent.translation.vector;
    let lines = vec![
        format!(
            "map {}, split {}{origin}, {:.0} s of {} agents, {} vehicles and {} walkers around, {}",
            info.map,
            info.split,
            info.duration_s,
            info.agents.len(),
            info.n_vehicles,
            info.n_walkers,
            weather(source, desk.frame)?,
        ),
        format!("{} at {:.1} m east, {:.1} m north, {sight}", agent.agent, place.x, place.y),
    ];
    Ok(Sheet { heading, lines, ..Sheet::default() })
}

/// The weather of a frame in words: shares in percent.
fn weather(source: &SceneSource, frame: u32) -> Result<String, VizError> {
    let rows: Vec<WeatherAt> = source.reader().rows()?;
    Ok(rows.iter().find(|row| row.frame == frame).map_or_else(String::new, |row| {
        format!(
            "sun {:.0} degrees high, clouds {:.0}%, rain {:.0}%, fog {:.0}%",
            row.sun_altitude_deg, row.cloudiness, row.precipitation, row.fog_density
        )
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_stand_as_they_look() {
        let mut names = ["RGB-CAM_BACK", "RGB-CAM_FRONT", "RGB-ROOF", "RGB-CAM_FRONT_LEFT"];
        names.sort_by_key(|name| camera_order(name));
        assert_eq!(names, ["RGB-CAM_FRONT_LEFT", "RGB-CAM_FRONT", "RGB-CAM_BACK", "RGB-ROOF"]);
    }
}
