//! Scene planning: which scenes, where, how long, in which weather.
