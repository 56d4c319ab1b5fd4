//! Joining stores of one plan that were made in several places.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use runner::{
    EXIT_DONE, EXIT_SOME_FAILED, EXIT_TRY_AGAIN, EXIT_USAGE, Graph, SceneList, StageSpec, UnitKind, say,
    was_stopped,
};
use schema::scene_info::LOG_STAGE;
use schema::tables::{SceneTileRow, TILE_STAGE};
use schema::tile::TileIndex;
use store::{Attempt, Manifest, Scope, Store, StoreError, keys};

use super::member::{Fault, Member};
use super::mixed;

/// What was taken over.
#[derive(Default)]
struct Taken {
    scenes: BTreeSet<u32>,
    stages: usize,
    bytes: u64,
    there: usize,
    /// The folder that was looked at last, and whether there was something unfinished in it.
    looked: Option<(String, bool)>,
}

/// Takes into `place` all that other stores of the same plan have and it has not, of all scenes or some; the
/// exit code. Where they are `mixed`, scenes that are not in its plan are added to it, with the settings that
/// they were made by.
pub(crate) fn merge(place: &Path, others: &[PathBuf], only: Option<&SceneList>, is_mixed: bool) -> u8 {
    runner::listen_for_signals();
    match join(place, others, only, is_mixed) {
        Ok(()) => EXIT_DONE,
        Err(Fault::Refused(why)) => {
            tracing::error!("{why}");
            EXIT_USAGE
        }
        Err(Fault::Store(e)) => {
            tracing::error!("{e}");
            match () {
                () if e.is_usage() => EXIT_USAGE,
                () if e.is_transient() => EXIT_TRY_AGAIN,
                () => EXIT_SOME_FAILED,
            }
        }
        Err(Fault::Lock(e)) => {
            tracing::error!("{}", e.report());
            e.exit_code()
        }
        Err(Fault::Stopped) => {
            tracing::warn!("stopped; run the same command again to go on");
            EXIT_TRY_AGAIN
        }
    }
}

fn join(place: &Path, others: &[PathBuf], only: Option<&SceneList>, is_mixed: bool) -> Result<(), Fault> {
    let open = |other: &PathBuf| {
        let none = || Fault::Refused(format!("{}: holds no plan: is it a store?", other.display()));
        Member::open(other, only)?.ok_or_else(none)
    };
    let others: Vec<Member> = others.iter().map(open).collect::<Result<_, _>>()?;
    if let Some(only) = only {
        let mut known = Vec::new();
        for other in &others {
            known.extend(other.scenes()?);
        }
        if let Some(scene) = only.outside(&known).first() {
            return Err(Fault::Refused(format!(
                "--scenes {only}: nothing is done of scene {scene} in any of them"
            )));
        }
    }
    let _lock = runner::hold_alone(&Store::open(place)?, "convoy merge")?;
    let here = match Member::open(place, None)? {
        Some(here) => here,
        None => {
            // The largest plan has all scenes of the others, or one of them is refused below.
            let largest = others.iter().max_by_key(|other| other.plan.sections.len());
            let Some(largest) = largest else { return Ok(()) };
            let into = Store::open(place)?;
            if into.backend().keys("")?.iter().any(|key| !keys::is_lock(key)) {
                let why = "holds files, but no plan; give an empty folder, or a store of the same plan";
                return Err(Fault::Refused(format!("{}: {why}", place.display())));
            }
            others.iter().try_for_each(|other| fits(largest, other, is_mixed))?;
            into.adopt(&largest.store, Scope::Plan, &largest.plan)?;
            Member { store: into, name: place.display().to_string(), only: None, ..largest.clone() }
        }
    };
    // All that speaks against it is said before anything is copied.
    let mut offers = Vec::new();
    for other in &others {
        fits(&here, other, is_mixed)?;
        let offered = stages(other)?;
        for (scope, manifest) in &offered {
            let stands = here.store.manifest(*scope, &manifest.stage)?;
            if stands.is_some_and(|stands| stands.digest() != manifest.digest()) {
                return Err(Fault::Refused(format!(
                    "{}: {} of {} is another than in {}: remove one of the two",
                    other.name,
                    manifest.stage,
                    scope.folder(),
                    here.name
                )));
            }
        }
        offers.push((other, offered));
    }
    for (other, offered) in offers {
        let mut taken = Taken::default();
        for (scope, manifest) in offered {
            take(&here.store, &other.store, scope, &manifest, &mut taken)?;
        }
        say(&format!(
            "{}: {} stages of {} scenes taken, {:.1} MB; {} were there",
            other.name,
            taken.stages,
            taken.scenes.len(),
            taken.bytes as f64 / 1e6,
            taken.there
        ));
    }
    if is_mixed {
        mixed::enrol(&here, &others)?;
        say(
            "scenes of several editions: plan and statistics are made anew by `convoy run` with the configuration of any",
        );
    } else {
        say("statistics are of all scenes: make them anew (convoy run)");
    }
    Ok(())
}

