//! The pictures that there are of an agent, by their names.

use export_core::SceneSource;
use pictures::{BevPalette, ColourBy, Reach};
use scene::SensorKind;
use schema::arrays::{ArrayKind, BEV_MASKS, FILLED_VOXEL_GRIDS, VOXEL_CELLS, VOXEL_GRIDS};
use schema::table::Row;
use schema::tables::CameraRow;
use schema::{AgentId, ImageKind};

use crate::error::VizError;

/// A kind of picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    /// An image of a camera, by the name of its table; of colour images with boxes.
    Camera(ImageKind, String),
    /// A point cloud.
    Cloud { source: Source, is_solid: bool, has_boxes: bool, reach: Reach },
    /// Voxels: the archive that they are in.
    Voxels { kind: ArrayKind, reach: Reach },
    /// BEV masks.
    Bev(BevPalette),
    /// The lidars of all agents in this agent's lidar frame.
    Together { is_solid: bool, reach: Reach },
    /// All agents on the map: a picture of the scene, not of an agent.
    Scene,
}

/// The pictures that are wanted of an agent.
pub(crate) type Wanted = (AgentId, Vec<Mode>);

/// Whose points a cloud has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// A lidar's, by name.
    Lidar(String),
    /// A semantic lidar's, by name.
    SemanticLidar(String),
    /// All radars'.
    Radars,
}

impl Source {
    /// Its name in the names of pictures.
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Lidar(name) | Self::SemanticLidar(name) => name,
            Self::Radars => "RADAR",
        }
    }

    /// What its colours tell where nothing is said.
    pub(crate) fn colour(&self) -> ColourBy {
        match self {
            Self::Lidar(_) => ColourBy::Distance,
            Self::SemanticLidar(_) => ColourBy::Tag,
            Self::Radars => ColourBy::Velocity,
        }
    }
}

impl Mode {
    /// Its name.
    pub(crate) fn name(&self) -> String {
        let solid = |is_solid: &bool| if *is_solid { "3D" } else { "" };
        match self {
            Self::Camera(_, table) => table.clone(),
            Self::Cloud { source, is_solid, has_boxes, reach } => {
                let boxes = if *has_boxes { "wBBOX" } else { "" };
                format!("{}{}{boxes}-{}", source.name(), solid(is_solid), reach.name())
            }
            Self::Voxels { kind, reach } if *kind == FILLED_VOXEL_GRIDS => {
                format!("VOXEL3D-FILLED-{}", reach.name())
            }
            Self::Voxels { reach, .. } => format!("VOXEL3D-{}", reach.name()),
            Self::Bev(BevPalette::Plain) => "BEV".into(),
            Self::Bev(BevPalette::Cityscapes) => "BEV-CITYSCAPES".into(),
            Self::Together { is_solid, reach } => format!("COOP{}-{}", solid(is_solid), reach.name()),
            Self::Scene => "SCENE".into(),
        }
    }

    /// Photographs are kept as JPEG, all that is drawn as PNG.
    pub(crate) fn is_photograph(&self) -> bool {
        matches!(self, Self::Camera(ImageKind::Rgb, _))
    }

    /// Whether it shows points.
    pub(crate) fn has_points(&self) -> bool {
        matches!(self, Self::Cloud { .. }) || self.is_of_all()
    }

    /// Whether it shows what other agents have, too.
    pub(crate) fn is_of_all(&self) -> bool {
        matches!(self, Self::Together { .. } | Self::Scene)
    }
}

/// The pictures that there are of an agent, in the order in which people look for them.
pub(crate) fn modes_of(source: &SceneSource, agent: AgentId) -> Result<Vec<Mode>, VizError> {
    let sensors = if source.has(CameraRow::STAGE) { source.sensors(agent)? } else { Vec::new() };
    let mut modes = Vec::new();
    for kind in ImageKind::ALL {
        let of_kind = sensors.iter().filter(|s| s.kind == SensorKind::Image(*kind));
        modes.extend(of_kind.map(|s| Mode::Camera(*kind, s.name.clone())));
    }
    let has_radar = sensors.iter().any(|s| s.kind == SensorKind::Radar);
    let named = sensors.iter().filter_map(|s| match s.kind {
        SensorKind::Lidar => Some(Source::Lidar(s.name.clone())),
        SensorKind::SemanticLidar => Some(Source::SemanticLidar(s.name.clone())),
        _ => None,
    });
    for cloud in named.chain(has_radar.then_some(Source::Radars)) {
        let boxes: &[bool] =
            if matches!(cloud, Source::SemanticLidar(_)) { &[false] } else { &[false, true] };
        for is_solid in [false, true] {
            for &has_boxes in boxes {
                modes.extend(Reach::ALL.map(|reach| Mode::Cloud {
                    source: cloud.clone(),
                    is_solid,
                    has_boxes,
                    reach,
                }));
            }
        }
    }
    for kind in [VOXEL_GRIDS, VOXEL_CELLS, FILLED_VOXEL_GRIDS] {
        if source.has_arrays(&kind, agent) {
            modes.extend(Reach::ALL.map(|reach| Mode::Voxels { kind, reach }));
        }
    }
    if source.has_arrays(&BEV_MASKS, agent) {
        modes.extend(BevPalette::ALL.map(Mode::Bev));
    }
    if sensors.iter().any(|s| s.kind == SensorKind::Lidar) {
        for is_solid in [false, true] {
            modes.extend(Reach::ALL.map(|reach| Mode::Together { is_solid, reach }));
        }
    }
    Ok(modes)
}
