//! Clouds of points.

use frames::math;
use nalgebra::{Isometry3, Point3};
use schema::Tag;

use crate::colours::{agent_rgb, distance_rgb, height_rgb, id_rgb, intensity_rgb, velocity_rgb};
use crate::{Canvas, PictureError, Rgb, View};

/// What a point's colour tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColourBy {
    /// Its distance from the sensor.
    Distance,
    /// Its height over the agent's ground.
    Height,
    /// The semantic tag of what was hit.
    Tag,
    /// The object that was hit.
    Id,
    /// How strong the return is.
    Intensity,
    /// How fast what was hit comes nearer or goes away.
    Velocity,
    /// Which agent's point it is.
    Agent,
}

impl ColourBy {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Distance, Self::Height, Self::Tag, Self::Id, Self::Intensity, Self::Velocity, Self::Agent];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Distance => "distance",
            Self::Height => "height",
            Self::Tag => "tag",
            Self::Id => "id",
            Self::Intensity => "intensity",
            Self::Velocity => "velocity",
            Self::Agent => "agent",
        }
    }

    /// The column of a sensor's table that says it; none where places alone do, or whose points they are.
    #[must_use]
    pub fn column(self) -> Option<&'static str> {
        match self {
            Self::Distance | Self::Height | Self::Agent => None,
            Self::Tag | Self::Id | Self::Intensity | Self::Velocity => Some(self.name()),
        }
    }
}

/// Points of a sensor in its frame (FLU), metres. Columns are as long as `xyz_m`, or empty where the sensor
/// has no such.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// Places.
    pub xyz_m: Vec<[f32; 3]>,
    /// Semantic tags.
    pub tag: Vec<u8>,
    /// Object ids.
    pub id: Vec<u16>,
    /// Strength of the return, 0 to 1.
    pub intensity: Vec<f32>,
    /// Radial velocity, m/s, positive receding.
    pub velocity: Vec<f32>,
}

impl Cloud {
    /// Of a radar's returns: distance m, angle above its horizon and to its left rad, radial velocity m/s.
    #[must_use]
    pub fn from_polar(depth_m: &[f32], altitude: &[f32], azimuth: &[f32], velocity: &[f32]) -> Self {
        let angles = altitude.iter().zip(azimuth);
        let xyz_m = depth_m.iter().zip(angles).map(|(&depth, (&altitude, &azimuth))| {
            let (up, flat) = math::sin_cos(f64::from(altitude));
            let (left, ahead) = math::sin_cos(f64::from(azimuth));
            let depth = f64::from(depth);
            [depth * flat * ahead, depth * flat * left, depth * up].map(|v| v as f32)
        });
        Self { xyz_m: xyz_m.collect(), velocity: velocity.to_vec(), ..Self::default() }
    }

    /// What its points can be coloured by.
    pub fn colours(&self) -> impl Iterator<Item = ColourBy> {
        ColourBy::ALL.into_iter().filter(|by| self.has(*by))
    }

    /// Without a column that is no reading.
    #[must_use]
    pub fn without(mut self, by: ColourBy) -> Self {
        match by {
            ColourBy::Distance | ColourBy::Height | ColourBy::Agent => {}
            ColourBy::Tag => self.tag.clear(),
            ColourBy::Id => self.id.clear(),
            ColourBy::Intensity => self.intensity.clear(),
            ColourBy::Velocity => self.velocity.clear(),
        }
        self
    }

    /// Whether its points can be coloured by something.
    #[must_use]
    pub fn has(&self, by: ColourBy) -> bool {
        let n = self.xyz_m.len();
        match by {
            ColourBy::Distance | ColourBy::Height | ColourBy::Agent => true,
            ColourBy::Tag => self.tag.len() == n,
            ColourBy::Id => self.id.len() == n,
            ColourBy::Intensity => self.intensity.len() == n,
            ColourBy::Velocity => self.velocity.len() == n,
        }
    }
}

