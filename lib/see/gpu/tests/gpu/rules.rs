//! What shaders may not call: operations that no decoration keeps in order, or that devices round as they
//! like.

use std::path::Path;

/// Single instructions or library calls whose inner order the driver chooses, and divisions.
const FORBIDDEN: [&str; 18] = [
    "dot",
    "length",
    "normalize",
    "cross",
    "distance",
    "mix",
    "smoothstep",
    "fma",
    "reflect",
    "refract",
    "sqrt",
    "inverseSqrt",
    "pow",
    "exp",
    "log",
    "sin",
    "cos",
    "mat",
];

/// What of a shader's text is against the rules, with its line.
fn faults(wgsl: &str) -> Vec<String> {
    let mut faults = Vec::new();
    for (number, line) in (1..).zip(wgsl.lines()) {
        let code = line.split("//").next().unwrap_or_default();
        if code.contains('/') || code.contains('%') {
            faults.push(format!("line {number}: `/` or `%`: {line}"));
        }
        let words = code.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty());
        for word in words {
            let is_matrix = word.starts_with("mat") && word.len() > 3 && word.as_bytes()[3].is_ascii_digit();
            if FORBIDDEN.contains(&word) || is_matrix {
                faults.push(format!("line {number}: `{word}`: {line}"));
            }
        }
    }
    faults
}

#[test]
fn shaders_call_nothing_inexact() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut read = 0;
    for entry in std::fs::read_dir(folder).expect("is there").flatten() {
        if entry.path().extension().is_some_and(|extension| extension == "wgsl") {
            let text = std::fs::read_to_string(entry.path()).expect("is text");
            assert_eq!(faults(&text), [""; 0], "{}", entry.path().display());
            read += 1;
        }
    }
    assert!(read >= 2, "{read}");
}

#[test]
fn what_is_inexact_is_found() {
    for line in [
        "let a = b / c;",
        "let a = dot(b, c);",
        "x = fma(a, b, c);",
        "let m = mat3x3<f32>();",
        "a = b % 2u; // no",
    ] {
        assert_eq!(faults(&format!("\n{line}\n")).len(), 1, "{line}");
    }
    assert_eq!(faults("let dotted = a * b; // dot / mix\nlet length_m = a;"), [""; 0]);
}
