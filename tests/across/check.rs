//! `check` finds nothing in a store as it was made, and finds each fault that is planted in a copy of it.

use std::fs::{self, File};
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    ArrowPrimitiveType, Float32Type, Float64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{
    Array, ArrayRef, BinaryArray, FixedSizeListArray, ListArray, PrimitiveArray, RecordBatch, StringArray,
};
use arrow_buffer::OffsetBuffer;
use arrow_schema::DataType;
use convoy_tests::{Bench, Outcome, TINY, program};
use formats::{NpzReader, NpzWriter, Scalar, encode_member};
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::{ArrowReaderMetadata, ParquetRecordBatchReaderBuilder};
use parquet::file::properties::WriterProperties;
use rayon::prelude::*;
use serde_json::Value;

/// Frames that are looked at: every fifth one.
const FRAME: usize = 5;
/// The folder of the vehicle's sensors.
const VEHICLE: &str = "scenes/0000/sensors/vehicle_0";

/// A fault: the check that must find it, and how to plant it in a store.
type Plant = (&'static str, &'static str, fn(&Path));

/// Runs the check on a store.
fn checked(store: &Path, every: &str) -> Outcome {
    let mut command = Command::new(program("check"));
    command.arg("--store").arg(store).args(["--every", every, "--threads", "1"]);
    Outcome::of(&command.output().expect("the program starts"))
}

/// How much of a check is off, by the report's table.
fn off(report: &str, rule: &str) -> u64 {
    let line = report.lines().find(|line| {
        line.strip_prefix(rule).is_some_and(|rest| {
            rest.starts_with("  ") && rest.trim_start().starts_with(|c: char| c.is_ascii_digit())
        })
    });
    let mut numbers = line.unwrap_or_default()[line.map_or(0, |_| rule.len())..].split_whitespace();
    numbers.nth(1).map_or(0, |number| number.parse().expect("a number"))
}

/// A copy whose files are links; those that are written anew are the copy's own.
fn copied(store: &Path, to: &Path) {
    for entry in walkdir::WalkDir::new(store).into_iter().filter_map(Result::ok) {
        let place = to.join(entry.path().strip_prefix(store).expect("is below"));
        if entry.file_type().is_dir() {
            fs::create_dir_all(place).expect("a folder");
        } else {
            fs::hard_link(entry.path(), place).expect("a link");
        }
    }
}

fn rewrite(path: &Path, bytes: &[u8]) {
    fs::remove_file(path).expect("was there");
    fs::write(path, bytes).expect("writes");
}

/// Rewrites a table, row group by row group, and what it says of itself.
fn edit(
    path: &Path,
    change: impl Fn(usize, RecordBatch) -> Vec<RecordBatch>,
    note: impl Fn(String) -> String,
) {
    let file = File::open(path).expect("opens");
    let about = ArrowReaderMetadata::load(&file, Default::default()).expect("is a table");
    let mut notes = about.metadata().file_metadata().key_value_metadata().cloned().unwrap_or_default();
    notes.retain(|n| n.key != "ARROW:schema");
    notes.iter_mut().for_each(|n| n.value = n.value.take().map(&note));
    let properties = WriterProperties::builder().set_key_value_metadata(Some(notes)).build();
    let mut bytes = Vec::new();
    let mut writer =
        ArrowWriter::try_new(&mut bytes, about.schema().clone(), Some(properties)).expect("opens");
    let mut row = 0;
    for group in 0..about.metadata().num_row_groups() {
        let file = File::open(path).expect("opens");
        let reader = ParquetRecordBatchReaderBuilder::new_with_metadata(file, about.clone());
        for rows in reader.with_row_groups(vec![group]).with_batch_size(1 << 20).build().expect("opens") {
            let rows = rows.expect("reads");
            let first = row;
            row += rows.num_rows();
            change(first, rows).iter().for_each(|rows| writer.write(rows).expect("writes"));
        }
        writer.flush().expect("writes");
    }
    writer.close().expect("ends");
    rewrite(path, &bytes);
}

/// The same column with its numbers (those in its lists, one after the other) changed.
fn renumbered<T: ArrowPrimitiveType>(array: &ArrayRef, change: &dyn Fn(&mut [T::Native])) -> ArrayRef {
    if let Some(values) = array.as_primitive_opt::<T>() {
        let mut numbers = values.values().to_vec();
        change(&mut numbers);
        return Arc::new(PrimitiveArray::<T>::new(numbers.into(), values.nulls().cloned()));
    }
    if let Some(list) = array.as_list_opt::<i32>() {
        let values = renumbered::<T>(list.values(), change);
        let DataType::List(field) = list.data_type() else { unreachable!() };
        return Arc::new(ListArray::new(field.clone(), list.offsets().clone(), values, None));
    }
    let list = array.as_fixed_size_list();
    let values = renumbered::<T>(list.values(), change);
    let DataType::FixedSizeList(field, len) = list.data_type() else { unreachable!() };
    Arc::new(FixedSizeListArray::new(field.clone(), *len, values, None))
}

