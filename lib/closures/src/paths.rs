//! The paths that code speaks in: `schema::lights::BRAKE`.

use std::collections::BTreeSet;

use crate::words::{code_lines, is_word};

/// Stands for everything, at the end of a path.
pub(crate) const GLOB: &str = "*";

/// What paths are made of; all else is one mark after another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Token<'a> {
    Word(&'a str),
    /// `::`.
    Into,
    Mark(char),
}

/// Paths of two words or more in the code of a file, its imports taken apart: `use a::{b, c::d as e}` has `a::b` and
/// `a::c::d::e`, the other name being one more word. And `self::` before each module that the file declares.
pub(crate) fn paths_of(bytes: &[u8]) -> BTreeSet<Vec<String>> {
    let lines: Vec<&str> = code_lines(bytes).collect();
    let text = lines.join("\n");
    let tokens = tokens_of(&text);
    let mut reading = Reading { tokens: &tokens, at: 0, found: BTreeSet::new() };
    while let Some(token) = reading.next() {
        match token {
            Token::Word("use") => reading.path(&mut Vec::new(), true),
            Token::Word("mod") => {
                if let [Token::Word(name), Token::Mark(';'), ..] = reading.tokens[reading.at..] {
                    reading.found.insert(vec!["self".to_owned(), name.to_owned()]);
                }
            }
            Token::Word(_) => {
                reading.at -= 1;
                reading.path(&mut Vec::new(), false);
            }
            Token::Into | Token::Mark(_) => {}
        }
    }
    reading.found
}

fn tokens_of(text: &str) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let length = if is_word(c) {
            let end = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
            tokens.push(Token::Word(&rest[..end]));
            end
        } else if rest.starts_with("::") {
            tokens.push(Token::Into);
            2
        } else {
            if !c.is_whitespace() {
                tokens.push(Token::Mark(c));
            }
            c.len_utf8()
        };
        rest = &rest[length..];
    }
    tokens
}

struct Reading<'a> {
    tokens: &'a [Token<'a>],
    at: usize,
    found: BTreeSet<Vec<String>>,
}

impl<'a> Reading<'a> {
    fn peek(&self) -> Option<Token<'a>> {
        self.tokens.get(self.at).copied()
    }

    fn next(&mut self) -> Option<Token<'a>> {
        let token = self.peek();
        self.at += 1;
        token
    }

    /// Reads what follows `path`, which ends as it began.
    fn path(&mut self, path: &mut Vec<&'a str>, is_import: bool) {
        let length = path.len();
        loop {
            match self.peek() {
                Some(Token::Word(word)) => path.push(word),
                Some(Token::Mark('*')) if is_import => path.push(GLOB),
                Some(Token::Mark('{')) if is_import => {
                    self.at += 1;
                    self.group(path);
                    break;
                }
                _ => break,
            }
            self.at += 1;
            let goes_on = match self.peek() {
                Some(Token::Word("as")) => is_import,
                next => next == Some(Token::Into),
            };
            if !goes_on {
                break;
            }
            self.at += 1;
        }
        if path.len() > 1 {
            self.found.insert(path.iter().map(|&word| word.to_owned()).collect());
        }
        path.truncate(length);
    }

    /// The paths between braces.
    fn group(&mut self, path: &mut Vec<&'a str>) {
        loop {
            match self.peek() {
                None => return,
                Some(Token::Mark('}')) => {
                    self.at += 1;
                    return;
                }
                Some(Token::Word(_) | Token::Mark('{' | '*')) => self.path(path, true),
                Some(Token::Into | Token::Mark(_)) => self.at += 1,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn imports_are_taken_apart_and_calls_are_paths() {
        let text = "// use comments::Not;\nuse a::{\n    b, c::{D, e as f},\n    g::*,\n};\npub use h::I as J;\nmod k;\n\
                    fn l(m: &n::O) -> <P as q::R>::S {\n    t::u::<v::W>(x.find(y), z as f64)\n}\n";
        let found = paths_of(text.as_bytes());
        let paths: Vec<String> = found.iter().map(|path| path.join("::")).collect();
        let expected = [
            "a::b",
            "a::c",
            "a::c::D",
            "a::c::e::f",
            "a::g::*",
            "h::I::J",
            "n::O",
            "q::R",
            "self::k",
            "t::u",
            "v::W",
        ];
        assert_eq!(paths, expected);
    }
}
