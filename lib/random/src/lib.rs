//! Counter-based random streams named by seed, scene, topic and entity.
