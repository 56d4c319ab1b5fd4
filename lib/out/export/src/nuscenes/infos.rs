//! What mmdet3d reads of a nuScenes export: one file for each split with all samples, in the form of its
//! version 1.1 and later, and in that of 0.x, which BEVFusion and others read.
//!
//! Its own converter knows three names of versions and nuScenes' own lists of scenes, and would find no
//! sample here. Fields and conventions are those of its converter: boxes in the frame of `LIDAR_TOP`,
//! centres in the middle; sizes are length, width, height with the yaw about z in the one form, width,
//! length, height with `-yaw - pi/2` in the other; up to ten earlier sweeps.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::io;

use frames::math::atan2;
use nalgebra::{Isometry3, Matrix3, Matrix4, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use schema::nuscenes_class;

use super::boxes::category_token;
use super::mask::MapMask;
use super::options::NuScenesOptions;
use super::parts::unpack;
use super::pickle::{Pickle, Value};
use super::rig::sensor_token;
use super::rows::{Annotation, BOX_STEPS, CalibratedSensor, EgoPose, POSE_STEPS, Row, SampleData, rounded};
use super::unit::Fragment;
use super::vocabulary::CATEGORIES;
use crate::{ExportError, ExportFile, UnitFiles};

/// The lidar in whose frame boxes are.
const LIDAR: &str = "LIDAR_TOP";
/// As many earlier sweeps has a sample at most.
const MOST_SWEEPS: usize = 10;
/// Velocities are taken from boxes at most so far apart in time, and twice as far over both neighbours, s.
const MOST_APART_S: f64 = 1.5;
/// Classes in the order of mmdet3d's labels.
const CLASSES: [&str; 10] = [
    "car",
    "truck",
    "trailer",
    "bus",
    "construction_vehicle",
    "bicycle",
    "motorcycle",
    "pedestrian",
    "traffic_cone",
    "barrier",
];

/// Writes `infos/mmdet3d_SPLIT.pkl` and `infos/mmdet3d_0x_SPLIT.pkl`.
pub(crate) fn write(
    fragments: &[Fragment],
    masks: &BTreeMap<&str, MapMask>,
    options: &NuScenesOptions,
    files: &mut UnitFiles<'_>,
) -> Result<(), ExportError> {
    if options.infos.is_none() {
        return Ok(());
    }
    let mut splits: BTreeMap<&str, Vec<&Fragment>> = BTreeMap::new();
    for fragment in fragments {
        splits.entry(&fragment.split).or_default().push(fragment);
    }
    for (split, fragments) in splits {
        let mut current = InfoFile::create(files, &format!("infos/mmdet3d_{split}.pkl"), "data_list")?;
        let mut old = InfoFile::create(files, &format!("infos/mmdet3d_0x_{split}.pkl"), "infos")?;
        let mut number = 0;
        for fragment in &fragments {
            let shift = masks.get(fragment.map.as_str()).map(MapMask::global_from_world).unwrap_or_default();
            let tables = Tables::read(fragment, shift, files)?;
            for sample in tables.samples() {
                current.push(&sample.current(number))?;
                old.push(&sample.old())?;
                number += 1;
            }
        }
        let version = fragments.first().map(|fragment| fragment.version.clone()).unwrap_or_default();
        let categories = CLASSES.iter().enumerate().map(|(i, name)| (*name, Value::Int(i as i64))).collect();
        let about = Value::Dict(vec![
            ("categories", Value::Dict(categories)),
            ("dataset", Value::text("nuscenes")),
            ("version", Value::Text(version.clone())),
            ("info_version", Value::text("1.1")),
        ]);
        current.finish("metainfo", &about, files)?;
        old.finish("metadata", &Value::Dict(vec![("version", Value::Text(version))]), files)?;
    }
    Ok(())
}

/// A file of samples in the making.
struct InfoFile {
    file: ExportFile,
    pickle: Pickle,
}

impl InfoFile {
    fn create(files: &mut UnitFiles<'_>, name: &str, list: &str) -> Result<Self, ExportError> {
        let (file, mut pickle) = (files.create(name)?, Pickle::new());
        pickle.begin_dict();
        pickle.begin_entry(list);
        pickle.begin_list();
        Ok(Self { file, pickle })
    }

    fn push(&mut self, sample: &Value) -> Result<(), ExportError> {
        self.pickle.item(sample);
        self.file.write_all(&self.pickle.take())
    }

    fn finish(mut self, key: &str, about: &Value, files: &mut UnitFiles<'_>) -> Result<(), ExportError> {
        self.pickle.end_entry();
        self.pickle.begin_entry(key);
        self.pickle.put(about);
        self.pickle.end_entry();
        self.file.write_all(&self.pickle.finish())?;
        files.add(self.file)
    }
}

/// The rows of an agent of a scene.
struct Tables {
    channels: BTreeMap<String, String>,
    calibrations: BTreeMap<String, CalibratedSensor>,
    poses: BTreeMap<String, EgoPose>,
    /// Readings in the order of time, and the moment of each sample.
    readings: Vec<SampleData>,
    samples: Vec<(String, u64)>,
    /// Categories by instance, and annotations by token.
    categories: BTreeMap<String, &'static str>,
    annotations: BTreeMap<String, Annotation>,
}

impl Tables {
    fn read(fragment: &Fragment, shift: [f64; 3], files: &UnitFiles<'_>) -> Result<Self, ExportError> {
        let names = fragment.channels.iter().map(|(channel, _)| (sensor_token(channel), channel.clone()));
        let mut tables = Self {
            channels: names.collect(),
            calibrations: BTreeMap::new(),
            poses: BTreeMap::new(),
            readings: Vec::new(),
            samples: Vec::new(),
            categories: BTreeMap::new(),
            annotations: BTreeMap::new(),
        };
        let by_token: BTreeMap<String, &'static str> =
            CATEGORIES.iter().map(|(name, _)| (category_token(name), *name)).collect();
        let moved = |at: [f64; 3], steps| rounded([0, 1, 2].map(|axis| at[axis] + shift[axis]), steps);
        let broken = |source: io::Error| ExportError::Read {
            path: fragment.rows.clone().into(),
            action: "read",
            source,
        };
        for row in unpack(files.open(&fragment.rows)?).map_err(broken)? {
            match row.map_err(broken)? {
                Row::CalibratedSensor(row) => drop(tables.calibrations.insert(row.token.clone(), row)),
                Row::EgoPose(mut row) => {
                    row.translation = moved(row.translation, POSE_STEPS);
                    tables.poses.insert(row.token.clone(), row);
                }
                Row::Sample(row) => tables.samples.push((row.token, row.timestamp)),
                Row::SampleData(row) => tables.readings.push(row),
                Row::Instance(row) => {
                    let category = by_token.get(&row.category_token).copied().unwrap_or_default();
                    tables.categories.insert(row.token, category);
                }
                Row::Annotation(mut row) => {
                    row.translation = moved(row.translation, BOX_STEPS);
                    tables.annotations.insert(row.token.clone(), row);
                }
                Row::Log(_) | Row::Scene(_) | Row::LidarSeg(_) => {}
            }
        }
        tables.readings.sort_by_key(|reading| reading.timestamp);
        Ok(tables)
    }

    /// A reading with where its sensor was.
    fn reading<'a>(&'a self, of: &'a SampleData) -> Option<Reading<'a>> {
        let calibration = self.calibrations.get(&of.calibrated_sensor_token)?;
        Some(Reading {
            of,
            channel: self.channels.get(&calibration.sensor_token)?,
            calibration,
            ego: self.poses.get(&of.ego_pose_token)?,
        })
    }

    /// All samples with a sweep of the lidar, in the order of time.
    fn samples(&self) -> Vec<Sample<'_>> {
        let readings: Vec<Reading<'_>> = self.readings.iter().filter_map(|of| self.reading(of)).collect();
        let sweeps: Vec<&Reading<'_>> = readings.iter().filter(|reading| reading.channel == LIDAR).collect();
        let mut boxes: BTreeMap<&str, Vec<&Annotation>> = BTreeMap::new();
        for annotation in self.annotations.values() {
            boxes.entry(&annotation.sample_token).or_default().push(annotation);
        }
        let sample = |(token, _): &(String, u64)| -> Option<Sample<'_>> {
            let is_own =
                |reading: &&Reading<'_>| reading.of.is_key_frame && reading.of.sample_token == *token;
            let at = sweeps.iter().position(is_own)?;
            let lidar = *sweeps[at];
            let earlier = sweeps[..at].iter().rev().take(MOST_SWEEPS).map(|reading| **reading).collect();
            let is_camera = |reading: &&Reading<'_>| !reading.calibration.camera_intrinsic.is_empty();
            let cameras = readings.iter().filter(is_own).filter(is_camera).copied().collect();
            let lidar_from_global = lidar.global_from_sensor().inverse();
            let found = boxes.get(token.as_str()).into_iter().flatten();
            let boxes = found.map(|annotation| self.found(annotation, &lidar_from_global)).collect();
            Some(Sample { token: token.clone(), lidar, earlier, cameras, boxes })
        };
        self.samples.iter().filter_map(sample).collect()
    }

    /// A box in the frame of the lidar.
    fn found(&self, of: &Annotation, lidar_from_global: &Isometry3<f64>) -> FoundBox {
        let place = lidar_from_global * isometry(of.translation, of.rotation);
        let ahead = place.rotation * Vector3::x();
        let category = self.categories.get(&of.instance_token).copied().unwrap_or_default();
        let velocity = self.velocity(of).map(|v| lidar_from_global.rotation * v);
        FoundBox {
            center_m: place.translation.vector.into(),
            size_m: of.size,
            yaw_rad: atan2(ahead.y, ahead.x),
            velocity_mps: velocity.map_or([f64::NAN; 2], |v| [v.x, v.y]),
            category,
            class: nuscenes_class(category),
            points: [of.num_lidar_pts, of.num_radar_pts],
        }
    }

    /// The velocity of an annotated object in the global frame, m/s, as nuscenes-devkit takes it: from its
    /// boxes before and after, if these are near enough in time.
    fn velocity(&self, of: &Annotation) -> Option<Vector3<f64>> {
        let (before, after) = (self.annotations.get(&of.prev), self.annotations.get(&of.next));
        let most_s = if before.is_some() && after.is_some() { 2.0 * MOST_APART_S } else { MOST_APART_S };
        let (first, last) = (before.unwrap_or(of), after.unwrap_or(of));
        let time = |row: &Annotation| self.samples.iter().find(|(token, _)| *token == row.sample_token);
        let apart_s = 1e-6 * (time(last)?.1 as f64 - time(first)?.1 as f64);
        let way = Point3::from(last.translation) - Point3::from(first.translation);
        (apart_s > 0.0 && apart_s <= most_s).then(|| way / apart_s)
    }
}

