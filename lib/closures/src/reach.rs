//! Which files of a vocabulary the rest of a closure speaks of.
//!
//! Code can use an item only where some file names it, or names something whose file names it: a type by its name, a method
//! through its type, a trait's method through the trait. So the files that define a name which occurs among the reached
//! files, again and again until no more are found, hold everything that can be used. Words in comments do not count.
//! A word that means something else reaches a file too many, never one too few.

use std::collections::BTreeSet;

use crate::sources::Source;

/// The sources among `candidates` that `files` reach.
pub(crate) fn reached<'a>(files: &[&'a Source], candidates: Vec<&'a Source>) -> Vec<&'a Source> {
    let mut words: BTreeSet<&str> = files.iter().flat_map(|file| &file.words).map(String::as_str).collect();
    let (mut found, mut waiting) = (Vec::new(), candidates);
    loop {
        let is_reached = |names: &BTreeSet<String>| names.iter().any(|name| words.contains(name.as_str()));
        let (now, later): (Vec<_>, Vec<_>) =
            waiting.into_iter().partition(|file| file.names.as_ref().is_none_or(is_reached));
        if now.is_empty() {
            return found;
        }
        words.extend(now.iter().flat_map(|file| &file.words).map(String::as_str));
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

    #[test]
    fn files_are_reached_through_one_another_and_not_by_comments() {
        let users = files(&[("bins/a/src/lib.rs", "// Unused\nfn run(x: First) {}\n")], false);
        let vocabulary = [
            ("lib/v/src/lib.rs", "mod first;\npub use first::First;\npub use unused::Unused;\n"),
            ("lib/v/src/first.rs", "pub struct First(pub super::second::Second);\n"),
            ("lib/v/src/second.rs", "pub struct Second;\n"),
            ("lib/v/src/more.rs", "impl Second {\n    pub fn grow(self) {}\n}\n"),
            ("lib/v/src/unused.rs", "pub struct Unused(First);\n"),
        ];
        let vocabulary = files(&vocabulary, true);
        let found = reached(&users.iter().collect::<Vec<_>>(), vocabulary.iter().collect());
        let mut names: Vec<&str> = found.into_iter().map(|file| file.name.as_str()).collect();
        names.sort_unstable();
        assert_eq!(names, ["lib/v/src/first.rs", "lib/v/src/more.rs", "lib/v/src/second.rs"]);
    }
}
