//! How a house front is divided: bays, storeys, and a window in each.

use glam::Vec3;
use schema::ObjectId;
use schema::geometry::Wall;

use super::front_style::{Style, own};
use super::windows::Windows;

/// Height of a storey, metres, where it fits the wall.
const STOREY_M: f32 = 3.1;
/// Walls narrower than this have no windows, metres.
const NARROW_M: f32 = 1.6;

/// A front.
pub(super) struct Front {
    pub(super) wall: Wall,
    pub(super) style: Style,
    /// Left and lower end of the wall, and width of a bay and height of a storey, metres.
    pub(super) start_m: [f32; 2],
    pub(super) cell_m: [f32; 2],
    /// Whether its lowest storey is the ground floor.
    pub(super) is_on_ground: bool,
    /// None on narrow walls.
    pub(super) windows: Option<Windows>,
}

impl Front {
    /// Of a triangle of a wall, which reaches from end to end: a whole number of bays and storeys fit.
    pub(super) fn new(wall: Wall, object: ObjectId, right: Vec3, corners_m: [Vec3; 3]) -> Self {
        let style = Style::of(wall, &|salt| own(object, salt));
        let range = |of: &dyn Fn(Vec3) -> f32| {
            let [a, b, c] = corners_m.map(of);
            [a.min(b).min(c), a.max(b).max(c)]
        };
        let (along, up) = (range(&|p| p.dot(right)), range(&|p| p.z));
        let cell = |[low, high]: [f32; 2], wanted: f32| {
            let length = high - low;
            length / (length / wanted).round().max(1.0)
        };
        let cell_m = [cell(along, style.bay_m), cell(up, STOREY_M)];
        let cells = [along, up].map(|[low, high]| high - low);
        let cells = [0, 1].map(|axis| (cells[axis] / cell_m[axis]).round());
        let is_on_ground = up[0] < 1.5;
        let is_blank = along[1] - along[0] < NARROW_M || up[1] - up[0] < 1.8;
        Self {
            wall,
            start_m: [along[0], up[0]],
            cell_m,
            is_on_ground,
            windows: (!is_blank).then(|| Windows::new(wall, object, &style, cells, is_on_ground)),
            style,
        }
    }
}
