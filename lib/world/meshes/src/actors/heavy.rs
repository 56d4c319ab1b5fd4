//! Lorries: a cab on a frame with a body behind it, all on wheels.

use crate::solids::{Detail, MeshBuilder};
use catalogue::{Load, Model, Rim, Shape};
use glam::Vec3;
use schema::Tag;

use crate::actors::car::{Car, Looks};
use crate::actors::hull::Hull;
use crate::actors::lorry::{CAB, Lorry, TYRE_M, cab_top_m, is_fire};
use crate::actors::pieces::ActorMesh;
use crate::actors::pod::rounded;
use crate::actors::wheel::Wheels;
use crate::actors::{brigade, load, tanks, trailer};

/// That of a fire engine, with room for a crew.
const CREW_CAB: Shape =
    Shape { cowl: (0.010, 0.485), roof: (0.13, 0.985), windows: (0.10, 0.90), pillars: &[0.42, 0.58], ..CAB };

/// How much narrower than the body a cab is on each side: mirrors fill that.
const NARROWER_M: f32 = 0.07;

/// A lorry: cab over the front axle, frame, and a box (or the body of a fire engine).
pub(crate) fn truck(model: &Model, load: Load, size: Vec3) -> ActorMesh {
    let half = 0.5 * size;
    let radius = model.wheel_radius_m as f32;
    let front = half.x - 1.35;
    let rear = front - model.wheelbase_m as f32;
    let axles = if model.axles == 3 { vec![front, rear + 0.65, rear - 0.65] } else { vec![front, rear] };
    let fire = is_fire(load);
    let cab_length = if fire { 2.75 } else { 1.35 + 1.12 * radius + 0.09 };
    let cab_back = half.x - cab_length;
    let cab_top = cab_top_m(load, size.z);
    let hull = Hull::new(
        if fire { CREW_CAB } else { CAB },
        [cab_back, half.x],
        [half.y - NARROWER_M, cab_top],
        &axles[..1],
        radius,
    );
    let wheels = Wheels {
        tag: Tag::Truck,
        axles: &axles,
        radius,
        width: TYRE_M,
        outer_y: half.y - NARROWER_M - 0.03,
        rim: Rim::Heavy,
    };
    let cab = Car { model, hull: &hull, looks: Looks::new(Tag::Truck, model), wheels };
    let floor_m = 2.0 * radius + 0.08;
    let lorry = Lorry { size, cab: &cab, axles: &axles, cab_back, cab_top, load, floor_m };
    let made = |detail: Detail| {
        let mut b = MeshBuilder::new();
        cab.shell(&mut b, detail);
        cab.nose(&mut b, detail);
        lorry.frame(&mut b, detail);
        carried(&lorry, &mut b, detail);
        lorry.rear_lamps(&mut b, detail);
        tall_mirrors(&mut b, &hull, &cab.looks, half, detail);
        let fit = b.fit(Vec3::new(-half.x, -half.y, CAB.clearance * cab_top), half.with_z(size.z));
        (cab.wheels.under(b, detail), fit)
    };
    ActorMesh::with_cabin(made, |fit| cab.cabin(fit, &|_, _, _| false))
}

/// Mirrors on arms before the corners of an upright windscreen, as far out as the vehicle is wide.
pub(crate) fn tall_mirrors(b: &mut MeshBuilder, hull: &Hull, looks: &Looks, half: Vec3, detail: Detail) {
    if detail == Detail::Coarse {
        return;
    }
    let z = 0.68 * hull.height;
    for side in [1.0, -1.0] {
        let at = Vec3::new(half.x - 0.13, side * (half.y - 0.09), z);
        rounded(b, looks.trim, at - Vec3::new(0.05, 0.09, 0.20), at + Vec3::new(0.05, 0.09, 0.20), 0.03);
        if detail == Detail::Full {
            let root = Vec3::new(half.x - 0.30, side * (hull.half_width - 0.08), z);
            for up in [0.16, -0.16] {
                b.bar(looks.trim, root + Vec3::Z * (up + 0.05), at + Vec3::Z * up, [0.018; 2], 5);
            }
        }
    }
}

/// What a lorry carries.
fn carried(lorry: &Lorry<'_>, b: &mut MeshBuilder, detail: Detail) {
    match lorry.load {
        Load::Goods { ribbed } => {
            load::goods(lorry, b, ribbed, detail);
            deflector(lorry, b, detail);
        }
        Load::Curtain => {
            load::curtain(lorry, b, detail);
            deflector(lorry, b, detail);
        }
        Load::Flatbed => {
            load::flatbed(lorry, b, detail);
            lorry.beacons(b, detail);
        }
        Load::Dropside => load::dropside(lorry, b, detail),
        Load::Tipper => load::tipper(lorry, b, detail),
        Load::Mixer => tanks::mixer(lorry, b, detail),
        Load::Tank => tanks::tanker(lorry, b, detail),
        Load::Refuse => tanks::refuse(lorry, b, detail),
        Load::Tow => tanks::tow(lorry, b, detail),
        Load::Sweeper => tanks::sweeper(lorry, b, detail),
        Load::Fire | Load::Ladder => brigade::fire_engine(lorry, b, detail),
        Load::Coupling => {
            trailer::coupling(lorry, b, detail);
            deflector(lorry, b, detail);
        }
        Load::Container => trailer::container(lorry, b, detail),
    }
}

/// What leads the air over the box.
fn deflector(l: &Lorry<'_>, b: &mut MeshBuilder, detail: Detail) {
    let (half, paint) = (l.half(), l.cab.looks.paint);
    let (low, high) = (l.cab_top - 0.06, l.size.z - 0.05);
    let steps = if detail == Detail::Full { 6 } else { 2 };
    let rings: Vec<Vec<Vec3>> = (0..=steps)
        .map(|i| {
            let t = i as f32 / steps as f32;
            // From the cab's back forwards, round over the top.
            let x = l.cab_back + 0.04 + t * (half.x - 0.55 - l.cab_back);
            let (top, wide) = (high + (low + 0.02 - high) * t * t, (0.84 - 0.14 * t) * half.y);
            [(-wide, low), (wide, low), (0.9 * wide, top), (-0.9 * wide, top)]
                .map(|(y, z)| Vec3::new(x, y, z))
                .to_vec()
        })
        .collect();
    b.loft(&rings, |_, _| paint, [l.cab.looks.trim, paint]);
}
