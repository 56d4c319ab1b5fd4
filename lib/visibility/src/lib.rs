//! What is seen: tiled rasteriser and packet ray tracer.
