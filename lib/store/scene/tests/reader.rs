//! A small scene in memory, read through its manifests.

use std::collections::BTreeMap;

use frames::{Agent, Pose, Sensor};
use nalgebra::Point3;
use scene::{ArrayReader, SceneError, SceneLog, SceneReader, SensorFrames, agent_rows, read_calibration};
use schema::arrays::BEV_MASKS;
use schema::calibration::{Calibration, METADATA_KEY, Mounting};
use schema::scene_info::{AgentInfo, LOG_STAGE, SCENE_FILE, SceneInfo};
use schema::table::{Blob, Row};
use schema::tables::{
    ActorRow, AgentRow, CameraRow, FrameRow, GnssRow, LampRow, SignalRow, StateRow, VisibleRow,
};
use schema::{AgentId, FRAME_PERIOD_S};
use settings::Lens;
use store::{Attempt, Identity, Scope, Store, StoreError, TableOptions, Unit, keys};

const SCENE: u32 = 7;
const FRAMES: u32 = 3;

fn ego() -> AgentId {
    AgentId::vehicle(0)
}

/// Does a stage of the scene.
fn stage(store: &Store, name: &str, write: impl FnOnce(&mut Unit<'_>)) {
    let identity = Identity {
        stage: name.into(),
        scope: Scope::Scene(SCENE),
        code_version: "test".into(),
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

fn table<R: Row>(unit: &mut Unit<'_>, rows: &[R]) {
    unit.rows(&keys::scene(SCENE, &format!("{}.parquet", R::TABLE)), rows).expect("writes");
}

/// A vehicle (object 1) that goes 1 m a frame along x, and an RSU (object 2); rows of `states` in a given
/// order of frames.
fn log(store: &Store, order: &[i32]) {
    let agent = |name: &str, id| AgentInfo { agent: name.into(), id, ..AgentInfo::default() };
    let info = SceneInfo {
        scene: SCENE,
        frames: FRAMES,
        agents: vec![agent("vehicle_0", 1), agent("rsu_0", 2)],
        ..SceneInfo::default()
    };
    let at = |frame: i32| [f64::from(frame), 2.0, 0.5];
    let quaternion = [1.0, 0.0, 0.0, 0.0];
    let agents = (0..FRAMES).flat_map(|frame| {
        let row = AgentRow { frame, quaternion, ..AgentRow::default() };
        [
            AgentRow { agent: "vehicle_0".into(), id: 1, xyz_m: at(frame as i32), ..row.clone() },
            AgentRow { agent: "rsu_0".into(), id: 2, xyz_m: [9.0, 9.0, 0.0], ..row },
        ]
    });
    let state = |&frame: &i32| StateRow { frame, id: 1, xyz_m: at(frame), quaternion, ..StateRow::default() };
    let signals = [-1, 0, 2].map(|frame| SignalRow { frame, id: 3, ..SignalRow::default() });
    let time_s = |frame: u32| f64::from(frame) * FRAME_PERIOD_S;
    let frames = (0..FRAMES).map(|frame| FrameRow { frame, time_s: time_s(frame), ..FrameRow::default() });
    stage(store, LOG_STAGE, |unit| {
        let json = serde_json::to_vec(&info).expect("json");
        unit.bytes(&keys::scene(SCENE, SCENE_FILE), &json, 1).expect("writes");
        table(unit, &[ActorRow { id: 1, ..ActorRow::default() }]);
        table::<LampRow>(unit, &[]);
        table(unit, &agents.collect::<Vec<_>>());
        table(unit, &order.iter().map(state).collect::<Vec<_>>());
        table(unit, &signals);
        table(unit, &frames.collect::<Vec<_>>());
    });
}

fn memory() -> Store {
    Store::open("memory:").expect("is a place")
}

fn open(store: &Store) -> SceneReader {
    SceneReader::open(store, SCENE, &[LOG_STAGE, "render-sensors", "bev-gt"]).expect("opens")
}

#[test]
fn the_log_has_each_frame_and_the_one_before_the_first() {
    let store = memory();
    log(&store, &[-1, 0, 1, 2]);
    let log = SceneLog::read(&open(&store)).expect("reads");
    assert_eq!((log.frame_count(), log.agent_ids()), (3, &[ego(), AgentId::rsu(0)][..]));
    for frame in -1..3 {
        let xs: Vec<f64> = log.states_at(frame).iter().map(|s| s.xyz_m[0]).collect();
        assert_eq!(xs, [frame as f64]);
    }
    assert!(log.states_at(-2).is_empty() && log.states_at(3).is_empty());
    let signals = [-1, 0, 1, 2].map(|frame| log.signals_at(frame).len());
    assert_eq!(signals, [1, 1, 0, 1]);
    for frame in 0..3 {
        assert_eq!(log.world_from_agent(0, frame).xyz()[0], f64::from(frame));
        assert_eq!(log.world_from_agent(1, frame).xyz(), [9.0, 9.0, 0.0]);
    }
}

#[test]
fn unsorted_states_are_refused_by_row() {
    let store = memory();
    log(&store, &[-1, 1, 0, 2]);
    let error = SceneLog::read(&open(&store)).expect_err("out of order");
    assert!(matches!(error, SceneError::Order { row: 2, frame: 0, .. }), "{error}");
    assert!(error.to_string().contains("log/states.parquet"), "{error}");
}

#[test]
fn facts_are_read_through_the_manifest() {
    let store = memory();
    log(&store, &[-1, 0, 1, 2]);
    let reader = open(&store);
    assert_eq!(reader.info().expect("reads").frames, FRAMES);
    // Another file in its place is not believed.
    let key = keys::scene(SCENE, SCENE_FILE);
    store.write_json(&key, LOG_STAGE, &SceneInfo::default()).expect("writes");
    assert!(matches!(reader.info(), Err(SceneError::Store(StoreError::Size { .. }))));
    store.backend().remove(&key).expect("removes");
    assert!(matches!(reader.info(), Err(SceneError::Store(StoreError::Missing { .. }))));
    // Nor is anything read whose manifest was not handed over.
    let blind = SceneReader::new(&store, SCENE, []);
    assert!(matches!(blind.info(), Err(SceneError::NotMade { scene: SCENE, stage: LOG_STAGE })));
}

#[test]
fn sensors_give_one_row_a_frame_and_say_what_is_wrong() {
    let store = memory();
    let calibration = Calibration {
        name: "CAM_FRONT".into(),
        frame: "optical".into(),
        agent_from_sensor: Mounting { translation: [1.0, 2.0, 3.0], quaternion: [0.0, 0.0, 0.0, 1.0] },
        every_n_frames: 1,
        width: Some(64),
        height: Some(32),
        intrinsics: Some([[10.0, 0.0, 32.0], [0.0, 10.0, 16.0], [0.0, 0.0, 1.0]]),
        lens: Some(Lens::Brown { k: [-0.3, 0.1, 0.0], p: [1e-3, 0.0] }),
    };
    let json = serde_json::to_string(&calibration).expect("json");
    stage(&store, "render-sensors", |unit| {
        let options = TableOptions::frames(vec![(METADATA_KEY.into(), json)]);
        let key = keys::sensor(SCENE, ego(), "RGB-CAM_FRONT");
        let mut images = unit.table::<CameraRow>(&key, options).expect("opens");
        for frame in 0..FRAMES {
            let image = Blob(vec![frame as u8; 5]);
            images.push(&[CameraRow { frame, image, ..CameraRow::default() }]).expect("writes");
        }
        unit.add(images.finish().expect("finishes"));
        let gap = [0, 2].map(|frame| GnssRow { frame, ..GnssRow::default() });
        unit.rows(&keys::sensor(SCENE, ego(), "GNSS"), &gap).expect("writes");
        let visible = [0, 0, 2].map(|frame| VisibleRow { frame, pixels: 5, ..VisibleRow::default() });
        unit.rows(&keys::sensor(SCENE, ego(), "visible"), &visible).expect("writes");
    });
    let reader = open(&store);
    let images = |frames| {
        SensorFrames::<CameraRow>::open(&reader, ego(), "RGB-CAM_FRONT", (frames, 1)).expect("opens")
    };
    let first: Vec<u8> = images(FRAMES).map(|row| row.expect("reads").image.0[0]).collect();
    assert_eq!(first, [0, 1, 2]);
    let last = images(FRAMES + 1).last().expect("an end");
    assert!(matches!(last, Err(SceneError::Frame { expected: 3, found: None, .. })));
    // At every other frame it is whole; at every frame it has a gap.
    let gnss = |every| SensorFrames::<GnssRow>::open(&reader, ego(), "GNSS", (FRAMES, every)).expect("opens");
    assert_eq!(gnss(2).map(|row| row.expect("reads").frame).collect::<Vec<_>>(), [0, 2]);
    // Frames may be passed over; in groups of one row, and within one of many.
    let mut some = images(FRAMES);
    let at = |frame: u32, some: &mut SensorFrames<CameraRow>| {
        some.at(frame).map(|row| row.map(|row| row.image.0[0]))
    };
    assert_eq!(at(2, &mut some).expect("reads"), Some(2));
    assert!(matches!(at(1, &mut some), Err(SceneError::Frame { expected: 1, .. })), "only ahead");
    let mut some = images(FRAMES);
    assert_eq!([0, 2].map(|frame| at(frame, &mut some).expect("reads")), [Some(0), Some(2)]);
    assert_eq!(at(FRAMES, &mut some).expect("is past the end"), None);
    assert_eq!(gnss(2).at(2).expect("reads").map(|row| row.frame), Some(2));
    assert_eq!(gnss(2).at(1).expect("is not due"), None);
    assert!(matches!(gnss(1).at(1), Err(SceneError::Frame { expected: 1, found: Some(2), .. })));
    let mut gap = gnss(1);
    assert!(gap.next().is_some_and(|row| row.is_ok()));
    assert!(matches!(gap.next(), Some(Err(SceneError::Frame { expected: 1, found: Some(2), .. }))));
    assert!(gap.next().is_none(), "nothing after an error");
    assert_eq!(agent_rows::<VisibleRow>(&reader, ego(), "visible").expect("reads").len(), 3);

    let read = read_calibration::<CameraRow>(&reader, ego(), "RGB-CAM_FRONT").expect("reads");
    assert_eq!(read, calibration);
    // Half a turn about z.
    let agent_from_sensor: Pose<Agent, Sensor> = read.agent_from_sensor.agent_from_sensor();
    let there = agent_from_sensor.isometry() * Point3::new(1.0, 0.0, 0.0);
    assert!((there - Point3::new(0.0, 2.0, 3.0)).norm() < 1e-12);
    let silent = read_calibration::<GnssRow>(&reader, ego(), "GNSS");
    assert!(matches!(silent, Err(SceneError::NoCalibration { .. })));
}

#[test]
fn broken_archives_name_their_stage() {
    let store = memory();
    let key = keys::array(SCENE, &BEV_MASKS, ego());
    stage(&store, "bev-gt", |unit| unit.bytes(&key, b"no archive", 1).expect("writes"));
    let opened = ArrayReader::open(&open(&store), &BEV_MASKS, ego(), 1000);
    let Err(error) = opened else { panic!("is no archive") };
    assert!(error.to_string().contains("run bev-gt for scene 7 again"), "{error}");
    assert!(error.to_string().contains(&key), "{error}");
}
