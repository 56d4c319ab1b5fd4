//! The proportions of cars, vans and pickups.

use crate::actors::hull::Style;

/// A nose whose bumper stands out below the bonnet.
const LOW_NOSE: &[(f32, f32)] =
    &[(0.20, 0.09), (0.34, 0.02), (0.50, 0.0), (0.66, 0.015), (0.80, 0.045), (0.92, 0.09), (1.0, 0.17)];
/// An upright one.
const HIGH_NOSE: &[(f32, f32)] =
    &[(0.20, 0.07), (0.34, 0.015), (0.45, 0.0), (0.75, 0.012), (0.88, 0.035), (0.95, 0.07), (1.0, 0.12)];
/// A tail with a boot's lid above the bumper.
const BOOT: &[(f32, f32)] =
    &[(0.20, 0.10), (0.34, 0.025), (0.46, 0.0), (0.60, 0.004), (0.66, 0.04), (0.92, 0.05), (1.0, 0.07)];
/// A straight one.
const HATCH: &[(f32, f32)] =
    &[(0.20, 0.08), (0.36, 0.015), (0.50, 0.0), (0.66, 0.006), (0.72, 0.035), (0.90, 0.045), (1.0, 0.055)];
/// That of a van.
const UPRIGHT: &[(f32, f32)] = &[(0.2, 0.03), (0.36, 0.0), (0.62, 0.004), (0.70, 0.025), (1.0, 0.03)];

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
    bow_m: [0.30, 0.22],
    glass_bow_m: [0.16, 0.12],
    tuck: 0.05,
    ends_width: [0.86, 0.88],
    nose_lean: LOW_NOSE,
    tail_lean: BOOT,
    belt: [0.90, 0.90],
    crown_m: 0.055,
    falls: [0.035, 0.028],
};

const HATCHBACK: Style = Style {
    bow_m: [0.28, 0.16],
    glass_bow_m: [0.15, 0.09],
    ends_width: [0.86, 0.90],
    tail_lean: HATCH,
    ..SEDAN
};

/// Cars that stand high.
const TALL: Style = Style {
    bow_m: [0.22, 0.14],
    glass_bow_m: [0.13, 0.08],
    ends_width: [0.90, 0.92],
    nose_lean: HIGH_NOSE,
    tuck: 0.045,
    crown_m: 0.05,
    ..HATCHBACK
};

const VAN: Style = Style {
    bow_m: [0.26, 0.04],
    glass_bow_m: [0.16, 0.03],
    ends_width: [0.88, 0.965],
    tail_lean: UPRIGHT,
    tuck: 0.025,
    belt: [0.88, 0.86],
    crown_m: 0.06,
    falls: [0.022, 0.006],
    ..TALL
};

/// The proportions of each model; long, as it is read as a table.
pub(super) fn style(name: &str) -> Style {
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
            roof: (0.40, 0.80),
            deck: (0.965, 0.63),
            tail_z: 0.57,
            windows: (0.28, 0.815),
            pillars: &[0.54],
            ..HATCHBACK
        },
        "car.sports" => Style {
            nose_z: 0.49,
            cowl: (0.30, 0.67),
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
            ..HATCHBACK
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
            ..TALL
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
            ..TALL
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
            ..HATCHBACK
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
            ..HATCHBACK
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
        "car.city" => Style {
            nose_z: 0.52,
            cowl: (0.21, 0.64),
            roof: (0.36, 0.84),
            deck: (0.975, 0.62),
            tail_z: 0.50,
            windows: (0.24, 0.88),
            pillars: &[0.53],
            roof_width: 0.75,
            ..HATCHBACK
        },
        "car.compact" => Style {
            nose_z: 0.52,
            cowl: (0.25, 0.66),
            roof: (0.41, 0.72),
            deck: (0.875, 0.69),
            tail_z: 0.67,
            windows: (0.28, 0.78),
            pillars: &[0.52],
            ..SEDAN
        },
        "car.liftback" => Style {
            nose_z: 0.47,
            cowl: (0.22, 0.64),
            roof: (0.43, 0.60),
            deck: (0.95, 0.68),
            tail_z: 0.655,
            windows: (0.26, 0.82),
            pillars: &[0.52],
            roof_width: 0.68,
            ..SEDAN
        },
        "car.crossover" => Style {
            nose_z: 0.53,
            cowl: (0.25, 0.65),
            roof: (0.40, 0.80),
            deck: (0.965, 0.64),
            tail_z: 0.56,
            windows: (0.28, 0.87),
            pillars: &[0.52, 0.74],
            roof_width: 0.73,
            clearance: 0.13,
            ..TALL
        },
        "car.offroad_large" => Style {
            nose_z: 0.56,
            cowl: (0.26, 0.645),
            roof: (0.37, 0.93),
            deck: (0.98, 0.62),
            tail_z: 0.50,
            windows: (0.29, 0.945),
            pillars: &[0.50, 0.72],
            roof_width: 0.80,
            clearance: 0.15,
            ..TALL
        },
        "car.mpv" => Style {
            nose_z: 0.50,
            cowl: (0.20, 0.61),
            roof: (0.38, 0.90),
            deck: (0.98, 0.60),
            tail_z: 0.48,
            windows: (0.23, 0.94),
            pillars: &[0.48, 0.71],
            roof_width: 0.78,
            ..TALL
        },
        "car.cab" => Style {
            roof: (0.42, 0.90),
            deck: (0.975, 0.60),
            tail_z: 0.52,
            windows: (0.30, 0.93),
            pillars: &[0.50, 0.72],
            roof_z: 0.925,
            cowl: (0.27, 0.625),
            nose_z: 0.47,
            ..HATCHBACK
        },
        "van.compact" => Style {
            nose_z: 0.47,
            cowl: (0.17, 0.575),
            roof: (0.33, 0.965),
            deck: (0.985, 0.55),
            tail_z: 0.45,
            windows: (0.20, 0.40),
            pillars: &[],
            roof_width: 0.85,
            clearance: 0.10,
            rear_glass: false,
            ..VAN
        },
        "van.minibus" => Style {
            nose_z: 0.34,
            cowl: (0.12, 0.45),
            roof: (0.25, 0.975),
            deck: (0.99, 0.46),
            tail_z: 0.40,
            windows: (0.15, 0.955),
            pillars: &[0.285, 0.42, 0.555, 0.69, 0.825],
            roof_width: 0.88,
            clearance: 0.09,
            ..VAN
        },
        "van.parcel" => Style {
            nose_z: 0.36,
            cowl: (0.075, 0.43),
            roof: (0.155, 0.985),
            deck: (0.993, 0.5),
            tail_z: 0.35,
            windows: (0.10, 0.255),
            pillars: &[],
            roof_width: 0.95,
            clearance: 0.11,
            rear_glass: false,
            crown_m: 0.03,
            ..VAN
        },
        "van.motorhome" => Style {
            nose_z: 0.31,
            cowl: (0.115, 0.41),
            roof: (0.245, 0.985),
            deck: (0.993, 0.5),
            tail_z: 0.35,
            windows: (0.135, 0.285),
            pillars: &[],
            roof_width: 0.94,
            clearance: 0.09,
            rear_glass: false,
            roof_z: 0.955,
            crown_m: 0.03,
            ..VAN
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
            ..VAN
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
            ..VAN
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
            ..VAN
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
            ..VAN
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
            ..TALL
        },
        _ => SEDAN,
    }
}
