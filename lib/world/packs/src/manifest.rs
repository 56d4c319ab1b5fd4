//! A model's page: what a glTF file does not say.

use std::collections::BTreeMap;

use catalogue::{Age, BaseType, Gender, Model, Special, models};
use schema::{Tag, lights};
use serde::Deserialize;

use crate::error::Problem;
use crate::joints::{JointName, MARKS};
use crate::limits;

/// The page as it is written. Keys that are not here are faults.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    name: String,
    base: String,
    size_m: Option<[f64; 3]>,
    height_m: Option<f64>,
    age: Option<String>,
    gender: Option<String>,
    file: Option<String>,
    weight: Option<f64>,
    #[serde(default)]
    special: String,
    #[serde(default = "one")]
    scale: f64,
    #[serde(default = "up")]
    up: String,
    #[serde(default = "forward")]
    forward: String,
    wheelbase_m: Option<f64>,
    wheel_radius_m: Option<f64>,
    #[serde(default = "crease")]
    crease_deg: f64,
    #[serde(default)]
    lod_from_m: Vec<f64>,
    #[serde(default)]
    materials: BTreeMap<String, String>,
    #[serde(default)]
    nodes: BTreeMap<String, WrittenNode>,
    joints: Option<BTreeMap<String, String>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenNode {
    tag: Option<String>,
    wheel: Option<String>,
    door: Option<String>,
    hinge_m: Option<[f64; 3]>,
    lamps: Option<Vec<String>>,
    lamp_rgb: Option<[f32; 3]>,
}

fn one() -> f64 {
    1.0
}
fn up() -> String {
    "+y".into()
}
fn forward() -> String {
    "+z".into()
}
fn crease() -> f64 {
    40.0
}

/// What is made of a material instead of what the file says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum MaterialOverride {
    Paint,
    Glass,
    Rubber,
    Metal,
    Cloth,
    Plain,
}

/// What a node is.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct NodeNote {
    pub(crate) tag: Option<Tag>,
    /// A wheel, and whether it is steered.
    pub(crate) wheel: Option<bool>,
    /// A door: its number.
    pub(crate) door: Option<usize>,
    /// The door's hinge, object frame before it is centred; else the node's origin.
    pub(crate) hinge_m: Option<[f64; 3]>,
    /// Bits of [`lights`].
    pub(crate) lamps: Option<u32>,
    /// A lamp's colour, linear RGB; else its material's.
    pub(crate) lamp_rgb: Option<[f32; 3]>,
}

/// A model's page, checked.
#[derive(Clone, Debug)]
pub(crate) struct ModelManifest {
    pub(crate) name: String,
    pub(crate) base: BaseType,
    /// Of people the height alone.
    pub(crate) size_m: Option<[f64; 3]>,
    pub(crate) height_m: f64,
    /// Words of [`Age::NAMES`] and [`Gender::NAMES`]; empty where it is nobody.
    pub(crate) age: &'static str,
    pub(crate) gender: &'static str,
    /// Which joint each node is.
    pub(crate) joints: BTreeMap<String, JointName>,
    pub(crate) file: Option<String>,
    pub(crate) weight: f64,
    pub(crate) special: Special,
    pub(crate) scale: f64,
    /// Rows: forward, left, up in the file's axes.
    pub(crate) axes: [[f64; 3]; 3],
    pub(crate) wheelbase_m: Option<f64>,
    pub(crate) wheel_radius_m: Option<f64>,
    pub(crate) crease_rad: f64,
    pub(crate) lod_from_m: Vec<f64>,
    pub(crate) materials: BTreeMap<String, MaterialOverride>,
    pub(crate) nodes: BTreeMap<String, NodeNote>,
}

