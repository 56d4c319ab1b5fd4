//! What was imported from another layout: it is never stale, and cannot be made again.

use schema::scene_info::LOG_STAGE;
use store::{Manifest, Scope, Store, StoreError};

use crate::graph::{StageSpec, UnitKind};

/// Whether a manifest stands for what was imported: no configuration, code or input of ours went into it that
/// could change.
pub(crate) fn is_imported(manifest: &Manifest) -> bool {
    schema::is_imported(&manifest.code_version)
}

/// Why a stage cannot be made of some scopes: they were imported, and it needs the log that is not there.
/// What `is_kept` is not touched, and counts for nothing.
///
/// # Errors
/// The store cannot be read.
pub(crate) fn refusal<E: From<StoreError>>(
    store: &Store,
    spec: &StageSpec,
    scopes: &[Scope],
    is_kept: impl Fn(Scope) -> Result<bool, E>,
) -> Result<Option<String>, E> {
    if !spec.needs_log {
        return Ok(None);
    }
    // A plan has been imported itself, a scene with its log.
    let origin = if spec.unit == UnitKind::Plan { spec.name } else { LOG_STAGE };
    let mut refused = Vec::new();
    for &scope in scopes {
        if store.manifest(scope, origin)?.is_some_and(|manifest| is_imported(&manifest)) && !is_kept(scope)? {
            refused.push(match scope {
                Scope::Scene(scene) => format!("scene {scene}"),
                Scope::Plan | Scope::Tile { .. } | Scope::Stats => "the plan".to_owned(),
            });
        }
    }
    let (what, name) = (refused.join(", "), spec.name);
    Ok((!refused.is_empty())
        .then(|| format!("{what}: imported, without a log that {name} could be made from")))
}
