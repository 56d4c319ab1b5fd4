//! Files that are written beside a store: whole or not at all.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// A file that has no name yet. Dropped before [`OutputFile::finish`], it leaves nothing.
#[derive(Debug)]
pub struct OutputFile {
    file: NamedTempFile,
    path: PathBuf,
}

impl OutputFile {
    /// Begins a file, making its folder where needed.
    ///
    /// # Errors
    /// The folder cannot be made or written to.
    pub fn begin(path: &Path) -> io::Result<Self> {
        let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder)?;
        Ok(Self { file: NamedTempFile::new_in(folder)?, path: path.to_owned() })
    }

    /// Gives the file its name, in the place of what was there.
    ///
    /// # Errors
    /// The file system refuses.
    pub fn finish(self) -> io::Result<()> {
        // Temporary files are private; finished ones are like any other file.
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            self.file.as_file().set_permissions(std::fs::Permissions::from_mode(0o644))?;
        }
        self.file.persist(&self.path).map_err(|e| e.error)?;
        Ok(())
    }

    /// Writes a whole file.
    ///
    /// # Errors
    /// As [`OutputFile::begin`] and [`OutputFile::finish`], or the disk is full.
    pub fn save(path: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut file = Self::begin(path)?;
        file.write_all(bytes)?;
        file.finish()
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_there_whole_or_not_at_all() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("pictures/a.png");
        OutputFile::save(&path, b"first").expect("writes");
        let mut dropped = OutputFile::begin(&path).expect("begins");
        dropped.write_all(b"sec").expect("writes");
        drop(dropped);
        assert_eq!(std::fs::read(&path).expect("is there"), b"first");
        assert_eq!(path.parent().expect("a folder").read_dir().expect("is a folder").count(), 1);
        OutputFile::save(&path, b"third").expect("writes");
        assert_eq!(std::fs::read(&path).expect("is there"), b"third");
        // A folder stands in the place of the file.
        assert!(OutputFile::save(folder.path(), b"").is_err());
    }
}
