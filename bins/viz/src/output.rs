//! Files that are written.

use std::io::{self, Write};
use std::path::Path;

use crate::error::VizError;

/// A file that has no name yet, in the folder of a path.
pub(crate) fn begin(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    tempfile::NamedTempFile::new_in(folder)
}

/// Gives a file its name.
pub(crate) fn finish(file: tempfile::NamedTempFile, path: &Path) -> io::Result<()> {
    // Temporary files are private; finished ones are like any other file.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        file.as_file().set_permissions(std::fs::Permissions::from_mode(0o644))?;
    }
    file.persist(path).map_err(|e| e.error)?;
    Ok(())
}

/// Writes a file whole or not at all, readable by all, making its folder where needed.
pub(crate) fn save(path: &Path, bytes: &[u8]) -> Result<(), VizError> {
    let written = begin(path).and_then(|mut file| {
        file.write_all(bytes)?;
        finish(file, path)
    });
    written.map_err(|source| VizError::Write { path: path.to_owned(), source })
}
