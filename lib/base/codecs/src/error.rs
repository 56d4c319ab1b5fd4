//! What can be wrong with an archive.

use std::io;

use rawzip::ErrorKind;

/// An archive cannot be written or read. `place` is a member's name or a part of the archive.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NpzError {
    /// The stream below failed, in reading or in writing. The source is the stream's own error with its kind
    /// ([`io::ErrorKind::StorageFull`], say); which file it was, the caller knows.
    #[error("input or output of the archive failed")]
    Io(#[from] io::Error),
    /// The archive ends before the part that should be there: it was cut.
    #[error("{place}: truncated: {problem}")]
    Truncated {
        /// Where.
        place: String,
        /// What is missing.
        problem: String,
    },
    /// Bytes that no valid archive has.
    #[error("{place}: corrupt: {problem}")]
    Corrupt {
        /// Where.
        place: String,
        /// What is wrong.
        problem: String,
    },
    /// A valid archive, but with a feature that is not read here.
    #[error("{place}: unsupported: {feature}")]
    Unsupported {
        /// Where.
        place: String,
        /// The feature.
        feature: String,
    },
    /// The member's bytes are not those that were written.
    #[error("{member}: bad checksum: the archive says {stored:08x}, the data gives {computed:08x}")]
    Checksum {
        /// The member.
        member: String,
        /// CRC-32 in the archive.
        stored: u32,
        /// CRC-32 of the data.
        computed: u32,
    },
    /// There is no member of this name.
    #[error("{member}: no such member")]
    NoMember {
        /// The name.
        member: String,
    },
    /// The array is larger than the reader's limit.
    #[error("{member}: has {bytes} bytes, the limit is {limit}")]
    TooLarge {
        /// The member.
        member: String,
        /// Its size.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// What the caller wants to write is no valid member.
    #[error("{member}: cannot be written: {problem}")]
    Invalid {
        /// The member.
        member: String,
        /// What is wrong.
        problem: String,
    },
}

impl NpzError {
    /// What the container's reader or writer says of a place.
    pub(crate) fn of_zip(place: &str, error: rawzip::Error) -> Self {
        match error.into_kind() {
            ErrorKind::IO(error) => Self::of_stream(place, error),
            ErrorKind::Eof => Self::cut(place),
            ErrorKind::MissingEndOfCentralDirectory => Self::truncated(
                "end of archive",
                "no record with the central directory's place, as in every zip",
            ),
            other => Self::corrupt(place, other.to_string()),
        }
    }

    /// What the stream says while a place is read.
    pub(crate) fn of_stream(place: &str, error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::UnexpectedEof => Self::cut(place),
            _ => Self::Io(error),
        }
    }

    fn cut(place: &str) -> Self {
        Self::truncated(place, "the archive ends within it")
    }

    pub(crate) fn truncated(place: &str, problem: impl Into<String>) -> Self {
        Self::Truncated { place: place.to_owned(), problem: problem.into() }
    }

    pub(crate) fn corrupt(place: &str, problem: impl Into<String>) -> Self {
        Self::Corrupt { place: place.to_owned(), problem: problem.into() }
    }

    pub(crate) fn unsupported(place: &str, feature: impl Into<String>) -> Self {
        Self::Unsupported { place: place.to_owned(), feature: feature.into() }
    }

    pub(crate) fn invalid(member: &str, problem: impl Into<String>) -> Self {
        Self::Invalid { member: member.to_owned(), problem: problem.into() }
    }
}
