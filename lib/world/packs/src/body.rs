//! The figure of a rig: how long its bones are, and how what hangs on them is turned into their frames.

use catalogue::Age;
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use meshes::people::{Appearance, Bone, Figure, Measures, Side as Of};

use crate::error::Problem;
use crate::joints::{JointName, Side};
use crate::manifest::ModelManifest;
use crate::rig::Rig;
use crate::triangle_soup::Triangle;

/// A sole is what is no higher over the lowest of its foot, metres.
const SOLE_M: f64 = 0.015;
/// Joints are no farther from the hips, metres.
const REACH_M: f64 = 3.0;
/// Where feet bend whose rig does not say it, as a share of their length.
const BALL: f64 = 0.71;

/// A figure with the ways from the object's frame, as the file stands, to those of its bones.
pub(crate) struct Body {
    pub(crate) figure: Figure,
    pub(crate) bone_from_object: [DAffine3; Bone::BODY.len()],
}

fn bad(mark: JointName, problem: &'static str) -> Problem {
    Problem::JointPlace { bone: mark.name(), problem }
}

/// What is read of a foot.
struct Foot {
    /// From the object's frame to that of the foot, but for its height: at the ankle, toes ahead.
    foot_from_object: DAffine3,
    sole_z: f64,
    /// Ankle over the sole; ends of the sole and the hinge of the toes ahead of the ankle.
    ankle: f64,
    heel: f64,
    ball: f64,
    toe: f64,
}

impl Body {
    /// The figure whose joints a rig has; `triangles` are all of the finest level.
    ///
    /// # Errors
    /// Joints lie where nobody has them.
    pub(crate) fn new(rig: &Rig, sheet: &ModelManifest, triangles: &[Triangle]) -> Result<Self, Problem> {
        let at = |mark: JointName| rig.places_m.get(&mark).copied().ok_or(bad(mark, "it is not there"));
        let feet = [foot(rig, triangles, Side::Left)?, foot(rig, triangles, Side::Right)?];
        let ground = feet[0].sole_z.min(feet[1].sole_z);
        let mean = |of: &dyn Fn(Side) -> Result<f64, Problem>| -> Result<f64, Problem> {
            Ok(0.5 * (of(Side::Left)? + of(Side::Right)?))
        };
        let length = |from: fn(Side) -> JointName, to: fn(Side) -> JointName| {
            mean(&|side| {
                let length = (at(to(side))? - at(from(side))?).length();
                if length > 0.02 {
                    Ok(length)
                } else {
                    Err(bad(to(side), "it is where the joint above it is"))
                }
            })
        };
        let hips = 0.5 * (at(JointName::Thigh(Side::Left))? + at(JointName::Thigh(Side::Right))?);
        for (mark, place) in &rig.places_m {
            // Limbs of which one is a hundred times as long as the other cannot be bent.
            let is_near = (*place - hips).length() < REACH_M;
            if !is_near {
                return Err(bad(*mark, "it is far from the hips"));
            }
        }
        let (chest, neck) = (at(JointName::Chest)?, at(JointName::Head)?);
        let chest = DVec3::new(hips.x, hips.y, chest.z);
        let hip_y = 0.5 * (at(JointName::Thigh(Side::Left))?.y - at(JointName::Thigh(Side::Right))?.y);
        let upright = [
            (JointName::Thigh(Side::Left), hip_y > 0.01, "it is not left of the right one"),
            (JointName::Thigh(Side::Left), hips.z - ground > 0.15, "it is near the ground"),
            (JointName::Chest, chest.z - hips.z > 0.01, "it is not above the hips"),
            (JointName::Head, neck.z - chest.z > 0.05, "it is not above the chest"),
        ];
        if let Some((mark, _, problem)) = upright.iter().find(|(_, good, _)| !good) {
            return Err(bad(*mark, problem));
        }
        let shoulder = |side: Side| -> Result<DVec3, Problem> { Ok(at(JointName::UpperArm(side))? - chest) };
        let (left, right) = (shoulder(Side::Left)?, shoulder(Side::Right)?);
        if left.y <= right.y {
            return Err(bad(JointName::UpperArm(Side::Left), "it is not left of the right one"));
        }
        let shoulder = 0.5 * (left + right * DVec3::new(1.0, -1.0, 1.0));
        let of_feet = |of: fn(&Foot) -> f64| (0.5 * (of(&feet[0]) + of(&feet[1]))) as f32;
        let apart = 0.5 * (at(JointName::Foot(Side::Left))?.y - at(JointName::Foot(Side::Right))?.y);
        let measures = Measures {
            hip_z: (hips.z - ground) as f32,
            hip_y: hip_y as f32,
            thigh: length(JointName::Thigh, JointName::Shin)? as f32,
            shin: length(JointName::Shin, JointName::Foot)? as f32,
            ankle: of_feet(|foot| foot.ankle),
            heel: of_feet(|foot| foot.heel),
            ball: of_feet(|foot| foot.ball),
            toe: of_feet(|foot| foot.toe),
            // A model that stands with legs apart in the file does not walk so.
            stance_y: apart.clamp(0.5 * hip_y, 1.1 * hip_y) as f32,
            waist: (chest.z - hips.z) as f32,
            shoulder: shoulder.as_vec3(),
            neck: (neck - chest).as_vec3() * Vec3::new(1.0, 0.0, 1.0),
            upper_arm: length(JointName::UpperArm, JointName::Forearm)? as f32,
            forearm: length(JointName::Forearm, JointName::Hand)? as f32,
        };
        let age = Age::from_name(sheet.age);
        let figure = Figure::measured(Appearance::plain(age, sheet.gender == "female"), &measures);
        let mut body = Self { figure, bone_from_object: [DAffine3::IDENTITY; Bone::BODY.len()] };
        for (bone, joint) in [(Bone::Pelvis, hips), (Bone::Chest, chest), (Bone::Head, neck)] {
            body.set(bone, DAffine3::from_translation(-joint));
        }
        for (side, of, foot) in [(Side::Left, Of::Left, &feet[0]), (Side::Right, Of::Right, &feet[1])] {
            let [upper, lower] = of.arm();
            let [thigh, shin, sole, toes] = of.leg();
            for (bone, from, to) in [
                (upper, JointName::UpperArm(side), JointName::Forearm(side)),
                (lower, JointName::Forearm(side), JointName::Hand(side)),
                (thigh, JointName::Thigh(side), JointName::Shin(side)),
                (shin, JointName::Shin(side), JointName::Foot(side)),
            ] {
                body.set(bone, hung(at(from)?, at(to)?));
            }
            let raised = DVec3::Z * (-foot.sole_z - f64::from(figure.ankle));
            body.set(sole, DAffine3::from_translation(raised) * foot.foot_from_object);
            let hinge = DAffine3::from_translation(-figure.hinge().as_dvec3());
            body.set(toes, hinge * body.bone_from_object[sole as usize]);
        }
        Ok(body)
    }

