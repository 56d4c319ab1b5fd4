//! What somebody looks like: age, sex, build, clothes, hair, what they carry. It follows from model and
//! variant alone.

use catalogue::{Age, BaseType, Model, Special};
use schema::geometry::Weave;

/// Looks that a model has; variants beyond begin again.
pub const APPEARANCES: u32 = 16;

/// How broad somebody is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum Build {
    Slim,
    Average,
    Heavy,
}

/// What is worn above.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum Top {
    Tee,
    Shirt,
    Jacket,
    Hoodie,
    Suit,
    Coat,
    Dress,
    HiVis,
    Uniform,
}

/// What is worn below.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum Bottom {
    Trousers,
    Shorts,
    Skirt,
}

/// Hair, as far as a hat leaves it to be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum Hair {
    Thin,
    Short,
    Curls,
    Bob,
    Long,
    Bun,
    Ponytail,
}

/// What is worn on the head.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum Hat {
    None,
    Cap,
    Beanie,
    SunHat,
    Scarf,
    Helmet,
    PeakedCap,
    /// Of a motorcyclist.
    FullHelmet,
    /// Of a cyclist.
    BicycleHelmet,
}

/// What somebody has with them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum Carried {
    Nothing,
    Backpack,
    ShoulderBag,
    Cane,
    /// A phone held in front.
    Phone,
    /// A pram, pushed with both hands.
    Pram,
    /// A dog on a lead, in the left hand.
    Dog,
    /// A shovel, in both hands.
    Shovel,
}

/// What somebody does while they stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum Stance {
    ArmsHang,
    /// A hand at the ear.
    Phones,
    /// A hand raised in talk.
    Talks,
    HandsOnHips,
}

/// Somebody's look. Colours are linear RGB.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub struct Appearance {
    pub age: Age,
    pub woman: bool,
    pub build: Build,
    pub top: Top,
    pub bottom: Bottom,
    pub hair: Hair,
    pub hat: Hat,
    pub carried: Carried,
    pub stance: Stance,
    /// Height compared to what is usual of the model.
    pub height: f32,
    pub top_weave: Weave,
    pub bottom_weave: Weave,
    pub top_rgb: [f32; 3],
    pub bottom_rgb: [f32; 3],
    pub skin_rgb: [f32; 3],
    pub hair_rgb: [f32; 3],
    pub shoe_rgb: [f32; 3],
    pub extra_rgb: [f32; 3],
    /// Height of a dog's back, metres.
    pub dog_m: f32,
}

const TOPS: [[f32; 3]; 14] = [
    [0.283, 0.063, 0.063],
    [0.044, 0.068, 0.160],
    [0.485, 0.473, 0.436],
    [0.026, 0.026, 0.029],
    [0.063, 0.136, 0.081],
    [0.387, 0.253, 0.100],
    [0.139, 0.145, 0.158],
    [0.187, 0.083, 0.163],
    [0.090, 0.194, 0.218],
    [0.610, 0.610, 0.598],
    [0.236, 0.187, 0.138],
    [0.109, 0.146, 0.256],
    [0.344, 0.191, 0.204],
    [0.091, 0.091, 0.073],
];
const BOTTOMS: [[f32; 3]; 9] = [
    [0.035, 0.055, 0.12],
    [0.02, 0.02, 0.022],
    [0.17, 0.13, 0.08],
    [0.09, 0.095, 0.10],
    [0.24, 0.21, 0.16],
    [0.07, 0.11, 0.20],
    [0.05, 0.045, 0.04],
    [0.10, 0.11, 0.07],
    [0.15, 0.20, 0.30],
];
const SKIN: [[f32; 3]; 7] = [
    [0.58, 0.36, 0.27],
    [0.49, 0.29, 0.20],
    [0.33, 0.18, 0.11],
    [0.16, 0.08, 0.05],
    [0.62, 0.41, 0.32],
    [0.42, 0.23, 0.15],
    [0.09, 0.045, 0.03],
];
const HAIR: [[f32; 3]; 6] = [
    [0.012, 0.010, 0.009],
    [0.05, 0.028, 0.016],
    [0.11, 0.06, 0.03],
    [0.30, 0.19, 0.08],
    [0.16, 0.05, 0.018],
    [0.025, 0.016, 0.011],
];
const GREY: [[f32; 3]; 3] = [[0.42, 0.41, 0.40], [0.62, 0.61, 0.59], [0.22, 0.21, 0.21]];
const SHOES: [[f32; 3]; 6] = [
    [0.02, 0.02, 0.02],
    [0.10, 0.055, 0.03],
    [0.55, 0.55, 0.54],
    [0.06, 0.06, 0.065],
    [0.20, 0.20, 0.22],
    [0.16, 0.05, 0.04],
];
const EXTRAS: [[f32; 3]; 7] = [
    [0.026, 0.026, 0.029],
    [0.202, 0.061, 0.061],
    [0.062, 0.092, 0.178],
    [0.153, 0.104, 0.067],
    [0.076, 0.125, 0.088],
    [0.320, 0.277, 0.210],
    [0.337, 0.233, 0.092],
];
/// High-visibility clothing: orange or yellow.
const VESTS: [[f32; 3]; 2] = [[0.80, 0.20, 0.015], [0.58, 0.70, 0.03]];
const HELMETS: [[f32; 3]; 3] = [[0.80, 0.58, 0.03], [0.80, 0.80, 0.78], [0.78, 0.22, 0.02]];
/// Coats of dogs.
const COATS: [[f32; 3]; 6] = [
    [0.016, 0.014, 0.013],
    [0.36, 0.22, 0.09],
    [0.62, 0.58, 0.50],
    [0.13, 0.065, 0.03],
    [0.24, 0.23, 0.22],
    [0.42, 0.30, 0.16],
];
const UNIFORM: [f32; 3] = [0.012, 0.018, 0.05];

