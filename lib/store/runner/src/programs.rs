//! Which build made what: its commit, and digests that tell edited programs from one another.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};

use memchr::memmem;
use store::MadeBy;

use crate::beside::{file_of, is_all_programs};
use crate::graph::{Graph, stated_versions};

/// The stamp that a build writes into its programs: a name, the commit (spaces where there is none), `+` for
/// a build of just this commit, its date (spaces where nobody knows it).
const STAMP_NAME: &[u8] = b"\0convoy-build-stamp\0";
const COMMIT_LEN: usize = 64;
const DATE_LEN: usize = 10;
/// Bytes of a stamp.
pub const STAMP_LEN: usize = STAMP_NAME.len() + COMMIT_LEN + 1 + DATE_LEN;
/// The header of the note in which linkers write a digest of an ELF file, stamp included.
const BUILD_ID_NAME: &[u8] = b"\x04\0\0\0\x14\0\0\0\x03\0\0\0GNU\0";
const BUILD_ID_LEN: usize = 20;

/// The programs of this build: those beside the one that runs, or that one alone where it is all of them.
#[derive(Debug)]
pub struct Programs {
    commit: Option<String>,
    this: Option<PathBuf>,
    /// Digests by stage, each found once (and once for all where one file is all of them).
    digests: Mutex<BTreeMap<String, String>>,
}

impl Programs {
    /// The programs beside the one that runs, by its stamp. `stage` is the stage that it does itself: its
    /// file is read at once, before a newer build can take its place.
    #[must_use]
    pub fn of_build(stamp: &[u8; STAMP_LEN], stage: Option<&str>) -> Self {
        let Stamped { commit, is_committed, .. } = Stamped::of(stamp);
        let commit = is_committed.then_some(commit);
        let this = std::env::current_exe().ok();
        let own = stage.map(|stage| (key_of(stage), this.as_deref().and_then(digest_of)));
        let own = own.and_then(|(key, digest)| Some((key, digest?)));
        Self { commit, this, digests: Mutex::new(own.into_iter().collect()) }
    }

    /// Programs of given digests by stage, for tests; none of a commit where that is `None`.
    #[cfg(test)]
    pub(crate) fn given(commit: Option<&str>, digests: &[(&str, &str)]) -> Self {
        let digests = digests.iter().map(|(stage, digest)| ((*stage).to_owned(), (*digest).to_owned()));
        Self { commit: commit.map(str::to_owned), this: None, digests: Mutex::new(digests.collect()) }
    }

    /// Digest of a stage's program; none where there is no such program.
    pub(crate) fn digest(&self, stage: &str) -> Option<String> {
        let mut digests = self.digests.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = digests.get(&key_of(stage)) {
            return Some(known.clone());
        }
        let found = digest_of(&file_of(self.this.as_deref()?, stage))?;
        digests.insert(key_of(stage), found.clone());
        Some(found)
    }

    /// What manifests of a stage say of this build.
    #[must_use]
    pub fn made_by(&self, stage: &str) -> MadeBy {
        MadeBy {
            release: env!("CARGO_PKG_VERSION").to_owned(),
            commit: self.commit.clone(),
            program: self.digest(stage).unwrap_or_default(),
            versions: if stage == Graph::get().planner().name { versions() } else { BTreeMap::new() },
            device: None,
        }
    }

    /// Whether this build's program for a stage makes what another build made, by the same version. Where
    /// there is no such program, the version alone counts.
    pub(crate) fn makes_the_same(&self, stage: &str, then: &MadeBy) -> bool {
        if self.commit.is_some() && then.commit.is_some() {
            return true;
        }
        self.digest(stage).is_none_or(|program| program == then.program)
    }
}

/// The versions of all stages of this build.
fn versions() -> BTreeMap<String, String> {
    stated_versions().iter().map(|(stage, version)| ((*stage).to_owned(), version.to_string())).collect()
}

/// What a stamp says.
struct Stamped {
    /// Empty where there was no repository.
    commit: String,
    is_committed: bool,
    /// Empty where nobody knows it.
    date: String,
}

impl Stamped {
    fn of(stamp: &[u8; STAMP_LEN]) -> Self {
        // Optimised code must not know the stamp: programs of two commits differ in its bytes alone.
        let stamp = std::hint::black_box(stamp);
        let (commit, rest) = stamp[STAMP_NAME.len()..].split_at(COMMIT_LEN);
        let (sign, date) = rest.split_at(1);
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
        Self { commit: text(commit), is_committed: sign == b"+", date: text(date) }
    }

    /// Release, commit and date, as `0.1.0 (0e49c38c9f12, 2026-11-30)`.
    fn line(&self) -> String {
        let Self { commit, is_committed, date } = self;
        let commit = commit.get(..12).unwrap_or(commit);
        let commit = if *is_committed { commit.to_owned() } else { format!("{commit} with changes") };
        let facts: Vec<&str> = [commit.trim(), date].into_iter().filter(|fact| !fact.is_empty()).collect();
        format!("{} ({})", env!("CARGO_PKG_VERSION"), facts.join(", "))
    }
}

/// What `--version` says of a build, by its stamp: release, commit and date.
#[must_use]
pub fn release(stamp: &[u8; STAMP_LEN]) -> &'static str {
    static LINE: OnceLock<String> = OnceLock::new();
    LINE.get_or_init(|| Stamped::of(stamp).line())
}

/// By what the digest of a stage's program is kept.
fn key_of(stage: &str) -> String {
    if is_all_programs() { "all".to_owned() } else { stage.to_owned() }
}

/// So much of a program's file is read at a time: it is larger than what memory may be left.
const CHUNK: usize = 1 << 20;
/// A name and what comes after it are no longer than this.
const LONGEST: usize = 1 << 10;

