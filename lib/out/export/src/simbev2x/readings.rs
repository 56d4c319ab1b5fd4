//! Readings of sensors as files of the layout.

use codecs::{DType, EncodedMember, NpzError, Repeats, Scalar, archive_of, encode_records, npy_header};
use scene::{SensorEntry, SensorFrames, SensorKind};
use schema::table::{Framed, Row};
use schema::tables::{CameraRow, FlowRow, GnssRow, ImuRow, LidarRow, RadarRow, SemanticLidarRow};
use schema::{AgentId, ImageKind, framed};

use crate::{ExportError, SceneSource};

schema::columns! {
    /// Where the returns of a lidar are.
    Points of LidarRow { frame: u32, x: Vec<f32>, y: Vec<f32>, z: Vec<f32> }
}

schema::columns! {
    /// Returns of a semantic lidar.
    TaggedPoints of SemanticLidarRow {
        frame: u32, x: Vec<f32>, y: Vec<f32>, z: Vec<f32>, cos_angle: Vec<f32>, id: Vec<u16>, tag: Vec<u8>,
    }
}

schema::columns! {
    /// Returns of a radar.
    Returns of RadarRow {
        frame: u32, depth: Vec<f32>, altitude: Vec<f32>, azimuth: Vec<f32>, velocity: Vec<f32>,
    }
}

framed!(Points, TaggedPoints, Returns);

/// The table of a sensor, frame by frame.
pub(super) enum Readings {
    Image(SensorFrames<CameraRow>),
    Flow(SensorFrames<FlowRow>),
    Lidar(SensorFrames<Points>),
    SemanticLidar(SensorFrames<TaggedPoints>),
    Radar(SensorFrames<Returns>),
    Gnss(SensorFrames<GnssRow>),
    Imu(SensorFrames<ImuRow>),
}

impl Readings {
    /// Opens the table of a sensor.
    pub(super) fn open(
        scene: &SceneSource,
        agent: AgentId,
        sensor: &SensorEntry,
    ) -> Result<Self, ExportError> {
        Ok(match sensor.kind {
            SensorKind::Image(ImageKind::Flow) => Self::Flow(scene.readings(agent, sensor)?),
            SensorKind::Image(_) => Self::Image(scene.readings(agent, sensor)?),
            SensorKind::Lidar => Self::Lidar(scene.readings(agent, sensor)?),
            SensorKind::SemanticLidar => Self::SemanticLidar(scene.readings(agent, sensor)?),
            SensorKind::Radar => Self::Radar(scene.readings(agent, sensor)?),
            SensorKind::Gnss => Self::Gnss(scene.readings(agent, sensor)?),
            SensorKind::Imu => Self::Imu(scene.readings(agent, sensor)?),
        })
    }

    /// The file of a frame; none where the sensor has no reading then.
    pub(super) fn file(&mut self, frame: u32) -> Result<Option<Vec<u8>>, ReadingError> {
        match self {
            Self::Image(rows) => made(rows, frame, |row| Ok(row.image.0)),
            Self::Flow(rows) => made(rows, frame, |row| flow(&row)),
            Self::Lidar(rows) => made(rows, frame, |row| columns(&[&row.x, &row.y, &row.z])),
            Self::SemanticLidar(rows) => made(rows, frame, |row| tagged(&row)),
            Self::Radar(rows) => {
                made(rows, frame, |row| columns(&[&row.depth, &row.altitude, &row.azimuth, &row.velocity]))
            }
            Self::Gnss(rows) => {
                made(rows, frame, |row| plain(&[row.latitude_deg, row.longitude_deg, row.altitude_m]))
            }
            Self::Imu(rows) => made(rows, frame, |row| plain(&imu(&row))),
        }
    }
}

/// Why a reading has no file.
#[derive(Debug)]
pub(super) enum ReadingError {
    /// The store cannot be read.
    Store(ExportError),
    /// The reading does not fit.
    Content(String),
}

fn made<R: Row + Framed>(
    rows: &mut SensorFrames<R>,
    frame: u32,
    make: impl FnOnce(R) -> Result<Vec<u8>, NpzError>,
) -> Result<Option<Vec<u8>>, ReadingError> {
    let row = rows.at(frame).map_err(|e| ReadingError::Store(e.into()))?;
    row.map(|row| make(row).map_err(|e| ReadingError::Content(e.to_string()))).transpose()
}

/// An archive of one array, `data`.
fn archive(
    dtype: impl Into<DType>,
    shape: &[usize],
    bytes: &[u8],
    repeats: Repeats<'_>,
) -> Result<Vec<u8>, NpzError> {
    archive_of(encode_records(DATA, dtype, shape, bytes, repeats)?)
}

/// Name of the one member of archives.
const DATA: &str = "data.npy";

/// An archive of one array that is compressed already.
pub(super) fn repacked(member: EncodedMember) -> Result<Vec<u8>, NpzError> {
    archive_of(member.renamed(DATA)?)
}

/// Columns of equal length side by side: `[n, columns]`, f32.
fn columns(columns: &[&Vec<f32>]) -> Result<Vec<u8>, NpzError> {
    let n = columns.iter().map(|column| column.len()).min().unwrap_or(0);
    let mut bytes = vec![0; 4 * n * columns.len()];
    for (i, record) in bytes.chunks_exact_mut(4 * columns.len()).enumerate() {
        for (cell, column) in record.chunks_exact_mut(4).zip(columns) {
            cell.copy_from_slice(&column[i].to_le_bytes());
        }
    }
    // Noise: next to nothing in it comes back.
    archive(Scalar::F32, &[n, columns.len()], &bytes, Repeats::NONE)
}