fn replaced(rows: &RecordBatch, column: &str, array: ArrayRef) -> RecordBatch {
    let at = rows.schema().index_of(column).expect("the column is there");
    let mut columns = rows.columns().to_vec();
    columns[at] = array;
    RecordBatch::try_new(rows.schema(), columns).expect("fits")
}

/// Changes numbers of a column in the row group that holds a row.
fn change<T: ArrowPrimitiveType>(path: PathBuf, column: &str, row: usize, with: impl Fn(&mut [T::Native])) {
    let each = |first: usize, rows: RecordBatch| {
        if !(first..first + rows.num_rows()).contains(&row) {
            return vec![rows];
        }
        let array = renumbered::<T>(rows.column_by_name(column).expect("is there"), &with);
        vec![replaced(&rows, column, array)]
    };
    edit(&path, each, |note| note);
}

/// Changes the pixels of an image at [`FRAME`]: rows of three bytes each, width 160.
fn repaint(path: PathBuf, with: impl Fn(&mut [[u8; 3]])) {
    let each = |first: usize, rows: RecordBatch| {
        if first != FRAME {
            return vec![rows];
        }
        let image = rows.column_by_name("image").expect("is there").as_binary::<i32>().value(0);
        let mut reader = png::Decoder::new(Cursor::new(image)).read_info().expect("is a picture");
        let mut rgb = vec![0; reader.output_buffer_size().expect("is small")];
        let info = reader.next_frame(&mut rgb).expect("reads");
        with(rgb.as_chunks_mut::<3>().0);
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, info.width, info.height);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().expect("writes");
        writer.write_image_data(&rgb).expect("writes");
        writer.finish().expect("ends");
        vec![replaced(&rows, "image", Arc::new(BinaryArray::from_vec(vec![&bytes])))]
    };
    edit(&path, each, |note| note);
}

/// A depth image's row with other depths.
fn with_depths(rows: &RecordBatch, change: impl Fn(u32) -> u32) -> RecordBatch {
    let image = rows.column_by_name("image").expect("is there").as_binary::<i32>().value(0);
    let mut reader = png::Decoder::new(Cursor::new(image)).read_info().expect("is a picture");
    let mut rgb = vec![0; reader.output_buffer_size().expect("is small")];
    let info = reader.next_frame(&mut rgb).expect("reads");
    for pixel in rgb.as_chunks_mut::<3>().0.iter_mut().filter(|p| **p != [255; 3]) {
        let depth = change(u32::from_le_bytes([pixel[0], pixel[1], pixel[2], 0]));
        let [low, middle, high, _] = depth.min(0xff_fffe).to_le_bytes();
        *pixel = [low, middle, high];
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, info.width, info.height);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().expect("writes");
    writer.write_image_data(&rgb).expect("writes");
    writer.finish().expect("ends");
    replaced(rows, "image", Arc::new(BinaryArray::from_vec(vec![&bytes])))
}

/// Changes the array of [`FRAME`].
fn recell(path: PathBuf, scalar: Scalar, with: impl Fn(&mut [u8])) {
    let mut reader = NpzReader::new(File::open(&path).expect("opens")).expect("is an archive");
    let names: Vec<String> = reader.members().map(str::to_owned).collect();
    let mut writer = NpzWriter::new(Vec::new());
    for name in names {
        let mut array = reader.read(&name).expect("reads");
        if name == format!("{FRAME:04}.npy") {
            with(&mut array.bytes);
        }
        writer
            .append(encode_member(&name, scalar, &array.shape, &array.bytes, 1).expect("packs"))
            .expect("writes");
    }
    rewrite(&path, &writer.finish().expect("ends"));
}

/// Changes what the vehicle's lidar saw of its voxels at [`FRAME`].
fn reseen(store: &Path, with: impl Fn(&mut [u8])) {
    recell(store.join("scenes/0000/occupancy_observed/vehicle_0.npz"), Scalar::U8, with);
}

/// The place of the first number of a row of a column in a table that has all its rows in one group.
fn row_of(path: &Path, frame: u32, wanted: impl Fn(&RecordBatch, usize) -> bool) -> usize {
    let reader =
        ParquetRecordBatchReaderBuilder::try_new(File::open(path).expect("opens")).expect("is a table");
    let mut first = 0;
    for rows in reader.build().expect("opens") {
        let rows = rows.expect("reads");
        let frames = rows.column_by_name("frame").expect("is there").as_primitive::<UInt32Type>().clone();
        if let Some(row) = (0..rows.num_rows()).find(|&k| frames.value(k) == frame && wanted(&rows, k)) {
            return first + row;
        }
        first += rows.num_rows();
    }
    panic!("{}: no such row", path.display());
}

