//! Scenery, meshes and actor models; the instances at a time.
