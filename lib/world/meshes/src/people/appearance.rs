//! What somebody looks like: age, sex, build, clothes, hair, what they carry. It follows from model and
//! variant alone.

use catalogue::{Age, BaseType, Model, Special};
use schema::geometry::Weave;

use crate::people::palette::{
    ACCENTS, BOTTOMS, COATS, DARK_SKIN, EXTRAS, GREY, HAIR, HELMETS, RIDERS_HELMETS, RIDERS_JACKETS, SHOES,
    SKIN, TOPS, UNIFORM, VESTS,
};

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
    Bald,
    Thin,
    Crew,
    Short,
    Parted,
    Quiff,
    Fringe,
    Curls,
    Afro,
    Bob,
    Long,
    Bun,
    Ponytail,
}

/// Hair of the face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum Beard {
    None,
    Stubble,
    Moustache,
    Goatee,
    Full,
}

/// What is worn on the feet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum Shoe {
    Sports,
    Leather,
    Boots,
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
    pub beard: Beard,
    pub glasses: bool,
    pub shoe: Shoe,
    pub carried: Carried,
    pub stance: Stance,
    /// What makes a face and a hairdo somebody's own, each 0 to 1.
    pub face: [f32; 4],
    /// How wide trousers and skirts are cut, 0 to 1, and how long skirts and coats are.
    pub loose: f32,
    pub long: f32,
    /// Whether a shirt is worn in the trousers.
    pub tucks: bool,
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
    /// Of what is small and stands out: a tie, a shirt below a jacket, the stripe on a helmet.
    pub accent_rgb: [f32; 3],
    /// Of the helmet and the jacket of somebody who rides.
    pub helmet_rgb: [f32; 3],
    pub jacket_rgb: [f32; 3],
    /// Height of a dog's back, metres.
    pub dog_m: f32,
}

