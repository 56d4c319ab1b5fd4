//! The dataset configuration: TOML in, [`DatasetSettings`] out, every fault at once with its line. YAML of
//! SimBEV2X is translated first.

use std::collections::BTreeSet;
use std::path::Path;

use crate::dataset::{DatasetSettings, read};
use crate::document::{Fault, Source, line_of, texts_of};
use crate::reader::with_documents;
use crate::shipped::text_at;
use crate::suspicions::{self, Suspicion};
use crate::{rig_keys, yaml};

/// Reads a configuration file, or one that comes with the programs by its name, and what in it is
/// suspicious: keys that ask for something in vain, or for something that is hardly meant. Files whose
/// names end in `.yaml` or `.yml` are read as SimBEV2X configurations.
///
/// # Errors
/// All faults of the file, with line numbers.
pub fn load(path: &Path) -> Result<(DatasetSettings, Vec<Fault>), Vec<Fault>> {
    let file = path.display().to_string();
    let text = text_at(path).map_err(|e| {
        vec![Fault { file: file.clone(), line: None, message: format!("cannot read: {e}{}", hint(path)) }]
    })?;
    if is_yaml(path) { parse_yaml(&text, &file) } else { parse_whole(&text, &file, false) }
}

/// What else a path without an ending may have been meant as.
fn hint(path: &Path) -> &'static str {
    match path.extension() {
        Some(_) => "",
        None => " (and none of this name comes with the programs: `convoy config list`)",
    }
}

fn is_yaml(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("yaml") || e.eq_ignore_ascii_case("yml"))
}

/// What is suspicious at keys of a configuration file for reasons that are not in the file, as it is said:
/// with the line of each key, or of the table that it would stand in.
#[must_use]
pub fn suspicions_in(path: &Path, found: &[Suspicion]) -> Vec<Fault> {
    let text = text_at(path).unwrap_or_default();
    let file = path.display().to_string();
    let translated = if is_yaml(path) { yaml::translate(&text, &file).ok() } else { None };
    let line = |key: &str| match &translated {
        Some(yaml) => line_of(&yaml.toml, key).and_then(|line| yaml.lines.get(line - 1).copied()),
        None => line_of(&text, key),
    };
    let said = |s: &Suspicion| Fault { file: file.clone(), line: line(&s.key), message: s.message.clone() };
    found.iter().map(said).collect()
}

/// The files of rigs that a configuration file names, as it writes them: from its folder, or whole paths.
///
/// # Errors
/// The file cannot be read.
pub fn rigs_named_in(path: &Path) -> std::io::Result<BTreeSet<String>> {
    // SimBEV2X's configurations name none.
    let mut named = match is_yaml(path) {
        true => BTreeSet::new(),
        false => texts_of(&text_at(path)?, rig_keys::FILE_KEY),
    };
    named.remove("");
    Ok(named)
}

/// Reads a SimBEV2X configuration.
fn parse_yaml(text: &str, file: &str) -> Result<(DatasetSettings, Vec<Fault>), Vec<Fault>> {
    let yaml::Translation { toml, lines, warnings } = yaml::translate(text, file)?;
    let in_yaml = |fault: Fault| Fault {
        line: fault.line.and_then(|line| lines.get(line.checked_sub(1)?).copied()),
        ..fault
    };
    let (settings, more) = parse_whole(&toml, file, true)
        .map_err(|faults| faults.into_iter().map(in_yaml).collect::<Vec<_>>())?;
    Ok((settings, warnings.into_iter().chain(more.into_iter().map(in_yaml)).collect()))
}

/// Reads a configuration text; `file` is its name in messages, and rigs that it names are files beside it.
///
/// # Errors
/// All faults of the text and of these files, with line numbers.
pub fn parse(text: &str, file: &str) -> Result<DatasetSettings, Vec<Fault>> {
    Ok(parse_whole(text, file, false)?.0)
}

/// Reads a configuration text, and what in it is suspicious; `names_all`: see [`Source`].
fn parse_whole(text: &str, file: &str, names_all: bool) -> Result<(DatasetSettings, Vec<Fault>), Vec<Fault>> {
    let (written, text_of_all) = (String::new(), Ok(text.to_owned()));
    let whole = Source { written, file: file.to_owned(), text: text_of_all, names_all };
    let folder = Path::new(file).parent().unwrap_or(Path::new(""));
    let named = texts_of(text, rig_keys::FILE_KEY);
    let rigs = named.into_iter().filter(|written| !written.is_empty()).map(|written| {
        let path = folder.join(&written);
        let text = std::fs::read_to_string(&path).map_err(|e| e.to_string());
        Source { written, file: path.display().to_string(), text, names_all: false }
    });
    let sources: Vec<Source> = std::iter::once(whole).chain(rigs).collect();
    with_documents(&sources, |root| {
        let all = read(root);
        suspicions::look(root, &all);
        all
    })
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
mod suspicion_tests;
#[cfg(test)]
mod tests;
