//! Shards, manifests and their atomic commit.
