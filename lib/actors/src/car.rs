//! Cars, vans and pickups: a side profile lofted across the width.

use std::sync::Arc;

use glam::Vec3;
use schema::geometry::{Part, Surface, TriMesh};
use schema::models::{BaseType, Model};
use schema::{Tag, lights};

use crate::pieces::{ActorMesh, Joint, Piece};
use crate::wheel;
use solids::{Fit, MeshBuilder, chain_at};

/// The outline of a car seen from its left side. Lengths are shares of the whole length counted from the nose, heights
/// shares of the whole height.
#[derive(Clone, Copy)]
struct Style {
    nose_z: f32,
    /// Lower edge of the windscreen.
    cowl: (f32, f32),
    /// Where the roof begins and ends.
    roof: (f32, f32),
    /// Lower edge of the rear window.
    deck: (f32, f32),
    tail_z: f32,
    /// Side windows begin and end here.
    windows: (f32, f32),
    pillars: &'static [f32],
    /// Half width of the roof as a share of the half width.
    roof_width: f32,
    /// Gap under the body.
    clearance: f32,
    rear_glass: bool,
    /// Roof height where something stands on it.
    roof_z: f32,
}

const SEDAN: Style = Style {
    nose_z: 0.50,
    cowl: (0.27, 0.67),
    roof: (0.43, 0.69),
    deck: (0.85, 0.70),
    tail_z: 0.66,
    windows: (0.30, 0.77),
    pillars: &[0.52],
    roof_width: 0.70,
    clearance: 0.12,
    rear_glass: true,
    roof_z: 1.0,
};

