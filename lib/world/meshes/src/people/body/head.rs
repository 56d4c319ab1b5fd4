//! Heads: neck, face, hair and what is worn.

use crate::solids::MeshBuilder;

use super::cranium::Head;
use super::face::face;
use super::hair::hair;
use super::hats::hat;
use super::shape::{Shaped, slice};
use super::skull::Skull;
use super::stuffs::Stuffs;
use crate::people::appearance::Hat;
use crate::people::figure::Figure;

pub(super) fn head(b: &mut MeshBuilder, f: &Figure, s: &Stuffs) {
    let h = f.stature;
    let broad = if f.look.woman { 0.88 } else { 1.0 } * (0.6 + 0.4 * f.look.girth());
    let neck = |z: f32, front: f32, back: f32, half: f32| {
        slice(z, front * h * broad, back * h * broad, half * h * broad)
    };
    let covered = f.look.hat == Hat::Scarf;
    let slices = [
        neck(-0.026 * h, 0.040, 0.046, 0.050),
        neck(-0.004 * h, 0.032, 0.038, 0.037),
        neck(0.5 * f.neck_m, 0.030, 0.036, 0.032),
        neck(f.neck_m + 0.10 * f.head, 0.032, 0.036, 0.033).at(0.002 * h, 0.0),
        neck(f.neck_m + 0.26 * f.head, 0.034, 0.036, 0.034).at(0.004 * h, 0.0),
    ];
    let part = if covered { s.extra } else { s.skin };
    Shaped { slices: &slices, sides: [12, 10], square: 1.0, between: 0, relief: &|_, _| 0.0 }
        .add(b, |_| part);
    let top = 1.0 + Figure::hat_share(&f.look) * h / f.head;
    let skull = Skull::new(&f.look);
    let mut it = Head { b, m: f.head, chin: f.neck_m, x: 0.010 * h, top, skull };
    face(&mut it, f, s);
    if !matches!(f.look.hat, Hat::Scarf | Hat::FullHelmet) {
        hair(&mut it, f, s);
    }
    hat(&mut it, f, s);
}
