//! Digests of a store's shards and of exported files. Left out is what names versions of the code: it differs
//! with every number of `versions.toml`, which these digests are to prove.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;

use schema::is_imported;
use schema::tables::SceneTileRow;
use store::{Manifest, Output, Store, hash_bytes, keys};

/// By stage and key of a shard, the BLAKE3 of its bytes.
pub(super) type Digests = BTreeMap<(String, String), String>;

/// The program that wrote imported shards, whichever stage they stand for.
pub(super) const IMPORT: &str = "import";

/// Many small files that are made alike have one digest for all.
const TOGETHER: [(&str, &str); 3] = [("stats/figures/", ".svg"), ("stats/", ".csv"), ("stats/", ".parquet")];

/// Adds every shard that a manifest of a store names, under keys that begin with a prefix.
pub(super) fn add_store(digests: &mut Digests, root: &Path, prefix: &str) {
    let store = Store::open(root).expect("is a folder");
    let mut together: BTreeMap<(String, String), String> = BTreeMap::new();
    for manifest in manifests(root) {
        let stage = if is_imported(&manifest.code_version) { IMPORT } else { &manifest.stage };
        for output in &manifest.outputs {
            let digest = digest(&store, &manifest, output);
            let key = format!("{prefix}{}", without_set(&output.key));
            let group = TOGETHER.iter().find(|(folder, end)| {
                output.key.strip_prefix(folder).is_some_and(|name| !name.contains('/') && name.ends_with(end))
            });
            if let Some((folder, end)) = group {
                let text = together.entry((stage.to_owned(), format!("{prefix}{folder}*{end}"))).or_default();
                writeln!(text, "{key} {digest}").expect("writes");
            } else {
                let other = digests.insert((stage.to_owned(), key.clone()), digest);
                assert_eq!(other, None, "{key} is there twice");
            }
        }
    }
    digests.extend(together.into_iter().map(|(key, text)| (key, hash_bytes(text.as_bytes()))));
}

/// All manifests below a folder, by path. What they say of versions and inputs is not looked at.
fn manifests(root: &Path) -> Vec<Manifest> {
    let files =
        walkdir::WalkDir::new(root).sort_by_file_name().into_iter().map(|file| file.expect("is listed"));
    let is_manifest = |path: &Path| {
        path.ends_with("_manifest.json") || path.parent().is_some_and(|folder| folder.ends_with("_manifests"))
    };
    let paths = files.map(walkdir::DirEntry::into_path).filter(|path| path.is_file() && is_manifest(path));
    paths
        .map(|path| serde_json::from_slice(&fs::read(path).expect("reads")).expect("is a manifest"))
        .collect()
}

/// The folder of a set of tiles is named by what they are made from, versions of the code too.
fn without_set(key: &str) -> String {
    match key.strip_prefix("tiles/").and_then(|rest| rest.split_once('/')) {
        Some((_, rest)) => format!("tiles/*/{rest}"),
        None => key.to_owned(),
    }
}

fn digest(store: &Store, manifest: &Manifest, output: &Output) -> String {
    let text = || {
        let bytes = store.read(&output.key).expect("reads").expect("is there");
        String::from_utf8(bytes).expect("is text")
    };
    let without = |is_unstable: fn(&str) -> bool| {
        let text = text();
        let kept: Vec<&str> = text.lines().filter(|line| !is_unstable(line)).collect();
        hash_bytes(kept.join("\n").as_bytes())
    };
    match output.key.as_str() {
        keys::DATASET => without(|line| line.contains("\"code_version\"")),
        "README.md" => without(is_of_versions),
        key if key.ends_with("/log/tiles.parquet") => {
            // It names the set of tiles and digests of their manifests; the tiles' own shards have digests
            // here.
            let rows: Vec<SceneTileRow> = store.read_rows(manifest, key).expect("reads");
            let lines = rows.iter().map(|t| format!("{} {} {} {}\n", t.x, t.y, t.first_id, t.objects));
            hash_bytes(lines.collect::<String>().as_bytes())
        }
        _ => output.blake3.clone(),
    }
}

/// A dataset card says in two lines which program made it, and in a table which code each stage is of.
fn is_of_versions(line: &str) -> bool {
    let is_of_stage = |stage: &str| line.starts_with(&format!("| {stage} | `"));
    line.contains("Made with Convoy")
        || runner::Graph::get().stages.iter().any(|stage| is_of_stage(stage.name))
}

/// Adds the files of an export, one digest a folder: there are hundreds.
pub(super) fn add_export(digests: &mut Digests, dest: &Path, layout: &str) {
    let mut folders: BTreeMap<String, String> = BTreeMap::new();
    for (name, digest) in convoy_tests::digests(dest) {
        // Records of the export and log tables as they stand in the store: both name versions of the code.
        if name.starts_with(".convoy-export/") || name.starts_with("simbev2x/logs/") {
            continue;
        }
        let folder = name.rsplit_once('/').map_or_else(String::new, |(folder, _)| format!("{folder}/"));
        writeln!(folders.entry(folder).or_default(), "{name} {digest}").expect("writes");
    }
    for (folder, text) in folders {
        let key = ("export".to_owned(), format!("{layout}/{folder}*"));
        digests.insert(key, hash_bytes(text.as_bytes()));
    }
}
