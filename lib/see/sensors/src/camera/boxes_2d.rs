//! Boxes of objects in the pictures: what is seen of them, and what would be.

use std::collections::BTreeMap;

use glam::Vec3;
use render::{CameraView, PinholeCamera, SKY, Scene, ViewQuery, VisibilityBuffer, Window, render_views};
use schema::geometry::{Instance, Snapshot};
use schema::tables::{BOXES_2D_TABLE, Box2dRow};
use schema::{DetectionClass, ObjectId, Tag};
use settings::Rig;

use crate::error::SensorError;
use crate::observation::Observation;
use crate::sensor::{Layout, Sensor, SensorTable};
use shading::Sight;

/// Windows of so many pixels are held at a time, and one more: 12 bytes each.
const BATCH_PX: u64 = 1 << 22;

/// Measures every object with a class in every camera of an agent.
pub(crate) struct Boxes2d {
    cameras: Vec<String>,
    every_n_frames: u32,
}

impl Boxes2d {
    /// For rigs that want them and have a picture to measure in.
    pub(crate) fn of(rig: &Rig) -> Option<Self> {
        let wanted = rig.camera.boxes_2d && !rig.camera.images.is_empty();
        let cameras = || rig.cameras.iter().map(|camera| camera.name.clone()).collect();
        wanted.then(|| Self { cameras: cameras(), every_n_frames: rig.camera.every_n_frames })
    }
}

impl Sensor for Boxes2d {
    type Row = Box2dRow;

    fn table(&self) -> SensorTable {
        SensorTable::new(BOXES_2D_TABLE, None, Layout::Whole, self.every_n_frames)
    }

    fn sense(&self, at: &Observation<'_>) -> Result<Vec<Box2dRow>, SensorError> {
        let looking = self.cameras.iter().zip(&at.sights);
        let (cameras, sights): (Vec<&String>, Vec<&Sight>) =
            looking.filter_map(|(camera, sight)| Some((camera, sight.as_ref()?))).unzip();
        let rows = measure(at.scene, &sights)?.into_iter();
        let named = |(number, row): (usize, Box2dRow)| Box2dRow {
            frame: at.frame,
            camera: cameras[number].clone(),
            ..row
        };
        Ok(rows.map(named).collect())
    }
}

/// Whether parts of a tag belong to an object's box: those that name its class, and riders.
fn is_boxed(tag: Tag) -> bool {
    tag == Tag::Rider || DetectionClass::from_tag(tag).is_some()
}

/// An object in the picture.
struct Shown {
    id: ObjectId,
    class: DetectionClass,
    pixels: u32,
    visible: Rect,
    /// Numbers of its instances, ascending.
    instances: Vec<u32>,
}

/// A rectangle of whole pixels: first column and row, and those after the last.
#[derive(Clone, Copy)]
struct Rect {
    low: [u32; 2],
    high: [u32; 2],
}

