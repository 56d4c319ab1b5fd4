//! Ways to change a store.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{ArrowPrimitiveType, Float32Type, UInt8Type, UInt16Type, UInt32Type};
use arrow_array::{Array, ArrayRef, BinaryArray, FixedSizeListArray, ListArray, PrimitiveArray, RecordBatch};
use arrow_schema::DataType;
use codecs::{NpzReader, NpzWriter, Scalar, encode_member};
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::{ArrowReaderMetadata, ParquetRecordBatchReaderBuilder};
use parquet::file::properties::WriterProperties;

/// A fault: the check that must find it, words of its finding, and how to plant it in a store.
pub(super) type Plant = (&'static str, &'static str, fn(&Path));

/// A frame that is looked at, of every tenth one.
pub(super) const FRAME: usize = 10;
/// The folder of the vehicle's sensors.
const VEHICLE: &str = "scenes/0000/sensors/vehicle_0";

/// A copy whose files are links; those that are written anew are the copy's own.
pub(super) fn copied(store: &Path, to: &Path) {
    for entry in walkdir::WalkDir::new(store).into_iter().filter_map(Result::ok) {
        let place = to.join(entry.path().strip_prefix(store).expect("is below"));
        if entry.file_type().is_dir() {
            fs::create_dir_all(place).expect("a folder");
        } else {
            fs::hard_link(entry.path(), place).expect("a link");
        }
    }
}

pub(super) fn rewrite(path: &Path, bytes: &[u8]) {
    fs::remove_file(path).expect("was there");
    fs::write(path, bytes).expect("writes");
}

