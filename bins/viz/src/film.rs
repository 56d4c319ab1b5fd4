//! A scene as a film.

use std::io::{BufWriter, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use arguments::viz::{FilmArgs, ShownBoxes};
use codecs::images::{AnimationWriter, ImageError};
use pictures::{Canvas, Panel, Sheet, draw_sheet};
use runner::{OutputFile, say};
use scene::SensorKind;
use schema::table::Row;
use schema::tables::CameraRow;
use schema::{AgentId, FRAME_PERIOD_S, ImageKind, rate};

use crate::desk::Desk;
use crate::error::{Drawing, VizError};
use crate::feed::{AgentFrame, Rig, Wants};
use crate::mode::{Mode, modes_of};
use crate::preview::camera_order;
use crate::session::{Session, for_frames};
use crate::stills::sensor_names;

/// Cameras in the upper row.
const CAMERAS: usize = 3;
/// Height of the text of scales and legends, as a share of a picture's width: films are narrow.
const TEXT: f64 = 0.026;
/// The encoder that makes MP4 files, if it is installed.
const ENCODER: &str = "ffmpeg";

pub(crate) fn run(args: &FilmArgs) -> Result<(), VizError> {
    if args.out.extension().is_none_or(|e| e != "png") {
        let out = args.out.display();
        return Err(VizError::Refused(format!("{out}: a film must end in .png (a .mp4 is put beside it)")));
    }
    let session = Session::open(&args.common, args.scene)?;
    let (_, agent) = session.agent(args.agent)?;
    let modes = shown(modes_of(&session.source, agent)?);
    let frames = frames(&session, agent, &modes, args.every)?;
    let mut feeds = session.feeds(&wants(&session, agent, &modes, args.common.boxes())?)?;
    let write = |source| VizError::Write { path: args.out.clone(), source };
    let mut file = BufWriter::new(OutputFile::begin(&args.out).map_err(write)?);
    let step_s = f64::from(frames.get(1).map_or(args.every, |second| second - frames[0])) * FRAME_PERIOD_S;
    let mut film =
        Film { path: &args.out, file: Some(&mut file), frames: frames.len() as u32, step_s, open: None };
    for_frames(
        &mut feeds,
        &frames,
        |frame, agents, rigs| picture(&session, (frame, agent), &modes, (agents, rigs), args.width),
        |_, canvas| film.push(canvas),
    )?;
    let movie = film.end()?;
    let file = file.into_inner().map_err(|e| write(e.into_error()))?;
    file.finish().map_err(write)?;
    say(&format!("{} ({} frames)", args.out.display(), frames.len()));
    match movie {
        Some(movie) => say(&movie.end()),
        None => say(&format!("no {ENCODER} is installed: there is no .mp4 beside it")),
    }
    Ok(())
}

/// Both files in the making; their size is that of the first picture.
struct Film<'f, W: Write> {
    path: &'f Path,
    file: Option<&'f mut W>,
    frames: u32,
    step_s: f64,
    open: Option<(AnimationWriter<&'f mut W>, Option<Movie>)>,
}

impl<W: Write> Film<'_, W> {
    fn failed(&self, fault: &ImageError) -> VizError {
        VizError::Refused(format!("{}: {fault}", self.path.display()))
    }

    fn push(&mut self, canvas: Canvas) -> Result<(), VizError> {
        if let Some(file) = self.file.take() {
            let millis = (1000.0 * self.step_s).round().clamp(1.0, 60_000.0) as u16;
            let writer = AnimationWriter::new(file, canvas.size(), self.frames, millis);
            let movie = Movie::begin(&self.path.with_extension("mp4"), canvas.size(), self.step_s);
            self.open = Some((writer.map_err(|e| self.failed(&e))?, movie));
        }
        let Some((writer, movie)) = &mut self.open else { return Ok(()) };
        if let Some(movie) = movie {
            movie.push(&canvas);
        }
        let pushed = writer.push(canvas.into_rgba());
        pushed.map_err(|e| self.failed(&e))
    }

    fn end(mut self) -> Result<Option<Movie>, VizError> {
        let Some((writer, movie)) = self.open.take() else {
            return Err(VizError::Refused("there is no frame at which all of it is there".into()));
        };
        writer.finish().map_err(|e| self.failed(&e))?;
        Ok(movie)
    }
}

/// What a film shows, of what there is: cameras ahead, then the lidar from above and from behind, or what
/// else there is.
fn shown(there: Vec<Mode>) -> Vec<Mode> {
    let mut cameras: Vec<Mode> = there.iter().filter(|mode| mode.is_photograph()).cloned().collect();
    cameras.sort_by_key(|mode| camera_order(&mode.name()));
    cameras.truncate(CAMERAS);
    let named = |name: &str| there.iter().find(|mode| mode.name() == name).cloned();
    let clouds = [named("LIDAR3DwBBOX-FAR"), Some(Mode::Scene), named("BEV")];
    cameras.into_iter().chain(clouds.into_iter().flatten()).collect()
}

