//! Which sensors of an agent become which channels, and at which frames.

use scene::{SensorEntry, SensorKind};
use schema::{AgentId, ImageKind};
use settings::Lens;

use super::options::NuScenesOptions;
use super::rows::token;
use super::vocabulary::{Modality, channel};
use crate::{ExportError, SceneSource};

/// A sensor under its name in the layout.
#[derive(Clone, Debug)]
pub(crate) struct Channel {
    pub(crate) name: String,
    pub(crate) modality: Modality,
    pub(crate) sensor: SensorEntry,
}

impl Channel {
    /// The token of a channel in the table of sensors.
    pub(crate) fn sensor_token(&self) -> String {
        sensor_token(&self.name)
    }
}

pub(crate) fn sensor_token(channel: &str) -> String {
    token(&format!("sensor {channel}"))
}

/// The channels of an agent.
#[derive(Clone, Debug)]
pub(crate) struct Rig {
    /// By name; one is `LIDAR_TOP`.
    pub(crate) channels: Vec<Channel>,
    /// Sensors that have no place, and why.
    pub(crate) left_out: Vec<(SensorEntry, &'static str)>,
}

impl Rig {
    /// The channels of an agent's wanted sensors.
    ///
    /// # Errors
    /// Its tables cannot be read, or it has no lidar.
    pub(crate) fn of(scene: &SceneSource, agent: AgentId) -> Result<Self, ExportError> {
        let sensors = scene.sensors(agent)?;
        let lidars: Vec<&SensorEntry> = sensors.iter().filter(|s| s.kind == SensorKind::Lidar).collect();
        let top = lidars.iter().find(|s| s.name == "LIDAR").or(lidars.first()).map(|s| s.name.clone());
        let Some(top) = top else {
            return Err(ExportError::Content {
                scene: scene.number(),
                frame: None,
                agent: Some(agent.to_string()),
                problem: "has no lidar, and every sample must have a LIDAR_TOP (choose other agents with --agents, or more \
                          sensors with --sensors)"
                    .to_owned(),
            });
        };
        let (mut channels, mut left_out) = (Vec::new(), Vec::new());
        for sensor in sensors {
            if let Some(why) = no_place(&sensor) {
                left_out.push((sensor, why));
            } else if let Some((name, modality)) = channel(&sensor, sensor.name == top) {
                channels.push(Channel { name, modality, sensor });
            }
        }
        channels.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(Self { channels, left_out })
    }
}

/// Whether a channel's points have labels: those of `LIDAR_TOP`, if they are wanted and their tags are known.
///
/// # Errors
/// Its table cannot be read.
pub(crate) fn is_labelled(
    scene: &SceneSource,
    agent: AgentId,
    channel: &Channel,
    options: &NuScenesOptions,
) -> Result<bool, ExportError> {
    if !options.lidarseg || channel.name != "LIDAR_TOP" {
        return Ok(false);
    }
    Ok(!scene.unknown_columns(agent, &channel.sensor)?.contains("tag"))
}

/// Why a sensor has no place in the layout.
fn no_place(sensor: &SensorEntry) -> Option<&'static str> {
    let bends = sensor.about.lens.is_some_and(|lens| lens != Lens::Pinhole);
    match sensor.kind {
        SensorKind::Image(ImageKind::Rgb) if bends || sensor.about.intrinsics.is_none() => {
            Some("calibrations of the layout are those of pinholes")
        }
        SensorKind::Image(ImageKind::Rgb) | SensorKind::Lidar | SensorKind::Radar => None,
        SensorKind::Image(_) => Some("the layout has no place for them"),
        SensorKind::SemanticLidar => {
            Some("the layout has no place for it: lidarseg has the lidar's own tags")
        }
        SensorKind::Gnss | SensorKind::Imu => Some("they would belong to the CAN bus expansion"),
    }
}

/// Every how many frames of the log a scene's samples stand: the least multiple of all wanted agents' and
/// labels' rates that is not below what is wanted, so that every sample has all channels and boxes.
///
/// # Errors
/// As [`Rig::of`].
pub(crate) fn sample_step(scene: &SceneSource, options: &NuScenesOptions) -> Result<u32, ExportError> {
    // The second of the wanted frames is their distance.
    let wanted = scene.frames().nth(1).unwrap_or(1);
    let mut step = common_step(wanted, scene.info().label_every_n_frames);
    for agent in scene.agents() {
        for channel in Rig::of(scene, *agent)?.channels {
            step = common_step(step, channel.sensor.about.every_n_frames);
        }
    }
    Ok(step.saturating_mul(options.sample_every_n_frames.max(1).div_ceil(step)))
}

/// The least common multiple of two rates.
fn common_step(a: u32, b: u32) -> u32 {
    let (a, b) = (a.max(1), b.max(1));
    let (mut divisor, mut rest) = (a, b);
    while rest > 0 {
        (divisor, rest) = (rest, divisor % rest);
    }
    (a / divisor).saturating_mul(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_least_common_multiples() {
        for (a, b, expected) in [(1, 1, 1), (0, 3, 3), (4, 6, 12), (7, 11, 77), (10, 5, 10)] {
            assert_eq!(common_step(a, b), expected, "{a} {b}");
        }
    }
}
