//! JSON as Python writes it: with `NaN` and `Infinity`, numbers read to the last digit.

use crate::value::Value;

/// Deepest nesting.
const MAX_DEPTH: usize = 32;

/// A text is no JSON.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("byte {offset}: {problem}")]
pub struct JsonError {
    /// Where, from the text's first byte.
    pub offset: usize,
    /// What is wrong.
    pub problem: String,
}

/// Reads a text. Memory is in proportion to its length.
///
/// # Errors
/// It is no JSON, nested more than 32 deep, or has something behind its value.
pub fn parse(text: &[u8]) -> Result<Value, JsonError> {
    let mut parser = Parser { text, at: 0 };
    let value = parser.value(0)?;
    parser.skip_spaces();
    if parser.at == text.len() { Ok(value) } else { Err(parser.fault("something behind the value")) }
}

struct Parser<'a> {
    text: &'a [u8],
    at: usize,
}

impl Parser<'_> {
    fn fault(&self, problem: &str) -> JsonError {
        JsonError { offset: self.at, problem: problem.to_owned() }
    }

    fn skip_spaces(&mut self) {
        while matches!(self.text.get(self.at), Some(b' ' | b'\n' | b'\r' | b'\t')) {
            self.at += 1;
        }
    }

    fn accept(&mut self, byte: u8) -> bool {
        self.skip_spaces();
        let found = self.text.get(self.at) == Some(&byte);
        self.at += usize::from(found);
        found
    }

    fn expect(&mut self, byte: u8) -> Result<(), JsonError> {
        if self.accept(byte) { Ok(()) } else { Err(self.fault(&format!("`{}` expected", char::from(byte)))) }
    }

    fn value(&mut self, depth: usize) -> Result<Value, JsonError> {
        if depth > MAX_DEPTH {
            return Err(self.fault("nested too deep"));
        }
        self.skip_spaces();
        match self.text.get(self.at) {
            Some(b'{') => self.object(depth),
            Some(b'[') => self.list(depth),
            Some(b'"') => Ok(Value::Text(self.string()?)),
            Some(_) => self.word(),
            None => Err(self.fault("it ends early")),
        }
    }

    fn object(&mut self, depth: usize) -> Result<Value, JsonError> {
        self.at += 1;
        let mut entries = Vec::new();
        if self.accept(b'}') {
            return Ok(Value::Dict(entries));
        }
        loop {
            self.skip_spaces();
            if self.text.get(self.at) != Some(&b'"') {
                return Err(self.fault("a key expected"));
            }
            let key = self.string()?;
            self.expect(b':')?;
            entries.push((key, self.value(depth + 1)?));
            if !self.accept(b',') {
                self.expect(b'}')?;
                return Ok(Value::Dict(entries));
            }
        }
    }

    fn list(&mut self, depth: usize) -> Result<Value, JsonError> {
        self.at += 1;
        let mut items = Vec::new();
        if self.accept(b']') {
            return Ok(Value::List(items));
        }
        loop {
            items.push(self.value(depth + 1)?);
            if !self.accept(b',') {
                self.expect(b']')?;
                return Ok(Value::List(items));
            }
        }
    }

    fn string(&mut self) -> Result<String, JsonError> {
        let rest = self.text.get(self.at + 1..).unwrap_or_default();
        let mut is_escaped = false;
        let end = rest.iter().position(|&b| match b {
            _ if is_escaped => {
                is_escaped = false;
                false
            }
            b'\\' => {
                is_escaped = true;
                false
            }
            b => b == b'"',
        });
        let end = end.ok_or_else(|| self.fault("a text without end"))?;
        // Escapes are rare and many: another one's business. It takes no floating numbers here.
        let quoted = &self.text[self.at..self.at + end + 2];
        let text = serde_json::from_slice(quoted).map_err(|e| self.fault(&format!("no text: {e}")))?;
        self.at += end + 2;
        Ok(text)
    }

    fn word(&mut self) -> Result<Value, JsonError> {
        let rest = &self.text[self.at..];
        let is_part = |b: &u8| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'-' | b'.');
        let len = rest.iter().take_while(|b| is_part(b)).count();
        let word = std::str::from_utf8(&rest[..len]).unwrap_or_default();
        let value = match word {
            "null" => Value::None,
            "true" => Value::Bool(true),
            "false" => Value::Bool(false),
            "NaN" => Value::Float(f64::NAN),
            "Infinity" => Value::Float(f64::INFINITY),
            "-Infinity" => Value::Float(f64::NEG_INFINITY),
            _ => number(word).ok_or_else(|| self.fault("a value expected"))?,
        };
        self.at += len;
        Ok(value)
    }
}

/// `-12`, `1.5`, `1e-07`; no words that Rust knows and JSON does not.
fn number(word: &str) -> Option<Value> {
    let digits = word.strip_prefix('-').unwrap_or(word);
    if !digits.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    if digits.bytes().all(|b| b.is_ascii_digit()) {
        return word.parse().ok().map(Value::Int);
    }
    word.parse().ok().map(Value::Float)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_python_writes_is_read() {
        let text = br#" {"a": [1, -2.5, 1e-07, NaN, -Infinity], "b": {"c": null, "d": "\u00e9\"\\"}, "e": true, "f": []} "#;
        let value = parse(text).expect("JSON");
        let Some(Value::List(list)) = value.get("a") else { panic!("a list") };
        assert_eq!(list[..3], [Value::Int(1), Value::Float(-2.5), Value::Float(1e-7)]);
        assert!(list[3].number().is_some_and(f64::is_nan));
        assert_eq!(list[4], Value::Float(f64::NEG_INFINITY));
        assert_eq!(value.get("b").and_then(|b| b.get("d")).and_then(Value::text), Some("é\"\\"));
        assert_eq!(value.get("f"), Some(&Value::List(Vec::new())));
    }

    #[test]
    fn digits_are_read_to_the_last() {
        // The doubles next to each other around these: the decimal says which is meant.
        for text in
            ["0.1", "396.3190612792969", "1.7976931348623157e308", "4.8531727790832524", "9007199254740993.0"]
        {
            assert_eq!(parse(text.as_bytes()), Ok(Value::Float(text.parse().expect("a number"))));
        }
        assert_eq!(parse(b"18446744073709551617"), Ok(Value::Int((1 << 64) + 1)));
    }

    #[test]
    fn faults_name_their_place() {
        let deep = [b"[".repeat(40), b"]".repeat(40)].concat();
        for (text, want) in [
            (b"{\"a\": }".as_slice(), "byte 6: a value expected"),
            (b"[1, 2", "byte 5: `]` expected"),
            (b"\"abc", "byte 0: a text without end"),
            (b"{} {}", "byte 3: something behind the value"),
            (b"inf", "byte 0: a value expected"),
            (b"{1: 2}", "byte 1: a key expected"),
            (b"", "byte 0: it ends early"),
            (&deep, "byte 33: nested too deep"),
        ] {
            assert_eq!(parse(text).expect_err("no JSON").to_string(), want);
        }
    }
}
