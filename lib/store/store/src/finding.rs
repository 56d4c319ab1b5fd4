//! What is wrong in a store.

/// What is wrong with a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Problem {
    /// It is not there.
    Missing,
    /// It has another size than its manifest says.
    Size {
        /// Bytes in the manifest.
        expected: u64,
        /// Bytes found.
        found: u64,
    },
    /// It has the right size and other bytes.
    Changed,
    /// A manifest cannot be understood.
    Manifest(String),
    /// No manifest names it, and no try of a stage has it in hand.
    Stray,
    /// A stage has no manifest: it was never done, was stopped half-way, or the manifest was deleted.
    NotDone,
    /// A stage has no manifest because it failed.
    Failed(String),
}

impl std::fmt::Display for Problem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Problem::Missing => write!(f, "missing"),
            Problem::Size { expected, found } => {
                write!(f, "{found} bytes, expected {expected}: truncated or changed")
            }
            Problem::Changed => write!(f, "right size, other bytes: changed"),
            Problem::Manifest(problem) => write!(f, "{problem}"),
            Problem::Stray => write!(f, "no manifest names this file"),
            Problem::NotDone => write!(f, "no manifest: the stage is not done, or its manifest was deleted"),
            Problem::Failed(reason) => write!(f, "no manifest: the stage failed: {reason}"),
        }
    }
}

/// A file that is not as it should be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The file.
    pub key: String,
    /// The manifest that names it, where there is one.
    pub manifest: Option<String>,
    /// What is wrong.
    pub problem: Problem,
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.key, self.problem)?;
        self.manifest.as_ref().map_or(Ok(()), |manifest| write!(f, " (named by {manifest})"))
    }
}
