//! What an archive of arrays is called.

/// A kind of arrays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArrayKind {
    /// Folder in the scene's folder; the archives in it are `AGENT.npz`.
    pub folder: &'static str,
    /// The stage that writes it.
    pub stage: &'static str,
}