const LAMPS: [(&str, u32); 10] = [
    ("position", lights::POSITION),
    ("low_beam", lights::LOW_BEAM),
    ("high_beam", lights::HIGH_BEAM),
    ("brake", lights::BRAKE),
    ("blink_right", lights::BLINK_RIGHT),
    ("blink_left", lights::BLINK_LEFT),
    ("reverse", lights::REVERSE),
    ("fog", lights::FOG),
    ("emergency", lights::EMERGENCY),
    ("emergency_other", lights::EMERGENCY_OTHER),
];
const STUFFS: [(&str, MaterialOverride); 6] = [
    ("paint", MaterialOverride::Paint),
    ("glass", MaterialOverride::Glass),
    ("rubber", MaterialOverride::Rubber),
    ("metal", MaterialOverride::Metal),
    ("cloth", MaterialOverride::Cloth),
    ("plain", MaterialOverride::Plain),
];
const DOORS: [&str; 4] = ["front_left", "front_right", "rear_left", "rear_right"];
const WHEELS: [(&str, bool); 2] = [("steered", true), ("fixed", false)];
const AXES: [(&str, [f64; 3]); 6] = [
    ("+x", [1.0, 0.0, 0.0]),
    ("-x", [-1.0, 0.0, 0.0]),
    ("+y", [0.0, 1.0, 0.0]),
    ("-y", [0.0, -1.0, 0.0]),
    ("+z", [0.0, 0.0, 1.0]),
    ("-z", [0.0, 0.0, -1.0]),
];

fn bad(key: impl Into<String>, problem: impl Into<String>) -> Problem {
    Problem::Key { key: key.into(), problem: problem.into() }
}

/// What a word means among some words.
fn word<T: Copy>(key: &str, written: &str, words: &[(&str, T)]) -> Result<T, Problem> {
    let found = words.iter().find(|(word, _)| *word == written).map(|(_, meaning)| *meaning);
    found.ok_or_else(|| {
        let all: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
        bad(key, format!("`{written}` is none of {}", all.join(", ")))
    })
}

fn between(key: &str, value: f64, low: f64, high: f64) -> Result<f64, Problem> {
    let good = value >= low && value <= high;
    good.then_some(value).ok_or_else(|| bad(key, format!("{value} is not between {low} and {high}")))
}

impl ModelManifest {
    pub(crate) fn parse(text: &str) -> Result<Self, Problem> {
        let written: Written = toml::from_str(text).map_err(|error| {
            let start = error.span().map_or(0, |span| span.start.min(text.len()));
            let line = text.as_bytes()[..start].iter().filter(|b| **b == b'\n').count() + 1;
            Problem::Toml { line, message: error.message().replace('\n', ", ") }
        })?;
        written.checked()
    }

    /// From where on each level of detail is shown, metres.
    pub(crate) fn levels_from_m(&self) -> impl Iterator<Item = f64> {
        std::iter::once(0.0).chain(self.lod_from_m.iter().copied())
    }

    /// The name's family must be that of its base type, so that no model is taken for scenery.
    fn check_name(name: &str, base: BaseType) -> Result<(), Problem> {
        let kind = name.split_once('.').and_then(|(family, kind)| (family == base.family()).then_some(kind));
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '-';
        if !kind.is_some_and(|kind| !kind.is_empty() && kind.len() < 60 && kind.chars().all(plain)) {
            let family = base.family();
            let problem =
                format!("`{name}` is not `{family}.` with small letters, digits, `_` and `-` after it");
            return Err(bad("name", problem));
        }
        Ok(())
    }
}