/// The boxes of some sights, one after the other, by object, each with the number of its sight; frame and
/// camera are not said yet. What the objects of all sights would show alone is asked for in few batches.
fn measure(scene: &dyn Scene, sights: &[&Sight]) -> Result<Vec<(usize, Box2dRow)>, SensorError> {
    let snapshot = scene.snapshot();
    let shown: Vec<(usize, Shown)> = (0..)
        .zip(sights)
        .flat_map(|(number, sight)| {
            shown(snapshot, &sight.seen).into_iter().map(move |object| (number, object))
        })
        .collect();
    let (amodal, alone): (Vec<[f32; 4]>, Vec<ViewQuery<'_>>) =
        shown.iter().map(|(number, object)| object.whole(snapshot, sights[*number])).unzip();
    let mut rows = Vec::with_capacity(shown.len());
    while rows.len() < shown.len() {
        let mut pixels = 0;
        let batch = alone[rows.len()..].iter().take_while(|query| {
            let [width, height] = query.window.size;
            let fits = pixels < BATCH_PX;
            pixels += u64::from(width) * u64::from(height);
            fits
        });
        let batch: Vec<ViewQuery<'_>> = batch.copied().collect();
        for (query, seen_alone) in batch.iter().zip(render_views(scene, &batch)?) {
            let (number, object) = &shown[rows.len()];
            let sight = sights[*number];
            let hidden = hidden(snapshot, &sight.seen, object.id, &seen_alone, query.window.corner);
            rows.push((*number, object.row(hidden, amodal[rows.len()], &sight.view.pinhole())));
        }
    }
    Ok(rows)
}

impl Shown {
    /// The box around all of it in a picture, pixels, and what asks for the part of the picture in that box
    /// as if there were no other objects.
    fn whole<'a>(&'a self, snapshot: &Snapshot, sight: &'a Sight) -> ([f32; 4], ViewQuery<'a>) {
        let instances = self.instances.iter().map(|&i| &snapshot.instances[i as usize]);
        let amodal_px = silhouette(snapshot, instances, &sight.view, self.visible);
        let window = window(&sight.view.pinhole(), amodal_px);
        (amodal_px, ViewQuery { view: &sight.view, window, among: Some(&self.instances) })
    }

    fn row(&self, hidden_pixels: u32, amodal_px: [f32; 4], camera: &PinholeCamera) -> Box2dRow {
        let Rect { low, high } = self.visible;
        Box2dRow {
            id: self.id,
            class: self.class.name().to_owned(),
            pixels: self.pixels,
            visible_px: [low[0], low[1], high[0], high[1]].map(|v| v as f32),
            amodal_px,
            occlusion: hidden_pixels as f32 / (hidden_pixels + self.pixels) as f32,
            truncation: truncation(amodal_px, camera),
            ..Box2dRow::default()
        }
    }
}

/// The tag of what a pixel shows, and whose it is; none of the sky.
fn part_at(snapshot: &Snapshot, seen: &VisibilityBuffer, pixel: usize) -> Option<(Tag, ObjectId)> {
    let instance = seen.instance[pixel];
    (instance != SKY).then(|| {
        let instance = &snapshot.instances[instance as usize];
        (snapshot.mesh(instance).part(seen.triangle[pixel] as usize).tag, instance.object)
    })
}

/// The objects with a class that a picture shows, by their ids.
fn shown(snapshot: &Snapshot, seen: &VisibilityBuffer) -> Vec<Shown> {
    // A class needs one of its tags in the picture: a rider's alone has none.
    let mut found: BTreeMap<ObjectId, (Option<DetectionClass>, u32, Rect)> = BTreeMap::new();
    for y in 0..seen.height {
        for x in 0..seen.width {
            let Some((tag, id)) = part_at(snapshot, seen, seen.index(x, y)).filter(|(tag, _)| is_boxed(*tag))
            else {
                continue;
            };
            let (class, pixels, rect) =
                found.entry(id).or_insert((None, 0, Rect { low: [x, y], high: [x, y] }));
            *class = DetectionClass::from_tag(tag).or(*class);
            *pixels += 1;
            rect.low = [rect.low[0].min(x), rect.low[1].min(y)];
            rect.high = [rect.high[0].max(x + 1), rect.high[1].max(y + 1)];
        }
    }
    let classes = classes_of(snapshot, &found.keys().copied().collect::<Vec<_>>());
    let object = |(id, (class, pixels, visible)): (ObjectId, (Option<DetectionClass>, u32, Rect))| {
        let class = class.or_else(|| classes.get(&id).copied())?;
        Some((id, Shown { id, class, pixels, visible, instances: Vec::new() }))
    };
    let mut shown: BTreeMap<ObjectId, Shown> = found.into_iter().filter_map(object).collect();
    for (number, instance) in (0..).zip(&snapshot.instances) {
        if let Some(object) = shown.get_mut(&instance.object) {
            object.instances.push(number);
        }
    }
    shown.into_values().collect()
}

