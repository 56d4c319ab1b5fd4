//! Tiles in a store. A set of tiles is named by what they are made from: the map, the rules of scenery, the
//! code version. A missing tile is made and stored with a manifest like a stage's; the next reader finds it,
//! in this scene or another, in this process or another. Two processes that make the same tile at once write
//! the same bytes.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use catalogue::Catalogue;
use land::tiles::{Tile, TileMaker};
use opendrive::Map;
use schema::Layer;
use schema::geometry::SurfaceMesh;
use schema::tables::{SurfaceRow, TILE_STAGE, TileObjectRow};
use schema::tile::TileIndex;
use settings::SceneryRules;
use store::{Attempt, Identity, MadeBy, Manifest, Scope, Store, StoreError, keys, side_by_side};

/// A tile cannot be had.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TileError {
    /// The store failed.
    #[error("{0}")]
    Store(#[from] StoreError),
    /// Its triangles do not fit together.
    #[error("{path}: is damaged: its columns do not fit together (remove the tile's folder)")]
    Broken {
        /// The file.
        path: String,
    },
    /// The rules cannot be written down: a bug.
    #[error("the rules of scenery cannot be written down")]
    Rules(#[source] serde_json::Error),
}

/// What is known of a tile.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownTile {
    /// Which it is.
    pub index: TileIndex,
    /// Digest of its manifest.
    pub digest: String,
    /// The objects in it.
    pub objects: Vec<TileObjectRow>,
    /// The layers that its ground has.
    pub layers: BTreeSet<Layer>,
}

/// The tiles of a map in a store.
#[derive(Debug)]
pub struct TileStore<'a> {
    store: &'a Store,
    map: &'a Map,
    rules: &'a SceneryRules,
    catalogue: &'a Catalogue,
    set: u64,
    code_version: &'a str,
    made_by: Option<MadeBy>,
    config_hash: String,
    map_hash: &'a str,
    maker: OnceLock<TileMaker<'a>>,
    known: Mutex<BTreeMap<TileIndex, Arc<KnownTile>>>,
}

impl<'a> TileStore<'a> {
    /// The tiles of a map (with the BLAKE3 of its text) by some rules and with the models of a catalogue, as
    /// code of a version makes them.
    ///
    /// # Errors
    /// The rules cannot be written down.
    pub fn new(
        store: &'a Store,
        (map, map_hash): (&'a Map, &'a str),
        (rules, catalogue): (&'a SceneryRules, &'a Catalogue),
        code_version: &'a str,
    ) -> Result<Self, TileError> {
        let mut config = serde_json::to_vec(rules).map_err(TileError::Rules)?;
        if !catalogue.is_built_in() {
            // Which models are parked, and how large they are.
            config.extend(catalogue.identity());
        }
        let config_hash = store::hash_bytes(&config);
        let all = store::hash_bytes(format!("{map_hash} {config_hash} {code_version}").as_bytes());
        // The first 64 of its 256 bits; the manifests hold the parts themselves.
        let set = all
            .bytes()
            .take(16)
            .fold(0, |set, digit| set << 4 | u64::from((digit as char).to_digit(16).unwrap_or_default()));
        let (maker, known) = (OnceLock::new(), Mutex::default());
        Ok(Self {
            store,
            map,
            rules,
            catalogue,
            set,
            code_version,
            made_by: None,
            config_hash,
            map_hash,
            maker,
            known,
        })
    }

    /// The same, with the build at work as a remark in the manifests of tiles that are made.
    #[must_use]
    pub fn remarking(self, made_by: MadeBy) -> Self {
        Self { made_by: Some(made_by), ..self }
    }

    /// The number of the set: that of its folder.
    #[must_use]
    pub fn set(&self) -> u64 {
        self.set
    }

