//! Records that a stage brings up to date without making anything again.

use serde::Serialize;
use settings::DatasetSettings;
use store::{Attempt, MadeBy, Manifest, Scope, keys};

use super::Run;
use crate::error::StageError;
use crate::graph::Graph;
use crate::imported::is_imported;
use crate::seen::{StageSettings, ViewError};
use crate::state::Staleness;

/// `dataset.json`.
#[derive(Serialize)]
struct DatasetRecord<'a> {
    format_version: u32,
    code_version: &'a str,
    /// The newest edition.
    config: &'a DatasetSettings,
    /// All of them, where there are several.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    editions: &'a [DatasetSettings],
}

impl<S: StageSettings> Run<'_, S> {
    /// Keeps what older code made, if it did: the manifest says so from here on.
    pub(super) fn accept(&self, scope: Scope) -> Result<(), StageError> {
        let Some(read) = self.store.manifest(scope, S::STAGE)?.filter(|manifest| !is_imported(manifest))
        else {
            return Ok(());
        };
        let mut manifest = read.clone();
        // A manifest may be of another version, and of another program as well.
        while let Err(why) = self.status().is_of_code(S::STAGE, &manifest) {
            manifest.accepted_by.push(match why {
                Staleness::Program => self.programs.made_by(S::STAGE).program,
                _ => crate::code_version(S::STAGE).to_owned(),
            });
        }
        if manifest != read {
            tracing::info!("{}: keeps what code {} made", self.label(scope), read.code_version);
            self.store.replace_manifest(scope, &read, &manifest)?;
        }
        Ok(())
    }

    /// `dataset.json`: the whole configuration. It goes with the plan, but the plan sees only a part of it.
    pub(super) fn record(&self) -> Result<Vec<u8>, StageError> {
        let record = DatasetRecord {
            format_version: schema::FORMAT_VERSION,
            code_version: crate::code_version(Graph::get().planner().name),
            config: self.editions.newest(),
            editions: if self.editions.all().len() > 1 { self.editions.all() } else { &[] },
        };
        let stage = S::STAGE;
        Ok(serde_json::to_vec_pretty(&record).map_err(|source| ViewError::Json { stage, source })?)
    }

    /// Brings `dataset.json` up to date where something changed that the plan does not see.
    pub(super) fn renew_record(&self) -> Result<(), StageError> {
        let record = self.record()?;
        let planner = Graph::get().planner().name;
        let written = self.store.manifest(Scope::Plan, planner)?;
        let hash = store::hash_bytes(&record);
        let is_old =
            |m: Manifest| !is_imported(&m) && m.output(keys::DATASET).is_none_or(|o| o.blake3 != hash);
        if written.is_some_and(is_old) {
            Attempt::amend(&self.store, Scope::Plan, planner, keys::DATASET, &record)?;
        }
        Ok(())
    }

    /// Notes in a plan that is kept which versions its tasks are to have.
    pub(super) fn renew_versions(&self) -> Result<(), StageError> {
        let planner = Graph::get().planner().name;
        let Some(read) = self.store.manifest(Scope::Plan, planner)?.filter(|plan| !is_imported(plan)) else {
            return Ok(());
        };
        let now = self.programs.made_by(planner);
        if read.made_by.as_ref().is_none_or(|then| then.versions != now.versions) {
            let then = read.made_by.clone().unwrap_or_else(|| now.clone());
            let made_by = Some(MadeBy { versions: now.versions, ..then });
            self.store.replace_manifest(Scope::Plan, &read, &Manifest { made_by, ..read.clone() })?;
        }
        Ok(())
    }
}
