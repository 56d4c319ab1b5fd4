//! Warning signs before hazards: boards on folding stands, which look along +x.

use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface, TriMesh};

use crate::solids::{MeshBuilder, circle};

const fn face(rgb: [f32; 3]) -> MeshPart {
    MeshPart::new(Tag::TrafficSign, Surface::Reflector, rgb)
}

const BLACK: MeshPart = MeshPart::new(Tag::TrafficSign, Surface::Plain, [0.02; 3]);
const RED: MeshPart = face([0.62, 0.02, 0.02]);
const GREY: MeshPart = MeshPart::new(Tag::TrafficSign, Surface::Metal, [0.30; 3]);
/// Height of the board's lower end as a share of the whole height.
const BOARD_FROM: f32 = 0.26;

/// A device on the board in its own coordinates: from -1 to 1, y to the left of the way it looks, z upward.
type Shape = &'static [[f32; 2]];

/// Two cars nose to nose, a crack between them.
const ACCIDENT: [Shape; 7] = [
    &[[-0.50, -0.52], [-0.06, -0.52], [-0.06, -0.34], [-0.50, -0.34]],
    &[[-0.44, -0.34], [-0.20, -0.34], [-0.26, -0.19], [-0.40, -0.19]],
    &[[0.06, -0.52], [0.50, -0.52], [0.50, -0.34], [0.06, -0.34]],
    &[[0.20, -0.34], [0.44, -0.34], [0.40, -0.19], [0.26, -0.19]],
    &[[-0.04, -0.24], [0.04, -0.24], [0.02, 0.06], [-0.02, 0.06]],
    &[[-0.16, -0.14], [-0.11, -0.20], [-0.05, -0.02], [-0.09, 0.0]],
    &[[0.11, -0.20], [0.16, -0.14], [0.09, 0.0], [0.05, -0.02]],
];
/// A worker who digs in a heap.
const DIGGING: [Shape; 6] = [
    &[[0.46, -0.48], [-0.50, -0.48], [-0.50, -0.55], [0.46, -0.55]],
    &[[-0.46, -0.48], [-0.10, -0.48], [-0.22, -0.20], [-0.34, -0.20]],
    &[[0.16, -0.48], [0.30, -0.48], [0.28, -0.05], [0.14, -0.05]],
    &[[0.14, -0.10], [0.32, -0.06], [0.18, 0.32], [0.02, 0.26]],
    &[[-0.20, -0.24], [-0.15, -0.28], [0.16, 0.10], [0.10, 0.14]],
    &[[-0.02, 0.36], [0.08, 0.30], [0.16, 0.42], [0.06, 0.50]],
];
/// An exclamation mark.
const DANGER: [Shape; 2] = [
    &[[-0.06, -0.30], [0.06, -0.30], [0.11, 0.22], [-0.11, 0.22]],
    &[[-0.075, -0.52], [0.075, -0.52], [0.075, -0.38], [-0.075, -0.38]],
];

/// A sign by its kind; none where it is no warning.
pub(crate) fn warning(kind: &str, size: Vec3) -> Option<TriMesh> {
    let half = 0.5 * size;
    let (low, middle) = (BOARD_FROM * size.z, 0.5 * (1.0 + BOARD_FROM) * size.z);
    let half_height = middle - low;
    // A triangle stands on its side; its device sits in its lower two thirds.
    let triangle: Shape = &[[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]];
    let diamond: Shape = &[[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];
    let (outline, inner_middle, rim, ground, device): (Shape, f32, MeshPart, MeshPart, &[Shape]) = match kind
    {
        "accident" => (triangle, -0.33, RED, face([0.85; 3]), &ACCIDENT),
        "danger" => (triangle, -0.33, RED, face([0.85; 3]), &DANGER),
        "road_works" => (diamond, 0.0, BLACK, face([0.85, 0.30, 0.02]), &DIGGING),
        _ => return None,
    };
    let at = |x: f32, [y, z]: [f32; 2]| Vec3::new(x, y * half.y, middle + z * half_height);
    let ring = |x: f32, share: f32| -> Vec<Vec3> {
        outline.iter().map(|[y, z]| at(x, [y * share, inner_middle + (z - inner_middle) * share])).collect()
    };
    let front = 0.10 * half.x;
    let mut b = MeshBuilder::new();
    let rings = [ring(front - 0.03, 1.0), ring(front - 0.004, 1.0), ring(front, 0.80)];
    b.loft(&rings, |k, _| if k == 0 { GREY } else { rim }, [GREY, ground]);
    for shape in device {
        let ring = |x: f32| -> Vec<Vec3> { shape.iter().map(|p| at(x, *p)).collect() };
        let counter_clockwise = shape
            .iter()
            .zip(shape.iter().cycle().skip(1))
            .map(|(a, b)| a[0] * b[1] - b[0] * a[1])
            .sum::<f32>()
            > 0.0;
        let mut rings = [ring(front - 0.002), ring(front + 0.006)];
        if !counter_clockwise {
            rings.iter_mut().for_each(|r| r.reverse());
        }
        b.loft(&rings, |_, _| BLACK, [BLACK; 2]);
    }
    if kind == "road_works" {
        let head: Vec<[f32; 2]> = circle(8).map(|(c, s)| [0.0 + 0.09 * c, 0.44 + 0.09 * s]).collect();
        let ring = |x: f32| -> Vec<Vec3> { head.iter().map(|p| at(x, *p)).collect() };
        b.loft(&[ring(front - 0.002), ring(front + 0.006)], |_, _| BLACK, [BLACK; 2]);
    }
    // Four legs: two before, two behind, and a bar across under the board.
    let hub = Vec3::new(front - 0.045, 0.0, low + 0.22 * half_height);
    for (x, y) in [(1.0, 0.55), (1.0, -0.55), (-1.0, 0.55), (-1.0, -0.55)] {
        let foot = Vec3::new(x * (half.x - 0.02), y * half.y, 0.0);
        let shoulder = hub + Vec3::new(0.0, 0.35 * y * half.y, 0.0);
        b.bar(GREY, foot, shoulder, [0.014; 2], 5);
    }
    b.cuboid(GREY, hub - Vec3::new(0.015, 0.4 * half.y, 0.02), hub + Vec3::new(0.012, 0.4 * half.y, 0.02));
    b.bar(GREY, hub, Vec3::new(hub.x, 0.0, middle + 0.5 * half_height), [0.014; 2], 5);
    b.fit(Vec3::new(-half.x, -half.y, 0.0), Vec3::new(half.x, half.y, size.z));
    Some(b.finish())
}
