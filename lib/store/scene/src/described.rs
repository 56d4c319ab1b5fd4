//! What archives of arrays say of themselves: the comment at the end of a zip file, a JSON object.

use schema::AgentId;
use schema::arrays::ArrayKind;
use serde::de::DeserializeOwned;
use store::{StoreError, keys};

use crate::{SceneError, SceneReader};

/// What ends every archive (APPNOTE.TXT 4.3.16): a signature, eighteen bytes of which the last two are the
/// comment's length, the comment.
const END: [u8; 4] = *b"PK\x05\x06";
const END_BYTES: usize = 22;

/// What the archive of an agent's arrays of a kind says of itself. Only its end is read.
///
/// # Errors
/// The stage has not made it, or it says nothing that can be understood.
pub fn described<T: DeserializeOwned>(
    scene: &SceneReader,
    kind: &ArrayKind,
    agent: AgentId,
) -> Result<T, SceneError> {
    let key = keys::array(scene.scene(), kind, agent);
    let path = scene.store().location(&key);
    let shard = scene.store().open_output(scene.manifest(kind.stage)?, &key)?;
    let size = shard.size();
    let from = size.saturating_sub((END_BYTES + usize::from(u16::MAX)) as u64);
    let tail = shard.read_at(from..size).map_err(|source| StoreError::read(&path, "read", source))?;
    serde_json::from_slice(comment_of(&tail).unwrap_or_default()).map_err(|e| SceneError::Array {
        path,
        scene: scene.scene(),
        frame: None,
        stage: kind.stage,
        source: format!("what it says of itself cannot be understood: {e}").into(),
    })
}

/// The comment of the zip file that ends like this.
fn comment_of(tail: &[u8]) -> Option<&[u8]> {
    let last = tail.len().checked_sub(END_BYTES)?;
    (0..=last).rev().find_map(|at| {
        let comment = &tail[at + END_BYTES..];
        let length = u16::from_le_bytes([tail[at + 20], tail[at + 21]]);
        (tail[at..at + 4] == END && usize::from(length) == comment.len()).then_some(comment)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_stand_at_the_end() {
        let archive = |comment: &str| {
            let mut writer = codecs::NpzWriter::new(Vec::new());
            let member = codecs::encode_member("0000.npy", codecs::Scalar::U8, &[2], &[1, 2], 0);
            writer.append(member.expect("encodes")).expect("fits");
            writer.set_comment(comment).expect("is short");
            writer.finish().expect("memory takes it")
        };
        // One that looks like the end of an archive itself, and none.
        for comment in ["{\"a\": \"PK\u{5}\u{6}\"}", ""] {
            assert_eq!(comment_of(&archive(comment)), Some(comment.as_bytes()));
        }
        let bytes = archive("{}");
        assert_eq!(comment_of(&bytes[..bytes.len() - 1]), None);
        assert_eq!((comment_of(b"PK\x05\x06"), comment_of(&[])), (None, None));
    }
}
