//! Models of packs as a store keeps them (`models/NAME/`), held against the digest that the plan has.

use packs::{Files, PackError, PackModel};
use store::{Store, StoreError, keys};

/// A model of a pack cannot be read from the store.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The store failed.
    #[error("{0}")]
    Store(#[from] StoreError),
    /// It is missing or broken.
    #[error("{0} (run spawn-planner with --force)")]
    Pack(#[from] PackError),
    /// It is another one than the plan was made with.
    #[error("model {name}: its files are not those of the plan (run spawn-planner with --force)")]
    Other {
        /// The model.
        name: String,
    },
}

/// The files of a model in a store.
struct InStore<'a> {
    store: &'a Store,
    model: &'a str,
}

impl Files for InStore<'_> {
    fn read(&self, path: &str, most: u64) -> Result<Option<Vec<u8>>, String> {
        let key = keys::model_file(self.model, path);
        let bytes = self.store.read(&key).map_err(|e| e.to_string())?;
        // The planner let none in that is larger.
        Ok(bytes.map(|mut bytes| {
            bytes.truncate(usize::try_from(most.saturating_add(1)).unwrap_or(usize::MAX));
            bytes
        }))
    }

    fn location(&self, path: &str) -> String {
        self.store.location(&keys::model_file(self.model, path))
    }
}

/// The model of a name, by its page, whose files have a hash.
///
/// # Errors
/// It is missing, broken or another one.
pub fn read(store: &Store, [name, page, hash]: [&str; 3]) -> Result<PackModel, ModelError> {
    let model = packs::read_model(page, &InStore { store, model: name })?;
    if model.row.hash != hash || model.row.name != name {
        return Err(ModelError::Other { name: name.to_owned() });
    }
    Ok(model)
}
