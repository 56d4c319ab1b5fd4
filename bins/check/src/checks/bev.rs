//! Bird's-eye-view masks against boxes, returns and hazard areas.

use schema::{BevClass, Tag};

use super::boxes::{AROUND_M, DOOR_M, Labelled};
use super::clouds::{Cloud, OfSurface, SIGMAS};
use super::layers::Layers;
use super::mapped::Mapped;
use crate::files::{Npz, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::Scene;
use crate::space::{Motion, sub};

/// Boxes whose bottom is this near to the agent's own height stand on its ground, m...
const LEVEL_M: f64 = 1.0;
/// ...if they are no farther than this, m.
const PRESENT_M: f64 = 40.0;
/// Returns from the ground are looked at within this distance and height, m: beyond, the way may lead elsewhere.
const GROUND_M: [f64; 2] = [60.0, 1.0];
/// Returns may lie so many cells off a cell of their class.
const GROUND_CELLS: f64 = 1.5;

/// The masks of an agent.
pub(crate) struct Masks {
    archive: Npz,
    /// What there is beside them.
    layers: Layers,
    cells: usize,
    cell_m: f64,
    /// The rule that they follow, when it is not ours.
    foreign: Option<String>,
}

/// The mask of a frame, and where it lies.
pub(super) struct Mask<'a> {
    masks: &'a Masks,
    bits: Vec<u8>,
    /// The agent's place, and its heading as cosine and sine.
    origin: [f64; 2],
    heading: [f64; 2],
}

impl Masks {
    pub(crate) fn new(
        archive: Npz,
        layers: Layers,
        (cells, cell_m): (usize, f64),
        foreign: Option<&str>,
    ) -> Self {
        Self { archive, layers, cells, cell_m, foreign: foreign.map(str::to_owned) }
    }

