//! How a house front is divided: bays, storeys, and a window in each.

use glam::Vec3;
use schema::ObjectId;
use schema::geometry::Wall;
use simd::F32x8;

use super::pattern::{Width, bars};
use super::room::REVEAL_M;

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
        let is_blank = along[1] - along[0] < NARROW_M || up[1] - up[0] < 1.8;
        Self {
            wall,
            start_m: [along[0], up[0]],
            cell_m,
            is_on_ground: up[0] < 1.5,
            windows: (!is_blank).then(|| Windows::new(style.opening, style.is_split, cell_m)),
            style,
        }
    }
}

/// A number of a building, 0 to 1.
pub(super) fn own(object: ObjectId, salt: i32) -> f32 {
    crate::textures::unit(crate::textures::hash2(i32::from(object), salt, 0x51ed))
}

/// What a front is divided into.
pub(super) struct Style {
    pub(super) bay_m: f32,
    /// Width and height of openings over those of bays and storeys.
    pub(super) opening: [f32; 2],
    /// Whether panes have a bar in the middle.
    pub(super) is_split: bool,
    /// How far panes stand back, metres.
    pub(super) reveal_m: f32,
    /// Strength of window sills, and of bands between storeys.
    pub(super) sill: f32,
    pub(super) band: f32,
    /// Share of light that panes mirror and let through.
    pub(super) mirror: f32,
    pub(super) clear: f32,
}

impl Style {
    #[inline]
    fn of(wall: Wall, pick: &impl Fn(i32) -> f32) -> Self {
        let (wide, high) = (pick(2), pick(3));
        let common = Self {
            bay_m: 2.6 + pick(1),
            opening: [0.40 + 0.18 * wide, 0.46 + 0.14 * high],
            is_split: true,
            reveal_m: REVEAL_M,
            sill: 1.0,
            band: if pick(5) > 0.5 { 1.0 } else { 0.0 },
            mirror: 0.06,
            clear: 0.8,
        };
        match wall {
            Wall::Plaster | Wall::Brick => common,
            Wall::Ashlar => Self { band: 1.0, opening: [0.38 + 0.1 * wide, 0.55 + 0.1 * high], ..common },
            Wall::Panels => Self {
                bay_m: 3.2 + pick(1),
                opening: [0.6 + 0.25 * wide, 0.44 + 0.08 * high],
                is_split: wide < 0.5,
                sill: 0.0,
                band: 0.0,
                reveal_m: 0.1,
                ..common
            },
            Wall::Curtain => Self {
                bay_m: 1.4 + 0.5 * pick(1),
                opening: [0.955, 0.66 + 0.2 * high],
                is_split: false,
                reveal_m: 0.03,
                sill: 0.0,
                band: 0.0,
                mirror: 0.13,
                clear: 0.45,
            },
        }
    }
}

/// The windows of some storeys, in bays and storeys.
pub(super) struct Windows {
    pub(super) wide: f32,
    pub(super) high: f32,
    sill: f32,
    is_split: bool,
    cell_m: [f32; 2],
}

impl Windows {
    #[inline]
    fn new([wide, high]: [f32; 2], is_split: bool, cell_m: [f32; 2]) -> Self {
        Self { wide, high, sill: 0.5 - 0.5 * high + 0.05f32.min(0.4 * (1.0 - high)), is_split, cell_m }
    }

    /// Left and lower edge of openings.
    pub(super) fn start(&self) -> [f32; 2] {
        [0.5 - 0.5 * self.wide, self.sill]
    }

    /// Share of openings in the wall.
    #[inline]
    pub(super) fn opening(&self, u: F32x8, v: F32x8, wu: Width, wv: Width) -> F32x8 {
        let [left, sill] = self.start();
        bars(u - left, self.wide, wu) * bars(v - sill, self.high, wv)
    }

    /// Share of panes: the frame is a band of 6 cm inside the opening, and a bar in its middle.
    #[inline]
    pub(super) fn panes(&self, u: F32x8, v: F32x8, wu: Width, wv: Width) -> F32x8 {
        let [left, sill] = self.start();
        let (fu, fv) = (0.06 / self.cell_m[0], 0.06 / self.cell_m[1]);
        let pane =
            bars(u - left - fu, self.wide - 2.0 * fu, wu) * bars(v - sill - fv, self.high - 2.0 * fv, wv);
        if self.is_split { pane * (1.0 - bars(u - 0.5 + 0.5 * fu, fu, wu)) } else { pane }
    }

    /// Share of the sills below openings.
    #[inline]
    pub(super) fn ledge(&self, u: F32x8, v: F32x8, wu: Width, wv: Width) -> F32x8 {
        let [left, sill] = self.start();
        bars(v - sill + 0.03, 0.03, wv) * bars(u - left + 0.025, self.wide + 0.05, wu)
    }
}
