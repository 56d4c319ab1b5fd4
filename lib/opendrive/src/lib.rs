//! OpenDRIVE road networks: read, write, geometry, lane graph, queries.
