//! Taking away what no scene needs any more.

use std::collections::BTreeSet;
use std::path::Path;
use std::time::Duration;

use runner::{EXIT_DONE, StageError, hold_alone, say};
use schema::scene_info::LOG_STAGE;
use schema::tables::SceneTileRow;
use store::{Scope, Store, StoreError, Strays, keys, remove_strays};

/// Younger files that no manifest names may be of a process that still writes.
const OLD: Duration = Duration::from_secs(24 * 3600);

/// Removes tiles that no scene's log names, old files that no manifest names, and locks of the dead.
pub(crate) fn tidy(store: &Path) -> u8 {
    runner::listen_for_signals();
    match tidied(store) {
        Ok(((tiles, bytes), strays)) => {
            say(&format!("{tiles} tiles removed, {:.1} MB", bytes as f64 / 1e6));
            let Strays { removed, bytes, left } = strays;
            if removed > 0 {
                say(&format!("{removed} files that no manifest names removed, {:.1} MB", bytes as f64 / 1e6));
            }
            if left > 0 {
                say(&format!(
                    "{left} more are younger than a day, lie in scenes that are not done, or are not ours"
                ));
            }
            EXIT_DONE
        }
        Err(e) => {
            tracing::error!("{}", e.report());
            e.exit_code()
        }
    }
}

fn tidied(store: &Path) -> Result<((usize, u64), Strays), StageError> {
    let store = Store::open_made(store)?;
    // A simulation that runs may name tiles in a log that is not there yet.
    let _lock = hold_alone(&store, "convoy tidy")?;
    store::remove_probes(&store)?;
    Ok((remove_unused(&store)?, remove_strays(&store, OLD)?))
}

/// How many tiles were removed, and their bytes.
fn remove_unused(store: &Store) -> Result<(usize, u64), StoreError> {
    let manifest_name = format!("/_manifests/{LOG_STAGE}.json");
    let mut used = BTreeSet::new();
    for key in store.backend().keys("scenes")? {
        let number = key.strip_prefix("scenes/").and_then(|rest| rest.strip_suffix(&manifest_name));
        let Some(scene) = number.and_then(|number| number.parse().ok()) else { continue };
        let Some(manifest) = store.manifest(Scope::Scene(scene), LOG_STAGE)? else { continue };
        let table = keys::table::<SceneTileRow>(scene);
        // Logs of older code know no tiles.
        if manifest.output(&table).is_some() {
            let rows: Vec<SceneTileRow> = store.read_rows(&manifest, &table)?;
            used.extend(rows.into_iter().map(|tile| format!("tiles/{}/{}_{}", tile.set, tile.x, tile.y)));
        }
    }
    let (mut tiles, mut bytes) = (BTreeSet::new(), 0);
    for key in store.backend().keys("tiles")? {
        let folder: Vec<&str> = key.split('/').take(3).collect();
        let folder = folder.join("/");
        if !used.contains(&folder) {
            bytes += store.backend().size(&key)?.unwrap_or(0);
            store.backend().remove(&key)?;
            tiles.insert(folder);
        }
    }
    Ok((tiles.len(), bytes))
}