/// Draws points as squares of `side_px` pixels, nearer ones over farther ones. `space_from_sensor` takes them
/// to the space of the view, `ground_z_m` is the height of the agent's ground there, `agent` the place of the
/// agent in the scene's list.
///
/// # Errors
/// The points have not what they are to be coloured by.
pub fn draw_cloud(
    canvas: &mut Canvas,
    depth: &mut Vec<f32>,
    view: &View,
    (cloud, space_from_sensor): (&Cloud, &Isometry3<f64>),
    (by, ground_z_m, agent): (ColourBy, f64, usize),
    side_px: u32,
) -> Result<(), PictureError> {
    if !cloud.has(by) {
        let others = cloud.colours().map(ColourBy::name).collect::<Vec<_>>().join(", ");
        return Err(PictureError::NoColour { by: by.name(), others });
    }
    let [width, height] = canvas.size().map(|side| side as i64);
    depth.resize((width * height) as usize, f32::INFINITY);
    let mut rows: Vec<&mut [u8]> = canvas.rows_mut().collect();
    let half = 0.5 * f64::from(side_px);
    for (i, xyz_m) in cloud.xyz_m.iter().enumerate() {
        let local = Point3::from(xyz_m.map(f64::from));
        let point = space_from_sensor * local;
        let Some(([u, v], far)) = view.project(point) else { continue };
        let [left, top] = [u, v].map(|at| (at - half).round() as i64);
        let side = i64::from(side_px);
        if left + side <= 0 || top + side <= 0 || left >= width || top >= height {
            continue;
        }
        let rgb: Rgb = match by {
            ColourBy::Distance => distance_rgb(local.coords.norm()),
            ColourBy::Height => height_rgb(point.z - ground_z_m),
            ColourBy::Tag => Tag::from_u8(cloud.tag[i]).unwrap_or_default().viewer_rgb(),
            ColourBy::Id => id_rgb(cloud.id[i]),
            ColourBy::Intensity => intensity_rgb(f64::from(cloud.intensity[i])),
            ColourBy::Velocity => velocity_rgb(f64::from(cloud.velocity[i])),
            ColourBy::Agent => agent_rgb(agent),
        };
        let far = far as f32;
        for y in top.max(0)..(top + side).min(height) {
            for x in left.max(0)..(left + side).min(width) {
                let cell = &mut depth[(y * width + x) as usize];
                if far < *cell {
                    *cell = far;
                    let at = 4 * x as usize;
                    rows[y as usize][at..at + 3].copy_from_slice(&rgb);
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Reach;

    fn draw(cloud: &Cloud, by: ColourBy) -> Canvas {
        let view = View::above(Reach::Far);
        let mut canvas = Canvas::new(view.size(), [255; 3]).expect("fits");
        let place = (cloud, &Isometry3::identity());
        draw_cloud(&mut canvas, &mut Vec::new(), &view, place, (by, -1.8, 1), 3).expect("draws");
        canvas
    }

    #[test]
    fn higher_points_cover_lower_ones_in_whatever_order() {
        let place = |z: f32, tag: Tag| ([10.0, 0.0, z], tag as u8);
        for points in
            [[place(0.0, Tag::Road), place(2.0, Tag::Car)], [place(2.0, Tag::Car), place(0.0, Tag::Road)]]
        {
            let (xyz_m, tag) = points.into_iter().unzip();
            let canvas = draw(&Cloud { xyz_m, tag, ..Cloud::default() }, ColourBy::Tag);
            // 10 m ahead at 16 pixels a metre, a square of three pixels.
            assert_eq!(canvas.pixel([1280, 1120]), Some(Tag::Car.viewer_rgb()));
            assert_eq!(canvas.pixel([1280, 1123]), Some([255; 3]));
        }
    }

    #[test]
    fn columns_that_are_not_there_cannot_be_shown() {
        let cloud = Cloud::from_polar(&[10.0], &[0.0], &[0.0], &[-4.0]);
        let by: Vec<&str> = cloud.colours().map(ColourBy::name).collect();
        assert_eq!(by, ["distance", "height", "velocity", "agent"]);
        let (mut canvas, view) = (Canvas::new([9, 9], [0; 3]).expect("fits"), View::above(Reach::Far));
        let place = (&cloud, &Isometry3::identity());
        let fault = draw_cloud(&mut canvas, &mut Vec::new(), &view, place, (ColourBy::Tag, 0.0, 0), 1);
        let text = fault.expect_err("has none").to_string();
        assert_eq!(text, "these points have no tag: colour them by distance, height, velocity, agent");
        let bare = cloud.without(ColourBy::Velocity).without(ColourBy::Height);
        assert_eq!(bare.colours().map(ColourBy::name).collect::<Vec<_>>(), ["distance", "height", "agent"]);
    }

    #[test]
    fn radar_angles_go_left_and_up() {
        let quarter = std::f32::consts::FRAC_PI_2;
        let cloud =
            Cloud::from_polar(&[2.0, 2.0, 2.0], &[0.0, 0.0, quarter], &[0.0, quarter, 0.0], &[0.0; 3]);
        for (got, want) in cloud.xyz_m.iter().zip([[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]]) {
            assert!((0..3).all(|k| (got[k] - want[k] as f32).abs() < 1e-6), "{got:?}");
        }
    }
}