/// The proportions of each model; long, as it is read as a table.
fn style(name: &str) -> Style {
    match name {
        "car.coupe" => Style {
            cowl: (0.31, 0.67),
            roof: (0.47, 0.62),
            deck: (0.88, 0.68),
            windows: (0.34, 0.74),
            pillars: &[0.62],
            ..SEDAN
        },
        "car.hatchback" => Style {
            cowl: (0.25, 0.65),
            roof: (0.40, 0.84),
            deck: (0.975, 0.63),
            tail_z: 0.55,
            windows: (0.28, 0.88),
            pillars: &[0.52, 0.73],
            ..SEDAN
        },
        "car.sports" => Style {
            nose_z: 0.42,
            cowl: (0.30, 0.64),
            roof: (0.47, 0.57),
            deck: (0.92, 0.70),
            tail_z: 0.66,
            windows: (0.33, 0.66),
            pillars: &[0.61],
            roof_width: 0.62,
            clearance: 0.10,
            ..SEDAN
        },
        "car.wagon" => Style {
            roof: (0.42, 0.90),
            deck: (0.975, 0.64),
            tail_z: 0.55,
            windows: (0.30, 0.93),
            pillars: &[0.50, 0.72],
            ..SEDAN
        },
        "car.suv" => Style {
            nose_z: 0.54,
            cowl: (0.25, 0.65),
            roof: (0.39, 0.88),
            deck: (0.975, 0.62),
            tail_z: 0.52,
            windows: (0.28, 0.92),
            pillars: &[0.51, 0.74],
            roof_width: 0.76,
            clearance: 0.14,
            ..SEDAN
        },
        "car.offroad" => Style {
            nose_z: 0.58,
            cowl: (0.30, 0.64),
            roof: (0.36, 0.97),
            deck: (0.985, 0.62),
            tail_z: 0.50,
            windows: (0.31, 0.96),
            pillars: &[0.53, 0.74],
            roof_width: 0.86,
            clearance: 0.17,
            ..SEDAN
        },
        "car.mini" => Style {
            nose_z: 0.55,
            cowl: (0.23, 0.65),
            roof: (0.37, 0.88),
            deck: (0.975, 0.62),
            tail_z: 0.50,
            windows: (0.26, 0.92),
            pillars: &[0.56],
            roof_width: 0.78,
            ..SEDAN
        },
        "car.micro" => Style {
            nose_z: 0.48,
            cowl: (0.14, 0.60),
            roof: (0.36, 0.86),
            deck: (0.975, 0.58),
            tail_z: 0.46,
            windows: (0.20, 0.84),
            pillars: &[0.64],
            roof_width: 0.76,
            ..SEDAN
        },
        "car.electric" => Style {
            nose_z: 0.46,
            cowl: (0.24, 0.65),
            roof: (0.45, 0.64),
            deck: (0.92, 0.69),
            tail_z: 0.66,
            windows: (0.28, 0.80),
            pillars: &[0.53],
            ..SEDAN
        },
        "car.limousine" => Style {
            cowl: (0.26, 0.66),
            roof: (0.40, 0.70),
            deck: (0.84, 0.69),
            windows: (0.29, 0.78),
            pillars: &[0.49, 0.70],
            ..SEDAN
        },
        "car.taxi" => Style { roof_z: 0.93, windows: (0.30, 0.77), ..SEDAN },
        "car.police" => Style { roof_z: 0.93, pillars: &[0.51, 0.70], ..SEDAN },
        "van.delivery" => Style {
            nose_z: 0.34,
            cowl: (0.13, 0.47),
            roof: (0.27, 0.975),
            deck: (0.99, 0.50),
            tail_z: 0.40,
            windows: (0.16, 0.33),
            pillars: &[],
            roof_width: 0.88,
            clearance: 0.09,
            rear_glass: false,
            ..SEDAN
        },
        "van.camper" => Style {
            nose_z: 0.44,
            cowl: (0.13, 0.54),
            roof: (0.28, 0.965),
            deck: (0.985, 0.54),
            tail_z: 0.45,
            windows: (0.17, 0.94),
            pillars: &[0.36, 0.62],
            roof_width: 0.84,
            clearance: 0.10,
            ..SEDAN
        },
        "van.passenger" => Style {
            nose_z: 0.46,
            cowl: (0.14, 0.55),
            roof: (0.29, 0.96),
            deck: (0.985, 0.55),
            tail_z: 0.45,
            windows: (0.18, 0.94),
            pillars: &[0.36, 0.55, 0.75],
            roof_width: 0.82,
            clearance: 0.10,
            ..SEDAN
        },
        "van.ambulance" => Style {
            nose_z: 0.33,
            cowl: (0.13, 0.44),
            roof: (0.30, 0.985),
            deck: (0.993, 0.5),
            tail_z: 0.35,
            windows: (0.16, 0.32),
            pillars: &[],
            roof_width: 0.92,
            clearance: 0.10,
            rear_glass: false,
            roof_z: 0.93,
        },
        "truck.pickup" => Style {
            nose_z: 0.56,
            cowl: (0.25, 0.64),
            roof: (0.37, 0.57),
            deck: (0.61, 0.62),
            tail_z: 0.62,
            windows: (0.28, 0.585),
            pillars: &[0.47],
            roof_width: 0.78,
            clearance: 0.18,
            ..SEDAN
        },
        _ => SEDAN,
    }
}

/// A car, van or pickup with its wheels and doors.
pub(crate) fn vehicle(model: &Model, size: Vec3) -> ActorMesh {
    let style = style(model.name);
    let tag = if model.base == BaseType::Car { Tag::Car } else { Tag::Truck };
    let (radius, wheelbase) = (model.wheel_radius_m as f32, model.wheelbase_m as f32);
    // Front overhang is a little shorter than the rear one.
    let front = 0.5 * size.x - 0.46 * (size.x - wheelbase);
    let axles = [front, front - wheelbase];
    let hull = Hull::new(style, size, axles, radius);
    let looks = Looks::new(tag, model);
    let mut b = MeshBuilder::new();
    body(&mut b, &hull, &looks);
    details(&mut b, &style, tag, size, model);
    let bottom = style.clearance * size.z;
    let fit =
        b.fit(Vec3::new(-0.5 * size.x, -0.5 * size.y, bottom), Vec3::new(0.5 * size.x, 0.5 * size.y, size.z));
    let mut pieces = vec![Piece { mesh: Arc::new(b.finish()), joint: Joint::Fixed }];
    pieces.extend(wheel::wheels(tag, &axles, radius, 0.125 * size.y, 0.5 * size.y - 0.02));
    pieces.extend(doors(model, &hull, &looks, &fit));
    ActorMesh::of(pieces)
}