fn isometry(translation: [f64; 3], [w, x, y, z]: [f64; 4]) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    Isometry3::from_parts(Translation3::from(translation), turn)
}

fn rows3(matrix: &Matrix3<f64>) -> Vec<f64> {
    matrix.transpose().iter().copied().collect()
}

/// A homogeneous matrix as rows.
fn rows4(of: &Isometry3<f64>) -> Value {
    let matrix: Matrix4<f64> = of.to_homogeneous();
    Value::rows([0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|column| matrix[(row, column)])))
}

/// A reading, and where its sensor was.
#[derive(Clone, Copy)]
struct Reading<'a> {
    of: &'a SampleData,
    channel: &'a str,
    calibration: &'a CalibratedSensor,
    ego: &'a EgoPose,
}

impl Reading<'_> {
    fn ego_from_sensor(&self) -> Isometry3<f64> {
        isometry(self.calibration.translation, self.calibration.rotation)
    }

    fn global_from_ego(&self) -> Isometry3<f64> {
        isometry(self.ego.translation, self.ego.rotation)
    }

    fn global_from_sensor(&self) -> Isometry3<f64> {
        self.global_from_ego() * self.ego_from_sensor()
    }

    fn time_s(&self) -> Value {
        Value::Float(self.of.timestamp as f64 / 1e6)
    }

    /// The name of its file without folders.
    fn file_name(&self) -> Value {
        Value::text(self.of.filename.rsplit('/').next().unwrap_or_default())
    }

    /// A sensor's reading in the form of 0.x, beside a sweep of the lidar.
    fn old(&self, kind: &str, lidar: &Reading<'_>) -> Vec<(&'static str, Value)> {
        let lidar_from_sensor = lidar.global_from_sensor().inverse() * self.global_from_sensor();
        let turn = lidar_from_sensor.rotation.to_rotation_matrix();
        vec![
            ("data_path", Value::text(&self.of.filename)),
            ("type", Value::text(kind)),
            ("sample_data_token", Value::text(&self.of.token)),
            ("sensor2ego_translation", Value::numbers(self.calibration.translation)),
            ("sensor2ego_rotation", Value::numbers(self.calibration.rotation)),
            ("ego2global_translation", Value::numbers(self.ego.translation)),
            ("ego2global_rotation", Value::numbers(self.ego.rotation)),
            ("timestamp", Value::Int(self.of.timestamp as i64)),
            ("sensor2lidar_rotation", Value::Floats(rows3(turn.matrix()), vec![3, 3])),
            (
                "sensor2lidar_translation",
                Value::Floats(lidar_from_sensor.translation.vector.iter().copied().collect(), vec![3]),
            ),
        ]
    }
}

