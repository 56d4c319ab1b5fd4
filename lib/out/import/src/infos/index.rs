//! Where in a file the parts are: found byte by byte, so that a file of gigabytes takes no memory.

use std::collections::BTreeMap;
use std::io::{self, BufReader, Read};
use std::ops::Range;

/// Deepest nesting.
const MAX_DEPTH: usize = 64;
/// Longest key that matters.
const MAX_KEY: usize = 64;
/// Most scenes of a file.
const MAX_SCENES: usize = 1_000_000;
/// Greatest number of a scene.
const MAX_NUMBER: u32 = 999_999;

/// Places of the parts of a file of infos.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Index {
    /// What is said of all sensors.
    pub metadata: Range<u64>,
    /// The scenes, by number.
    pub scenes: BTreeMap<u32, Range<u64>>,
}

/// A file is no JSON of infos.
#[derive(Debug, thiserror::Error)]
pub enum IndexError {
    /// It cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// It is something else.
    #[error("byte {offset}: {problem}")]
    Content {
        /// Where.
        offset: u64,
        /// What is wrong.
        problem: String,
    },
}

/// Finds the parts of a file: `{"metadata": {...}, "data": {"scene_0000": {...}, ...}}`. What the parts hold
/// is not looked at, but for its brackets and texts.
///
/// # Errors
/// It cannot be read; brackets do not fit together; a part is missing, no object, or there twice.
pub fn scan(file: impl Read) -> Result<Index, IndexError> {
    let mut scanner = Scanner::default();
    for byte in BufReader::with_capacity(1 << 20, file).bytes() {
        scanner.take(byte?)?;
        scanner.offset += 1;
    }
    scanner.finish()
}

#[derive(Default)]
struct Scanner {
    offset: u64,
    open: Vec<u8>,
    is_text: bool,
    is_escaped: bool,
    /// The last text of the two outer levels; none where it was too long.
    text: Option<Vec<u8>>,
    /// The keys of the value in hand, outer and inner.
    keys: [Option<Vec<u8>>; 2],
    /// Whether a colon has come, on these levels.
    has_colon: bool,
    /// The part in hand: where it began and how deep that was.
    part: Option<(IndexPart, u64, usize)>,
    has_data: bool,
    metadata: Option<Range<u64>>,
    scenes: BTreeMap<u32, Range<u64>>,
    is_over: bool,
}

#[derive(Clone, Copy)]
enum IndexPart {
    Metadata,
    Scene(u32),
}

impl Scanner {
    fn fault<T>(&self, problem: impl Into<String>) -> Result<T, IndexError> {
        Err(IndexError::Content { offset: self.offset, problem: problem.into() })
    }

    fn take(&mut self, byte: u8) -> Result<(), IndexError> {
        if self.is_text {
            self.in_text(byte);
            return Ok(());
        }
        let depth = self.open.len();
        if self.is_over && !byte.is_ascii_whitespace() {
            return self.fault("something behind the end");
        }
        if depth == 0 && byte != b'{' && !byte.is_ascii_whitespace() {
            return self.fault("no JSON object");
        }
        match byte {
            b'"' => {
                self.is_text = true;
                self.text = (depth <= 2).then(Vec::new);
            }
            b':' if depth == 1 || depth == 2 => {
                self.keys[depth - 1] = self.text.take();
                self.has_colon = true;
            }
            b',' if depth <= 2 => self.has_colon = false,
            b'{' | b'[' => self.begin(byte)?,
            b'}' | b']' => self.end(byte)?,
            _ => {}
        }
        Ok(())
    }

    fn in_text(&mut self, byte: u8) {
        match byte {
            _ if self.is_escaped => self.is_escaped = false,
            b'\\' => self.is_escaped = true,
            b'"' => {
                self.is_text = false;
                return;
            }
            _ => {}
        }
        match &mut self.text {
            Some(text) if text.len() < MAX_KEY => text.push(byte),
            other => *other = None,
        }
    }

