//! Arguments of the layout `simbev2x`.

use clap::{Args, ValueEnum};
use export_core::Layout;
use export_core::simbev2x::{Options, Palette, SimBev2x, State};

use crate::args::CommonArgs;

/// What the layout takes.
#[derive(Debug, Args)]
pub(crate) struct SimBev2xArgs {
    #[command(flatten)]
    common: CommonArgs,
    /// As before or after SimBEV2X's post-processing.
    #[arg(long, value_enum, default_value = "processed")]
    state: StateWord,
    /// Colours of the pictures of BEV masks.
    #[arg(long, value_enum, default_value = "plain")]
    palette: PaletteWord,
    /// The folder by which readers will find the dataset (their --path): it stands in the paths of the infos (default: as --dest
    /// is given).
    #[arg(long, value_name = "DIR")]
    path_prefix: Option<String>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum StateWord {
    /// What its generator writes.
    Raw,
    /// With points, validity and difficulty of boxes, combined boxes, filled grids.
    Processed,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum PaletteWord {
    /// Bright colours.
    Plain,
    /// Those of Cityscapes.
    Cityscapes,
}

impl SimBev2xArgs {
    pub(crate) fn split(self) -> (Box<dyn Layout>, CommonArgs) {
        let Self { common, state, palette, path_prefix } = self;
        let state = match state {
            StateWord::Raw => State::Raw,
            StateWord::Processed => State::Processed,
        };
        let palette = match palette {
            PaletteWord::Plain => Palette::Plain,
            PaletteWord::Cityscapes => Palette::Cityscapes,
        };
        let path_prefix = path_prefix.unwrap_or_else(|| common.dest.to_string_lossy().into_owned());
        (Box::new(SimBev2x::new(Options { state, palette, path_prefix })), common)
    }
}
