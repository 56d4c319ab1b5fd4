//! What every sensor tells of itself: enough for its table to be opened, written, counted and described.

use random::Stream;
use schema::AgentId;
use schema::table::Row;

use crate::error::SensorError;
use crate::geo::GeoOrigin;
use crate::observation::Observation;

/// How the rows of a sensor's table are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Each frame can be fetched alone.
    Frames,
    /// The same; what it holds is compressed already.
    CompressedFrames,
    /// All frames together: small rows.
    Whole,
}

/// A sensor's table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SensorTable {
    /// Its name among those of the agent.
    pub name: String,
    /// What its bytes are counted as: its name, for images their kind.
    pub counted_as: String,
    /// Pose and intrinsics as JSON ([`schema::calibration`]).
    pub metadata: Option<String>,
    /// How rows are kept.
    pub layout: Layout,
    /// It is read at frames 0, n, 2 n, ...
    pub every_n_frames: u32,
}

impl SensorTable {
    /// A table that is counted by its name.
    #[must_use]
    pub fn new(name: &str, metadata: Option<String>, layout: Layout, every_n_frames: u32) -> Self {
        Self { name: name.to_owned(), counted_as: name.to_owned(), metadata, layout, every_n_frames }
    }
}

/// An amount that is added to the statistics, under [`SensorTable::counted_as`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Amount {
    /// One of [`schema::measures`].
    pub measure: &'static str,
    /// How many.
    pub count: u64,
}

/// A sensor of one agent: a table, and rows for it at every frame at which it is read.
pub trait Sensor: Send + Sync + 'static {
    /// A row of its table.
    type Row: Row + Send + 'static;

    /// Its table.
    fn table(&self) -> SensorTable;

    /// Its rows of one frame. Frames may be asked for in any order and at the same time: the answer depends
    /// on the observation alone.
    ///
    /// # Errors
    /// The renderer failed, or an encoder refused.
    fn sense(&self, at: &Observation<'_>) -> Result<Vec<Self::Row>, SensorError>;

    /// What these rows add to the statistics, if anything.
    fn amount(&self, _rows: &[Self::Row]) -> Option<Amount> {
        None
    }
}

/// A callback for every sensor of a rig.
pub trait SensorVisitor {
    /// What can go wrong with a sensor.
    type Error: From<SensorError>;

    /// Is shown one sensor.
    ///
    /// # Errors
    /// The visitor's own.
    fn visit<S: Sensor>(&mut self, sensor: S) -> Result<(), Self::Error>;
}

/// Whose sensors they are.
#[derive(Clone, Copy, Debug)]
pub struct SensorContext {
    /// Seed of the dataset.
    pub seed: u64,
    /// Number of the scene.
    pub scene: u32,
    /// The agent.
    pub agent: AgentId,
    /// Where the map's origin is on the globe.
    pub geo_origin: GeoOrigin,
}

impl SensorContext {
    /// The random numbers of one of its sensors.
    #[must_use]
    pub fn stream(&self, sensor: &str) -> Stream {
        Stream::new(self.seed, u64::from(self.scene), &format!("sensors/{}/{sensor}", self.agent), 0)
    }
}