/// A word that differs between questions asked of the same look (the finaliser of SplitMix64, by Steele, Lea
/// and Flood).
fn word(model: &Model, variant: u32, question: u64) -> usize {
    let name = model.name.bytes().fold(0u64, |sum, byte| sum.wrapping_mul(257).wrapping_add(u64::from(byte)));
    let seed = name ^ u64::from(variant % APPEARANCES) << 40 ^ question << 52;
    let mut z = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ z >> 31) >> 33) as usize
}

impl Appearance {
    /// The appearance of a walker, a rider or a person in a wheelchair, by model and variant.
    #[must_use]
    pub fn new(model: &Model, variant: u32) -> Self {
        let variant = variant % APPEARANCES;
        let ask = |question: u64| word(model, variant, question);
        // Neighbours differ in what is seen first, whatever the words say.
        let turn = variant as usize;
        let woman = match model.base {
            BaseType::Pedestrian => model.gender(variant) == "female",
            _ => ask(15) % 3 == 0,
        };
        let age = model.person.map_or(Age::Adult, |person| person.age);
        let pick = |of: &[[f32; 3]], question: u64| of[ask(question) % of.len()];
        let build = match (age, (turn / 2 + ask(1)) % 5) {
            (Age::Child | Age::Teen, 0..=2) | (_, 0) => Build::Slim,
            (_, 4) => Build::Heavy,
            _ => Build::Average,
        };
        let dresses = woman && age != Age::Child;
        let top = match (age, (5 * turn + ask(2)) % 12) {
            (_, 0 | 1) if dresses => Top::Dress,
            (Age::Child | Age::Teen, 0..=4) => Top::Tee,
            (Age::Child | Age::Teen, 5..=8) => Top::Hoodie,
            (Age::Child | Age::Teen, _) => Top::Jacket,
            (Age::Elder, 2..=5) => Top::Coat,
            (Age::Elder, 6..=8) => Top::Jacket,
            (_, 2 | 3) => Top::Tee,
            (_, 4 | 5) => Top::Jacket,
            (_, 6) => Top::Hoodie,
            (_, 7) => Top::Suit,
            (_, 8 | 9) => Top::Coat,
            _ => Top::Shirt,
        };
        let bottom = match (top, ask(3) % 6) {
            (Top::Dress, _) => Bottom::Skirt,
            (_, 0 | 1) if dresses => Bottom::Skirt,
            (Top::Tee, 2..=4) if age != Age::Elder => Bottom::Shorts,
            _ => Bottom::Trousers,
        };
        let hair = match (woman, age, (turn + ask(4)) % 6) {
            (false, Age::Elder, 0..=2) => Hair::Thin,
            (true, Age::Elder, 0..=2) => Hair::Curls,
            (true, _, 0 | 1) => Hair::Long,
            (true, _, 2) => Hair::Ponytail,
            (true, _, 3) => Hair::Bun,
            (true, _, 4) => Hair::Bob,
            (_, _, 5) => Hair::Curls,
            (false, Age::Adult, 4) => Hair::Thin,
            _ => Hair::Short,
        };
        let hat = match (woman, age, (turn + ask(5)) % 12) {
            (_, Age::Child | Age::Teen, 0 | 1) | (false, _, 0) => Hat::Cap,
            (_, _, 2) => Hat::Beanie,
            (true, _, 3) | (_, Age::Elder, 3) => Hat::SunHat,
            (true, Age::Adult | Age::Elder, 4) => Hat::Scarf,
            _ => Hat::None,
        };
        let carried = match (age, (turn + ask(6)) % 8) {
            (Age::Elder, 0..=2) => Carried::Cane,
            (Age::Child | Age::Teen, 0..=2) | (Age::Adult, 0 | 1) => Carried::Backpack,
            (Age::Adult | Age::Elder, 3) => Carried::ShoulderBag,
            (Age::Adult, 4) if woman => Carried::ShoulderBag,
            (Age::Adult | Age::Teen, 5) => Carried::Phone,
            _ => Carried::Nothing,
        };
        let stance = match (carried, ask(7) % 5) {
            (Carried::Cane | Carried::Phone, _) | (_, 0 | 1) => Stance::ArmsHang,
            (_, 2) if age != Age::Child => Stance::Phones,
            (_, 3) => Stance::Talks,
            _ => Stance::HandsOnHips,
        };
        let top_weave = match (top, ask(18) % 6) {
            (Top::Tee, 0 | 1) | (Top::Dress | Top::Shirt, 0) => Weave::Stripes,
            (Top::Shirt, 1 | 2) | (Top::Dress | Top::Coat, 1) => Weave::Checks,
            (Top::Hoodie, _) | (Top::Shirt, 3) => Weave::Knit,
            (Top::Jacket, 0) => Weave::Denim,
            _ => Weave::Plain,
        };
        let bottom_rgb = pick(&BOTTOMS, 10);
        let bottom_weave = match (bottom, bottom_rgb) {
            (Bottom::Skirt, _) if ask(19) % 4 == 0 => Weave::Checks,
            // Blue ones are jeans.
            (_, [r, _, b]) if b > 1.5 * r => Weave::Denim,
            _ => Weave::Plain,
        };
        let spread = (ask(8) % 1000) as f32 / 1000.0;
        let look = Self {
            age,
            woman,
            build,
            top,
            bottom,
            hair,
            hat,
            carried,
            stance,
            height: 0.95 + 0.10 * spread,
            top_weave,
            bottom_weave,
            top_rgb: TOPS[(3 * turn + ask(9)) % TOPS.len()],
            bottom_rgb,
            skin_rgb: SKIN[(turn + ask(11)) % SKIN.len()],
            hair_rgb: if age == Age::Elder { pick(&GREY, 12) } else { pick(&HAIR, 12) },
            shoe_rgb: pick(&SHOES, 13),
            extra_rgb: pick(&EXTRAS, 14),
            dog_m: 0.30 + 0.22 * (ask(16) % 1000) as f32 / 1000.0,
        };
        look.with_them(model.special, pick(&COATS, 17)).at_work(model.special, turn)
    }

