//! The other programs of this build: files beside this one, or this file under another name.

use std::ffi::OsStr;
use std::io;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether this file is all programs of its build.
static IS_ALL: AtomicBool = AtomicBool::new(false);

/// Says that this file is all programs of its build: which of them runs, its name decides.
pub fn declare_all_programs() {
    IS_ALL.store(true, Ordering::Relaxed);
}

/// Whether this file is all programs of its build.
pub(crate) fn is_all_programs() -> bool {
    IS_ALL.load(Ordering::Relaxed)
}

/// The name of a program by the first of its words: the last part of a path, and the last word of
/// `convoy export`, which is how `convoy` calls the programs that it starts.
#[must_use]
pub fn name_of(typed: &OsStr) -> String {
    let file = Path::new(typed).file_name().unwrap_or_default().to_string_lossy().into_owned();
    file.rsplit(' ').next().unwrap_or_default().to_owned()
}

/// The command that starts another program of this build, by its name.
///
/// # Errors
/// Nobody knows where this program lies.
pub fn program_beside(name: &str) -> io::Result<Command> {
    let this = std::env::current_exe()?;
    let mut command = Command::new(file_of(&this, name));
    command.arg0(this.with_file_name(name));
    Ok(command)
}

/// The file in which a program of this build lies, by the file of the one that runs.
pub(crate) fn file_of(this: &Path, name: &str) -> PathBuf {
    if is_all_programs() { this.to_owned() } else { this.with_file_name(name) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_known_by_paths_and_by_what_people_type() {
        for (typed, name) in [
            ("bev-gt", "bev-gt"),
            ("/opt/our programs/convoy", "convoy"),
            ("convoy export", "export"),
            ("./convoy preview", "preview"),
            ("", ""),
        ] {
            assert_eq!(name_of(OsStr::new(typed)), name, "{typed}");
        }
    }
}