/// A box in the frame of the lidar.
struct FoundBox {
    center_m: [f64; 3],
    /// Width, length, height.
    size_m: [f64; 3],
    yaw_rad: f64,
    velocity_mps: [f64; 2],
    category: &'static str,
    class: Option<&'static str>,
    /// Of lidars and radars.
    points: [u32; 2],
}

impl FoundBox {
    fn is_seen(&self) -> bool {
        self.points.iter().sum::<u32>() > 0
    }

    fn current(&self) -> Value {
        let label = self.class.and_then(|class| CLASSES.iter().position(|known| *known == class));
        let label = Value::Int(label.map_or(-1, |label| label as i64));
        let [x, y, z] = self.center_m;
        let [width, length, height] = self.size_m;
        let [lidar, radar] = self.points.map(|points| Value::Int(points.into()));
        Value::Dict(vec![
            ("bbox_label", label.clone()),
            ("bbox_3d", Value::numbers([x, y, z, length, width, height, self.yaw_rad])),
            ("bbox_3d_isvalid", Value::Bool(self.is_seen())),
            ("bbox_label_3d", label),
            ("num_lidar_pts", lidar),
            ("num_radar_pts", radar),
            ("velocity", Value::numbers(self.velocity_mps)),
        ])
    }
}

/// A sample with all that is said of it.
struct Sample<'a> {
    token: String,
    lidar: Reading<'a>,
    /// The sweeps before it, the latest first.
    earlier: Vec<Reading<'a>>,
    cameras: Vec<Reading<'a>>,
    boxes: Vec<FoundBox>,
}

