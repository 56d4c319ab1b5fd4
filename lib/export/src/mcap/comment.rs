//! What archives of arrays say of themselves: the comment at the end of a zip file, a JSON object.

use serde::de::DeserializeOwned;

use schema::AgentId;
use schema::arrays::ArrayKind;
use store::keys;

use crate::{ExportError, SceneSource};

/// End of a zip file's directory: signature, eighteen bytes, the comment behind them.
const END: [u8; 4] = *b"PK\x05\x06";
const END_BYTES: usize = 22;

/// What the archive of an agent's arrays of a kind says of itself.
///
/// # Errors
/// It cannot be read, or says nothing that can be understood.
pub(crate) fn described<T: DeserializeOwned>(
    scene: &SceneSource,
    kind: &ArrayKind,
    agent: AgentId,
) -> Result<T, ExportError> {
    let reader = scene.reader();
    let key = keys::array(scene.number(), kind, agent);
    let path = reader.store().location(&key);
    let shard = reader.store().open_output(reader.manifest(kind.stage)?, &key)?;
    let size = shard.size();
    let from = size.saturating_sub((END_BYTES + usize::from(u16::MAX)) as u64);
    let tail = shard.read_at(from..size).map_err(|source| ExportError::Read {
        path: (&path).into(),
        action: "read",
        source,
    })?;
    let text = comment_of(&tail).unwrap_or_default();
    serde_json::from_slice(text).map_err(|e| {
        let problem = format!("what it says of its grid cannot be understood: {e}");
        ExportError::Refused(format!("{path}: {problem} (run {} again with --force)", kind.stage))
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
        let mut archive = formats::NpzWriter::new(Vec::new());
        archive.set_comment("{\"cells\":4}").expect("is short");
        let bytes = archive.finish().expect("memory takes it");
        assert_eq!(comment_of(&bytes), Some(&b"{\"cells\":4}"[..]));
        let bytes = formats::NpzWriter::new(Vec::new()).finish().expect("memory takes it");
        assert_eq!(comment_of(&bytes), Some(&[][..]));
        assert_eq!(comment_of(b"PK\x05\x06"), None);
    }
}
