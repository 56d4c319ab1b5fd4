//! `evaluate` on BEV masks: the store's own, shifted and cut ones, and masks that cannot be.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

use codecs::{NpzReader, NpzWriter, Scalar, encode_member};
use convoy_tests::{Bench, Outcome, program};
use serde_json::Value;

const CLASSES: usize = 14;
const CELLS: usize = 400;
/// Cells a side of what is cut out.
const CUT: usize = 200;

fn evaluate(bench: &Bench, masks: &Path, args: &[&str]) -> (Outcome, Vec<Value>) {
    let out = bench.folder.path().join("masks.json");
    let mut command = Command::new(program("convoy"));
    command.args(["evaluate", "--bev-masks"]).arg(masks).arg("--store").arg(bench.store());
    let outcome =
        Outcome::of(&command.args(args).arg("--out").arg(&out).output().expect("the program starts"));
    let rows = fs::read(&out).ok().filter(|_| outcome.code == 0);
    (outcome, rows.map(|bytes| serde_json::from_slice(&bytes).expect("is JSON")).unwrap_or_default())
}

/// Values of a measure at a threshold by class and level.
fn values(rows: &[Value], measure: &str, threshold: Option<f64>) -> BTreeMap<(String, String), f64> {
    let text = |row: &Value, key: &str| row[key].as_str().expect("is a text").to_owned();
    let wanted =
        rows.iter().filter(|row| row["measure"] == measure && row["threshold"].as_f64() == threshold);
    wanted
        .map(|row| ((text(row, "class"), text(row, "level")), row["value"].as_f64().expect("is a number")))
        .collect()
}

fn write(folder: &Path, members: &[(String, Scalar, Vec<usize>, Vec<u8>)]) -> PathBuf {
    let path = folder.join("x2x/0000");
    fs::create_dir_all(&path).expect("is made");
    let mut writer = NpzWriter::new(File::create(path.join("vehicle_0.npz")).expect("is created"));
    for (name, scalar, shape, bytes) in members {
        writer.append(encode_member(name, *scalar, shape, bytes, 1).expect("fits")).expect("is written");
    }
    writer.finish().expect("is written");
    folder.to_owned()
}

