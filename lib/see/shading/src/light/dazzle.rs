//! Lamps that shine into a camera.

use glam::Vec3;
use schema::lights;
use simd::Vec3x8;

use super::lamps::{Beam, Lamp, Lamps};
use super::street;

/// What a street lamp gives above its cut-off, as a share of [`street::intensity`]: its cover scatters light.
const STREET_SPILL: f32 = 0.03;
/// Kilocandela of lamps that are seen and light hardly anything: traffic lights (EN 12368), brake lamps,
/// emergency lights, the others of vehicles (UN Regulation 148).
const SIGNAL_KCD: f32 = 0.15;
const BRAKE_KCD: f32 = 0.06;
const EMERGENCY_KCD: f32 = 0.4;
const SMALL_KCD: f32 = 0.008;
/// No lamp is taken to be nearer, metres.
const NEAREST_M: f32 = 1.0;

/// A lamp as a camera has it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shining {
    /// Where it is, local frame, metres.
    pub(crate) position: Vec3,
    /// The light on a surface at the camera that faces it, kilolux, if nothing is between.
    pub(crate) klx: Vec3,
}

impl Lamps {
    /// The lamps that shine on a place.
    pub(crate) fn shining_on(&self, place: Vec3) -> impl Iterator<Item = Shining> {
        self.lamps.iter().filter_map(move |lamp| {
            let klx = lamp.klx_at(place);
            (klx.max_element() > 0.0).then_some(Shining { position: lamp.position, klx })
        })
    }
}

impl Lamp {
    /// The light on a surface at a place that faces it, kilolux.
    fn klx_at(&self, place: Vec3) -> Vec3 {
        let to = place - self.position;
        let away_m = to.length();
        let way = to / away_m.max(1e-3);
        let kcd = match self.beam {
            Beam::Glow => self.color() * self.small_kcd(way),
            beam => {
                let spread = self.spread(&Vec3x8::splat(way)).to_array()[0];
                let spill = if beam == Beam::Street { STREET_SPILL * street::MOST } else { 0.0 };
                self.rgb * spread.max(spill)
            }
        };
        kcd / (away_m.max(NEAREST_M) * away_m.max(NEAREST_M))
    }

    /// Of a lamp that lights hardly anything.
    fn small_kcd(&self, way: Vec3) -> f32 {
        const SIGNALS: u32 = lights::SIGNAL_RED | lights::SIGNAL_YELLOW | lights::SIGNAL_GREEN;
        if self.bits & (lights::EMERGENCY | lights::EMERGENCY_OTHER) != 0 {
            return EMERGENCY_KCD;
        }
        let kcd = if self.bits & SIGNALS != 0 {
            SIGNAL_KCD
        } else if self.bits & lights::BRAKE != 0 {
            BRAKE_KCD
        } else {
            SMALL_KCD
        };
        // Lenses send most of their light ahead.
        let cos = way.dot(self.direction).max(0.0);
        kcd * cos * cos
    }

    /// Its colour, the greatest component 1.
    fn color(&self) -> Vec3 {
        self.rgb / self.rgb.max_element().max(1e-6)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Affine3A;
    use render::Renderer;
    use render::cpu::CpuRenderer;
    use schema::Tag;
    use schema::geometry::{MeshPart, Surface, TriMesh};

    use super::*;

    /// What shines on a place of an object at the origin that looks along x, whose one lamp is 2 m ahead.
    fn shining(bits: u32, x_m: f32, place: Vec3) -> Vec<Shining> {
        let mut mesh = TriMesh::default();
        let part = mesh.part_index(MeshPart::new(Tag::Car, Surface::Lamp(bits), [0.8, 0.1, 0.1]));
        let corners = [[x_m, -0.1, 0.6], [x_m, 0.1, 0.6], [x_m, 0.0, 0.8]];
        let corners = corners.map(|corner| mesh.add_vertex(Vec3::from_array(corner)));
        mesh.add_triangle(part, corners);
        let mut object = testkit::instance(0, 3, Affine3A::IDENTITY);
        object.lights = bits;
        let snapshot = testkit::snapshot(vec![Arc::new(mesh)], vec![object]);
        let mut renderer = CpuRenderer::default();
        renderer.prepare(&snapshot.meshes).expect("has no device");
        let scene = renderer.place(&snapshot).expect("all meshes are prepared");
        Lamps::new(&*scene, true, Vec3::ZERO).expect("has no device").shining_on(place).collect()
    }

    #[test]
    fn small_lamps_shine_where_they_look_and_less_with_the_square_of_the_distance() {
        let ahead = |away_m: f32| Vec3::new(2.0 + away_m, 0.0, 0.6 + 0.2 / 3.0);
        let [near, far] = [10.0, 20.0].map(|away_m| shining(lights::SIGNAL_RED, 2.0, ahead(away_m))[0].klx);
        assert!((near.x - SIGNAL_KCD / 100.0).abs() < 1e-6 && near.y < 0.2 * near.x, "{near}");
        assert!((near / far - 4.0).abs().max_element() < 1e-3);
        // Not behind; a tail lamp not ahead.
        assert!(shining(lights::SIGNAL_RED, 2.0, -ahead(10.0)).is_empty());
        assert!(shining(lights::BRAKE, -2.0, ahead(10.0)).is_empty());
        assert!(!shining(lights::BRAKE, -2.0, -ahead(10.0)).is_empty());
        // All around.
        assert!(!shining(lights::EMERGENCY, 0.0, ahead(10.0)).is_empty());
        assert!(!shining(lights::EMERGENCY, 0.0, -ahead(10.0)).is_empty());
    }
}
