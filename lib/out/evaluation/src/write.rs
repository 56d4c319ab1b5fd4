//! Results as a file.

use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch, StringArray};
use parquet::arrow::ArrowWriter;
use serde_json::json;

use crate::EvaluationError;
use crate::measures::Measure;

/// Writes numbers one row each: as Parquet where the name of the file ends so, as a list of JSON objects
/// where in `.json`. What is no number is null.
///
/// # Errors
/// The name ends in something else, or the file cannot be written.
pub fn write_measures(path: &Path, measures: &[Measure]) -> Result<(), EvaluationError> {
    let fault = |problem: String| EvaluationError::Write { path: path.display().to_string(), problem };
    let write = |bytes: Vec<u8>| {
        File::create(path).and_then(|mut file| file.write_all(&bytes)).map_err(|e| fault(e.to_string()))
    };
    match path.extension().and_then(|end| end.to_str()) {
        Some("json") => write(as_json(measures)),
        Some("parquet") => write(as_parquet(measures).map_err(|e| fault(e.to_string()))?),
        _ => Err(EvaluationError::Refused(format!(
            "{}: results are written to names in .parquet or .json",
            path.display()
        ))),
    }
}

fn number(value: f64) -> Option<f64> {
    Some(value).filter(|v| v.is_finite())
}

fn as_json(measures: &[Measure]) -> Vec<u8> {
    let row = |m: &Measure| {
        let row = json!({
            "metrics": m.metrics, "mode": m.mode.name(), "class": m.class, "level": m.level,
            "measure": m.name, "threshold": m.threshold, "value": number(m.value),
        });
        format!("{row}")
    };
    let rows: Vec<String> = measures.iter().map(row).collect();
    format!("[\n{}\n]\n", rows.join(",\n")).into_bytes()
}

fn as_parquet(measures: &[Measure]) -> Result<Vec<u8>, parquet::errors::ParquetError> {
    let texts = |of: fn(&Measure) -> &'static str| -> ArrayRef {
        Arc::new(StringArray::from_iter_values(measures.iter().map(of)))
    };
    let numbers = |of: fn(&Measure) -> Option<f64>| -> ArrayRef {
        Arc::new(measures.iter().map(of).collect::<Float64Array>())
    };
    let batch = RecordBatch::try_from_iter_with_nullable([
        ("metrics", texts(|m| m.metrics), false),
        ("mode", texts(|m| m.mode.name()), false),
        ("class", texts(|m| m.class), false),
        ("level", texts(|m| m.level), false),
        ("measure", texts(|m| m.name), false),
        ("threshold", numbers(|m| m.threshold), true),
        ("value", numbers(|m| number(m.value)), true),
    ])?;
    let mut writer = ArrowWriter::try_new(Vec::new(), batch.schema(), None)?;
    writer.write(&batch)?;
    writer.into_inner()
}
