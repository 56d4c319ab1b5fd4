//! Cars, vans and pickups: a hull with what is on it, wheels, and doors that open.

mod doors;
mod ends;
mod flanks;
mod livery;

use crate::solids::{Detail, Fit, MeshBuilder};
use catalogue::{BaseType, CarBody, Model};
use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use crate::actors::cabin::cabin;
use crate::actors::hull::Hull;
use crate::actors::pieces::{ActorMesh, Cabin, Piece};
use crate::actors::skin::{Grid, LINE_M, Place, skin, wheel_houses};
use crate::actors::wheel::Wheels;

/// A car, van or pickup with its wheels and doors.
pub(crate) fn vehicle(model: &Model, body: &CarBody, size: Vec3) -> ActorMesh {
    let tag = if model.base == BaseType::Car { Tag::Car } else { Tag::Truck };
    let (radius, wheelbase) = (model.wheel_radius_m as f32, model.wheelbase_m as f32);
    // Front overhang is a little shorter than the rear one.
    let ahead = if size.x < 3.0 { 0.5 } else { 0.46 };
    let front = 0.5 * size.x - ahead * (size.x - wheelbase);
    let axles = [front, front - wheelbase];
    let hull = Hull::new(body.shape, [-0.5 * size.x, 0.5 * size.x], [0.5 * size.y, size.z], &axles, radius);
    let width = 0.125 * size.y;
    let aside = |f: f32| hull.side_at(f, 0.8 * radius, true).y;
    let wheels = Wheels {
        tag,
        axles: &axles,
        radius,
        width,
        outer_y: aside(hull.f_of(axles[0])).min(aside(hull.f_of(axles[1]))) - 0.022,
        rim: body.rim,
    };
    let car = Car { model, hull: &hull, looks: Looks::new(tag, model), wheels };
    ActorMesh::with_cabin(|detail| car.pieces(detail), |fit| car.cabin(fit, &|_, _, _| false))
}

/// What the skin of a car is made of.
pub(crate) struct Looks {
    tag: Tag,
    pub(crate) paint: MeshPart,
    pub(crate) window: MeshPart,
    /// That of lamps.
    glass: MeshPart,
    pub(crate) under: MeshPart,
    /// Unpainted plastic.
    pub(crate) trim: MeshPart,
    pub(crate) chrome: MeshPart,
    /// Lower band of the sides.
    sill: MeshPart,
    pub(crate) gap: MeshPart,
}

impl Looks {
    pub(crate) fn new(tag: Tag, model: &Model) -> Self {
        let paint = MeshPart::new(tag, Surface::Paint, [0.5; 3]);
        let plain = |rgb: [f32; 3]| MeshPart::new(tag, Surface::Plain, rgb);
        Self {
            tag,
            paint,
            window: MeshPart::new(tag, Surface::Window, [0.04, 0.05, 0.06]),
            glass: MeshPart::new(tag, Surface::Glass, [0.04, 0.05, 0.06]),
            under: plain([0.022, 0.022, 0.023]),
            trim: MeshPart::new(tag, Surface::Rubber, [0.035, 0.035, 0.037]),
            chrome: MeshPart::new(tag, Surface::Metal, [0.7, 0.71, 0.72]),
            sill: model.car_body().and_then(|body| body.sill_rgb).map_or(paint, plain),
            gap: plain([0.05, 0.05, 0.052]),
        }
    }

    pub(crate) fn lamp(&self, bits: u32, rgb: [f32; 3]) -> MeshPart {
        MeshPart::new(self.tag, Surface::Lamp(bits), rgb)
    }
}

/// A vehicle with a hull in the making: a car, a bus, or the cab of a lorry.
pub(crate) struct Car<'a> {
    pub(crate) model: &'a Model,
    pub(crate) hull: &'a Hull,
    pub(crate) looks: Looks,
    pub(crate) wheels: Wheels<'a>,
}

