//! Towns as OpenDRIVE files, and pictures of maps.

use std::path::{Path, PathBuf};

use clap::Subcommand;
use mapview::{ViewOptions, Window};
use opendrive::{Map, Network};
use runner::{At, Place};
use town::TownParameters;

use crate::files::{Fault, exit_code, write_file};

/// Commands about maps.
#[derive(Debug, Subcommand)]
pub(crate) enum MapCommand {
    /// Generates a town and writes it as an OpenDRIVE file.
    Town {
        /// Name of one of our towns, such as convoy/03.
        #[arg(
            long,
            value_name = "NAME",
            required_unless_present = "parameters",
            conflicts_with = "parameters"
        )]
        name: Option<String>,
        /// A town of your own: a file such as those in lib/map/town/towns.
        #[arg(long, value_name = "FILE")]
        parameters: Option<PathBuf>,
        /// Seed instead of the town's own.
        #[arg(long, value_name = "N")]
        seed: Option<u64>,
        /// The file to write: .xodr.
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
        /// A picture of it: .svg or .png.
        #[arg(long, value_name = "FILE")]
        picture: Option<PathBuf>,
    },
    /// Writes all our towns as OpenDRIVE files, or draws them, or both.
    Towns {
        /// The folder to write them to; `convoy/03` becomes convoy_03.xodr.
        #[arg(long, value_name = "DIR", required_unless_present = "pictures")]
        dest: Option<PathBuf>,
        /// A folder for a picture of each.
        #[arg(long, value_name = "DIR")]
        pictures: Option<PathBuf>,
        /// Kind of the pictures.
        #[arg(long, value_name = "KIND", default_value = "svg", value_parser = ["svg", "png"])]
        format: String,
        /// Longer side of the map in the pictures, pixels.
        #[arg(long, value_name = "PX", default_value_t = 1600, requires = "pictures", value_parser = clap::value_parser!(u32).range(120..=12_000))]
        size: u32,
    },
    /// Draws an OpenDRIVE file or one of our towns from above.
    MapPicture {
        /// A .xodr or .xodr.gz file, or a name such as convoy/03.
        #[arg(long, value_name = "FILE")]
        map: PathBuf,
        /// The picture: .svg or .png.
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
        /// Only the part around a point: metres east and north.
        #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = point)]
        around: Option<[f64; 2]>,
        /// Half the side of that part, metres.
        #[arg(long, value_name = "M", default_value_t = 100.0, requires = "around")]
        radius: f64,
        /// Longer side of the map in the picture, pixels.
        #[arg(long, value_name = "PX", default_value_t = 1600, value_parser = clap::value_parser!(u32).range(120..=12_000))]
        size: u32,
    },
}

/// Runs a command; its exit code.
pub(crate) fn run(command: MapCommand) -> u8 {
    let result = match command {
        MapCommand::Town { name, parameters, seed, out, picture } => parameters_of(name, parameters)
            .and_then(|p| {
                town_file(&seeded(p, seed), Some(&out), picture.as_deref(), &ViewOptions::default())
            }),
        MapCommand::Towns { dest, pictures, format, size } => {
            let options = ViewOptions { size_px: f64::from(size), ..ViewOptions::default() };
            all_towns(dest.as_deref(), pictures.as_deref(), &format, &options)
        }
        MapCommand::MapPicture { map, out, around, radius, size } => {
            let window = around.map(|centre_m| Window { centre_m, radius_m: radius });
            map_picture(&map, &out, ViewOptions { size_px: f64::from(size), window, title: None })
        }
    };
    exit_code(result)
}

pub(crate) fn point(text: &str) -> Result<[f64; 2], String> {
    let number = |t: &str| t.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    match text.split(',').map(number).collect::<Vec<_>>()[..] {
        [Some(x), Some(y)] => Ok([x, y]),
        _ => Err("expected two numbers such as 120,-45".to_owned()),
    }
}

fn named(name: &str) -> Result<TownParameters, Fault> {
    town::named(name).ok_or_else(|| {
        Fault::Usage(format!("no town is called `{name}`; there are {}", town::names().join(", ")))
    })
}

/// The parameters of a town that is named, or described in a file.
fn parameters_of(name: Option<String>, file: Option<PathBuf>) -> Result<TownParameters, Fault> {
    let Some(path) = file else { return named(&name.unwrap_or_default()) };
    let text = std::fs::read_to_string(&path).map_err(|source| Fault::Read { path: path.clone(), source })?;
    TownParameters::from_toml(&text)
        .map_err(|source| Fault::Town { name: path.display().to_string(), source })
}

fn seeded(parameters: TownParameters, seed: Option<u64>) -> TownParameters {
    TownParameters { seed: seed.unwrap_or(parameters.seed), ..parameters }
}

fn generate(parameters: &TownParameters) -> Result<Network, Fault> {
    town::generate(parameters).map_err(|source| Fault::Town { name: parameters.name.clone(), source })
}

fn town_file(
    parameters: &TownParameters,
    out: Option<&Path>,
    picture: Option<&Path>,
    options: &ViewOptions,
) -> Result<(), Fault> {
    if let Some(path) = picture {
        Kind::of(path)?;
    }
    let network = generate(parameters)?;
    if let Some(path) = out {
        write_file(path, opendrive::write(&network).as_bytes())?;
    }
    if let Some(path) = picture {
        draw(network, path, options)?;
    }
    Ok(())
}

fn all_towns(
    dest: Option<&Path>,
    pictures: Option<&Path>,
    format: &str,
    options: &ViewOptions,
) -> Result<(), Fault> {
    for name in town::names() {
        let stem = name.replace('/', "_");
        let picture = pictures.map(|folder| folder.join(format!("{stem}.{format}")));
        let out = dest.map(|folder| folder.join(format!("{stem}.xodr")));
        town_file(&named(name)?, out.as_deref(), picture.as_deref(), options)?;
    }
    Ok(())
}

fn map_picture(map: &Path, out: &Path, mut options: ViewOptions) -> Result<(), Fault> {
    Kind::of(out)?;
    let name = map.to_string_lossy();
    let network = if let Some(parameters) = town::named(&name) {
        generate(&parameters)?
    } else {
        let io = |source| Fault::Read { path: map.to_owned(), source };
        let bytes = std::fs::read(map).map_err(io)?;
        let network = opendrive::read_bytes(&bytes).at(|| Place::file(name.as_ref()))?;
        if network.header.name.trim().is_empty() {
            let stem = map.file_name().unwrap_or_default().to_string_lossy();
            options.title = stem.split('.').next().map(str::to_owned);
        }
        network
    };
    draw(network, out, &options)
}

/// Kinds of pictures, by the ending of their file.
#[derive(Clone, Copy)]
enum Kind {
    Svg,
    Png,
}

impl Kind {
    fn of(path: &Path) -> Result<Self, Fault> {
        match path.extension().and_then(|e| e.to_str()) {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            _ => Err(Fault::Usage(format!("{}: a picture must end in .svg or .png", path.display()))),
        }
    }
}

fn draw(network: Network, path: &Path, options: &ViewOptions) -> Result<(), Fault> {
    let kind = Kind::of(path)?;
    let picture = mapview::draw(&Map::new(network), options);
    let bytes = match kind {
        Kind::Svg => picture.to_svg().into_bytes(),
        Kind::Png => picture.to_png().at(|| Place::file(path.to_string_lossy()))?,
    };
    write_file(path, &bytes)
}
