//! Rows of a unit in a file, from which the tables of the end are made row by row.

use std::io::{self, BufRead, BufReader, Read, Write};

use super::rows::Row;

/// How hard zstd tries.
const LEVEL: i32 = 3;

/// Rows, one a line, compressed.
pub(crate) fn pack(rows: &[Row]) -> io::Result<Vec<u8>> {
    let mut encoder = zstd::Encoder::new(Vec::new(), LEVEL)?;
    for row in rows {
        serde_json::to_writer(&mut encoder, row)?;
        encoder.write_all(b"\n")?;
    }
    encoder.finish()
}

/// The rows of a file, one by one.
pub(crate) fn unpack(file: impl Read) -> io::Result<impl Iterator<Item = io::Result<Row>>> {
    let lines = BufReader::new(zstd::Decoder::new(file)?).lines();
    Ok(lines.map(|line| Ok(serde_json::from_str(&line?)?)))
}

#[cfg(test)]
mod tests {
    use super::super::rows::{EgoPose, Sample};
    use super::*;

    #[test]
    fn rows_come_back() {
        let pose = EgoPose {
            token: "a".into(),
            timestamp: 1_500_000_000_050_000,
            rotation: [1.0, 0.0, 0.0, 0.0],
            translation: [-184.226_286_564_759_73, 0.1 + 0.2, -1.84],
        };
        let sample = Sample {
            token: "b".into(),
            timestamp: 3,
            prev: String::new(),
            next: "c\n".into(),
            scene_token: "d".into(),
        };
        let rows = [Row::EgoPose(pose), Row::Sample(sample)];
        let packed = pack(&rows).expect("memory does not fail");
        let found: Vec<Row> =
            unpack(packed.as_slice()).expect("zstd").collect::<Result<_, _>>().expect("rows");
        assert_eq!(found, rows);
        assert!(unpack(&packed[..packed.len() / 2]).expect("a header").any(|row| row.is_err()));
    }
}
