//! Cabins: what is seen through the panes of cars, vans, lorries and buses.

mod driver;
mod lining;
mod plan;
mod room;
mod seats;

use std::sync::Arc;

use crate::solids::{Fit, MeshBuilder};
use catalogue::{Body, Model, trains};
use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use crate::actors::hull::Hull;
use crate::actors::pieces::Cabin;
use crate::actors::skin::Place;
use plan::Plan;
use room::Room;
use seats::Stuffs;

pub(crate) use lining::REAR_PANE;
pub(crate) use plan::REAR_DOOR_M;

/// The cabin of a model's hull; `inner_y` as of its wheels, `pane` where its skin is one: at a place, on the
/// left or the right.
pub(crate) fn cabin(
    model: &Model,
    tag: Tag,
    hull: &Hull,
    inner_y: Vec<f32>,
    fit: &Fit,
    pane: &dyn Fn(f32, Place, bool) -> bool,
) -> Cabin {
    let room = Room { hull, inner_y };
    let plan = Plan::new(model, &room);
    let stuff = |surface: Surface, rgb: [f32; 3]| MeshPart::new(tag, surface, rgb);
    let seats = match model.body {
        Body::Bus(_) => [0.05, 0.09, 0.22],
        Body::Car(body) => body.seat_rgb,
        _ => [0.075, 0.073, 0.07],
    };
    let stuffs = Stuffs::new(stuff, seats);
    let mut b = MeshBuilder::new();
    lining::lining(&mut b, &room, &plan, stuff, pane);
    let is_towed = trains::of_towed(model.name).is_some();
    if !is_towed {
        seats::dashboard(&mut b, stuffs.plastic, &plan, hull);
    }
    seats::rows(&mut b, &stuffs, &plan, hull);
    if !is_towed {
        seats::steering_wheel(&mut b, &stuffs, &plan);
        seats::inner_mirror(&mut b, stuffs.plastic, hull);
    }
    b.reshape(|p| fit.apply(room.held(p)));
    let driver = (!is_towed).then(|| Arc::new(driver::driver(model, tag, &plan, &room, fit)));
    Cabin { seats: Arc::new(b.finish()), driver }
}
