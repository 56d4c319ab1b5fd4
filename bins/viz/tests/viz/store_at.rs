//! A store made by hand: a vehicle at the origin that looks north and an RSU 10 m ahead of it, a car 8 m
//! ahead, two frames.

use std::collections::BTreeMap;
use std::path::Path;

use codecs::{NpzWriter, Scalar, encode_member, frame_member};
use frames::{OrientedBox, Pose};
use pictures::Canvas;
use schema::arrays::{ArrayKind, BEV_MASKS, VOXEL_GRIDS};
use schema::calibration::{Calibration, METADATA_KEY, Mounting};
use schema::scene_info::{AgentInfo, LOG_STAGE, SCENE_FILE, SceneInfo};
use schema::table::{Blob, Row};
use schema::tables::{
    AgentRow, BoxRow, CameraRow, FlowRow, FrameRow, LidarRow, PlanSceneRow, RadarRow, SemanticLidarRow,
    ValidBoxRow, VectorMapRow,
};
use schema::{AgentId, IMPORTED, Tag, ZERO_COLUMNS, is_imported};
use store::{Attempt, Identity, Scope, Store, TableOptions, Unit, keys};

pub(crate) const SCENE: u32 = 3;
pub(crate) const FRAMES: u32 = 2;
/// Width and height of the camera's images.
pub(crate) const IMAGE_PX: [u32; 2] = [64, 36];
/// Optical axes of a camera that looks along its agent's x axis.
const AHEAD: [f64; 4] = [0.5, -0.5, 0.5, -0.5];