impl Sample<'_> {
    /// In the form of 1.1 and later.
    fn current(&self, number: i64) -> Value {
        let lidar_from_global = self.lidar.global_from_sensor().inverse();
        let cameras = self.cameras.iter().map(|camera| {
            let lidar_from_camera = lidar_from_global * camera.global_from_sensor();
            let about = Value::Dict(vec![
                ("img_path", camera.file_name()),
                ("cam2img", Value::rows(camera.calibration.camera_intrinsic.iter().copied())),
                ("sample_data_token", Value::text(&camera.of.token)),
                ("timestamp", camera.time_s()),
                ("cam2ego", rows4(&camera.ego_from_sensor())),
                ("lidar2cam", rows4(&lidar_from_camera.inverse())),
            ]);
            (camera.channel.to_owned(), about)
        });
        let sweeps = self.earlier.iter().map(|sweep| {
            let sweep_from_lidar = sweep.global_from_sensor().inverse() * lidar_from_global.inverse();
            let points = Value::Dict(vec![
                ("lidar_path", Value::text(&sweep.of.filename)),
                ("lidar2ego", rows4(&sweep.ego_from_sensor())),
                ("lidar2sensor", rows4(&sweep_from_lidar)),
            ]);
            Value::Dict(vec![
                ("lidar_points", points),
                ("timestamp", sweep.time_s()),
                ("sample_data_token", Value::text(&sweep.of.token)),
                ("ego2global", rows4(&sweep.global_from_ego())),
            ])
        });
        let points = Value::Dict(vec![
            ("num_pts_feats", Value::Int(5)),
            ("lidar_path", self.lidar.file_name()),
            ("lidar2ego", rows4(&self.lidar.ego_from_sensor())),
        ]);
        Value::Dict(vec![
            ("sample_idx", Value::Int(number)),
            ("token", Value::text(&self.token)),
            ("timestamp", self.lidar.time_s()),
            ("ego2global", rows4(&self.lidar.global_from_ego())),
            ("images", Value::Named(cameras.collect())),
            ("lidar_points", points),
            ("instances", Value::List(self.boxes.iter().map(FoundBox::current).collect())),
            ("lidar_sweeps", Value::List(sweeps.collect())),
        ])
    }

    /// In the form of 0.x.
    fn old(&self) -> Value {
        let Reading { of, calibration, ego, .. } = self.lidar;
        let cameras = self.cameras.iter().map(|camera| {
            let mut about = camera.old(camera.channel, &self.lidar);
            let intrinsic = camera.calibration.camera_intrinsic.iter().flatten().copied().collect();
            about.push(("cam_intrinsic", Value::Floats(intrinsic, vec![3, 3])));
            (camera.channel.to_owned(), Value::Dict(about))
        });
        let sweeps = self.earlier.iter().map(|sweep| Value::Dict(sweep.old("lidar", &self.lidar)));
        let count = self.boxes.len();
        let boxes = self.boxes.iter().flat_map(|found| {
            let ([x, y, z], [width, length, height]) = (found.center_m, found.size_m);
            [x, y, z, width, length, height, -found.yaw_rad - FRAC_PI_2]
        });
        let points = |which: usize| {
            Value::Ints(self.boxes.iter().map(|found| i64::from(found.points[which])).collect())
        };
        let names = self.boxes.iter().map(|found| found.class.unwrap_or(found.category).to_owned());
        let velocities = self.boxes.iter().flat_map(|found| found.velocity_mps).collect();
        Value::Dict(vec![
            ("lidar_path", Value::text(&of.filename)),
            ("token", Value::text(&self.token)),
            ("sweeps", Value::List(sweeps.collect())),
            ("cams", Value::Named(cameras.collect())),
            ("lidar2ego_translation", Value::numbers(calibration.translation)),
            ("lidar2ego_rotation", Value::numbers(calibration.rotation)),
            ("ego2global_translation", Value::numbers(ego.translation)),
            ("ego2global_rotation", Value::numbers(ego.rotation)),
            ("timestamp", Value::Int(of.timestamp as i64)),
            ("gt_boxes", Value::Floats(boxes.collect(), vec![count, 7])),
            ("gt_names", Value::Texts(names.collect())),
            ("gt_velocity", Value::Floats(velocities, vec![count, 2])),
            ("num_lidar_pts", points(0)),
            ("num_radar_pts", points(1)),
            ("valid_flag", Value::Bools(self.boxes.iter().map(FoundBox::is_seen).collect())),
        ])
    }
}
