//! What is painted on the boards of signs.

use std::sync::Arc;

use crate::solids::circle;
use schema::SignFace;
use schema::mesh_textures::Image;

use crate::actors::canvas::Canvas;

/// A polygon on the board, from -1 to 1: to the reader's right, and upward.
type Shape = &'static [[f32; 2]];

const WHITE: [f32; 3] = [0.85; 3];
const BLACK: [f32; 3] = [0.03; 3];
const RED: [f32; 3] = [0.65, 0.03, 0.03];
const DEEP_RED: [f32; 3] = [0.60, 0.03, 0.03];
const BLUE: [f32; 3] = [0.05, 0.12, 0.45];

const SQUARE: Shape = &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
/// On its tip, and on its side.
const TIP: Shape = &[[0.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
const TRIANGLE: Shape = &[[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]];
/// A regular octagon with flat sides that fills the square.
const K: f32 = 0.414_213_57;
const OCTAGON: Shape =
    &[[-K, -1.0], [K, -1.0], [1.0, -K], [1.0, K], [K, 1.0], [-K, 1.0], [-1.0, K], [-1.0, -K]];

const WIDE_BAR: Shape = &[[-0.72, -0.16], [0.72, -0.16], [0.72, 0.16], [-0.72, 0.16]];
/// From upper left to lower right, as it is read.
const STROKE: Shape = &[[0.58, -0.44], [0.44, -0.58], [-0.58, 0.44], [-0.44, 0.58]];
/// The other way, with the one before a cross.
const COUNTER_STROKE: Shape = &[[-0.58, -0.44], [-0.44, -0.58], [0.58, 0.44], [0.44, 0.58]];
/// An arrow to the reader's right.
const ARROW: [Shape; 2] = [
    &[[-0.75, -0.16], [0.15, -0.16], [0.15, 0.16], [-0.75, 0.16]],
    &[[0.15, -0.62], [0.80, 0.0], [0.15, 0.62]],
];
/// One that turns to the left.
const LEFT_ARROW: [Shape; 3] = [
    &[[0.10, -0.55], [0.28, -0.55], [0.28, 0.22], [0.10, 0.22]],
    &[[-0.20, 0.04], [0.28, 0.04], [0.28, 0.22], [-0.20, 0.22]],
    &[[-0.20, -0.14], [-0.20, 0.40], [-0.55, 0.13]],
];
/// A pedestrian: body, two legs, an arm; the head is a disc.
const WALKER: [Shape; 4] = [
    &[[-0.10, -0.30], [0.10, -0.30], [0.12, 0.10], [-0.12, 0.10]],
    &[[-0.30, -0.70], [-0.17, -0.70], [0.04, -0.26], [-0.10, -0.26]],
    &[[0.17, -0.70], [0.30, -0.70], [0.10, -0.26], [-0.04, -0.26]],
    &[[0.08, 0.08], [0.14, 0.02], [0.34, -0.22], [0.27, -0.26], [0.04, -0.02]],
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
/// A road with humps.
const HUMPS: Shape = &[
    [-0.62, -0.66],
    [0.62, -0.66],
    [0.62, -0.54],
    [0.44, -0.52],
    [0.34, -0.34],
    [0.22, -0.34],
    [0.10, -0.52],
    [-0.10, -0.52],
    [-0.22, -0.34],
    [-0.34, -0.34],
    [-0.44, -0.52],
    [-0.62, -0.54],
];
/// An animal that leaps: body, neck with a head, legs.
const ANIMAL: [Shape; 4] = [
    &[[-0.36, -0.36], [0.20, -0.24], [0.24, -0.06], [-0.32, -0.16]],
    &[[0.10, -0.14], [0.24, -0.22], [0.34, 0.10], [0.48, 0.08], [0.46, 0.18], [0.30, 0.24]],
    &[[-0.38, -0.30], [-0.24, -0.30], [-0.34, -0.66], [-0.44, -0.66]],
    &[[0.08, -0.28], [0.22, -0.24], [0.42, -0.50], [0.34, -0.56]],
];
/// Two ways that become one.
const MERGE: [Shape; 2] = [
    &[[-0.20, -0.66], [-0.06, -0.66], [-0.06, 0.16], [-0.20, 0.16]],
    &[[0.22, -0.66], [0.36, -0.66], [0.36, -0.40], [-0.06, 0.0], [-0.06, -0.18], [0.22, -0.44]],
];
/// Three arrows round a middle.
const ROUND: [Shape; 6] = [
    &[[-0.52, -0.02], [-0.34, -0.10], [-0.18, 0.30], [-0.34, 0.36]],
    &[[-0.44, 0.30], [-0.06, 0.22], [-0.10, 0.60]],
    &[[0.10, 0.54], [0.02, 0.38], [0.34, 0.10], [0.46, 0.22]],
    &[[0.22, 0.04], [0.62, 0.26], [0.56, -0.18]],
    &[[0.42, -0.30], [0.30, -0.16], [-0.10, -0.30], [-0.10, -0.48]],
    &[[-0.06, -0.16], [-0.06, -0.62], [-0.42, -0.38]],
];

/// A blank board.
pub(crate) struct Board {
    /// Outline; a disc where there is none.
    pub(crate) outline: Option<Shape>,
    pub(crate) rim: [f32; 3],
    pub(crate) inner: [f32; 3],
    /// What of the half width is inside the rim.
    pub(crate) inside: f32,
    /// Height about which the rim shrinks: triangles do about their own middle.
    pub(crate) middle: f32,
}

const fn blank(outline: Option<Shape>, rim: [f32; 3], inner: [f32; 3], inside: f32) -> Board {
    Board { outline, rim, inner, inside, middle: 0.0 }
}

pub(crate) fn board(kind: &str) -> Board {
    match kind {
        "stop" => blank(Some(OCTAGON), WHITE, DEEP_RED, 0.92),
        "yield" => Board { middle: 0.33, ..blank(Some(TIP), RED, WHITE, 0.76) },
        "speed" | "ban" => blank(None, RED, WHITE, 0.76),
        "no_entry" => blank(None, WHITE, RED, 0.94),
        "no_parking" => blank(None, RED, BLUE, 0.76),
        "duty" => blank(None, WHITE, BLUE, 0.94),
        "warning" | "bend" => Board { middle: -0.33, ..blank(Some(TRIANGLE), RED, WHITE, 0.76) },
        "crossing" | "parking" | "one_way" => blank(Some(SQUARE), WHITE, BLUE, 0.94),
        "info" => blank(Some(SQUARE), RED, WHITE, 0.92),
        "name" | "guide" => blank(Some(SQUARE), WHITE, BLUE, 0.95),
        _ => blank(Some(SQUARE), WHITE, BLUE, 0.76),
    }
}

/// The picture of a board of some width and height.
pub(crate) fn picture(kind: &str, size_m: [f32; 2], said: SignFace) -> Arc<Image> {
    let Board { outline, rim, inner, inside, middle } = board(kind);
    let mut face = Face { canvas: Canvas::new(size_m, rim), half_m: size_m.map(|v| 0.5 * v) };
    let ring: Vec<[f32; 2]> =
        outline.map_or_else(|| circle(48).map(|(y, z)| [y, z]).collect(), <[[f32; 2]]>::to_vec);
    let ring: Vec<[f32; 2]> =
        ring.iter().map(|[x, y]| [x * inside, middle + (y - middle) * inside]).collect();
    face.shape(&ring, inner);
    match kind {
        "stop" => face.word("STOP", 0.0, 0.62, 1.62, WHITE),
        "speed" if said.number > 0 => face.word(&said.number.to_string(), 0.0, 0.78, 1.16, BLACK),
        "ban" => banned(&mut face, said.word()),
        "no_entry" => face.shape(WIDE_BAR, WHITE),
        "no_parking" => {
            face.shape(STROKE, RED);
            if said.word() == "no_standing" {
                face.shape(COUNTER_STROKE, RED);
            }
        }
        "duty" => face.shapes(&ROUND, WHITE),
        "warning" => warned(&mut face, said.word()),
        "bend" => face.shapes(&BENDING, BLACK),
        "crossing" => {
            face.shape(CROSSING_GROUND, WHITE);
            face.walker(0.0, -0.1, 0.8, BLACK);
        }
        "parking" => face.word("P", 0.0, 1.3, 1.2, WHITE),
        "one_way" => face.shapes(&ARROW, WHITE),
        "info" => face.lines(notice(said.word()), RED),
        "name" => face.word(&street(said.number), 0.0, 0.95, 1.7, WHITE),
        "guide" => {
            let [far, near] = [said.number / 97, said.number].map(place);
            let lines = [(near, 1 + said.number % 17), (far, 18 + said.number % 43)];
            for (line, up) in lines.iter().zip([0.4, -0.4]) {
                face.word_at(&line.0, [-0.26, up], 0.38, 1.2, WHITE);
                face.word_at(&line.1.to_string(), [0.66, up], 0.38, 0.4, WHITE);
            }
        }
        _ => {}
    }
    face.canvas.finish()
}

/// What is forbidden, under a stroke.
fn banned(face: &mut Face, word: &str) {
    match word {
        "no_left_turn" | "no_turns" => face.shapes(&LEFT_ARROW, BLACK),
        "no_pedestrians" => face.walker(0.0, 0.0, 0.75, BLACK),
        "no_bicycles" => face.bicycle(BLACK),
        _ => {}
    }
    face.shape(STROKE, RED);
}

/// What is warned of, in the lower two thirds of a triangle.
fn warned(face: &mut Face, word: &str) {
    match word {
        "school_zone" => {
            face.walker(-0.18, -0.28, 0.55, BLACK);
            face.walker(0.24, -0.34, 0.45, BLACK);
        }
        "frequent_pedestrian_cyclist" => face.walker(0.0, -0.24, 0.6, BLACK),
        "animal_crossing" => face.shapes(&ANIMAL, BLACK),
        "bump_ahead" | "uneven_road" => face.shape(HUMPS, BLACK),
        "lane_reduction" => face.shapes(&MERGE, BLACK),
        _ => face.shapes(&MARK, BLACK),
    }
}

/// The words on a notice.
fn notice(word: &str) -> &'static [&'static str] {
    match word {
        "bus_stop_no_parking" => &["BUS", "STOP", "NO PARKING"],
        "clean_up_after_pet" => &["CLEAN UP", "AFTER", "YOUR DOG"],
        "parking_time_limit" => &["2 HOUR", "PARKING", "8 TO 18"],
        "cross_only_at_crosswalk" => &["CROSS", "ONLY AT", "CROSSWALK"],
        "photo_enforced" => &["PHOTO", "ENFORCED"],
        "reserved_parking" => &["RESERVED", "PARKING"],
        "stop_for_pedestrians" => &["STOP", "FOR", "WALKERS"],
        "yield_to_pedestrians" => &["YIELD", "TO", "WALKERS"],
        "tow_away_zone" => &["TOW", "AWAY", "ZONE"],
        "passenger_cars_only" => &["CARS", "ONLY"],
        _ => &["NOTICE"],
    }
}

/// A made-up town.
fn place(number: u16) -> String {
    const FIRST: [&str; 16] = [
        "ALDER", "BRACK", "CORN", "DUN", "ELM", "FEN", "GREEN", "HOLM", "KING", "LANG", "MOOR", "NOR", "OAK",
        "RED", "STONE", "WEST",
    ];
    const LAST: [&str; 8] = ["FIELD", "WICK", "HAM", "FORD", "TON", "BURY", "STEAD", "MERE"];
    format!("{}{}", FIRST[usize::from(number % 16)], LAST[usize::from(number / 16 % 8)])
}

/// A made-up street.
fn street(number: u16) -> String {
    const FIRST: [&str; 12] = [
        "MILL", "CHURCH", "STATION", "GARDEN", "BRIDGE", "MARKET", "HARBOUR", "MEADOW", "CHAPEL", "FOREST",
        "QUARRY", "WELL",
    ];
    const LAST: [&str; 4] = ["STREET", "LANE", "ROAD", "ROW"];
    format!("{} {}", FIRST[usize::from(number % 12)], LAST[usize::from(number / 12 % 4)])
}

/// A board that is painted, in halves of its width and height from its middle.
struct Face {
    canvas: Canvas,
    half_m: [f32; 2],
}

impl Face {
    fn shape(&mut self, polygon: &[[f32; 2]], rgb: [f32; 3]) {
        let place = |p: &[f32; 2]| [0, 1].map(|k| (p[k] + 1.0) * self.half_m[k]);
        let polygon: Vec<[f32; 2]> = polygon.iter().map(place).collect();
        self.canvas.fill(&polygon, rgb);
    }

    fn shapes(&mut self, polygons: &[Shape], rgb: [f32; 3]) {
        polygons.iter().for_each(|polygon| self.shape(polygon, rgb));
    }

    /// A word in the middle of the board, as high and at most as wide as that.
    fn word(&mut self, text: &str, up: f32, height: f32, widest: f32, rgb: [f32; 3]) {
        self.word_at(text, [0.0, up], height, widest, rgb);
    }

    fn word_at(&mut self, text: &str, middle: [f32; 2], height: f32, widest: f32, rgb: [f32; 3]) {
        let [x, y] = [0, 1].map(|k| (middle[k] + 1.0) * self.half_m[k]);
        self.canvas.write(text, [x, y], height * self.half_m[1], widest * self.half_m[0], rgb);
    }

    /// Lines of equal height that fill a board.
    fn lines(&mut self, lines: &[&str], rgb: [f32; 3]) {
        let pitch = 1.6 / lines.len().max(2) as f32;
        for (k, line) in lines.iter().enumerate() {
            let up = (0.5 * (lines.len() as f32 - 1.0) - k as f32) * pitch;
            self.word(line, up, 0.62 * pitch, 1.6, rgb);
        }
    }

    /// A pedestrian of some size about a place.
    fn walker(&mut self, x: f32, y: f32, size: f32, rgb: [f32; 3]) {
        let place = |p: [f32; 2]| [x + p[0] * size, y + p[1] * size];
        for part in WALKER {
            let part: Vec<[f32; 2]> = part.iter().map(|p| place(*p)).collect();
            self.shape(&part, rgb);
        }
        let head: Vec<[f32; 2]> = circle(16).map(|(c, s)| place([0.11 * c, 0.27 + 0.11 * s])).collect();
        self.shape(&head, rgb);
    }

    /// Two wheels and a frame.
    fn bicycle(&mut self, rgb: [f32; 3]) {
        const FRAME: [Shape; 4] = [
            &[[-0.34, -0.20], [-0.28, -0.24], [-0.06, 0.20], [-0.12, 0.22]],
            &[[-0.10, 0.12], [0.24, 0.12], [0.24, 0.19], [-0.10, 0.19]],
            &[[0.32, -0.20], [0.38, -0.20], [0.24, 0.30], [0.17, 0.30]],
            &[[-0.20, 0.22], [0.02, 0.22], [0.02, 0.29], [-0.20, 0.29]],
        ];
        self.shapes(&FRAME, rgb);
        for x in [-0.32, 0.35] {
            // A ring, cut open so that it has no hole.
            let ring = |radius: f32| circle(24).map(move |(c, s)| [x + radius * c, -0.20 + radius * s]);
            let mut rim: Vec<[f32; 2]> = ring(0.25).chain(ring(0.25).take(1)).collect();
            let mut inner: Vec<[f32; 2]> = ring(0.18).chain(ring(0.18).take(1)).collect();
            inner.reverse();
            rim.extend(inner);
            self.shape(&rim, rgb);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share of a board that is nearer to its ink than to its ground.
    fn ink(kind: &str, said: SignFace) -> f32 {
        let Board { inner, .. } = board(kind);
        let image = picture(kind, [0.8, 0.8], said);
        let texels = &image.levels[0].texels;
        let ground = texels.iter().filter(|t| {
            let bytes = inner.map(|v| (255.0 * frames::math::f32::pow(v, 1.0 / 2.2)) as i32);
            (0..3).all(|k| (i32::from(t[k]) - bytes[k]).abs() < 30)
        });
        1.0 - ground.count() as f32 / texels.len() as f32
    }

    #[test]
    fn boards_say_what_their_signs_say() {
        let said = |sign_type: &str, number: u16| {
            let place = schema::SIGN_TYPES.iter().position(|word| *word == sign_type).expect("is known");
            SignFace { bottom_cm: 220, sign_type: place as u8, number }
        };
        // A digit more is more ink; a limit without a number is a ring alone.
        let limits = [0, 5, 50, 130].map(|number| ink("speed", said("speed_limit", number)));
        assert!(limits[0] + 0.02 < limits[1] && limits[1] + 0.02 < limits[2], "{limits:?}");
        assert!(limits[0] + 0.05 < limits[3], "three are narrower: {limits:?}");
        // All words of the vocabulary whose boards have a device: no two of a kind of board are the same.
        for (kind, words) in [
            ("info", &["bus_stop_no_parking", "clean_up_after_pet", "tow_away_zone", "photo_enforced"][..]),
            ("warning", &["school_zone", "animal_crossing", "bump_ahead", "lane_reduction", ""]),
            ("ban", &["no_left_turn", "no_bicycles", "no_pedestrians"]),
            ("no_parking", &["no_parking", "no_standing"]),
        ] {
            let pictures: Vec<_> =
                words.iter().map(|word| picture(kind, [0.6, 0.6], said(word, 0))).collect();
            for (i, a) in pictures.iter().enumerate() {
                assert!(pictures[i + 1..].iter().all(|b| a != b), "{kind}");
            }
        }
        assert_ne!(
            picture("name", [0.9, 0.22], said("street_name", 3)),
            picture("name", [0.9, 0.22], said("street_name", 4))
        );
    }

    #[test]
    fn made_up_names_can_be_written() {
        for number in 0..4096 {
            for text in [place(number), street(number)] {
                assert!(lettering::write(&text).is_some(), "{text}");
            }
        }
        let words = schema::SIGN_TYPES.iter().flat_map(|word| notice(word));
        assert!(words.into_iter().all(|word| lettering::write(word).is_some()));
    }
}
