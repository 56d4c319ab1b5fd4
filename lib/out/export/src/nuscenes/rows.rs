//! Rows of the tables, with the fields that devkits read, in their order.

use serde::{Deserialize, Serialize};
use store::hash_bytes;

/// The token of a thing: 32 hexadecimal digits of a digest of the words that name it.
pub(crate) fn token(words: &str) -> String {
    hash_bytes(words.as_bytes())[..32].to_owned()
}

/// Numbers to so many steps a unit: tables of millions of rows need not carry more than is meant.
pub(crate) fn rounded<const N: usize>(values: [f64; N], steps: f64) -> [f64; N] {
    // Adding zero makes a plain one of -0.
    values.map(|value| (value * steps).round() / steps + 0.0)
}

/// Steps of a metre in places and sizes of boxes.
pub(crate) const BOX_STEPS: f64 = 1e4;
/// Steps of a metre in places of agents, and of one in components of quaternions.
pub(crate) const POSE_STEPS: f64 = 1e9;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Log {
    pub(crate) token: String,
    pub(crate) logfile: String,
    pub(crate) vehicle: String,
    pub(crate) date_captured: String,
    pub(crate) location: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Scene {
    pub(crate) token: String,
    pub(crate) log_token: String,
    pub(crate) nbr_samples: u32,
    pub(crate) first_sample_token: String,
    pub(crate) last_sample_token: String,
    pub(crate) name: String,
    pub(crate) description: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CalibratedSensor {
    pub(crate) token: String,
    pub(crate) sensor_token: String,
    pub(crate) translation: [f64; 3],
    pub(crate) rotation: [f64; 4],
    pub(crate) camera_intrinsic: Vec<[f64; 3]>,
}

/// Where an agent is; in the parts of a unit in the world, in the table in the global frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct EgoPose {
    pub(crate) token: String,
    pub(crate) timestamp: u64,
    pub(crate) rotation: [f64; 4],
    pub(crate) translation: [f64; 3],
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Sample {
    pub(crate) token: String,
    pub(crate) timestamp: u64,
    pub(crate) prev: String,
    pub(crate) next: String,
    pub(crate) scene_token: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SampleData {
    pub(crate) token: String,
    pub(crate) sample_token: String,
    pub(crate) ego_pose_token: String,
    pub(crate) calibrated_sensor_token: String,
    pub(crate) timestamp: u64,
    pub(crate) fileformat: String,
    pub(crate) is_key_frame: bool,
    pub(crate) height: u32,
    pub(crate) width: u32,
    pub(crate) filename: String,
    pub(crate) prev: String,
    pub(crate) next: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Instance {
    pub(crate) token: String,
    pub(crate) category_token: String,
    pub(crate) nbr_annotations: u32,
    pub(crate) first_annotation_token: String,
    pub(crate) last_annotation_token: String,
}

/// A box; as [`EgoPose`] in the world or in the global frame. `size` is width, length, height.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Annotation {
    pub(crate) token: String,
    pub(crate) sample_token: String,
    pub(crate) instance_token: String,
    pub(crate) visibility_token: String,
    pub(crate) attribute_tokens: Vec<String>,
    pub(crate) translation: [f64; 3],
    pub(crate) size: [f64; 3],
    pub(crate) rotation: [f64; 4],
    pub(crate) prev: String,
    pub(crate) next: String,
    pub(crate) num_lidar_pts: u32,
    pub(crate) num_radar_pts: u32,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct LidarSeg {
    pub(crate) token: String,
    pub(crate) sample_data_token: String,
    pub(crate) filename: String,
}

/// A row of a unit, for one of the tables.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Row {
    Log(Log),
    Scene(Scene),
    CalibratedSensor(CalibratedSensor),
    EgoPose(EgoPose),
    Sample(Sample),
    SampleData(SampleData),
    Instance(Instance),
    Annotation(Annotation),
    LidarSeg(LidarSeg),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_tell_words_apart() {
        let (a, b) = (token("scene 1 vehicle_0"), token("scene 1 vehicle_1"));
        assert!(a != b && a.len() == 32 && a.bytes().all(|c| c.is_ascii_hexdigit()));
        assert_eq!(a, token("scene 1 vehicle_0"));
    }

    #[test]
    fn numbers_are_rounded() {
        assert_eq!(rounded([1.234_56, -0.000_04, 2.0], 1e4), [1.2346, 0.0, 2.0]);
        assert_eq!(serde_json::to_string(&rounded([-0.000_01], 1e4)).expect("numbers"), "[0.0]");
    }
}
