//! Maps of static objects, kept over frames and agents.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use render::{RenderError, Renderer};
use schema::geometry::{Instance, Snapshot};
use schema::{ObjectId, Tag};

use super::lens::{ASIDE_M, Lens, LensKey, Window, depths};
use super::map::{Map, Still};
use super::walls::Walls;

/// Maps kept at most: some 5 MiB each.
const MOST_MAPS: usize = 16;
/// What houses leave of the sky is kept for so many places at most, 3 MiB each.
const MOST_WALLS: usize = 24;

/// What never moves in a scene.
pub trait StillWorld: Send + Sync {
    /// Static objects within a distance of a place: as far as a scene's snapshots reach around an agent,
    /// less `nearer_m`; all as detailed as they are at `detail_m` from an agent. The answer follows from
    /// these numbers alone.
    fn around(&self, centre_world_m: [f64; 3], nearer_m: f64, detail_m: f64) -> Snapshot;

    /// Whether an object of a snapshot may move.
    fn moves(&self, object: ObjectId) -> bool;
}

impl std::fmt::Debug for StillMaps<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StillMaps").finish_non_exhaustive()
    }
}

/// Makes maps of static objects, one for all cameras in a lens's cell.
pub(crate) struct StillMaps<'a> {
    renderer: &'a dyn Renderer,
    world: &'a dyn StillWorld,
    kept: Mutex<Kept>,
    walls: Mutex<BTreeMap<LensKey, Arc<Walls>>>,
}

#[derive(Default)]
struct Kept {
    maps: BTreeMap<LensKey, Slot>,
    /// Counts askings.
    clock: u64,
}

enum Slot {
    /// Somebody is at it.
    Begun,
    Made {
        map: Arc<Still>,
        /// When it was last asked for.
        asked: u64,
    },
}

impl<'a> StillMaps<'a> {
    /// Maps of a world, seen through a renderer that has its meshes.
    pub(crate) fn new(renderer: &'a dyn Renderer, world: &'a dyn StillWorld) -> Self {
        Self { renderer, world, kept: Mutex::default(), walls: Mutex::default() }
    }

    /// Numbers of a snapshot's instances that may move, ascending.
    pub(crate) fn moving(&self, snapshot: &Snapshot) -> Vec<u32> {
        let instances = (0..).zip(&snapshot.instances);
        instances.filter(|(_, i)| self.world.moves(i.object)).map(|(number, _)| number).collect()
    }

    /// The maps of some lenses, in their order.
    ///
    /// Which thread makes a map changes nothing in it. Threads that want the same maps at once share the
    /// work: each makes what none has begun, and only then what another has not finished (to wait for it
    /// could wait for oneself).
    ///
    /// # Errors
    /// The renderer failed.
    pub(super) fn of(&self, lenses: &[Lens]) -> Result<Vec<Arc<Still>>, RenderError> {
        let mut found: Vec<Option<Arc<Still>>> = vec![None; lenses.len()];
        while let Some(next) = self.next(lenses, &mut found) {
            let made = self.make(&lenses[next]);
            let mut kept = self.kept();
            match made {
                Ok(map) => {
                    let map = Arc::new(map);
                    found[next] = Some(Arc::clone(&map));
                    let asked = kept.clock;
                    kept.maps.insert(lenses[next].key, Slot::Made { map, asked });
                    kept.trim();
                }
                Err(error) => {
                    kept.maps.remove(&lenses[next].key);
                    return Err(error);
                }
            }
        }
        Ok(found.into_iter().flatten().collect())
    }

    /// Takes what is made, and says which lens to make the map of next; none when all are there.
    fn next(&self, lenses: &[Lens], found: &mut [Option<Arc<Still>>]) -> Option<usize> {
        let mut kept = self.kept();
        kept.clock += 1;
        let clock = kept.clock;
        let mut elsewhere = None;
        let mut free = None;
        for (i, lens) in lenses.iter().enumerate().filter(|(i, _)| found[*i].is_none()).collect::<Vec<_>>() {
            match kept.maps.get_mut(&lens.key) {
                Some(Slot::Made { map, asked }) => {
                    *asked = clock;
                    found[i] = Some(Arc::clone(map));
                }
                Some(Slot::Begun) => elsewhere = Some(i),
                None => free = Some(i),
            }
        }
        if let Some(i) = free {
            kept.maps.insert(lenses[i].key, Slot::Begun);
        }
        free.or(elsewhere)
    }

