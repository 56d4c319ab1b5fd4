//! Readings of sensors as rows.

use std::fs::File;
use std::path::Path;

use codecs::images::{jpeg_size, png_size};
use codecs::{Array, DType, NpzReader, Scalar};
use schema::table::Blob;
use schema::tables::{CameraRow, FlowRow, GnssRow, ImuRow, LidarRow, RadarRow, SemanticLidarRow};
use schema::{FRAME_PERIOD_S, ImageKind, SensorKind, Tag};

use crate::cast::SceneObjects;
use crate::error::{ImportError, SourceFault};
use crate::folder::{Folder, read_file};
use crate::npy;
use crate::pictures::LIMITS;

/// Most bytes of a picture, of a receiver's reading, and of a sweep's and a flow's array.
const MAX_PICTURE: u64 = 1 << 28;
const MAX_READING: u64 = 1 << 16;
const MAX_SWEEP: u64 = 1 << 27;
const MAX_FLOW: u64 = 1 << 29;
/// Name of the one member of archives.
pub(crate) const DATA: &str = "data.npy";

/// A reading of a sensor.
pub(crate) enum Reading {
    Image(CameraRow, (u32, u32)),
    Flow(FlowRow),
    Lidar(LidarRow),
    SemanticLidar(SemanticLidarRow),
    Radar(RadarRow),
    Gnss(GnssRow),
    Imu(ImuRow),
}

/// Columns that the layout does not say, of the tables of a kind of sensor: they hold zeros.
pub(crate) fn zero_columns(kind: SensorKind) -> &'static [&'static str] {
    match kind {
        SensorKind::Lidar => &["intensity", "ring", "time_offset_s", "cos_angle", "id", "tag"],
        SensorKind::SemanticLidar => &["intensity", "ring", "time_offset_s"],
        SensorKind::Radar => &["rcs_dbsm", "snr_db", "id", "tag"],
        SensorKind::Image(_) | SensorKind::Gnss | SensorKind::Imu => &[],
    }
}

/// Reads the file of a sensor at a frame.
///
/// # Errors
/// It is missing, broken, of another shape or type, or holds numbers that are none.
pub(crate) fn read(
    folder: &Folder,
    said: &str,
    kind: SensorKind,
    frame: u32,
    cast: &SceneObjects,
) -> Result<Reading, ImportError> {
    let path = folder.find(said)?;
    let made = match kind {
        SensorKind::Image(ImageKind::Flow) => {
            archive(&path, MAX_FLOW).and_then(|array| flow(&array, frame)).map(Reading::Flow)
        }
        SensorKind::Image(image) => {
            let bytes = read_file(&path, MAX_PICTURE)?;
            let size =
                if image == ImageKind::Rgb { jpeg_size(&bytes, LIMITS) } else { png_size(&bytes, LIMITS) };
            size.map_err(SourceFault::from).map(|[width, height]| {
                let row = CameraRow { frame, time_s: time_s(frame), image: Blob(bytes) };
                Reading::Image(row, (width, height))
            })
        }
        SensorKind::Lidar => {
            archive(&path, MAX_SWEEP).and_then(|array| lidar(&array, frame)).map(Reading::Lidar)
        }
        SensorKind::SemanticLidar => archive(&path, MAX_SWEEP)
            .and_then(|array| semantic(&array, frame, cast))
            .map(Reading::SemanticLidar),
        SensorKind::Radar => {
            archive(&path, MAX_SWEEP).and_then(|array| radar(&array, frame)).map(Reading::Radar)
        }
        SensorKind::Gnss => {
            numbers::<3>(&read_file(&path, MAX_READING)?).map(|values| Reading::Gnss(gnss(values, frame)))
        }
        SensorKind::Imu => {
            numbers::<7>(&read_file(&path, MAX_READING)?).map(|values| Reading::Imu(imu(values, frame)))
        }
    };
    made.map_err(|problem| ImportError::source(&path, problem))
}

fn time_s(frame: u32) -> f64 {
    f64::from(frame) * FRAME_PERIOD_S
}

