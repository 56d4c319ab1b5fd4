//! Bodies: a closed mesh for each bone, overlapping at the joints.

mod dog;
mod head;
pub(crate) mod limbs;
mod pram;
mod shape;
mod stuffs;
mod torso;

use crate::solids::{Detail, MeshBuilder};
use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface, TriMesh};

use self::shape::{lofted, slice};
use self::stuffs::Stuffs;
use crate::people::appearance::Carried;
use crate::people::dog::{Dog, LEGS};
use crate::people::figure::{Bone, Figure, Side};
use crate::people::pram::{FRONT, REAR};

impl Figure {
    /// The meshes of the body in the frames of its bones; all parts carry the tag. At [`Detail::Coarse`],
    /// feet have no toes.
    #[must_use]
    pub fn meshes(&self, tag: Tag, detail: Detail) -> Vec<(Bone, TriMesh)> {
        let stuffs = Stuffs::new(&self.look, tag);
        let mut made: Vec<(Bone, TriMesh)> = Vec::new();
        let mut add = |bone: Bone, fill: &dyn Fn(&mut MeshBuilder)| {
            let mut b = MeshBuilder::at(detail);
            fill(&mut b);
            if !b.is_empty() {
                made.push((bone, b.finish()));
            }
        };
        add(Bone::Pelvis, &|b| torso::pelvis(b, self, &stuffs));
        add(Bone::Chest, &|b| torso::chest(b, self, &stuffs));
        add(Bone::Head, &|b| head::head(b, self, &stuffs));
        for side in Side::BOTH {
            let [upper, lower] = side.arm();
            add(upper, &|b| limbs::upper_arm(b, self, &stuffs));
            add(lower, &|b| limbs::forearm(b, self, &stuffs, side));
            let [thigh, shin, foot, toes] = side.leg();
            add(thigh, &|b| limbs::thigh(b, self, &stuffs, side));
            add(shin, &|b| limbs::shin(b, self, &stuffs));
            add(foot, &|b| limbs::foot(b, self, &stuffs));
            add(toes, &|b| limbs::toes(b, self, &stuffs));
        }
        match self.look.carried {
            Carried::Cane => add(Bone::Cane, &|b| cane(b, self, &stuffs)),
            Carried::Shovel => add(Bone::Shovel, &|b| shovel(b, self, &stuffs)),
            Carried::Pram => {
                add(Bone::Pram, &|b| pram::frame(b, self, &stuffs));
                add(Bone::PramFront, &|b| pram::wheels(b, &stuffs, &FRONT));
                add(Bone::PramRear, &|b| pram::wheels(b, &stuffs, &REAR));
            }
            Carried::Dog => {
                let dog = Dog::new(&self.look);
                add(Bone::LeadUpper, &|b| dog::lead(b, &stuffs, self.lead_m()));
                add(Bone::LeadLower, &|b| dog::lead(b, &stuffs, self.lead_m()));
                add(Bone::Dog, &|b| dog::trunk(b, &dog, &stuffs));
                add(Bone::DogHead, &|b| dog::head(b, &dog, &stuffs));
                add(Bone::DogTail, &|b| dog::tail(b, &dog, &stuffs));
                for leg in LEGS {
                    add(leg.upper, &|b| dog::upper_leg(b, &dog, &stuffs, leg.hind));
                    add(leg.lower, &|b| dog::lower_leg(b, &dog, &stuffs));
                }
            }
            _ => {}
        }
        made
    }
}

fn shovel(b: &mut MeshBuilder, figure: &Figure, stuffs: &Stuffs) {
    let wood = MeshPart::new(stuffs.tag, Surface::Wood, [0.30, 0.19, 0.09]);
    let steel = MeshPart::new(stuffs.tag, Surface::Metal, [0.16, 0.16, 0.17]);
    let length = figure.shovel_m();
    let at = |x: f32, z: f32| Vec3::new(x, 0.0, z - length);
    b.bar(wood, at(0.0, 0.22), at(0.0, length), [0.016; 2], 8);
    b.bar(wood, Vec3::new(0.0, -0.055, 0.0), Vec3::new(0.0, 0.055, 0.0), [0.015; 2], 8);
    b.bar(steel, at(0.0, 0.19), at(0.0, 0.34), [0.022, 0.017], 8);
    // The blade, narrower at its tip.
    let across = |z: f32, half: f32| slice(z - length, 0.005, 0.005, half);
    let blade = [across(0.0, 0.055), across(0.05, 0.095), across(0.24, 0.105), across(0.25, 0.10)];
    lofted(b, &blade, 8, 0.5, |_, _| steel);
}

fn cane(b: &mut MeshBuilder, figure: &Figure, stuffs: &Stuffs) {
    let wood = MeshPart::new(stuffs.tag, Surface::Wood, [0.10, 0.05, 0.025]);
    let length = figure.cane_m();
    b.bar(wood, Vec3::NEG_Z * length, Vec3::ZERO, [0.010, 0.011], 8);
    b.bar(wood, Vec3::new(-0.035, 0.0, 0.0), Vec3::new(0.075, 0.0, 0.008), [0.014, 0.012], 8);
}
