//! Colours of vehicles.

/// Forty paints (sRGB), and how many of two hundred vehicles have each: close to what makers of paint publish
/// of the colours of new cars worldwide. A third are white, a fifth black, nearly as many grey; then silver,
/// blue, red, brown, green, others.
const SHADES: [([u8; 3], usize); 40] = [
    ([242, 243, 242], 30),
    ([234, 233, 226], 20),
    ([226, 226, 220], 10),
    ([216, 222, 226], 6),
    ([18, 18, 20], 20),
    ([26, 28, 34], 8),
    ([38, 38, 40], 8),
    ([36, 30, 28], 4),
    ([84, 87, 91], 10),
    ([108, 112, 116], 8),
    ([62, 65, 70], 7),
    ([130, 132, 132], 5),
    ([98, 100, 96], 4),
    ([142, 140, 134], 2),
    ([184, 187, 190], 7),
    ([166, 170, 174], 5),
    ([198, 199, 198], 4),
    ([176, 174, 166], 2),
    ([22, 42, 88], 5),
    ([36, 66, 122], 3),
    ([48, 96, 164], 3),
    ([70, 92, 116], 2),
    ([20, 58, 140], 2),
    ([122, 164, 196], 1),
    ([150, 18, 24], 4),
    ([190, 26, 30], 3),
    ([110, 20, 30], 2),
    ([206, 44, 36], 1),
    ([92, 66, 48], 2),
    ([190, 176, 148], 2),
    ([64, 48, 40], 1),
    ([150, 126, 96], 1),
    ([26, 62, 48], 1),
    ([72, 86, 66], 1),
    ([40, 88, 84], 1),
    ([128, 146, 104], 1),
    ([232, 188, 40], 1),
    ([196, 164, 92], 1),
    ([218, 98, 30], 1),
    ([76, 44, 92], 1),
];

/// Every common paint as often as vehicles have it.
pub const COMMON: &[[u8; 3]] = &PAINTS;

const PAINTS: [[u8; 3]; 200] = {
    let mut paints = [[0; 3]; 200];
    let (mut shade, mut of_shade, mut i) = (0, 0, 0);
    while i < paints.len() {
        paints[i] = SHADES[shade].0;
        of_shade += 1;
        if of_shade == SHADES[shade].1 {
            (shade, of_shade) = (shade + 1, 0);
        }
        i += 1;
    }
    paints
};

/// Frames of bicycles, motorcycles and scooters (sRGB): bright ones are as common as black and white.
pub(crate) const TWO_WHEELERS: &[[u8; 3]] = &[
    [22, 22, 24],
    [54, 57, 62],
    [150, 153, 156],
    [236, 237, 234],
    [178, 24, 28],
    [222, 62, 40],
    [236, 120, 24],
    [240, 190, 36],
    [182, 204, 44],
    [62, 142, 64],
    [24, 84, 66],
    [84, 176, 164],
    [44, 142, 206],
    [24, 72, 168],
    [26, 38, 84],
    [104, 60, 132],
    [206, 84, 138],
    [232, 214, 184],
    [128, 88, 56],
    [92, 20, 34],
];
/// Taxis.
pub(crate) const TAXIS: &[[u8; 3]] = &[[236, 184, 28], [238, 232, 208], [24, 24, 26]];
/// Vehicles that clean streets.
pub(crate) const MUNICIPAL: &[[u8; 3]] = &[[222, 96, 16], [236, 236, 230], [70, 132, 60]];

/// Seats, linear RGB.
pub(crate) const CLOTH: [f32; 3] = [0.075, 0.073, 0.07];
pub(crate) const LEATHER: [f32; 3] = [0.24, 0.19, 0.13];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forty_paints_are_as_common_as_they_say() {
        assert_eq!(SHADES.iter().map(|(_, of_200)| of_200).sum::<usize>(), PAINTS.len());
        for (i, (rgb, of_200)) in SHADES.iter().enumerate() {
            assert_eq!(PAINTS.iter().filter(|paint| *paint == rgb).count(), *of_200, "{rgb:?}");
            assert!(SHADES[..i].iter().all(|(other, _)| other != rgb));
        }
        // White, black, grey and silver are what eight of ten are.
        let grey = |[r, g, b]: &[u8; 3]| r.max(g).max(b) - r.min(g).min(b) <= 12;
        let share = PAINTS.iter().filter(|paint| grey(paint)).count() as f64 / PAINTS.len() as f64;
        assert!((0.75..0.85).contains(&share), "{share}");
    }
}
