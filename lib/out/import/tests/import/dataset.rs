//! A small dataset, its pickles written opcode by opcode.

use std::fs;
use std::path::Path;

use codecs::{Scalar, archive_of, encode_member, npy_header, npy_object_header};

/// Frames of the scene.
pub(crate) const FRAMES: usize = 5;

/// Opcodes of values, in protocol 3 without a memo.
pub(crate) struct Pickle(pub(crate) Vec<u8>);

impl Pickle {
    fn text(&mut self, text: &str) {
        self.0.push(b'X');
        self.0.extend_from_slice(&(text.len() as u32).to_le_bytes());
        self.0.extend_from_slice(text.as_bytes());
    }

    fn float(&mut self, value: f64) {
        self.0.push(b'G');
        self.0.extend_from_slice(&value.to_be_bytes());
    }

    fn int(&mut self, value: i32) {
        self.0.push(b'J');
        self.0.extend_from_slice(&value.to_le_bytes());
    }

    fn array(&mut self, shape: &[i32], values: &[f64]) {
        self.0.extend_from_slice(
            b"cnumpy.core.multiarray\n_reconstruct\ncnumpy\nndarray\nK\x00\x85C\x01b\x87R(K\x01(",
        );
        shape.iter().for_each(|n| self.int(*n));
        self.0.extend_from_slice(b"tcnumpy\ndtype\nX\x02\0\0\0f8\x89\x88\x87R(K\x03X\x01\0\0\0<NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\x00tb\x89");
        self.0.push(b'B');
        self.0.extend_from_slice(&(8 * values.len() as u32).to_le_bytes());
        values.iter().for_each(|v| self.0.extend_from_slice(&v.to_le_bytes()));
        self.0.extend_from_slice(b"tb");
    }

    /// A car of 4 x 2 x 1.5 m that looks north, at a place on the ground.
    fn car(&mut self, id: i32, [x, y]: [f64; 2], angle_deg: f64) {
        let sign = |k: usize, bit: usize| if k & bit == 0 { -1.0 } else { 1.0 };
        let corner = |k: usize| [x + sign(k, 2), y + 2.0 * sign(k, 4), 0.75 + 0.75 * sign(k, 1)];
        let corners: Vec<f64> = (0..8).flat_map(corner).collect();
        self.0.extend_from_slice(b"}(");
        self.text("id");
        self.int(id);
        self.text("type");
        self.text("vehicle.car.sedan");
        for (key, flag) in
            [("is_alive", b'\x88'), ("is_active", b'\x88'), ("is_dormant", b'\x89'), ("parent", b'N')]
        {
            self.text(key);
            self.0.push(flag);
        }
        self.text("attributes");
        self.0.push(b'}');
        for (key, vector) in [
            ("rotation", [0.0, 0.0, 90.0]),
            ("linear_velocity", [0.0, 10.0, 0.0]),
            ("angular_velocity", [0.0, 0.0, 0.0]),
        ] {
            self.text(key);
            self.array(&[3], &vector);
        }
        self.text("semantic_tags");
        self.0.extend_from_slice(b"](K\x0ee");
        self.text("bounding_box");
        self.array(&[8, 3], &corners);
        self.text("distance_to_ego");
        self.float((x * x + y * y).sqrt());
        self.text("angle_to_ego");
        self.float(angle_deg);
        self.0.push(b'u');
    }
}

/// A file of boxes: the agent itself, id 9, and another car, id 12.
pub(crate) fn boxes(frame: usize) -> Vec<u8> {
    let mut pickle = Pickle(npy_object_header("boxes", &[2]).expect("fits"));
    pickle.0.extend_from_slice(
        b"\x80\x03cnumpy.core.multiarray\n_reconstruct\ncnumpy\nndarray\nK\x00\x85C\x01b\x87R(K\x01K\x02\x85",
    );
    pickle.0.extend_from_slice(b"cnumpy\ndtype\nX\x02\0\0\0O8\x89\x88\x87R(K\x03X\x01\0\0\0|NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\x3ftb\x89](");
    pickle.car(9, [0.0, 0.5 * frame as f64], f64::NAN);
    pickle.car(12, [8.0, 0.5 * frame as f64], -90.0);
    pickle.0.extend_from_slice(b"etb.");
    pickle.0
}

/// The masks of a frame: a cell of road, and one more each frame.
pub(crate) fn masks(frame: usize) -> Vec<u8> {
    let mut cells = vec![0; 14 * 16];
    cells[..=frame].fill(1);
    archive_of(encode_member("data.npy", Scalar::Bool, &[14, 4, 4], &cells, 2).expect("fits")).expect("fits")
}

