#![doc = include_str!("../README.md")]

pub mod benches;
mod body;
mod buses;
pub mod cars;
pub mod fleet;
mod lorries;
mod model;
pub mod models;
mod packs;
pub mod paints;
pub mod people;
pub mod roadside;
mod shapes;
pub mod street_lamps;
pub mod trains;
mod two_wheelers;
mod vans;
pub mod works;

pub use body::{
    BarrierBody, Body, BusBody, CarBody, ConeBody, Frame, Livery, Load, PersonBody, Rim, Seats, Shape,
    TwoWheelerBody,
};
pub use model::{Age, BaseType, Gender, Model, Person, RSU_MODEL, Special, swept_m};
pub use packs::Catalogue;
pub use shapes::SEDAN;
