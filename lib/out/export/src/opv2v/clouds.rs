//! Sweeps as point clouds of files.

use frames::math;
use schema::tables::LidarRow;

schema::columns! {
    /// What clouds hold of a sweep, and the beams to thin them by.
    Sweep of LidarRow {
        frame: u32,
        x: Vec<f32>,
        y: Vec<f32>,
        z: Vec<f32>,
        intensity: Vec<f32>,
        ring: Vec<u16>,
    }
}

schema::framed!(Sweep);

impl Sweep {
    /// x ahead, y to the right, z up, and intensity of the points of every n-th beam, from the highest on.
    fn points(&self, every_n_beams: u16) -> impl Iterator<Item = ([f32; 3], f32)> {
        let place = self.x.iter().zip(&self.y).zip(&self.z);
        let points = place.zip(&self.intensity).zip(&self.ring);
        points.filter(move |(_, ring)| ring.is_multiple_of(every_n_beams)).map(|((((x, y), z), i), _)| {
            // Zero has no sign here.
            ([*x, 0.0 - *y, *z], *i)
        })
    }

    /// How high over the horizon its points are seen, rad.
    pub(super) fn elevations(&self) -> impl Iterator<Item = f64> {
        let place = self.x.iter().zip(&self.y).zip(&self.z);
        place.map(|((x, y), z)| math::atan2(f64::from(*z), math::hypot(f64::from(*x), f64::from(*y))))
    }

    /// Which of the beams to keep so that about so many are left. The lowest beam that met something counts
    /// them.
    pub(super) fn thinning(&self, beams: u16) -> u16 {
        let all = self.ring.iter().max().map_or(0, |last| u32::from(*last) + 1);
        let beams = u32::from(beams);
        u16::try_from((2 * all + beams) / (2 * beams)).unwrap_or(u16::MAX).max(1)
    }

    /// As binary PCD, of every n-th beam. Loaders take the intensity from the red of a packed colour: 8 bits.
    pub(super) fn to_pcd(&self, every_n_beams: u16) -> Vec<u8> {
        let mut body = Vec::with_capacity(16 * self.x.len());
        for (place, intensity) in self.points(every_n_beams) {
            let red = (255.0 * intensity.clamp(0.0, 1.0)).round() as u32;
            body.extend(place.iter().flat_map(|v| v.to_le_bytes()));
            body.extend((red << 16).to_le_bytes());
        }
        let n = body.len() / 16;
        let header = format!(
            "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\n\
             COUNT 1 1 1 1\nWIDTH {n}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {n}\nDATA binary\n"
        );
        [header.into_bytes(), body].concat()
    }

    /// As x, y, z, intensity: four little-endian floats a point.
    pub(super) fn to_bin(&self) -> Vec<u8> {
        let points = self.points(1).flat_map(|([x, y, z], i)| [x, y, z, i]);
        points.flat_map(f32::to_le_bytes).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sweep() -> Sweep {
        Sweep {
            frame: 0,
            x: vec![1.0, 2.0, 3.0],
            y: vec![0.0, 5.0, -6.0],
            z: vec![0.5, 0.0, -1.5],
            intensity: vec![0.0, 0.5, 1.5],
            ring: vec![0, 3, 63],
        }
    }

    #[test]
    fn left_is_to_the_other_side() {
        let bytes = sweep().to_bin();
        let floats: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
        assert_eq!(floats, [1.0, 0.0, 0.5, 0.0, 2.0, -5.0, 0.0, 0.5, 3.0, 6.0, -1.5, 1.5]);
        assert!(floats[1].is_sign_positive());
    }

    #[test]
    fn a_pcd_by_hand() {
        let file = sweep().to_pcd(1);
        let end = b"POINTS 3\nDATA binary\n";
        let start = file.windows(end.len()).position(|w| w == end).expect("has a header") + end.len();
        let body = &file[start..];
        assert_eq!(body.len(), 48);
        assert_eq!(body[..16], [0, 0, 128, 63, 0, 0, 0, 0, 0, 0, 0, 63, 0, 0, 0, 0]);
        // Blue, green, red: 128 of 255, and no more than 255.
        assert_eq!((&body[28..32], &body[44..]), (&[0, 0, 128, 0][..], &[0, 0, 255, 0][..]));
        let header = std::str::from_utf8(&file[..start]).expect("is text");
        assert_eq!((header.lines().count(), header.lines().nth(6)), (11, Some("WIDTH 3")));
    }

    #[test]
    fn thinned_clouds_have_every_nth_beam() {
        let full = sweep();
        assert_eq!((full.thinning(32), full.thinning(16)), (2, 4));
        let kept = |n| (full.to_pcd(n).len() - full.to_pcd(64).len()) / 16;
        assert_eq!([1, 3].map(kept), [2, 2], "0, 3 and 63; all of them are multiples of 3");
        assert_eq!(kept(2), 0, "the first alone");
        let many = Sweep { ring: vec![127], ..Sweep::default() };
        let few = Sweep { ring: vec![15], ..Sweep::default() };
        assert_eq!([many.thinning(32), many.thinning(16), few.thinning(16), few.thinning(32)], [4, 8, 1, 1]);
        assert_eq!(Sweep::default().thinning(16), 1);
    }
}
