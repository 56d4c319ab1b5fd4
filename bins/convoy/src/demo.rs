//! The first dataset of who has just installed this: nothing is needed, and it says how to go on.

use std::path::{Path, PathBuf};

use arguments::device::DeviceArgs;
use arguments::stage::Progress;
use runner::{EXIT_DONE, EXIT_USAGE, STAMP_LEN, say};
use settings::Shipped;

use crate::stores::{RunArgs, run_stages};

/// The configuration that is made.
const CONFIGURATION: &str = "tiny";

/// What `convoy demo` takes.
#[derive(Debug, clap::Args)]
pub(crate) struct DemoArgs {
    /// The folder to write; what is there already is kept.
    #[arg(long, value_name = "DIR", default_value = "convoy-demo")]
    out: PathBuf,
    #[command(flatten)]
    device: DeviceArgs,
    /// Worker threads (default: all cores).
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// How to show progress.
    #[arg(long, value_enum, default_value = "auto")]
    progress: Progress,
}

/// Makes the dataset and says how to look at it; the exit code.
pub(crate) fn run(args: DemoArgs, stamp: &[u8; STAMP_LEN]) -> u8 {
    let DemoArgs { out, device, threads, progress } = args;
    let Some(config) = Shipped::named(CONFIGURATION).map(Shipped::path) else { return EXIT_USAGE };
    let code = run_stages(&RunArgs::of_dataset(config, out.clone(), device, (threads, progress)), stamp);
    if code == EXIT_DONE {
        next_steps(&out).iter().for_each(|line| say(line));
    }
    code
}

/// What can be done with the dataset.
fn next_steps(store: &Path) -> [String; 17] {
    let store = store.display();
    [
        String::new(),
        "Look at it:".to_owned(),
        format!("  convoy view {store}                                  (in the browser)"),
        format!("  convoy preview --store {store} --out preview.jpg     (a frame on one sheet)"),
        String::new(),
        "Open it from Python (with numpy and pyarrow):".to_owned(),
        "  import convoy".to_owned(),
        format!("  dataset = convoy.Dataset({:?})", store.to_string()),
        "  frame = dataset.scene(0).frame(10)".to_owned(),
        "  agent = frame.agent(\"vehicle_0\")".to_owned(),
        "  print(agent.sensors, agent.points().shape, len(frame.boxes(valid=True)))".to_owned(),
        String::new(),
        "Make a larger one, or your own:".to_owned(),
        "  convoy run --config demo --store demo".to_owned(),
        "  convoy config show demo > my.toml; convoy run --config my.toml --store mine".to_owned(),
        "  convoy forecast --config my.toml                     (what that costs)".to_owned(),
        String::new(),
    ]
}
