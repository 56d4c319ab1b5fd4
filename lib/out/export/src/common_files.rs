//! The files of an export that belong to no unit: tables, lists, what all scenes have in common. They are
//! made again after every run.

use std::collections::BTreeSet;
use std::fs::OpenOptions;

use crate::disk::{inside, lines, put, remove, unfinished, write_error};
use crate::unit::ProgressWatch;
use crate::{Destination, ExportError, UnitFiles};

/// Among the records, the names of these files, a line each.
const COMMON: &str = "common.files";
/// The same while they are being made: those of before, and each new one before it is made.
const IN_HAND: &str = "common.journal";

impl Destination {
    /// Starts these files anew; those of before stay until the new ones are whole.
    pub(crate) fn begin_common<'a>(
        &'a self,
        watch: &'a dyn ProgressWatch,
    ) -> Result<UnitFiles<'a>, ExportError> {
        let path = self.records().join(IN_HAND);
        let known: String = self.common()?.iter().map(|name| format!("{name}\n")).collect();
        put(&path, known.as_bytes())?;
        let journal = OpenOptions::new().append(true).open(&path);
        let journal = journal.map_err(|source| write_error(&path, "open", source))?;
        Ok(UnitFiles::new(self.root(), (path, journal), watch))
    }

    /// Ends them: those of before that are none any more are removed.
    pub(crate) fn end_common(&self, files: UnitFiles<'_>) -> Result<(), ExportError> {
        let made: BTreeSet<String> = files.into_sizes().into_keys().collect();
        let known = self.common()?;
        self.sync()?;
        let names: String = made.iter().map(|name| format!("{name}\n")).collect();
        put(&self.records().join(COMMON), names.as_bytes())?;
        self.remove_all(&known.difference(&made).cloned().collect())?;
        remove(&self.records().join(IN_HAND))
    }

    /// Removes them, those that a killed run has begun among them.
    pub(crate) fn forget_common(&self) -> Result<(), ExportError> {
        self.remove_all(&self.common()?)?;
        remove(&self.records().join(IN_HAND))?;
        remove(&self.records().join(COMMON))
    }

    /// Their names, as far as anybody knows.
    fn common(&self) -> Result<BTreeSet<String>, ExportError> {
        let mut names = BTreeSet::new();
        for record in [COMMON, IN_HAND] {
            names.extend(lines(&self.records().join(record))?);
        }
        Ok(names)
    }

    /// Removes files, whole or not, and the folders that are empty without them.
    fn remove_all(&self, names: &BTreeSet<String>) -> Result<(), ExportError> {
        for name in names {
            let path = inside(self.root(), name)?;
            remove(&unfinished(&path))?;
            remove(&path)?;
        }
        self.prune(names);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::unit::Nobody;

    fn make(place: &Destination, names: &[&str]) -> Result<(), ExportError> {
        let mut files = place.begin_common(&Nobody)?;
        names.iter().try_for_each(|name| files.put(name, name.as_bytes()))?;
        place.end_common(files)
    }

    fn has(place: &Destination, name: &str) -> bool {
        place.root().join(name).exists()
    }

    #[test]
    fn what_is_none_any_more_goes_and_its_folder_too() -> Result<(), ExportError> {
        let folder = tempfile::tempdir().expect("a folder");
        let place = Destination::new(folder.path(), "test");
        make(&place, &["a/one", "a/b/two", "c/three"])?;
        make(&place, &["a/one", "d/four"])?;
        assert!(has(&place, "a/one") && has(&place, "d/four"));
        assert!(!has(&place, "a/b") && !has(&place, "c"));
        // Somebody else's file keeps its folder.
        fs::write(folder.path().join("d/mine"), "").expect("is written");
        place.forget_common()?;
        assert!(!has(&place, "a") && has(&place, "d/mine") && !has(&place, "d/four"));
        Ok(())
    }

    #[test]
    fn what_a_killed_run_has_begun_is_known() -> Result<(), ExportError> {
        let folder = tempfile::tempdir().expect("a folder");
        let place = Destination::new(folder.path(), "test");
        make(&place, &["v1/one"])?;
        let mut files = place.begin_common(&Nobody)?;
        files.put("v2/one", b"")?;
        drop(files.create("v2/two")?);
        // Killed here; the next run makes others.
        drop(files);
        make(&place, &["v3/one"])?;
        assert!(has(&place, "v3/one") && !has(&place, "v2") && !has(&place, "v1"));
        Ok(())
    }
}
