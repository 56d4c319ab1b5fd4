//! The ground of a scene.

use schema::geometry::SurfaceMesh;
use schema::tables::{SceneTileRow, SurfaceRow, TILE_STAGE};
use schema::tile::TileIndex;
use store::{Scope, keys, side_by_side};

use crate::{SceneError, SceneReader};

/// The ground of the tiles that a scene has, tile by tile.
///
/// # Errors
/// As [`SceneReader::rows`]; or a tile is not there any more, or not the one that the scene was simulated
/// with.
pub fn read_ground(scene: &SceneReader) -> Result<Vec<SurfaceMesh>, SceneError> {
    let tiles = scene.rows::<SceneTileRow>()?;
    let at_once = scene.store().backend().at_once();
    Ok(side_by_side(&tiles, at_once, |tile| read_tile(scene, tile))?.into_iter().flatten().collect())
}

fn read_tile(scene: &SceneReader, tile: &SceneTileRow) -> Result<Vec<SurfaceMesh>, SceneError> {
    let store = scene.store();
    let wrong = |path: String, problem| SceneError::Tile { path, scene: scene.scene(), problem };
    let index = TileIndex { x: tile.x, y: tile.y };
    let set = u64::from_str_radix(&tile.set, 16);
    let set = set.map_err(|_| wrong(scene.location("log/tiles.parquet"), "names no set of tiles"))?;
    let scope = Scope::Tile { set, index };
    let path = || store.location(&scope.manifest(TILE_STAGE));
    let manifest = store.manifest(scope, TILE_STAGE)?.ok_or_else(|| wrong(path(), "is missing"))?;
    if manifest.digest() != tile.digest {
        return Err(wrong(path(), "is another tile than that of the scene"));
    }
    let key = keys::tile(set, index, "surfaces");
    let broken = || wrong(store.location(&key), "has columns that do not fit together");
    let rows: Vec<SurfaceRow> = store.read_rows(&manifest, &key)?;
    rows.iter().map(|row| row.mesh().ok_or_else(broken)).collect()
}
