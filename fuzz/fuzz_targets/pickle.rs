//! Reads any bytes as a file of boxes: an array of objects with its pickle, and as the pickle alone. There is
//! an answer, of bounded size, and nothing is called.

#![no_main]

use import_core::{Value, npy, pickle};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for value in [pickle::parse(bytes).ok(), npy::parse(bytes).ok()].into_iter().flatten() {
        // What is recalled from the memo is copied, within a budget.
        assert!(size(&value) <= 40 * bytes.len() + (32 << 20), "far more comes out of it than is in it");
        let _ = (value.get("id").and_then(Value::whole::<u16>), value.numbers::<24>());
    }
});

/// Bytes that a value takes, about.
fn size(value: &Value) -> usize {
    32 + match value {
        Value::Text(text) => text.len(),
        Value::Bytes(bytes) => bytes.len(),
        Value::List(items) => items.iter().map(size).sum(),
        Value::Dict(entries) => entries.iter().map(|(key, value)| key.len() + size(value)).sum(),
        Value::Numbers { values, shape } => {
            assert_eq!(shape.iter().product::<usize>(), values.len(), "a shape that is not filled");
            8 * values.len()
        }
        _ => 0,
    }
}
