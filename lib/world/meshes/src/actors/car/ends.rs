//! What is on the nose and the tail: lamps with their reflectors, grilles, plates.

use crate::solids::{Detail, MeshBuilder};
use catalogue::{BaseType, Model, Special};
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};
use schema::lights;

use super::Car;
use crate::actors::decal::{disc, patch};
use crate::actors::plates::SHEETING;

/// Four corners `(y, z)` on the left: inner below, outer below, outer above, inner above.
type Corners = [(f32, f32); 4];

/// An upright rectangle.
fn block(y: [f32; 2], z: [f32; 2]) -> Corners {
    [(y[0], z[0]), (y[1], z[0]), (y[1], z[1]), (y[0], z[1])]
}

const AMBER: [f32; 3] = [0.75, 0.35, 0.05];
/// How deep what lies on the skin reaches in, metres.
const DEEP_M: f32 = 0.09;

/// Where things are on a nose, as shares of the way from its lower edge to the bonnet.
struct Face {
    lamps: [f32; 2],
    /// How far lamps rise towards the sides.
    slant: f32,
    /// Openings below.
    intake: [f32; 2],
    grille: Option<[f32; 2]>,
    fog: f32,
    plate: f32,
}

impl Face {
    fn of(model: &Model) -> Self {
        let car = Self {
            lamps: [0.66, 0.83],
            slant: 0.06,
            intake: [0.13, 0.40],
            grille: (model.special != Special::Electric).then_some([0.54, 0.82]),
            fog: 0.27,
            plate: 0.30,
        };
        match model.base {
            BaseType::Van => Self { grille: Some([0.60, 0.84]), ..car },
            BaseType::Bus => Self {
                lamps: [0.34, 0.50],
                slant: 0.02,
                intake: [0.06, 0.20],
                grille: None,
                fog: 0.16,
                plate: 0.24,
            },
            BaseType::Truck if model.car_body().is_none() => Self {
                lamps: [0.24, 0.42],
                slant: 0.01,
                intake: [0.05, 0.20],
                grille: Some([0.50, 0.93]),
                fog: 0.12,
                plate: 0.22,
            },
            _ => car,
        }
    }
}

/// One end of a car: heights are metres, places aside shares of its half width there.
struct End<'a, 'b> {
    car: &'a Car<'a>,
    b: &'b mut MeshBuilder,
    nose: bool,
    detail: Detail,
}

impl End<'_, '_> {
    fn on(&self, y: f32, z: f32, out_m: f32) -> Vec3 {
        let hull = self.car.hull;
        hull.end(self.nose, y, z) + Vec3::X * if self.nose { out_m } else { -out_m }
    }

    /// Half width of the end, metres.
    fn wide(&self) -> f32 {
        let hull = self.car.hull;
        hull.end(self.nose, 1.0, 0.4 * hull.height).y
    }

    fn inward(&self) -> Vec3 {
        Vec3::X * if self.nose { -DEEP_M } else { DEEP_M }
    }

    /// A patch between four corners, `away` is 1 on the left and -1 on the right.
    fn patch(&mut self, part: MeshPart, corners: Corners, away: f32, out_m: f32, cells: [usize; 2]) {
        let [a, b, c, d] = corners;
        let cells = match self.detail {
            Detail::Full => cells,
            Detail::Half => [cells[0].min(2), 1],
            Detail::Coarse => [1, 1],
        };
        let mix = |p: (f32, f32), q: (f32, f32), t: f32| (p.0 + (q.0 - p.0) * t, p.1 + (q.1 - p.1) * t);
        let inward = self.inward();
        let mut mesh = std::mem::take(self.b);
        patch(&mut mesh, part, cells, inward, &|u, v| {
            let (y, z) = mix(mix(a, b, u), mix(d, c, u), v);
            self.on(away * y, z, out_m)
        });
        *self.b = mesh;
    }

    fn pair(&mut self, parts: [MeshPart; 2], corners: Corners, out_m: f32, cells: [usize; 2]) {
        self.patch(parts[0], corners, 1.0, out_m, cells);
        self.patch(parts[1], corners, -1.0, out_m, cells);
    }

    /// A patch from one side to the other.
    fn across(&mut self, part: MeshPart, half: [f32; 2], z: [f32; 2], out_m: f32, cells: [usize; 2]) {
        let corners = [(-half[0], z[0]), (half[0], z[0]), (half[1], z[1]), (-half[1], z[1])];
        self.patch(part, corners, 1.0, out_m, cells);
    }