/// The classes of some objects by all their parts, whether they are seen or not.
fn classes_of(snapshot: &Snapshot, of: &[ObjectId]) -> BTreeMap<ObjectId, DetectionClass> {
    let mut classes = BTreeMap::new();
    for instance in snapshot.instances.iter().filter(|i| of.binary_search(&i.object).is_ok()) {
        let mesh = snapshot.mesh(instance);
        for class in mesh.parts.iter().filter_map(|part| DetectionClass::from_tag(part.tag)) {
            classes.insert(instance.object, class);
        }
    }
    classes
}

/// The box around the picture of some instances' parts, left, top, right, bottom; it holds all pixels of
/// `visible`.
fn silhouette<'a>(
    snapshot: &Snapshot,
    instances: impl Iterator<Item = &'a Instance>,
    view: &CameraView,
    visible: Rect,
) -> [f32; 4] {
    let camera = view.pinhole();
    let optical_from_local = camera.local_from_optical.inverse();
    let (mut low, mut high) = (visible.low.map(|v| v as f32), visible.high.map(|v| v as f32));
    let size = [camera.width as f32, camera.height as f32];
    let mut add = |p: Vec3| {
        let (at, is_shown) = view.model.project(p);
        if !is_shown {
            return;
        }
        for (k, at) in at.to_array().into_iter().enumerate() {
            let at = at.clamp(-size[k], 2.0 * size[k]);
            (low[k], high[k]) = (low[k].min(at), high[k].max(at));
        }
    };
    let is_bent = view.model.rays().is_some();
    for instance in instances {
        let (mesh, pose) = (snapshot.mesh(instance), optical_from_local * instance.local_from_object);
        let points: Vec<Vec3> = mesh.positions.iter().map(|p| pose.transform_point3(*p)).collect();
        for (index, corners) in mesh.triangles.iter().enumerate() {
            if !is_boxed(mesh.part(index).tag) {
                continue;
            }
            let corners = corners.map(|i| points[i as usize]);
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                if is_bent {
                    along(a, b, &mut add);
                    continue;
                }
                add(a);
                // An edge through the near plane ends there.
                if (a.z < camera.near_m) != (b.z < camera.near_m) {
                    let end = a + (b - a) * ((camera.near_m - a.z) / (b.z - a.z));
                    add(Vec3::new(end.x, end.y, camera.near_m));
                }
            }
        }
    }
    [low[0], low[1], high[0], high[1]]
}

/// Calls with points of an edge, from the first on and short of the last, as near to one another as a lens
/// may bend it: they are a degree apart at most.
fn along(a: Vec3, b: Vec3, each: &mut impl FnMut(Vec3)) {
    let (mut share, whole) = (0.0_f32, (b - a).length());
    while share < 1.0 {
        let point = a + (b - a) * share;
        each(point);
        share += (point.length() / (57.3 * whole)).max(1.0 / 4096.0);
    }
}

/// The part of a camera's picture that a box lies in.
fn window(camera: &PinholeCamera, [left, top, right, bottom]: [f32; 4]) -> Window {
    let inside = |v: f32, size: u32| v.clamp(0.0, size as f32);
    let low = [inside(left, camera.width), inside(top, camera.height)].map(|v| v.floor() as u32);
    let high = [inside(right, camera.width), inside(bottom, camera.height)].map(|v| v.ceil() as u32);
    Window { corner: low, size: [high[0] - low[0], high[1] - low[1]] }
}

/// Pixels that would show an object if nothing else were there, and show something else.
fn hidden(
    snapshot: &Snapshot,
    seen: &VisibilityBuffer,
    id: ObjectId,
    alone: &VisibilityBuffer,
    corner: [u32; 2],
) -> u32 {
    let mut hidden = 0;
    for y in 0..alone.height {
        for x in 0..alone.width {
            let there = part_at(snapshot, alone, alone.index(x, y)).is_some_and(|(tag, _)| is_boxed(tag));
            let pixel = seen.index(corner[0] + x, corner[1] + y);
            let own = |(tag, other): (Tag, ObjectId)| other == id && is_boxed(tag);
            hidden += u32::from(there && !part_at(snapshot, seen, pixel).is_some_and(own));
        }
    }
    hidden
}

