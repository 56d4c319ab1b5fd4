//! Triangles of the horizon.

use glam::Vec3;
use schema::geometry::{MeshPart, TriMesh};

/// A mesh while it is made.
#[derive(Default)]
pub(super) struct Shape(TriMesh);

impl Shape {
    /// A flat triangle or quadrangle, counter-clockwise seen from outside.
    pub(super) fn face(&mut self, part: MeshPart, corners: &[Vec3]) {
        let part = self.0.part_index(part);
        let corners: Vec<u32> = corners.iter().map(|corner| self.0.add_vertex(*corner)).collect();
        for pair in corners[1..].windows(2) {
            self.0.add_triangle(part, [corners[0], pair[0], pair[1]]);
        }
    }

    /// A tree from its foot to its top: the sides of its crown.
    pub(super) fn tree(&mut self, part: MeshPart, foot: Vec3, radius_m: f32, height_m: f32) {
        // Radius and height, as shares.
        const PROFILE: [(f32, f32); 3] = [(0.25, 0.0), (1.0, 0.38), (0.72, 0.78)];
        const SIDES: usize = 5;
        let place = |(radius, up): (f32, f32), k: usize| {
            let (s, c) = frames::math::f32::sin_cos(std::f32::consts::TAU * k as f32 / SIDES as f32);
            foot + Vec3::new(c * radius * radius_m, s * radius * radius_m, up * height_m)
        };
        for k in 0..SIDES {
            for ring in PROFILE.windows(2) {
                let corners =
                    [(0, k), (0, k + 1), (1, k + 1), (1, k)].map(|(r, k)| place(ring[r], k % SIDES));
                self.face(part, &corners);
            }
            let last = PROFILE[PROFILE.len() - 1];
            self.face(part, &[place(last, k), place(last, (k + 1) % SIDES), foot + Vec3::Z * height_m]);
        }
    }

    /// A pyramid over a square.
    pub(super) fn spire(&mut self, part: MeshPart, foot: Vec3, half_m: f32, height_m: f32) {
        let plan = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let ring = plan.map(|(x, y)| foot + Vec3::new(x * half_m, y * half_m, 0.0));
        for i in 0..4 {
            self.face(part, &[ring[i], ring[(i + 1) % 4], foot + Vec3::Z * height_m]);
        }
    }

    /// A house on a place: walls of a height, and a roof that rises to its ridge along x or, without a
    /// rise, is flat. `half_m` and `along` are in the plane.
    pub(super) fn house(
        &mut self,
        [wall, roof]: [MeshPart; 2],
        foot: Vec3,
        ([half_x, half_y], along): ([f32; 2], Vec3),
        [eaves_m, ridge_m]: [f32; 2],
    ) {
        let across = Vec3::new(-along.y, along.x, 0.0);
        let place =
            |x: f32, y: f32, z: f32| foot + along * (x * half_x) + across * (y * half_y) + Vec3::Z * z;
        // Into the ground, which slopes.
        const DEEP_M: f32 = -4.0;
        let plan = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        for i in 0..4 {
            let ((x0, y0), (x1, y1)) = (plan[i], plan[(i + 1) % 4]);
            let mut side = vec![
                place(x0, y0, DEEP_M),
                place(x1, y1, DEEP_M),
                place(x1, y1, eaves_m),
                place(x0, y0, eaves_m),
            ];
            if x0 == x1 && ridge_m > 0.0 {
                side.insert(3, place(x0, 0.0, eaves_m + ridge_m));
            }
            self.face(wall, &side);
        }
        if ridge_m > 0.0 {
            let ridge = [place(-1.0, 0.0, eaves_m + ridge_m), place(1.0, 0.0, eaves_m + ridge_m)];
            self.face(roof, &[place(-1.0, -1.0, eaves_m), place(1.0, -1.0, eaves_m), ridge[1], ridge[0]]);
            self.face(roof, &[place(1.0, 1.0, eaves_m), place(-1.0, 1.0, eaves_m), ridge[0], ridge[1]]);
        } else {
            self.face(roof, &plan.map(|(x, y)| place(x, y, eaves_m)));
        }
    }

    pub(super) fn finish(self) -> TriMesh {
        self.0
    }
}
