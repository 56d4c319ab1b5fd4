//! A vehicle's claim on junctions: the lanes that are reserved for it, and how long it has waited for more.

/// A reserved junction lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reservation {
    pub(crate) lane: usize,
    /// The vehicle's odometer at the lane's beginning, metres.
    pub(crate) start_m: f64,
    /// Number of the reservation: older ones go first.
    pub(crate) order: u64,
}

/// What a vehicle has reserved, and what it waits for.
#[derive(Debug, Default)]
pub(crate) struct Claim {
    /// Junction lanes that are kept free for it, each once.
    reservations: Vec<Reservation>,
    /// Step at which it came to the line that it waits at.
    waiting_since: Option<u32>,
    /// Steps it has stood still at a stop sign.
    stood_steps: u32,
    /// Steps that it has asked in vain for leave to pass a line.
    refused_steps: u32,
    /// Those it yields to, standing inside a junction, by their indices.
    yields_to: Vec<usize>,
}

impl Claim {
    pub(crate) fn reservations(&self) -> &[Reservation] {
        &self.reservations
    }

    /// Whether nothing is reserved.
    pub(crate) fn is_empty(&self) -> bool {
        self.reservations.is_empty()
    }

    /// The reservation of a lane.
    pub(crate) fn of_lane(&self, lane: usize) -> Option<&Reservation> {
        self.reservations.iter().find(|r| r.lane == lane)
    }

    /// Age of the oldest reservation; lower is older.
    pub(crate) fn oldest(&self) -> Option<u64> {
        self.reservations.iter().map(|r| r.order).min()
    }

    /// Steps that it has been refused.
    pub(crate) fn refused_steps(&self) -> u32 {
        self.refused_steps
    }

    /// Steps that it has stood at a stop sign.
    pub(crate) fn stood_steps(&self) -> u32 {
        self.stood_steps
    }

    /// Those it yields to, standing, by their indices.
    pub(crate) fn yields_to(&self) -> &[usize] {
        &self.yields_to
    }

    /// Adds a reservation; whether the lane was not reserved yet.
    pub(crate) fn reserve(&mut self, reservation: Reservation) -> bool {
        let is_new = self.of_lane(reservation.lane).is_none();
        if is_new {
            self.reservations.push(reservation);
        }
        is_new
    }

    /// Ends the reservations but for those to keep, and names the lanes of those that end.
    pub(crate) fn keep(&mut self, keep: impl Fn(&Reservation) -> bool, mut ended: impl FnMut(usize)) {
        self.reservations.retain(|reservation| {
            let keep = keep(reservation);
            if !keep {
                ended(reservation.lane);
            }
            keep
        });
    }

    /// Makes all reservations at least as old as this.
    pub(crate) fn age(&mut self, order: u64) {
        self.reservations.iter_mut().for_each(|r| r.order = r.order.min(order));
    }

    /// Makes the reservation of a lane at least as old as this, if there is one, and says how old it is then.
    pub(crate) fn age_lane(&mut self, lane: usize, order: u64) -> Option<u64> {
        let reservation = self.reservations.iter_mut().find(|r| r.lane == lane)?;
        reservation.order = reservation.order.min(order);
        Some(reservation.order)
    }

    /// It waits at a line; the step at which it came there.
    pub(crate) fn wait_at_line(&mut self, step: u32) -> u32 {
        *self.waiting_since.get_or_insert(step)
    }

    /// It is not at a line, or not the first one there.
    pub(crate) fn leave_line(&mut self) {
        self.waiting_since = None;
    }

    /// It stands at a stop sign for one more step.
    pub(crate) fn stand_at_sign(&mut self) {
        self.stood_steps += 1;
    }

    /// It has asked in vain once more.
    pub(crate) fn refuse(&mut self) {
        self.refused_steps += 1;
    }

    /// It may pass the line that it waited at, or waits there no longer.
    pub(crate) fn stop_waiting(&mut self) {
        (self.waiting_since, self.stood_steps, self.refused_steps) = (None, 0, 0);
    }

    pub(crate) fn yield_to(&mut self, rivals: Vec<usize>) {
        self.yields_to = rivals;
    }
}
