//! One agent of a scene: opens its files, checks frame by frame.

use std::collections::BTreeMap;

use rayon::prelude::*;
use schema::{BevClass, Tag};

use super::bev::Masks;
use super::boxes::{self, Labelled};
use super::boxes_2d::FlatBoxes;
use super::cameras::{self, Camera, Sight};
use super::cells::CellArrays;
use super::clouds::{self, Cloud, Kind, Ranger};
use super::counts::{self, Evidence, Visible};
use super::layers::Layers;
use super::observed::Observed;
use super::voxels::Grids;
use super::{flow, inertial, ranging, scans, tables};
use crate::config::{AgentConfig, Config};
use crate::files::{Npz, Table, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::{AgentTrack, Scene};

/// An agent with its open files.
struct Agent<'a> {
    scene: &'a Scene,
    config: &'a Config,
    track: &'a AgentTrack,
    boxes: &'a [Vec<Labelled>],
    cameras: Vec<Camera>,
    rangers: Vec<Ranger>,
    visible: Option<Visible>,
    flat_boxes: Option<FlatBoxes>,
    masks: Option<Masks>,
    grids: Option<Grids>,
    observed: Option<Observed>,
    is_validated: bool,
}

/// Points that its sensors returned.
type Points = BTreeMap<(&'static str, String), u64>;

/// Checks all that belongs to an agent; its boxes by frame. `every`: of large files only each so many frames
/// are looked at.
pub(crate) fn check(
    scene: &Scene,
    config: &Config,
    name: &str,
    every: u32,
    ledger: &mut Ledger,
) -> Vec<Vec<Labelled>> {
    let Some(track) = scene.agents.get(name) else { return Vec::new() };
    let read = boxes::read(scene, config, name, track, ledger);
    let boxes = ledger.read(read).unwrap_or_default();
    let has = |stage: &str| scene.done.contains(stage);
    let about = config.agent(name);
    let mut agent = Agent {
        scene,
        config,
        track,
        boxes: &boxes,
        cameras: Vec::new(),
        rangers: Vec::new(),
        visible: None,
        flat_boxes: None,
        masks: None,
        grids: None,
        observed: None,
        is_validated: has("postprocess-valid"),
    };
    if has("render-sensors") {
        agent.open_sensors(name, &about, ledger);
        inertial::check(scene, name, track, &about, ledger);
    } else {
        for rule in [Rule::ImageIds, Rule::PointIds, Rule::DepthLidar, Rule::Flow, Rule::Gnss, Rule::Imu] {
            ledger.skip(rule, "sensors are not rendered");
        }
    }
    agent.open_masks(name, ledger);
    agent.open_grids(name, &about, ledger);
    let place = format!("scene {} {name}", scene.number);
    let frames: Vec<usize> = (0..track.rows.len().min(boxes.len())).step_by(every as usize).collect();
    let found: Vec<(Ledger, Points)> = frames
        .par_iter()
        .map(|&frame| {
            let mut ledger = Ledger::at(&place);
            let points = agent.check_frame(frame, &mut ledger);
            (ledger, points)
        })
        .collect();
    let (mut sum, mut points) = (Ledger::at(&place), Points::new());
    for (part, found) in found {
        sum.take(part);
        for (sensor, count) in found {
            *points.entry(sensor).or_default() += count;
        }
    }
    if every == 1 {
        let checked = check_partials(scene, config, name, &points, &mut sum);
        sum.read(checked);
    } else {
        sum.skip(Rule::Counts, format!("sums over frames: only every {every}th frame is looked at"));
    }
    ledger.take(sum);
    boxes
}

impl Agent<'_> {
    fn open_sensors(&mut self, name: &str, about: &AgentConfig, ledger: &mut Ledger) {
        self.cameras = cameras::open(self.scene, about, name, ledger);
        self.rangers = clouds::open(self.scene, about, name, ledger);
        if about.takes("instance") && !self.cameras.is_empty() {
            self.visible = ledger.read(counts::read_visible(self.scene, name));
        } else {
            for rule in [Rule::ImageIds, Rule::BoxPixels, Rule::Pictures] {
                ledger.skip(rule, format!("{name}: no instance images are kept"));
            }
        }
        if about.takes("boxes_2d") && !self.cameras.is_empty() {
            let read = FlatBoxes::read(self.scene, name, ledger);
            self.flat_boxes = ledger.read(read);
        } else {
            ledger.skip(Rule::FlatBoxes, format!("{name}: not asked for"));
        }
        for (taken, rule) in [
            ("semantic", Rule::Semantic),
            ("depth", Rule::DepthLidar),
            ("flow", Rule::Flow),
            ("flow", Rule::FlowIds),
        ] {
            if !about.takes(taken) {
                ledger.skip(rule, format!("{name}: no {taken} images are kept"));
            }
        }
        let mut wanted: Vec<String> = Vec::new();
        wanted.extend(about.gnss().map(|_| "GNSS".to_owned()));
        wanted.extend(about.imu().map(|_| "IMU".to_owned()));
        tables::wanted(&self.scene.file(&format!("sensors/{name}")), &wanted, ledger);
    }

    fn open_masks(&mut self, name: &str, ledger: &mut Ledger) {
        let rules = [
            Rule::BevObjects,
            Rule::BevPresent,
            Rule::BevGround,
            Rule::BevMapped,
            Rule::BevStray,
            Rule::BevHazard,
            Rule::BevIds,
            Rule::BevHeights,
            Rule::BevPaint,
        ];
        if !self.config.has_all_bev_classes() {
            rules.into_iter().for_each(|rule| ledger.skip(rule, "masks have chosen classes"));
            return;
        }
        match self.config.bev() {
            Some(size) if self.scene.done.contains("bev-gt") => {
                let archive = ledger.read(Npz::open(&self.scene.file(&format!("bev/{name}.npz"))));
                let layers = Layers::open(&self.scene.folder, name, self.config, ledger);
                let rule = self.config.foreign_bev_rule();
                self.masks = archive.map(|archive| Masks::new(archive, layers, size, rule));
            }
            _ => {
                for rule in rules {
                    ledger.skip(rule, format!("{name}: there are no masks"));
                }
            }
        }
    }

    fn open_grids(&mut self, name: &str, about: &AgentConfig, ledger: &mut Ledger) {
        if !(about.grid.enabled && self.scene.done.contains("occupancy-gt")) {
            ledger.skip(Rule::VoxelPoints, format!("{name}: there are no voxel grids"));
            ledger.skip(Rule::VoxelFill, format!("{name}: there are no voxel grids"));
            return;
        }
        if about.grid.observed && self.is_validated {
            let archive = Npz::open(&self.scene.file(&format!("occupancy_observed/{name}.npz")));
            self.observed = ledger.read(archive).map(|archive| Observed::new(about.grid, archive));
        } else {
            ledger.skip(Rule::Observed, format!("{name}: not asked for, or not validated yet"));
        }
        let folder = &self.scene.folder;
        let whose = if about.grid.sparse { "occupancy_cells" } else { "occupancy" };
        let plain = ledger.read(Npz::open(&folder.join(format!("{whose}/{name}.npz"))));
        let filled = if about.grid.sparse {
            ledger.skip(Rule::VoxelFill, format!("{name}: cells are listed"));
            None
        } else if self.is_validated {
            ledger.read(Npz::open(&folder.join(format!("occupancy_filled/{name}.npz"))))
        } else {
            ledger.skip(Rule::VoxelFill, format!("{name}: grids are not filled yet"));
            None
        };
        let cells = CellArrays::open(folder, name, &about.grid, ledger);
        self.grids = plain.map(|plain| Grids::new(about.grid, plain, filled, cells));
    }

    fn check_frame(&self, frame: usize, ledger: &mut Ledger) -> Points {
        let pose = self.track.rows[frame].world_from_agent;
        let (boxes, own) = (&self.boxes[frame], self.track.id);
        let rangers = self.rangers.iter().filter(|ranger| ranger.is_due(frame));
        let clouds: Vec<Cloud<'_>> =
            rangers.filter_map(|ranger| ledger.read(ranger.frame(self.scene, self.track, frame))).collect();
        let mut points = Points::new();
        for cloud in &clouds {
            cloud.check(self.scene, boxes, frame, ledger);
            cloud.ranger.check_reach(cloud, frame, ledger);
            let checked = scans::check(self.scene, cloud, frame, ledger);
            ledger.read(checked);
            ranging::check_velocity(self.scene, self.track, cloud, frame, ledger);
            let measure = if cloud.ranger.kind == Kind::Radar { "radar_points" } else { "lidar_points" };
            points.insert((measure, cloud.ranger.name.clone()), cloud.points.len() as u64);
            points.insert(("sweeps", cloud.ranger.name.clone()), 1);
        }
        let cameras = self.cameras.iter().filter(|camera| camera.row_of(frame).is_some());
        let sights: Vec<Sight<'_>> = cameras.map(|camera| camera.sight(frame, &pose, ledger)).collect();
        for sight in &sights {
            self.check_sight(sight, &clouds, frame, ledger);
        }
        if let Some(visible) = &self.visible {
            counts::check_visible(visible, &sights, frame, ledger);
        }
        if self.is_validated {
            let evidence = Evidence {
                clouds: &clouds,
                sights: self.visible.is_some().then_some(&sights),
                valid_by_image: self.config.valid_by_image(),
            };
            counts::check(boxes, &evidence, frame, ledger);
        } else {
            ledger.skip(Rule::Counts, "boxes are not validated yet");
        }
        let frame_number = frame as u32;
        if let Some(masks) =
            self.masks.as_ref().filter(|_| frame_number.is_multiple_of(self.config.bev_every()))
        {
            masks.check(self.scene, frame, &pose, (boxes, &clouds), ledger);
        }
        if let Some(grids) = self.grids.as_ref().filter(|grids| frame_number.is_multiple_of(grids.every())) {
            grids.check(self.scene, frame, (&pose, own), (boxes, &clouds), ledger);
        }
        if let Some(observed) = self.observed.as_ref().filter(|o| frame_number.is_multiple_of(o.every())) {
            observed.check(frame, &clouds, ledger);
        }
        points
    }

    fn check_sight(&self, sight: &Sight<'_>, clouds: &[Cloud<'_>], frame: usize, ledger: &mut Ledger) {
        let own = self.track.id;
        sight.check_ids(self.scene, frame, ledger);
        sight.check_boxes(&self.boxes[frame], own, frame, ledger);
        if let Some(flat) = &self.flat_boxes {
            flat.check(self.scene, sight, (&self.boxes[frame], own), frame, ledger);
        }
        sight.camera.check_others(sight, frame, ledger);
        for cloud in clouds.iter().filter(|cloud| cloud.ranger.kind != Kind::Radar) {
            ranging::check_depth(sight, cloud, own, frame, ledger);
        }
        let camera = sight.camera;
        let Some(pose) =
            camera.flow.as_ref().and_then(|_| self.scene.agent_pose(self.track, frame as i64 - 1))
        else {
            return;
        };
        // Before frame 0 there is no picture, but the log knows where everything was.
        let before = if frame > 0 { camera.sight(frame - 1, &pose, ledger) } else { camera.blind(&pose) };
        flow::check(self.scene, sight, &before, own, frame, ledger);
    }
}

