//! Pages of the documentation: links that lead somewhere, prose that is no wider than a screen, and commands
//! and options that exist.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Pages that a program writes as a whole.
const WRITTEN: [&str; 2] = ["docs/results.md", "docs/gallery/README.md"];
/// Columns of prose. Tables, examples and pictures may be wider.
const WIDTH: usize = 130;
/// Below it a page is generated; the texts of the code have widths of their own.
const GENERATED: &str = "<!-- generated from the code below this line";

/// What there is to type: targets of the Makefile, programs, and what their `--help` says.
pub(crate) struct Commands {
    targets: BTreeSet<String>,
    /// Of `convoy`, its commands (`convoy-run`) and stages: the help, as snapshots of `tests/across` hold it.
    helps: Vec<(String, String)>,
}

impl Commands {
    /// Reads them.
    pub(crate) fn read(workspace: &Path) -> Result<Self, String> {
        let makefile = read(&workspace.join("Makefile"))?;
        let target = |line: &str| {
            let (name, _) = line.split_once(':')?;
            let is_name = |text: &str| text.chars().all(|c| c.is_ascii_alphanumeric() || c == '-');
            (!name.is_empty() && name.split(' ').all(is_name)).then(|| name.to_owned())
        };
        let targets = makefile.lines().filter_map(target);
        let targets = targets.flat_map(|t| t.split(' ').map(str::to_owned).collect::<Vec<_>>()).collect();
        let folder = workspace.join("tests/across/snapshots");
        let entries = std::fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let mut helps = Vec::new();
        for path in entries.flatten().map(|entry| entry.path()) {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let name = name.strip_prefix("across__help__").and_then(|n| n.strip_suffix(".snap"));
            if let Some(name) = name {
                helps.push((name.to_owned(), read(&path)?));
            }
        }
        Ok(Self { targets, helps })
    }

    fn help(&self, name: &str) -> Option<&str> {
        self.helps.iter().find(|(known, _)| known == name).map(|(_, help)| help.as_str())
    }

    /// What is wrong with a line that is to be typed.
    fn fault(&self, line: &str) -> Option<String> {
        let typed = line.split(" #").next().unwrap_or_default();
        // What is quoted is a value.
        let unquoted: String = typed.split(['"', '\'']).step_by(2).collect();
        let mut words = unquoted.split_whitespace();
        let program = words.next()?.trim_start_matches("target/release/");
        let words: Vec<&str> = words.collect();
        if program == "make" {
            let unknown =
                words.iter().find(|w| w.starts_with(char::is_lowercase) && !self.targets.contains(**w));
            return unknown.map(|word| format!("`make {word}`: the Makefile has no such target"));
        }
        let (name, words) = match (program, words.first()) {
            ("convoy", Some(command)) if !command.starts_with('-') => {
                (format!("convoy-{command}"), &words[1..])
            }
            _ => (program.to_owned(), &words[..]),
        };
        let Some(help) = self.help(&name) else {
            return (program == "convoy").then(|| format!("`{typed}`: there is no such command"));
        };
        if help.contains("\nCommands:\n") {
            return None; // Options of commands of commands stand in no snapshot.
        }
        let option = |word: &&str| {
            let name = word.split('=').next().unwrap_or_default();
            name.starts_with("--")
                && name.len() > 2
                && !help.contains(&format!("{name} "))
                && !help.contains(&format!("{name}\n"))
        };
        let unknown =
            words.iter().map(|word| word.trim_matches(['[', ']', ')', ';', ','])).find(|w| option(w));
        unknown.map(|word| format!("`{name}` has no option {word}"))
    }
}

/// Faults of a page.
pub(crate) fn faults(workspace: &Path, page: &Path, text: &str, commands: &Commands) -> Vec<String> {
    let folder = workspace.join(page).parent().map(PathBuf::from).unwrap_or_default();
    let text = text.split(GENERATED).next().unwrap_or_default();
    let mut faults = Vec::new();
    let mut fence: Option<&str> = None;
    for (number, line) in text.lines().enumerate() {
        let mut tell = |what: String| faults.push(format!("{}:{}: {what}", page.display(), number + 1));
        if let Some(language) = line.trim_start().strip_prefix("```") {
            fence = fence.is_none().then_some(language);
            continue;
        }
        match fence {
            Some("sh") => commands.fault(line).into_iter().for_each(&mut tell),
            Some(_) => {}
            None => {
                let is_wide = line.chars().count() > WIDTH && !WRITTEN.iter().any(|p| page.ends_with(p));
                if is_wide && !line.starts_with(['|', '!', '<']) {
                    tell(format!("prose wider than {WIDTH} columns"));
                }
                for target in links(line) {
                    if let Some(what) = broken(workspace.join(page).as_path(), &folder, target) {
                        tell(what);
                    }
                }
            }
        }
    }
    faults
}

