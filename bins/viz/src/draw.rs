//! Draws one picture of one agent.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use pictures::{
    BoxShape, Canvas, ColourBar, ColourBy, PictureError, Reach, Tone, View, VoxelGrid, agent_names,
    decode_jpeg, decode_png, draw_bev, draw_boxes, draw_cloud, draw_depth, draw_ego, draw_flow, draw_ground,
    draw_instances, draw_names, draw_rings, draw_voxels, draw_wheel, label_rings,
};
use scene::{ArrayReader, SensorKind};
use schema::arrays::{ArrayKind, BEV_MASKS, VOXEL_CELLS};
use schema::{BevClass, ImageKind, rate};

use crate::archive::{BevGrid, OccupancyGrid};
use crate::desk::{Desk, boxes_of_all};
use crate::error::{Drawing, VizError};
use crate::feed::{AgentFrame, Rig};
use crate::mode::{Mode, Source};

/// White, as users of the original are used to.
const PAPER: [u8; 3] = [255; 3];
/// Pixels of BEV pictures a cell.
const BEV_SCALE: u32 = 2;
/// Largest array that is read, bytes.
const MOST_BYTES: u64 = 1 << 30;

impl Desk<'_> {
    /// The picture of an agent (by its place among those that were read); none where there is nothing at this
    /// frame.
    pub(crate) fn draw(&self, mode: &Mode, which: usize) -> Result<Option<Canvas>, VizError> {
        let (agent, rig) = (&self.agents[which], &self.rigs[which]);
        let place = || {
            let scene = self.session.source.number();
            format!("scene {scene} frame {} {} {}", self.frame, agent.agent, mode.name())
        };
        match mode {
            Mode::Camera(kind, table) => self.camera(*kind, table, agent, rig).drawing(place),
            Mode::Cloud { source, is_solid, has_boxes, reach } => {
                self.cloud(source, (*is_solid, *has_boxes, *reach), agent, rig).drawing(place)
            }
            Mode::Together { is_solid, reach } => {
                self.together((*is_solid, *reach), agent, rig).map(Some).drawing(place)
            }
            Mode::Bev(palette) => self.bev(*palette, agent, place),
            Mode::Voxels { kind, reach } => self.voxels(kind, *reach, agent, rig, place),
            Mode::Scene => crate::scene_view::draw_scene(self).map(Some).drawing(place),
        }
    }

    fn camera(
        &self,
        kind: ImageKind,
        table: &str,
        agent: &AgentFrame,
        rig: &Rig,
    ) -> Result<Option<Canvas>, PictureError> {
        if kind == ImageKind::Flow {
            let flow = agent.flows.get(table);
            let Some(flow) = flow else { return Ok(None) };
            let (mut canvas, full_px) = draw_flow([flow.width, flow.height], &flow.dx, &flow.dy)?;
            let text_px = self.text_px(&canvas);
            draw_wheel(&mut canvas, full_px, text_px);
            return Ok(Some(canvas));
        }
        let Some(bytes) = agent.images.get(table) else { return Ok(None) };
        Ok(Some(match kind {
            ImageKind::Rgb => {
                let mut canvas = decode_jpeg(bytes)?;
                if let Some(camera) = rig.camera(table, &agent.world_from_agent) {
                    // Cameras are inside of their own agent's box.
                    let boxes: Vec<BoxShape> =
                        agent.boxes.iter().map(|(b, _)| *b).filter(|b| b.id != agent.id).collect();
                    let width = self.line_px(&canvas);
                    draw_boxes(&mut canvas, &View::Through(camera), &Isometry3::identity(), &boxes, width);
                }
                canvas
            }
            ImageKind::Depth => {
                let (size, rgb) = decode_png(bytes)?;
                let mut canvas = draw_depth(size, &rgb)?;
                let text_px = self.text_px(&canvas);
                ColourBar::DEPTH.draw(&mut canvas, Tone::Dark, text_px);
                canvas
            }
            ImageKind::Instance => {
                let (size, rgb) = decode_png(bytes)?;
                draw_instances(size, &rgb)?
            }
            ImageKind::Semantic | ImageKind::Flow => {
                let (size, rgb) = decode_png(bytes)?;
                Canvas::from_rgb(size, &rgb)?
            }
        }))
    }

    fn cloud(
        &self,
        source: &Source,
        (is_solid, has_boxes, reach): (bool, bool, Reach),
        agent: &AgentFrame,
        rig: &Rig,
    ) -> Result<Option<Canvas>, PictureError> {
        let names: Vec<&str> = match source {
            Source::Lidar(name) | Source::SemanticLidar(name) => vec![name],
            Source::Radars => rig.names(SensorKind::Radar).collect(),
        };
        let (agent_from_view, side) = match source {
            Source::Lidar(name) | Source::SemanticLidar(name) => {
                (rig.agent_from(name), dot_px(is_solid, reach))
            }
            Source::Radars => (rig.agent_from_lidar(), dot_px(is_solid, reach) + 4),
        };
        let view_from_agent = agent_from_view.inverse();
        let view = view_of(is_solid, reach);
        let (mut canvas, mut depth) = (Canvas::new(view.size(), PAPER)?, Vec::new());
        let text_px = self.text_px(&canvas);
        draw_rings(&mut canvas, &view, text_px);
        let ground_z_m = -agent_from_view.translation.z;
        let mut by = None;
        for name in names {
            let Some(cloud) = agent.clouds.get(name) else { continue };
            let placed = view_from_agent * rig.agent_from(name);
            // What nobody knows is not painted, unless it is asked for: that is refused.
            let usual = if cloud.has(source.colour()) { source.colour() } else { ColourBy::Height };
            let shown = *by.insert(self.colour.unwrap_or(usual));
            let how = (shown, ground_z_m, agent.position);
            draw_cloud(&mut canvas, &mut depth, &view, (cloud, &placed), how, side)?;
        }
        let Some(by) = by else { return Ok(None) };
        let from_world = view_from_agent * agent.world_from_agent.inverse();
        if has_boxes {
            let boxes: Vec<BoxShape> = agent.boxes.iter().map(|(b, _)| *b).collect();
            let width = self.line_px(&canvas);
            draw_boxes(&mut canvas, &view, &from_world, &boxes, width);
        }
        let body = agent.body.map(|corners| corners.map(|corner| from_world * corner));
        draw_ego(&mut canvas, &view, &view_from_agent, body.as_ref(), text_px);
        label_rings(&mut canvas, &view, text_px);
        if let Some(bar) = ColourBar::of(by) {
            bar.draw(&mut canvas, Tone::Light, text_px);
        }
        Ok(Some(canvas))
    }

    /// The lidars of all agents in an agent's lidar frame, with the boxes that any of them saw, on the map.
    fn together(
        &self,
        (is_solid, reach): (bool, Reach),
        agent: &AgentFrame,
        rig: &Rig,
    ) -> Result<Canvas, PictureError> {
        let agent_from_view = rig.agent_from_lidar();
        let view_from_world = (agent.world_from_agent * agent_from_view).inverse();
        let view = view_of(is_solid, reach);
        let (mut canvas, mut depth) = (Canvas::new(view.size(), PAPER)?, Vec::new());
        let text_px = self.text_px(&canvas);
        draw_ground(&mut canvas, &view, &view_from_world, &self.session.ground, text_px / 18.0);
        draw_rings(&mut canvas, &view, text_px);
        let by = self.colour.unwrap_or(ColourBy::Agent);
        for (other, its_rig) in self.agents.iter().zip(self.rigs) {
            for name in its_rig.names(SensorKind::Lidar) {
                let Some(cloud) = other.clouds.get(name) else { continue };
                let placed = view_from_world * other.world_from_agent * its_rig.agent_from(name);
                let how = (by, -agent_from_view.translation.z, other.position);
                draw_cloud(&mut canvas, &mut depth, &view, (cloud, &placed), how, dot_px(is_solid, reach))?;
            }
        }
        let width = self.line_px(&canvas);
        draw_boxes(&mut canvas, &view, &view_from_world, &boxes_of_all(self.agents), width);
        let body = agent.body.map(|corners| corners.map(|corner| view_from_world * corner));
        draw_ego(&mut canvas, &view, &agent_from_view.inverse(), body.as_ref(), text_px);
        label_rings(&mut canvas, &view, text_px);
        match ColourBar::of(by) {
            Some(bar) => bar.draw(&mut canvas, Tone::Light, text_px),
            None if by == ColourBy::Agent => {
                let names: Vec<(usize, String)> =
                    self.agents.iter().map(|a| (a.position, a.agent.to_string())).collect();
                draw_names(&mut canvas, &agent_names(&names), text_px);
            }
            None => {}
        }
        Ok(canvas)
    }

    fn bev(
        &self,
        palette: pictures::BevPalette,
        agent: &AgentFrame,
        place: impl Fn() -> String,
    ) -> Result<Option<Canvas>, VizError> {
        let reader = self.session.source.reader();
        let grid: BevGrid = scene::described(reader, &BEV_MASKS, agent.agent)?;
        if !rate::is_due(self.frame, grid.every_n_frames) {
            return Ok(None);
        }
        let mut archive = ArrayReader::open(reader, &BEV_MASKS, agent.agent, MOST_BYTES)?;
        let path = archive.path().to_owned();
        let wrong =
            |problem: String| VizError::Archive { path: path.clone(), problem, stage: BEV_MASKS.stage };
        let class = |name: &String| {
            BevClass::from_name(name).ok_or_else(|| wrong(format!("there is no class `{name}`")))
        };
        let classes: Vec<BevClass> = grid.classes.iter().map(class).collect::<Result<_, _>>()?;
        let masks = archive.read(self.frame)?;
        let [_, rows, columns] = masks.shape[..] else {
            return Err(wrong(format!("frame {} has the shape {:?}", self.frame, masks.shape)));
        };
        let drawn = draw_bev(&masks.bytes, &classes, [rows, columns], palette, BEV_SCALE);
        let mut canvas = drawn.drawing(place)?;
        if let Some(cell_m) = grid.cell_m {
            self.mark_masks(&mut canvas, agent, f64::from(BEV_SCALE) / cell_m);
        }
        Ok(Some(canvas))
    }

    /// Rings, scale and the agent itself on its masks: they lie in its frame, turned by its yaw alone.
    fn mark_masks(&self, canvas: &mut Canvas, agent: &AgentFrame, px_per_m: f64) {
        let view = View::Above { centre_m: [0.0; 2], size: canvas.size(), px_per_m };
        let text_px = self.text_px(canvas);
        let (_, _, yaw) = agent.world_from_agent.rotation.euler_angles();
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        let from_world = Isometry3::from_parts(agent.world_from_agent.translation, turn).inverse();
        draw_rings(canvas, &view, text_px);
        let body = agent.body.map(|corners| corners.map(|corner| from_world * corner));
        draw_ego(canvas, &view, &(from_world * agent.world_from_agent), body.as_ref(), text_px);
        label_rings(canvas, &view, text_px);
    }

    fn voxels(
        &self,
        kind: &ArrayKind,
        reach: Reach,
        agent: &AgentFrame,
        rig: &Rig,
        place: impl Fn() -> String,
    ) -> Result<Option<Canvas>, VizError> {
        let View::Through(camera) = View::behind(reach) else { return Ok(None) };
        let reader = self.session.source.reader();
        let about: OccupancyGrid = scene::described(reader, kind, agent.agent)?;
        if !rate::is_due(self.frame, about.every_n_frames) {
            return Ok(None);
        }
        let mut archive = ArrayReader::open(reader, kind, agent.agent, MOST_BYTES)?;
        let path = archive.path().to_owned();
        let wrong = |problem: String| VizError::Archive { path: path.clone(), problem, stage: kind.stage };
        let array = archive.read(self.frame)?;
        let (shape, tags) = if *kind == VOXEL_CELLS {
            let shape = about.shape();
            (shape, listed(&array.bytes, shape).ok_or_else(|| wrong("lists cells beyond the grid".into()))?)
        } else {
            let [x, y, z] = array.shape[..] else {
                return Err(wrong(format!("frame {} has the shape {:?}", self.frame, array.shape)));
            };
            ([x, y, z], array.bytes)
        };
        let lower_m = [-about.range_m, -about.range_m, about.mount_z_m + about.lower_m];
        let grid = VoxelGrid::new(shape, tags, lower_m, about.voxel_m).drawing(&place)?;
        draw_voxels(&grid, &camera, &rig.agent_from_lidar()).map(Some).drawing(place)
    }
}