    /// Some tiles, in the order of their indices; those that are not in the store are made.
    ///
    /// # Errors
    /// The store cannot be read or written.
    pub fn get(&self, wanted: &BTreeSet<TileIndex>) -> Result<Vec<Arc<KnownTile>>, TileError> {
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let missing: Vec<TileIndex> = {
            let known = known();
            wanted.iter().copied().filter(|index| !known.contains_key(index)).collect()
        };
        // Those who wait for a bucket need no core.
        let at_once = self.store.backend().at_once().max(rayon::current_num_threads());
        let found = side_by_side(&missing, at_once, |&index| self.load_or_make(index).map(Arc::new))?;
        let mut known = known();
        known.extend(found.into_iter().map(|tile| (tile.index, tile)));
        Ok(wanted.iter().filter_map(|index| known.get(index).cloned()).collect())
    }

    /// The triangles of a tile's ground.
    ///
    /// # Errors
    /// The store cannot be read or written.
    pub fn surfaces(&self, index: TileIndex) -> Result<Vec<SurfaceMesh>, TileError> {
        // It may have been taken away since it was made.
        let manifest = self.manifest_or_make(index)?.0;
        self.read_surfaces(&manifest, index)
    }

    /// The same of many tiles, in their order. As many are read side by side as the place is worth asking.
    pub fn surfaces_of(
        &self,
        indices: impl Iterator<Item = TileIndex>,
    ) -> impl Iterator<Item = Result<Vec<SurfaceMesh>, TileError>> {
        let at_once = self.store.backend().at_once();
        let mut left = indices;
        let some = std::iter::from_fn(move || {
            let some: Vec<TileIndex> = left.by_ref().take(at_once).collect();
            (!some.is_empty()).then(|| side_by_side(&some, at_once, |&index| self.surfaces(index)))
        });
        some.flat_map(|found| match found {
            Ok(found) => found.into_iter().map(Ok).collect(),
            Err(error) => vec![Err(error)],
        })
    }

    fn read_surfaces(&self, manifest: &Manifest, index: TileIndex) -> Result<Vec<SurfaceMesh>, TileError> {
        let key = keys::tile(self.set, index, "surfaces");
        let rows: Vec<SurfaceRow> = self.store.read_rows(manifest, &key)?;
        let broken = || TileError::Broken { path: self.store.location(&key) };
        rows.iter().map(|row| row.mesh().ok_or_else(broken)).collect()
    }

    fn load_or_make(&self, index: TileIndex) -> Result<KnownTile, TileError> {
        let (manifest, made) = self.manifest_or_make(index)?;
        let Tile { surfaces, objects } = match made {
            Some(tile) => tile,
            None => Tile {
                surfaces: self.read_surfaces(&manifest, index)?,
                objects: self.store.read_rows(&manifest, &keys::tile(self.set, index, "objects"))?,
            },
        };
        let layers = surfaces.iter().map(|piece| piece.layer).collect();
        Ok(KnownTile { index, digest: manifest.digest(), objects, layers })
    }

    /// The manifest of a tile; the tile, too, where it was made just now.
    fn manifest_or_make(&self, index: TileIndex) -> Result<(Manifest, Option<Tile>), TileError> {
        let identity = Identity {
            stage: TILE_STAGE.into(),
            scope: Scope::Tile { set: self.set, index },
            code_version: self.code_version.to_owned(),
            config_hash: self.config_hash.clone(),
            inputs: BTreeMap::from([("map".to_owned(), self.map_hash.to_owned())]),
            made_by: self.made_by.clone(),
        };
        let attempt = match Attempt::start_once(self.store, identity)? {
            Ok(attempt) => attempt,
            Err(manifest) => return Ok((manifest, None)),
        };
        let tile =
            self.maker.get_or_init(|| TileMaker::new(self.map, self.rules, self.catalogue)).make(index);
        if let Some(mut unit) = attempt.unit("tile")? {
            let surfaces: Vec<SurfaceRow> = tile.surfaces.iter().map(SurfaceRow::from).collect();
            unit.rows(&keys::tile(self.set, index, "surfaces"), &surfaces)?;
            unit.rows(&keys::tile(self.set, index, "objects"), &tile.objects)?;
            unit.finish()?;
        }
        Ok((attempt.commit()?, Some(tile)))
    }
}
