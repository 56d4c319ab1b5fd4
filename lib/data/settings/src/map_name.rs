//! What maps are called.

/// Endings of map files.
pub const MAP_ENDINGS: [&str; 2] = [".xodr", ".xodr.gz"];

/// What a map of the configuration is called in the store: a file is called by its stem, all others as
/// written.
#[must_use]
pub fn map_name(written: &str) -> &str {
    match MAP_ENDINGS.iter().find_map(|ending| written.strip_suffix(ending)) {
        Some(stem) => stem.rsplit(['/', '\\']).next().unwrap_or(stem),
        None => written,
    }
}

#[cfg(test)]
mod tests {
    use super::map_name;

    #[test]
    fn files_are_called_by_their_stem() {
        for (written, name) in [
            ("convoy/03", "convoy/03"),
            ("Town03", "Town03"),
            ("Town03.xodr", "Town03"),
            ("../maps/north side.xodr.gz", "north side"),
            ("/data/v1.2/town.xodr", "town"),
        ] {
            assert_eq!(map_name(written), name);
        }
    }
}
