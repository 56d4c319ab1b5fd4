//! A plane in the sun on which examples put actors.
#![allow(dead_code, reason = "each example needs a part of it")]

#[path = "../../tests/sensors/common/mod.rs"]
mod common;

use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use catalogue::{BaseType, Model, benches};
use glam::{Affine3A, Vec3};
use meshes::actors::{Piece, Posture, actor_mesh};
use meshes::people::Walker;
use packs::{Attachment, PackModel};
use schema::Tag;
use schema::geometry::{Instance, Snapshot, Surface, SurfaceMesh, TriMesh};
use schema::tables::Weather;
use settings::{CameraSettings, Optics};

/// The objects on the plane.
#[derive(Default)]
pub(crate) struct Stage {
    meshes: Vec<Arc<TriMesh>>,
    instances: Vec<Instance>,
    /// Objects behind panes.
    cabins: Vec<Instance>,
}

impl Stage {
    pub(crate) fn new() -> Self {
        let mut stage = Self::default();
        stage.meshes.push(testkit::plane(60.0, 0.0, Tag::Sidewalk, Surface::Concrete));
        stage.instances.push(common::instance(0, 1, Affine3A::IDENTITY));
        stage
    }

    /// A lawn.
    pub(crate) fn meadow() -> Self {
        let mut stage = Self::default();
        stage.meshes.push(testkit::plane(160.0, 0.0, Tag::Terrain, Surface::Grass));
        stage.instances.push(common::instance(0, 1, Affine3A::IDENTITY));
        stage
    }

    /// Somebody of a model at a place, in a posture.
    pub(crate) fn add(&mut self, model: &Model, variant: u32, at: Affine3A, posture: Posture) {
        self.add_level(model, variant, 0, at, posture, [0.5; 3]);
    }

    /// The same as detailed as it is farther away, in a paint (linear RGB); gives the number of triangles.
    pub(crate) fn add_level(
        &mut self,
        model: &Model,
        variant: u32,
        level: usize,
        at: Affine3A,
        posture: Posture,
        paint: [f32; 3],
    ) -> usize {
        let size = if model.base == BaseType::Pedestrian && model.wheel_radius_m == 0.0 {
            Walker::new(model, variant).size_m().to_array().map(f64::from)
        } else {
            model.size_m
        };
        let Some(made) = actor_mesh(model.name, size, variant) else { return 0 };
        let made = made.with_ambient_occlusion();
        let posture = made.posed(posture);
        let object = self.instances.len() as u16 + 1;
        let coarser = level.checked_sub(1).and_then(|i| made.coarser.get(i));
        let pieces: &[Piece] = coarser.map_or(&made.pieces, |coarser| &coarser.pieces);
        let mut triangles = 0;
        for piece in pieces {
            let Some(pose) = piece.joint.object_from_piece(&posture) else { continue };
            let instance = common::instance(self.meshes.len() as u32, object, at * pose);
            self.instances.push(Instance { paint, ..instance });
            self.meshes.push(Arc::clone(&piece.mesh));
            triangles += piece.mesh.triangles.len();
        }
        let behind = if level < 2 { made.cabin } else { None };
        for mesh in behind.into_iter().flat_map(|cabin| [Some(cabin.seats), cabin.driver]).flatten() {
            self.cabins.push(common::instance(self.meshes.len() as u32, object, at));
            self.meshes.push(mesh);
        }
        triangles
    }

    /// Whatever is no vehicle and nobody.
    pub(crate) fn add_thing(&mut self, model: &str, size_m: [f64; 3], variant: u32, at: Affine3A) {
        self.add_thing_level(model, size_m, variant, 0, at);
    }

    /// The same as detailed as it is farther away; gives the number of triangles.
    pub(crate) fn add_thing_level(
        &mut self,
        model: &str,
        size_m: [f64; 3],
        variant: u32,
        level: usize,
        at: Affine3A,
    ) -> usize {
        let Some(made) = actor_mesh(model, size_m, variant) else { return 0 };
        let object = self.instances.len() as u16 + 1;
        let coarser = level.checked_sub(1).and_then(|i| made.coarser.get(i));
        let pieces: &[Piece] = coarser.map_or(&made.pieces, |coarser| &coarser.pieces);
        for piece in pieces {
            self.instances.push(common::instance(self.meshes.len() as u32, object, at));
            self.meshes.push(Arc::clone(&piece.mesh));
        }
        pieces.iter().map(|piece| piece.mesh.triangles.len()).sum()
    }

    /// A bench, with somebody of each look on it from its left to its right; all of them at a phase.
    pub(crate) fn add_bench(&mut self, at: Affine3A, sitters: &[(&Model, u32)], phase_rad: f32) {
        let size_m = [0.55, 1.7, 0.85];
        let Some(made) = actor_mesh(benches::MODEL, size_m, 0) else { return };
        for piece in &made.pieces {
            let object = self.instances.len() as u16 + 1;
            self.instances.push(common::instance(self.meshes.len() as u32, object, at));
            self.meshes.push(Arc::clone(&piece.mesh));
        }
        let seat_m = (benches::SEAT * size_m[2]) as f32;
        for ((model, look), left) in sitters.iter().zip(benches::PLACES) {
            let walker = Walker::new(model, *look);
            let length_m = walker.posed_box_m(&walker.bones(phase_rad, 0.0, seat_m)).x;
            let ahead_m = (benches::BACK_M - 0.5 * size_m[0]) as f32 + 0.5 * length_m;
            let place = Affine3A::from_translation(Vec3::new(ahead_m, (left * size_m[1]) as f32, 0.0));
            self.add(model, *look, at * place, Posture { phase_rad, seat_m, ..Posture::default() });
        }
    }

