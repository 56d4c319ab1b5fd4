//! Where people sit in each vehicle.

use catalogue::{BaseType, Model, Seats};

use super::room::Room;

/// The door of a bus's rear section is so far ahead of its axle, metres.
pub(crate) const REAR_DOOR_M: f32 = 1.75;

/// A row of seats: of hips that are so far ahead and so high, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub(crate) x: f32,
    pub(crate) z: f32,
    pub(crate) seats: Seats,
}

/// Where everything is, metres.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    pub(crate) floor_z: f32,
    /// Middle of the dashboard's front edge and how deep it is.
    pub(crate) cowl_x: f32,
    pub(crate) cowl_z: f32,
    pub(crate) dash_m: f32,
    /// The driver's hips.
    pub(crate) driver: [f32; 3],
    /// How far the driver leans back, radians.
    pub(crate) lean_rad: f32,
    /// Radius of the steering wheel, and how far it is tipped from upright, radians.
    pub(crate) wheel: [f32; 2],
    pub(crate) rows: Vec<Row>,
    /// A cover at the belt begins here, behind the last seats.
    pub(crate) cover_x: Option<f32>,
    /// Here the cabin ends.
    pub(crate) rear_x: f32,
}

/// From the hips to the rear of a seat's back, metres.
const BEHIND_M: f32 = 0.52;

impl Plan {
    /// That of a model.
    pub(crate) fn new(model: &Model, room: &Room<'_>) -> Self {
        match model.base {
            BaseType::Bus => Self::bus(room),
            BaseType::Truck if model.car_body().is_none() => Self::lorry(room),
            _ => Self::car(model, room),
        }
    }

    fn car(model: &Model, room: &Room<'_>) -> Self {
        let (hull, style) = (room.hull, &room.hull.style);
        let van = model.base == BaseType::Van;
        let cowl_x = hull.x_of(style.cowl.0);
        let belt_z = hull.section(style.windows.0 + 0.05).belt_z;
        // In a high van one sits above the belt rather than behind it.
        let drop_m = if !van {
            0.42
        } else if hull.height < 2.3 {
            0.28
        } else {
            0.14
        };
        let hips_z = belt_z - drop_m;
        let front_x = match style.pillars.first() {
            Some(pillar) => hull.x_of(*pillar) + 0.27,
            None => hull.x_of(style.windows.1) + 0.30,
        };
        let front_x = front_x.clamp(cowl_x - 1.15, cowl_x - 0.78);
        let aside = 0.2 * 2.0 * hull.half_width;
        let mut rows = vec![Row { x: front_x, z: hips_z, seats: Seats::Two(aside) }];
        let body = model.car_body();
        let behind = body.map_or(&[][..], |body| body.rear_seats);
        for (k, seats) in behind.iter().enumerate() {
            let x = front_x - (k + 1) as f32 * if van { 0.88 } else { 0.80 };
            rows.push(Row { x, z: hips_z + 0.03, seats: *seats });
        }
        let last_x = rows[rows.len() - 1].x - BEHIND_M;
        // A wall behind the seats of those that carry goods.
        let walled = body.is_some_and(|body| body.has_bulkhead);
        let rear_x = if walled {
            last_x.min(hull.x_of(style.windows.1))
        } else {
            // The rear window bulges behind its lower edge.
            hull.x_of(style.deck.0) - style.glass_bow_m[1]
        };
        Self {
            floor_z: (room.least_z() + 0.05).min(hips_z - 0.24),
            cowl_x,
            cowl_z: hull.section(style.cowl.0).belt_z + 0.03,
            dash_m: 0.40,
            driver: [front_x, aside, hips_z],
            lean_rad: if van { 0.16 } else { 0.32 },
            wheel: [0.185, if van { 0.7 } else { 0.42 }],
            rows,
            cover_x: (!walled).then_some(last_x.max(rear_x + 0.02)),
            rear_x,
        }
    }

    fn lorry(room: &Room<'_>) -> Self {
        let (hull, style) = (room.hull, &room.hull.style);
        let cowl_x = hull.x_of(0.0) - 0.02;
        let belt_z = hull.section(style.windows.0 + 0.05).belt_z;
        let over = hull.axles.iter().filter_map(|x| room.over_wheels(*x)).map(|(z, _)| z).fold(0.0, f32::max);
        let (floor_z, hips_z) = (over.min(belt_z - 0.2) + 0.02, belt_z + 0.12);
        let rear_x = hull.x[0] + 0.07;
        let front_x = (cowl_x - 0.92).max(rear_x + BEHIND_M);
        let aside = 0.62 * hull.half_width;
        let mut rows = vec![Row { x: front_x, z: hips_z, seats: Seats::Two(aside) }];
        if front_x - 0.95 - BEHIND_M > rear_x {
            rows.push(Row { x: front_x - 0.95, z: hips_z, seats: Seats::Bench(0.85) });
        }
        Self {
            floor_z,
            cowl_x,
            cowl_z: belt_z,
            dash_m: 0.38,
            driver: [front_x, aside, hips_z],
            lean_rad: 0.10,
            wheel: [0.225, 0.95],
            rows,
            cover_x: None,
            rear_x,
        }
    }

    fn bus(room: &Room<'_>) -> Self {
        let (hull, style) = (room.hull, &room.hull.style);
        let cowl_x = hull.x_of(style.cowl.0) - 0.02;
        let belt_z = hull.section(style.windows.0 + 0.03).belt_z;
        let hips_z = belt_z + 0.10;
        // Those of a coach sit over their luggage.
        let floor_z = (room.least_z() + 0.06).max(belt_z - 0.74);
        let (front_x, aside) = (cowl_x - 1.0, 0.62 * hull.half_width);
        let rear_x = hull.x_of(1.0) + 0.10;
        // What is towed has its door before its only axle, and seats where others have a driver.
        let (middle_door, first) = match hull.axles[..] {
            [ahead, behind, ..] => (0.5 * (ahead + behind), front_x - 1.55),
            [one] => (one + REAR_DOOR_M, cowl_x - 0.75),
            [] => (cowl_x, cowl_x),
        };
        let count = ((first - rear_x - 0.6) / 0.80) as usize;
        let rows = (0..count).map(|k| {
            let x = first - 0.80 * k as f32;
            let under = [-0.2, 0.0, 0.15, 0.3].into_iter().filter_map(|ahead| room.over_wheels(x + ahead));
            let over = under.map(|(z, _)| z + 0.18).fold(0.0, f32::max);
            let right = (x - middle_door).abs() > 1.0;
            Row { x, z: (floor_z + 0.45).max(over), seats: Seats::Aisle { right } }
        });
        Self {
            floor_z,
            cowl_x,
            cowl_z: belt_z,
            dash_m: 0.40,
            driver: [front_x, aside, hips_z],
            lean_rad: 0.08,
            wheel: [0.235, 1.0],
            rows: rows.collect(),
            cover_x: None,
            rear_x,
        }
    }
}
