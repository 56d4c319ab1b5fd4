//! The dataset configuration: TOML in, [`DatasetSettings`] out, every fault at once with its line. YAML of
//! SimBEV2X is translated first.

use std::path::Path;

use crate::dataset::{DatasetSettings, read};
use crate::reader::{Fault, Source, texts_of, with_documents};
use crate::{rig_keys, yaml};

/// Reads a configuration file, and what it asks for in vain (keys of a YAML file that have no effect here).
/// Files whose names end in `.yaml` or `.yml` are read as SimBEV2X configurations.
///
/// # Errors
/// All faults of the file, with line numbers.
pub fn load(path: &Path) -> Result<(DatasetSettings, Vec<Fault>), Vec<Fault>> {
    let file = path.display().to_string();
    let text = std::fs::read_to_string(path)
        .map_err(|e| vec![Fault { file: file.clone(), line: None, message: format!("cannot read: {e}") }])?;
    let is_yaml =
        path.extension().is_some_and(|e| e.eq_ignore_ascii_case("yaml") || e.eq_ignore_ascii_case("yml"));
    if is_yaml { parse_yaml(&text, &file) } else { Ok((parse(&text, &file)?, Vec::new())) }
}

/// Reads a SimBEV2X configuration.
fn parse_yaml(text: &str, file: &str) -> Result<(DatasetSettings, Vec<Fault>), Vec<Fault>> {
    let yaml::Translation { toml, lines, warnings } = yaml::translate(text, file)?;
    let in_yaml = |fault: Fault| Fault {
        line: fault.line.and_then(|line| lines.get(line.checked_sub(1)?).copied()),
        ..fault
    };
    let settings =
        parse(&toml, file).map_err(|faults| faults.into_iter().map(in_yaml).collect::<Vec<_>>())?;
    Ok((settings, warnings))
}

/// Reads a configuration text; `file` is its name in messages, and rigs that it names are files beside it.
///
/// # Errors
/// All faults of the text and of these files, with line numbers.
pub fn parse(text: &str, file: &str) -> Result<DatasetSettings, Vec<Fault>> {
    let whole = Source { written: String::new(), file: file.to_owned(), text: Ok(text.to_owned()) };
    let folder = Path::new(file).parent().unwrap_or(Path::new(""));
    let named = texts_of(text, rig_keys::FILE_KEY);
    let rigs = named.into_iter().filter(|written| !written.is_empty()).map(|written| {
        let path = folder.join(&written);
        let text = std::fs::read_to_string(&path).map_err(|e| e.to_string());
        Source { written, file: path.display().to_string(), text }
    });
    let sources: Vec<Source> = std::iter::once(whole).chain(rigs).collect();
    with_documents(&sources, read)
}

/// Default settings with one scene, for tests.
#[cfg(test)]
pub(crate) fn example_settings() -> DatasetSettings {
    parse("[scenes.train]\n\"convoy/demo\" = 1\n", "example.toml")
        .expect("the smallest configuration is valid")
}

#[cfg(test)]
mod group_tests;
#[cfg(test)]
mod rig_tests;
#[cfg(test)]
mod tests;
