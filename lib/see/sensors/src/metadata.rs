//! What a sensor's table says about the sensor itself: its pose and intrinsics, as JSON.

use frames::{Agent, Frame, Pose};
use schema::calibration::{Calibration, Mounting};
use settings::{CameraSettings, CameraSpec, Mount};

/// Pose and rate of a sensor in its agent's frame, as JSON of a [`Calibration`].
#[must_use]
pub fn sensor_metadata(name: &str, mount: &Mount, every_n_frames: u32) -> String {
    text(&calibration(name, "flu", &mount.agent_from_sensor(), every_n_frames))
}

/// The same for a camera, whose pose is that of its optical frame (x right, y down, z forward), with size and
/// intrinsics.
#[must_use]
pub fn camera_metadata(camera: &CameraSpec, settings: &CameraSettings) -> String {
    let agent_from_optical = camera.mount.agent_from_sensor() * frames::flu_from_optical();
    text(&Calibration {
        width: Some(camera.optics.width),
        height: Some(camera.optics.height),
        intrinsics: Some(camera.optics.matrix()),
        lens: Some(camera.optics.lens),
        ..calibration(&camera.name, "optical", &agent_from_optical, settings.every_n_frames)
    })
}

fn calibration<F: Frame>(
    name: &str,
    frame: &str,
    agent_from_sensor: &Pose<Agent, F>,
    every_n_frames: u32,
) -> Calibration {
    Calibration {
        name: name.to_owned(),
        frame: frame.to_owned(),
        agent_from_sensor: Mounting::new(agent_from_sensor),
        every_n_frames,
        width: None,
        height: None,
        intrinsics: None,
        lens: None,
    }
}

fn text(calibration: &Calibration) -> String {
    // Strings and numbers: writing them cannot fail.
    serde_json::to_string(calibration).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};
    use settings::Rig;

    #[test]
    fn the_front_left_camera_is_described_as_published() {
        let rig = Rig::vehicle();
        let value: Value =
            serde_json::from_str(&camera_metadata(&rig.cameras[0], &rig.camera)).expect("is JSON");
        assert_eq!(value["name"], "CAM_FRONT_LEFT");
        assert_eq!(value["agent_from_sensor"]["translation"], json!([0.4, 0.4, 1.6]));
        let want = [0.674_379_7, -0.674_379_7, 0.212_631_1, -0.212_631_1];
        for (i, want) in want.iter().enumerate() {
            let got = value["agent_from_sensor"]["quaternion"][i].as_f64().expect("is a number");
            assert!((got - want).abs() < 1e-7, "{got} {want}");
        }
        assert_eq!(value["lens"], json!({"model": "pinhole"}));
        let focal = value["intrinsics"][0][0].as_f64().expect("is a number");
        assert!((focal - 953.402_874_075_368_1).abs() < 1e-9);
    }

    #[test]
    fn names_are_escaped() {
        let text = sensor_metadata("a\"b", &Mount::upright([0.0, 0.0, 1.8], 0.0), 2);
        let value: Value = serde_json::from_str(&text).expect("is JSON");
        assert_eq!(value["name"], "a\"b");
        assert_eq!(value["agent_from_sensor"]["quaternion"], json!([1.0, 0.0, 0.0, 0.0]));
        assert_eq!(value["every_n_frames"], 2);
    }
}
