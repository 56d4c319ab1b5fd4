//! The names that a file gives to others.

use std::collections::BTreeSet;

/// Lines that are no comments.
pub(crate) fn code_lines(bytes: &[u8]) -> impl Iterator<Item = &str> {
    str::from_utf8(bytes).unwrap_or_default().lines().filter(|line| !line.trim_start().starts_with("//"))
}

pub(crate) fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// Words before the name of an item.
const BEFORE: [&str; 8] = ["pub", "const", "static", "unsafe", "async", "extern", "default", "mut"];
/// Words that say what kind of item follows.
const KINDS: [&str; 6] = ["struct", "enum", "trait", "type", "union", "fn"];

/// Names that a file gives to the rest: its public items, the macros that it exports, the rows of its `table!`s, and the
/// types that it adds methods to. A file of module declarations and re-exports gives none.
pub(crate) fn names_of(bytes: &[u8]) -> BTreeSet<String> {
    let (mut names, mut own_macros) = (BTreeSet::new(), BTreeSet::new());
    let mut is_exported = false;
    for line in code_lines(bytes) {
        let is_top = !line.starts_with(char::is_whitespace);
        let words: Vec<&str> = line.split(|c| !is_word(c)).filter(|w| !w.is_empty()).collect();
        // `pub(crate)` and the like.
        let words: Vec<&str> = words.into_iter().filter(|w| !["crate", "super", "in"].contains(w)).collect();
        let Some(kind) = words.iter().position(|w| !BEFORE.contains(w)) else { continue };
        let is_public = words[0] == "pub";
        let was_exported = std::mem::replace(&mut is_exported, line.trim() == "#[macro_export]");
        match (words[kind], words.get(kind + 1)) {
            ("macro_rules", Some(name)) if was_exported => {
                names.insert((*name).to_owned());
            }
            ("macro_rules", Some(name)) => {
                own_macros.insert((*name).to_owned());
            }
            // `pub(crate) use name;`: the other way to give a macro away.
            ("use", Some(name)) if is_public && words.len() == kind + 2 && own_macros.contains(*name) => {
                names.insert((*name).to_owned());
            }
            (word, Some(name)) if is_public && KINDS.contains(&word) && (is_top || word != "fn") => {
                names.insert((*name).to_owned());
            }
            (name, _)
                if is_public && is_top && words[..kind].iter().any(|w| ["const", "static"].contains(w)) =>
            {
                names.insert(name.to_owned());
            }
            // `impl Trait for Type`, `impl Type`: whoever reaches the type may use what is said of it here.
            ("impl", _) if is_top => names.extend(self_type(line)),
            // A row of `table!`: `ActorRow in "log/actors" by ... {`.
            (name, _) if line.contains(" in \"") && name.starts_with(|c: char| c.is_ascii_uppercase()) => {
                names.insert(name.to_owned());
            }
            _ => {}
        }
    }
    names
}

/// The type that a block of methods is about: the first capitalised word after the last `for`, or after the parameters.
fn self_type(line: &str) -> Option<String> {
    let head = line.split('{').next().unwrap_or(line);
    let of = head.rsplit_once(" for ").map_or_else(|| without_parameters(head), |(_, of)| of);
    let mut words = of.split(|c| !is_word(c));
    words.find(|word| word.starts_with(|c: char| c.is_ascii_uppercase())).map(str::to_owned)
}

/// What follows `impl<...>`.
fn without_parameters(head: &str) -> &str {
    let rest = head.trim_start_matches("impl");
    if !rest.starts_with('<') {
        return rest;
    }
    let mut depth = 0_u32;
    let end = rest.find(|c| {
        depth = match c {
            '<' => depth + 1,
            '>' => depth.saturating_sub(1),
            _ => depth,
        };
        depth == 0
    });
    end.map_or(rest, |end| &rest[end + 1..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_item_is_a_name() {
        let text = "//! Head.\nuse crate::Other;\npub mod inner;\npub(crate) struct One;\npub const TWO: u8 = 2;\n\
                    pub enum Three {\n    Four,\n}\nimpl Five {\n    pub fn six() {}\n    const EIGHT: u8 = 8;\n}\n\
                    impl<T: Copy> Nine for Ten<T> {}\nimpl<T: Into<Vec<Copy>>> Fifteen<T> {}\npub fn eleven() {}\npub const fn twelve() {}\nconst fn own() {}\n\
                    table! {\n    Thirteen in \"log/actors\" {\n        id: u16,\n    }\n}\nmacro_rules! own_macro {\n}\n#[macro_export]\nmacro_rules! fourteen {\n}\nmacro_rules! sixteen {\n}\npub(crate) use sixteen;\n";
        let names = names_of(text.as_bytes());
        let expected = [
            "One", "TWO", "Three", "Five", "Ten", "eleven", "twelve", "Thirteen", "fourteen", "Fifteen",
            "sixteen",
        ];
        for name in expected {
            assert!(names.contains(name), "{name} in {names:?}");
        }
        for name in ["Other", "inner", "Four", "six", "EIGHT", "Nine", "T", "Copy", "own", "id", "own_macro"]
        {
            assert!(!names.contains(name), "{name} in {names:?}");
        }
    }
}
