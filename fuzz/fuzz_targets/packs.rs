//! Reads any bytes as a model of a pack: a length, a page of that many bytes, and the rest as its glTF file.
//! What is read can be shown.

#![no_main]

use libfuzzer_sys::fuzz_target;
use packs::{Files, read_model};

struct Two<'a> {
    page: &'a [u8],
    mesh: &'a [u8],
}

impl Files for Two<'_> {
    fn read(&self, path: &str, most: u64) -> Result<Option<Vec<u8>>, String> {
        let bytes = match path {
            "a.toml" => self.page,
            "a.glb" => self.mesh,
            _ => return Ok(None),
        };
        Ok(Some(bytes[..bytes.len().min(most as usize + 1)].to_vec()))
    }

    fn location(&self, path: &str) -> String {
        path.to_owned()
    }
}

fuzz_target!(|bytes: &[u8]| {
    let Some((length, rest)) = bytes.split_first_chunk::<2>() else { return };
    let length = usize::from(u16::from_le_bytes(*length)).min(rest.len());
    let (page, mesh) = rest.split_at(length);
    let Ok(model) = read_model("a.toml", &Two { page, mesh }) else { return };
    assert!(model.row.size_m.iter().all(|v| *v > 0.0 && *v < 31.0), "a model of no size");
    if let Some(walker) = &model.walker {
        assert!(walker.box_m(1.0, 1.4).is_finite(), "somebody of no size");
    }
    for piece in model.levels.iter().flat_map(|level| &level.pieces) {
        let mesh = &piece.mesh;
        assert!(mesh.positions.iter().all(|p| p.is_finite()) && piece.hang.at().is_finite(), "a place that is none");
        assert_eq!(mesh.triangles.len(), mesh.triangle_part.len());
        for t in 0..mesh.triangles.len() {
            let _ = (mesh.corners(t), mesh.part(t), mesh.bent(t));
        }
        if let Some(textures) = &mesh.textures {
            assert_eq!(textures.corners.len(), mesh.triangles.len());
        }
    }
});