/// The share of a box that lies outside of the picture.
fn truncation([left, top, right, bottom]: [f32; 4], camera: &PinholeCamera) -> f32 {
    let area = |left: f32, top: f32, right: f32, bottom: f32| (right - left) * (bottom - top);
    let (width, height) = (camera.width as f32, camera.height as f32);
    let inside = area(left.max(0.0), top.max(0.0), right.min(width), bottom.min(height));
    (1.0 - inside / area(left, top, right, bottom)).max(0.0)
}

#[cfg(test)]
mod tests {
    use frames::Pose;
    use render::Renderer;
    use render::cpu::CpuRenderer;
    use settings::{CameraSettings, CameraSpec, Lens, Mount, Optics};
    use testkit::{WorldBuilder, box_mesh};

    use super::super::mounted::Camera;
    use super::*;

    /// Boxes in front of a camera at the origin that looks along x, 100 by 60 pixels, focal length 50 pixels.
    fn boxes_of(world: WorldBuilder) -> Vec<Box2dRow> {
        boxes_through(world, Lens::Pinhole)
    }

    fn boxes_through(world: WorldBuilder, lens: Lens) -> Vec<Box2dRow> {
        let snapshot = world.snapshot([0.0; 3]);
        let mut renderer = CpuRenderer::default();
        renderer.prepare(&snapshot.meshes).expect("has no device");
        let scene = renderer.place(&snapshot).expect("is prepared");
        let spec = CameraSpec {
            name: "CAM".into(),
            mount: Mount::upright([0.0; 3], 0.0),
            optics: Optics { lens, ..Optics::pinhole(100, 60, frames::deg(90.0)) },
        };
        let camera = Camera::new(&spec, &CameraSettings::default()).expect("is one");
        let view = camera.view(&snapshot.origin, &Pose::identity(), &Pose::identity());
        let sight = Sight::all(&*scene, vec![view]).expect("has no device").remove(0);
        let measured = measure(&*scene, &[&sight]).expect("has no device");
        measured.into_iter().map(|(_, row)| row).collect()
    }

    fn thing(world: &mut WorldBuilder, tag: Tag, size: [f32; 3], id: u16, xyz: [f64; 3]) {
        world.add(box_mesh(tag, size, 2), id, xyz, [0.0; 3]);
    }

    #[test]
    fn a_box_alone_is_its_front_face() {
        let mut world = WorldBuilder::default();
        // Its front is at x = 10, from y = -1 to 1 and z = -1 to 1: 5 pixels either way from (50, 30).
        thing(&mut world, Tag::Car, [4.0, 2.0, 2.0], 7, [12.0, 0.0, -1.0]);
        let got = boxes_of(world);
        let [row] = got.as_slice() else { panic!("{got:?}") };
        assert_eq!((row.id, row.class.as_str(), row.pixels), (7, "car", 100));
        assert_eq!(row.visible_px, [45.0, 25.0, 55.0, 35.0]);
        assert!(row.amodal_px.iter().zip([45.0, 25.0, 55.0, 35.0]).all(|(a, b)| (a - b).abs() < 1e-3));
        assert_eq!((row.occlusion, row.truncation < 1e-4), (0.0, true));
    }