/// What stages counted of an agent against what was counted here.
fn check_partials(
    scene: &Scene,
    config: &Config,
    name: &str,
    points: &Points,
    ledger: &mut Ledger,
) -> Result<(), Unreadable> {
    let mut wanted: BTreeMap<(String, String), u64> = BTreeMap::new();
    for ((measure, sensor), count) in points {
        wanted.insert(((*measure).to_owned(), sensor.clone()), *count);
    }
    let shares = ledger.shares.clone();
    if shares.bev_grids > 0 {
        for class in BevClass::ALL {
            for measure in ["bev_cells", "bev_heat"] {
                wanted.insert((measure.into(), class.name().into()), shares.bev_cells[class as usize]);
            }
        }
        wanted.insert(("bev_grids".into(), config.bev_rule().to_owned()), shares.bev_grids);
    }
    if shares.voxel_grids > 0 {
        for tag in Tag::ALL {
            wanted.insert(("voxel_cells".into(), tag.name().into()), shares.voxels[tag as usize]);
            if shares.filled.iter().any(|&cells| cells > 0) {
                wanted.insert(("voxel_cells_filled".into(), tag.name().into()), shares.filled[tag as usize]);
            }
        }
        wanted.insert(("voxel_grids".into(), String::new()), shares.voxel_grids);
    }
    let mut told: BTreeMap<(String, String), u64> = BTreeMap::new();
    for stage in ["render-sensors", "bev-gt", "occupancy-gt", "postprocess-valid"] {
        let path = scene.file(&format!("stats/{stage}.{name}.parquet"));
        if !(scene.done.contains(stage) && path.is_file()) {
            continue;
        }
        for rows in Table::open(&path)?.batches()? {
            let (measures, classes, counts) =
                (rows.texts("measure")?, rows.texts("class")?, rows.ints("count")?);
            for ((measure, class), count) in measures.into_iter().zip(classes).zip(counts) {
                *told.entry((measure, class)).or_default() += count.unsigned_abs();
            }
        }
    }
    for (key, wanted) in wanted {
        let said = told.get(&key).copied().unwrap_or(0);
        ledger.expect(Rule::Counts, said == wanted, || {
            format!("partial statistics: {} {} is {said}, counted {wanted}", key.0, key.1)
        });
    }
    Ok(())
}