/// Targets of the links of a line, outside backquotes.
fn links(line: &str) -> Vec<&str> {
    let mut found = Vec::new();
    for text in line.split('`').step_by(2) {
        for (at, _) in text.match_indices("](") {
            let target = &text[at + 2..];
            found.extend(target.find(')').map(|end| &target[..end]));
        }
    }
    found
}

/// Why a link leads nowhere.
fn broken(page: &Path, folder: &Path, target: &str) -> Option<String> {
    if target.contains("://") || target.starts_with("mailto:") {
        return None;
    }
    let (path, part) = target.split_once('#').unwrap_or((target, ""));
    let file = if path.is_empty() { page.to_owned() } else { folder.join(path) };
    if !file.exists() {
        return Some(format!("a link to {target}, which is not there"));
    }
    if part.is_empty() || file.extension().is_none_or(|e| e != "md") {
        return None;
    }
    let text = std::fs::read_to_string(&file).ok()?;
    let headings = text.lines().filter(|line| line.starts_with('#'));
    let is_there = headings.map(|h| anchor(h.trim_start_matches('#'))).any(|a| a == part);
    (!is_there).then(|| format!("a link to {target}: {path} has no such heading"))
}

/// The anchor that GitHub gives to a heading.
fn anchor(heading: &str) -> String {
    let lower = heading.trim().to_lowercase();
    let kept = lower.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// Pages that people read: those of the root and of `docs`.
pub(crate) fn pages(workspace: &Path) -> Vec<PathBuf> {
    let list = |folder: &Path| {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| entry.path()).collect::<Vec<_>>()
    };
    let docs = list(&workspace.join("docs"));
    let below = docs.iter().filter(|path| path.is_dir()).flat_map(|folder| list(folder));
    let mut found: Vec<PathBuf> = list(workspace).into_iter().chain(below).chain(docs.clone()).collect();
    found.retain(|path| path.extension().is_some_and(|e| e == "md"));
    found.sort();
    found
}

fn read(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Vec<String> {
        let help = "Options:\n      --store <DIR>\n      --force\n".to_owned();
        let commands = Commands {
            targets: BTreeSet::from(["dataset".to_owned()]),
            helps: vec![("convoy-run".to_owned(), help.clone()), ("stats".to_owned(), help)],
        };
        faults(Path::new(env!("CARGO_MANIFEST_DIR")), Path::new("README.md"), text, &commands)
    }

    #[test]
    fn what_cannot_be_typed_is_told() {
        let good = "```sh\nmake dataset CONFIG=x ARGS=\"-n rain\" # 1\nconvoy run --store x --force\nstats --store=y\nls --all\n```\n";
        assert_eq!(of(good), [""; 0]);
        assert_eq!(of("```sh\nmake nothing\n```").len(), 1);
        assert_eq!(of("```sh\nconvoy rnu\n```").len(), 1);
        assert_eq!(of("```sh\ntarget/release/convoy run --stor x\n```").len(), 1);
        assert_eq!(of("```text\nconvoy rnu\n```"), [""; 0]);
    }

    #[test]
    fn links_lead_to_files_and_headings() {
        assert_eq!(of("[a](Cargo.toml), [b](https://x.y/z), [c](README.md#layers)"), [""; 0]);
        assert_eq!(of("[a](nothing.md)").len(), 1);
        assert_eq!(of("[a](README.md#no-such-heading)").len(), 1);
        assert_eq!(of("`[a](nothing.md)`"), [""; 0]);
        assert_eq!(anchor(" BEV masks with `bev.rule`: (1)"), "bev-masks-with-bevrule-1");
    }

    #[test]
    fn prose_is_held_to_the_width() {
        let long = "word ".repeat(30);
        assert_eq!(of(&long).len(), 1);
        assert_eq!(of(&format!("| {long} |\n```\n{long}\n```\n{GENERATED}\n{long}")), [""; 0]);
    }
}
