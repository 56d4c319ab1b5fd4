//! What archives of arrays say of themselves.

use scene::SceneReader;
use schema::AgentId;
use schema::arrays::ArrayKind;
use serde::Deserialize;
use store::{StoreError, keys};

use crate::error::VizError;

/// What ends every archive (APPNOTE.TXT 4.3.16): a signature, eighteen bytes, the length of the comment, the comment.
const END: [u8; 4] = *b"PK\x05\x06";
const END_LEN: usize = 22;
const MOST_COMMENT: u64 = 65_535;

/// The grid of BEV masks.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct BevGrid {
    pub(crate) classes: Vec<String>,
    pub(crate) every_n_frames: u32,
}

/// The grid of voxels.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct OccupancyGrid {
    pub(crate) range_m: f64,
    pub(crate) voxel_m: f64,
    pub(crate) lower_m: f64,
    pub(crate) upper_m: f64,
    pub(crate) mount_z_m: f64,
    pub(crate) every_n_frames: u32,
}

/// What an agent's archive of arrays of a kind says of itself in its comment.
pub(crate) fn about<T: for<'a> Deserialize<'a>>(
    scene: &SceneReader,
    kind: &ArrayKind,
    agent: AgentId,
) -> Result<T, VizError> {
    let key = keys::array(scene.scene(), kind, agent);
    let path = scene.store().location(&key);
    let shard = scene.store().open_output(scene.manifest(kind.stage)?, &key)?;
    let start = shard.size().saturating_sub(MOST_COMMENT + END_LEN as u64);
    let tail = shard.read_at(start..shard.size()).map_err(|e| StoreError::read(&path, "read", e))?;
    let wrong = |problem: String| VizError::Archive { path: path.clone(), problem, stage: kind.stage };
    let comment = comment_of(&tail).ok_or_else(|| wrong("does not end as an archive does".into()))?;
    serde_json::from_slice(comment).map_err(|e| wrong(format!("what it says of itself is no grid: {e}")))
}

/// The comment at the end of an archive.
fn comment_of(tail: &[u8]) -> Option<&[u8]> {
    let starts = (0..=tail.len().checked_sub(END_LEN)?).rev();
    starts.filter(|&i| tail[i..i + 4] == END).find_map(|i| {
        let len = usize::from(u16::from_le_bytes([tail[i + 20], tail[i + 21]]));
        (i + END_LEN + len == tail.len()).then(|| &tail[i + END_LEN..])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_found_at_the_end() {
        let mut writer = formats::NpzWriter::new(Vec::new());
        let member = formats::encode_member("0000.npy", formats::Scalar::U8, &[2], &[1, 2], 0);
        writer.append(member.expect("encodes")).expect("fits");
        // A comment that looks like the end of an archive itself.
        let comment = "{\"a\": \"PK\u{5}\u{6}\"}";
        writer.set_comment(comment).expect("is short");
        let bytes = writer.finish().expect("finishes");
        assert_eq!(comment_of(&bytes), Some(comment.as_bytes()));
        assert_eq!(comment_of(&bytes[..bytes.len() - 1]), None);
        assert_eq!(comment_of(&[]), None);
    }
}
