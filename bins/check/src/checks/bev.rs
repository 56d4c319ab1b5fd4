//! Bird's-eye-view masks against boxes, returns and hazard areas.

use schema::{BevClass, Tag};

use super::boxes::{AROUND_M, DOOR_M, Labelled};
use super::clouds::{Cloud, OfSurface, SIGMAS};
use super::layers::Layers;
use super::mapped::Mapped;
use super::mask::{Mask, tag_of};
use crate::files::{Npz, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::Scene;
use crate::space::{Motion, sub};

/// Boxes whose bottom is this near to the agent's own height stand on its ground, m...
const LEVEL_M: f64 = 1.0;
/// ...if they are no farther than this, m.
const PRESENT_M: f64 = 40.0;
/// Returns from the ground are looked at within this distance and height, m: beyond, the way may lead
/// elsewhere.
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
            bits: array.bytes,
            cells: self.cells,
            cell_m: self.cell_m,
            is_exact: self.foreign.is_none(),
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

impl Mask {
    fn check_objects(&self, boxes: &[Labelled], agent: &Motion, frame: usize, ledger: &mut Ledger) {
        let size = self.cells as f64;
        for class in BevClass::ALL {
            let Some(tag) = tag_of(class) else { continue };
            if class == BevClass::Rider && !self.is_exact {
                ledger.skip(Rule::BevObjects, "rider: by the masks' rule cones are among them");
                continue;
            }
            let set = self.channel(class);
            let mut allowed = vec![false; set.len()];
            for labelled in boxes.iter().filter(|b| b.tags.contains(&(tag as u8))) {
                let footprint = self.footprint(labelled);
                let doors = if labelled.open_door { DOOR_M } else { 0.0 };
                // Elbows and handlebars may reach over a box.
                let around = 0.7072 + (AROUND_M + doors) / self.cell_m;
                for cell in self.near(&self.outline(labelled), around) {
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
                let place = [first / self.cells, first % self.cells];
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
        let size = self.cells as f64;
        for cloud in clouds {
            let reach = GROUND_CELLS + SIGMAS * cloud.ranger.noise_m / self.cell_m;
            for OfSurface { point, tag, around_m, .. } in cloud.surfaces() {
                let reach = reach + around_m / self.cell_m;
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
}
