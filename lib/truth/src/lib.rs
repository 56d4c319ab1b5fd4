//! Ground truth: boxes, HD map, BEV, occupancy, validity, tracks.