/// How somebody's hair is worn: `turn` goes on from look to look, `other` tells more apart.
fn hairdo(age: Age, woman: bool, dark: bool, turn: usize, other: usize) -> Hair {
    let curly = dark && other.is_multiple_of(2) || other.is_multiple_of(9);
    match (woman, age, turn % 8) {
        (false, Age::Elder, 0..=2) | (false, Age::Adult, 3) => Hair::Thin,
        (false, Age::Elder, 3 | 4) | (false, Age::Adult, 7) => Hair::Bald,
        (true, Age::Elder, 0..=2) => Hair::Curls,
        (true, Age::Elder, 3) => Hair::Short,
        (true, _, 4) => Hair::Bun,
        (true, _, 6) => Hair::Ponytail,
        (_, _, 5) if curly => Hair::Afro,
        _ if curly => Hair::Curls,
        (true, _, 0 | 1) => Hair::Long,
        (true, _, 2) => Hair::Bob,
        (true, _, 3) => Hair::Fringe,
        (true, _, 5) => Hair::Short,
        (true, ..) => Hair::Long,
        (false, _, 0) => Hair::Crew,
        (false, _, 1) => Hair::Parted,
        (false, _, 2) => Hair::Quiff,
        (false, _, 6) => Hair::Fringe,
        (false, ..) => Hair::Short,
    }
}

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
        let skin_rgb = SKIN[(turn + ask(11)) % SKIN.len()];
        let hair = hairdo(age, woman, skin_rgb[0] < DARK_SKIN, turn + ask(4), ask(20));
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
        let top_weave = match (top, ask(18) % 12) {
            (Top::Tee, 0 | 1) => Weave::Stripes,
            (Top::Shirt, 1..=3) | (Top::Dress | Top::Coat, 1) => Weave::Checks,
            (Top::Hoodie, _) | (Top::Shirt, 4) => Weave::Knit,
            (Top::Jacket, 0 | 1) => Weave::Denim,
            _ => Weave::Plain,
        };
        let bottom_rgb = pick(&BOTTOMS, 10);
        let bottom_weave = match (bottom, bottom_rgb) {
            (Bottom::Skirt, _) if ask(19) % 6 == 0 => Weave::Checks,
            // Blue ones are jeans.
            (_, [r, _, b]) if b > 1.5 * r => Weave::Denim,
            _ => Weave::Plain,
        };
        let share = |question: u64| (ask(question) % 1000) as f32 / 1000.0;
        let grown = matches!(age, Age::Adult | Age::Elder);
        let beard = match (turn / 3 + ask(21)) % 7 {
            _ if woman || !grown => Beard::None,
            0 => Beard::Full,
            1 | 2 => Beard::Stubble,
            3 => Beard::Goatee,
            4 if age == Age::Elder => Beard::Moustache,
            _ => Beard::None,
        };
        let shoe = match (top, (turn + ask(22)) % 5) {
            (Top::Suit, _) | (Top::Coat, 0..=2) => Shoe::Leather,
            (_, 0) => Shoe::Boots,
            (_, 1) if grown => Shoe::Leather,
            _ => Shoe::Sports,
        };
        let look = Self {
            age,
            woman,
            build,
            top,
            bottom,
            hair,
            hat,
            beard,
            glasses: grown && (turn + ask(23)).is_multiple_of(4),
            shoe,
            carried,
            stance,
            face: [24, 25, 26, 27].map(share),
            loose: share(28),
            long: share(29),
            tucks: ask(30) % 3 == 0,
            height: 0.95 + 0.10 * share(8),
            top_weave,
            bottom_weave,
            top_rgb: TOPS[(3 * turn + ask(9)) % TOPS.len()],
            bottom_rgb,
            skin_rgb,
            hair_rgb: match age {
                Age::Elder => pick(&GREY, 12),
                Age::Adult if ask(31) % 9 == 0 => pick(&GREY, 12),
                // The first two are dark.
                _ if skin_rgb[0] < DARK_SKIN => pick(&HAIR[..2], 12),
                _ => pick(&HAIR, 12),
            },
            shoe_rgb: if shoe == Shoe::Boots { pick(&SHOES[..2], 13) } else { pick(&SHOES, 13) },
            extra_rgb: pick(&EXTRAS, 14),
            accent_rgb: ACCENTS[(turn + ask(32)) % ACCENTS.len()],
            helmet_rgb: RIDERS_HELMETS[(3 * turn + ask(33)) % RIDERS_HELMETS.len()],
            jacket_rgb: RIDERS_JACKETS[(5 * turn + ask(34)) % RIDERS_JACKETS.len()],
            dog_m: 0.30 + 0.22 * share(16),
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
            beard: Beard::None,
            glasses: false,
            shoe: Shoe::Leather,
            carried: Carried::Nothing,
            stance: Stance::ArmsHang,
            face: [0.5; 4],
            loose: 0.4,
            long: 0.5,
            tucks: false,
            height: 1.0,
            top_weave: Weave::Plain,
            bottom_weave: Weave::Plain,
            top_rgb: TOPS[0],
            bottom_rgb: BOTTOMS[0],
            skin_rgb: SKIN[0],
            hair_rgb: HAIR[0],
            shoe_rgb: SHOES[0],
            extra_rgb: EXTRAS[0],
            accent_rgb: ACCENTS[0],
            helmet_rgb: RIDERS_HELMETS[0],
            jacket_rgb: RIDERS_JACKETS[0],
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
        let shoe = Shoe::Boots;
        Self { shoe, top_weave, bottom_weave, hat, extra_rgb, carried, stance, hair, bottom, ..worn }
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
            Top::Tee | Top::Shirt if full_helmet => Top::Jacket,
            top => top,
        };
        // Motorcyclists wear what is made for it, cyclists often what they have.
        if full_helmet || self.top == Top::Jacket {
            self.top_rgb = self.jacket_rgb;
            self.top_weave = Weave::Plain;
        }
        if full_helmet {
            self.shoe = Shoe::Boots;
            self.glasses = false;
        }
        self.extra_rgb = self.helmet_rgb;
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

    /// Whether the top is worn in the trousers, so that a belt shows.
    #[must_use]
    pub fn tucked(&self) -> bool {
        self.tucks && matches!(self.top, Top::Shirt | Top::Tee) && self.bottom != Bottom::Skirt
    }

    /// Whether trousers have a crease.
    #[must_use]
    pub fn pressed(&self) -> bool {
        self.top == Top::Suit || self.top == Top::Uniform || self.shoe == Shoe::Leather && self.tucks
    }

    /// Whether a jacket or a coat is open at the neck, so that what is below shows.
    #[must_use]
    pub fn open(&self) -> bool {
        let rides = self.hat == Hat::FullHelmet;
        self.top == Top::Coat || self.top == Top::Jacket && self.face[2] > 0.45 && !rides
    }

    /// Whether a skirt or a coat's tails hang about the thighs.
    #[must_use]
    pub fn hangs(&self) -> bool {
        self.bottom == Bottom::Skirt || self.top == Top::Coat
    }

    /// How much a skirt or a coat widens downward: 0 not, 1 as a bell.
    #[must_use]
    pub fn flare(&self) -> f32 {
        if self.top == Top::Coat { 0.25 + 0.25 * self.loose } else { 0.25 + 0.75 * self.loose }
    }

    /// How far down the thigh a skirt reaches, as a share of it.
    #[must_use]
    pub fn skirt(&self) -> f32 {
        0.68 + 0.30 * self.long
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