    fn round(&mut self, part: MeshPart, (y, z): (f32, f32), radius_m: f32, out_m: f32) {
        let (inward, half_w) = (self.inward(), self.wide());
        let sides = match self.detail {
            Detail::Full => 12,
            Detail::Half => 6,
            Detail::Coarse => 4,
        };
        for away in [1.0, -1.0] {
            let mut mesh = std::mem::take(self.b);
            disc(&mut mesh, part, sides, inward, &|c, s| {
                self.on(away * (y + radius_m * c / half_w), z + radius_m * s, out_m)
            });
            *self.b = mesh;
        }
    }
}

impl Car<'_> {
    pub(super) fn white(&self) -> MeshPart {
        MeshPart::new(self.looks.tag, Surface::Plain, [0.78, 0.78, 0.76])
    }

    pub(crate) fn nose(&self, b: &mut MeshBuilder, detail: Detail) {
        let (hull, looks) = (self.hull, &self.looks);
        let full = detail == Detail::Full;
        let nose = hull.style.nose_z * hull.height;
        let low = hull.style.clearance * hull.height;
        // Heights between the lower edge and the bonnet.
        let at = |share: f32| low + share * (nose - low);
        let face = Face::of(self.model);
        let mut end = End { car: self, b, nose: true, detail };
        let head = looks.lamp(lights::LOW_BEAM | lights::HIGH_BEAM | lights::POSITION, [0.85, 0.86, 0.88]);
        let (left, right) = (looks.lamp(lights::BLINK_LEFT, AMBER), looks.lamp(lights::BLINK_RIGHT, AMBER));
        let fog = looks.lamp(lights::FOG, [0.8, 0.8, 0.75]);
        let (inner, outer) = (0.50, 0.97);
        let slant = |y: f32, top: bool| {
            let t = (y - inner) / (outer - inner);
            at(if top { face.lamps[1] + face.slant * t } else { face.lamps[0] + 1.15 * face.slant * t })
        };
        let piece = |y: [f32; 2], margin: f32| -> Corners {
            [
                (y[0], slant(y[0], false) + margin),
                (y[1], slant(y[1], false) + margin),
                (y[1], slant(y[1], true) - margin),
                (y[0], slant(y[0], true) - margin),
            ]
        };
        if detail == Detail::Coarse {
            end.pair([head; 2], piece([inner, 0.76], 0.0), 0.012, [1, 1]);
        } else {
            end.pair([looks.glass; 2], piece([inner - 0.01, outer], -0.008), 0.006, [6, 1]);
            let (radius, centre) = (0.42 * (slant(0.58, true) - slant(0.58, false)), |y| {
                0.5 * (slant(y, true) + slant(y, false))
            });
            for y in [0.565, 0.70] {
                if full {
                    end.round(looks.chrome, (y, centre(y)), radius, 0.011);
                }
                end.round(head, (y, centre(y)), 0.78 * radius, 0.016);
            }
        }
        end.pair([left, right], piece([0.80, 0.94], 0.012), 0.012, [2, 1]);
        // Lower grille with fog lamps, plate, upper grille.
        let intake = face.intake.map(at);
        if detail != Detail::Coarse {
            end.across(looks.under, [0.52, 0.58], intake, 0.006, [8, 1]);
            end.pair(
                [looks.under; 2],
                block([0.66, 0.86], [at(face.fog - 0.11), at(face.fog + 0.11)]),
                0.006,
                [3, 1],
            );
        }
        if full {
            for i in 1..4 {
                let z = intake[0] + 0.25 * i as f32 * (intake[1] - intake[0]);
                end.across(looks.trim, [0.51, 0.51], [z - 0.006, z + 0.006], 0.013, [8, 1]);
            }
        }
        end.round(fog, (0.74, at(face.fog)), 0.042, 0.014);
        if let Some(grille) = face.grille {
            let grille = grille.map(at);
            if full {
                let frame = [grille[0] - 0.012, grille[1] + 0.012];
                end.across(looks.chrome, [0.36, 0.44], frame, 0.006, [6, 1]);
            }
            end.across(looks.under, [0.345, 0.425], grille, 0.012, [6, 1]);
            if full {
                for i in 1..5 {
                    let z = grille[0] + (grille[1] - grille[0]) * 0.2 * i as f32;
                    end.across(looks.chrome, [0.36, 0.37], [z - 0.005, z + 0.005], 0.016, [6, 1]);
                }
            }
        }
        if full {
            let badge = (0.0, face.grille.map_or(at(0.76), |[z0, z1]| at(0.45 * z0 + 0.55 * z1)));
            end.round(looks.chrome, badge, 0.042, 0.020);
        }
        self.plate(&mut end, at(face.plate));
    }

    /// What sends light back: plates, reflectors.
    fn reflector(&self, rgb: [f32; 3]) -> MeshPart {
        MeshPart::new(self.looks.tag, Surface::Reflector, rgb)
    }

    fn plate(&self, end: &mut End<'_, '_>, z: f32) {
        let half = 0.26 / end.wide();
        if end.detail == Detail::Full {
            end.across(self.looks.trim, [half + 0.015; 2], [z - 0.012, z + 0.122], 0.014, [4, 1]);
        }
        end.across(self.reflector(SHEETING), [half; 2], [z, z + 0.11], 0.019, [4, 1]);
    }

    pub(crate) fn tail(&self, b: &mut MeshBuilder, detail: Detail) {
        let (hull, looks) = (self.hull, &self.looks);
        let full = detail == Detail::Full;
        let tail = hull.style.tail_z * hull.height;
        let low = hull.style.clearance * hull.height;
        let at = |share: f32| low + share * (tail - low);
        let upright = hull.style.roof.1 > 0.94;
        let mut end = End { car: self, b, nose: false, detail };
        let red = looks.lamp(lights::POSITION | lights::FOG, [0.55, 0.03, 0.03]);
        let brake = looks.lamp(lights::BRAKE, [0.6, 0.02, 0.02]);
        let reverse = looks.lamp(lights::REVERSE, [0.8, 0.8, 0.8]);
        let (left, right) = (looks.lamp(lights::BLINK_LEFT, AMBER), looks.lamp(lights::BLINK_RIGHT, AMBER));
        // Upright lamps of vans, wide ones of cars: rows from below, and how far in they reach.
        let (inner, rows) =
            if upright { (0.76, [0.52, 0.66, 0.80, 0.93]) } else { (0.56, [0.64, 0.72, 0.80, 0.90]) };
        let outer = 0.97;
        let split = inner + 0.30 * (outer - inner);
        if full {
            let housing = block([inner - 0.015, outer + 0.015], [at(rows[0]) - 0.01, at(rows[3]) + 0.01]);
            end.pair(
                [MeshPart::new(looks.tag, Surface::Glass, [0.05, 0.006, 0.006]); 2],
                housing,
                0.005,
                [4, 1],
            );
        }
        let z = rows.map(at);
        let gap = 0.004;
        end.pair([red; 2], block([split + 0.01, outer], [z[2] + gap, z[3]]), 0.012, [3, 1]);
        end.pair([brake; 2], block([split + 0.01, outer], [z[0], z[2] - gap]), 0.012, [3, 1]);
        end.pair([left, right], block([inner, split - 0.01], [z[1] + gap, z[3]]), 0.012, [2, 1]);
        end.pair([reverse; 2], block([inner, split - 0.01], [z[0], z[1] - gap]), 0.012, [2, 1]);
        let plate = at(if upright { 0.40 } else { 0.50 });
        if full {
            end.across(looks.gap, [0.92; 2], [at(0.455), at(0.462)], 0.004, [8, 1]);
            end.across(looks.chrome, [0.30; 2], [plate + 0.15, plate + 0.17], 0.012, [4, 1]);
            end.pair(
                [self.reflector([0.45, 0.02, 0.02]); 2],
                block([0.66, 0.84], [at(0.20), at(0.24)]),
                0.008,
                [2, 1],
            );
            if self.model.special != Special::Electric {
                end.round(looks.chrome, (0.60, at(0.07)), 0.04, 0.015);
                end.round(looks.gap, (0.60, at(0.07)), 0.032, 0.018);
            }
            if upright {
                // Where the doors meet.
                end.across(looks.gap, [0.006; 2], [at(0.30), at(1.0)], 0.006, [1, 4]);
            }
        }
        self.plate(&mut end, plate);
    }
}
