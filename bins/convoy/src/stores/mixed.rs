//! Plans of unlike stores become one: each scene keeps the settings that it was made by.

use serde_json::{Value, json};
use store::{Attempt, Scope, Store, StoreError, keys};

use runner::Graph;

use super::member::{Fault, Member};

/// Adds the scenes of other stores that are in no plan here, with their editions and maps. The planner does
/// the rest: it plans every scene by its edition, which gives what its store had.
pub(super) fn enrol(here: &Member, others: &[Member]) -> Result<(), Fault> {
    let mut editions = here.editions.clone();
    let mut slots = slots_of(&here.store)?;
    let mut is_changed = false;
    for other in others {
        let begun = other.scenes()?;
        for mut slot in slots_of(&other.store)? {
            let Some(scene) = slot["scene"].as_u64().and_then(|n| u32::try_from(n).ok()) else { continue };
            let is_here = slots.iter().any(|known| known["scene"] == slot["scene"]);
            if is_here || !begun.contains(&scene) || other.planned(scene).is_none() {
                continue;
            }
            let kind = other.kinds.get(&scene).cloned().unwrap_or_default();
            let Some(edition) = other.editions.get(kind.edition as usize) else { continue };
            slot["edition"] = json!(place_of(edition, &mut editions));
            take_map(here, other, &slot)?;
            slots.push(slot);
            is_changed = true;
        }
    }
    if !is_changed {
        return Ok(());
    }
    slots.sort_by_key(|slot| slot["scene"].as_u64());
    let mut dataset: Value = here.store.read_json(keys::DATASET)?.unwrap_or_default();
    dataset["config"] = editions.last().cloned().unwrap_or_default();
    dataset["editions"] = json!(editions);
    amend(&here.store, keys::ROSTER, &json!(slots))?;
    amend(&here.store, keys::DATASET, &dataset)
}

fn slots_of(store: &Store) -> Result<Vec<Value>, StoreError> {
    Ok(store.read_json(keys::ROSTER)?.unwrap_or_default())
}

/// The number of an edition among others; it is added where none has its rules.
fn place_of(edition: &Value, editions: &mut Vec<Value>) -> usize {
    let rules = runner::rules_of_record(edition);
    let known = editions.iter().position(|known| runner::rules_of_record(known) == rules);
    known.unwrap_or_else(|| {
        editions.push(edition.clone());
        editions.len() - 1
    })
}

/// Takes the map that a scene stands on, where there is none of its name.
fn take_map(here: &Member, other: &Member, slot: &Value) -> Result<(), Fault> {
    let key = keys::map(slot["map"].as_str().unwrap_or_default());
    let (ours, theirs) = (here.plan.output(&key), other.plan.output(&key));
    match (ours, theirs) {
        (Some(ours), Some(theirs)) if ours.blake3 != theirs.blake3 => Err(Fault::Refused(format!(
            "{}: {key} is another map than in {}: rename one of the files",
            other.store.location(""),
            here.store.location("")
        ))),
        (None, Some(_)) => {
            let text = other.store.read(&key)?.unwrap_or_default();
            Ok(Attempt::amend(&here.store, Scope::Plan, Graph::get().planner().name, &key, &text)?)
        }
        _ => Ok(()),
    }
}

fn amend(store: &Store, key: &str, value: &Value) -> Result<(), Fault> {
    let mut text = value.to_string().into_bytes();
    text.push(b'\n');
    Ok(Attempt::amend(store, Scope::Plan, Graph::get().planner().name, key, &text)?)
}
