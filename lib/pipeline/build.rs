//! Computes, for every stage, a digest of the sources it is built from.
//!
//! A stage's output depends on the code of its binary and of every crate of ours below it, and on the versions of
//! all other crates (`Cargo.lock`). The digest stands in each manifest, so a change of code makes exactly the
//! stages stale that it can reach.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    let root = here.join("../..");
    let mut table = String::from("const CODE_VERSIONS: &[(&str, &str)] = &[\n");
    let version = env::var("CARGO_PKG_VERSION").unwrap_or_default();
    for (binary, crates) in closures(&root)? {
        let mut hasher = blake3::Hasher::new();
        hash_file(&root.join("Cargo.lock"), &root, &mut hasher)?;
        for folder in crates {
            hash_folder(&folder, &root, &mut hasher)?;
        }
        let digest = hasher.finalize().to_hex();
        table.push_str(&format!("    (\"{binary}\", \"{version}+{}\"),\n", &digest.as_str()[..16]));
    }
    table.push_str("];\n");
    println!("cargo::rerun-if-changed={}", root.join("Cargo.lock").display());
    for folder in ["bins", "lib"] {
        println!("cargo::rerun-if-changed={}", root.join(folder).display());
    }
    fs::write(out.join("code_versions.rs"), table)
}

/// Every binary crate with the folders of our crates it is built from, sorted.
fn closures(root: &Path) -> io::Result<BTreeMap<String, BTreeSet<PathBuf>>> {
    let mut result = BTreeMap::new();
    for binary in folders(&root.join("bins"))? {
        let mut open = vec![binary.clone()];
        let mut seen = BTreeSet::new();
        while let Some(folder) = open.pop() {
            if !seen.insert(folder.clone()) {
                continue;
            }
            open.extend(own_dependencies(&fs::read_to_string(folder.join("Cargo.toml"))?, root));
        }
        let name = binary.file_name().unwrap_or_default().to_string_lossy().into_owned();
        result.insert(name, seen);
    }
    Ok(result)
}

/// Our crates under `[dependencies]`: lines `name.workspace = true` with a folder `lib/name`.
fn own_dependencies(manifest: &str, root: &Path) -> Vec<PathBuf> {
    let mut inside = false;
    let mut found = Vec::new();
    for line in manifest.lines() {
        if line.starts_with('[') {
            inside = line.trim() == "[dependencies]";
        } else if inside && let Some((name, _)) = line.split_once(['.', '=', ' ']) {
            let folder = root.join("lib").join(name.trim());
            if folder.join("Cargo.toml").is_file() {
                found.push(folder);
            }
        }
    }
    found
}

fn folders(parent: &Path) -> io::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(parent)? {
        let path = entry?.path();
        if path.join("Cargo.toml").is_file() {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

fn hash_folder(folder: &Path, root: &Path, hasher: &mut blake3::Hasher) -> io::Result<()> {
    let mut files = Vec::new();
    let mut open = vec![folder.join("src")];
    while let Some(next) = open.pop() {
        let Ok(entries) = fs::read_dir(&next) else { continue };
        for entry in entries {
            let path = entry?.path();
            if path.is_dir() {
                open.push(path);
            } else {
                files.push(path);
            }
        }
    }
    files.push(folder.join("Cargo.toml"));
    files.extend(Some(folder.join("build.rs")).filter(|p| p.is_file()));
    files.sort();
    for file in files {
        hash_file(&file, root, hasher)?;
    }
    Ok(())
}

fn hash_file(file: &Path, root: &Path, hasher: &mut blake3::Hasher) -> io::Result<()> {
    // Names are hashed relative to the workspace: where it is checked out makes no difference.
    let name = file.strip_prefix(root).unwrap_or(file).to_string_lossy().replace('\\', "/");
    let bytes = fs::read(file)?;
    hasher.update(&(name.len() as u64).to_le_bytes());
    hasher.update(name.as_bytes());
    hasher.update(&(bytes.len() as u64).to_le_bytes());
    hasher.update(&bytes);
    Ok(())
}
