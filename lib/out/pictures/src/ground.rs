//! The map under what is drawn.

use nalgebra::{Isometry3, Point3};

use crate::{Canvas, Rgb, View};

/// What an element of a map is, as far as its picture tells; in painting order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum GroundStyle {
    /// Paved ground of a junction.
    Junction,
    /// A walk for pedestrians.
    Sidewalk,
    /// A pedestrian crossing.
    Crosswalk,
    /// The border of a lane.
    LaneBorder,
    /// The edge of the ground for vehicles.
    Edge,
    /// Paint along the road.
    Paint,
    /// A line at which traffic must stop.
    StopLine,
}

impl GroundStyle {
    fn rgb(self) -> Rgb {
        match self {
            Self::Junction => [240, 240, 243],
            Self::Sidewalk => [232, 226, 214],
            Self::Crosswalk => [222, 222, 230],
            Self::LaneBorder => [216, 218, 222],
            Self::Edge => [150, 154, 160],
            Self::Paint => [196, 198, 204],
            Self::StopLine => [206, 120, 110],
        }
    }

    /// Width of its line, in widths of thin lines.
    fn width(self) -> f64 {
        match self {
            Self::Edge => 1.5,
            Self::StopLine => 2.0,
            _ => 1.0,
        }
    }

    fn is_area(self) -> bool {
        matches!(self, Self::Junction | Self::Sidewalk | Self::Crosswalk)
    }
}

/// An element of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundLine {
    /// What it is.
    pub style: GroundStyle,
    /// Its points in the world, metres: a line, or rings one after another.
    pub chains_m: Vec<Vec<Point3<f64>>>,
}

/// Draws elements of a map from above, areas under lines; in other views nothing, since lines that reach the
/// horizon hide what stands before them. `space_from_world` takes them to the space of the view; thin lines
/// are `line_px` wide, however many metres a pixel is.
pub fn draw_ground(
    canvas: &mut Canvas,
    view: &View,
    space_from_world: &Isometry3<f64>,
    ground: &[GroundLine],
    line_px: f64,
) {
    let View::Above { .. } = view else { return };
    let mut order: Vec<&GroundLine> = ground.iter().collect();
    order.sort_by_key(|line| line.style);
    let [w, h] = view.size().map(f64::from);
    for line in order {
        let place = |chain: &Vec<Point3<f64>>| {
            let places = chain.iter().filter_map(|p| view.project(space_from_world * p));
            places.map(|(at, _)| at).collect::<Vec<[f64; 2]>>()
        };
        let chains: Vec<Vec<[f64; 2]>> = line.chains_m.iter().map(place).collect();
        let points = || chains.iter().flatten();
        let is_shown = (0..2)
            .all(|k| points().any(|at| at[k] >= 0.0) && points().any(|at: &[f64; 2]| at[k] <= [w, h][k]));
        if !is_shown {
            continue;
        }
        let slices = chains.iter().map(Vec::as_slice);
        if line.style.is_area() {
            canvas.area(slices, line.style.rgb(), 255);
        } else {
            canvas.lines(slices, line_px * line.style.width(), line.style.rgb());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Reach;

    #[test]
    fn areas_lie_under_lines() {
        let view = View::above(Reach::Far);
        let mut canvas = Canvas::new(view.size(), [255; 3]).expect("fits");
        let ring = [[-5.0, -5.0], [5.0, -5.0], [5.0, 5.0], [-5.0, 5.0]];
        let ring = ring.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
        let line = vec![Point3::new(-20.0, 0.0, 0.0), Point3::new(20.0, 0.0, 0.0)];
        let ground = [
            GroundLine { style: GroundStyle::Edge, chains_m: vec![line] },
            GroundLine { style: GroundStyle::Junction, chains_m: vec![ring] },
        ];
        draw_ground(&mut canvas, &view, &Isometry3::identity(), &ground, 2.0);
        // 16 pixels a metre, x up: the line runs up the middle, three pixels wide, the square around it.
        assert_eq!(canvas.pixel([1280, 1280]), Some(GroundStyle::Edge.rgb()));
        assert_eq!(canvas.pixel([1280, 1280 - 300]), Some(GroundStyle::Edge.rgb()));
        let wide = (1200..1360).filter(|x| canvas.pixel([*x, 1000]) != Some([255; 3])).count();
        assert!((3..=4).contains(&wide), "{wide}");
        assert_eq!(canvas.pixel([1280 + 70, 1280 - 70]), Some(GroundStyle::Junction.rgb()));
        assert_eq!(canvas.pixel([1280 + 90, 1280]), Some([255; 3]));
    }
}