/// What the skin of a car is made of.
struct Looks {
    paint: Part,
    glass: Part,
    under: Part,
    sill: Part,
    /// Lower band of the sides.
    livery: Part,
    trim: Part,
    seat: Part,
    gap: Part,
}

impl Looks {
    fn new(tag: Tag, model: &Model) -> Self {
        let paint = Part::new(tag, Surface::Paint, [0.5; 3]);
        Self {
            paint,
            glass: Part::new(tag, Surface::Glass, [0.04, 0.05, 0.06]),
            under: Part::new(tag, Surface::Plain, [0.04, 0.04, 0.04]),
            sill: Part::new(tag, Surface::Plain, [0.06, 0.06, 0.065]),
            livery: match model.name {
                "car.police" => Part::new(tag, Surface::Plain, [0.85, 0.85, 0.85]),
                "van.ambulance" => Part::new(tag, Surface::Plain, [0.75, 0.08, 0.05]),
                _ => paint,
            },
            trim: Part::new(tag, Surface::Plain, [0.07, 0.07, 0.075]),
            seat: Part::new(tag, Surface::Cloth, [0.09, 0.085, 0.08]),
            gap: Part::new(tag, Surface::Plain, [0.012, 0.012, 0.013]),
        }
    }
}

/// The skin of a car: its cross-section at any place along it.
struct Hull {
    style: Style,
    size: Vec3,
    axles: [f32; 2],
    radius: f32,
    arch: f32,
    top: [(f32, f32); 9],
    belt: [(f32, f32); 4],
    belt_width: [(f32, f32); 4],
    top_width: [(f32, f32); 6],
}

impl Hull {
    fn new(style: Style, size: Vec3, axles: [f32; 2], radius: f32) -> Self {
        let roof_z = style.roof_z;
        let (roof0, roof1) = style.roof;
        Self {
            style,
            size,
            axles,
            radius,
            arch: 1.14 * radius,
            top: [
                (0.0, style.nose_z * 0.94),
                (0.05, style.nose_z + 0.01),
                (0.6 * style.cowl.0, 0.35 * style.nose_z + 0.65 * style.cowl.1),
                style.cowl,
                (roof0, 0.97 * roof_z),
                (0.5 * (roof0 + roof1), roof_z),
                (roof1, 0.975 * roof_z),
                style.deck,
                (1.0, style.tail_z),
            ],
            belt: [
                (0.0, 0.80 * style.nose_z),
                (style.cowl.0, 0.95 * style.cowl.1),
                (style.deck.0, 0.97 * style.deck.1),
                (1.0, 0.86 * style.tail_z),
            ],
            belt_width: [(0.0, 0.93), (style.cowl.0, 0.95), (style.deck.0, 0.95), (1.0, 0.95)],
            top_width: [
                (0.0, 0.80),
                (style.cowl.0, 0.84),
                (roof0, style.roof_width),
                (roof1, style.roof_width),
                (style.deck.0, 0.84),
                (1.0, 0.84),
            ],
        }
    }

    /// x of a place given as a share of the length from the nose.
    fn x(&self, f: f32) -> f32 {
        0.5 * self.size.x - f * self.size.x
    }

    /// The left side there as `(y, z)` from the bottom to the roof: bottom, sill, shoulder, belt, top.
    fn section(&self, f: f32) -> [(f32, f32); 5] {
        const PLAN: [(f32, f32); 6] =
            [(0.0, 0.80), (0.05, 0.92), (0.14, 1.0), (0.88, 1.0), (0.96, 0.95), (1.0, 0.88)];
        let (height, x) = (self.size.z, self.x(f));
        let mut low = self.style.clearance * height;
        for axle in self.axles {
            let d = (x - axle).abs();
            if d <= 1.001 * self.arch {
                low = low.max(self.radius + (self.arch * self.arch - d * d).max(0.0).sqrt());
            }
        }
        let top_z = chain_at(&self.top, f) * height;
        let belt_z = (chain_at(&self.belt, f) * height).min(top_z - 0.015).max(low + 0.04);
        let top_z = top_z.max(belt_z + 0.015);
        let sill_z = low.max(0.21 * height);
        let shoulder_z = (0.82 * belt_z).max(sill_z + 0.01).min(belt_z - 0.01);
        let w = 0.5 * self.size.y * chain_at(&PLAN, f);
        [
            (0.88 * w, low),
            (0.985 * w, sill_z),
            (w, shoulder_z),
            (w * chain_at(&self.belt_width, f), belt_z),
            (w * chain_at(&self.top_width, f), top_z),
        ]
    }
}