fn lidar(frame: usize) -> Vec<u8> {
    let values: Vec<u8> = (0..30).flat_map(|k| (k as f32 + frame as f32).to_le_bytes()).collect();
    archive_of(encode_member("data.npy", Scalar::F32, &[10, 3], &values, 1).expect("fits")).expect("fits")
}

fn fix(frame: usize) -> Vec<u8> {
    let mut file = npy_header("fix", &Scalar::F64.into(), &[3]).expect("fits");
    [49.0, 8.0, frame as f64].iter().for_each(|v| file.extend_from_slice(&v.to_le_bytes()));
    file
}

/// What infos say: two scenes, of which the second has the files of the first.
pub(crate) fn infos() -> String {
    let pose = r#"{"sensor2lidar_translation": [0, 0, 0], "sensor2lidar_rotation": [1, 0, 0, 0],
        "sensor2ego_translation": [0.0, 0.0, 1.8], "sensor2ego_rotation": [1.0, 0.0, 0.0, 0.0]}"#;
    let cameras = ["CAM_FRONT_LEFT", "CAM_FRONT", "CAM_FRONT_RIGHT"];
    let others = ["CAM_BACK_LEFT", "CAM_BACK", "CAM_BACK_RIGHT", "RAD_LEFT", "RAD_RIGHT", "RAD_BACK"];
    let both = cameras.iter().chain(&["RAD_FRONT", "LIDAR", "VOXEL-GRID"]);
    let mut entries: Vec<String> = Vec::new();
    for name in both {
        entries.extend([format!("\"{name}\": {pose}"), format!("\"RSU-{name}\": {pose}")]);
    }
    entries.extend(others.iter().map(|name| format!("\"{name}\": {pose}")));
    for prefix in ["", "rsu_"] {
        entries.push(format!(r#""{prefix}camera_intrinsics": [[100.0, 0, 8], [0, 100.0, 4], [0, 0, 1]]"#));
        entries.push(format!(
            r#""{prefix}voxel_detector_properties": {{"range": 4.0, "voxel_size": 0.5, "upper_limit": 3.0, "lower_limit": -1.0}}"#
        ));
    }
    let weather = [
        "cloudiness",
        "precipitation",
        "precipitation_deposits",
        "wind_intensity",
        "sun_azimuth_angle",
        "sun_altitude_angle",
        "wetness",
        "fog_density",
        "fog_distance",
        "fog_falloff",
    ];
    let weather: Vec<String> = weather.iter().map(|name| format!("\"{name}\": 5.0")).collect();
    let scene = |number: usize| {
        let frames: Vec<String> = (0..FRAMES).map(|frame| record(number, frame)).collect();
        format!(
            r#""scene_{number:04}": {{"scene_info": {{"map": "Town03", "seed": 27, "vehicle_0": {{"vehicle": "vehicle.car.sedan"}},
            "initial_weather_parameters": {{{}}}, "n_vehicles": 1}}, "scene_data": {{"vehicle_0": [{}]}}}}"#,
            weather.join(", "),
            frames.join(", ")
        )
    };
    format!(r#"{{"metadata": {{{}}}, "data": {{{}, {}}}}}"#, entries.join(", "), scene(0), scene(1))
}

fn record(scene: usize, frame: usize) -> String {
    let y = 0.5 * frame as f64;
    let path = |name: &str| format!("/d/simbev2x/files/{name}-{frame}");
    format!(
        r#"{{"ego2global_translation": [0.0, {y}, 0.0], "ego2global_rotation": [0.7071067811865476, 0.0, 0.0, 0.7071067811865475],
        "timestamp": {}, "LIDAR": "{}", "GNSS": "{}", "GT_SEG": "{}", "GT_DET": "{}", "scene": {scene}, "frame": {frame}}}"#,
        500_000 * frame,
        path("LIDAR"),
        path("GNSS"),
        path("GT_SEG"),
        path("GT_DET"),
    )
}

/// Writes the dataset.
pub(crate) fn write(root: &Path) {
    let put = |name: &str, bytes: &[u8]| {
        let path = root.join("simbev2x").join(name);
        fs::create_dir_all(path.parent().expect("has one")).expect("made");
        fs::write(path, bytes).expect("written");
    };
    put("infos/simbev2x_infos_train.json", infos().as_bytes());
    for frame in 0..FRAMES {
        put(&format!("files/LIDAR-{frame}"), &lidar(frame));
        put(&format!("files/GNSS-{frame}"), &fix(frame));
        put(&format!("files/GT_SEG-{frame}"), &masks(frame));
        put(&format!("files/GT_DET-{frame}"), &boxes(frame));
    }
}
