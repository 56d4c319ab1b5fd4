//! A scene of a store, read through its manifests.

use std::collections::BTreeMap;

use schema::AgentId;
use schema::scene_info::SceneInfo;
use schema::table::Row;
use store::{Manifest, Scope, Store, keys};

use crate::SceneError;

/// A scene of a store. Cheap to clone; nothing is read before it is asked for.
#[derive(Clone, Debug)]
pub struct SceneReader {
    store: Store,
    scene: u32,
    manifests: BTreeMap<String, Manifest>,
}

impl SceneReader {
    /// A scene as some manifests describe it: what a stage is allowed to read.
    #[must_use]
    pub fn new(store: &Store, scene: u32, manifests: impl IntoIterator<Item = Manifest>) -> Self {
        let manifests = manifests.into_iter().map(|m| (m.stage.clone(), m)).collect();
        Self { store: store.clone(), scene, manifests }
    }

    /// A scene with everything that some stages have made of it.
    ///
    /// # Errors
    /// A manifest cannot be read or understood.
    pub fn open(store: &Store, scene: u32, stages: &[&str]) -> Result<Self, SceneError> {
        let mut manifests = BTreeMap::new();
        for stage in stages {
            if let Some(manifest) = store.manifest(Scope::Scene(scene), stage)? {
                manifests.insert((*stage).to_owned(), manifest);
            }
        }
        Ok(Self { store: store.clone(), scene, manifests })
    }

    /// The scene's number.
    #[must_use]
    pub fn scene(&self) -> u32 {
        self.scene
    }

    /// The store that it is in.
    #[must_use]
    pub fn store(&self) -> &Store {
        &self.store
    }

    /// The manifest of a stage.
    ///
    /// # Errors
    /// The stage has not made its part.
    pub fn manifest(&self, stage: &'static str) -> Result<&Manifest, SceneError> {
        self.manifests.get(stage).ok_or(SceneError::NotMade { scene: self.scene, stage })
    }

    /// Where a file of the scene is, for messages.
    #[must_use]
    pub fn location(&self, name: &str) -> String {
        self.store.location(&keys::scene(self.scene, name))
    }

    /// Facts of the scene that are no table.
    ///
    /// # Errors
    /// The log is missing, or not as its manifest says.
    pub fn info(&self) -> Result<SceneInfo, SceneError> {
        let manifest = self.manifest(schema::scene_info::LOG_STAGE)?;
        Ok(self.store.read_output_json(manifest, &keys::scene(self.scene, schema::scene_info::SCENE_FILE))?)
    }

    /// The agents: vehicles, then RSUs.
    ///
    /// # Errors
    /// As [`SceneReader::info`], or an agent's name is none.
    pub fn agents(&self) -> Result<Vec<AgentId>, SceneError> {
        self.agents_of(&self.info()?)
    }

    /// The agents that the facts of the scene name.
    pub(crate) fn agents_of(&self, info: &SceneInfo) -> Result<Vec<AgentId>, SceneError> {
        let path = || self.location(schema::scene_info::SCENE_FILE);
        let parse = |name: &str| name.parse().map_err(|source| SceneError::Agent { path: path(), source });
        info.agents.iter().map(|agent| parse(&agent.agent)).collect()
    }

    /// Name of the file of a table.
    fn file_of<R: Row>() -> String {
        format!("{}.parquet", R::TABLE)
    }

    /// A whole table, by its row type; a row type of some of its columns ([`schema::columns!`]) reads no
    /// others. Rows of which every agent or sensor has a table, and those of the plan, do not compile: for
    /// the former there are [`crate::agent_rows`] and [`crate::SensorFrames`].
    ///
    /// # Errors
    /// Its stage has not made it, or it is not as the manifest says.
    pub fn rows<R: Row>(&self) -> Result<Vec<R>, SceneError> {
        const { assert!(is_one_of_scene(R::TABLE), "a scene has not one table of these rows") };
        let manifest = self.manifest(R::STAGE)?;
        Ok(self.store.read_rows(manifest, &keys::scene(self.scene, &Self::file_of::<R>()))?)
    }
}

/// Whether a scene has one table of this name: it stands not in the plan, and no name of an agent or sensor
/// belongs into it.
const fn is_one_of_scene(table: &str) -> bool {
    let name = table.as_bytes();
    if let [b'p', b'l', b'a', b'n', b'/', ..] | [b'm', b'a', b'p', b's', b'/', ..] = name {
        return false;
    }
    let mut i = 0;
    while i < name.len() {
        if name[i] == b'{' {
            return false;
        }
        i += 1;
    }
    true
}

#[cfg(test)]
mod tests {
    use schema::tables::{BoxRow, LidarRow, PlanSceneRow};

    use super::*;

    #[test]
    fn tables_of_agents_sensors_and_the_plan_are_not_one_of_a_scene() {
        assert!(is_one_of_scene(BoxRow::TABLE));
        assert!(!is_one_of_scene(LidarRow::TABLE) && LidarRow::TABLE.contains('{'));
        assert!(!is_one_of_scene(PlanSceneRow::TABLE));
    }
}
