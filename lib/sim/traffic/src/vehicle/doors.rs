//! Doors of vehicles that stand.

use catalogue::Model;
use random::Stream;
use schema::FRAME_PERIOD_S;

/// Open doors stand at this angle, radians.
const OPEN_RAD: f64 = 1.1;
/// They are swung open at this rate, radians per second.
const SWING_RADPS: f64 = 1.8;
/// Slower than this a vehicle stands, and at this speed all doors are closed, m/s.
const STANDING_MPS: f64 = 0.1;
const CLOSED_MPS: f64 = 1.0;

/// One of the doors, or all: each as likely.
fn choice(model: &Model, draw: &mut Stream) -> [bool; 4] {
    let doors = usize::from(model.doors);
    let chosen = draw.index(doors + 1).unwrap_or(doors);
    std::array::from_fn(|door| door < doors && (chosen == door || chosen == doors))
}

/// The doors of a vehicle that is left with some of them open, radians.
pub(crate) fn left_open(model: &Model, draw: &mut Stream) -> [f32; 4] {
    let open = choice(model, draw);
    open.map(|open| if open && model.doors > 0 { OPEN_RAD as f32 } else { 0.0 })
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    /// Nobody has thought of getting out at this stop yet.
    Closed,
    /// At this stop nobody gets out.
    Stays,
    /// These are open or about to be.
    Open([bool; 4]),
}

/// The doors of a vehicle in traffic: at every stop one of them, or all, may open; they close when the
/// vehicle drives off.
#[derive(Clone, Debug)]
pub(crate) struct Doors {
    model: &'static Model,
    /// That somebody does so at a stop.
    chance: f64,
    draw: Stream,
    state: State,
    angle_rad: f64,
}

impl Doors {
    pub(crate) fn new(model: &'static Model, chance: f64, draw: Stream) -> Self {
        let chance = if model.doors == 0 { 0.0 } else { chance };
        Self { model, chance, draw, state: State::Closed, angle_rad: 0.0 }
    }

    /// One step of time at a speed.
    pub(crate) fn step(&mut self, speed_mps: f64) {
        if self.chance == 0.0 {
            return;
        }
        if speed_mps >= CLOSED_MPS {
            self.state = State::Closed;
        } else if speed_mps < STANDING_MPS && self.state == State::Closed {
            let opens = self.draw.chance(self.chance);
            self.state = if opens { State::Open(choice(self.model, &mut self.draw)) } else { State::Stays };
        }
        let swung = self.angle_rad + SWING_RADPS * FRAME_PERIOD_S;
        self.angle_rad = match self.state {
            State::Open(_) => swung.min(OPEN_RAD * (1.0 - speed_mps / CLOSED_MPS)).max(0.0),
            _ => 0.0,
        };
    }

    /// How far each stands open, radians.
    pub(crate) fn angles_rad(&self) -> [f32; 4] {
        match self.state {
            State::Open(which) => which.map(|open| if open { self.angle_rad as f32 } else { 0.0 }),
            _ => [0.0; 4],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use catalogue::models;

    fn doors(name: &str, chance: f64, entity: u64) -> Doors {
        Doors::new(models::find(name).expect("a model"), chance, Stream::new(5, 0, "test/doors", entity))
    }

    #[test]
    fn there_is_one_trial_at_each_stop() {
        let (mut opened, mut kinds) = (0, [0; 5]);
        for entity in 0..4000 {
            let mut doors = doors("car.sedan", 0.1, entity);
            for _ in 0..200 {
                doors.step(0.0);
            }
            let open = doors.angles_rad().map(|a| a > 0.0);
            opened += usize::from(open.contains(&true));
            match open.iter().filter(|o| **o).count() {
                0 => {}
                1 => kinds[open.iter().position(|o| *o).expect("one")] += 1,
                4 => kinds[4] += 1,
                other => panic!("{other} doors are open"),
            }
            assert!(doors.angles_rad().iter().all(|a| *a == 0.0 || (*a - 1.1).abs() < 1e-6));
        }
        // Four standard errors: 4000 trials at 10 %, some 400 at a fifth each.
        assert!((324..=476).contains(&opened), "{opened}");
        assert!(kinds.iter().all(|k| (45..=115).contains(k)), "{kinds:?}");
    }

    #[test]
    fn doors_swing_and_are_closed_at_a_metre_a_second() {
        let mut doors = doors("car.suv", 1.0, 1);
        let most = |d: &Doors| d.angles_rad().into_iter().fold(0.0, f32::max);
        let mut before = 0.0;
        for _ in 0..30 {
            doors.step(0.0);
            assert!(most(&doors) >= before && most(&doors) - before < 0.1);
            before = most(&doors);
        }
        assert!((before - 1.1).abs() < 1e-6);
        for k in 0..=20 {
            doors.step(0.06 * f64::from(k));
            assert!(most(&doors) <= before);
            before = most(&doors);
            assert!(k < 17 || before == 0.0, "{before}");
        }
        // The next stop is another chance.
        doors.step(0.0);
        assert!(most(&doors) > 0.0);
    }

    #[test]
    fn trucks_and_agents_keep_theirs_closed() {
        for (name, chance) in [("truck.box", 1.0), ("bicycle.city", 1.0), ("car.sedan", 0.0)] {
            let mut doors = doors(name, chance, 1);
            (0..100).for_each(|_| doors.step(0.0));
            assert_eq!(doors.angles_rad(), [0.0; 4]);
        }
        let mut draw = Stream::new(5, 0, "test/doors", 0);
        let open = |name: &str, draw: &mut Stream| left_open(models::find(name).expect("a model"), draw);
        for _ in 0..40 {
            assert_eq!(open("bus.city", &mut draw), [0.0; 4]);
            let [front_left, front_right, rear @ ..] = open("car.coupe", &mut draw);
            assert!(rear == [0.0; 2] && front_left + front_right > 0.0);
        }
    }
}
