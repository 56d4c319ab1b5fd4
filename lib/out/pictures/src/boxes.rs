//! Boxes as wire frames.

use nalgebra::{Isometry3, Point3};
use schema::{DetectionClass, Difficulty};

use crate::colours::box_rgb;
use crate::{Canvas, View};

/// The twelve edges of a box, by its corners in the dataset's order.
const EDGES: [[usize; 2]; 12] =
    [[0, 1], [0, 2], [0, 4], [1, 3], [1, 5], [2, 3], [2, 6], [3, 7], [4, 5], [4, 6], [5, 7], [6, 7]];

/// A box that is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxShape {
    /// Object id.
    pub id: u16,
    /// Eight corners in the world, metres: 0 to 4 is the length, 0 to 2 the width, 0 to 1 the height.
    pub corners_m: [Point3<f64>; 8],
    /// Its class, which says its colour.
    pub class: DetectionClass,
    /// How hard it is to detect, which says how bright and thick its lines are.
    pub difficulty: Difficulty,
}

/// Draws the edges of boxes, the hardest first. `space_from_world` takes their corners to the space of the
/// view; the lines of hard ones are `width_px` wide, those of medium ones twice, of easy ones three times as
/// much.
pub fn draw_boxes(
    canvas: &mut Canvas,
    view: &View,
    space_from_world: &Isometry3<f64>,
    boxes: &[BoxShape],
    width_px: f64,
) {
    for (difficulty, times) in [(Difficulty::Hard, 1.0), (Difficulty::Medium, 2.0), (Difficulty::Easy, 3.0)] {
        for shape in boxes.iter().filter(|shape| shape.difficulty == difficulty) {
            let corners = shape.corners_m.map(|corner| space_from_world * corner);
            let chains: Vec<Vec<[f64; 2]>> =
                EDGES.iter().flat_map(|&[a, b]| view.line(corners[a], corners[b])).collect();
            let rgb = box_rgb(shape.class, difficulty);
            canvas.lines(chains.iter().map(Vec::as_slice), times * width_px, rgb);
        }
    }
}

#[cfg(test)]
mod tests {
    use frames::{OrientedBox, Pose};

    use super::*;
    use crate::{Camera, Reach};

    fn car(at: [f64; 3], difficulty: Difficulty) -> BoxShape {
        let pose = Pose::from_xyz_rpy(at, [0.0; 3]);
        let corners_m = OrientedBox::standing(pose, 4.0, 2.0, 1.5).corners();
        BoxShape { id: 1, corners_m, class: DetectionClass::Car, difficulty }
    }

    #[test]
    fn every_edge_is_as_long_as_a_side() {
        let [length, width, height] = [4.0, 2.0, 1.5];
        let corners = car([0.0; 3], Difficulty::Easy).corners_m;
        let mut sides = EDGES.map(|[a, b]| (corners[a] - corners[b]).norm());
        sides.sort_by(f64::total_cmp);
        let want = [[height; 4], [width; 4], [length; 4]].concat();
        assert!(sides.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-12), "{sides:?}");
    }

    #[test]
    fn from_above_a_box_is_its_footprint() {
        let view = View::above(Reach::Far);
        for (difficulty, width, rgb) in
            [(Difficulty::Easy, 6, [0, 128, 240]), (Difficulty::Hard, 2, [0, 77, 144])]
        {
            let mut canvas = Canvas::new(view.size(), [255; 3]).expect("fits");
            let place = [20.0, 5.0, 0.0];
            draw_boxes(&mut canvas, &view, &Isometry3::identity(), &[car(place, difficulty)], 2.0);
            // 16 pixels a metre: x 18 to 22 is rows 928 to 992, y 4 to 6 is columns 1184 to 1216.
            let row: Vec<u32> = (1100..1300).filter(|&x| canvas.pixel([x, 960]) != Some([255; 3])).collect();
            let wanted: Vec<u32> =
                [1184, 1216].into_iter().flat_map(|x| x - width / 2..x + width / 2).collect();
            assert_eq!(row, wanted);
            assert_eq!(canvas.pixel([1200, 928]), Some(rgb));
            assert_eq!(canvas.pixel([1200, 960]), Some([255; 3]));
        }
    }

    #[test]
    fn a_camera_shows_a_box_where_pinholes_say() {
        // A face of 2 m x 1.5 m, its middle 8 m ahead: 25 by 18.75 pixels of a focal length of 100.
        let camera =
            Camera::at([0.0, 0.0, 0.75], [0.5, -0.5, 0.5, -0.5], [200, 100], [100.0, 100.0, 100.0, 50.0]);
        let view = View::Through(camera);
        let mut canvas = Canvas::new([200, 100], [255; 3]).expect("fits");
        draw_boxes(
            &mut canvas,
            &view,
            &Isometry3::identity(),
            &[car([10.0, 0.0, 0.0], Difficulty::Easy)],
            1.0,
        );
        let drawn: Vec<[u32; 2]> = (0..100)
            .flat_map(|y| (0..200).map(move |x| [x, y]))
            .filter(|&at| canvas.pixel(at) != Some([255; 3]))
            .collect();
        let range = |k: usize| {
            let along = drawn.iter().map(|at| at[k]);
            [along.clone().min().expect("any"), along.max().expect("any")]
        };
        // Half the line's width beyond: 87.5 - 1.5 to 112.5 + 1.5, 40.6 - 1.5 to 59.4 + 1.5.
        assert_eq!([range(0), range(1)], [[86, 113], [39, 60]]);
    }
}
