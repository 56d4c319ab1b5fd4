//! The ground of a scene.

use schema::geometry::SurfaceMesh;
use schema::tables::{SceneTileRow, SurfaceRow, TILE_STAGE};
use schema::tile::TileIndex;
use store::{Scope, keys};

use crate::{SceneError, SceneReader};

/// The ground of the tiles that a scene has, tile by tile.
///
/// # Errors
/// As [`SceneReader::rows`]; or a tile is not there any more, or not the one that the scene was simulated
/// with.
pub fn read_ground(scene: &SceneReader) -> Result<Vec<SurfaceMesh>, SceneError> {
    let mut ground = Vec::new();
    for tile in scene.rows::<SceneTileRow>()? {
        add_tile(scene, &tile, &mut ground)?;
    }
    Ok(ground)
}

fn add_tile(
    scene: &SceneReader,
    tile: &SceneTileRow,
    ground: &mut Vec<SurfaceMesh>,
) -> Result<(), SceneError> {
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
    for row in store.read_rows::<SurfaceRow>(&manifest, &key)? {
        let broken = || wrong(store.location(&key), "has columns that do not fit together");
        ground.push(row.mesh().ok_or_else(broken)?);
    }
    Ok(())
}
