//! The kinds of street furniture: what they are called, how large they are, where they stand and how often.
//! A kind is named once more where its mesh is made.

use schema::{ActorKind, Tag};

use crate::scenery::style::FurnitureStyle;

/// Where a kind of furniture stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FurniturePlace {
    /// On a wide sidewalk, half a metre behind the kerb.
    Kerb,
    /// There, or beyond the outer edge of a narrower sidewalk or of a road without one.
    KerbOrBeyond,
    /// Beyond the outer edge.
    Beyond,
    /// As `KerbOrBeyond`, where there is a parking lane.
    Parking,
    /// So many metres beyond the outer edge.
    Verge([f64; 2]),
    /// Beyond the outer edge before buildings of these models, beside their doors.
    Door(&'static [&'static str]),
    /// Beyond the outer edge before such buildings, where the grass beside the street ends.
    Yard(&'static [&'static str]),
    /// In a line on both sides of a road without sidewalk.
    Line {
        /// From the edge, metres.
        beyond_m: f64,
        /// Distance between two, metres.
        apart_m: f64,
    },
    /// In such a line on one side of a road, with wires from one to the next.
    Wired {
        /// From the edge of a road without sidewalk, metres.
        beyond_m: f64,
        /// Shortest and longest distance between two, metres.
        apart_m: [f64; 2],
    },
    /// Piece by piece along fast roads without sidewalk, so many metres beyond the edge, and on medians.
    Rail(f64),
}

/// Which way a kind of furniture looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FurnitureFront {
    /// At the road.
    Road,
    /// At the traffic of its side of the road.
    Traffic,
}

/// A kind of street furniture.
#[derive(Clone, Copy, Debug)]
pub struct FurnitureKind {
    /// Model name.
    pub model: &'static str,
    /// The way it looks, across that, and up, metres.
    pub size_m: [f64; 3],
    /// What it is.
    pub tag: Tag,
    /// What some of its parts are besides.
    pub also: &'static [Tag],
    /// Where it stands.
    pub place: FurniturePlace,
    /// Where it looks.
    pub front: FurnitureFront,
    /// How many stand on a kilometre of one side of a street with a narrow sidewalk, with a wide one, of a
    /// road without one; of doors and lines: the share of buildings and roads that have it.
    pub often: [f64; 3],
    /// Height of the foot or slab that it stands on, metres: its top is level with the ground at the street,
    /// and falling ground shows it on the other side; 0 without one.
    pub foot_m: f64,
    /// So many of them differ.
    pub variants: u32,
    /// The style of town that has it.
    pub style: FurnitureStyle,
}

impl FurnitureKind {
    /// What its rows say it is.
    #[must_use]
    pub fn actor_kind(&self) -> ActorKind {
        if self.model.starts_with("pole.") { ActorKind::Pole } else { ActorKind::Prop }
    }
}

use FurniturePlace::{Beyond, Door, Kerb, KerbOrBeyond, Line, Parking, Rail, Verge, Wired, Yard};

const fn kind(
    model: &'static str,
    size_m: [f64; 3],
    tag: Tag,
    place: FurniturePlace,
    often: [f64; 3],
    variants: u32,
) -> FurnitureKind {
    let (front, style, foot_m) = (FurnitureFront::Road, FurnitureStyle::Any, 0.0);
    FurnitureKind { model, size_m, tag, also: &[], place, front, often, foot_m, variants, style }
}

impl FurnitureKind {
    const fn facing_traffic(self) -> Self {
        Self { front: FurnitureFront::Traffic, ..self }
    }

    const fn on_foot(self, foot_m: f64) -> Self {
        Self { foot_m, ..self }
    }

    const fn with(self, also: &'static [Tag]) -> Self {
        Self { also, ..self }
    }

    const fn american(self) -> Self {
        Self { style: FurnitureStyle::American, ..self }
    }

    const fn european(self) -> Self {
        Self { style: FurnitureStyle::European, ..self }
    }
}

const SHOPS: &[&str] = &["building.block", "building.shop"];
const HOMES: &[&str] = &["building.block", "building.house", "building.tower"];
const HOUSES: &[&str] = &["building.house"];
const LARGE: &[&str] = &["building.block", "building.tower", "building.shop", "building.hall"];

/// Delineators on both sides, poles of lines on one.
const DELINEATORS: FurniturePlace = Line { beyond_m: 0.6, apart_m: 50.0 };
const POLES: FurniturePlace = Wired { beyond_m: 2.6, apart_m: [34.0, 46.0] };