fn body(b: &mut MeshBuilder, hull: &Hull, looks: &Looks) {
    let (style, length) = (&hull.style, hull.size.x);
    let (roof0, roof1) = style.roof;
    let mut stations = vec![0.006, 0.05, 0.12, 0.6 * style.cowl.0, 0.92, 0.96, 0.994];
    stations.extend([
        style.cowl.0,
        roof0,
        0.5 * (roof0 + roof1),
        roof1,
        style.deck.0,
        style.windows.0,
        style.windows.1,
    ]);
    for p in style.pillars {
        stations.extend([p - 0.009, p + 0.009]);
    }
    for axle in hull.axles {
        for share in [-1.03, -1.0, -0.85, -0.5, 0.0, 0.5, 0.85, 1.0, 1.03] {
            stations.push((0.5 * length - axle + share * hull.arch) / length);
        }
    }
    stations.retain(|f| (0.006..=0.994).contains(f));
    stations.sort_by(f32::total_cmp);
    stations.dedup_by(|a, b| *a - *b < 0.0015);
    // Rings run from the tail to the nose: along +x.
    stations.reverse();
    let rings: Vec<Vec<Vec3>> = stations
        .iter()
        .map(|f| {
            let (x, widths) = (hull.x(*f), hull.section(*f));
            let left = widths.iter().map(|(y, z)| Vec3::new(x, *y, *z));
            let right = widths.iter().rev().map(|(y, z)| Vec3::new(x, -*y, *z));
            // Counter-clockwise about +x: right bottom, left bottom, up the left side, down the right side.
            let mut ring: Vec<Vec3> = left.chain(right).collect();
            ring.rotate_right(1);
            ring
        })
        .collect();
    let Looks { paint, glass, under, sill, livery, .. } = *looks;
    b.loft(
        &rings,
        |k, j| {
            let f = 0.5 * (stations[k] + stations[k + 1]);
            let pillar = style.pillars.iter().any(|p| (f - p).abs() < 0.009);
            match j {
                0 => under,
                1 | 9 => sill,
                2 | 8 if f > style.windows.0 && f < 0.75 => livery,
                4 | 6 if f > style.windows.0 && f < style.windows.1 && !pillar => glass,
                5 if f > style.cowl.0 && f < roof0 => glass,
                5 if style.rear_glass && f > roof1 && f < style.deck.0 => glass,
                _ => paint,
            }
        },
        [paint, paint],
    );
}

/// Thickness of a door, and how far the way in stands out of the skin, metres.
const LEAF_M: f32 = 0.07;
const STANDS_OUT_M: f32 = 0.008;
/// Rings of a door's mesh.
const DOOR_RINGS: usize = 5;

/// The doors: the leaves, and what shows behind an open one in place of the closed skin.
fn doors(model: &Model, hull: &Hull, looks: &Looks, fit: &Fit) -> Vec<Piece> {
    let style = &hull.style;
    let behind = |at: f32| style.pillars.iter().copied().find(|p| *p > at + 0.05).unwrap_or(style.windows.1);
    let middle = behind(style.windows.0);
    let spans = [[style.windows.0, middle], [middle, behind(middle)]];
    let mut pieces = Vec::new();
    for (row, [ahead, behind]) in spans.into_iter().take(model.doors() / 2).enumerate() {
        for (side, left) in [(0, 1.0), (1, -1.0)] {
            let door = 2 * row + side;
            let [leaf, way_in] = door_meshes(hull, looks, fit, [ahead + 0.008, behind - 0.008], left);
            let (y, z) = hull.section(ahead)[2];
            let at = fit.apply(Vec3::new(hull.x(ahead + 0.008), left * (y - 0.02), 0.5 * z));
            pieces.push(Piece { mesh: Arc::new(moved(leaf, -at)), joint: Joint::Door { at, door } });
            pieces.push(Piece { mesh: Arc::new(way_in), joint: Joint::Doorway { door } });
        }
    }
    pieces
}

