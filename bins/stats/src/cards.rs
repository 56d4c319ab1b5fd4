//! Scenes as the report shows them: a few words and a small picture.

use std::error::Error;

use analysis::SceneCard;
use scene::{SceneReader, SensorEntry, SensorFrames, SensorKind, sensors_of};
use schema::scene_info::SceneInfo;
use schema::table::Row;
use schema::tables::CameraRow;
use schema::{AgentId, ImageKind};

/// Width of a picture, pixels, and its quality.
const WIDTH_PX: u32 = 320;
const JPEG_QUALITY: u8 = 80;
/// The frame that is shown, if there are as many: everybody has set off by then.
const FRAME: u32 = 20;

/// The card of a scene of a kind (empty: there is but one); `stats/` is where its picture's path begins.
pub(crate) fn card(info: &SceneInfo, kind: &str, has_picture: bool) -> SceneCard {
    let count = |kind: &str, words: [&str; 2]| {
        let n = info.agents.iter().filter(|agent| agent.agent.starts_with(kind)).count();
        format!("{n} {}", words[usize::from(n != 1)])
    };
    let (vehicles, rsus) = (count("vehicle_", ["vehicle", "vehicles"]), count("rsu_", ["RSU", "RSUs"]));
    SceneCard {
        scene: info.scene,
        split: info.split.clone(),
        map: info.map.clone(),
        kind: kind.to_owned(),
        words: format!("{:.0} s, {vehicles}, {rsus}", info.duration_s),
        picture: has_picture.then(|| format!("scenes/{:04}.jpg", info.scene)),
    }
}

/// What the front camera of the first agent that has one shows; none where there are no colour images.
pub(crate) fn picture(
    scene: &SceneReader,
    info: &SceneInfo,
) -> Result<Option<Vec<u8>>, Box<dyn Error + Send + Sync>> {
    if scene.manifest(CameraRow::STAGE).is_err() {
        return Ok(None);
    }
    for agent in scene.agents()? {
        let cameras: Vec<SensorEntry> = sensors_of(scene, agent)?
            .into_iter()
            .filter(|sensor| sensor.kind == SensorKind::Image(ImageKind::Rgb))
            .collect();
        let front = cameras.iter().find(|sensor| sensor.name.ends_with("CAM_FRONT"));
        if let Some(camera) = front.or(cameras.first()) {
            return of_camera(scene, info, agent, camera);
        }
    }
    Ok(None)
}

fn of_camera(
    scene: &SceneReader,
    info: &SceneInfo,
    agent: AgentId,
    camera: &SensorEntry,
) -> Result<Option<Vec<u8>>, Box<dyn Error + Send + Sync>> {
    let every = camera.about.every_n_frames.max(1);
    let last = info.frames.saturating_sub(1);
    let frame = FRAME.min(last) / every * every;
    let mut images = SensorFrames::<CameraRow>::open(scene, agent, &camera.name, (info.frames, every))?;
    let Some(row) = images.at(frame)? else { return Ok(None) };
    Ok(Some(codecs::images::shrink(&row.image.0, WIDTH_PX, JPEG_QUALITY)?))
}

#[cfg(test)]
mod tests {
    use schema::scene_info::AgentInfo;

    use super::*;

    #[test]
    fn cards_say_who_is_there() {
        let agent = |agent: &str| AgentInfo { agent: agent.into(), ..AgentInfo::default() };
        let agents = ["vehicle_0", "vehicle_1", "rsu_0"].map(agent).to_vec();
        let info = SceneInfo { scene: 7, duration_s: 12.0, agents, ..SceneInfo::default() };
        let card = card(&info, "", true);
        assert_eq!(card.words, "12 s, 2 vehicles, 1 RSU");
        assert_eq!(card.picture.as_deref(), Some("scenes/0007.jpg"));
    }
}