/// A row of `boxes` and `boxes_valid` at [`FRAME`] whose object is no agent: of the vehicle's list.
fn a_box(store: &Path) -> usize {
    row_of(&store.join("scenes/0000/boxes.parquet"), FRAME as u32, |rows, k| {
        let agents = rows.column_by_name("agent").expect("is there").as_string::<i32>();
        let angles = rows.column_by_name("angle_rad").expect("is there");
        agents.value(k) == "vehicle_0" && !angles.is_null(k)
    })
}

/// A point of the semantic lidar amid a voxel of half a metre, as its place in the list and that in the grid.
fn a_voxel(store: &Path) -> usize {
    let path = store.join(VEHICLE).join("SEG-LIDAR.parquet");
    let reader =
        ParquetRecordBatchReaderBuilder::try_new(File::open(path).expect("opens")).expect("is a table");
    let mut reader = reader.with_batch_size(1).build().expect("opens");
    let rows = reader.nth(FRAME).expect("a frame").expect("reads");
    let axis = |name: &str| {
        let list = rows.column_by_name(name).expect("is there").as_list::<i32>().value(0);
        list.as_primitive::<Float32Type>().values().to_vec()
    };
    let (x, y, z) = (axis("x"), axis("y"), axis("z"));
    // The lidar is 1.8 m above the agent's origin, the grid's origin 0.02 m; the grid begins 1 m below it.
    let place =
        |k: usize| [x[k] + 64.0, y[k] + 64.0, z[k] + 1.8 - 0.02 + 1.0].map(|way| f64::from(way) / 0.5);
    let sides = [256.0, 256.0, 16.0];
    let amid = |k: &usize| {
        (0..3).all(|a| {
            let cells = place(*k)[a];
            let rest = cells - cells.floor();
            (0.0..sides[a]).contains(&cells) && (0.1..0.9).contains(&rest)
        })
    };
    let [i, j, k] = place((0..x.len()).find(amid).expect("a point")).map(|cells| cells as usize);
    (i * 256 + j) * 16 + k
}

/// The place in the list of a return of the turning lidar at [`FRAME`] that is no surface's.
fn a_backscatter(store: &Path) -> usize {
    let file = File::open(sensor(store, "TURNING")).expect("opens");
    let reader = ParquetRecordBatchReaderBuilder::try_new(file).expect("is a table");
    let rows = reader.with_batch_size(1).build().expect("opens").nth(FRAME).expect("a frame").expect("reads");
    let kinds = rows.column_by_name("return_kind").expect("is there").as_list::<i32>().value(0);
    let kinds = kinds.as_primitive::<UInt8Type>().values().to_vec();
    kinds.iter().position(|kind| *kind != 0).expect("there is fog")
}

fn sensor(store: &Path, name: &str) -> PathBuf {
    store.join(VEHICLE).join(format!("{name}.parquet"))
}

fn table(store: &Path, name: &str) -> PathBuf {
    store.join(format!("scenes/0000/{name}.parquet"))
}

/// Faults of the log, boxes and tracks.
const OF_TABLES: &[Plant] = &[
    ("numbers", "values of center_m are no numbers", |store| {
        let row = a_box(store);
        change::<Float64Type>(table(store, "boxes"), "center_m", row, move |all| all[3 * row] = f64::NAN);
    }),
    ("units", "difficulty says \"simple\"", |store| {
        let words = |_: usize, rows: RecordBatch| {
            let words = rows.column_by_name("difficulty").expect("is there").as_string::<i32>();
            let mut words: Vec<String> = words.iter().flatten().map(str::to_owned).collect();
            words[0] = "simple".into();
            vec![replaced(&rows, "difficulty", Arc::new(StringArray::from(words)))]
        };
        edit(&table(store, "boxes_valid"), words, |note| note);
    }),
    ("units", "the sign_type of object", |store| {
        let words = |_: usize, rows: RecordBatch| {
            let facts = rows.column_by_name("attributes").expect("is there").as_string::<i32>();
            let wrong = |facts: &str| facts.replace("\"speed_limit", "\"how_fast");
            let facts: Vec<String> = facts.iter().flatten().map(wrong).collect();
            vec![replaced(&rows, "attributes", Arc::new(StringArray::from(facts)))]
        };
        edit(&table(store, "log/actors"), words, |note| note);
    }),
    ("times", "frame 4 is at", |store| {
        let row = 4;
        change::<Float64Type>(table(store, "log/frames"), "time_s", row, move |all| all[row] += 1e-6);
    }),
    ("poses", "from where the log has it", |store| {
        // A turned pose: by a hundredth of a degree.
        change::<Float64Type>(table(store, "agents"), "quaternion", 0, |all| all[1] += 1e-4);
    }),
    ("poses", "and says", |store| {
        // The last row is that of the object with the highest id: no agent.
        change::<Float32Type>(table(store, "log/states"), "velocity_mps", 0, |all| {
            let last = all.len() - 3;
            all[last] += 2.0;
        });
    }),
    ("box list", "does not list object", |store| {
        let row = a_box(store);
        for name in ["boxes", "boxes_valid"] {
            let without = |first: usize, rows: RecordBatch| {
                let at = row - first;
                vec![rows.slice(0, at), rows.slice(at + 1, rows.num_rows() - at - 1)]
            };
            edit(&table(store, name), without, |note| note);
        }
    }),
    ("box shape", "its corners is off", |store| {
        let row = a_box(store);
        for name in ["boxes", "boxes_valid"] {
            change::<Float64Type>(table(store, name), "corners_m", row, move |all| {
                all[24 * row..24 * (row + 1)].iter_mut().step_by(3).for_each(|x| *x += 0.01);
            });
        }
    }),
    ("counts", "num_lidar_pts is", |store| {
        let row = a_box(store);
        change::<UInt32Type>(table(store, "boxes_valid"), "num_lidar_pts", row, move |all| all[row] += 1);
    }),
    ("counts", "num_radar_pts is", |store| {
        let row = a_box(store);
        change::<UInt32Type>(table(store, "boxes_valid"), "num_radar_pts", row, move |all| all[row] += 1);
    }),
    ("counts", "num_pixels is", |store| {
        let row = a_box(store);
        change::<UInt32Type>(table(store, "boxes_valid"), "num_pixels", row, move |all| all[row] += 1);
    }),
    ("tracks", "num_lidar_pts of object", |store| {
        change::<UInt32Type>(table(store, "tracks_frames"), "num_lidar_pts", 0, |all| all[7] += 1);
    }),
    ("tracks", "path_m of object", |store| {
        change::<Float64Type>(table(store, "tracks"), "path_m", 0, |all| all[0] += 0.1);
    }),
];