fn moved(mut mesh: TriMesh, by: Vec3) -> TriMesh {
    mesh.positions.iter_mut().for_each(|p| *p += by);
    mesh
}

/// A leaf and a way in over a span of the side, from the sill to the roof; `left` is 1 or -1.
fn door_meshes(hull: &Hull, looks: &Looks, fit: &Fit, span: [f32; 2], left: f32) -> [TriMesh; 2] {
    // From behind to the front: along +x. The rings run counter-clockwise about it.
    let ring = |k: usize, out_m: f32, in_m: f32| -> Vec<Vec3> {
        let f = span[1] + (span[0] - span[1]) * k as f32 / (DOOR_RINGS - 1) as f32;
        let section = hull.section(f);
        let side =
            |push: f32| section[1..].iter().map(move |(y, z)| Vec3::new(hull.x(f), left * (y + push), *z));
        let mut points: Vec<Vec3> = side(out_m).chain(side(-in_m).rev()).collect();
        if left < 0.0 {
            points.reverse();
        }
        points.into_iter().map(|p| fit.apply(p)).collect()
    };
    // Bands from below: to the shoulder, to the belt, to the roof, outside (0 to 2) and inside (6 to 4); mirrored for the
    // right side, where the order is reversed.
    let band = |j: usize| if left > 0.0 { j } else { (14 - j) % 8 };
    let mut leaf = MeshBuilder::new();
    let rings: Vec<Vec<Vec3>> = (0..DOOR_RINGS).map(|k| ring(k, 0.0, LEAF_M)).collect();
    let skin = |_: usize, j: usize| match band(j) {
        0 => looks.livery,
        1 => looks.paint,
        2 | 4 => looks.glass,
        _ => looks.trim,
    };
    leaf.loft(&rings, skin, [looks.trim; 2]);
    let mut way_in = MeshBuilder::new();
    let rings: Vec<Vec<Vec3>> = (0..DOOR_RINGS).map(|k| ring(k, STANDS_OUT_M, LEAF_M)).collect();
    // The seat is in the rear half, up to the belt.
    let inside = |k: usize, j: usize| if k < 2 && band(j) < 2 { looks.seat } else { looks.gap };
    way_in.loft(&rings, inside, [looks.gap; 2]);
    [leaf.finish(), way_in.finish()]
}