    /// The same with what the model takes along: the hands are there for that.
    fn with_them(self, special: Special, coat_rgb: [f32; 3]) -> Self {
        let (carried, extra_rgb) = match special {
            Special::Pram => (Carried::Pram, self.extra_rgb),
            Special::Dog => (Carried::Dog, coat_rgb),
            _ => return self,
        };
        Self { carried, extra_rgb, stance: Stance::ArmsHang, ..self }
    }

    /// Somebody of whom no more is known: nothing carried, arms that hang.
    #[must_use]
    pub fn plain(age: Age, woman: bool) -> Self {
        Self {
            age,
            woman,
            build: Build::Average,
            top: Top::Shirt,
            bottom: Bottom::Trousers,
            hair: Hair::Short,
            hat: Hat::None,
            carried: Carried::Nothing,
            stance: Stance::ArmsHang,
            height: 1.0,
            top_weave: Weave::Plain,
            bottom_weave: Weave::Plain,
            top_rgb: TOPS[0],
            bottom_rgb: BOTTOMS[0],
            skin_rgb: SKIN[0],
            hair_rgb: HAIR[0],
            shoe_rgb: SHOES[0],
            extra_rgb: EXTRAS[0],
            dog_m: 0.0,
        }
    }

    /// The same in the clothes of their work.
    fn at_work(self, special: Special, turn: usize) -> Self {
        let (worn, hat, extra_rgb, carried) = match special {
            Special::Worker => {
                let vest = VESTS[turn % 2];
                let legs = if turn % 4 < 2 { vest } else { UNIFORM };
                let worn = Self { top: Top::HiVis, top_rgb: vest, bottom_rgb: legs, ..self };
                let carried = if turn % 5 < 2 { Carried::Shovel } else { Carried::Nothing };
                (worn, Hat::Helmet, HELMETS[turn % 3], carried)
            }
            Special::Police => (self.in_uniform(), Hat::PeakedCap, UNIFORM, Carried::Nothing),
            _ => return self,
        };
        let free = carried == Carried::Nothing && self.stance != Stance::Phones;
        let stance = if free { self.stance } else { Stance::ArmsHang };
        let hair = if self.woman { Hair::Ponytail } else { Hair::Short };
        let bottom = Bottom::Trousers;
        let (top_weave, bottom_weave) = (Weave::Plain, Weave::Plain);
        Self { top_weave, bottom_weave, hat, extra_rgb, carried, stance, hair, bottom, ..worn }
    }