fn stage(store: &Store, scope: Scope, (name, code_version): (&str, &str), write: impl FnOnce(&mut Unit<'_>)) {
    let identity = Identity {
        stage: name.into(),
        scope,
        code_version: code_version.into(),
        config_hash: "c".into(),
        inputs: BTreeMap::new(),
        made_by: None,
    };
    let attempt = Attempt::start(store, identity, false).expect("starts");
    let mut unit = attempt.unit("all").expect("a unit").expect("fresh");
    write(&mut unit);
    unit.finish().expect("finishes");
    attempt.commit().expect("commits");
}

/// Makes the store.
pub(crate) fn make(folder: &Path) {
    make_as(folder, "test");
}

/// Makes it as an import would: without columns of points that SimBEV2X's layout does not say, and without a
/// map.
pub(crate) fn make_imported(folder: &Path) {
    make_as(folder, IMPORTED);
}

fn make_as(folder: &Path, origin: &str) {
    let store = Store::open(folder).expect("is a place");
    store
        .write_json(keys::DATASET, "test", &serde_json::json!({"config": {"name": "hand"}}))
        .expect("writes");
    stage(&store, Scope::Plan, (PlanSceneRow::STAGE, origin), |unit| {
        let scene = PlanSceneRow { scene: SCENE, split: "train".into(), ..PlanSceneRow::default() };
        unit.rows(keys::PLAN_SCENES, &[scene]).expect("writes");
        let edge = VectorMapRow {
            kind: "lane_boundary".into(),
            x_m: vec![3.0, 3.0],
            y_m: vec![-50.0, 50.0],
            z_m: vec![0.0; 2],
            is_edge: true,
            ..VectorMapRow::default()
        };
        if !is_imported(origin) {
            unit.rows(&keys::vector_map("straight"), &[edge]).expect("writes");
        }
    });
    stage(&store, Scope::Scene(SCENE), (LOG_STAGE, origin), log);
    stage(&store, Scope::Scene(SCENE), (CameraRow::STAGE, origin), |unit| sensors(unit, is_imported(origin)));
    stage(&store, Scope::Scene(SCENE), (ValidBoxRow::STAGE, origin), |unit| {
        let seen = |b: &BoxRow| ValidBoxRow {
            frame: b.frame,
            agent: b.agent.clone(),
            id: b.id,
            class: b.class.clone(),
            valid_flag: b.id == 9,
            difficulty: "easy".into(),
            ..ValidBoxRow::default()
        };
        table(unit, &boxes().iter().map(seen).collect::<Vec<_>>());
    });
    stage(&store, Scope::Scene(SCENE), (BEV_MASKS.stage, origin), |unit| {
        // Road everywhere, a car in the middle.
        let mut masks = vec![1_u8; 20 * 20];
        masks.extend((0..400).map(|i| u8::from((8..12).contains(&(i / 20)) && (9..11).contains(&(i % 20)))));
        let about = r#"{"rule":"exact","classes":["road","car"],"cells":20,"cell_m":1.0,"every_n_frames":1}"#;
        archive(unit, &BEV_MASKS, about, Scalar::Bool, &[2, 20, 20], &masks);
    });
    stage(&store, Scope::Scene(SCENE), (VOXEL_GRIDS.stage, origin), |unit| {
        // A floor of 20 m by 20 m, a wall across it ahead.
        let (n, layers) = (40, 8);
        let cell = |i: usize| match (i / layers / n, i % layers) {
            (_, 0) => Tag::Road as u8,
            (36, _) => Tag::Building as u8,
            _ => 0,
        };
        let cells: Vec<u8> = (0..n * n * layers).map(cell).collect();
        let about = r#"{"range_m":10.0,"voxel_m":0.5,"lower_m":-0.5,"upper_m":3.5,"mount_z_m":0.0,"every_n_frames":1}"#;
        archive(unit, &VOXEL_GRIDS, about, Scalar::U8, &[n, n, layers], &cells);
    });
}

fn table<R: Row>(unit: &mut Unit<'_>, rows: &[R]) {
    unit.rows(&keys::scene(SCENE, &format!("{}.parquet", R::TABLE)), rows).expect("writes");
}

fn archive(
    unit: &mut Unit<'_>,
    kind: &ArrayKind,
    about: &str,
    scalar: Scalar,
    shape: &[usize],
    bytes: &[u8],
) {
    let mut writer = NpzWriter::new(Vec::new());
    for frame in 0..FRAMES {
        let member = encode_member(&frame_member(frame), scalar, shape, bytes, 1).expect("encodes");
        writer.append(member).expect("fits");
    }
    writer.set_comment(about).expect("is short");
    let bytes = writer.finish().expect("finishes");
    unit.bytes(&keys::array(SCENE, kind, AgentId::vehicle(0)), &bytes, u64::from(FRAMES)).expect("writes");
}

/// A car ahead that the vehicle sees, and one behind that it does not see.
fn boxes() -> Vec<BoxRow> {
    let one = |frame, id, y: f64| {
        let pose = Pose::from_xyz_rpy([0.0, y, 0.0], [0.0, 0.0, frames::deg(90.0)]);
        let corners = OrientedBox::standing(pose, 4.0, 2.0, 1.5).corners();
        BoxRow {
            frame,
            agent: "vehicle_0".into(),
            id,
            class: "car".into(),
            corners_m: std::array::from_fn(|i| corners[i / 3][i % 3]),
            ..BoxRow::default()
        }
    };
    (0..FRAMES).flat_map(|frame| [one(frame, 9, 8.0), one(frame, 10, -8.0)]).collect()
}

fn log(unit: &mut Unit<'_>) {
    let agent = |name: &str, id| AgentInfo { agent: name.into(), id, ..AgentInfo::default() };
    let info = SceneInfo {
        scene: SCENE,
        split: "train".into(),
        map: "straight".into(),
        frames: FRAMES,
        agents: vec![agent("vehicle_0", 1), agent("rsu_0", 2)],
        ..SceneInfo::default()
    };
    let json = serde_json::to_vec(&info).expect("json");
    unit.bytes(&keys::scene(SCENE, SCENE_FILE), &json, 1).expect("writes");
    let north = Pose::<frames::World, frames::Agent>::from_xyz_rpy([0.0; 3], [0.0, 0.0, frames::deg(90.0)]);
    let quaternion = north.wxyz();
    let agents = (0..FRAMES).flat_map(|frame| {
        let row = AgentRow { frame, quaternion, ..AgentRow::default() };
        let rsu = AgentRow { agent: "rsu_0".into(), id: 2, xyz_m: [0.0, 10.0, 0.0], ..row.clone() };
        [AgentRow { agent: "vehicle_0".into(), id: 1, ..row }, rsu]
    });
    table(unit, &agents.collect::<Vec<_>>());
    table(unit, &boxes());
    let frames = (0..FRAMES).map(|frame| FrameRow { frame, sun_altitude_deg: 40.0, ..FrameRow::default() });
    table(unit, &frames.collect::<Vec<_>>());
}

/// Columns of zeros of imported points.
fn zero_columns(name: &str) -> Option<&'static str> {
    match name {
        "LIDAR" => Some(r#"["intensity","ring","time_offset_s","cos_angle","id","tag"]"#),
        "SEG-LIDAR" => Some(r#"["intensity","ring","time_offset_s"]"#),
        "RAD_FRONT" => Some(r#"["rcs_dbsm","snr_db","id","tag"]"#),
        _ => None,
    }
}

/// A sensor's table.
fn sensor<R: Row>(
    unit: &mut Unit<'_>,
    (agent, is_imported): (AgentId, bool),
    name: &str,
    height_m: f64,
    row: impl Fn(u32) -> R,
) {
    let is_camera = name.contains("CAM");
    let [width, height] = IMAGE_PX;
    let matrix = [[32.0, 0.0, 32.0], [0.0, 32.0, 18.0], [0.0, 0.0, 1.0]];
    let about = Calibration {
        name: name.into(),
        frame: if is_camera { "optical" } else { "flu" }.into(),
        agent_from_sensor: Mounting {
            translation: [0.0, 0.0, height_m],
            quaternion: if is_camera { AHEAD } else { [1.0, 0.0, 0.0, 0.0] },
        },
        every_n_frames: 1,
        width: is_camera.then_some(width),
        height: is_camera.then_some(height),
        intrinsics: is_camera.then_some(matrix),
        lens: None,
    };
    let json = serde_json::to_string(&about).expect("json");
    let mut metadata = vec![(METADATA_KEY.into(), json)];
    if let Some(columns) = zero_columns(name).filter(|_| is_imported) {
        metadata.push((ZERO_COLUMNS.into(), columns.into()));
    }
    let options = TableOptions::frames(metadata);
    let mut rows = unit.table::<R>(&keys::sensor(SCENE, agent, name), options).expect("opens");
    (0..FRAMES).for_each(|frame| rows.push(&[row(frame)]).expect("writes"));
    unit.add(rows.finish().expect("finishes"));
}

fn sensors(unit: &mut Unit<'_>, is_imported: bool) {
    let ego = (AgentId::vehicle(0), is_imported);
    let grey = Canvas::new(IMAGE_PX, [128; 3]).expect("fits");
    let image = |canvas: &Canvas, is_jpeg: bool| {
        let bytes = if is_jpeg { canvas.to_jpeg(95) } else { canvas.to_png() };
        Blob(bytes.expect("encodes"))
    };
    let camera = |image: &Blob, frame| CameraRow { frame, image: image.clone(), ..CameraRow::default() };
    let photograph = image(&grey, true);
    sensor(unit, ego, "RGB-CAM_FRONT", 1.5, |frame| camera(&photograph, frame));
    // Tag 14, object 9 in the instance image; 10 m in the depth image: 167772 is 92 + 256 x 143 + 65536 x 2.
    for (name, rgb) in
        [("SEG-CAM_FRONT", [0, 0, 142]), ("IST-CAM_FRONT", [14, 9, 0]), ("DPT-CAM_FRONT", [92, 143, 2])]
    {
        let drawn = image(&Canvas::new(IMAGE_PX, rgb).expect("fits"), false);
        sensor(unit, ego, name, 1.5, |frame| camera(&drawn, frame));
    }
    let pixels = (IMAGE_PX[0] * IMAGE_PX[1]) as usize;
    sensor(unit, ego, "FLW-CAM_FRONT", 1.5, |frame| FlowRow {
        frame,
        width: IMAGE_PX[0],
        height: IMAGE_PX[1],
        dx: (0..pixels).map(|i| i as f32 / pixels as f32).collect(),
        dy: vec![0.0; pixels],
        ..FlowRow::default()
    });
    // A point on the car's roof. Of what is imported zeros stand where nobody knows.
    let (tag, id, intensity) = if is_imported { (0, 0, 0.0) } else { (14, 9, 0.5) };
    let lidar = |frame| LidarRow {
        frame,
        x: vec![8.0],
        y: vec![0.0],
        z: vec![-0.3],
        intensity: vec![intensity],
        ring: vec![3],
        tag: vec![tag],
        id: vec![id],
        ..LidarRow::default()
    };
    sensor(unit, ego, "LIDAR", 1.8, lidar);
    sensor(unit, (AgentId::rsu(0), is_imported), "LIDAR", 3.2, lidar);
    sensor(unit, ego, "SEG-LIDAR", 1.8, |frame| SemanticLidarRow {
        frame,
        x: vec![8.0],
        y: vec![0.0],
        z: vec![-0.3],
        intensity: vec![intensity],
        ring: vec![3],
        tag: vec![14],
        id: vec![9],
        ..SemanticLidarRow::default()
    });
    sensor(unit, ego, "RAD_FRONT", 0.6, |frame| RadarRow {
        frame,
        depth: vec![6.0],
        altitude: vec![0.0],
        azimuth: vec![0.0],
        velocity: vec![-5.0],
        tag: vec![tag],
        id: vec![id],
        ..RadarRow::default()
    });
}
