//! Rust source as the few kinds of tokens that tell which file uses which.

/// A word or a sign, with the line it is on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Token {
    pub(crate) text: String,
    pub(crate) line: usize,
}

impl Token {
    pub(crate) fn is_word(&self) -> bool {
        self.text.starts_with(|c: char| c.is_alphabetic() || c == '_')
    }
}

/// Words, `::`, and single signs; comments are left out, and of literals only a `"` is left, or for numbers a
/// `0`.
pub(crate) fn tokens(source: &str) -> Vec<Token> {
    let chars: Vec<char> = source.chars().collect();
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    let (mut found, mut i, mut line) = (Vec::new(), 0, 1);
    while i < chars.len() {
        let from = i;
        let c = chars[i];
        let text = if c.is_whitespace() {
            i += 1;
            None
        } else if c == '/' && at(i + 1) == '/' {
            i = end(&chars, i, |c| c == '\n');
            None
        } else if c == '/' && at(i + 1) == '*' {
            i = block_comment_end(&chars, i);
            None
        } else if let Some(quote) = string_start(&chars, i) {
            i = string_end(&chars, quote);
            Some("\"".to_owned())
        } else if c.is_alphabetic() || c == '_' {
            i = end(&chars, i, |c| !(c.is_alphanumeric() || c == '_'));
            Some(chars[from..i].iter().collect())
        } else if c.is_ascii_digit() {
            i = end(&chars, i, |c| !(c.is_alphanumeric() || c == '_'));
            Some("0".to_owned())
        } else if c == '\'' {
            // A character, or a lifetime: that has no quote behind its first letter.
            if at(i + 1) == '\\' {
                i = end(&chars, i + 3, |c| c == '\'') + 1;
                Some("\"".to_owned())
            } else if at(i + 2) == '\'' {
                i += 3;
                Some("\"".to_owned())
            } else {
                i += 1;
                None
            }
        } else if c == ':' && at(i + 1) == ':' {
            i += 2;
            Some("::".to_owned())
        } else {
            i += 1;
            Some(c.to_string())
        };
        found.extend(text.map(|text| Token { text, line }));
        line += chars[from..i.min(chars.len())].iter().filter(|&&c| c == '\n').count();
    }
    found
}

/// The first place from `i` on at which a character is as wanted.
fn end(chars: &[char], i: usize, wanted: impl Fn(char) -> bool) -> usize {
    let rest = chars.get(i..).unwrap_or_default();
    i + rest.iter().position(|&c| wanted(c)).unwrap_or(rest.len())
}

fn block_comment_end(chars: &[char], from: usize) -> usize {
    let (mut depth, mut i) = (0, from);
    while i < chars.len() {
        match (chars[i], chars.get(i + 1)) {
            ('/', Some('*')) => (depth, i) = (depth + 1, i + 2),
            ('*', Some('/')) => (depth, i) = (depth - 1, i + 2),
            _ => i += 1,
        }
        if depth == 0 {
            break;
        }
    }
    i
}

/// Where the quote of a string is that begins here, and how many `#` it has; none before the quote if it is
/// not raw.
fn string_start(chars: &[char], i: usize) -> Option<(usize, Option<usize>)> {
    let prefix = end(chars, i, |c| !matches!(c, 'b' | 'c' | 'r'));
    let raw = chars[i..prefix].contains(&'r');
    let quote = if raw { end(chars, prefix, |c| c != '#') } else { prefix };
    (prefix - i <= 2 && chars.get(quote) == Some(&'"')).then_some((quote, raw.then_some(quote - prefix)))
}

fn string_end(chars: &[char], (quote, raw): (usize, Option<usize>)) -> usize {
    let mut i = quote + 1;
    while i < chars.len() {
        match raw {
            None if chars[i] == '\\' => i += 1,
            None if chars[i] == '"' => return i + 1,
            Some(hashes) if chars[i] == '"' && (1..=hashes).all(|k| chars.get(i + k) == Some(&'#')) => {
                return i + 1 + hashes;
            }
            _ => {}
        }
        i += 1;
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(source: &str) -> Vec<String> {
        tokens(source).into_iter().map(|t| t.text).collect()
    }

    #[test]
    fn words_and_signs_are_kept_and_literals_and_comments_are_not() {
        let source = "use a::b; // crate::x\n/* crate::y /* nested */ */ f(\"crate::z\", r#\"a \" b\"#, b\"\\\"\", 'c', '\\'', 1.5e3) <'a>";
        let found = texts(source);
        assert!(!found.iter().any(|t| ["x", "y", "z", "c", "nested"].contains(&t.as_str())), "{found:?}");
        assert_eq!(found[..6], ["use", "a", "::", "b", ";", "f"]);
        assert_eq!(found[found.len() - 3..], ["<", "a", ">"]);
    }

    #[test]
    fn lines_are_counted_through_everything() {
        let found = tokens("a\n\"x\ny\" b /* \n */ c\nd");
        let line = |word: &str| found.iter().find(|t| t.text == word).map(|t| t.line);
        assert_eq!([line("a"), line("b"), line("c"), line("d")], [Some(1), Some(3), Some(4), Some(5)]);
    }
}
