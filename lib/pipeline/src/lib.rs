//! The stage graph, the dataset configuration and the stage runner.
