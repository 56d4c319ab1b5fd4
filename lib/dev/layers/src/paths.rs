//! The paths that a file names, the modules that it declares, and what its `use` items bind.

use std::collections::BTreeSet;

use crate::lexer::{Token, tokens};

/// A path named in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Named {
    /// The inline module of the file that names it.
    pub(crate) within: Vec<String>,
    pub(crate) segments: Vec<String>,
    pub(crate) line: usize,
    /// The name that a `use` item binds it to; `*` for all that is there.
    pub(crate) binds: Option<String>,
    /// Named by a `pub use`.
    pub(crate) is_reexport: bool,
}

/// What is read from a file; what is for tests alone is left out.
#[derive(Debug, Default)]
pub(crate) struct Source {
    pub(crate) named: Vec<Named>,
    /// Modules that have files of their own, with the inline module that declares them.
    pub(crate) modules: Vec<Vec<String>>,
    /// Modules inside the file.
    pub(crate) inline: Vec<Vec<String>>,
    /// All words outside `use` items.
    pub(crate) words: BTreeSet<String>,
}

/// Reads a file.
pub(crate) fn read(text: &str) -> Source {
    let tokens = tokens(text);
    let mut source = Source::default();
    let mut reader = Reader { tokens: &tokens, i: 0, within: Vec::new(), depth: 0 };
    while reader.i < tokens.len() {
        reader.item(&mut source);
    }
    source
}

struct Reader<'a> {
    tokens: &'a [Token],
    i: usize,
    /// Inline modules that are open, with the depth of braces inside them.
    within: Vec<(String, usize)>,
    depth: usize,
}