impl Car<'_> {
    fn pieces(&self, detail: Detail) -> (Vec<Piece>, Fit) {
        let hull = self.hull;
        let mut b = MeshBuilder::new();
        self.shell(&mut b, detail);
        self.nose(&mut b, detail);
        self.tail(&mut b, detail);
        self.flanks(&mut b, detail);
        self.livery(&mut b, detail);
        self.on_the_roof(&mut b, detail);
        let bottom = hull.style.clearance * hull.height;
        let (half_l, half_w) = (hull.x[1], hull.half_width);
        let fit = b.fit(Vec3::new(-half_l, -half_w, bottom), Vec3::new(half_l, half_w, hull.height));
        let mut pieces = self.wheels.under(b, detail);
        pieces.extend(self.doors(&fit));
        (pieces, fit)
    }

    /// What is behind its panes; `also` says where there are more of them than the skin has: at a place, on
    /// the left or the right.
    pub(crate) fn cabin(&self, fit: &Fit, also: &dyn Fn(f32, Place, bool) -> bool) -> Cabin {
        let pane = |f: f32, place: Place, left: bool| {
            self.part(f, place, &[]).surface.is_window() || also(f, place, left)
        };
        cabin(self.model, self.looks.tag, self.hull, self.wheels.inner_y(), fit, &pane)
    }

    /// The skin with the walls of its wheel houses.
    pub(crate) fn shell(&self, b: &mut MeshBuilder, detail: Detail) {
        // Farther away gaps between panels are finer than pixels.
        let cuts = if detail == Detail::Full { self.cuts() } else { Vec::new() };
        skin(b, self.hull, &self.grid(detail, &cuts), &|f, place| self.part(f, place, &cuts));
        if detail != Detail::Coarse {
            wheel_houses(b, self.hull, self.looks.under, &self.wheels.inner_y());
        }
    }

    /// Where doors end, as places along the side.
    fn cuts(&self) -> Vec<f32> {
        let mut cuts: Vec<f32> = self.doorways().into_iter().flatten().collect();
        if self.looks.tag == Tag::Truck && cuts.is_empty() {
            // Doors of cabs that stay closed.
            let (ahead, behind) = self.hull.style.windows;
            cuts.extend([ahead, self.hull.style.pillars.first().copied().unwrap_or(behind)]);
        }
        cuts.sort_by(f32::total_cmp);
        cuts.dedup_by(|a, b| *a - *b < 0.03);
        cuts
    }

    fn grid(&self, detail: Detail, cuts: &[f32]) -> Grid {
        let style = &self.hull.style;
        let mut places = vec![style.windows.0, style.windows.1];
        if detail == Detail::Full {
            // Gaps across bonnet and boot.
            places.extend([FRONT_GAP[0], FRONT_GAP[1]]);
        }
        if detail != Detail::Coarse {
            places.extend(style.pillars.iter().flat_map(|p| [p - PILLAR, p + PILLAR]));
        }
        Grid::new(self.hull, detail, &places, cuts)
    }

    /// What is where on the skin.
    fn part(&self, f: f32, place: Place, cuts: &[f32]) -> MeshPart {
        let (style, looks) = (&self.hull.style, &self.looks);
        let glazed = f > style.windows.0 && f < style.windows.1;
        let in_arch = || {
            let x = self.hull.x_of(f);
            self.hull.axles.iter().any(|axle| (x - axle).abs() < 1.003 * self.hull.arch)
        };
        let cut = cuts.iter().any(|c| (f - c).abs() < self.hull.share(LINE_M));
        let clad = self.model.car_body().is_some_and(|body| body.has_cladding);
        match place {
            Place::Under => looks.under,
            Place::Side(row) if row < 0.0 => looks.under,
            Place::Side(row) if row < 0.1 && (clad || !in_arch()) => looks.trim,
            Place::Side(row) if row > 0.1 && row < 1.0 && cut => looks.gap,
            Place::Side(row) if row > 0.3 && row < 0.7 && f > style.windows.0 && f < 0.96 && !in_arch() => {
                looks.sill
            }
            Place::Side(row) if row > 1.0 && row < 1.05 && glazed => looks.trim,
            Place::Side(row) if row > 1.05 && row < 1.91 && glazed => {
                if style.pillars.iter().any(|p| (f - p).abs() < PILLAR) { looks.trim } else { looks.window }
            }
            Place::Side(row)
                if row > 1.91 && !cuts.is_empty() && f > FRONT_GAP[1] && f < style.cowl.0 - 0.01 =>
            {
                looks.gap
            }
            Place::Top(s) if s.abs() < 0.94 => {
                let (roof, deck) = (style.roof, style.deck);
                // Sections of trains that are towed have no windscreen.
                let ahead = roof.0 - style.cowl.0 > LEAST_SCREEN && f > style.cowl.0 && f < roof.0;
                if ahead || style.rear_glass && f > roof.1 && f < deck.0 {
                    looks.window
                } else if !cuts.is_empty() && f > FRONT_GAP[0] && f < FRONT_GAP[1] {
                    looks.gap
                } else {
                    looks.paint
                }
            }
            Place::Nose(row) if row < 0.1 => looks.trim,
            Place::Tail(row) if row < 0.2 => looks.trim,
            _ => looks.paint,
        }
    }
}

/// Windscreens are longer than this, as a share of the car's length.
const LEAST_SCREEN: f32 = 0.008;
/// The gap before the bonnet, as places along the car.
const FRONT_GAP: [f32; 2] = [0.028, 0.0305];
/// Half width of the pillars between side windows.
const PILLAR: f32 = 0.009;
