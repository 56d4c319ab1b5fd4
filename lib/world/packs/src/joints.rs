//! Which joint of a rig is which of ours: by the page, or by names that programs and shops use.

use meshes::people::Bone;

/// What joints are looked for: those of our bones, and the wrists, where forearms end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum JointName {
    Pelvis,
    Chest,
    Head,
    UpperArm(Side),
    Forearm(Side),
    Hand(Side),
    Thigh(Side),
    Shin(Side),
    Foot(Side),
    Toes(Side),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Side {
    Left,
    Right,
}

use JointName::{Chest, Foot, Forearm, Hand, Head, Pelvis, Shin, Thigh, Toes, UpperArm};
use Side::{Left, Right};

/// All of them by the names that pages use; what ends on the way down stands before what hangs on it.
pub(crate) const MARKS: [(&str, JointName); 17] = [
    ("pelvis", Pelvis),
    ("chest", Chest),
    ("head", Head),
    ("upper_arm_left", UpperArm(Left)),
    ("upper_arm_right", UpperArm(Right)),
    ("forearm_left", Forearm(Left)),
    ("forearm_right", Forearm(Right)),
    ("hand_left", Hand(Left)),
    ("hand_right", Hand(Right)),
    ("thigh_left", Thigh(Left)),
    ("thigh_right", Thigh(Right)),
    ("shin_left", Shin(Left)),
    ("shin_right", Shin(Right)),
    ("foot_left", Foot(Left)),
    ("foot_right", Foot(Right)),
    ("toes_left", Toes(Left)),
    ("toes_right", Toes(Right)),
];

impl JointName {
    pub(crate) fn name(self) -> &'static str {
        MARKS.iter().find(|(_, mark)| *mark == self).map_or("", |(name, _)| *name)
    }

    /// The bone that moves what hangs on it; hands are part of forearms.
    pub(crate) fn bone(self) -> Bone {
        let of = |side: Side, [left, right]: [Bone; 2]| if side == Left { left } else { right };
        match self {
            Pelvis => Bone::Pelvis,
            Chest => Bone::Chest,
            Head => Bone::Head,
            UpperArm(side) => of(side, [Bone::UpperArmLeft, Bone::UpperArmRight]),
            Forearm(side) | Hand(side) => of(side, [Bone::ForearmLeft, Bone::ForearmRight]),
            Thigh(side) => of(side, [Bone::ThighLeft, Bone::ThighRight]),
            Shin(side) => of(side, [Bone::ShinLeft, Bone::ShinRight]),
            Foot(side) => of(side, [Bone::FootLeft, Bone::FootRight]),
            Toes(side) => of(side, [Bone::ToesLeft, Bone::ToesRight]),
        }
    }

    /// Whether a rig must have it: without toes, feet bend where others do.
    pub(crate) fn is_needed(self) -> bool {
        !matches!(self, Toes(_))
    }

    /// What its joint is called, without side and decoration; the first that a rig has is meant. Chests turn
    /// at the waist, so the lowest joint of the spine is theirs, and heads with their necks.
    fn words(self) -> &'static [&'static str] {
        match self {
            Pelvis => &["hips", "pelvis", "hip", "spine"],
            Chest => &["spine", "spine1", "spine2", "abdomen", "torso", "chest"],
            Head => &["neck", "neck1", "head"],
            UpperArm(_) => &["upperarm", "uparm", "arm"],
            Forearm(_) => &["forearm", "lowerarm", "lowarm", "elbow"],
            Hand(_) => &["hand", "wrist"],
            Thigh(_) => &["upleg", "thigh", "upperleg", "uplegjoint"],
            Shin(_) => &["shin", "calf", "lowerleg", "lowleg", "leg", "knee"],
            Foot(_) => &["foot", "ankle"],
            Toes(_) => &["toebase", "toes", "toe", "ball"],
        }
    }

    fn side(self) -> Option<Side> {
        match self {
            Pelvis | Chest | Head => None,
            UpperArm(side) | Forearm(side) | Hand(side) | Thigh(side) | Shin(side) | Foot(side)
            | Toes(side) => Some(side),
        }
    }
}