    /// Checks the mask of a frame.
    pub(crate) fn check(
        &self,
        scene: &Scene,
        frame: usize,
        agent: &Motion,
        (boxes, clouds): (&[Labelled], &[Cloud<'_>]),
        ledger: &mut Ledger,
    ) {
        let shape = [BevClass::COUNT, self.cells, self.cells];
        let read = self.archive.frame(frame as u32).and_then(|array| {
            if array.shape == shape && array.descr == "|b1" && array.bytes.iter().all(|&bit| bit < 2) {
                Ok(array)
            } else {
                Err(Unreadable(format!("frame {frame}: a mask is {:?} of {}", array.shape, array.descr)))
            }
        });
        let Some(array) = ledger.read(read) else { return };
        let ahead = agent.ahead();
        let length = libm::hypot(ahead[0], ahead[1]);
        let mask = Mask {
            masks: self,
            bits: array.bytes,
            origin: [agent.origin[0], agent.origin[1]],
            heading: [ahead[0] / length, ahead[1] / length],
        };
        ledger.shares.bev_grids += 1;
        for class in BevClass::ALL {
            let cells = mask.channel(class).iter().map(|&bit| u64::from(bit)).sum::<u64>();
            ledger.shares.bev_cells[class as usize] += cells;
        }
        mask.check_objects(boxes, agent, frame, ledger);
        mask.check_hazards(scene, frame, ledger);
        let mapped = scene.map.as_ref().map(|map| Mapped::of(map, &mask, agent));
        if let Some(rule) = &self.foreign {
            for checked in [Rule::BevGround, Rule::BevMapped, Rule::BevStray] {
                ledger.skip(checked, format!("masks follow the rule {rule:?}"));
            }
        } else {
            mask.check_ground(clouds, agent, frame, ledger);
            if let Some(mapped) = &mapped {
                mapped.check(&mask, frame, ledger);
            }
        }
        self.layers.check(scene, &mask, (agent, mapped.as_ref()), (boxes, clouds), frame, ledger);
    }
}

/// The tag of what an object channel shows.
pub(super) fn tag_of(class: BevClass) -> Option<Tag> {
    use BevClass::*;
    Some(match class {
        Road | Hazard | RoadLine | Sidewalk | Crosswalk => return None,
        TrafficCone => Tag::TrafficCone,
        Barrier => Tag::Barrier,
        Car => Tag::Car,
        Truck => Tag::Truck,
        Bus => Tag::Bus,
        Motorcycle => Tag::Motorcycle,
        Bicycle => Tag::Bicycle,
        Rider => Tag::Rider,
        Pedestrian => Tag::Pedestrian,
    })
}

impl Mask<'_> {
    /// Cells along a side.
    pub(super) fn cells(&self) -> usize {
        self.masks.cells
    }

    pub(super) fn cell_m(&self) -> f64 {
        self.masks.cell_m
    }

    /// Whether it follows our rule.
    pub(super) fn is_exact(&self) -> bool {
        self.masks.foreign.is_none()
    }

    /// Whether a cell has all its neighbours.
    pub(super) fn is_inner(&self, cell: usize) -> bool {
        let last = self.masks.cells - 1;
        [cell / self.masks.cells, cell % self.masks.cells].iter().all(|&at| at > 0 && at < last)
    }

    pub(super) fn channel(&self, class: BevClass) -> &[u8] {
        let cells = self.masks.cells * self.masks.cells;
        &self.bits[class as usize * cells..][..cells]
    }

    /// Row and column of a world point, in cells from the first one's middle.
    pub(super) fn place(&self, x: f64, y: f64) -> [f64; 2] {
        let (x, y) = (x - self.origin[0], y - self.origin[1]);
        let [cos, sin] = self.heading;
        let (ahead, left) = (cos * x + sin * y, cos * y - sin * x);
        let middle = 0.5 * self.masks.cells as f64 - 0.5;
        [middle - ahead / self.masks.cell_m, middle - left / self.masks.cell_m]
    }

    /// Cells whose centre is within some cells of a polygon in the grid.
    pub(super) fn near(&self, polygon: &[[f64; 2]], cells: f64) -> Vec<usize> {
        let last = self.masks.cells as f64 - 1.0;
        let ends = |axis: usize| {
            let values = || polygon.iter().map(|p| p[axis]);
            let low = values().fold(f64::INFINITY, f64::min) - cells;
            let high = values().fold(f64::NEG_INFINITY, f64::max) + cells;
            (low.ceil().max(0.0), high.floor().min(last))
        };
        let ((top, bottom), (left, right)) = (ends(0), ends(1));
        let mut found = Vec::new();
        let mut row = top;
        while row <= bottom {
            let mut column = left;
            while column <= right {
                if distance(polygon, [row, column]) <= cells {
                    found.push(row as usize * self.masks.cells + column as usize);
                }
                column += 1.0;
            }
            row += 1.0;
        }
        found
    }

    pub(super) fn footprint(&self, labelled: &Labelled) -> [[f64; 2]; 4] {
        labelled.footprint().map(|[x, y]| self.place(x, y))
    }

    fn check_objects(&self, boxes: &[Labelled], agent: &Motion, frame: usize, ledger: &mut Ledger) {
        let size = self.masks.cells as f64;
        for class in BevClass::ALL {
            let Some(tag) = tag_of(class) else { continue };
            if class == BevClass::Rider && self.masks.foreign.is_some() {
                ledger.skip(Rule::BevObjects, "rider: by the masks' rule cones are among them");
                continue;
            }
            let set = self.channel(class);
            let mut allowed = vec![false; set.len()];
            for labelled in boxes.iter().filter(|b| b.tags.contains(&(tag as u8))) {
                let footprint = self.footprint(labelled);
                let doors = if labelled.open_door { DOOR_M } else { 0.0 };
                // Elbows and handlebars may reach over a box.
                let around = 0.7072 + (AROUND_M + doors) / self.masks.cell_m;
                for cell in self.near(&footprint, around) {
                    allowed[cell] = true;
                }
                let is_whole = footprint.iter().flatten().all(|&c| c >= 1.0 && c <= size - 2.0);
                let height = (labelled.corners[0][2] - agent.origin[2]).abs();
                if is_whole && height < LEVEL_M && labelled.distance_m < PRESENT_M {
                    let is_there = self.near(&footprint, 1.0).iter().any(|&cell| set[cell] == 1);
                    ledger.expect(Rule::BevPresent, is_there, || {
                        format!(
                            "frame {frame}: object {} ({}) has no {} cell at {:?}",
                            labelled.id,
                            labelled.class.name(),
                            class.name(),
                            footprint[0].map(f64::round)
                        )
                    });
                }
            }
            let stray: Vec<usize> = (0..set.len()).filter(|&cell| set[cell] == 1 && !allowed[cell]).collect();
            ledger.fine(
                Rule::BevObjects,
                set.iter().map(|&bit| u64::from(bit)).sum::<u64>() - stray.len() as u64,
            );
            ledger.all_off(Rule::BevObjects, stray.len() as u64, "", || {
                let first = stray.first().copied().unwrap_or(0);
                let place = [first / self.masks.cells, first % self.masks.cells];
                format!(
                    "frame {frame}: {} {} cells lie in no box, the first at {place:?}",
                    stray.len(),
                    class.name()
                )
            });
        }
    }

    fn check_hazards(&self, scene: &Scene, frame: usize, ledger: &mut Ledger) {
        let set = self.channel(BevClass::Hazard);
        let mut allowed = vec![false; set.len()];
        for hazard in scene.facts["hazards"].as_array().into_iter().flatten() {
            let corners = hazard["area_m"].as_array().into_iter().flatten();
            let corners =
                corners.map(|p| self.place(p[0].as_f64().unwrap_or(0.0), p[1].as_f64().unwrap_or(0.0)));
            for cell in self.near(&corners.collect::<Vec<_>>(), 1.0) {
                allowed[cell] = true;
            }
        }
        let stray = (0..set.len()).filter(|&cell| set[cell] == 1 && !allowed[cell]).count() as u64;
        ledger.fine(Rule::BevHazard, set.iter().map(|&bit| u64::from(bit)).sum::<u64>() - stray);
        ledger.all_off(Rule::BevHazard, stray, "", || {
            format!("frame {frame}: {stray} hazard cells lie in no area")
        });
    }

    fn check_ground(&self, clouds: &[Cloud<'_>], agent: &Motion, frame: usize, ledger: &mut Ledger) {
        let size = self.masks.cells as f64;
        for cloud in clouds {
            let reach = GROUND_CELLS + SIGMAS * cloud.ranger.noise_m / self.masks.cell_m;
            for OfSurface { point, tag, around_m, .. } in cloud.surfaces() {
                let reach = reach + around_m / self.masks.cell_m;
                let class = match Tag::from_u8(tag) {
                    Some(Tag::Road | Tag::RoadLine) => BevClass::Road,
                    Some(Tag::Sidewalk) => BevClass::Sidewalk,
                    _ => continue,
                };
                let way = sub(point, agent.origin);
                let [row, column] = self.place(point[0], point[1]);
                let is_inside = [row, column].iter().all(|&c| c >= reach && c < size - 1.0 - reach);
                if libm::hypot(way[0], way[1]) > GROUND_M[0] || way[2].abs() > GROUND_M[1] || !is_inside {
                    continue;
                }
                let holds = self.is_near(self.channel(class), [row, column], reach);
                ledger.expect(Rule::BevGround, holds, || {
                    let place = [row, column].map(|c| c.round());
                    format!(
                        "frame {frame}: a return of {} with tag {tag} lies off the {} at {place:?}",
                        cloud.ranger.name,
                        class.name()
                    )
                });
            }
        }
    }

    /// Whether a cell that is set has its centre within some cells of a place.
    fn is_near(&self, set: &[u8], [row, column]: [f64; 2], cells: f64) -> bool {
        let (first, last) = ((row - cells).ceil() as usize, (row + cells) as usize);
        (first..=last).any(|r| {
            let (left, right) = ((column - cells).ceil() as usize, (column + cells) as usize);
            (left..=right).any(|c| {
                set[r * self.masks.cells + c] == 1 && libm::hypot(r as f64 - row, c as f64 - column) <= cells
            })
        })
    }
}

/// Distance of a point from a polygon, 0 inside.
fn distance(polygon: &[[f64; 2]], [x, y]: [f64; 2]) -> f64 {
    let mut is_inside = false;
    let mut least = f64::INFINITY;
    for (k, &[bx, by]) in polygon.iter().enumerate() {
        let [ax, ay] = polygon[(k + polygon.len() - 1) % polygon.len()];
        if (ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax) {
            is_inside = !is_inside;
        }
        let (ex, ey) = (bx - ax, by - ay);
        let length = ex * ex + ey * ey;
        let share =
            if length > 0.0 { (((x - ax) * ex + (y - ay) * ey) / length).clamp(0.0, 1.0) } else { 0.0 };
        least = least.min(libm::hypot(ax + share * ex - x, ay + share * ey - y));
    }
    if is_inside { 0.0 } else { least }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_of_a_square() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        for (point, want) in
            [([1.0, 1.0], 0.0), ([3.0, 1.0], 1.0), ([3.0, 3.0], 2.0_f64.sqrt()), ([-0.5, 0.2], 0.5)]
        {
            assert!((distance(&square, point) - want).abs() < 1e-12, "{point:?}");
        }
        assert_eq!(distance(&[], [0.0, 0.0]), f64::INFINITY);
    }
}
