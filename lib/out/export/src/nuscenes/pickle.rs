//! Python's pickles (protocol 2), as far as dictionaries, lists, texts, numbers and numpy's arrays go:
//! written piece by piece, so that a list may be longer than memory.

/// A value that is written at once.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    Bool(bool),
    Int(i64),
    Float(f64),
    Text(String),
    List(Vec<Value>),
    Dict(Vec<(&'static str, Value)>),
    /// By names that come from data.
    Named(Vec<(String, Value)>),
    /// A numpy array of 64-bit floats: numbers row by row, and its shape.
    Floats(Vec<f64>, Vec<usize>),
    /// Likewise of 64-bit integers, in one row.
    Ints(Vec<i64>),
    /// Likewise of truth values.
    Bools(Vec<bool>),
    /// Likewise of texts.
    Texts(Vec<String>),
}

impl Value {
    pub(crate) fn text(text: &str) -> Self {
        Self::Text(text.to_owned())
    }

    /// A list of numbers.
    pub(crate) fn numbers(values: impl IntoIterator<Item = f64>) -> Self {
        Self::List(values.into_iter().map(Self::Float).collect())
    }

    /// Rows of numbers.
    pub(crate) fn rows<const N: usize>(rows: impl IntoIterator<Item = [f64; N]>) -> Self {
        Self::List(rows.into_iter().map(Self::numbers).collect())
    }
}

/// A pickle in the making; what is written so far is taken by who keeps it.
#[derive(Debug)]
pub(crate) struct Pickle {
    bytes: Vec<u8>,
}

impl Pickle {
    pub(crate) fn new() -> Self {
        Self { bytes: vec![0x80, 2] }
    }

    /// What was written since it was taken last.
    pub(crate) fn take(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.bytes)
    }

    /// The end, with what was not taken yet.
    pub(crate) fn finish(mut self) -> Vec<u8> {
        self.bytes.push(b'.');
        self.bytes
    }

    pub(crate) fn begin_dict(&mut self) {
        self.bytes.push(b'}');
    }

    /// An entry of a dictionary: its key; its value comes between this and [`Self::end_entry`].
    pub(crate) fn begin_entry(&mut self, key: &str) {
        self.put_text(key);
    }

    pub(crate) fn end_entry(&mut self) {
        self.bytes.push(b's');
    }

    pub(crate) fn begin_list(&mut self) {
        self.bytes.push(b']');
    }

    /// An item of a list.
    pub(crate) fn item(&mut self, value: &Value) {
        self.put(value);
        self.bytes.push(b'a');
    }

    pub(crate) fn put(&mut self, value: &Value) {
        match value {
            Value::Bool(value) => self.bytes.push(if *value { 0x88 } else { 0x89 }),
            Value::Int(value) => self.put_int(*value),
            Value::Float(value) => self.put_float(*value),
            Value::Text(text) => self.put_text(text),
            Value::List(values) => self.put_list(values.iter(), Self::put),
            Value::Dict(entries) => self.put_dict(entries.iter().map(|(key, value)| (*key, value))),
            Value::Named(entries) => self.put_dict(entries.iter().map(|(key, value)| (key.as_str(), value))),
            Value::Floats(values, shape) => {
                self.put_global("reshape");
                self.bytes.push(b'(');
                self.put_array("float64", values.iter(), |pickle, value| pickle.put_float(*value));
                self.bytes.push(b'(');
                shape.iter().for_each(|side| self.put_int(*side as i64));
                self.bytes.extend(b"ttR");
            }
            Value::Ints(values) => self.put_array("int64", values.iter(), |p, value| p.put_int(*value)),
            Value::Bools(values) => {
                self.put_array("bool", values.iter(), |p, value| p.put(&Value::Bool(*value)));
            }
            Value::Texts(values) => self.put_array("str", values.iter(), |p, text| p.put_text(text)),
        }
    }

    fn put_dict<'a>(&mut self, entries: impl Iterator<Item = (&'a str, &'a Value)>) {
        self.bytes.extend(b"}(");
        for (key, value) in entries {
            self.put_text(key);
            self.put(value);
        }
        self.bytes.push(b'u');
    }

    fn put_list<T>(&mut self, values: impl Iterator<Item = T>, put: impl Fn(&mut Self, T)) {
        self.bytes.extend(b"](");
        values.for_each(|value| put(self, value));
        self.bytes.push(b'e');
    }

    /// `numpy.array(values, kind)`.
    fn put_array<T>(&mut self, kind: &str, values: impl Iterator<Item = T>, put: impl Fn(&mut Self, T)) {
        self.put_global("array");
        self.bytes.push(b'(');
        self.put_list(values, put);
        self.put_text(kind);
        self.bytes.extend(b"tR");
    }

    fn put_global(&mut self, name: &str) {
        self.bytes.extend(format!("cnumpy\n{name}\n").as_bytes());
    }

    fn put_int(&mut self, value: i64) {
        match i32::try_from(value) {
            Ok(small) => {
                self.bytes.push(b'J');
                self.bytes.extend(small.to_le_bytes());
            }
            Err(_) => {
                self.bytes.extend([0x8a, 8]);
                self.bytes.extend(value.to_le_bytes());
            }
        }
    }

    fn put_float(&mut self, value: f64) {
        self.bytes.push(b'G');
        self.bytes.extend(value.to_be_bytes());
    }

    fn put_text(&mut self, text: &str) {
        self.bytes.push(b'X');
        self.bytes.extend((text.len() as u32).to_le_bytes());
        self.bytes.extend(text.as_bytes());
    }
}

#[cfg(test)]
mod tests {
    use std::process::Command;

    use super::*;

    #[test]
    fn python_reads_what_was_written() {
        let Some(python) = testkit::python(&["numpy"]) else { return };
        let mut pickle = Pickle::new();
        pickle.begin_dict();
        pickle.begin_entry("list");
        pickle.begin_list();
        pickle.item(&Value::Int(1_500_000_000_000_000));
        pickle.item(&Value::Dict(vec![("é", Value::Bool(true)), ("no", Value::Bool(false))]));
        pickle.item(&Value::rows([[1.5, -2.0], [f64::NAN, 1e300]]));
        let first = pickle.take();
        pickle.item(&Value::Floats(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0], vec![2, 3]));
        pickle.item(&Value::Floats(Vec::new(), vec![0, 7]));
        pickle.item(&Value::List(vec![
            Value::Ints(vec![-3, 1 << 40]),
            Value::Bools(vec![true, false]),
            Value::Texts(vec!["car".into(), "bus".into()]),
            Value::Named(vec![("CAM".into(), Value::text("x"))]),
        ]));
        pickle.end_entry();
        let file = tempfile::NamedTempFile::new().expect("a temporary file");
        std::fs::write(file.path(), [first, pickle.finish()].concat()).expect("is written");
        let told = "import pickle, sys; print(pickle.load(open(sys.argv[1], 'rb')))";
        let output =
            Command::new(python).args(["-c", told]).arg(file.path()).output().expect("Python starts");
        let text = String::from_utf8_lossy(&output.stdout).replace('\n', "");
        let want = "{'list': [1500000000000000, {'é': True, 'no': False}, [[1.5, -2.0], [nan, 1e+300]], \
                    array([[1., 2., 3.],       [4., 5., 6.]]), array([], shape=(0, 7), dtype=float64), \
                    [array([           -3, 1099511627776]), array([ True, False]), array(['car', 'bus'], dtype='<U3'), \
                    {'CAM': 'x'}]]}";
        assert_eq!(text, want, "{}", String::from_utf8_lossy(&output.stderr));
    }
}
