//! The layouts that arguments ask for.

use arguments::export::{
    CommonArgs, KittiArgs, LayoutCommand, McapArgs, NuScenesArgs, Opv2vArgs, PaletteWord, SharedArgs,
    SimBev2xArgs, StateWord, Sweeps,
};
use export_core::kitti::{Kitti, KittiOptions};
use export_core::mcap::{Mcap, McapOptions};
use export_core::nuscenes::{Modality, NuScenes, NuScenesOptions};
use export_core::opv2v::{self, Opv2v, Variant};
use export_core::simbev2x::{self, Palette, SimBev2x, State};
use export_core::{ExportError, Layout};

/// HEAL replaces these words wherever they stand in a path.
const REPLACED: [&str; 5] = ["OPV2V", "train", "validate", "test", "yaml"];

/// A layout with its options, and what all layouts take.
type Wanted = (Box<dyn Layout>, CommonArgs);

/// The layout, with its options, and what all layouts take.
///
/// # Errors
/// An option makes no sense.
pub(crate) fn split(command: LayoutCommand) -> Result<Wanted, ExportError> {
    match command {
        LayoutCommand::Kitti(args) => Ok(kitti(args)),
        LayoutCommand::Mcap(args) => mcap(args),
        LayoutCommand::NuScenes(args) => Ok(nuscenes(args)),
        LayoutCommand::Opv2v(args) => Ok(opv2v(args)),
        LayoutCommand::V2xReal(args) => Ok(scenarios(args.shared, Variant::V2xReal, false)),
        LayoutCommand::SimBev2x(args) => Ok(simbev2x(args)),
    }
}

fn kitti(KittiArgs { common, camera, lidar }: KittiArgs) -> Wanted {
    (Box::new(Kitti::new(KittiOptions { camera, lidar })), common)
}

fn mcap(args: McapArgs) -> Result<Wanted, ExportError> {
    let McapArgs { common, voxel_range, voxel_block, depth } = args;
    let layout = Mcap::new(McapOptions { voxel_range_m: voxel_range, voxel_block, depth })?;
    Ok((Box::new(layout), common))
}

fn nuscenes(args: NuScenesArgs) -> Wanted {
    let modality = |sweeps: &Sweeps| match sweeps {
        Sweeps::Lidar => Modality::Lidar,
        Sweeps::Radar => Modality::Radar,
        Sweeps::Camera => Modality::Camera,
    };
    let mut sweeps: Vec<Modality> = args.sweeps.iter().map(modality).collect();
    sweeps.sort_unstable();
    sweeps.dedup();
    let layout = NuScenes::new(NuScenesOptions {
        version: args.version_name,
        sample_every_n_frames: args.sample_every,
        sweeps,
        radius_m: args.radius,
        empty_boxes: args.empty_boxes,
        lidarseg: !args.no_lidarseg,
        map_mask: !args.no_map_mask,
    });
    (Box::new(layout), args.common)
}

fn opv2v(args: Opv2vArgs) -> Wanted {
    let dest = std::path::absolute(&args.shared.common.dest).unwrap_or_default();
    if let Some(word) = REPLACED.iter().find(|word| dest.to_string_lossy().contains(**word)) {
        let dest = dest.display();
        tracing::warn!(
            "{dest}: HEAL replaces `{word}` in whole paths: read it from a folder without that word"
        );
    }
    scenarios(args.shared, Variant::Opv2v, args.all_rsus)
}

fn scenarios(args: SharedArgs, variant: Variant, all_rsus: bool) -> Wanted {
    let SharedArgs { common, classes, lidar, cameras } = args;
    let usual = opv2v::Options::new(variant);
    let classes = if classes.is_empty() { usual.classes } else { classes };
    (Box::new(Opv2v::new(opv2v::Options { variant, classes, all_rsus, lidar, cameras })), common)
}

fn simbev2x(args: SimBev2xArgs) -> Wanted {
    let SimBev2xArgs { common, state, palette, path_prefix } = args;
    let state = match state {
        StateWord::Raw => State::Raw,
        StateWord::Processed => State::Processed,
    };
    let palette = match palette {
        PaletteWord::Plain => Palette::Plain,
        PaletteWord::Cityscapes => Palette::Cityscapes,
    };
    let path_prefix = path_prefix.unwrap_or_else(|| common.dest.to_string_lossy().into_owned());
    (Box::new(SimBev2x::new(simbev2x::Options { state, palette, path_prefix })), common)
}