/// A joint's name without its side and what all names of its rig begin with: `mixamorig:LeftUpLeg`,
/// `thigh_l`, `Bip01 L Thigh`, `thigh.L`.
fn plain(name: &str) -> (String, Option<Side>) {
    let name = name.rsplit(':').next().unwrap_or(name);
    // Words end where a capital, a number or a sign begins.
    let mut words: Vec<String> = Vec::new();
    let mut before = ' ';
    for c in name.chars().take(100) {
        let begins = (c.is_uppercase() && !before.is_uppercase())
            || c.is_ascii_digit() != before.is_ascii_digit()
            || !before.is_alphanumeric();
        if c.is_alphanumeric() {
            if begins || words.is_empty() {
                words.push(String::new());
            }
            if let Some(word) = words.last_mut() {
                word.extend(c.to_lowercase());
            }
        }
        before = c;
    }
    let mut side = None;
    let mut kept = String::new();
    for (place, word) in words.iter().enumerate() {
        match word.as_str() {
            "left" | "l" if side.is_none() => side = Some(Left),
            "right" | "r" if side.is_none() => side = Some(Right),
            "mixamorig" | "bip" | "def" | "org" | "jnt" | "joint" | "bone" | "cc" | "base" | "j" => {}
            // The number of the rig, not of the joint.
            number if number.starts_with(|c: char| c.is_ascii_digit()) => {
                if !matches!(
                    place.checked_sub(1).and_then(|k| words.get(k)).map(String::as_str),
                    Some("mixamorig" | "bip")
                ) {
                    kept.push_str(number.trim_start_matches('0'));
                }
            }
            word => kept.push_str(word),
        }
    }
    // `ToeBase` lost its end.
    if kept == "toe" && words.iter().any(|word| word == "base") {
        kept = "toebase".into();
    }
    (kept, side)
}

/// The places in a list of names of those that are `mark`, as far as that is to be seen from the name.
/// `taken`: places with another meaning.
pub(crate) fn recognised(mark: JointName, names: &[&str], taken: &dyn Fn(usize) -> bool) -> Option<usize> {
    let known: Vec<(String, Option<Side>)> = names.iter().map(|name| plain(name)).collect();
    mark.words().iter().find_map(|word| {
        let is_it = |(place, (name, side)): &(usize, &(String, Option<Side>))| {
            name == word && *side == mark.side() && !taken(*place)
        };
        known.iter().enumerate().find(is_it).map(|(place, _)| place)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_common_rigs_are_known() {
        let mixamo = [
            "Hips",
            "Spine",
            "Spine1",
            "Neck",
            "Head",
            "LeftArm",
            "LeftForeArm",
            "LeftHand",
            "LeftUpLeg",
            "LeftLeg",
            "LeftFoot",
            "LeftToeBase",
        ];
        let unreal = [
            "pelvis",
            "spine_01",
            "spine_02",
            "neck_01",
            "head",
            "upperarm_l",
            "lowerarm_l",
            "hand_l",
            "thigh_l",
            "calf_l",
            "foot_l",
            "ball_l",
        ];
        let blender = [
            "spine",
            "spine.001",
            "spine.002",
            "neck",
            "head",
            "upper_arm.L",
            "forearm.L",
            "hand.L",
            "thigh.L",
            "shin.L",
            "foot.L",
            "toe.L",
        ];
        let biped = [
            "Bip01 Pelvis",
            "Bip01 Spine",
            "Bip01 Spine1",
            "Bip01 Neck",
            "Bip01 Head",
            "Bip01 L UpperArm",
            "Bip01 L Forearm",
            "Bip01 L Hand",
            "Bip01 L Thigh",
            "Bip01 L Calf",
            "Bip01 L Foot",
            "Bip01 L Toe0",
        ];
        let prefixed: Vec<String> = mixamo.iter().map(|name| format!("mixamorig:{name}")).collect();
        let joined: Vec<String> = mixamo.iter().map(|name| format!("mixamorig{name}")).collect();
        let all: [Vec<&str>; 6] = [
            mixamo.into(),
            unreal.into(),
            blender.into(),
            biped.into(),
            prefixed.iter().map(String::as_str).collect(),
            joined.iter().map(String::as_str).collect(),
        ];
        let marks = [
            Pelvis,
            Chest,
            Head,
            UpperArm(Left),
            Forearm(Left),
            Hand(Left),
            Thigh(Left),
            Shin(Left),
            Foot(Left),
        ];
        for names in all {
            let mut taken = Vec::new();
            for mark in marks {
                let found = recognised(mark, &names, &|place| taken.contains(&place));
                taken.push(found.unwrap_or_else(|| panic!("{mark:?} of {names:?}")));
            }
            assert_eq!(taken, [0, 1, 3, 5, 6, 7, 8, 9, 10], "{names:?}");
            assert_eq!(recognised(Thigh(Right), &names, &|_| false), None);
        }
    }
}