pub(super) fn check(bench: &Bench) {
    let own = bench.store().join("scenes/0000/bev/vehicle_0.npz");
    let folder = bench.folder.path().join("perfect");
    fs::create_dir_all(folder.join("0000")).expect("is made");
    fs::copy(&own, folder.join("0000/vehicle_0.npz")).expect("is copied");
    let (outcome, rows) = evaluate(bench, &folder, &[]);
    outcome.expect_done();
    assert!(outcome.stdout.starts_with("BEV masks, 20 frames\n"), "{}", outcome.stdout);
    let (cells, iou) = (values(&rows, "cells", None), values(&rows, "IoU", Some(0.9)));
    assert_eq!((cells.len(), iou.len()), (CLASSES * 4, CLASSES * 4));
    let of = |class: &str, level: &str| (class.to_owned(), level.to_owned());
    assert!(cells[&of("road", "over 40 m")] > 0.0 && cells[&of("car", "all")] > 0.0, "{cells:?}");
    for (key, cells) in &cells {
        // All that is there, and nothing that is not.
        let want = if *cells > 0.0 { 1.0 } else { 0.0 };
        assert!((iou[key] - want).abs() < 1e-5, "{key:?}: {}", iou[key]);
    }
    let confused = values(&rows, "confused", Some(0.5));
    assert_eq!(confused.len(), CLASSES * CLASSES);
    assert_eq!(confused[&of("car", "car")], cells[&of("car", "all")]);
    let (one, _) = evaluate(bench, &folder, &["--threads", "1"]);
    assert_eq!(one.stdout, outcome.stdout);

    // The middle half, seven cells too far to the right, of a score of 0.784.
    let mut archive = NpzReader::new(File::open(&own).expect("opens")).expect("is an archive");
    let (mut both, mut any) = (0_u64, 0_u64);
    let mut members = Vec::new();
    for frame in [0, 10] {
        let name = format!("{frame:04}.npy");
        let truth = archive.read(&name).expect("reads").bytes;
        let first = (CELLS - CUT) / 2;
        let at = |class: usize, row: usize, column: usize| truth[(class * CELLS + row) * CELLS + column];
        let cut = |shift: usize| -> Vec<u8> {
            let cells = (0..CLASSES * CUT * CUT).map(|i| (i / (CUT * CUT), i / CUT % CUT, i % CUT));
            cells.map(|(class, row, column)| at(class, first + row, first + column - shift)).collect()
        };
        let (right, shifted) = (cut(0), cut(7));
        for (a, b) in right[..CUT * CUT].iter().zip(&shifted) {
            both += u64::from(*a != 0 && *b != 0);
            any += u64::from(*a != 0 || *b != 0);
        }
        let scores = shifted.iter().map(|set| 200 * set).collect();
        members.push((name, Scalar::U8, vec![CLASSES, CUT, CUT], scores));
    }
    let shifted = write(&bench.folder.path().join("shifted"), &members);
    let (outcome, rows) = evaluate(bench, &shifted, &["--every", "10"]);
    outcome.expect_done();
    assert!(outcome.stdout.starts_with("BEV masks, cooperation x2x, 2 frames\n"), "{}", outcome.stdout);
    let found = values(&rows, "IoU", Some(0.5))[&of("road", "all")];
    assert!((found - both as f64 / any as f64).abs() < 1e-6 && found < 0.999, "{found}");
    assert_eq!(values(&rows, "IoU", Some(0.8))[&of("road", "all")], 0.0);

    let (refused, _) = evaluate(bench, &shifted, &[]);
    let want = "x2x/0000/vehicle_0.npz: has no 0001.npy: frame 1 is evaluated";
    assert!(refused.code == 2 && refused.stderr.contains(want), "{}", refused.stderr);
    let floats = |value: f32, cells: usize| value.to_le_bytes().repeat(CLASSES * cells * cells);
    let side = |cell_m: f64| ("cell_m.npy".to_owned(), Scalar::F64, vec![], cell_m.to_le_bytes().to_vec());
    let frame = |scalar, shape: [usize; 3], bytes| ("0000.npy".to_owned(), scalar, shape.to_vec(), bytes);
    let cases = [
        (
            vec![frame(Scalar::F32, [CLASSES, 8, 8], floats(1.5, 8))],
            "0000.npy: [0, 0, 0] is 1.5, expected a score",
        ),
        (vec![frame(Scalar::F32, [CLASSES, 8, 8], floats(f32::NAN, 8))], "is NaN, expected a score"),
        (
            vec![frame(Scalar::U8, [8, 13, 14], vec![0; 8 * 13 * 14])],
            "has shape [8, 13, 14], expected (14, n, n)",
        ),
        (vec![frame(Scalar::U32, [CLASSES, 8, 8], vec![0; CLASSES * 256])], "expected float16, float32"),
        (vec![frame(Scalar::U8, [CLASSES, 9, 9], vec![0; CLASSES * 81])], "cells do not lie on cells"),
        (
            vec![side(0.5), frame(Scalar::U8, [CLASSES, 8, 8], vec![0; CLASSES * 64])],
            "a cell must be once, twice",
        ),
        (vec![side(-1.0)], "cell_m.npy: must be one float above 0"),
        (vec![frame(Scalar::U8, [CLASSES, 900, 900], vec![0; CLASSES * 810_000])], "0000.npy: 900 cells"),
    ];
    for (i, (members, want)) in cases.into_iter().enumerate() {
        let (refused, _) = evaluate(
            bench,
            &write(&bench.folder.path().join(format!("bad-{i}")), &members),
            &["--every", "20"],
        );
        assert!(refused.code == 2 && refused.stderr.contains(want), "{want}: {}", refused.stderr);
        assert_eq!(refused.stderr.matches("ERROR").count(), 1, "{}", refused.stderr);
    }
    let (missing, _) = evaluate(bench, &folder, &["--agents", "*"]);
    assert!(
        missing.code == 2 && missing.stderr.contains("0000/rsu_0.npz: cannot be read"),
        "{}",
        missing.stderr
    );
}