/// Faults of sensors.
const OF_SENSORS: &[Plant] = &[
    ("files", "RAD_FRONT.parquet", |store| fs::remove_file(sensor(store, "RAD_FRONT")).expect("was there")),
    ("files", "IMU.parquet", |store| rewrite(&sensor(store, "IMU"), b"PAR1 and no more")),
    ("numbers", "values of x are no numbers", |store| {
        change::<Float32Type>(sensor(store, "LIDAR"), "x", FRAME, |all| all[9] = f32::NAN);
    }),
    ("times", "frame 5 is at", |store| {
        change::<Float64Type>(sensor(store, "LIDAR"), "time_s", FRAME, |all| all[0] += 1e-6);
    }),
    ("units", "intensity goes from", |store| {
        change::<Float32Type>(sensor(store, "LIDAR"), "intensity", FRAME, |all| all[9] = 1.5);
    }),
    ("calibration", "m and", |store| {
        let turned = |note: String| note.replace("\"translation\":[0.6,", "\"translation\":[0.601,");
        edit(&sensor(store, "IST-CAM_FRONT"), |_, rows| vec![rows], turned);
    }),
    ("image ids", "show 60000 with tag 1", |store| {
        repaint(sensor(store, "IST-CAM_FRONT"), |pixels| pixels[0] = [1, 0x60, 0xea]);
    }),
    ("semantic", "1 pixels of CAM_FRONT", |store| {
        repaint(sensor(store, "SEG-CAM_FRONT"), |pixels| pixels[77] = [1, 2, 3]);
    }),
    ("pictures", "visible.parquet says", |store| {
        change::<UInt32Type>(sensor(store, "visible"), "pixels", 0, |all| all[0] += 1);
    }),
    ("depth", "are at another depth than in CAM_FRONT", |store| {
        // 6 % more: the middle byte is worth 1.5 cm, the highest 3.9 m.
        repaint(sensor(store, "DPT-CAM_FRONT"), |pixels| {
            for pixel in pixels.iter_mut().filter(|p| **p != [255; 3]) {
                let depth = u32::from_le_bytes([pixel[0], pixel[1], pixel[2], 0]);
                let [low, middle, high, _] = (depth + depth / 16).min(0xff_fffe).to_le_bytes();
                *pixel = [low, middle, high];
            }
        });
    }),
    ("flow", "CAM_FRONT:", |store| {
        // A pixel to the right.
        change::<Float32Type>(sensor(store, "FLW-CAM_FRONT"), "dx", FRAME, |all| {
            all.iter_mut().for_each(|dx| *dx += 2.0 / 160.0);
        });
    }),
    ("flow ids", "CAM_FRONT:", |store| {
        change::<Float32Type>(sensor(store, "FLW-CAM_FRONT"), "dy", FRAME, |all| {
            all.iter_mut().for_each(|dy| *dy += 0.6);
        });
    }),
    ("point ids", "from object 60000, which the log has not", |store| {
        change::<UInt16Type>(sensor(store, "SEG-LIDAR"), "id", FRAME, |all| all[0] = 60_000);
    }),
    ("units", "time_offset_s goes from", |store| {
        change::<Float32Type>(sensor(store, "TURNING"), "time_offset_s", FRAME, |all| all[9] = 0.001);
    }),
    ("scan times", "returns of LIDAR were fired", |store| {
        change::<Float32Type>(sensor(store, "LIDAR"), "time_offset_s", FRAME, |all| all[9] = -0.001);
    }),
    ("scan times", "returns of TURNING were fired", |store| {
        // Two slices late.
        change::<Float32Type>(sensor(store, "TURNING"), "time_offset_s", FRAME, |all| {
            all.iter_mut().for_each(|t| *t = (*t + 2.0 * 0.05 / 32.0).min(0.0));
        });
    }),
    ("scan times", "returns of SMOOTH were fired", |store| {
        change::<Float32Type>(sensor(store, "SMOOTH"), "time_offset_s", FRAME, |all| {
            all.iter_mut().for_each(|t| *t = (*t + 2.0 * 0.05 / 32.0).min(0.0));
        });
    }),
    ("returns", "is numbered out of turn", |store| {
        change::<UInt8Type>(sensor(store, "TURNING"), "return_number", FRAME, |all| all[0] = 3);
    }),
    ("returns", "of more returns of its beam than are asked for", |store| {
        for column in ["return_number", "return_count"] {
            change::<UInt8Type>(sensor(store, "SMOOTH"), column, FRAME, |all| {
                (0..)
                    .zip(&mut all[..3])
                    .for_each(|(k, n)| *n = if column == "return_count" { 3 } else { k + 1 });
            });
        }
        for column in ["x", "y", "z", "time_offset_s"] {
            change::<Float32Type>(sensor(store, "SMOOTH"), column, FRAME, |all| all.copy_within(0..1, 1));
            change::<Float32Type>(sensor(store, "SMOOTH"), column, FRAME, |all| all.copy_within(0..1, 2));
        }
    }),
    ("returns", "has an id, a tag or an angle", |store| {
        let at = a_backscatter(store);
        change::<UInt16Type>(sensor(store, "TURNING"), "id", FRAME, move |all| all[at] = 1);
    }),
    ("returns", "has an id, a tag or an angle", |store| {
        let at = a_backscatter(store);
        change::<UInt8Type>(sensor(store, "TURNING"), "tag", FRAME, move |all| all[at] = 1);
    }),
    ("returns", "that the lidar does not feel", |store| {
        change::<UInt8Type>(sensor(store, "SEG-TURNING"), "return_kind", FRAME, |all| all[0] = 1);
    }),
    ("point ids", "from object 0, which the log has not", |store| {
        let at = a_backscatter(store);
        change::<UInt8Type>(sensor(store, "TURNING"), "return_kind", FRAME, move |all| all[at] = 0);
    }),
    ("radar velocity", "m/s off", |store| {
        change::<Float32Type>(sensor(store, "RAD_FRONT"), "velocity", FRAME, |all| {
            all.iter_mut().for_each(|v| *v += 0.1);
        });
    }),
    ("radar presence", "RAD_FRONT has no return", |store| {
        let none = |first: usize, rows: RecordBatch| {
            if first != FRAME {
                return vec![rows];
            }
            let columns = rows.columns().iter().map(|column| match column.as_list_opt::<i32>() {
                Some(list) => {
                    let DataType::List(field) = list.data_type() else { unreachable!() };
                    let empty = OffsetBuffer::from_lengths([0]);
                    Arc::new(ListArray::new(field.clone(), empty, list.values().slice(0, 0), None))
                        as ArrayRef
                }
                None => column.clone(),
            });
            vec![RecordBatch::try_new(rows.schema(), columns.collect()).expect("fits")]
        };
        edit(&sensor(store, "RAD_FRONT"), none, |note| note);
    }),
    ("gnss", "m off", |store| {
        change::<Float64Type>(sensor(store, "GNSS"), "altitude_m", FRAME, |all| all[FRAME] += 1e-5);
    }),
    ("gnss", "m off", |store| {
        change::<Float64Type>(sensor(store, "GNSS"), "longitude_deg", FRAME, |all| all[FRAME] += 1e-9);
    }),
    ("imu", "acceleration is", |store| {
        change::<Float64Type>(sensor(store, "IMU"), "acceleration_mps2", FRAME, |all| {
            all[3 * FRAME] += 0.001
        });
    }),
    ("imu", "rates are", |store| {
        change::<Float64Type>(sensor(store, "IMU"), "gyroscope_radps", FRAME, |all| all[3 * FRAME] += 0.001);
    }),
    ("imu", "compass is", |store| {
        change::<Float64Type>(sensor(store, "IMU"), "compass_rad", FRAME, |all| all[FRAME] -= 1e-6);
    }),
];

