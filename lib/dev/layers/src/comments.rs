//! How wide comments are.

use std::path::Path;

/// Columns of code and comments: `max_width` of `rustfmt.toml`, which leaves comments alone.
const WIDTH: usize = 110;

/// Comments that are wider than code. Rows of tables and examples in fences may be.
pub(crate) fn faults(file: &Path, source: &str) -> Vec<String> {
    let mut in_example = false;
    let mut faults = Vec::new();
    for (i, line) in source.lines().enumerate() {
        let Some(comment) = line.trim_start().strip_prefix("//") else {
            in_example = false;
            continue;
        };
        let text = comment.trim_start_matches(['/', '!']).trim_start();
        in_example ^= text.starts_with("```");
        let wide = line.chars().count() > WIDTH && text.contains(' ');
        if wide && !in_example && !text.starts_with('|') {
            faults.push(format!("{}:{}: a comment wider than {WIDTH} columns", file.display(), i + 1));
        }
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_prose_is_held_to_the_width() {
        let long = "word ".repeat(30);
        let of = |source: &str| faults(Path::new("a.rs"), source).len();
        assert_eq!(of(&format!("/// {long}\nfn f() {{}} // short")), 1);
        assert_eq!(of(&format!("    // {long}")), 1);
        assert_eq!(of(&format!("//! | {long} |\n//! ```\n//! {long}\n//! ```\n//! {long}")), 1);
        assert_eq!(of(&format!("/// <https://{}>", "x".repeat(150))), 0);
        assert_eq!(of(&format!("let text = \"{long}\";")), 0);
    }
}
