//! Ids, tags, classes, palettes, settings, tables and meshes that every crate speaks of.
