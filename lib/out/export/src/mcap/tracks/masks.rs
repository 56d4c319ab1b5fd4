//! BEV masks as one coloured grid.

use frames::{Agent, Pose as TypedPose, World};
use scene::ArrayReader;
use schema::arrays::BEV_MASKS;
use schema::tables::AgentRow;
use schema::{AgentId, BevClass};
use serde::Deserialize;

use super::Track;
use crate::mcap::chunk::Messages;
use crate::mcap::messages::{Grid, Pose, Timestamp, Vector2};
use crate::mcap::packed::{Packed, Values, pack};
use crate::mcap::topics::{Topic, Topics};
use crate::{ExportError, SceneSource};

/// Opacity of cells that have a class.
const ALPHA: u8 = 200;
/// The grid lies this far below the agent's origin, so that it does not fight with roads and boxes for the
/// same pixels, m.
const BELOW_M: f64 = 0.05;

/// What an archive of masks says of itself.
#[derive(Debug, Deserialize)]
struct Description {
    classes: Vec<String>,
    cells: u32,
    cell_m: f64,
    every_n_frames: u32,
}

/// An agent's masks.
pub(crate) struct MaskTrack {
    masks: ArrayReader,
    about: Description,
    colours: Vec<[u8; 3]>,
    topic: Topic<Grid>,
    poses: Vec<AgentRow>,
    scene: u32,
    agent: AgentId,
}

impl MaskTrack {
    /// Of an agent that has masks, with its poses by frame.
    pub(crate) fn open(
        scene: &SceneSource,
        agent: AgentId,
        poses: Vec<AgentRow>,
        topics: &mut Topics,
    ) -> Result<Self, ExportError> {
        let about: Description = scene::described(scene.reader(), &BEV_MASKS, agent)?;
        if about.classes.len() > u16::BITS as usize {
            let problem = format!("{} BEV classes do not fit into {} bits", about.classes.len(), u16::BITS);
            let (scene, agent) = (scene.number(), Some(agent.to_string()));
            return Err(ExportError::Content { scene, frame: None, agent, problem });
        }
        let masks = scene.arrays(&BEV_MASKS, agent)?;
        let facts = [
            ("bits_of_classes", about.classes.join(" ")),
            ("every_n_frames", about.every_n_frames.to_string()),
        ];
        let topic = topics.add(format!("/{agent}/bev"), &facts)?;
        let colours =
            about.classes.iter().map(|name| BevClass::from_name(name).map_or([128; 3], BevClass::rgb));
        let colours = colours.collect();
        Ok(Self { masks, about, colours, topic, poses, scene: scene.number(), agent })
    }
}

impl Track for MaskTrack {
    fn messages(&mut self, frame: u32, out: &mut Messages) -> Result<(), ExportError> {
        if !schema::rate::is_due(frame, self.about.every_n_frames) {
            return Ok(());
        }
        let array = self.masks.read(frame)?;
        let cells = self.about.cells as usize;
        let painted = (array.shape == [self.colours.len(), cells, cells])
            .then(|| paint(&array.bytes, cells, &self.colours))
            .flatten();
        let (Some(Packed { fields, stride, data }), Some(row)) = (painted, self.poses.get(frame as usize))
        else {
            let problem = format!(
                "{}: has shape {:?}, its comment says otherwise (run bev-gt again with --force)",
                self.masks.path(),
                array.shape
            );
            let agent = Some(self.agent.to_string());
            return Err(ExportError::Content { scene: self.scene, frame: Some(frame), agent, problem });
        };
        let grid = Grid {
            timestamp: Timestamp::at(frame),
            frame_id: "world".into(),
            pose: Pose::of(&corner(row, 0.5 * f64::from(self.about.cells) * self.about.cell_m)),
            column_count: self.about.cells,
            cell_size: Vector2 { x: self.about.cell_m, y: self.about.cell_m },
            row_stride: stride * self.about.cells,
            cell_stride: stride,
            fields,
            data,
        };
        self.topic.send(frame, &grid, out);
        Ok(())
    }
}

/// The corner behind and to the right of the agent, turned by its yaw alone.
fn corner(row: &AgentRow, half_extent_m: f64) -> TypedPose<World, Agent> {
    let world_from_agent: TypedPose<World, Agent> = TypedPose::from_xyz_wxyz(row.xyz_m, row.quaternion);
    let level: TypedPose<World, Agent> =
        TypedPose::from_xyz_rpy(row.xyz_m, [0.0, 0.0, world_from_agent.yaw()]);
    level * TypedPose::<Agent, Agent>::from_xyz_rpy([-half_extent_m, -half_extent_m, -BELOW_M], [0.0; 3])
}

/// Masks `[classes, rows, columns]` with row 0 ahead and column 0 to the left as cells with rows to the left
/// and columns ahead: the classes as bits, and the colour of the last of them.
fn paint(masks: &[u8], cells: usize, colours: &[[u8; 3]]) -> Option<Packed> {
    let size = cells * cells;
    let (mut bits, mut rgba) = (vec![0_u16; size], [(); 4].map(|()| vec![0_u8; size]));
    for (class, (mask, colour)) in masks.chunks_exact(size.max(1)).zip(colours).enumerate() {
        for (at, _) in mask.iter().enumerate().filter(|(_, set)| **set != 0) {
            let (row, column) = (at / cells, at % cells);
            let to = (cells - 1 - column) * cells + (cells - 1 - row);
            bits[to] |= 1 << class;
            for (channel, value) in rgba.iter_mut().zip([colour[0], colour[1], colour[2], ALPHA]) {
                channel[to] = value;
            }
        }
    }
    let [red, green, blue, alpha] = &rgba;
    pack(&[
        ("classes", Values::U16(&bits)),
        ("red", Values::U8(red)),
        ("green", Values::U8(green)),
        ("blue", Values::U8(blue)),
        ("alpha", Values::U8(alpha)),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_keep_their_places() {
        // Two classes, two by two: the first ahead left, the second ahead left and behind right.
        let masks = [1, 0, 0, 0, 1, 0, 0, 1];
        let packed = paint(&masks, 2, &[[10, 20, 30], [40, 50, 60]]).expect("fits");
        assert_eq!(packed.stride, 8);
        let cell = |x: usize, y: usize| &packed.data[(y * 2 + x) * 8..][..6];
        // Columns go ahead, rows to the left.
        assert_eq!(cell(1, 1), [3, 0, 40, 50, 60, ALPHA]);
        assert_eq!(cell(0, 0), [2, 0, 40, 50, 60, ALPHA]);
        assert_eq!((cell(1, 0), cell(0, 1)), (&[0; 6][..], &[0; 6][..]));
    }

    #[test]
    fn the_corner_is_behind_to_the_right_whatever_the_slope() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        // Heads north: behind is south, right is east.
        let row =
            AgentRow { xyz_m: [5.0, 6.0, 7.0], quaternion: [half, 0.0, 0.0, half], ..AgentRow::default() };
        let [x, y, z] = corner(&row, 10.0).xyz();
        assert!((x - 15.0).abs() < 1e-12 && (y + 4.0).abs() < 1e-12 && (z - 7.0 + BELOW_M).abs() < 1e-12);
        let climbing = TypedPose::<World, Agent>::from_xyz_rpy([0.0; 3], [0.2, -0.3, 0.0]);
        let row = AgentRow { quaternion: climbing.wxyz(), ..AgentRow::default() };
        let [x, y, _] = corner(&row, 10.0).xyz();
        assert!((x + 10.0).abs() < 1e-12 && (y + 10.0).abs() < 1e-12);
    }
}
