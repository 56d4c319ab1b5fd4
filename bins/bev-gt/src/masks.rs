//! The masks of an agent, and the layers beside them.

use std::borrow::Cow;

use codecs::Scalar;
use labels::bev::{BevRasterizer, LaneRasterizer};
use replay::Replay;
use runner::frames::{FrameArray, FrameArrays};
use runner::{At, Place, StageError};
use schema::AgentId;
use schema::arrays::{ArrayKind, BEV_HEIGHTS, BEV_IDS, BEV_MASKS, BEV_PAINT};
use schema::measures::counts::PartialCounts;
use settings::BevSettings;

use crate::sources::{AgentLanes, SceneAreas};

/// How an agent's masks are drawn.
pub(crate) enum Rule {
    Exact,
    Simbev2x(AgentLanes),
}

/// The masks of an agent.
pub(crate) struct Masks<'a> {
    pub(crate) replay: &'a Replay,
    pub(crate) position: usize,
    pub(crate) agent: AgentId,
    pub(crate) settings: &'a BevSettings,
    pub(crate) areas: &'a SceneAreas,
    pub(crate) rule: Rule,
}

impl FrameArrays for Masks<'_> {
    type Memory = (BevRasterizer, LaneRasterizer);

    fn every_n_frames(&self) -> u32 {
        self.settings.every_n_frames
    }

    fn kinds(&self) -> Vec<&'static ArrayKind> {
        let BevSettings { paint, ids, heights, .. } = *self.settings;
        let wanted = [(true, &BEV_MASKS), (paint, &BEV_PAINT), (ids, &BEV_IDS), (heights, &BEV_HEIGHTS)];
        wanted.into_iter().filter(|(wanted, _)| *wanted).map(|(_, kind)| kind).collect()
    }

    fn comment(&self) -> Result<String, StageError> {
        self.settings.describe().at(|| Place::default().agent(self.agent))
    }

    fn memory(&self) -> Result<Self::Memory, StageError> {
        let place = || Place::default().agent(self.agent);
        Ok((BevRasterizer::new(self.settings).at(place)?, LaneRasterizer::new(self.settings).at(place)?))
    }

    /// Masks by the rule; the layers beside them are exact whatever the rule.
    fn arrays<'m>(
        &self,
        (exact, by_lanes): &'m mut Self::Memory,
        frame: u32,
        counts: &mut PartialCounts,
    ) -> Result<Vec<FrameArray<'m>>, StageError> {
        let settings = self.settings;
        let pose = self.replay.log.world_from_agent(self.position, frame);
        let snapshot = self.replay.snapshot(frame, pose.xyz(), settings.reach_m());
        let mut draw_exact = || exact.rasterize(&snapshot, &pose, self.areas.areas());
        let mask = match &self.rule {
            Rule::Exact => draw_exact(),
            Rule::Simbev2x(lanes) => {
                if settings.paint || settings.ids || settings.heights {
                    draw_exact();
                }
                let view = lanes.view(self.replay, self.areas, self.position, frame);
                by_lanes.rasterize(&snapshot, &pose, view)
            }
        };
        mask.add_to(counts, &self.agent.to_string(), settings);
        let cells = settings.cells as usize;
        let array = |scalar, channels: Option<usize>, bytes: Vec<u8>| {
            let shape = channels.into_iter().chain([cells, cells]).collect();
            FrameArray { scalar, shape, bytes: Cow::Owned(bytes) }
        };
        let classes = &settings.classes;
        let mut arrays = vec![array(Scalar::Bool, Some(classes.len()), mask.to_bytes(classes))];
        if settings.paint {
            arrays.push(array(Scalar::Bool, Some(3), exact.paint_bytes(&pose, self.areas.paint())));
        }
        if settings.ids {
            arrays.push(array(Scalar::U16, None, exact.id_bytes()));
        }
        if settings.heights {
            arrays.push(array(Scalar::F32, None, exact.height_bytes()));
        }
        Ok(arrays)
    }
}