    /// The same in the uniform of the police, with whatever is on their head.
    #[must_use]
    pub fn in_uniform(self) -> Self {
        Self {
            top: Top::Uniform,
            top_weave: Weave::Plain,
            bottom_weave: Weave::Plain,
            top_rgb: UNIFORM,
            bottom_rgb: UNIFORM,
            ..self
        }
    }

    /// The same on a two-wheeler: a helmet, nothing in the hands, trousers.
    #[must_use]
    pub fn riding(mut self, full_helmet: bool) -> Self {
        self.hat = if full_helmet { Hat::FullHelmet } else { Hat::BicycleHelmet };
        self.carried = if self.carried == Carried::Backpack { self.carried } else { Carried::Nothing };
        self.bottom =
            if full_helmet || self.bottom == Bottom::Skirt { Bottom::Trousers } else { self.bottom };
        self.top = match self.top {
            Top::Coat | Top::Dress | Top::Suit => Top::Jacket,
            Top::Tee if full_helmet => Top::Jacket,
            top => top,
        };
        self.stance = Stance::ArmsHang;
        self
    }

    /// The same in a wheelchair.
    #[must_use]
    pub fn seated(mut self) -> Self {
        (self.carried, self.stance) = (Carried::Nothing, Stance::ArmsHang);
        self.top = if matches!(self.top, Top::Coat | Top::Dress) { Top::Shirt } else { self.top };
        self.bottom = if self.bottom == Bottom::Skirt { Bottom::Trousers } else { self.bottom };
        self
    }

    /// Whether somebody dressed so may sit on a bench: no coat or skirt stands off stiffly, and nothing is in
    /// the way of the seat or its back.
    #[must_use]
    pub fn may_sit(&self) -> bool {
        self.bottom != Bottom::Skirt
            && !matches!(self.top, Top::Coat | Top::Dress | Top::Suit)
            && matches!(self.carried, Carried::Nothing | Carried::Phone)
    }

    /// Whether the legs' skin is seen.
    #[must_use]
    pub fn bare_legs(&self) -> bool {
        self.bottom != Bottom::Trousers
    }

    /// How much wider the trunk is than of somebody average.
    #[must_use]
    pub fn girth(&self) -> f32 {
        match self.build {
            Build::Slim => 0.92,
            Build::Average => 1.0,
            Build::Heavy => 1.14,
        }
    }
}