    #[test]
    fn a_fisheye_bends_the_edges_of_a_box() {
        let mut world = WorldBuilder::default();
        // A face at x = 2 from -2 to 2 both ways, with a wall before all that is left of the middle.
        thing(&mut world, Tag::Car, [1.0, 4.0, 4.0], 7, [2.5, 0.0, -2.0]);
        thing(&mut world, Tag::Wall, [0.1, 4.0, 8.0], 8, [1.0, 2.0, -4.0]);
        let got = boxes_through(world, Lens::Fisheye { k: [0.0; 4] });
        let [row] = got.as_slice() else { panic!("a wall has no class: {got:?}") };
        // The middles of its edges are at 45 degrees, 50 pi / 4 pixels from the axis; its corners are nearer
        // both ways.
        let reach = 50.0 * std::f32::consts::FRAC_PI_4;
        let want = [50.0 - reach, 30.0 - reach, 50.0 + reach, 30.0 + reach];
        assert!(row.amodal_px.iter().zip(want).all(|(a, b)| (a - b).abs() < 0.02), "{row:?} {want:?}");
        assert!((row.occlusion - 0.5).abs() < 0.01, "{row:?}");
        assert_eq!((row.visible_px[0], row.visible_px[1], row.visible_px[3]), (50.0, 0.0, 60.0));
        let outside = 1.0 - 60.0 / (2.0 * reach);
        assert!((row.truncation - outside).abs() < 1e-3, "{row:?}");
    }

    #[test]
    fn what_others_hide_is_occluded() {
        let mut world = WorldBuilder::default();
        thing(&mut world, Tag::Car, [4.0, 2.0, 2.0], 7, [12.0, 0.0, -1.0]);
        // A wall of no class at x = 5 hides all that is left of the middle: y above 0.
        thing(&mut world, Tag::Wall, [0.2, 4.0, 8.0], 8, [5.1, 2.0, -4.0]);
        let got = boxes_of(world);
        let [row] = got.as_slice() else { panic!("a wall has no class: {got:?}") };
        assert_eq!((row.id, row.pixels, row.occlusion), (7, 50, 0.5));
        assert_eq!(row.visible_px, [50.0, 25.0, 55.0, 35.0]);
        assert!((row.amodal_px[0] - 45.0).abs() < 1e-3, "{:?}", row.amodal_px);
    }

    #[test]
    fn what_is_cut_off_is_truncated_and_what_is_behind_is_clipped() {
        let mut world = WorldBuilder::default();
        // The front at x = 10 reaches from y = 8 to 12: columns -10 to 10, of which half are in the picture.
        thing(&mut world, Tag::Truck, [1e-3, 4.0, 2.0], 3, [10.0, 10.0, -1.0]);
        // Beside the camera, from behind it to far ahead.
        thing(&mut world, Tag::Bus, [40.0, 1.0, 3.0], 4, [0.0, -3.0, -1.0]);
        let got = boxes_of(world);
        let [truck, bus] = got.as_slice() else { panic!("{got:?}") };
        assert!((truck.truncation - 0.5).abs() < 1e-3 && truck.occlusion == 0.0, "{truck:?}");
        assert!((truck.amodal_px[0] + 10.0).abs() < 1e-2, "{truck:?}");
        // Its near end is beyond the right and lower edge however far away that is.
        assert_eq!(bus.amodal_px[2], 200.0);
        assert!(bus.truncation > 0.4 && bus.visible_px[2] == 100.0, "{bus:?}");
    }

    #[test]
    fn a_rider_belongs_to_the_bicycle_and_a_pole_to_nobody() {
        let mut world = WorldBuilder::default();
        thing(&mut world, Tag::Bicycle, [0.2, 0.2, 1.0], 5, [10.0, 0.0, -1.0]);
        thing(&mut world, Tag::Rider, [0.2, 0.2, 1.0], 5, [10.0, 0.0, 0.0]);
        // The lower half hidden: what is seen is the rider alone.
        thing(&mut world, Tag::Wall, [0.1, 2.0, 4.0], 6, [5.0, 0.0, -4.0]);
        thing(&mut world, Tag::Pole, [0.2, 0.2, 1.0], 9, [10.0, 2.0, 0.0]);
        let got = boxes_of(world);
        let [row] = got.as_slice() else { panic!("{got:?}") };
        assert_eq!((row.id, row.class.as_str()), (5, "bicycle"));
        assert!((0.45..0.55).contains(&row.occlusion), "{row:?}");
    }
}