/// Rewrites a table, row group by row group, and what it says of itself.
pub(super) fn edit(
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
pub(super) fn renumbered<T: ArrowPrimitiveType>(
    array: &ArrayRef,
    change: &dyn Fn(&mut [T::Native]),
) -> ArrayRef {
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

pub(super) fn replaced(rows: &RecordBatch, column: &str, array: ArrayRef) -> RecordBatch {
    let at = rows.schema().index_of(column).expect("the column is there");
    let mut columns = rows.columns().to_vec();
    columns[at] = array;
    RecordBatch::try_new(rows.schema(), columns).expect("fits")
}

/// Changes numbers of a column in the row group that holds a row.
pub(super) fn change<T: ArrowPrimitiveType>(
    path: PathBuf,
    column: &str,
    row: usize,
    with: impl Fn(&mut [T::Native]),
) {
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
pub(super) fn repaint(path: PathBuf, with: impl Fn(&mut [[u8; 3]])) {
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
pub(super) fn with_depths(rows: &RecordBatch, change: impl Fn(u32) -> u32) -> RecordBatch {
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
pub(super) fn recell(path: PathBuf, scalar: Scalar, with: impl Fn(&mut [u8])) {
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
pub(super) fn reseen(store: &Path, with: impl Fn(&mut [u8])) {
    recell(store.join("scenes/0000/occupancy_observed/vehicle_0.npz"), Scalar::U8, with);
}

/// The place of the first number of a row of a column in a table that has all its rows in one group.
pub(super) fn row_of(path: &Path, frame: u32, wanted: impl Fn(&RecordBatch, usize) -> bool) -> usize {
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
pub(super) fn a_box(store: &Path) -> usize {
    row_of(&store.join("scenes/0000/boxes.parquet"), FRAME as u32, |rows, k| {
        let agents = rows.column_by_name("agent").expect("is there").as_string::<i32>();
        let angles = rows.column_by_name("angle_rad").expect("is there");
        agents.value(k) == "vehicle_0" && !angles.is_null(k)
    })
}

/// A point of the semantic lidar amid a voxel of half a metre, as its place in the list and that in the grid.
pub(super) fn a_voxel(store: &Path) -> usize {
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

/// A row of the boxes in the pictures at [`FRAME`].
pub(super) fn a_flat_box(store: &Path) -> usize {
    row_of(&sensor(store, "boxes_2d"), FRAME as u32, |rows, k| {
        let list = rows.column_by_name("amodal_px").expect("is there").as_fixed_size_list();
        let amodal = list.value(k);
        // Well amid the picture.
        amodal.as_primitive::<Float32Type>().values()[0] > 2.0
    })
}

/// An archive of the vehicle.
pub(super) fn array(store: &Path, folder: &str) -> PathBuf {
    store.join(format!("scenes/0000/{folder}/vehicle_0.npz"))
}

/// Ids of two objects with boxes and the same tags that have voxels at [`FRAME`].
pub(super) fn two_alike(store: &Path) -> [u16; 2] {
    let mut archive =
        NpzReader::new(File::open(array(store, "occupancy_ids")).expect("opens")).expect("is one");
    let ids = archive.read(&format!("{FRAME:04}.npy")).expect("reads").bytes;
    let there: BTreeSet<u16> = ids.as_chunks::<2>().0.iter().map(|id| u16::from_le_bytes(*id)).collect();
    let file = File::open(table(store, "boxes")).expect("opens");
    let reader = ParquetRecordBatchReaderBuilder::try_new(file).expect("is a table").build().expect("opens");
    let mut cars: Vec<u16> = Vec::new();
    for rows in reader {
        let rows = rows.expect("reads");
        let ids = rows.column_by_name("id").expect("is there").as_primitive::<UInt16Type>().clone();
        let classes = rows.column_by_name("class").expect("is there").as_string::<i32>().clone();
        let is_car = |k: &usize| classes.value(*k) == "car" && there.contains(&ids.value(*k));
        cars.extend((0..rows.num_rows()).filter(is_car).map(|k| ids.value(k)));
    }
    cars.sort_unstable();
    cars.dedup();
    [cars[0], cars[1]]
}

/// Takes elements off the end of the array of [`FRAME`], which has one side.
pub(super) fn reshape(path: PathBuf, scalar: Scalar, bytes: usize) {
    let mut reader = NpzReader::new(File::open(&path).expect("opens")).expect("is an archive");
    let names: Vec<String> = reader.members().map(str::to_owned).collect();
    let mut writer = NpzWriter::new(Vec::new());
    for name in names {
        let mut array = reader.read(&name).expect("reads");
        if name == format!("{FRAME:04}.npy") {
            array.bytes.truncate(array.bytes.len() - bytes);
            array.shape[0] -= 1;
        }
        writer
            .append(encode_member(&name, scalar, &array.shape, &array.bytes, 1).expect("packs"))
            .expect("writes");
    }
    rewrite(&path, &writer.finish().expect("ends"));
}

/// Sets every cell of a class of the vehicle's mask: some of them are far from all of the map's.
pub(super) fn far_cells(store: &Path, class: usize) {
    recell(array(store, "bev"), Scalar::Bool, move |bits| bits[class * 160_000..][..160_000].fill(1));
}

/// Raises the ground of the vehicle's mask.
pub(super) fn raise(store: &Path, by_m: f32) {
    recell(array(store, "bev_heights"), Scalar::F32, move |all| {
        for height in all.as_chunks_mut::<4>().0 {
            *height = (f32::from_le_bytes(*height) + by_m).to_le_bytes();
        }
    });
}

/// The place in the list of a return of the turning lidar at [`FRAME`] that is the air's.
pub(super) fn a_backscatter(store: &Path) -> usize {
    let file = File::open(sensor(store, "TURNING")).expect("opens");
    let reader = ParquetRecordBatchReaderBuilder::try_new(file).expect("is a table");
    let rows = reader.with_batch_size(1).build().expect("opens").nth(FRAME).expect("a frame").expect("reads");
    let kinds = rows.column_by_name("return_kind").expect("is there").as_list::<i32>().value(0);
    let kinds = kinds.as_primitive::<UInt8Type>().values().to_vec();
    kinds.iter().position(|kind| [1, 2].contains(kind)).expect("there is fog")
}

pub(super) fn sensor(store: &Path, name: &str) -> PathBuf {
    store.join(VEHICLE).join(format!("{name}.parquet"))
}

pub(super) fn table(store: &Path, name: &str) -> PathBuf {
    store.join(format!("scenes/0000/{name}.parquet"))
}