impl OccupancyGrid {
    fn shape(&self) -> [usize; 3] {
        let across = (2.0 * self.range_m / self.voxel_m).round() as usize;
        [across, across, ((self.upper_m - self.lower_m) / self.voxel_m).round() as usize]
    }
}

/// A grid from its occupied cells: place along x, y, z and tag, each a u16.
fn listed(cells: &[u8], shape: [usize; 3]) -> Option<Vec<u8>> {
    let mut tags = vec![0; shape.iter().product()];
    for cell in cells.chunks_exact(8) {
        let [x, y, z, tag] = [0, 2, 4, 6].map(|i| usize::from(u16::from_le_bytes([cell[i], cell[i + 1]])));
        if x >= shape[0] || y >= shape[1] || z >= shape[2] {
            return None;
        }
        tags[(x * shape[1] + y) * shape[2] + z] = u8::try_from(tag).ok()?;
    }
    Some(tags)
}

fn view_of(is_solid: bool, reach: Reach) -> View {
    if is_solid { View::behind(reach) } else { View::above(reach) }
}

/// Side of a point's square, pixels.
fn dot_px(is_solid: bool, reach: Reach) -> u32 {
    match (is_solid, reach) {
        (true, _) => 2,
        (false, Reach::Near) => 5,
        (false, Reach::Far) => 3,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn listed_cells_become_grids() {
        let cell = |numbers: [u16; 4]| numbers.map(u16::to_le_bytes).concat();
        let cells = [cell([0, 1, 2, 14]), cell([1, 0, 0, 1])].concat();
        let mut wanted = vec![0; 2 * 2 * 3];
        (wanted[5], wanted[6]) = (14, 1);
        assert_eq!(listed(&cells, [2, 2, 3]), Some(wanted));
        assert_eq!(listed(&cell([2, 0, 0, 1]), [2, 2, 3]), None);
    }
}