impl Written {
    fn checked(self) -> Result<ModelManifest, Problem> {
        let bases = BaseType::ALL.map(|base| (base.name(), base));
        let base = word("base", &self.base, &bases)?;
        ModelManifest::check_name(&self.name, base)?;
        let replaced = models::find(&self.name);
        let person = self.person(base, replaced)?;
        let special = [Special::None, Special::Emergency, Special::Taxi, Special::Electric]
            .into_iter()
            .find(|special| special.name() == self.special)
            .ok_or_else(|| {
                bad("special", format!("`{}` is none of emergency, taxi, electric", self.special))
            })?;
        for v in self.size_m.into_iter().flatten() {
            between("size_m", v, 0.02, 30.0)?;
        }
        let height_m = match (self.height_m, self.size_m) {
            (Some(height_m), None) if person.is_some() => between("height_m", height_m, 0.5, 2.5)?,
            (None, Some([.., height_m])) if person.is_none() => {
                between("size_m", height_m, 0.02, limits::HEIGHT_M)?
            }
            _ if person.is_some() => return Err(bad("height_m", "people have this, and no `size_m`")),
            _ => return Err(bad("size_m", "all but people have this, and no `height_m`")),
        };
        let weight = match (self.weight, replaced) {
            (Some(weight), _) => between("weight", weight, 0.0, 1000.0)?,
            (None, Some(model)) if base.is_driven() => catalogue::fleet::weight(model),
            (None, _) => 1.0,
        };
        let axes = axes(&self.up, &self.forward)?;
        let falling = |pair: &[f64]| pair[1] <= pair[0];
        if self.lod_from_m.iter().any(|from| !(*from >= 1.0 && *from <= 1e4))
            || self.lod_from_m.windows(2).any(falling)
            || self.lod_from_m.len() > limits::LEVELS
        {
            let problem = format!("must be up to {} rising distances from 1 to 10000 m", limits::LEVELS);
            return Err(bad("lod_from_m", problem));
        }
        if !base.is_driven() && (self.wheelbase_m.is_some() || self.wheel_radius_m.is_some()) {
            return Err(bad("wheelbase_m", format!("a {} has no wheels", base.name())));
        }
        let mut materials = BTreeMap::new();
        for (name, stuff) in &self.materials {
            materials.insert(name.clone(), word(&format!("materials.{name}"), stuff, &STUFFS)?);
        }
        let mut nodes = BTreeMap::new();
        for (name, node) in &self.nodes {
            nodes.insert(name.clone(), node.checked(&format!("nodes.{name}"), base)?);
        }
        let mut joints: BTreeMap<String, JointName> = BTreeMap::new();
        for (name, mark) in self.joints.iter().flatten() {
            let mark = word(&format!("joints.{name}"), mark, &MARKS)?;
            if let Some((other, _)) = joints.iter().find(|(_, known)| **known == mark) {
                return Err(bad(format!("joints.{name}"), format!("is `{}` as `{other}` is", mark.name())));
            }
            joints.insert(name.clone(), mark);
        }
        let length_m = self.size_m.map_or(f64::INFINITY, |[length_m, ..]| length_m);
        let wheelbase_m = self.wheelbase_m.map(|v| between("wheelbase_m", v, 0.3, 0.98 * length_m));
        let wheel_radius_m = self.wheel_radius_m.map(|v| between("wheel_radius_m", v, 0.05, 1.5));
        Ok(ModelManifest {
            name: self.name,
            base,
            size_m: self.size_m,
            height_m,
            age: person.map_or("", |[age, _]| age),
            gender: person.map_or("", |[_, gender]| gender),
            joints,
            file: self.file,
            weight,
            special,
            scale: between("scale", self.scale, 1e-6, 1e6)?,
            axes,
            wheelbase_m: wheelbase_m.transpose()?,
            wheel_radius_m: wheel_radius_m.transpose()?,
            crease_rad: between("crease_deg", self.crease_deg, 0.0, 180.0)?.to_radians(),
            lod_from_m: self.lod_from_m,
            materials,
            nodes,
        })
    }
}

