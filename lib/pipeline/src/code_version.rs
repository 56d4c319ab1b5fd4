//! Which code a stage was built from.

const CODE_VERSIONS: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/code_versions.rs"));

/// Version of a stage's code: the release and a digest of every source file the stage is built from.
#[must_use]
pub fn code_version(stage: &str) -> &'static str {
    CODE_VERSIONS
        .iter()
        .find(|(name, _)| *name == stage)
        .map_or(env!("CARGO_PKG_VERSION"), |(_, version)| version)
}
