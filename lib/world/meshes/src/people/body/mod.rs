//! Bodies: a closed mesh for each bone, overlapping at the joints.

mod arms;
mod bags;
mod cranium;
mod dog;
mod face;
mod garments;
mod hair;
mod hats;
mod head;
pub(crate) mod legs;
mod pram;
mod shape;
mod shoes;
mod skull;
mod stuffs;
mod torso;

use crate::solids::{Detail, MeshBuilder};
use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface, TriMesh};

use self::shape::{level_at, lofted, part_in_two, slice};
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
                let mut mesh = b.finish();
                level_at(&mut mesh, &self.joints(bone));
                if bone == Bone::Pelvis && detail == Detail::Full && !self.look.hangs() {
                    let h = self.stature;
                    part_in_two(&mut mesh, self.hip_y, [-0.020 * h, 0.060 * h]);
                }
                made.push((bone, mesh));
            }
        };
        add(Bone::Pelvis, &|b| torso::pelvis(b, self, &stuffs));
        add(Bone::Chest, &|b| torso::chest(b, self, &stuffs));
        add(Bone::Head, &|b| head::head(b, self, &stuffs));
        for side in Side::BOTH {
            let [upper, lower] = side.arm();
            add(upper, &|b| arms::upper_arm(b, self, &stuffs, side));
            add(lower, &|b| arms::forearm(b, self, &stuffs, side));
            let [thigh, shin, foot, toes] = side.leg();
            add(thigh, &|b| legs::thigh(b, self, &stuffs, side));
            add(shin, &|b| legs::shin(b, self, &stuffs, side));
            add(foot, &|b| shoes::foot(b, self, &stuffs));
            add(toes, &|b| shoes::toes(b, self, &stuffs));
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

impl Figure {
    /// Heights at which a bone's surface goes on as another's, and how far from there, metres.
    fn joints(&self, bone: Bone) -> Vec<[f32; 2]> {
        use Bone::*;
        match bone {
            UpperArmLeft | UpperArmRight => vec![[-self.upper_arm, 0.16 * self.upper_arm]],
            ForearmLeft | ForearmRight => vec![[0.0, 0.16 * self.forearm]],
            ThighLeft | ThighRight => vec![[0.0, 0.18 * self.thigh], [-self.thigh, 0.16 * self.thigh]],
            ShinLeft | ShinRight => vec![[0.0, 0.16 * self.shin]],
            _ => Vec::new(),
        }
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
