//! The Python of this machine, and which of the packages it has that something here is made for.

use std::process::{Command, Stdio};

/// Packages by the names that are imported, with what each is for.
const PACKAGES: [(&str, &str); 10] = [
    ("convoy", "reading datasets: pip install the wheel of this release"),
    ("numpy", "reading datasets"),
    ("pyarrow", "reading datasets"),
    ("PIL", "camera images in Python: pip install pillow"),
    ("torch", "training: convoy.torch, python/baseline"),
    ("pandas", "tables as data frames"),
    ("polars", "tables as data frames"),
    ("matplotlib", "plots"),
    ("rerun", "scenes in the Rerun viewer: pip install rerun-sdk"),
    ("ray", "convoy submit --engine ray"),
];

/// Prints a line for each package that is named: its name, and its version or nothing.
const QUESTION: &str = "
import importlib.metadata as m, importlib.util as u, sys
owners = m.packages_distributions()
print('%d.%d.%d' % sys.version_info[:3])
for name in sys.argv[1:]:
    there = u.find_spec(name) is not None
    of = owners.get(name, [])
    print(name, (m.version(of[0]) if of else 'no version') if there else '')
";

/// Rows of the table: name, what there is, what it is for.
pub(super) fn rows() -> Vec<(String, String, &'static str)> {
    let program = std::env::var("CONVOY_PYTHON").ok().filter(|program| !program.is_empty());
    let program = program.unwrap_or_else(|| "python3".to_owned());
    let mut question = Command::new(&program);
    question.args(["-c", QUESTION]).args(PACKAGES.map(|(name, _)| name));
    let asked = question.stdin(Stdio::null()).stderr(Stdio::null()).output();
    let Some(answer) = asked.ok().filter(|output| output.status.success()) else {
        let why = format!("{program}: not found, or older than 3.10");
        return vec![(
            "python".to_owned(),
            why,
            "needed only for reading datasets in Python (3.11 or later)",
        )];
    };
    let text = String::from_utf8_lossy(&answer.stdout).into_owned();
    let mut lines = text.lines();
    let version = lines.next().unwrap_or_default();
    let mut rows =
        vec![("python".to_owned(), format!("{version} ({program})"), "3.11 or later reads datasets")];
    for ((name, enables), line) in PACKAGES.iter().zip(lines) {
        let version = line.strip_prefix(name).unwrap_or_default().trim();
        let found = if version.is_empty() { "not installed" } else { version };
        rows.push((format!("  {name}"), found.to_owned(), *enables));
    }
    rows
}