    fn begin(&mut self, byte: u8) -> Result<(), IndexError> {
        let depth = self.open.len();
        if depth >= MAX_DEPTH {
            return self.fault("nested too deep");
        }
        let part = match (depth, self.keys[0].as_deref(), self.part) {
            (1, Some(b"metadata"), None) if self.has_colon => Some(IndexPart::Metadata),
            (1, Some(b"data"), None) if self.has_colon => {
                if self.has_data || byte != b'{' {
                    return self.fault("`data` is there twice, or is no object");
                }
                self.has_data = true;
                None
            }
            (2, Some(b"data"), None) if self.has_colon => Some(IndexPart::Scene(self.number()?)),
            _ => None,
        };
        if let Some(part) = part {
            if byte != b'{' {
                return self.fault("a part that is no object");
            }
            self.part = Some((part, self.offset, depth));
        }
        self.has_colon = false;
        self.open.push(byte);
        Ok(())
    }

    /// The number in `scene_0007`.
    fn number(&self) -> Result<u32, IndexError> {
        let key = self.keys[1].as_deref().and_then(|key| std::str::from_utf8(key).ok()).unwrap_or_default();
        let digits = key.strip_prefix("scene_").filter(|digits| digits.bytes().all(|b| b.is_ascii_digit()));
        let number = digits.and_then(|digits| digits.parse().ok()).filter(|&number| number <= MAX_NUMBER);
        match number {
            Some(number) => Ok(number),
            None => self.fault(format!("`{}` is no name of a scene", key.escape_debug())),
        }
    }

    fn end(&mut self, byte: u8) -> Result<(), IndexError> {
        let opened = self.open.pop();
        if opened != Some(if byte == b'}' { b'{' } else { b'[' }) {
            return self.fault("brackets that do not fit together");
        }
        let depth = self.open.len();
        self.is_over = depth == 0;
        if let Some((part, start, at)) = self.part
            && at == depth
        {
            self.part = None;
            let range = start..self.offset + 1;
            let is_new = match part {
                IndexPart::Metadata => self.metadata.replace(range).is_none(),
                IndexPart::Scene(number) => self.scenes.insert(number, range).is_none(),
            };
            if !is_new || self.scenes.len() > MAX_SCENES {
                return self.fault("a part that is there twice, or too many scenes");
            }
        }
        Ok(())
    }

    fn finish(self) -> Result<Index, IndexError> {
        if !self.is_over || self.is_text {
            return self.fault("it ends early");
        }
        match (self.metadata, self.has_data) {
            (Some(metadata), true) => Ok(Index { metadata, scenes: self.scenes }),
            _ => Err(IndexError::Content { offset: 0, problem: "has no `metadata`, or no `data`".into() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_found_whatever_their_texts_hold() {
        let text = br#"{ "metadata": {"a": "}\"{"}, "other": [{"data": {}}],
            "data": {"scene_0007": {"scene_info": {"data": {"scene_0009": {}}}}, "scene_0012": {"b": [1, {}]}} } "#;
        let index = scan(text.as_slice()).expect("infos");
        let part = |range: &Range<u64>| {
            std::str::from_utf8(&text[range.start as usize..range.end as usize]).expect("text")
        };
        assert_eq!(part(&index.metadata), r#"{"a": "}\"{"}"#);
        let scenes: Vec<(u32, &str)> =
            index.scenes.iter().map(|(number, range)| (*number, part(range))).collect();
        assert_eq!(
            scenes,
            [(7, r#"{"scene_info": {"data": {"scene_0009": {}}}}"#), (12, r#"{"b": [1, {}]}"#)]
        );
    }

    #[test]
    fn other_files_are_refused() {
        for (text, want) in [
            ("", "it ends early"),
            ("[]", "byte 0: no JSON object"),
            ("{\"metadata\": {}", "it ends early"),
            ("{\"metadata\": {}}", "has no `metadata`, or no `data`"),
            ("{\"metadata\": {}, \"data\": {}} x", "byte 29: something behind the end"),
            ("{\"metadata\": {}, \"data\": {\"scene_1\": {}, \"scene_0001\": {}}}", "there twice"),
            ("{\"metadata\": {}, \"data\": {\"scene_x\": {}}}", "`scene_x` is no name of a scene"),
            ("{\"metadata\": {}, \"data\": {\"scene_1\": []}}", "a part that is no object"),
            ("{\"metadata\": {]}", "byte 14: brackets that do not fit together"),
            ("{\"metadata\": {\"a", "it ends early"),
        ] {
            let error = scan(text.as_bytes()).expect_err("refused").to_string();
            assert!(error.contains(want), "{text}: {error}");
        }
        let deep = "{\"a\":".repeat(100);
        assert!(scan(deep.as_bytes()).expect_err("refused").to_string().ends_with("nested too deep"));
    }
}