/// Faults that need two files to agree, and of arrays.
const OF_ARRAYS: &[Plant] = &[
    ("box pixels", "pixels beyond its box", |store| {
        // A pixel of a car in a corner of the picture, for each camera that sees one.
        for camera in ["FRONT_LEFT", "FRONT", "FRONT_RIGHT", "BACK_LEFT", "BACK", "BACK_RIGHT"] {
            repaint(sensor(store, &format!("IST-CAM_{camera}")), |pixels| {
                if let Some(car) = pixels.iter().copied().find(|p| p[0] == 14) {
                    pixels[..200].fill(car);
                    let last = pixels.len() - 1;
                    pixels[last] = car;
                }
            });
        }
    }),
    ("box points", "lies outside its box", |store| {
        // All that the semantic lidar sees is 2 m farther to the left than it was.
        change::<Float32Type>(sensor(store, "SEG-LIDAR"), "y", FRAME, |all| {
            all.iter_mut().for_each(|y| *y += 2.0)
        });
    }),
    ("voxels", "lies in voxel", |store| {
        let cell = a_voxel(store);
        recell(store.join("scenes/0000/occupancy/vehicle_0.npz"), Scalar::U8, move |tags| tags[cell] = 0);
    }),
    ("filling", "have another tag when filled", |store| {
        let cell = a_voxel(store);
        recell(store.join("scenes/0000/occupancy_filled/vehicle_0.npz"), Scalar::U8, move |tags| {
            tags[cell] ^= 1
        });
    }),
    ("observed", "on a ray's way is unobserved", |store| {
        reseen(store, |seen| seen.iter_mut().filter(|cell| **cell == 1).for_each(|cell| *cell = 0));
    }),
    ("observed", "which is free", |store| {
        reseen(store, |seen| seen.iter_mut().filter(|cell| **cell == 0).for_each(|cell| *cell = 1));
    }),
    ("observed", "of a return is 1", |store| {
        let cell = |seen: &mut [u8]| seen.iter_mut().find(|cell| **cell == 2).map(|cell| *cell = 1);
        reseen(store, move |seen| assert!(cell(seen).is_some()));
    }),
    ("observed", "voxels without a return are occupied", |store| {
        reseen(store, |seen| *seen.last_mut().expect("has cells") = 2);
    }),
    ("bev objects", "car cells lie in no box", |store| {
        recell(store.join("scenes/0000/bev/vehicle_0.npz"), Scalar::Bool, |bits| {
            bits[7 * 160_000 + 5 * 400 + 5] = 1
        });
    }),
    ("bev presence", "has no car cell", |store| {
        recell(store.join("scenes/0000/bev/vehicle_0.npz"), Scalar::Bool, |bits| {
            bits[7 * 160_000..][..160_000].fill(0)
        });
    }),
    ("bev ground", "lies off the road", |store| {
        // A strip of 4 m right ahead.
        recell(store.join("scenes/0000/bev/vehicle_0.npz"), Scalar::Bool, |bits| {
            bits[150 * 400..190 * 400].fill(0);
        });
    }),
    ("bev hazards", "hazard cells lie in no area", |store| {
        recell(store.join("scenes/0000/bev/vehicle_0.npz"), Scalar::Bool, |bits| bits[160_000] = 1);
    }),
];