    fn set(&mut self, bone: Bone, bone_from_object: DAffine3) {
        self.bone_from_object[bone as usize] = bone_from_object;
    }
}

/// A limb's frame: at its upper joint, hanging straight down from it, turned no more than that takes.
fn hung(from: DVec3, to: DVec3) -> DAffine3 {
    let along = (to - from).normalize_or(DVec3::NEG_Z);
    DAffine3::from_quat(DQuat::from_rotation_arc(along, DVec3::NEG_Z)) * DAffine3::from_translation(-from)
}

fn foot(rig: &Rig, triangles: &[Triangle], side: Side) -> Result<Foot, Problem> {
    let ankle_mark = JointName::Foot(side);
    let ankle = rig.places_m.get(&ankle_mark).copied().ok_or(bad(ankle_mark, "it is not there"))?;
    let bones = [JointName::Foot(side).bone(), JointName::Toes(side).bone()];
    let corners = || triangles.iter().flat_map(|t| t.corners_m.iter().zip(&t.bones));
    let points = || corners().filter(|(_, bone)| bones.contains(bone)).map(|(point, _)| *point);
    let sole_z = points().map(|p| p.z).fold(f64::INFINITY, f64::min);
    if !sole_z.is_finite() || ankle.z - sole_z < 0.005 {
        return Err(bad(ankle_mark, "no foot hangs on it, or it is not above the sole"));
    }
    let toes = rig.places_m.get(&JointName::Toes(side)).copied();
    // Ahead is where the toes' joint is, or what is farthest from the ankle.
    let flat = |p: DVec3| (p - ankle).truncate();
    let farthest = points()
        .map(flat)
        .fold(glam::DVec2::ZERO, |most, p| if p.length_squared() > most.length_squared() { p } else { most });
    let ahead = toes.map_or(farthest, flat).normalize_or(glam::DVec2::X);
    let turn =
        DMat3::from_cols(DVec3::new(ahead.x, -ahead.y, 0.0), DVec3::new(ahead.y, ahead.x, 0.0), DVec3::Z);
    let across = DVec3::new(ankle.x, ankle.y, 0.0);
    let foot_from_object = DAffine3::from_mat3(turn) * DAffine3::from_translation(-across);
    let sole = || points().filter(|p| p.z < sole_z + SOLE_M).map(|p| foot_from_object.transform_point3(p).x);
    let (heel, toe) = (sole().fold(f64::INFINITY, f64::min), sole().fold(f64::NEG_INFINITY, f64::max));
    let ball = toes.map_or(heel + BALL * (toe - heel), |toes| flat(toes).length());
    if !(heel < 0.0 && ball > 0.005 && toe > ball) {
        return Err(bad(ankle_mark, "heel, ankle, ball and toes of its foot do not follow one another"));
    }
    Ok(Foot { foot_from_object, sole_z, ankle: ankle.z - sole_z, heel, ball, toe })
}
