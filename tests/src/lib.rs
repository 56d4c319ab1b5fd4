//! Helpers for tests across stages.