impl Written {
    /// How old somebody is, and what; none of what is nobody.
    fn person(&self, base: BaseType, replaced: Option<&Model>) -> Result<Option<[&'static str; 2]>, Problem> {
        if base != BaseType::Pedestrian {
            let given = [
                ("age", self.age.is_some()),
                ("gender", self.gender.is_some()),
                ("joints", self.joints.is_some()),
            ];
            let wrong = given.iter().find(|(_, there)| *there);
            return wrong.map_or(Ok(None), |(key, _)| Err(bad(*key, format!("a {} has none", base.name()))));
        }
        if let Some(model) = replaced.filter(|model| model.special != Special::None) {
            return Err(bad(
                "name",
                format!("`{}` has its own work, chair, pram or dog, and cannot be replaced", model.name),
            ));
        }
        if !self.special.is_empty() {
            return Err(bad("special", "people of packs walk about, and have none"));
        }
        let of = |key: &str, written: &Option<String>, words: &[&'static str], usual: Option<&str>| {
            let all: Vec<(&str, &'static str)> = words.iter().map(|word| (*word, *word)).collect();
            match (written.as_deref(), usual) {
                (Some(written), _) | (None, Some(written)) => word(key, written, &all),
                (None, None) => Err(bad(key, format!("is missing: {}", words.join(", ")))),
            }
        };
        let age = of("age", &self.age, &Age::NAMES, Some("adult"))?;
        Ok(Some([age, of("gender", &self.gender, &Gender::NAMES, None)?]))
    }
}

impl WrittenNode {
    fn checked(&self, path: &str, base: BaseType) -> Result<NodeNote, Problem> {
        let key = |name: &str| format!("{path}.{name}");
        let moving = [("wheel", self.wheel.is_some()), ("door", self.door.is_some())];
        for (name, there) in moving {
            if there && !base.is_driven() {
                return Err(bad(key(name), format!("a {} has none", base.name())));
            }
        }
        if self.lamps.is_some() && base == BaseType::Pedestrian {
            return Err(bad(key("lamps"), "people have none"));
        }
        if self.wheel.is_some() && self.door.is_some() {
            return Err(bad(path, "is a wheel and a door"));
        }
        if self.hinge_m.is_some() && self.door.is_none() {
            return Err(bad(key("hinge_m"), "only doors have hinges"));
        }
        if self.lamp_rgb.is_some() && self.lamps.is_none() {
            return Err(bad(key("lamp_rgb"), "only lamps have a colour of their own"));
        }
        for v in self.hinge_m.iter().flatten() {
            between(&key("hinge_m"), *v, -30.0, 30.0)?;
        }
        for v in self.lamp_rgb.iter().flatten() {
            between(&key("lamp_rgb"), f64::from(*v), 0.0, 1.0)?;
        }
        let tags: Vec<(&str, Tag)> = base.tags().iter().map(|tag| (tag.name(), *tag)).collect();
        let doors: Vec<(&str, usize)> = DOORS.iter().enumerate().map(|(i, name)| (*name, i)).collect();
        let lamps = |names: &Vec<String>| -> Result<u32, Problem> {
            if names.is_empty() {
                return Err(bad(key("lamps"), "is empty"));
            }
            names.iter().try_fold(0, |bits, name| Ok(bits | word(&key("lamps"), name, &LAMPS)?))
        };
        let tag = self.tag.as_ref().map(|tag| word(&key("tag"), tag, &tags));
        let wheel = self.wheel.as_ref().map(|wheel| word(&key("wheel"), wheel, &WHEELS));
        let door = self.door.as_ref().map(|door| word(&key("door"), door, &doors));
        Ok(NodeNote {
            tag: tag.transpose()?,
            wheel: wheel.transpose()?,
            door: door.transpose()?,
            hinge_m: self.hinge_m,
            lamps: self.lamps.as_ref().map(lamps).transpose()?,
            lamp_rgb: self.lamp_rgb,
        })
    }
}

/// Forward, left and up in the file's axes.
fn axes(up: &str, forward: &str) -> Result<[[f64; 3]; 3], Problem> {
    let (u, f) = (word("up", up, &AXES)?, word("forward", forward, &AXES)?);
    if (0..3).any(|k| u[k] != 0.0 && f[k] != 0.0) {
        return Err(bad("forward", format!("`{forward}` and `up` `{up}` are along one axis")));
    }
    let left = [u[1] * f[2] - u[2] * f[1], u[2] * f[0] - u[0] * f[2], u[0] * f[1] - u[1] * f[0]];
    Ok([f, left, u])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn left_is_left_of_forward() {
        // glTF: +z is forward, +y up, so +x is to the left.
        assert_eq!(axes("+y", "+z").expect("axes")[1], [1.0, 0.0, 0.0]);
        assert_eq!(axes("+z", "+x").expect("axes")[1], [0.0, 1.0, 0.0]);
        assert_eq!(axes("+z", "-y").expect("axes")[1], [1.0, 0.0, 0.0]);
    }
}