/// The frames at which everything that is shown is there.
fn frames(session: &Session, agent: AgentId, modes: &[Mode], every: u32) -> Result<Vec<u32>, VizError> {
    let has_sensors = session.source.has(CameraRow::STAGE);
    let sensors = if has_sensors { session.source.sensors(agent)? } else { Vec::new() };
    let is_shown = |name: &str| modes.iter().any(|mode| mode.name() == name || is_cloud_of(mode, name));
    let mut rates: Vec<u32> =
        sensors.iter().filter(|s| is_shown(&s.name)).map(|s| s.about.every_n_frames).collect();
    rates.push(every);
    if modes.iter().any(|mode| matches!(mode, Mode::Bev(_))) {
        let kind = &schema::arrays::BEV_MASKS;
        let grid: crate::archive::BevGrid = scene::described(session.source.reader(), kind, agent)?;
        rates.push(grid.every_n_frames);
    }
    let all = 0..session.frame_count();
    Ok(all.filter(|frame| rates.iter().all(|every| rate::is_due(*frame, *every))).collect())
}

fn is_cloud_of(mode: &Mode, name: &str) -> bool {
    matches!(mode, Mode::Cloud { source, .. } if source.name() == name)
}

fn wants(
    session: &Session,
    agent: AgentId,
    modes: &[Mode],
    boxes: ShownBoxes,
) -> Result<Vec<(AgentId, Wants)>, VizError> {
    let mut wants = Vec::new();
    for other in session.source.agents() {
        let mut sensors = sensor_names(session, *other, SensorKind::Lidar)?;
        if *other == agent {
            let cameras = sensor_names(session, *other, SensorKind::Image(ImageKind::Rgb))?;
            sensors.extend(cameras.into_iter().filter(|name| modes.iter().any(|m| m.name() == *name)));
        }
        wants.push((*other, Wants { sensors, boxes }));
    }
    Ok(wants)
}

fn picture(
    session: &Session,
    (frame, agent): (u32, AgentId),
    modes: &[Mode],
    (agents, rigs): (&[AgentFrame], &[Rig]),
    width: u32,
) -> Result<Canvas, VizError> {
    let desk = Desk { session, frame, agents, rigs, colour: None, text: TEXT };
    let which = agents.iter().position(|a| a.agent == agent).unwrap_or_default();
    let (mut above, mut below) = (Vec::new(), Vec::new());
    for mode in modes {
        if let Some(picture) = desk.draw(mode, which)? {
            let row = if mode.is_photograph() { &mut above } else { &mut below };
            row.push(Panel { name: mode.name(), picture });
        }
    }
    let rows = [above, below].into_iter().filter(|row| !row.is_empty()).collect();
    let time_s = f64::from(frame) * FRAME_PERIOD_S;
    let (name, info) = (&session.dataset, session.source.info());
    let heading = format!("{name}  scene {:04}  {agent}  {time_s:.2} s", info.scene);
    draw_sheet(&Sheet { heading, rows, ..Sheet::default() }, width).drawing(|| format!("frame {frame}"))
}

/// An MP4 file in the making, by an encoder that is installed.
struct Movie {
    encoder: Child,
    path: String,
    is_fed: bool,
}

impl Movie {
    /// Starts the encoder; none where there is none.
    fn begin(path: &Path, [width, height]: [u32; 2], step_s: f64) -> Option<Self> {
        let path = path.to_string_lossy().into_owned();
        let size = format!("{width}x{height}");
        let rate = format!("{:.6}", 1.0 / step_s);
        let encoder = Command::new(ENCODER)
            .args(["-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", &size])
            .args(["-r", &rate, "-i", "-", "-an", "-pix_fmt", "yuv420p", "-movflags", "+faststart", &path])
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()
            .ok()?;
        Some(Self { encoder, path, is_fed: true })
    }

    /// Adds a frame. A broken pipe is told at the end: the film itself goes on.
    fn push(&mut self, canvas: &Canvas) {
        if let Some(pipe) = &mut self.encoder.stdin {
            self.is_fed &= pipe.write_all(&canvas.to_rgb()).is_ok();
        }
    }

    /// Ends the file, and says how it went.
    fn end(mut self) -> String {
        drop(self.encoder.stdin.take());
        match self.encoder.wait() {
            Ok(status) if status.success() && self.is_fed => self.path,
            _ => format!("{}: {ENCODER} could not write it; the .png is whole", self.path),
        }
    }
}
