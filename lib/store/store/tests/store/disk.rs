//! What only a file system has: names of unfinished files, processes, folders.

use std::fs;
use std::path::Path;

use store::{Area, Backend, Disk};

use crate::common::STAGE;

fn files(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = walkdir::WalkDir::new(folder).into_iter().filter_map(Result::ok);
    entries.map(walkdir::DirEntry::into_path).filter(|p| p.is_file()).collect()
}

#[test]
fn what_a_living_process_writes_is_not_swept() {
    let dir = tempfile::tempdir().expect("temp dir");
    let disk = Disk::new(dir.path());
    let sink = disk.create("a/table.parquet", STAGE).expect("creates");
    let ours = files(dir.path()).pop().expect("is being written");
    // The same leftover, had another process made it.
    let mut other = std::process::Command::new("sleep").arg("600").spawn().expect("sleep runs");
    let name = ours.file_name().expect("has a name").to_string_lossy().into_owned();
    let own_id = format!("~{}~", std::process::id());
    assert!(name.contains(&own_id), "{name}");
    let theirs = ours.with_file_name(name.replace(&own_id, &format!("~{}~", other.id())));
    fs::write(&theirs, "half").expect("writes");
    // That of a container of the same name, whose processes have numbers of their own.
    let (start, end) = name.split_once('+').expect("marks the machine");
    let end = end[8..].replace(&own_id, "~4000000000~");
    let elsewhere = ours.with_file_name(format!("{start}+00000000{end}"));
    fs::write(&elsewhere, "half").expect("writes");
    drop(sink);
    assert_eq!(disk.sweep(Area::Below(""), STAGE).expect("sweeps"), 0);
    let abandoned = || disk.unfinished("").expect("lists").into_iter().filter(|seen| seen.abandoned).count();
    assert!(disk.unfinished("").expect("lists").len() == 2 && abandoned() == 0);
    other.kill().expect("is killed");
    other.wait().expect("is reaped");
    assert_eq!(abandoned(), 1);
    assert_eq!(disk.sweep(Area::Below(""), "bev-gt").expect("sweeps"), 0, "not its owner");
    assert_eq!(disk.sweep(Area::Below(""), STAGE).expect("sweeps"), 1);
    assert!(!theirs.exists() && elsewhere.exists());
}

#[test]
fn only_our_unfinished_files_are_hidden() {
    let dir = tempfile::tempdir().expect("temp dir");
    let disk = Disk::new(dir.path());
    for name in ["notes.tmp", ".hidden", ".a~b.tmp"] {
        fs::write(dir.path().join(name), "x").expect("writes");
    }
    let sink = disk.create("table.parquet", STAGE).expect("creates");
    assert_eq!(disk.keys("").expect("lists"), [".a~b.tmp", ".hidden", "notes.tmp"]);
    assert!(disk.put_if_absent("table.parquet", STAGE, b"whole").expect("puts"));
    drop(sink);
    assert_eq!(files(dir.path()).len(), 4, "a put leaves no other name behind");
}

/// Users put scenes on other disks by links.
#[cfg(unix)]
#[test]
fn what_is_behind_links_is_listed() {
    use std::os::unix::fs::symlink;
    let (dir, elsewhere) = (tempfile::tempdir().expect("temp dir"), tempfile::tempdir().expect("temp dir"));
    let disk = Disk::new(dir.path());
    fs::create_dir_all(elsewhere.path().join("sensors")).expect("makes");
    fs::write(elsewhere.path().join("sensors/a"), "abc").expect("writes");
    fs::create_dir_all(dir.path().join("scenes/0001")).expect("makes");
    symlink(elsewhere.path(), dir.path().join("scenes/0000")).expect("links");
    symlink(elsewhere.path().join("sensors"), dir.path().join("scenes/0001/sensors")).expect("links");
    symlink(elsewhere.path().join("gone"), dir.path().join("scenes/0001/gone")).expect("links");
    symlink(dir.path().join("scenes"), dir.path().join("scenes/0001/round")).expect("links");
    assert_eq!(disk.keys("scenes").expect("lists"), ["scenes/0000/sensors/a", "scenes/0001/sensors/a"]);
    assert_eq!(disk.keys("scenes/0000").expect("lists"), ["scenes/0000/sensors/a"]);
    assert_eq!(disk.list("scenes/0001").expect("lists").objects[0].bytes, 3);
    assert_eq!(disk.folders("scenes").expect("lists"), ["0000", "0001"]);
}

#[test]
fn folders_go_with_what_was_in_them() {
    let dir = tempfile::tempdir().expect("temp dir");
    let disk = Disk::new(dir.path());
    assert!(disk.put_if_absent("a/b/c", STAGE, b"").expect("puts"));
    disk.remove("a/b/c").expect("removes");
    disk.remove("a/b/c").expect("is gone");
    assert!(dir.path().exists() && !dir.path().join("a").exists());
}