/// Refuses a store whose scenes are made by other settings or planned otherwise. Where stores are mixed, this
/// holds for scenes that both have.
fn fits(here: &Member, other: &Member, is_mixed: bool) -> Result<(), Fault> {
    for scene in other.scenes()? {
        let (there, ours) = (other.planned(scene), here.planned(scene));
        if is_mixed && ours.is_none() && there.is_some() {
            continue;
        }
        // The rules of a scene that is not planned here are nobody's.
        let changes = settings::key_changes(&here.rules(scene), &other.rules(scene));
        if let Some(change) = changes.first().filter(|_| ours.is_some()) {
            let (here, other) = (&here.name, &other.name);
            return Err(Fault::Refused(format!(
                "{here} and {other} have different settings (scene {scene}): {change}"
            )));
        }
        if there.is_none() || there != ours {
            let what = if ours.is_none() { "not planned" } else { "planned otherwise" };
            let advice =
                "stores are joined whose scenes come from one plan; expand that plan first, or --mixed";
            return Err(Fault::Refused(format!(
                "{}: its scene {scene} is {what} in {} ({advice})",
                other.name, here.name
            )));
        }
    }
    Ok(())
}

/// All that is done for scenes, in running order: what others are made from first.
fn stages(member: &Member) -> Result<Vec<(Scope, Manifest)>, StoreError> {
    let mut found = Vec::new();
    for scene in member.scenes()? {
        let of_scenes = |stage: &&StageSpec| stage.unit == UnitKind::Scene;
        for stage in Graph::get().stages.iter().filter(of_scenes) {
            let scope = Scope::Scene(scene);
            found.extend(member.store.manifest(scope, stage.name)?.map(|manifest| (scope, manifest)));
        }
    }
    Ok(found)
}

fn take(
    here: &Store,
    other: &Store,
    scope: Scope,
    manifest: &Manifest,
    taken: &mut Taken,
) -> Result<(), Fault> {
    if was_stopped() {
        return Err(Fault::Stopped);
    }
    if here.manifest(scope, &manifest.stage)?.is_some() && here.outputs_present(manifest)? {
        taken.clear(here, scope, &manifest.stage)?;
        taken.there += 1;
        return Ok(());
    }
    if manifest.stage == LOG_STAGE {
        take_tiles(here, other, scope, manifest, taken)?;
    }
    taken.bytes += here.adopt(other, scope, manifest)?;
    taken.stages += 1;
    if let Scope::Scene(scene) = scope {
        taken.scenes.insert(scene);
    }
    Ok(())
}

impl Taken {
    /// Removes what a merge left that was killed right after it had put a manifest.
    fn clear(&mut self, here: &Store, scope: Scope, stage: &str) -> Result<(), StoreError> {
        let folder = scope.folder();
        let has_unfinished = match &self.looked {
            Some((looked, found)) if *looked == folder => *found,
            _ => here.backend().lists_unfinished() && here.backend().list(&folder)?.has_unfinished,
        };
        self.looked = Some((folder, has_unfinished));
        if has_unfinished {
            Attempt::tidy(here, scope, stage)?;
        }
        Ok(())
    }
}

/// Takes the tiles of the static world that a scene's log names.
fn take_tiles(
    here: &Store,
    other: &Store,
    scope: Scope,
    log: &Manifest,
    taken: &mut Taken,
) -> Result<(), Fault> {
    let Scope::Scene(scene) = scope else { return Ok(()) };
    let table = keys::table::<SceneTileRow>(scene);
    for tile in other.read_rows::<SceneTileRow>(log, &table)? {
        let index = TileIndex { x: tile.x, y: tile.y };
        let path = || other.location(&table);
        let corrupt = |problem: &str| StoreError::Corrupt { path: path(), problem: problem.into() };
        let set = u64::from_str_radix(&tile.set, 16).map_err(|_| corrupt("names no set of tiles"))?;
        let scope = Scope::Tile { set, index };
        let of = |store: &Store| store.manifest(scope, TILE_STAGE);
        let Some(manifest) = of(other)?.filter(|manifest| manifest.digest() == tile.digest) else {
            return Err(corrupt("names a tile that is not there").into());
        };
        match of(here)? {
            Some(stands) if stands.digest() == tile.digest && here.outputs_present(&stands)? => {
                taken.clear(here, scope, TILE_STAGE)?;
            }
            Some(stands) if stands.digest() != tile.digest => {
                let why = format!("{} is another tile than in {}", scope.folder(), other.location(""));
                return Err(Fault::Refused(format!("{}: {why}", here.location(""))));
            }
            _ => taken.bytes += here.adopt(other, scope, &manifest)?,
        }
    }
    Ok(())
}