/// The array of an archive of at most so many bytes.
pub(crate) fn archive(path: &Path, most: u64) -> Result<Array, SourceFault> {
    let file = File::open(path)?;
    let mut reader = NpzReader::new(file)?.with_max_bytes(most);
    Ok(reader.read(DATA)?)
}

/// Columns of an `[n, N]` array of `f4`, all of them numbers.
fn columns<const N: usize>(array: &Array) -> Result<[Vec<f32>; N], SourceFault> {
    let is_right = array.dtype == Scalar::F32.into() && matches!(array.shape.as_slice(), [_, n] if *n == N);
    if !is_right {
        return Err(
            format!("{DATA}: is {:?} of {:?}, expected n x {N} of f4", array.shape, array.dtype).into()
        );
    }
    let rows = array.bytes.len() / (4 * N);
    let mut found: [Vec<f32>; N] = std::array::from_fn(|_| Vec::with_capacity(rows));
    for (k, bytes) in array.bytes.chunks_exact(4).enumerate() {
        found[k % N].push(real(bytes, k / N)?);
    }
    Ok(found)
}

fn real(bytes: &[u8], row: usize) -> Result<f32, SourceFault> {
    let value = f32::from_le_bytes(std::array::from_fn(|i| bytes[i]));
    if value.is_finite() { Ok(value) } else { Err(format!("{DATA}: row {row} holds {value}").into()) }
}

fn lidar(array: &Array, frame: u32) -> Result<LidarRow, SourceFault> {
    let [x, y, z] = columns::<3>(array)?;
    let n = x.len();
    Ok(LidarRow {
        frame,
        time_s: time_s(frame),
        x,
        y,
        z,
        intensity: vec![0.0; n],
        ring: vec![0; n],
        time_offset_s: vec![0.0; n],
        cos_angle: vec![0.0; n],
        id: vec![0; n],
        tag: vec![0; n],
    })
}

fn semantic(array: &Array, frame: u32, cast: &SceneObjects) -> Result<SemanticLidarRow, SourceFault> {
    let fields = [
        ("x", Scalar::F32),
        ("y", Scalar::F32),
        ("z", Scalar::F32),
        ("CosAngle", Scalar::F32),
        ("ObjIdx", Scalar::U32),
        ("ObjTag", Scalar::U32),
    ];
    let wanted = DType::Record(fields.map(|(name, scalar)| (name.to_owned(), scalar)).to_vec());
    if array.dtype != wanted || array.shape.len() != 1 {
        return Err(format!(
            "{DATA}: is {:?} of {:?}, expected n records of a semantic lidar",
            array.shape, array.dtype
        )
        .into());
    }
    let n = array.shape[0];
    let mut row = SemanticLidarRow { frame, time_s: time_s(frame), ..SemanticLidarRow::default() };
    for (k, bytes) in array.bytes.chunks_exact(24).enumerate() {
        row.x.push(real(&bytes[0..4], k)?);
        row.y.push(real(&bytes[4..8], k)?);
        row.z.push(real(&bytes[8..12], k)?);
        // It is one of two directions: rounded, it may be more than 1.
        row.cos_angle.push(real(&bytes[12..16], k)?.abs().min(1.0));
        let whole = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| bytes[at + i]));
        row.id.push(cast.id(i128::from(whole(16))));
        let tag = u8::try_from(whole(20)).ok().filter(|tag| Tag::from_u8(*tag).is_some());
        row.tag.push(tag.ok_or_else(|| format!("{DATA}: row {k} has the tag {}", whole(20)))?);
    }
    row.intensity = vec![0.0; n];
    row.ring = vec![0; n];
    row.time_offset_s = vec![0.0; n];
    Ok(row)
}

fn radar(array: &Array, frame: u32) -> Result<RadarRow, SourceFault> {
    let [depth, altitude, azimuth, velocity] = columns::<4>(array)?;
    let n = depth.len();
    Ok(RadarRow {
        frame,
        time_s: time_s(frame),
        depth,
        altitude,
        azimuth,
        velocity,
        rcs_dbsm: vec![0.0; n],
        snr_db: vec![0.0; n],
        id: vec![0; n],
        tag: vec![0; n],
    })
}

