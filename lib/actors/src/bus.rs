//! Buses: a hull with rows of windows, doors on the right, a unit on the roof.

use glam::Vec3;
use schema::Tag;
use schema::geometry::{Part, Surface};
use schema::lights;
use schema::models::Model;
use solids::{Detail, MeshBuilder};

use crate::cabin::REAR_PANE;
use crate::car::{Car, Looks};
use crate::decal::patch;
use crate::heavy::{rounded, tall_mirrors};
use crate::hull::{Hull, Style};
use crate::pieces::ActorMesh;
use crate::skin::Place;
use crate::wheel::{Rim, Wheels};

/// A city bus with a low floor.
const CITY: Style = Style {
    nose_z: 0.35,
    cowl: (0.003, 0.36),
    roof: (0.030, 0.985),
    deck: (0.997, 0.37),
    tail_z: 0.36,
    windows: (0.035, 0.965),
    pillars: &[0.165, 0.30, 0.435, 0.57, 0.705, 0.84],
    roof_width: 0.93,
    clearance: 0.09,
    rear_glass: false,
    roof_z: 0.935,
    bow_m: [0.20, 0.10],
    glass_bow_m: [0.20, 0.09],
    tuck: 0.006,
    ends_width: [0.93, 0.96],
    nose_lean: &[(0.2, 0.03), (0.4, 0.0), (0.9, 0.01), (1.0, 0.02)],
    tail_lean: &[(0.2, 0.03), (0.4, 0.0), (1.0, 0.01)],
    belt: [0.985, 0.985],
    crown_m: 0.09,
    falls: [0.02, 0.01],
};

/// A bus.
pub(crate) fn bus(model: &Model, size: Vec3) -> ActorMesh {
    let half = 0.5 * size;
    let radius = model.wheel_radius_m as f32;
    let front = half.x - 2.75;
    let axles = [front, front - model.wheelbase_m as f32];
    let hull = Hull::new(CITY, [-half.x, half.x], [half.y, size.z], &axles, radius);
    let wheels =
        Wheels { tag: Tag::Bus, axles: &axles, radius, width: 0.32, outer_y: half.y - 0.07, rim: Rim::Heavy };
    let car = Car { model, hull: &hull, looks: Looks::new(Tag::Bus, model), wheels };
    let made = |detail: Detail| {
        let mut b = MeshBuilder::new();
        car.shell(&mut b, detail);
        car.nose(&mut b, detail);
        car.tail(&mut b, detail);
        doors(&mut b, &car, detail);
        glass_and_signs(&mut b, &car, detail);
        // What cools the air.
        let unit = Part::new(Tag::Bus, Surface::Plain, [0.72, 0.72, 0.71]);
        let (low, wide) = (CITY.roof_z * size.z - 0.10, 0.66 * half.y);
        rounded(
            &mut b,
            unit,
            Vec3::new(-0.30 * size.x, -wide, low),
            Vec3::new(0.02 * size.x, wide, size.z),
            0.07,
        );
        rounded(
            &mut b,
            unit,
            Vec3::new(0.10 * size.x, -wide, low),
            Vec3::new(0.34 * size.x, wide, size.z - 0.05),
            0.07,
        );
        tall_mirrors(&mut b, &hull, &car.looks, half, detail);
        let fit = b.fit(Vec3::new(-half.x, -half.y, CITY.clearance * size.z), half.with_z(size.z));
        (car.wheels.under(b, detail), fit)
    };
    // Panes that lie on the skin: those of the doors, and the rear window.
    let on_the_skin = |f: f32, place: Place, left: bool| match place {
        Place::Side(row) => {
            let x = hull.x_of(f);
            !left && (0.14..1.9).contains(&row) && door_places(&hull).iter().any(|at| (x - at).abs() < 0.6)
        }
        Place::Top(s) => {
            let down = (f - CITY.roof.1) / (CITY.deck.0 - CITY.roof.1);
            s.abs() < 0.84 && (REAR_PANE[0]..REAR_PANE[1]).contains(&down)
        }
        _ => false,
    };
    ActorMesh::with_cabin(made, |fit| car.cabin(fit, &on_the_skin))
}

/// x of the middles of doors.
fn door_places(hull: &Hull) -> [f32; 2] {
    [hull.x[1] - 1.25, 0.5 * (hull.axles[0] + hull.axles[1])]
}

/// Doors of two leaves in the right side: before the front axle, and between the axles.
fn doors(b: &mut MeshBuilder, car: &Car<'_>, detail: Detail) {
    let (hull, looks) = (car.hull, &car.looks);
    for x in door_places(hull) {
        let mut pane = |part: Part, x: [f32; 2], rows: [f32; 2], out_m: f32| {
            let cells = if detail == Detail::Full { [2, 8] } else { [1, 3] };
            patch(b, part, cells, Vec3::Y * 0.12, &|u, v| {
                let at = hull.section(hull.f_of(x[0] + (x[1] - x[0]) * u));
                hull.side(&at, rows[0] + (rows[1] - rows[0]) * v, false) - Vec3::Y * out_m
            });
        };
        pane(looks.trim, [x - 0.64, x + 0.64], [0.06, 1.90], 0.006);
        if detail != Detail::Coarse {
            for leaf in [x - 0.61, x + 0.02] {
                pane(looks.window, [leaf, leaf + 0.59], [0.14, 1.84], 0.012);
            }
        }
    }
}

/// The rear window and the boards that say where it goes.
fn glass_and_signs(b: &mut MeshBuilder, car: &Car<'_>, detail: Detail) {
    let (hull, looks) = (car.hull, &car.looks);
    let ((roof0, roof1), cowl, deck) = (hull.style.roof, hull.style.cowl.0, hull.style.deck.0);
    let mut pane = |part: Part, f: [f32; 2], s: f32, out: Vec3| {
        let cells = if detail == Detail::Full { [6, 3] } else { [2, 1] };
        patch(b, part, cells, -9.0 * out, &|u, v| {
            hull.top(&hull.section(f[0] + (f[1] - f[0]) * v), s * (1.0 - 2.0 * u)) + out
        });
    };
    let sign = looks.lamp(lights::POSITION, [0.75, 0.5, 0.1]);
    let screen = roof0 - cowl;
    pane(looks.gap, [roof0 - 0.28 * screen, roof0 - 0.02 * screen], 0.86, Vec3::X * 0.008);
    pane(sign, [roof0 - 0.23 * screen, roof0 - 0.08 * screen], 0.62, Vec3::X * 0.014);
    if detail != Detail::Coarse {
        let rear = deck - roof1;
        pane(looks.window, REAR_PANE.map(|share| roof1 + share * rear), 0.84, Vec3::X * -0.008);
    }
}