/// `[n]` records.
fn tagged(row: &TaggedPoints) -> Result<Vec<u8>, NpzError> {
    let fields = [
        ("x", Scalar::F32),
        ("y", Scalar::F32),
        ("z", Scalar::F32),
        ("CosAngle", Scalar::F32),
        ("ObjIdx", Scalar::U32),
        ("ObjTag", Scalar::U32),
    ];
    let columns = [row.y.len(), row.z.len(), row.cos_angle.len(), row.id.len(), row.tag.len()];
    let n = columns.into_iter().fold(row.x.len(), usize::min);
    let mut bytes = vec![0; 24 * n];
    for (i, record) in bytes.chunks_exact_mut(24).enumerate() {
        let floats = [row.x[i], row.y[i], row.z[i], row.cos_angle[i]].map(f32::to_le_bytes);
        let numbers = [u32::from(row.id[i]), u32::from(row.tag[i])].map(u32::to_le_bytes);
        record[..16].copy_from_slice(floats.as_flattened());
        record[16..].copy_from_slice(numbers.as_flattened());
    }
    let dtype = DType::Record(fields.map(|(name, scalar)| (name.to_owned(), scalar)).to_vec());
    // Neighbours are of one object; ids and tags have bytes of zero behind them.
    archive(dtype, &[n], &bytes, Repeats { distances: &[24], step: 2 })
}

/// `[height, width, 2]`, f32: motion to the right, motion up.
fn flow(row: &FlowRow) -> Result<Vec<u8>, NpzError> {
    let mut bytes = vec![0; 8 * row.dx.len().min(row.dy.len())];
    for ((cell, dx), dy) in bytes.chunks_exact_mut(8).zip(&row.dx).zip(&row.dy) {
        cell[..4].copy_from_slice(&dx.to_le_bytes());
        cell[4..].copy_from_slice(&dy.to_le_bytes());
    }
    let (width, height) = (row.width as usize, row.height as usize);
    // Pixels move as those beside or above them.
    archive(Scalar::F32, &[height, width, 2], &bytes, Repeats { distances: &[8, 8 * width], step: 1 })
}

/// Numbers as a NPY file.
fn plain(values: &[f64]) -> Result<Vec<u8>, NpzError> {
    let mut file = npy_header("reading", &Scalar::F64.into(), &[values.len()])?;
    values.iter().for_each(|value| file.extend_from_slice(&value.to_le_bytes()));
    Ok(file)
}

/// Acceleration, angular velocity with x and y in the layout's opposite signs, compass.
fn imu(row: &ImuRow) -> [f64; 7] {
    let ([ax, ay, az], [gx, gy, gz]) = (row.acceleration_mps2, row.gyroscope_radps);
    [ax, ay, az, -gx, -gy, gz, row.compass_rad]
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use codecs::{Array, NpzReader};

    use super::*;

    fn data(file: Vec<u8>) -> Array {
        let mut reader = NpzReader::new(Cursor::new(file)).expect("an archive");
        assert_eq!(reader.members().collect::<Vec<_>>(), ["data.npy"]);
        reader.read("data.npy").expect("reads")
    }

    fn floats(bytes: &[u8]) -> Vec<f32> {
        bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().expect("four"))).collect()
    }

    #[test]
    fn points_stand_side_by_side() {
        let array = data(columns(&[&vec![1.0, 2.0], &vec![3.0, 4.0], &vec![5.0, 6.0]]).expect("fits"));
        assert_eq!((array.dtype, array.shape), (Scalar::F32.into(), vec![2, 3]));
        assert_eq!(floats(&array.bytes), [1.0, 3.0, 5.0, 2.0, 4.0, 6.0]);
        let none = data(columns(&[&vec![], &vec![], &vec![], &vec![]]).expect("fits"));
        assert_eq!((none.shape, none.bytes.len()), (vec![0, 4], 0));
    }

    #[test]
    fn tagged_points_are_records_of_24_bytes() {
        let row = TaggedPoints {
            x: vec![1.0],
            y: vec![2.0],
            z: vec![3.0],
            cos_angle: vec![0.5],
            id: vec![513],
            tag: vec![14],
            ..TaggedPoints::default()
        };
        let array = data(tagged(&row).expect("fits"));
        assert_eq!((array.dtype.size(), array.shape), (24, vec![1]));
        assert_eq!(floats(&array.bytes[..16]), [1.0, 2.0, 3.0, 0.5]);
        assert_eq!(array.bytes[16..], [1, 2, 0, 0, 14, 0, 0, 0]);
    }

    #[test]
    fn flow_is_a_picture_of_pairs() {
        let row =
            FlowRow { width: 2, height: 1, dx: vec![0.25, 0.5], dy: vec![-1.0, -2.0], ..FlowRow::default() };
        let array = data(flow(&row).expect("fits"));
        assert_eq!(array.shape, [1, 2, 2]);
        assert_eq!(floats(&array.bytes), [0.25, -1.0, 0.5, -2.0]);
    }

    #[test]
    fn turning_rates_have_the_signs_of_the_layout() {
        let row = ImuRow {
            acceleration_mps2: [1.0, 2.0, 9.81],
            gyroscope_radps: [0.1, 0.2, 0.3],
            compass_rad: 4.0,
            ..ImuRow::default()
        };
        assert_eq!(imu(&row), [1.0, 2.0, 9.81, -0.1, -0.2, 0.3, 4.0]);
        let file = plain(&imu(&row)).expect("fits");
        assert_eq!(file.len(), 128 + 56);
        assert!(file[10..].starts_with(b"{'descr': '<f8', 'fortran_order': False, 'shape': (7,), }"));
    }
}
