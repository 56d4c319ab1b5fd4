//! Which files of a vocabulary the rest of a closure speaks of.
//!
//! Code can use an item only where some file names it, or names something whose file names it: a type by its name, a method
//! through its type, a trait's method through the trait. It names it in a path or an import that begins with the crate
//! (`schema::lights::BRAKE`), with a module of it that was imported (`lights::BRAKE`), or, within the crate, with `crate`,
//! `super` or a module of its own. So the files that define a name which stands in such a path of the reached files, again
//! and again until no more are found, hold everything that can be used. A path that means something else reaches a file
//! too many, never one too few.

use std::collections::BTreeSet;

use crate::ClosureError;
use crate::paths::GLOB;
use crate::sources::Source;

/// What paths within a crate begin with.
const WITHIN: [&str; 3] = ["crate", "super", "self"];

/// Words that are known to lead into the vocabularies.
struct Known<'a>(BTreeSet<&'a str>);

impl<'a> Known<'a> {
    /// Adds what a file names. `is_own`: the file is one of the vocabularies'. Whether there was anything new.
    fn add(&mut self, file: &'a Source, is_own: bool) -> Result<bool, ClosureError> {
        let before = self.0.len();
        for path in &file.paths {
            let leads = |word: &String| self.0.contains(word.as_str());
            let within = is_own && WITHIN.contains(&path[0].as_str());
            let Some(first) = (if within { Some(0) } else { path.iter().position(leads) }) else { continue };
            // What follows a type is within it.
            let is_type = |word: &String| word.starts_with(|c: char| c.is_ascii_uppercase());
            let ends = path[first..].iter().position(is_type).map_or(path.len(), |at| first + at + 1);
            for word in &path[first + 1..ends.max(first + 1)] {
                if word == GLOB {
                    return Err(ClosureError::Glob { file: file.name.clone(), path: path.join("::") });
                }
                if !WITHIN.contains(&word.as_str()) {
                    self.0.insert(word);
                }
            }
        }
        Ok(self.0.len() > before)
    }
}

/// The sources among `candidates` that `files` reach. `vocabularies`: the names that others have for the crates of the
/// candidates.
///
/// # Errors
/// A file imports everything of a vocabulary.
pub(crate) fn reached<'a>(
    files: &[&'a Source],
    vocabularies: &BTreeSet<&'a str>,
    candidates: Vec<&'a Source>,
) -> Result<Vec<&'a Source>, ClosureError> {
    let mut known = Known(vocabularies.clone());
    let (mut found, mut waiting) = (Vec::new(), candidates);
    loop {
        let mut is_more = true;
        while is_more {
            is_more = false;
            for (list, is_own) in [(files, false), (found.as_slice(), true)] {
                for file in list {
                    is_more |= known.add(file, is_own)?;
                }
            }
        }
        let is_reached = |names: &BTreeSet<String>| names.iter().any(|name| known.0.contains(name.as_str()));
        let (now, later): (Vec<_>, Vec<_>) =
            waiting.into_iter().partition(|file: &&Source| file.names.as_ref().is_none_or(is_reached));
        if now.is_empty() {
            return Ok(found);
        }
        found.extend(now);
        waiting = later;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(list: &[(&str, &str)], by_file: bool) -> Vec<Source> {
        let new =
            |(name, text): &(&str, &str)| Source::new((*name).to_owned(), text.as_bytes().to_vec(), by_file);
        list.iter().map(new).collect()
    }

    fn reached_of(user: &str, vocabulary: &[(&str, &str)]) -> Result<Vec<String>, ClosureError> {
        let (users, vocabulary) = (files(&[("bins/a/src/lib.rs", user)], false), files(vocabulary, true));
        let users: Vec<&Source> = users.iter().collect();
        let found = reached(&users, &BTreeSet::from(["v"]), vocabulary.iter().collect())?;
        let mut names: Vec<String> = found.into_iter().map(|file| file.name.clone()).collect();
        names.sort_unstable();
        Ok(names)
    }

    const VOCABULARY: [(&str, &str); 6] = [
        ("lib/v/src/lib.rs", "mod first;\npub mod lamps;\npub use first::First;\npub use unused::Unused;\n"),
        ("lib/v/src/first.rs", "pub struct First(pub super::second::Second);\n"),
        ("lib/v/src/second.rs", "pub struct Second;\n"),
        ("lib/v/src/more.rs", "impl Second {\n    pub fn grow(self) {}\n}\n"),
        ("lib/v/src/unused.rs", "pub struct Unused(crate::First);\npub enum Part {}\npub fn find() {}\n"),
        ("lib/v/src/lamps.rs", "pub const BRAKE: u32 = 1;\n"),
    ];

    #[test]
    fn files_are_reached_through_one_another_and_not_by_comments() {
        let found = reached_of("use v::First;\n// v::Unused\nfn run(x: First) {}\n", &VOCABULARY);
        assert_eq!(
            found.expect("no glob"),
            ["lib/v/src/first.rs", "lib/v/src/more.rs", "lib/v/src/second.rs"]
        );
    }

    #[test]
    fn a_word_that_means_something_else_reaches_nothing() {
        let user =
            "use v::Second;\nfn run(x: Second) {\n    x.iter().find(Record::Part);\n    Unused();\n}\n";
        let found = reached_of(user, &VOCABULARY);
        assert_eq!(found.expect("no glob"), ["lib/v/src/more.rs", "lib/v/src/second.rs"]);
    }

    #[test]
    fn modules_lead_to_their_items_under_whatever_name() {
        for user in [
            "fn run() -> u32 {\n    v::lamps::BRAKE\n}\n",
            "use v::lamps;\nconst B: u32 = lamps::BRAKE;\n",
            "use v::{lamps as of_cars, First as One};\nconst B: u32 = of_cars::BRAKE;\n",
            "use v::{\n    lamps::{self, BRAKE},\n};\n",
            "pub use v as words;\nconst B: u32 = crate::words::lamps::BRAKE;\n",
        ] {
            let found = reached_of(user, &VOCABULARY).expect("no glob");
            assert!(found.contains(&"lib/v/src/lamps.rs".to_owned()), "{user}: {found:?}");
        }
        let found = reached_of("use v::lamps;\nfn run(lamp: u32) {}\n", &VOCABULARY);
        assert!(found.expect("no glob").is_empty());
    }

    #[test]
    fn importing_a_whole_vocabulary_is_refused() {
        let error = reached_of("use v::lamps::*;\n", &VOCABULARY).expect_err("is a glob");
        assert!(error.to_string().starts_with("bins/a/src/lib.rs: imports v::lamps::*"), "{error}");
        for other in ["use rayon::prelude::*;\n", "use v::First;\nuse First::*;\nuse v::First::*;\n"] {
            assert!(reached_of(other, &VOCABULARY).is_ok(), "{other}");
        }
    }
}
