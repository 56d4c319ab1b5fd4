//! Which of a picture's texels are there.

use glam::Vec2;
use schema::mesh_textures::Wrap;

/// Places looked at along a side of a triangle at most.
const STEPS: f32 = 24.0;

/// What of a picture is there.
#[derive(Clone)]
pub(crate) struct Stencil {
    width: u32,
    wrap: [Wrap; 2],
    is_there: Vec<bool>,
}

impl Stencil {
    /// `width` texels in a row, row by row.
    pub(crate) fn new(width: u32, wrap: [Wrap; 2], is_there: Vec<bool>) -> Self {
        Self { width: width.max(1), wrap, is_there }
    }

    fn size(&self) -> Vec2 {
        Vec2::new(self.width as f32, (self.is_there.len() as u32 / self.width).max(1) as f32)
    }

    fn shows(&self, uv: Vec2) -> bool {
        let size = self.size();
        let at = uv * size;
        let x = self.wrap[0].texel(at.x.floor() as i32, self.width);
        let y = self.wrap[1].texel(at.y.floor() as i32, size.y as u32);
        self.is_there.get((y * self.width + x) as usize).copied().unwrap_or(true)
    }

    /// Lengths of a triangle's sides from each corner to the next, texels.
    pub(crate) fn sides(&self, uv: [Vec2; 3]) -> [f32; 3] {
        [0, 1, 2].map(|k| ((uv[(k + 1) % 3] - uv[k]) * self.size()).length())
    }

    /// How many places on a triangle are there, of how many.
    pub(crate) fn shown(&self, uv: [Vec2; 3]) -> [usize; 2] {
        let steps = self.sides(uv).into_iter().fold(2.0, f32::max).ceil().min(STEPS);
        let [a, b, c] = uv;
        let mut shown = [0; 2];
        for i in 0..steps as u32 {
            for j in 0..steps as u32 - i {
                let [s, t] = [i, j].map(|k| (k as f32 + 1.0 / 3.0) / steps);
                shown[0] += usize::from(self.shows(a + (b - a) * s + (c - a) * t));
                shown[1] += 1;
            }
        }
        shown
    }
}