    /// A piece of the ground, as seen from a place in the world.
    pub(crate) fn add_ground(&mut self, piece: SurfaceMesh, from_m: [f64; 3]) {
        let off = [0, 1, 2].map(|k| (piece.origin_m[k] - from_m[k]) as f32);
        let at = Affine3A::from_translation(Vec3::from_array(off));
        self.instances.push(common::instance(self.meshes.len() as u32, piece.layer as u16 + 1, at));
        self.meshes.push(Arc::new(piece.mesh));
    }

    /// A walker with meshes of their own.
    pub(crate) fn add_walker(&mut self, walker: &Walker, at: Affine3A, phase_rad: f32, gait_mps: f32) {
        let bones = walker.figure().walking(phase_rad, gait_mps);
        let object = self.instances.len() as u16 + 1;
        for (bone, mesh) in walker.meshes() {
            let pose = at * bones.object_from_bone(*bone);
            self.instances.push(common::instance(self.meshes.len() as u32, object, pose));
            self.meshes.push(Arc::clone(mesh));
        }
    }

    /// A model of a pack with its doors closed.
    pub(crate) fn add_pack(&mut self, model: &PackModel, at: Affine3A) {
        let object = self.instances.len() as u16 + 1;
        for piece in model.levels.first().map_or(&[][..], |level| &level.pieces) {
            let place_m = match piece.hang {
                Attachment::Wheel { at, .. } | Attachment::Door { at, .. } => at,
                Attachment::Body | Attachment::Bone(_) => Vec3::ZERO,
            };
            let pose = at * Affine3A::from_translation(place_m);
            self.instances.push(common::instance(self.meshes.len() as u32, object, pose));
            self.meshes.push(Arc::clone(&piece.mesh));
        }
    }

    /// A vehicle without its panes, so that its cabin shows.
    pub(crate) fn add_open(&mut self, model: &Model, at: Affine3A, paint: [f32; 3]) -> usize {
        let Some(made) = actor_mesh(model.name, model.size_m, 0) else { return 0 };
        let first = self.meshes.len();
        self.add_level(model, 0, 0, at, Posture::default(), paint);
        let body = Arc::make_mut(&mut self.meshes[first]);
        let kept: Vec<usize> =
            (0..body.triangles.len()).filter(|i| !body.part(*i).surface.is_window()).collect();
        body.triangles = kept.iter().map(|i| body.triangles[*i]).collect();
        body.triangle_part = kept.iter().map(|i| body.triangle_part[*i]).collect();
        body.corner_visibility =
            kept.iter().filter_map(|i| body.corner_visibility.get(*i).copied()).collect();
        body.corner_normals = kept.iter().filter_map(|i| body.corner_normals.get(*i).copied()).collect();
        let behind = made.cabin.into_iter().flat_map(|cabin| [Some(cabin.seats), cabin.driver]).flatten();
        let mut triangles = 0;
        for mesh in behind {
            let instance = common::instance(self.meshes.len() as u32, 2, at);
            self.instances.push(Instance { paint, ..instance });
            triangles += mesh.triangles.len();
            self.meshes.push(mesh);
        }
        triangles
    }

    /// Switches lamps of everything on it on.
    pub(crate) fn light(&mut self, lights: u32) {
        self.instances.iter_mut().for_each(|instance| instance.lights = lights);
    }

    /// The stage from the side of -y, so many metres away and so wide at the middle.
    pub(crate) fn save(
        self,
        path: &Path,
        eye: [f64; 3],
        down_rad: f64,
        size: [u32; 2],
        fov_deg: f64,
    ) -> Result<(), Box<dyn Error>> {
        self.draw(path, eye, [0.0, down_rad, frames::deg(90.0)], size, fov_deg)
    }

    /// The stage from anywhere: roll, down and yaw in radians.
    pub(crate) fn draw(
        self,
        path: &Path,
        eye: [f64; 3],
        rpy_rad: [f64; 3],
        size: [u32; 2],
        fov_deg: f64,
    ) -> Result<(), Box<dyn Error>> {
        let day = Weather {
            sun_azimuth_deg: 215.0,
            sun_altitude_deg: 48.0,
            cloudiness: 30.0,
            ..Weather::default()
        };
        let snapshot = Snapshot { cabins: self.cabins, ..common::snapshot(self.meshes, self.instances) };
        let optics = Optics::pinhole(size[0], size[1], frames::deg(fov_deg));
        let view = common::set_view(eye, rpy_rad, optics, &CameraSettings::default());
        let picture = common::picture(&snapshot, &view, &day);
        let [width, height] = [picture.width, picture.height].map(u16::try_from);
        let mut encoder = jpeg_encoder::Encoder::new_file(path, 78)?;
        encoder.set_sampling_factor(jpeg_encoder::SamplingFactor::F_2_2);
        encoder.encode(&picture.rgb, width?, height?, jpeg_encoder::ColorType::Rgb)?;
        Ok(())
    }
}

/// A place on the plane and the way to look.
pub(crate) fn at(x: f32, y: f32, yaw_deg: f32) -> Affine3A {
    common::at(x, y, 0.0, yaw_deg.to_radians())
}
