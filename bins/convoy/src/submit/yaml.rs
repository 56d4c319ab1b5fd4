//! Text as YAML has it, such that every reader of it finds the same text.

/// A text between double quotes.
pub(super) fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            '\n' => quoted.push_str("\\n"),
            '\t' => quoted.push_str("\\t"),
            // None of them lies beyond four digits.
            c if !is_printed(c) => quoted.push_str(&format!("\\u{:04X}", u32::from(c))),
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

/// A text as the value of a key: in lines of its own, set in by `indent`, as long as people can read it so.
pub(super) fn block(text: &str, indent: usize) -> String {
    let is_plain = text.chars().all(|c| matches!(c, '\n' | '\t') || is_printed(c));
    // What begins with a space or a line break would be taken for other columns.
    if text.is_empty()
        || !is_plain
        || text.starts_with(char::is_whitespace)
        || text.ends_with(char::is_whitespace) != text.ends_with('\n')
    {
        return quoted(text);
    }
    let ending = match (text.ends_with("\n\n"), text.ends_with('\n')) {
        (true, _) => "+",
        (_, true) => "",
        _ => "-",
    };
    let mut block = format!("|{ending}");
    for line in text.strip_suffix('\n').unwrap_or(text).split('\n') {
        block.push('\n');
        if !line.is_empty() {
            block.push_str(&" ".repeat(indent));
            block.push_str(line);
        }
    }
    block
}

/// Whether a character stands for itself: it is no control, no line break of old and no mark of byte order.
fn is_printed(c: char) -> bool {
    !(c.is_control() || matches!(c, '\u{2028}' | '\u{2029}' | '\u{FEFF}' | '\u{FFFE}' | '\u{FFFF}'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_blocks_where_they_can_be() {
        assert_eq!(block("a = 1\n\n[b]\n\tc = \"é\"\n", 4), "|\n    a = 1\n\n    [b]\n    \tc = \"é\"");
        assert_eq!(block("a = 1", 4), "|-\n    a = 1");
        assert_eq!(block("a = 1\n\n", 4), "|+\n    a = 1\n");
        for (odd, told) in [
            ("", "\"\""),
            (" a\n", "\" a\\n\""),
            ("\n", "\"\\n\""),
            ("a\r\nb\n", "\"a\\u000D\\nb\\n\""),
            ("a ", "\"a \""),
            ("\u{FEFF}a\u{85}\u{2028}\"\\", "\"\\uFEFFa\\u0085\\u2028\\\"\\\\\""),
        ] {
            assert_eq!(block(odd, 4), told);
        }
    }
}