/// Faults of sums, which are compared when every frame is looked at.
const OF_SUMS: &[Plant] = &[
    ("counts", "partial statistics: bev_cells", |store| {
        change::<UInt64Type>(table(store, "stats/bev-gt.vehicle_0"), "count", 0, |all| all[0] += 1);
    }),
    ("statistics", "bev_cells.parquet: cells of road", |store| {
        change::<UInt64Type>(store.join("stats/bev_cells.parquet"), "cells", 0, |all| all[0] += 1);
    }),
];

#[test]
fn each_planted_fault_is_found() {
    let exact = "
[vehicle.gnss]
noise_latitude_deg = 0
noise_longitude_deg = 0
noise_altitude_m = 0

[vehicle.imu]
noise_accel_mps2 = 0
gyro_bias_radps = 0
noise_gyro_radps = 0
";
    let scans = "
[[vehicle.lidars]]
name = \"TURNING\"
channels = 16
columns = 256
semantic = true
rolling = true
rolling_slices = 32
rolling_compensated = false
beam_rays = 7
returns = [\"first\", \"strongest\", \"last\"]
weather = true

[[vehicle.lidars]]
name = \"SMOOTH\"
channels = 16
columns = 256
semantic = true
noise_m = 0
rolling = true
rolling_slices = 32
beam_rays = 7
";
    let config = TINY
        .replace("flow = true\n", "flow = true\nboxes_2d = true\n")
        .replace("[vehicle.occupancy]\n", "[vehicle.occupancy]\nobserved = true\n")
        .replace("sun_altitude_deg = 30\n", "sun_altitude_deg = 30\nfog_density = 100\nprecipitation = 60\n");
    let bench = Bench::new(&format!("{config}{scans}{exact}"));
    bench.run("convoy", &["run", "--progress", "none"]).expect_done();
    let store = bench.store();
    let whole = checked(&store, "1");
    let before = checked(&store, "5");
    assert!(before.stdout.contains("voxels: LIDAR: it has noise"), "{}", before.stdout);
    assert!(before.stdout.contains("voxels: SEG-SMOOTH: of what moves"), "{}", before.stdout);
    assert!(before.stdout.contains("gnss: rsu: carries none"), "{}", before.stdout);

    let plants = [OF_TABLES, OF_SENSORS, OF_ARRAYS].concat();
    let plants: Vec<(&Plant, &str, &Outcome)> =
        plants.iter().map(|p| (p, "5", &before)).chain(OF_SUMS.iter().map(|p| (p, "1", &whole))).collect();
    let unfound: Vec<String> = plants
        .par_iter()
        .enumerate()
        .filter_map(|(k, ((rule, words, plant), every, before))| {
            let copy = bench.folder.path().join(format!("copy-{k}"));
            copied(&store, &copy);
            plant(&copy);
            let after = checked(&copy, every);
            fs::remove_dir_all(&copy).expect("goes");
            let (was, is) = (off(&before.stdout, rule), off(&after.stdout, rule));
            let found = after.code == 1 && is > was && (was > 0 || after.stdout.contains(words));
            (!found).then(|| {
                format!("{rule} ({words}): {was} before, {is} after\n{}{}", after.stdout, after.stderr)
            })
        })
        .collect();
    assert!(unfound.is_empty(), "{}", unfound.join("\n"));
    let lines = whole.stdout.lines().skip_while(|line| !line.starts_with("check ")).skip(1);
    let rules =
        lines.take_while(|line| !line.is_empty()).map(|line| line.split("  ").next().unwrap_or_default());
    let faulty: Vec<&str> = rules.filter(|rule| off(&whole.stdout, rule) > 0).collect();
    assert_eq!(faulty, [""; 0], "{}", whole.stdout);
}

/// Faults of a store whose sensors and labels are at a part of the frame rate.
const OF_SELDOM: &[Plant] = &[
    ("times", "rows do not count every 2. of the 20 frames", |store| {
        let without = |first: usize, rows: RecordBatch| if first == 3 { Vec::new() } else { vec![rows] };
        edit(&sensor(store, "LIDAR"), without, |note| note);
    }),
    ("times", "not every 4. of 20 frames", |store| {
        let path = store.join("scenes/0000/bev/vehicle_0.npz");
        let mut reader = NpzReader::new(File::open(&path).expect("opens")).expect("is an archive");
        let mut writer = NpzWriter::new(Vec::new());
        for (name, as_name) in [("0000.npy", "0000.npy"), ("0004.npy", "0002.npy")] {
            let array = reader.read(name).expect("reads");
            let packed = encode_member(as_name, Scalar::Bool, &array.shape, &array.bytes, 1).expect("packs");
            writer.append(packed).expect("writes");
        }
        rewrite(&path, &writer.finish().expect("ends"));
    }),
    ("times", "has frame 3, only every 2. is wanted", |store| {
        change::<UInt32Type>(table(store, "hd_map"), "frame", 0, |all| all[2] = 3);
    }),
    ("calibration", "says every_n_frames is 1", |store| {
        let faster = |note: String| note.replace("\"every_n_frames\":2", "\"every_n_frames\":1");
        edit(&sensor(store, "LIDAR"), |_, rows| vec![rows], faster);
    }),
    ("observed", "no lidar sweeps, so that", |store| {
        let path = store.join("dataset.json");
        let mut dataset: Value = serde_json::from_slice(&fs::read(&path).expect("reads")).expect("is JSON");
        dataset["config"]["vehicle_rig"]["lidars"][0]["every_n_frames"] = 3.into();
        rewrite(&path, dataset.to_string().as_bytes());
    }),
    ("calibration", "the lens is", |store| {
        edit(&sensor(store, "IST-CAM_BENT"), |_, rows| vec![rows], |note| note.replace("-0.28", "-0.27"));
    }),
    ("depth", "are at another depth than in CAM_WIDE", |store| {
        let farther = |_: usize, rows: RecordBatch| vec![with_depths(&rows, |depth| depth + depth / 16)];
        edit(&sensor(store, "DPT-CAM_WIDE"), farther, |note| note);
    }),
];

/// [`TINY`] with everything at a rate of its own, and cameras with lenses.
fn seldom() -> String {
    let cameras = r#"cameras = [
  { name = "CAM_FRONT", xyz_m = [0.6, 0.0, 1.6], fx = 90, fy = 95, cx = 71.5, cy = 50.25 },
  { name = "CAM_BENT", xyz_m = [0.6, 0.0, 1.6], fx = 120, lens = "brown", distortion = [-0.28, 0.09, 1e-3, -5e-4, -0.01] },
  { name = "CAM_WIDE", xyz_m = [0.0, 0.4, 1.7], rpy_deg = [0, 0, 90], lens = "fisheye", fov_deg = 190, distortion = [-0.02, 0.004, 0, 0] },
  { name = "CAM_SMALL", xyz_m = [-1.0, 0.0, 1.6], rpy_deg = [0, 0, 180], width = 96, height = 64, fov_deg = 60 },
]
"#;
    let with = |text: &str, table: &str, keys: &str| {
        assert_eq!(text.matches(table).count(), 1, "{table}");
        text.replace(table, &format!("{keys}{table}"))
    };
    let text = with(TINY, "[vehicle.camera]\n", &format!("[vehicle]\n{cameras}\n"));
    let text = text.replace(
        "[vehicle.camera]\n",
        "[vehicle.camera]\nevery_n_frames = 2\nboxes_2d = true\nflow_half = true\n",
    );
    let text = text
        .replace("[vehicle.lidar]\n", "[vehicle.lidar]\nevery_n_frames = 2\nsemantic_every_n_frames = 4\n");
    let text =
        text.replace("[vehicle.occupancy]\n", "[vehicle.occupancy]\nevery_n_frames = 4\nobserved = true\n");
    let more = "[vehicle.radar]\nevery_n_frames = 3\n[vehicle.gnss]\nevery_n_frames = 5\n[vehicle.imu]\nevery_n_frames = 2\n\
                [annotation]\nevery_n_frames = 2\n[bev]\nevery_n_frames = 4\n";
    format!("{text}\n{more}")
}