    /// The map of a window of a lens, which nobody will ask for again; of what lies wholly in a finer one
    /// only what reaches out of that by so many of its texels.
    ///
    /// # Errors
    /// The renderer failed.
    pub(super) fn once(
        &self,
        (lens, window): (&Lens, Window),
        finer: Option<(&Lens, Window, f32)>,
    ) -> Result<Still, RenderError> {
        let snapshot = self.world.around(lens.centre_m.to_array(), ASIDE_M, lens.detail_m);
        let camera = lens.camera(&snapshot.origin, window);
        let scene = self.renderer.place(&snapshot)?;
        let all = casters(&snapshot);
        let some = match finer {
            Some((finer, window, inner_px)) => {
                scene.beyond(&finer.camera(&snapshot.origin, window), inner_px, &all)
            }
            None => all,
        };
        let depth_m = depths(&*scene, [(&camera, Some(&some[..]), lens.panes())])?.pop().unwrap_or_default();
        Ok(Map::new(lens, window, &camera, depth_m, None).into_still())
    }

    fn make(&self, lens: &Lens) -> Result<Still, RenderError> {
        let snapshot = self.world.around(lens.centre_m.to_array(), ASIDE_M, lens.detail_m);
        let camera = lens.camera(&snapshot.origin, lens.whole());
        let scene = self.renderer.place(&snapshot)?;
        let all = casters(&snapshot);
        let depth_m = depths(&*scene, [(&camera, Some(&all[..]), lens.panes())])?.pop().unwrap_or_default();
        Ok(Map::new(lens, lens.whole(), &camera, depth_m, None).into_still())
    }

    /// What the houses that stand in a lens's sight leave of the sky.
    ///
    /// # Errors
    /// The renderer failed.
    pub(super) fn walls(&self, lens: &Lens) -> Result<Arc<Walls>, RenderError> {
        let known = |walls: &BTreeMap<LensKey, Arc<Walls>>| walls.get(&lens.key).cloned();
        if let Some(known) = self.walls.lock().ok().and_then(|walls| known(&walls)) {
            return Ok(known);
        }
        // Computed outside the lock: two threads may compute the same maps, with equal results.
        let snapshot = self.world.around(lens.centre_m.to_array(), ASIDE_M, lens.detail_m);
        let made = Arc::new(Walls::new(&*self.renderer.place(&snapshot)?, lens)?);
        if let Ok(mut walls) = self.walls.lock() {
            if walls.len() >= MOST_WALLS {
                walls.clear();
            }
            walls.insert(lens.key, Arc::clone(&made));
        }
        Ok(made)
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        // A thread that panicked inside left a whole entry or none.
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Numbers of the instances that throw shadows. Wires are thinner than the sun is wide; texels would draw
/// them as bars.
fn casters(snapshot: &Snapshot) -> Vec<u32> {
    let is_wire = |i: &Instance| snapshot.mesh(i).parts.iter().all(|part| part.tag == Tag::Other);
    let instances = (0..).zip(&snapshot.instances);
    instances.filter(|(_, i)| !is_wire(i)).map(|(number, _)| number).collect()
}

impl Kept {
    /// Forgets those that nobody asked for the longest.
    fn trim(&mut self) {
        loop {
            let made = self.maps.iter().filter_map(|(key, slot)| match slot {
                Slot::Made { asked, .. } => Some((*asked, *key)),
                Slot::Begun => None,
            });
            if made.clone().count() <= MOST_MAPS {
                return;
            }
            if let Some((_, key)) = made.min() {
                self.maps.remove(&key);
            }
        }
    }
}
