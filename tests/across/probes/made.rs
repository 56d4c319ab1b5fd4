//! A probe's store, made by the real programs, and the digests of all that is in it.

use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::process::Command;

use convoy_tests::{Outcome, program, workspace};
use store::hash_bytes;

use super::digests::{Digests, add_export, add_store};
use super::{Probe, folder};

/// A digest of what a probe is: its configuration but for comments, its maps and packs.
pub(super) fn input(probe: &Probe) -> String {
    let path = folder().join(format!("{}.toml", probe.name));
    let text = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let table: toml::Table = text.parse().unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut of = format!("{table}\n{:?} {}\n", probe.exports, probe.import);
    for (name, digest) in probe.maps.iter().flat_map(|maps| convoy_tests::digests(&workspace().join(maps))) {
        of += &format!("{name} {digest}\n");
    }
    hash_bytes(of.as_bytes())
}

/// Makes everything of a probe in a folder of its own.
pub(super) fn digests(probe: &Probe) -> Digests {
    let temporary = tempfile::tempdir().expect("a temporary folder");
    let at = temporary.path();
    let (store, config) = (at.join("store"), folder().join(format!("{}.toml", probe.name)));
    let mut args: Vec<&OsStr> = vec!["run".as_ref()];
    let maps = probe.maps.map(|maps| workspace().join(maps));
    if let Some(maps) = &maps {
        args.extend(["--maps".as_ref(), maps.as_os_str()]);
    }
    run("convoy", &[&args[..], &on(&config, &store)].concat());
    let mut made = Digests::new();
    add_store(&mut made, &store, "");

    for export in probe.exports {
        let (layout, dest) = (export[0], at.join("export").join(export[0]));
        let args: Vec<&OsStr> = export.iter().map(OsStr::new).collect();
        let places = ["--store".as_ref(), store.as_os_str(), "--dest".as_ref(), dest.as_os_str()];
        run("export", &[&args[..], &places].concat());
        add_export(&mut made, &dest, layout);
        if probe.import && probe.exports.last() == Some(export) {
            let imported = at.join("imported");
            let places = ["--source".as_ref(), dest.as_os_str(), "--store".as_ref(), imported.as_os_str()];
            run("import", &[&[layout.as_ref()], &places[..]].concat());
            // Labels that need no log are made of imports as of any store.
            for stage in ["merge-tracks", "stats"] {
                run(stage, &on(&config, &imported));
            }
            add_store(&mut made, &imported, "imported/");
        }
    }
    made
}

fn on<'a>(config: &'a Path, store: &'a Path) -> [&'a OsStr; 4] {
    ["--config".as_ref(), config.as_os_str(), "--store".as_ref(), store.as_os_str()]
}

fn run(name: &str, args: &[&OsStr]) {
    let mut command = Command::new(program(name));
    // Environment variables of the user who runs the tests would override the configuration.
    for (variable, _) in std::env::vars_os().filter(|(v, _)| v.to_string_lossy().starts_with("CONVOY_")) {
        command.env_remove(variable);
    }
    command.args(args).args(["--threads", "2", "--progress", "none"]);
    Outcome::of(&command.output().expect("the program starts")).expect_done();
}