/// BLAKE3 of a program's file without its stamp and the linker's digest of the file, or none when it cannot
/// be read.
fn digest_of(program: &Path) -> Option<String> {
    let mut file = File::open(program).ok()?;
    let (mut hasher, mut bytes) = (blake3::Hasher::new(), Vec::new());
    loop {
        let read = file.by_ref().take(CHUNK as u64).read_to_end(&mut bytes).ok()?;
        blank_after(&mut bytes, STAMP_NAME, STAMP_LEN - STAMP_NAME.len(), is_commit);
        blank_after(&mut bytes, BUILD_ID_NAME, BUILD_ID_LEN, |_| true);
        // What begins near the end may go on in the next chunk.
        let whole = if read == 0 { bytes.len() } else { bytes.len().saturating_sub(LONGEST) };
        hasher.update(&bytes[..whole]);
        bytes.drain(..whole);
        if read == 0 {
            return Some(hasher.finalize().to_hex().to_string());
        }
    }
}

/// Whether bytes are what a stamp holds after its name (programs have the name alone, too).
fn is_commit(bytes: &[u8]) -> bool {
    let (commit, rest) = bytes.split_at(COMMIT_LEN);
    let (sign, date) = rest.split_at(1);
    commit.iter().all(|byte| byte.is_ascii_hexdigit() || *byte == b' ')
        && matches!(sign, b"+" | b"-")
        && date.iter().all(|byte| byte.is_ascii_digit() || matches!(byte, b' ' | b'-'))
}

/// Sets the bytes after each place of a name to zero, where they are of a kind.
fn blank_after(file: &mut [u8], name: &[u8], len: usize, is_of_kind: impl Fn(&[u8]) -> bool) {
    let places: Vec<usize> = memmem::find_iter(file, name).map(|at| at + name.len()).collect();
    for from in places {
        if let Some(bytes) = file.get_mut(from..from + len).filter(|bytes| is_of_kind(bytes)) {
            bytes.fill(0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_commit_alone_makes_no_other_program() {
        let folder = tempfile::tempdir().expect("makes a folder");
        let digest = |name: &str, parts: &[&[u8]]| {
            let file = folder.path().join(name);
            std::fs::write(&file, parts.concat()).expect("writes");
            digest_of(&file).expect("reads")
        };
        let (ours, theirs) = (format!("{:<64}+2026-11-30", "ab12"), format!("{:<64}-{:<10}", "cd34", ""));
        let (ours, theirs) = (ours.as_bytes(), theirs.as_bytes());
        let (id, other_id) = ([1; BUILD_ID_LEN], [2; BUILD_ID_LEN]);
        let first = digest("first", &[b"code\0\0", BUILD_ID_NAME, &id, STAMP_NAME, ours, b"data"]);
        let same = digest("same", &[b"code\0\0", BUILD_ID_NAME, &other_id, STAMP_NAME, theirs, b"data"]);
        let edited = digest("edited", &[b"cope\0\0", BUILD_ID_NAME, &id, STAMP_NAME, ours, b"data"]);
        assert_eq!(first, same);
        assert_ne!(first, edited);
        assert_eq!(digest_of(&folder.path().join("none")), None);
        // Wherever in the file, as read in chunks.
        for before in
            [CHUNK - 2 * LONGEST, CHUNK - LONGEST, CHUNK - 40, CHUNK - 1, CHUNK, 2 * CHUNK - LONGEST - 9]
        {
            let code = vec![7; before];
            let [first, same] = [(&id, ours), (&other_id, theirs)]
                .map(|(id, stamp)| digest("long", &[&code, BUILD_ID_NAME, id, STAMP_NAME, stamp, b"data"]));
            assert_eq!(first, same, "{before}");
            let mut file = [&code, BUILD_ID_NAME, &id, STAMP_NAME, ours, b"data"].concat();
            blank_after(&mut file, STAMP_NAME, STAMP_LEN - STAMP_NAME.len(), is_commit);
            blank_after(&mut file, BUILD_ID_NAME, BUILD_ID_LEN, |_| true);
            assert_eq!(first, store::hash_bytes(&file), "{before}");
        }
        // A file that ends within a stamp.
        digest("short", &[STAMP_NAME, b"a"]);
    }

    #[test]
    fn releases_say_commit_and_date() {
        let line = |commit: &str, is_committed, date: &str| {
            let line = Stamped { commit: commit.to_owned(), is_committed, date: date.to_owned() }.line();
            line.strip_prefix(env!("CARGO_PKG_VERSION")).expect("begins with the release").to_owned()
        };
        assert_eq!(line("0123456789abcdef", true, "2026-11-30"), " (0123456789ab, 2026-11-30)");
        assert_eq!(line("0123456789abcdef", false, "2026-11-30"), " (0123456789ab with changes, 2026-11-30)");
        assert_eq!(line("", false, ""), " (with changes)");
    }

    #[test]
    fn builds_of_commits_are_trusted_to_their_versions() {
        let committed = Programs::given(Some("c"), &[("bev-gt", "p")]);
        let edited = Programs::given(None, &[("bev-gt", "p")]);
        let made = |commit: Option<&str>, program: &str| MadeBy {
            commit: commit.map(str::to_owned),
            program: program.to_owned(),
            ..MadeBy::default()
        };
        assert!(committed.makes_the_same("bev-gt", &made(Some("d"), "q")));
        assert!(!committed.makes_the_same("bev-gt", &made(None, "q")));
        assert!(committed.makes_the_same("bev-gt", &made(None, "p")));
        assert!(!edited.makes_the_same("bev-gt", &made(Some("d"), "q")));
        assert!(edited.makes_the_same("bev-gt", &made(Some("d"), "p")));
        assert!(edited.makes_the_same("stats", &made(None, "q")), "there is no such program");
    }
}
