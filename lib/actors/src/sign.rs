//! The boards of traffic signs on their poles. They have no letters: a device tells kinds apart.

use glam::Vec3;
use schema::Tag;
use schema::geometry::{Part, Surface, TriMesh};

use solids::{MeshBuilder, circle};

/// A polygon on the board, from -1 to 1: y to the left of the way it looks (to the right of who reads it), z upward.
type Shape = &'static [[f32; 2]];

const fn face(rgb: [f32; 3]) -> Part {
    Part::new(Tag::TrafficSign, Surface::Reflector, rgb)
}

const GREY: Part = Part::new(Tag::TrafficSign, Surface::Metal, [0.35; 3]);
const STEEL: Part = Part::new(Tag::Pole, Surface::Metal, [0.22, 0.23, 0.24]);
const WHITE: Part = face([0.85; 3]);
/// Ink lets nothing back.
const BLACK: Part = Part::new(Tag::TrafficSign, Surface::Plain, [0.03; 3]);
const RED: Part = face([0.65, 0.03, 0.03]);
const DEEP_RED: Part = face([0.60, 0.03, 0.03]);
const BLUE: Part = face([0.05, 0.12, 0.45]);

const SQUARE: Shape = &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
/// On its tip, and on its side.
const TIP: Shape = &[[0.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
const TRIANGLE: Shape = &[[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]];
/// A regular octagon with flat sides that fills the square.
const K: f32 = 0.414_213_57;
const OCTAGON: Shape =
    &[[-K, -1.0], [K, -1.0], [1.0, -K], [1.0, K], [K, 1.0], [-K, 1.0], [-1.0, K], [-1.0, -K]];

/// Bars in place of letters or digits.
const BAR: Shape = &[[-0.45, -0.14], [0.45, -0.14], [0.45, 0.14], [-0.45, 0.14]];
const WIDE_BAR: Shape = &[[-0.72, -0.16], [0.72, -0.16], [0.72, 0.16], [-0.72, 0.16]];
/// From upper left to lower right, as it is read.
const STROKE: Shape = &[[0.58, -0.44], [0.44, -0.58], [-0.58, 0.44], [-0.44, 0.58]];
/// An arrow to the right of who reads it.
const ARROW_SHAFT: Shape = &[[-0.75, -0.16], [0.15, -0.16], [0.15, 0.16], [-0.75, 0.16]];
const ARROW_HEAD: Shape = &[[0.15, -0.62], [0.80, 0.0], [0.15, 0.62]];
/// Somebody who walks: head, body, two legs.
const WALKER: [Shape; 4] = [
    &[[-0.09, 0.12], [0.09, 0.12], [0.09, 0.30], [-0.09, 0.30]],
    &[[-0.10, -0.30], [0.10, -0.30], [0.12, 0.08], [-0.12, 0.08]],
    &[[-0.28, -0.68], [-0.16, -0.68], [0.0, -0.30], [-0.10, -0.30]],
    &[[0.16, -0.68], [0.28, -0.68], [0.10, -0.30], [0.0, -0.30]],
];
const CROSSING_GROUND: Shape = &[[-0.82, -0.76], [0.82, -0.76], [0.0, 0.80]];
/// An exclamation mark, and a road that bends.
const MARK: [Shape; 2] = [
    &[[-0.06, -0.36], [0.06, -0.36], [0.11, 0.16], [-0.11, 0.16]],
    &[[-0.075, -0.62], [0.075, -0.62], [0.075, -0.48], [-0.075, -0.48]],
];
const BENDING: [Shape; 2] = [
    &[[-0.18, -0.68], [-0.02, -0.68], [0.02, -0.24], [-0.16, -0.18]],
    &[[-0.16, -0.18], [0.02, -0.24], [0.26, 0.04], [0.14, 0.18]],
];
/// The letter of car parks.
const LETTER: [Shape; 4] = [
    &[[-0.38, -0.62], [-0.18, -0.62], [-0.18, 0.62], [-0.38, 0.62]],
    &[[-0.18, 0.42], [0.30, 0.42], [0.30, 0.62], [-0.18, 0.62]],
    &[[-0.18, -0.10], [0.30, -0.10], [0.30, 0.10], [-0.18, 0.10]],
    &[[0.24, -0.02], [0.42, -0.02], [0.42, 0.54], [0.24, 0.54]],
];
/// Lines of text.
const LINES: [Shape; 4] = [
    &[[-0.72, 0.42], [0.72, 0.42], [0.72, 0.66], [-0.72, 0.66]],
    &[[-0.66, 0.06], [0.40, 0.06], [0.40, 0.22], [-0.66, 0.22]],
    &[[-0.66, -0.26], [0.56, -0.26], [0.56, -0.10], [-0.66, -0.10]],
    &[[-0.66, -0.58], [0.20, -0.58], [0.20, -0.42], [-0.66, -0.42]],
];
/// Three arrows round a middle.
const ROUND: [Shape; 3] = [
    &[[-0.58, 0.10], [-0.30, 0.10], [-0.10, 0.48], [-0.34, 0.58]],
    &[[0.34, 0.58], [0.10, 0.48], [0.30, 0.10], [0.58, 0.10]],
    &[[-0.30, -0.60], [0.30, -0.60], [0.30, -0.34], [-0.30, -0.34]],
];

/// How a board is painted.
struct Face {
    /// Outline; a disc where there is none.
    outline: Option<Shape>,
    rim: Part,
    inner: Part,
    /// What of the half width is inside the rim.
    inside: f32,
    device: &'static [Shape],
    ink: Part,
}

const fn painted(
    outline: Option<Shape>,
    rim: Part,
    inner: Part,
    device: &'static [Shape],
    ink: Part,
) -> Face {
    Face { outline, rim, inner, inside: 0.76, device, ink }
}

fn face_of(kind: &str) -> Face {
    match kind {
        "stop" => painted(Some(OCTAGON), WHITE, DEEP_RED, &[BAR], WHITE),
        "yield" => painted(Some(TIP), RED, WHITE, &[], BLACK),
        "speed" => painted(None, RED, WHITE, &[BAR], BLACK),
        "ban" => painted(None, RED, WHITE, &[STROKE], RED),
        "no_entry" => Face { inside: 0.94, ..painted(None, WHITE, RED, &[WIDE_BAR], WHITE) },
        "no_parking" => painted(None, RED, BLUE, &[STROKE], RED),
        "duty" => Face { inside: 0.94, ..painted(None, WHITE, BLUE, &ROUND, WHITE) },
        "warning" => painted(Some(TRIANGLE), RED, WHITE, &MARK, BLACK),
        "bend" => painted(Some(TRIANGLE), RED, WHITE, &BENDING, BLACK),
        "crossing" => Face { inside: 0.94, ..painted(Some(SQUARE), WHITE, BLUE, &WALKER, BLACK) },
        "parking" => Face { inside: 0.94, ..painted(Some(SQUARE), WHITE, BLUE, &LETTER, WHITE) },
        "one_way" => {
            Face { inside: 0.94, ..painted(Some(SQUARE), WHITE, BLUE, &[ARROW_SHAFT, ARROW_HEAD], WHITE) }
        }
        "info" => Face { inside: 0.92, ..painted(Some(SQUARE), RED, WHITE, &LINES, RED) },
        "name" => Face { inside: 0.95, ..painted(Some(SQUARE), WHITE, BLUE, &[WIDE_BAR], WHITE) },
        "guide" => Face { inside: 0.95, ..painted(Some(SQUARE), WHITE, BLUE, &LINES, WHITE) },
        _ => painted(Some(SQUARE), WHITE, BLUE, &[], BLACK),
    }
}

/// The board stands on z = 0 and looks along +x; its pole reaches `height_m` below.
pub(crate) fn sign(kind: &str, size: Vec3, height_m: f32) -> TriMesh {
    let half = 0.5 * size;
    let Face { outline, rim, inner, inside, device, ink } = face_of(kind);
    let outline: Vec<[f32; 2]> =
        outline.map_or_else(|| circle(16).map(|(y, z)| [y, z]).collect(), <[[f32; 2]]>::to_vec);
    // Triangles shrink about their own middle, the others about the square's.
    let middle = match kind {
        "yield" => 0.33,
        "warning" | "bend" => -0.33,
        _ => 0.0,
    };
    let at = |x: f32, [y, z]: [f32; 2]| Vec3::new(x, y * half.y, half.z + z * half.z);
    let ring = |x: f32, share: f32| -> Vec<Vec3> {
        outline.iter().map(|[y, z]| at(x, [y * share, middle + (z - middle) * share])).collect()
    };
    let (front, back) = (0.9 * half.x, -0.2 * half.x);
    let mut b = MeshBuilder::new();
    let rings = [ring(back, 1.0), ring(0.8 * front, 1.0), ring(0.9 * front, inside)];
    b.loft(&rings, |k, _| if k == 0 { GREY } else { rim }, [GREY, inner]);
    if kind == "crossing" {
        shape(&mut b, WHITE, CROSSING_GROUND, |p| at(0.4 * front, p), |p| at(0.95 * front, p));
    }
    for one in device {
        shape(&mut b, ink, one, |p| at(0.5 * front, p), |p| at(half.x, p));
    }
    let pole_x = -half.x + 0.004;
    b.bar(
        STEEL,
        Vec3::new(pole_x, 0.0, -height_m - 0.15),
        Vec3::new(pole_x, 0.0, 0.8 * size.z),
        [0.03; 2],
        8,
    );
    b.finish()
}

/// A polygon as a plate between two planes.
fn shape(
    b: &mut MeshBuilder,
    part: Part,
    polygon: Shape,
    rear: impl Fn([f32; 2]) -> Vec3,
    front: impl Fn([f32; 2]) -> Vec3,
) {
    let mut rings =
        [polygon.iter().map(|p| rear(*p)).collect(), polygon.iter().map(|p| front(*p)).collect::<Vec<_>>()];
    let turns: f32 =
        polygon.iter().zip(polygon.iter().cycle().skip(1)).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum();
    if turns < 0.0 {
        rings.iter_mut().for_each(|ring: &mut Vec<Vec3>| ring.reverse());
    }
    b.loft(&rings, |_, _| part, [part; 2]);
}
