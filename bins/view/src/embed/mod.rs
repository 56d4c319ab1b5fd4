//! Excerpts: some frames of a scene as a store of its own, small enough to lie inside one page.
//!
//! Of each lidar reading every k-th point stays, k the least that lets the page fit; positions are rounded to
//! 2^-7 m and intensities to 8 bits. Maps are cut to what comes near the agents. The page says all that.

mod archive;
mod table;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use crate::error::ViewError;
use crate::object::Object;
use crate::site::Site;
use crate::{listing, page, predictions};
use table::{Columns, Points, Rows};

/// What journals and mail let pass, bytes.
const LIMIT: usize = 15_000_000;
/// Frames where none are named: one second.
const FRAMES: u32 = 20;
/// Elements of the map stay where they come this near to an agent, metres.
const MAP_RADIUS_M: f64 = 150.0;
/// Fewer points than one in so many show nothing.
const THINNEST: usize = 64;

const AGENT_COLUMNS: Columns = &["frame", "agent", "id", "xyz_m", "quaternion", "velocity_mps"];
const BOX_COLUMNS: Columns = &[
    "frame",
    "agent",
    "id",
    "class",
    "center_m",
    "size_m",
    "rpy_rad",
    "velocity_mps",
    "num_lidar_pts",
    "num_radar_pts",
    "valid_flag",
    "difficulty",
    "seen_by",
    "signal_state",
    "opendrive_id",
    "attributes",
    "model",
];
const MAP_COLUMNS: Columns = &["kind", "x_m", "y_m", "z_m", "lane_type", "mark_color", "is_edge", "dash_m"];
const POINT_COLUMNS: Columns = &["frame", "x", "y", "z", "intensity", "id", "tag"];

/// What an excerpt is of.
#[derive(Debug)]
pub(crate) struct Excerpt {
    pub(crate) scene: u32,
    /// The first frame and the one after the last.
    pub(crate) frames: Option<(u32, u32)>,
    pub(crate) agents: Option<Vec<String>>,
    pub(crate) cameras: Vec<String>,
}

/// A page with its data inside.
#[derive(Debug)]
pub(crate) struct Page {
    pub(crate) html: String,
    /// What it shows, in words.
    pub(crate) what: String,
}

/// A file of the excerpt: its path in the store, and its bytes.
type Piece = (String, Vec<u8>);

/// An excerpt in the making.
struct Cut<'a> {
    site: &'a Site,
    folder: String,
    /// Files of the scene.
    files: Vec<String>,
    frames: (u32, u32),
    agents: Vec<String>,
    cameras: &'a [String],
}

impl Excerpt {
    /// Makes the page.
    ///
    /// # Errors
    /// There is no such scene, frame, agent or camera; files cannot be read; the page would be too large.
    pub(crate) fn page(&self, site: &Site) -> Result<Page, ViewError> {
        let folder = format!("{:04}", self.scene);
        let whole = listing::scene(site, &folder)?;
        let cut = self.cut(site, folder, &whole)?;
        let mut pieces = cut.tables()?;
        pieces.extend(cut.masks()?);
        pieces.extend(cut.pictures()?);
        pieces.extend(cut.predictions()?);
        let fixed = page::embedded(&[]).len() + encoded_len(&pieces) + (16 << 10);
        let room = LIMIT.checked_sub(fixed);
        let kind = if self.cameras.is_empty() { "frames or agents" } else { "cameras or frames" };
        let room = room.ok_or(ViewError::TooLarge(fixed as f64 / 1e6, kind))?;
        let (points, keep) = cut.points(room)?;
        pieces.extend(points);
        let what = cut.words(keep);
        pieces.extend(cut.lists(&whole, &what, &pieces));
        let files: Vec<(String, String)> =
            pieces.into_iter().map(|(path, bytes)| (path, STANDARD.encode(bytes))).collect();
        Ok(Page { html: page::embedded(&files), what })
    }

    fn cut<'a>(&'a self, site: &'a Site, folder: String, whole: &Value) -> Result<Cut<'a>, ViewError> {
        let info = &whole["info"];
        let total = info["frames"].as_u64().and_then(|n| u32::try_from(n).ok()).unwrap_or(0);
        let frames = self.frames.unwrap_or((0, FRAMES.min(total)));
        if frames.0 >= frames.1 || frames.1 > total {
            return Err(ViewError::NoFrames { scene: self.scene, frames: total });
        }
        let known: Vec<&str> =
            info["agents"].as_array().into_iter().flatten().filter_map(|a| a["agent"].as_str()).collect();
        let agents = match &self.agents {
            None => known.iter().map(|&a| a.to_owned()).collect(),
            Some(agents) => agents.clone(),
        };
        if let Some(other) = agents.iter().find(|a| !known.contains(&a.as_str())) {
            return Err(ViewError::NoAgent {
                scene: self.scene,
                agent: other.clone(),
                known: known.into_iter().map(str::to_owned).collect(),
            });
        }
        let files: Vec<String> = whole["files"]
            .as_array()
            .into_iter()
            .flatten()
            .filter_map(|f| f[0].as_str().map(str::to_owned))
            .collect();
        for camera in &self.cameras {
            let is_there =
                agents.iter().any(|agent| files.contains(&format!("sensors/{agent}/RGB-{camera}.parquet")));
            if !is_there {
                return Err(ViewError::NoCamera { agents, camera: camera.clone() });
            }
        }
        let cut = Cut { site, folder, files, frames, agents, cameras: &self.cameras };
        cut.agree_on_frames(info)?;
        Ok(cut)
    }
}