/// All kinds. None has a diagonal of more than 4.8 m: what is placed around them depends on that
/// (`site::reach_m`).
#[rustfmt::skip]
pub const FURNITURE: [FurnitureKind; 40] = [
    // Along kerbs.
    kind("prop.bollards", [0.16, 4.36, 1.0], Tag::Static, Kerb, [0.0, 36.0, 0.0], 4),
    kind("prop.hydrant_barrel", [0.36, 0.36, 0.78], Tag::Static, KerbOrBeyond, [4.0, 4.0, 0.5], 3).american(),
    kind("prop.parking_meter", [0.2, 0.22, 1.4], Tag::Static, Parking, [6.0, 10.0, 0.0], 3),
    kind("prop.pay_machine", [0.3, 0.4, 1.7], Tag::Static, Parking, [3.0, 4.0, 0.0], 3),
    kind("prop.charger", [0.4, 0.56, 1.8], Tag::Static, Parking, [2.0, 5.0, 0.0], 3),
    kind("prop.postbox_round_top", [0.5, 0.5, 1.25], Tag::Static, KerbOrBeyond, [1.5, 1.5, 0.2], 3).american(),
    kind("prop.postbox_pillar", [0.48, 0.48, 1.55], Tag::Static, KerbOrBeyond, [1.0, 1.2, 0.0], 3).european(),
    kind("prop.newspaper_boxes", [0.4, 0.9, 1.1], Tag::Static, KerbOrBeyond, [1.0, 2.0, 0.0], 5).american(),
    kind("prop.planter", [0.6, 1.2, 1.1], Tag::Static, KerbOrBeyond, [2.0, 8.0, 0.0], 6).with(&[Tag::Vegetation]),
    kind("prop.advert_column", [1.4, 1.4, 3.6], Tag::Static, KerbOrBeyond, [0.7, 1.2, 0.0], 6).on_foot(0.26).european(),
    kind("prop.city_light", [0.25, 1.3, 2.4], Tag::Static, KerbOrBeyond, [0.8, 2.0, 0.0], 6).facing_traffic(),
    kind("pole.bus_stop", [0.26, 0.46, 2.9], Tag::Pole, KerbOrBeyond, [1.0, 1.0, 0.6], 3).facing_traffic(),
    kind("pole.clock", [0.36, 0.8, 4.0], Tag::Pole, KerbOrBeyond, [0.2, 0.5, 0.0], 3).facing_traffic(),
    // Beyond the sidewalk.
    kind("prop.hydrant_pillar", [0.3, 0.4, 0.95], Tag::Static, Beyond, [4.0, 4.0, 0.6], 3).european(),
    kind("prop.hydrant_post", [0.08, 0.26, 1.1], Tag::Static, Beyond, [1.5, 1.5, 1.5], 2).european(),
    kind("prop.postbox_on_post", [0.3, 0.45, 1.4], Tag::Static, Beyond, [1.0, 1.0, 0.4], 3).european(),
    kind("prop.cabinet", [0.4, 1.2, 1.4], Tag::Static, Beyond, [6.0, 6.0, 0.8], 3),
    kind("prop.cabinet_small", [0.32, 0.6, 1.05], Tag::Static, Beyond, [4.0, 4.0, 0.8], 3),
    kind("prop.phone_box", [0.9, 0.9, 2.3], Tag::Static, Beyond, [0.6, 0.8, 0.2], 3),
    kind("prop.flower_tub", [0.8, 0.8, 0.75], Tag::Static, Beyond, [2.0, 5.0, 0.3], 6).with(&[Tag::Vegetation]),
    kind("prop.bicycle_pump", [0.36, 0.8, 1.35], Tag::Static, Beyond, [0.3, 1.0, 0.0], 3),
    kind("prop.info_board", [0.3, 1.2, 2.1], Tag::Static, Beyond, [0.4, 0.6, 0.3], 3),
    kind("prop.recycling", [1.3, 2.8, 1.9], Tag::Static, Beyond, [0.6, 0.8, 0.3], 4).on_foot(0.25),
    kind("prop.grit_bin", [0.7, 1.0, 0.8], Tag::Static, Beyond, [0.7, 0.5, 0.6], 3),
    kind("prop.kiosk", [2.0, 2.5, 3.24], Tag::Static, Beyond, [0.4, 0.8, 0.0], 3).on_foot(0.48),
    kind("prop.bus_shelter", [1.5, 4.0, 2.8], Tag::Static, Beyond, [1.0, 1.4, 0.5], 6).on_foot(0.3),
    kind("pole.flag", [0.4, 1.8, 7.5], Tag::Pole, Beyond, [1.0, 2.0, 0.3], 3).facing_traffic().with(&[Tag::Other]),
    kind("prop.billboard", [0.9, 3.8, 4.7], Tag::Static, Verge([3.6, 8.0]), [0.2, 0.0, 1.5], 6).facing_traffic(),
    // Beside doors.
    kind("prop.letterbox", [0.46, 0.25, 1.15], Tag::Static, Door(HOUSES), [0.3, 0.2, 0.6], 4),
    kind("prop.wheelie_bins", [0.75, 2.0, 1.07], Tag::Dynamic, Door(HOMES), [0.35, 0.3, 0.3], 6),
    kind("prop.container", [1.1, 1.37, 1.6], Tag::Dynamic, Door(LARGE), [0.10, 0.08, 0.10], 3).on_foot(0.2).european().with(&[Tag::Static]),
    kind("prop.dumpster", [1.5, 1.8, 1.7], Tag::Static, Door(LARGE), [0.12, 0.08, 0.25], 3).on_foot(0.3).american(),
    kind("prop.skip", [1.7, 3.4, 1.3], Tag::Static, Yard(HOMES), [0.06, 0.06, 0.06], 3),
    kind("prop.bags", [0.85, 1.3, 0.6], Tag::Dynamic, Door(HOMES), [0.08, 0.07, 0.04], 3),
    kind("prop.crates", [0.6, 1.2, 0.9], Tag::Dynamic, Door(SHOPS), [0.15, 0.12, 0.06], 5),
    kind("prop.a_board", [0.62, 0.6, 1.0], Tag::Dynamic, Door(SHOPS), [0.25, 0.25, 0.0], 9).facing_traffic().with(&[Tag::Static]),
    kind("prop.cafe", [2.0, 4.0, 2.94], Tag::Dynamic, Door(SHOPS), [0.20, 0.25, 0.0], 6).on_foot(0.46).with(&[Tag::Static, Tag::Other]),
    // Country roads.
    kind("prop.delineator", [0.13, 0.13, 1.0], Tag::Pole, DELINEATORS, [0.0, 0.0, 1.0], 1),
    kind("pole.utility", [2.4, 0.9, 9.5], Tag::Pole, POLES, [0.8, 0.7, 0.9], 3),
    kind("prop.guard_rail", [0.3, 4.0, 0.75], Tag::GuardRail, Rail(0.78), [0.0, 0.0, 1.0], 1),
];
