//! Arguments of the layout `kitti`.

use clap::Args;
use export_core::Layout;
use export_core::kitti::{Kitti, KittiOptions};

use crate::args::CommonArgs;

/// What the layout takes.
#[derive(Debug, Args)]
pub(crate) struct KittiArgs {
    #[command(flatten)]
    common: CommonArgs,
    /// The camera that becomes image_2 and carries the labels.
    #[arg(long, value_name = "NAME", default_value = "CAM_FRONT")]
    camera: String,
    /// The lidar that becomes velodyne.
    #[arg(long, value_name = "NAME", default_value = "LIDAR")]
    lidar: String,
}

impl KittiArgs {
    pub(crate) fn split(self) -> (Box<dyn Layout>, CommonArgs) {
        let Self { common, camera, lidar } = self;
        (Box::new(Kitti::new(KittiOptions { camera, lidar })), common)
    }
}