impl Reader<'_> {
    fn text(&self, i: usize) -> &str {
        self.tokens.get(i).map_or("", |t| &t.text)
    }

    fn module(&self) -> Vec<String> {
        self.within.iter().map(|(name, _)| name.clone()).collect()
    }

    /// Reads on by an item, a path, or a token.
    fn item(&mut self, source: &mut Source) {
        match self.text(self.i) {
            "#" => self.attribute(),
            "{" => (self.depth, self.i) = (self.depth + 1, self.i + 1),
            "}" => {
                if self.within.last().is_some_and(|(_, depth)| *depth == self.depth) {
                    self.within.pop();
                }
                (self.depth, self.i) = (self.depth.saturating_sub(1), self.i + 1);
            }
            "mod" if self.tokens.get(self.i + 1).is_some_and(Token::is_word) => {
                let name = self.text(self.i + 1).to_owned();
                let path = [self.module(), vec![name.clone()]].concat();
                match self.text(self.i + 2) {
                    ";" => source.modules.push(path),
                    "{" => {
                        source.inline.push(path);
                        self.depth += 1;
                        self.within.push((name, self.depth));
                    }
                    _ => {}
                }
                self.i += 3;
            }
            // Not the `use<...>` of a type.
            "use" if self.text(self.i + 1) != "<" => self.imports(source),
            _ if self.tokens[self.i].is_word() => self.path(source),
            _ => self.i += 1,
        }
    }

    /// Passes an attribute, and what it is for if that is tests.
    fn attribute(&mut self) {
        let from = self.i;
        self.i += 1 + usize::from(self.text(self.i + 1) == "!");
        self.pass_block("[", "]");
        let words: Vec<&str> = self.tokens[from..self.i].iter().map(|t| t.text.as_str()).collect();
        if words.contains(&"cfg") && words.contains(&"test") && !words.contains(&"not") {
            while !matches!(self.text(self.i), ";" | "{" | "") {
                self.i += 1;
            }
            if self.text(self.i) == "{" { self.pass_block("{", "}") } else { self.i += 1 }
        }
    }

    fn pass_block(&mut self, open: &str, close: &str) {
        let mut depth = 0;
        while self.i < self.tokens.len() {
            depth += i32::from(self.text(self.i) == open) - i32::from(self.text(self.i) == close);
            self.i += 1;
            if depth == 0 {
                break;
            }
        }
    }

    /// A path in code; a word alone is none.
    fn path(&mut self, source: &mut Source) {
        let line = self.tokens[self.i].line;
        let mut segments = vec![self.text(self.i).to_owned()];
        self.i += 1;
        while self.text(self.i) == "::" && self.tokens.get(self.i + 1).is_some_and(Token::is_word) {
            segments.push(self.text(self.i + 1).to_owned());
            self.i += 2;
        }
        source.words.insert(segments[0].clone());
        if segments.len() > 1 {
            let within = self.module();
            source.named.push(Named { within, segments, line, binds: None, is_reexport: false });
        }
    }

    /// A `use` item.
    fn imports(&mut self, source: &mut Source) {
        // Behind `pub`, or `pub(...)`.
        let before = |k: usize| self.i.checked_sub(k).map_or("", |i| self.text(i));
        let is_reexport =
            before(1) == "pub" || before(1) == ")" && (before(4) == "pub" || before(5) == "pub");
        self.i += 1;
        let mut open: Vec<Vec<String>> = vec![Vec::new()];
        let mut segments: Vec<String> = Vec::new();
        let mut alias = None;
        let mut line = 0;
        loop {
            let text = self.text(self.i).to_owned();
            match text.as_str() {
                "{" => {
                    let prefix = [open.last().cloned().unwrap_or_default(), std::mem::take(&mut segments)];
                    open.push(prefix.concat());
                }
                "," | "}" | ";" | "" => {
                    if !segments.is_empty() {
                        let prefix = open.last().cloned().unwrap_or_default();
                        let mut path = [prefix, std::mem::take(&mut segments)].concat();
                        let is_self = path.len() > 1 && path.last().is_some_and(|s| s == "self");
                        path.truncate(path.len() - usize::from(is_self));
                        let binds = alias.take().or_else(|| path.last().cloned());
                        let within = self.module();
                        source.named.push(Named { within, segments: path, line, binds, is_reexport });
                    }
                    if text == "}" {
                        open.pop();
                    } else if text != "," {
                        self.i += 1;
                        return;
                    }
                }
                "as" => {
                    alias = Some(self.text(self.i + 1).to_owned());
                    self.i += 1;
                }
                "::" => {}
                _ => {
                    line = self.tokens[self.i].line;
                    segments.push(text);
                }
            }
            self.i += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(text: &str) -> Vec<String> {
        let shown = |n: Named| {
            let binds = n.binds.map_or(String::new(), |b| format!(" as {b}"));
            format!("{}{binds}{}", n.segments.join("::"), if n.is_reexport { " pub" } else { "" })
        };
        read(text).named.into_iter().map(shown).collect()
    }

    #[test]
    fn use_trees_are_unfolded() {
        let text = "use crate::a::{self, b::{C, D as E}, f::*}; pub(crate) use self::g::H; pub use x::Y;";
        assert_eq!(
            named(text),
            [
                "crate::a as a",
                "crate::a::b::C as C",
                "crate::a::b::D as E",
                "crate::a::f::* as *",
                "self::g::H as H pub",
                "x::Y as Y pub"
            ]
        );
    }

    #[test]
    fn paths_in_code_count_and_tests_do_not() {
        let text = "
            fn f(x: &super::T) { crate::a::g::<u8>(x); }
            #[cfg(test)] mod tests { use crate::z::Z; fn h() { crate::y(); } }
            #[cfg(test)] use crate::w::W;
            #[derive(Debug)] struct S(crate::b::U);
        ";
        assert_eq!(named(text), ["super::T", "crate::a::g", "crate::b::U"]);
    }

    #[test]
    fn modules_are_those_with_files_and_those_inside() {
        let found =
            read("mod a; pub mod b { pub mod c; fn f() { if x { super::g() } } } #[cfg(test)] mod t;");
        assert_eq!(found.modules, [vec!["a"], vec!["b", "c"]]);
        assert_eq!(found.inline, [vec!["b"]]);
        assert_eq!(found.named[0].within, ["b"]);
    }
}
