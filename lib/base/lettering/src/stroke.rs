//! What a broad pen leaves along a line.

use crate::glyphs::Step;

/// A point: to the right and up, in heights of a capital.
pub type Point = [f64; 2];

/// Sines of 22.5, 45 and 67.5 degrees: an arc is that of a quarter of an ellipse in four pieces.
const SINES: [f64; 3] = [0.382_683_432_365_089_8, std::f64::consts::FRAC_1_SQRT_2, 0.923_879_532_511_286_7];
/// Corners reach no farther out than so many halves of the pen.
const MITRE: f64 = 1.6;

/// The outlines of a stroke; one that meets its own beginning is cut in two, so that none has a hole.
pub(crate) fn outlines(steps: &[Step], place: impl Fn(Point) -> Point, pen: f64) -> Vec<Vec<Point>> {
    let line: Vec<Point> = line_of(steps).into_iter().map(place).collect();
    let closed = line.len() > 3 && line.first() == line.last();
    if !closed {
        return vec![outline(&capped(line, pen), None, pen)];
    }
    let n = line.len() - 1;
    let at = |i: usize| line[i % n];
    let half = n / 2;
    let part = |from: usize, to: usize| {
        let points: Vec<Point> = (from..=to).map(at).collect();
        outline(&points, Some([at(from + n - 1), at(to + 1)]), pen)
    };
    vec![part(0, half), part(half, n)]
}

/// A line whose ends reach half a pen farther.
fn capped(mut line: Vec<Point>, pen: f64) -> Vec<Point> {
    let farther = |end: Point, before: Point| {
        let (dx, dy) = (end[0] - before[0], end[1] - before[1]);
        let share = 0.5 * pen / (dx * dx + dy * dy).sqrt().max(1e-9);
        [end[0] + dx * share, end[1] + dy * share]
    };
    if let [first, second, ..] = line[..] {
        line[0] = farther(first, second);
    }
    if let [.., second, last] = line[..] {
        let end = line.len() - 1;
        line[end] = farther(last, second);
    }
    line
}

/// The middle of a stroke.
fn line_of(steps: &[Step]) -> Vec<Point> {
    let mut line: Vec<Point> = Vec::with_capacity(4 * steps.len());
    for step in steps {
        let from = line.last().copied();
        let (to, along_x) = match (*step, from) {
            (Step::BowX(x, y), Some(_)) => ([x, y], true),
            (Step::BowY(x, y), Some(_)) => ([x, y], false),
            (Step::Line(x, y) | Step::BowX(x, y) | Step::BowY(x, y), _) => {
                line.push([x, y]);
                continue;
            }
        };
        let from = from.unwrap_or(to);
        for (sine, cosine) in SINES.into_iter().zip(SINES.into_iter().rev()) {
            // It leaves along one axis and arrives along the other.
            let (fast, slow) = (sine, 1.0 - cosine);
            let share = if along_x { [fast, slow] } else { [slow, fast] };
            line.push([0, 1].map(|k| from[k] + (to[k] - from[k]) * share[k]));
        }
        line.push(to);
    }
    line
}

/// A pen's outline along a line, counter-clockwise; `beyond` are the points before and after it, where the
/// line goes on.
fn outline(line: &[Point], beyond: Option<[Point; 2]>, pen: f64) -> Vec<Point> {
    let n = line.len();
    let before = |i: usize| if i > 0 { Some(line[i - 1]) } else { beyond.map(|ends| ends[0]) };
    let after = |i: usize| if i + 1 < n { Some(line[i + 1]) } else { beyond.map(|ends| ends[1]) };
    let normal = |a: Point, b: Point| {
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length = (dx * dx + dy * dy).sqrt().max(1e-9);
        [-dy / length, dx / length]
    };
    let offset = |i: usize| -> Point {
        let normals = [before(i).map(|p| normal(p, line[i])), after(i).map(|p| normal(line[i], p))];
        let [first, last] = match normals {
            [Some(a), Some(b)] => [a, b],
            [one, other] => [one.or(other).unwrap_or_default(); 2],
        };
        let sum = [first[0] + last[0], first[1] + last[1]];
        let square = sum[0] * sum[0] + sum[1] * sum[1];
        // Along the bisector, so far that both edges keep their distance.
        let reach = (2.0 / square.max(1e-9)).min(MITRE / square.sqrt().max(1e-9));
        sum.map(|v| 0.5 * pen * v * reach)
    };
    let side = |sign: f64| {
        (0..n).map(move |i| {
            let by = offset(i);
            [line[i][0] + sign * by[0], line[i][1] + sign * by[1]]
        })
    };
    // To the right of the line forwards, to its left back.
    let mut ring: Vec<Point> = side(-1.0).collect();
    let mut left: Vec<Point> = side(1.0).collect();
    left.reverse();
    ring.extend(left);
    ring
}