/// Lamps, plates, mirrors, grille and what stands on the roof.
fn details(b: &mut MeshBuilder, style: &Style, tag: Tag, size: Vec3, model: &Model) {
    let (half_l, half_w, height) = (0.5 * size.x, 0.5 * size.y, size.z);
    let lamp = |bits: u32, rgb: [f32; 3]| Part::new(tag, Surface::Lamp(bits), rgb);
    let dark = Part::new(tag, Surface::Plain, [0.03, 0.03, 0.035]);
    let nose = style.nose_z * height;
    let tail = style.tail_z * height;
    // `y` is given for the left side; the right one mirrors it.
    let mut pair = |part: Part, other: Part, x: [f32; 2], y: [f32; 2], z: [f32; 2]| {
        b.cuboid(part, Vec3::new(x[0], y[0] * half_w, z[0]), Vec3::new(x[1], y[1] * half_w, z[1]));
        b.cuboid(other, Vec3::new(x[0], -y[1] * half_w, z[0]), Vec3::new(x[1], -y[0] * half_w, z[1]));
    };
    let front = [half_l - 0.16, half_l];
    let rear = [-half_l, -half_l + 0.12];
    let head = lamp(lights::LOW_BEAM | lights::HIGH_BEAM | lights::POSITION, [0.85, 0.86, 0.88]);
    let (left, right) =
        (lamp(lights::BLINK_LEFT, [0.75, 0.35, 0.05]), lamp(lights::BLINK_RIGHT, [0.75, 0.35, 0.05]));
    pair(head, head, front, [0.44, 0.70], [0.74 * nose, 0.90 * nose]);
    pair(left, right, front, [0.70, 0.78], [0.74 * nose, 0.88 * nose]);
    let fog = lamp(lights::FOG, [0.8, 0.8, 0.75]);
    pair(fog, fog, front, [0.56, 0.68], [0.44 * nose, 0.52 * nose]);
    let red = lamp(lights::POSITION | lights::FOG, [0.55, 0.03, 0.03]);
    let brake = lamp(lights::BRAKE, [0.6, 0.02, 0.02]);
    let reverse = lamp(lights::REVERSE, [0.8, 0.8, 0.8]);
    let base = tail.min(0.75 * height);
    pair(red, red, rear, [0.66, 0.83], [0.80 * base, 0.90 * base]);
    pair(brake, brake, rear, [0.66, 0.83], [0.70 * base, 0.80 * base]);
    pair(left, right, rear, [0.56, 0.66], [0.80 * base, 0.90 * base]);
    pair(reverse, reverse, rear, [0.56, 0.66], [0.70 * base, 0.80 * base]);
    // Mirrors fill the room that the tumblehome leaves beside the belt line.
    let x = half_l - size.x * (style.cowl.0 + 0.045);
    pair(
        dark,
        dark,
        [x - 0.08, x + 0.04],
        [0.86, 1.0],
        [0.97 * style.cowl.1 * height, 0.97 * style.cowl.1 * height + 0.12],
    );

    let plate = Part::new(tag, Surface::Plain, [0.8, 0.8, 0.78]);
    b.cuboid(plate, Vec3::new(half_l - 0.1, -0.26, 0.46 * nose), Vec3::new(half_l, 0.26, 0.46 * nose + 0.11));
    b.cuboid(
        plate,
        Vec3::new(-half_l, -0.26, 0.55 * base),
        Vec3::new(-half_l + 0.1, 0.26, 0.55 * base + 0.11),
    );
    if model.special != "electric" {
        b.cuboid(
            dark,
            Vec3::new(half_l - 0.14, -0.4 * half_w, 0.66 * nose),
            Vec3::new(half_l - 0.006, 0.4 * half_w, 0.86 * nose),
        );
    }
    on_the_roof(b, style, tag, size, model);
}

/// What stands on the roof, or else the third brake lamp.
fn on_the_roof(b: &mut MeshBuilder, style: &Style, tag: Tag, size: Vec3, model: &Model) {
    let (half_l, half_w, height) = (0.5 * size.x, 0.5 * size.y, size.z);
    let lamp = |bits: u32, rgb: [f32; 3]| Part::new(tag, Surface::Lamp(bits), rgb);
    let roof_middle = half_l - 0.5 * (style.roof.0 + style.roof.1) * size.x;
    let roof_low = (style.roof_z - 0.03) * height;
    match model.special {
        "emergency" => {
            let bar_x = if tag == Tag::Truck { half_l - (style.roof.0 + 0.05) * size.x } else { roof_middle };
            for (y0, y1, bits, rgb) in [
                (0.02, 0.55, lights::EMERGENCY, [0.05, 0.1, 0.8]),
                (-0.55, -0.02, lights::EMERGENCY_OTHER, [0.8, 0.05, 0.05]),
            ] {
                b.cuboid(
                    lamp(bits, rgb),
                    Vec3::new(bar_x - 0.14, y0 * half_w, roof_low),
                    Vec3::new(bar_x + 0.14, y1 * half_w, height),
                );
            }
        }
        "taxi" => {
            let sign = lamp(lights::POSITION, [0.9, 0.75, 0.2]);
            b.cuboid(
                sign,
                Vec3::new(roof_middle - 0.08, -0.2, roof_low),
                Vec3::new(roof_middle + 0.08, 0.2, height),
            );
        }
        _ => {
            let third = Part::new(tag, Surface::Lamp(lights::BRAKE), [0.5, 0.02, 0.02]);
            let x = half_l - style.deck.0 * size.x;
            let z = style.deck.1 * height;
            if style.rear_glass && style.deck.0 < 0.95 {
                b.cuboid(third, Vec3::new(x - 0.03, -0.12, z - 0.02), Vec3::new(x + 0.05, 0.12, z + 0.03));
            }
        }
    }
}
