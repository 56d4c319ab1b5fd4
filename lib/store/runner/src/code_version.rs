//! Which code a stage was made by.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use crate::graph::stated_versions;

static CODE_VERSIONS: LazyLock<BTreeMap<&'static str, String>> = LazyLock::new(|| {
    stated_versions().iter().map(|(stage, version)| (*stage, version.to_string())).collect()
});

/// Version of what a stage makes, as its manifests have it: the whole number of `versions.toml`.
#[must_use]
pub fn code_version(stage: &str) -> &'static str {
    CODE_VERSIONS.get(stage).map_or("0", String::as_str)
}