impl Cut<'_> {
    /// Readings are counted from the excerpt's first frame on, so there must be one of each kind.
    fn agree_on_frames(&self, info: &Value) -> Result<(), ViewError> {
        let mut rates = vec![("boxes".to_owned(), info["label_every_n_frames"].as_u64().unwrap_or(1))];
        for (path, rate) in self.sensor_files()?.iter().map(|(path, rate, _)| (path, *rate)) {
            rates.push((path.clone(), rate));
        }
        for path in self.files.iter().filter(|f| self.is_mask(f)) {
            rates.push((path.clone(), archive::every_n_frames(&self.open(path)?)?));
        }
        match rates.iter().find(|(_, rate)| u64::from(self.frames.0) % rate != 0) {
            None => Ok(()),
            Some((what, rate)) => Err(ViewError::Between { what: what.clone(), rate: *rate }),
        }
    }

    fn is_mask(&self, file: &str) -> bool {
        self.agents.iter().any(|agent| file == format!("bev/{agent}.npz"))
    }

    /// Sensor tables that belong to the excerpt, with every how many frames they have a row, and whether they
    /// hold points.
    fn sensor_files(&self) -> Result<Vec<(String, u64, bool)>, ViewError> {
        let mut found = Vec::new();
        for agent in &self.agents {
            let of_kind = |name: &str| format!("sensors/{agent}/{name}.parquet");
            let lidar =
                ["LIDAR", "SEG-LIDAR"].map(of_kind).into_iter().find(|path| self.files.contains(path));
            let pictures = self.cameras.iter().map(|camera| of_kind(&format!("RGB-{camera}")));
            let tables = lidar.into_iter().map(|path| (path, true)).chain(pictures.map(|path| (path, false)));
            for (path, has_points) in tables.filter(|(path, _)| self.files.contains(path)) {
                let rate = table::every_n_frames(&self.open(&path)?)?;
                found.push((path, rate, has_points));
            }
        }
        Ok(found)
    }

    fn open(&self, path: &str) -> Result<Object, ViewError> {
        let found = self.site.object(&self.key(path))?;
        found.ok_or_else(|| ViewError::NotInScene { scene: self.folder.clone(), what: path.to_owned() })
    }

    fn key(&self, path: &str) -> String {
        format!("scenes/{}/{path}", self.folder)
    }

    /// Poses, boxes, lines of the map.
    fn tables(&self) -> Result<Vec<Piece>, ViewError> {
        let rows = Rows { frames: Some(self.frames), words: vec![("agent", self.agents.clone())] };
        let agents = self.open("agents.parquet")?;
        let mut pieces = vec![(self.key("agents.parquet"), table::rows(&agents, AGENT_COLUMNS, &rows)?)];
        let merged = Rows { frames: Some(self.frames), words: Vec::new() };
        for (name, rows) in [("tracks_frames.parquet", &merged), ("boxes.parquet", &rows)] {
            if self.files.iter().any(|f| f == name) {
                pieces.push((self.key(name), table::rows(&self.open(name)?, BOX_COLUMNS, rows)?));
                break;
            }
        }
        let info = listing::scene_info(self.site, &self.folder)?;
        let map = format!("maps/{}.vector.parquet", info["map"].as_str().unwrap_or_default());
        if let Some(lines) = self.site.object(&map)? {
            let places = table::places(&agents, &rows)?;
            pieces.push((map, table::near(&lines, MAP_COLUMNS, &places, MAP_RADIUS_M)?));
        }
        Ok(pieces)
    }

    fn masks(&self) -> Result<Vec<Piece>, ViewError> {
        let masks = self.files.iter().filter(|f| self.is_mask(f));
        masks.map(|path| Ok((self.key(path), archive::frames(&self.open(path)?, self.frames)?))).collect()
    }

    fn pictures(&self) -> Result<Vec<Piece>, ViewError> {
        let mut pieces = Vec::new();
        for (path, rate, _) in self.sensor_files()?.into_iter().filter(|(_, _, has_points)| !has_points) {
            let columns = &["frame", "time_s", "image"];
            pieces.push((
                self.key(&path),
                table::readings(&self.open(&path)?, columns, self.frames, rate, None)?,
            ));
        }
        if self.cameras.is_empty() {
            return Ok(pieces);
        }
        for agent in &self.agents {
            let path = format!("sensors/{agent}/boxes_2d.parquet");
            if self.files.contains(&path) {
                let rows = Rows { frames: Some(self.frames), words: vec![("camera", self.cameras.to_vec())] };
                let columns = &["frame", "camera", "id", "class", "visible_px"];
                pieces.push((self.key(&path), table::rows(&self.open(&path)?, columns, &rows)?));
            }
        }
        Ok(pieces)
    }

    /// What a model found for the excerpt's agents at its frames, numbered from its first one on.
    fn predictions(&self) -> Result<Option<Piece>, ViewError> {
        if self.site.predictions().is_none() {
            return Ok(None);
        }
        let mut found = predictions::of_scene(self.site, &self.folder)?;
        if let Some(samples) = found["samples"].as_array_mut() {
            samples.retain(|sample| {
                let frame = sample["frame"].as_u64().unwrap_or(u64::MAX);
                let is_within = (u64::from(self.frames.0)..u64::from(self.frames.1)).contains(&frame);
                is_within && self.agents.iter().any(|agent| sample["agent"] == agent.as_str())
            });
            for sample in samples {
                let frame = sample["frame"].as_u64().unwrap_or_default();
                sample["frame"] = json!(frame - u64::from(self.frames.0));
            }
        }
        Ok(Some((format!("api/predictions/{}.json", self.folder), found.to_string().into_bytes())))
    }

    /// Lidar readings that fit into some bytes of base64, and of how many points one is kept.
    fn points(&self, room: usize) -> Result<(Vec<Piece>, usize), ViewError> {
        let tables: Vec<_> =
            self.sensor_files()?.into_iter().filter(|(_, _, has_points)| *has_points).collect();
        let thinned = |keep: usize| {
            let readings = tables.iter().map(|(path, rate, _)| {
                let points = Points { keep_one_in: keep };
                let bytes =
                    table::readings(&self.open(path)?, POINT_COLUMNS, self.frames, *rate, Some(points))?;
                Ok((self.key(path), bytes))
            });
            readings.collect::<Result<Vec<Piece>, ViewError>>()
        };
        // Bytes fall a little slower than points do: a coarse try tells where to begin.
        let trial = 8;
        let size = encoded_len(&thinned(trial)?);
        let mut keep = (2 * size * trial / (3 * room.max(1))).max(1);
        while keep <= THINNEST {
            let pieces = thinned(keep)?;
            if encoded_len(&pieces) <= room {
                return Ok((pieces, keep));
            }
            keep += 1;
        }
        Err(ViewError::TooThin(THINNEST))
    }

    fn words(&self, keep: usize) -> String {
        let frames = format!("scene {}, frames {} to {}", self.folder, self.frames.0, self.frames.1 - 1);
        let points = match keep {
            1 => "all lidar points".to_owned(),
            _ => format!("one of {keep} lidar points"),
        };
        format!("excerpt: {frames}, {} agents, {points}, to 8 mm", self.agents.len())
    }

    /// What the server says of a store, of the excerpt.
    fn lists(&self, whole: &Value, what: &str, pieces: &[Piece]) -> Vec<Piece> {
        let mut info = whole["info"].clone();
        info["frames"] = json!(self.frames.1 - self.frames.0);
        info["first_frame"] = json!(self.frames.0);
        if let Some(agents) = info["agents"].as_array_mut() {
            agents.retain(|a| {
                a["agent"].as_str().is_some_and(|name| self.agents.iter().any(|own| own == name))
            });
        }
        let start = self.key("");
        let files: Vec<Value> = pieces
            .iter()
            .filter_map(|(path, bytes)| Some(json!([path.strip_prefix(&start)?, bytes.len()])))
            .collect();
        let map_bytes =
            pieces.iter().find(|(path, _)| path.starts_with("maps/")).map_or(0, |(_, bytes)| bytes.len());
        let title = format!("{} · {}", self.folder, info["map"].as_str().unwrap_or("?"));
        let scenes = json!([{ "folder": self.folder, "title": title, "missing": [] }]);
        let dataset = listing::name(self.site).ok().flatten().unwrap_or_default();
        let lists = [
            ("api/names.json".to_owned(), listing::names()),
            (
                "api/store.json".to_owned(),
                json!({
                    "name": dataset, "scenes": scenes, "excerpt": what,
                    "predictions": predictions::about(self.site),
                }),
            ),
            (
                format!("api/scenes/{}.json", self.folder),
                json!({ "info": info, "files": files, "map_bytes": map_bytes }),
            ),
        ];
        lists.map(|(path, value)| (path, value.to_string().into_bytes())).into()
    }
}

/// Bytes of pieces as base64, with the elements around them.
fn encoded_len(pieces: &[Piece]) -> usize {
    pieces.iter().map(|(path, bytes)| bytes.len().div_ceil(3) * 4 + path.len() + 64).sum()
}