#[test]
fn part_rates_lenses_and_half_floats_are_held_to() {
    let bench = Bench::new(&seldom());
    bench.run("convoy", &["run", "--progress", "none"]).expect_done();
    let store = bench.store();
    let whole = checked(&store, "1");
    assert_eq!(whole.code, 0, "{}{}", whole.stdout, whole.stderr);
    let rows = |path: PathBuf| -> i64 {
        let file = File::open(path).expect("opens");
        ArrowReaderMetadata::load(&file, Default::default())
            .expect("is a table")
            .metadata()
            .file_metadata()
            .num_rows()
    };
    // Of 20 frames.
    for (name, want) in [
        ("LIDAR", 10),
        ("SEG-LIDAR", 5),
        ("RAD_FRONT", 7),
        ("GNSS", 4),
        ("IMU", 10),
        ("RGB-CAM_WIDE", 10),
        ("FLW-CAM_BENT", 10),
    ] {
        assert_eq!(rows(sensor(&store, name)), want, "{name}");
    }
    assert_eq!(rows(table(&store, "agents")), 40);
    for (folder, want) in [("bev", 5), ("occupancy", 5), ("occupancy_filled", 5)] {
        let archive = File::open(store.join(format!("scenes/0000/{folder}/vehicle_0.npz"))).expect("opens");
        assert_eq!(NpzReader::new(archive).expect("is one").members().len(), want, "{folder}");
    }
    let unfound: Vec<String> = OF_SELDOM
        .iter()
        .enumerate()
        .filter_map(|(k, (rule, words, plant))| {
            let copy = bench.folder.path().join(format!("seldom-{k}"));
            copied(&store, &copy);
            plant(&copy);
            let after = checked(&copy, "1");
            fs::remove_dir_all(&copy).expect("goes");
            let found = after.code == 1 && off(&after.stdout, rule) > 0 && after.stdout.contains(words);
            (!found).then(|| format!("{rule} ({words}):\n{}{}", after.stdout, after.stderr))
        })
        .collect();
    assert!(unfound.is_empty(), "{}", unfound.join("\n"));
}

#[test]
fn what_is_no_store_is_told_from_a_faulty_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let outcome = checked(folder.path(), "1");
    assert_eq!(outcome.code, 2, "{outcome:?}");
    assert!(outcome.stderr.contains("dataset.json"), "{outcome:?}");
}

#[test]
fn what_options_leave_out_is_said_and_no_fault() {
    let config = TINY
        .replace("[vehicle.occupancy]\n", "[vehicle.occupancy]\nsparse = true\nobserved = true\n")
        .replace("[rsu.occupancy]\n", "[rsu.occupancy]\nfull_sweep = false\n")
        .replace("[rsu.lidar]\n", "[rsu.lidar]\nsemantic = true\n");
    let bench = Bench::new(&format!("{config}\n[bev]\nclasses = [\"car\", \"road\"]\n"));
    bench.run("convoy", &["run", "--progress", "none"]).expect_done();
    let found = checked(&bench.store(), "1");
    for said in [
        "masks have chosen classes",
        "vehicle_0: cells are listed",
        "voxels: sweeps find",
        "some agents are listed",
    ] {
        assert!(found.stdout.contains(said), "{said}: {}", found.stdout);
    }
    found.expect_done();
}
