//! How a store is kept.

use crate::key::settings;

settings! {
    /// How the store is kept.
    pub struct StoreSettings {
        /// Finished work of so many seconds of one core, estimated, is not made again because the
        /// configuration or the code changed, unless `--redo` says so.
        ask_beyond_s: f64 = 60.0, within(0.0..=1e9);
    }
}
