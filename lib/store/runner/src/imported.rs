//! What was imported from another layout: it is never stale, and cannot be made again.

use schema::scene_info::LOG_STAGE;
use store::{Manifest, Scope};

use crate::graph::{Graph, StageSpec, UnitKind};

/// Whether a manifest stands for what was imported: no configuration, code or input of ours went into it that
/// could change.
pub(crate) fn is_imported(manifest: &Manifest) -> bool {
    schema::is_imported(&manifest.code_version)
}

/// The stage whose manifest says whether a scope was imported where another stage of it needs a log: a plan
/// has been imported itself, a scene with its log.
pub(crate) fn origin(spec: &StageSpec) -> Option<&'static str> {
    let origin = if spec.unit == UnitKind::Plan { Graph::get().planner().name } else { LOG_STAGE };
    spec.needs_log.then_some(origin)
}

/// Why a stage cannot be made of some scopes that were imported: it needs the log that is not there.
pub(crate) fn refusal(spec: &StageSpec, imported: &[Scope]) -> Option<String> {
    let scope = |scope: &Scope| match scope {
        Scope::Scene(scene) => format!("scene {scene}"),
        Scope::Plan | Scope::Tile { .. } | Scope::Stats => "the plan".to_owned(),
    };
    let (what, name) = (imported.iter().map(scope).collect::<Vec<_>>().join(", "), spec.name);
    (!imported.is_empty()).then(|| format!("{what}: imported, without a log that {name} could be made from"))
}
