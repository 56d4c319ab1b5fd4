//! Limits on what is read, checked before the XML parser sees it: no file may fill the memory or the stack.

use super::ReadError;

/// Longest text that is read, bytes; also of what a compressed file unpacks to.
pub(super) const MAX_TEXT_BYTES: u64 = 1 << 30;
/// Compressed files that unpack to more than this many times their size are taken for bombs (real ones: 10 to
/// 30)...
const MAX_RATIO: u64 = 200;
/// ... if they are larger than this.
const SMALL_BYTES: u64 = 1 << 24;
/// Most elements of a file (Town11 has 150,000).
const MAX_ELEMENTS: usize = 1 << 24;
/// Most attributes of one element: the XML parser compares each with all before it.
const MAX_ATTRIBUTES: usize = 1000;
/// Deepest nesting of elements (the format itself: 10).
const MAX_DEPTH: usize = 100;

/// The largest text that a compressed file of some size may hold, bytes.
pub(super) fn unpacked_limit(compressed: usize) -> u64 {
    (compressed as u64 * MAX_RATIO).clamp(SMALL_BYTES, MAX_TEXT_BYTES)
}

/// Refuses texts that would cost more than they are worth. Only counts tags: whether they fit each other is
/// for the parser to say.
pub(super) fn check(xml: &str) -> Result<(), ReadError> {
    if xml.len() as u64 > MAX_TEXT_BYTES {
        return Err(ReadError::Bytes { message: format!("more than {MAX_TEXT_BYTES} bytes") });
    }
    let bytes = xml.as_bytes();
    let (mut at, mut elements, mut depth) = (0, 0, 0_usize);
    while let Some(open) = find(bytes, at, b'<') {
        let rest = bytes.get(open..).unwrap_or_default();
        let refuse = |message: String| {
            let line = 1 + bytes.get(..open).unwrap_or_default().iter().filter(|b| **b == b'\n').count();
            Err(ReadError::Content { line: u32::try_from(line).unwrap_or(u32::MAX), road: None, message })
        };
        at = if rest.starts_with(b"<!--") {
            after(xml, open + 4, "-->")
        } else if rest.starts_with(b"<![CDATA[") {
            after(xml, open + 9, "]]>")
        } else if rest.starts_with(b"<?") {
            after(xml, open + 2, "?>")
        } else if rest.starts_with(b"</") {
            depth = depth.saturating_sub(1);
            open + 2
        } else {
            let (end, attributes, closed) = tag(bytes, open + 1);
            elements += 1;
            depth += usize::from(!closed);
            if attributes > MAX_ATTRIBUTES {
                return refuse(format!("an element with more than {MAX_ATTRIBUTES} attributes"));
            }
            if depth > MAX_DEPTH {
                return refuse(format!("elements are nested more than {MAX_DEPTH} deep"));
            }
            if elements > MAX_ELEMENTS {
                return refuse(format!("more than {MAX_ELEMENTS} elements"));
            }
            end
        };
    }
    Ok(())
}

fn find(bytes: &[u8], from: usize, wanted: u8) -> Option<usize> {
    bytes.get(from..)?.iter().position(|b| *b == wanted).map(|i| from + i)
}

/// The place after an end mark, or the text's end.
fn after(xml: &str, from: usize, mark: &str) -> usize {
    xml.get(from..).and_then(|rest| rest.find(mark)).map_or(xml.len(), |i| from + i + mark.len())
}

/// Where a start tag ends, how many attributes it has, and whether it closes itself.
fn tag(bytes: &[u8], from: usize) -> (usize, usize, bool) {
    let (mut at, mut attributes) = (from, 0);
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'>' => return (at + 1, attributes, bytes.get(at - 1) == Some(&b'/')),
            b'"' | b'\'' => {
                attributes += 1;
                at = find(bytes, at + 1, byte).unwrap_or(bytes.len());
            }
            // Not well-formed: let the parser say so.
            b'<' => return (at, attributes, false),
            _ => {}
        }
        at += 1;
    }
    (bytes.len(), attributes, false)
}

#[cfg(test)]
mod tests {
    use super::check;

    #[test]
    fn ordinary_texts_pass() {
        let text =
            "<?xml version='1.0'?><!-- < <a --><a b=\"<>\" c='/>'><![CDATA[<x><x>]]><d/><d e='1'/>&lt;</a>";
        assert_eq!(check(text), Ok(()));
        // Many at one level are not deep.
        assert_eq!(check(&format!("<a>{}</a>", "<b/><c></c>".repeat(500))), Ok(()));
    }

    #[test]
    fn deep_and_wide_ones_are_refused_with_their_line() {
        let deep = format!("<a>\n{}", "<b>".repeat(200));
        assert!(check(&deep).expect_err("deep").to_string().starts_with("line 2: elements are nested"));
        let wide = format!("<a>\n\n<b {}/></a>", "c='' ".repeat(1001));
        assert!(check(&wide).expect_err("wide").to_string().starts_with("line 3: an element with"));
        for odd in ["<", "<a", "<a b='", "<!--", "<![CDATA[", "</", "<a <b", "é<é"] {
            assert_eq!(check(odd), Ok(()), "{odd}");
        }
    }
}
