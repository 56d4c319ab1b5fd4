//! Array containers and foreign dataset layouts.
