//! What is wrong with a file that cannot be used.

/// Why a file cannot be used at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReadError {
    /// Not well-formed XML.
    #[error("line {line}, column {column}: not XML: {message}")]
    Xml {
        /// Line, from 1.
        line: u32,
        /// Column, from 1.
        column: u32,
        /// What the XML parser says.
        message: String,
    },
    /// Bytes that are neither UTF-8 text nor gzip of it, or too many of them.
    #[error("not text: {message}")]
    Bytes {
        /// What is wrong.
        message: String,
    },
    /// An element that cannot be understood, though it must be.
    #[error("line {line}{}: {message}", road.as_ref().map(|r| format!(", road {r}")).unwrap_or_default())]
    Content {
        /// Line, from 1.
        line: u32,
        /// Id of the road it is in.
        road: Option<String>,
        /// What is wrong.
        message: String,
    },
}
