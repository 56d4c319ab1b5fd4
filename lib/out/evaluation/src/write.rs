//! Results as a file.

use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch, StringArray};
use parquet::arrow::ArrowWriter;
use serde_json::json;

use crate::EvaluationError;
use crate::result::ResultRow;

/// Writes numbers one row each: as Parquet where the name of the file ends so, as a list of JSON objects
/// where in `.json`. What is no number is null.
///
/// # Errors
/// The name ends in something else, or the file cannot be written.
pub fn write_measures(path: &Path, rows: &[ResultRow]) -> Result<(), EvaluationError> {
    let fault = |problem: String| EvaluationError::Write { path: path.display().to_string(), problem };
    let write = |bytes: Vec<u8>| {
        File::create(path).and_then(|mut file| file.write_all(&bytes)).map_err(|e| fault(e.to_string()))
    };
    match path.extension().and_then(|end| end.to_str()) {
        Some("json") => write(as_json(rows)),
        Some("parquet") => write(as_parquet(rows).map_err(|e| fault(e.to_string()))?),
        _ => Err(EvaluationError::Refused(format!(
            "{}: results are written to names in .parquet or .json",
            path.display()
        ))),
    }
}

fn number(value: f64) -> Option<f64> {
    Some(value).filter(|v| v.is_finite())
}

/// What the columns of intervals are called.
const SPREAD: [&str; 5] = ["low", "high", "gain", "gain_low", "gain_high"];

/// An interval and what is gained, in the order of [`SPREAD`].
fn spread_of(row: &ResultRow) -> [Option<f64>; 5] {
    let Some(spread) = row.spread else { return [None; 5] };
    let gain = spread.gain.unwrap_or([f64::NAN; 3]);
    [spread.interval[0], spread.interval[1], gain[0], gain[1], gain[2]].map(number)
}

fn as_json(rows: &[ResultRow]) -> Vec<u8> {
    let (has_maps, has_spread) = (has_maps(rows), has_spread(rows));
    let line = |row: &ResultRow| {
        let m = &row.measure;
        let mut line = json!({
            "metrics": m.metrics, "mode": m.mode.name(), "class": m.class, "level": m.level,
            "measure": m.name, "threshold": m.threshold, "value": number(m.value),
        });
        if has_maps {
            line["map"] = json!(row.map);
        }
        if has_spread {
            for (name, value) in SPREAD.into_iter().zip(spread_of(row)) {
                line[name] = json!(value);
            }
        }
        format!("{line}")
    };
    let rows: Vec<String> = rows.iter().map(line).collect();
    format!("[\n{}\n]\n", rows.join(",\n")).into_bytes()
}

fn has_maps(rows: &[ResultRow]) -> bool {
    rows.iter().any(|row| row.map.is_some())
}

fn has_spread(rows: &[ResultRow]) -> bool {
    rows.iter().any(|row| row.spread.is_some())
}

fn as_parquet(rows: &[ResultRow]) -> Result<Vec<u8>, parquet::errors::ParquetError> {
    let texts = |of: fn(&ResultRow) -> &'static str| -> ArrayRef {
        Arc::new(StringArray::from_iter_values(rows.iter().map(of)))
    };
    let numbers = |of: &dyn Fn(&ResultRow) -> Option<f64>| -> ArrayRef {
        Arc::new(rows.iter().map(of).collect::<Float64Array>())
    };
    let mut columns = vec![
        ("metrics", texts(|row| row.measure.metrics), false),
        ("mode", texts(|row| row.measure.mode.name()), false),
        ("class", texts(|row| row.measure.class), false),
        ("level", texts(|row| row.measure.level), false),
        ("measure", texts(|row| row.measure.name), false),
        ("threshold", numbers(&|row| row.measure.threshold), true),
        ("value", numbers(&|row| number(row.measure.value)), true),
    ];
    if has_maps(rows) {
        let maps: StringArray = rows.iter().map(|row| row.map.as_deref()).collect();
        columns.push(("map", Arc::new(maps), true));
    }
    if has_spread(rows) {
        for (i, name) in SPREAD.into_iter().enumerate() {
            columns.push((name, numbers(&|row| spread_of(row)[i]), true));
        }
    }
    let batch = RecordBatch::try_from_iter_with_nullable(columns)?;
    let mut writer = ArrowWriter::try_new(Vec::new(), batch.schema(), None)?;
    writer.write(&batch)?;
    writer.into_inner()
}