fn flow(array: &Array, frame: u32) -> Result<FlowRow, SourceFault> {
    let &[height, width, 2] = array.shape.as_slice() else {
        return Err(format!("{DATA}: is {:?}, expected height x width x 2", array.shape).into());
    };
    if array.dtype != Scalar::F32.into() {
        return Err(format!("{DATA}: is of {:?}, expected f4", array.dtype).into());
    }
    let (mut dx, mut dy) = (Vec::with_capacity(height * width), Vec::with_capacity(height * width));
    for (k, pair) in array.bytes.chunks_exact(8).enumerate() {
        dx.push(real(&pair[..4], k)?);
        dy.push(real(&pair[4..], k)?);
    }
    // Their product counts bytes in memory.
    Ok(FlowRow { frame, time_s: time_s(frame), width: width as u32, height: height as u32, dx, dy })
}

fn numbers<const N: usize>(bytes: &[u8]) -> Result<[f64; N], SourceFault> {
    let value = npy::parse(bytes)?;
    let found = value.numbers::<N>().ok_or_else(|| format!("has not {N} numbers"))?;
    if found.iter().all(|v| v.is_finite()) { Ok(found) } else { Err("holds what is no number".into()) }
}

fn gnss([latitude_deg, longitude_deg, altitude_m]: [f64; 3], frame: u32) -> GnssRow {
    GnssRow { frame, time_s: time_s(frame), latitude_deg, longitude_deg, altitude_m }
}

/// Rates about x and y have the opposite sign of a right-handed vector's.
fn imu([ax, ay, az, gx, gy, gz, compass_rad]: [f64; 7], frame: u32) -> ImuRow {
    ImuRow {
        frame,
        time_s: time_s(frame),
        acceleration_mps2: [ax, ay, az],
        gyroscope_radps: [-gx, -gy, gz],
        compass_rad,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn floats(shape: &[usize], values: &[f32]) -> Array {
        let bytes = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        Array { dtype: Scalar::F32.into(), shape: shape.to_vec(), bytes }
    }

    #[test]
    fn points_stand_in_columns() {
        let row = lidar(&floats(&[2, 3], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), 3).expect("points");
        assert_eq!((row.x, row.y, row.z), (vec![1.0, 4.0], vec![2.0, 5.0], vec![3.0, 6.0]));
        assert_eq!((row.frame, row.time_s, row.tag), (3, 3.0 * 0.05, vec![0, 0]));
        let none = radar(&floats(&[0, 4], &[]), 0).expect("no returns");
        assert!(none.depth.is_empty() && none.snr_db.is_empty());
        for (array, want) in [
            (floats(&[2, 4], &[0.0; 8]), "expected n x 3 of f4"),
            (floats(&[6], &[0.0; 6]), "expected n x 3 of f4"),
            (
                Array { dtype: Scalar::F64.into(), shape: vec![1, 3], bytes: vec![0; 24] },
                "expected n x 3 of f4",
            ),
            (floats(&[2, 3], &[0.0, 0.0, 0.0, 0.0, f32::NAN, 0.0]), "data.npy: row 1 holds NaN"),
        ] {
            let error = lidar(&array, 0).expect_err("refused").to_string();
            assert!(error.contains(want), "{error}");
        }
    }

    #[test]
    fn flow_and_receivers_are_read() {
        let row = flow(&floats(&[1, 2, 2], &[0.25, -1.0, 0.5, -2.0]), 0).expect("flow");
        assert_eq!((row.width, row.height, row.dx, row.dy), (2, 1, vec![0.25, 0.5], vec![-1.0, -2.0]));
        let row = imu([1.0, 2.0, 9.8, 0.1, 0.2, 0.3, 4.0], 2);
        assert_eq!((row.acceleration_mps2, row.gyroscope_radps), ([1.0, 2.0, 9.8], [-0.1, -0.2, 0.3]));
        assert_eq!(gnss([1.0, 2.0, 3.0], 0).altitude_m, 3.0);
    }
}
