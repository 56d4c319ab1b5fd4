//! Lists of records as numpy pickles them: an object array of Python dictionaries, in protocol 3.
//!
//! Classes go by the module names of numpy 1 (`numpy.core.multiarray`), which numpy 2 understands, too; the
//! other way round it does not. What returns (keys, types, the words of modules) is written once and recalled
//! from the memo.

use codecs::NpzError;

/// A value of a record.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    None,
    Bool(bool),
    Int(i64),
    Float(f64),
    Text(String),
    Ints(Vec<i64>),
    /// A dictionary of texts.
    Facts(Vec<(String, String)>),
    /// A float64 array of one dimension.
    Vector([f64; 3]),
    /// A float64 array of eight rows of three.
    Corners([f64; 24]),
}

/// A dictionary, its keys in the order of writing.
pub(super) type Record = Vec<(&'static str, Value)>;

/// A file as `numpy.save(..., allow_pickle=True)` writes it of an array of dictionaries.
pub(super) fn object_file(records: &[Record]) -> Result<Vec<u8>, NpzError> {
    let mut out = codecs::npy_object_header("GT_DET", &[records.len()])?;
    out.reserve(1200 * records.len());
    let mut pickle = Pickle { out, known: Vec::new() };
    pickle.op(b"\x80\x03");
    pickle.array(&[records.len()], Elements::Records(records));
    pickle.op(b".");
    Ok(pickle.out)
}

/// What a numpy array holds.
enum Elements<'a> {
    Floats(&'a [f64]),
    Records(&'a [Record]),
}

/// What the memo holds.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Known {
    Reconstruct,
    NdArray,
    DType,
    Float64,
    Object,
    Key(&'static str),
}

struct Pickle {
    out: Vec<u8>,
    /// What was written, by its number in the memo.
    known: Vec<Known>,
}

impl Pickle {
    fn op(&mut self, bytes: &[u8]) {
        self.out.extend_from_slice(bytes);
    }

    /// Recalls something from the memo, or writes it and puts it there.
    fn recall(&mut self, what: Known, write: impl FnOnce(&mut Self)) {
        if let Some(number) = self.known.iter().position(|known| *known == what) {
            // Keys and classes are some thirty.
            self.op(&[b'h', number as u8]);
            return;
        }
        write(self);
        // What `write` itself remembered has its number by now.
        if let Ok(number) = u8::try_from(self.known.len()) {
            self.op(&[b'q', number]);
            self.known.push(what);
        }
    }

    fn int(&mut self, value: i64) {
        if let Ok(byte) = u8::try_from(value) {
            self.op(&[b'K', byte]);
        } else if let Ok(short) = u16::try_from(value) {
            self.op(b"M");
            self.op(&short.to_le_bytes());
        } else if let Ok(int) = i32::try_from(value) {
            self.op(b"J");
            self.op(&int.to_le_bytes());
        } else {
            self.op(&[0x8a, 8]);
            self.op(&value.to_le_bytes());
        }
    }

    fn text(&mut self, text: &str) {
        self.op(b"X");
        // Attributes are short; what is longer than 4 GiB does not exist.
        self.op(&(text.len() as u32).to_le_bytes());
        self.op(text.as_bytes());
    }

    fn global(&mut self, what: Known, module: &str, name: &str) {
        self.recall(what, |pickle| {
            pickle.op(b"c");
            pickle.op(module.as_bytes());
            pickle.op(b"\n");
            pickle.op(name.as_bytes());
            pickle.op(b"\n");
        });
    }

    /// `dtype(word, False, True)` in its state.
    fn dtype(&mut self, what: Known, word: &str, order: &str, flags: u8) {
        self.recall(what, |pickle| {
            pickle.global(Known::DType, "numpy", "dtype");
            pickle.text(word);
            pickle.op(b"\x89\x88\x87R(K\x03");
            pickle.text(order);
            pickle.op(b"NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK");
            pickle.op(&[flags]);
            pickle.op(b"tb");
        });
    }

    fn array(&mut self, shape: &[usize], elements: Elements<'_>) {
        self.global(Known::Reconstruct, "numpy.core.multiarray", "_reconstruct");
        self.global(Known::NdArray, "numpy", "ndarray");
        self.op(b"K\x00\x85C\x01b\x87R(K\x01");
        shape.iter().for_each(|&length| self.int(length as i64));
        self.op(if shape.len() == 1 { b"\x85" } else { b"\x86" });
        match elements {
            Elements::Floats(values) => {
                self.dtype(Known::Float64, "f8", "<", 0);
                self.op(b"\x89");
                // 192 bytes at most.
                self.op(&[b'C', (8 * values.len()) as u8]);
                values.iter().for_each(|value| self.op(&value.to_le_bytes()));
            }
            Elements::Records(records) => {
                self.dtype(Known::Object, "O8", "|", 63);
                self.op(b"\x89](");
                records.iter().for_each(|record| self.record(record));
                self.op(b"e");
            }
        }
        self.op(b"tb");
    }

    fn record(&mut self, record: &Record) {
        self.op(b"}(");
        for (key, value) in record {
            self.recall(Known::Key(key), |pickle| pickle.text(key));
            self.value(value);
        }
        self.op(b"u");
    }

    fn value(&mut self, value: &Value) {
        match value {
            Value::None => self.op(b"N"),
            Value::Bool(value) => self.op(if *value { b"\x88" } else { b"\x89" }),
            Value::Int(value) => self.int(*value),
            Value::Float(value) => {
                self.op(b"G");
                self.op(&value.to_be_bytes());
            }
            Value::Text(text) => self.text(text),
            Value::Ints(values) => {
                self.op(b"](");
                values.iter().for_each(|value| self.int(*value));
                self.op(b"e");
            }
            Value::Facts(facts) => {
                self.op(b"}(");
                for (key, value) in facts {
                    self.text(key);
                    self.text(value);
                }
                self.op(b"u");
            }
            Value::Vector(values) => self.array(&[3], Elements::Floats(values)),
            Value::Corners(values) => self.array(&[8, 3], Elements::Floats(values)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pickle of one record, without the header of its file.
    fn pickled(record: Record) -> Vec<u8> {
        let file = object_file(&[record]).expect("fits");
        assert_eq!(file.len() - file[128..].len(), 128, "the header of a short list");
        file[128..].to_vec()
    }

    #[test]
    fn a_record_is_what_the_opcodes_say() {
        let found =
            pickled(vec![("id", Value::Int(300)), ("ok", Value::Bool(true)), ("x", Value::Float(1.0))]);
        let head: &[u8] =
            b"\x80\x03cnumpy.core.multiarray\n_reconstruct\nq\x00cnumpy\nndarray\nq\x01K\x00\x85C\x01b\x87R";
        let state: &[u8] = b"(K\x01K\x01\x85cnumpy\ndtype\nq\x02X\x02\0\0\0O8\x89\x88\x87R(K\x03X\x01\0\0\0|NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\x3ftbq\x03\x89";
        let items: &[u8] = b"](}(X\x02\0\0\0idq\x04M\x2c\x01X\x02\0\0\0okq\x05\x88X\x01\0\0\0xq\x06G\x3f\xf0\0\0\0\0\0\0uetb.";
        assert_eq!(found, [head, state, items].concat());
    }

    #[test]
    fn what_returns_is_recalled() {
        let record = vec![("v", Value::Vector([1.0, 2.0, 3.0]))];
        let one = object_file(std::slice::from_ref(&record)).expect("fits");
        let two = object_file(&[record.clone(), record]).expect("fits");
        // The second one: `}(h KEY h _reconstruct h ndarray K0 TUPLE1 C1 b TUPLE3 R`, then
        // `( K1 K3 TUPLE1 h dtype NEWFALSE C24 ... t b u`.
        assert_eq!(two.len() - one.len(), 2 + 2 + 4 + 8 + 1 + 4 + 1 + 2 + 1 + 2 + 24 + 2 + 1);
        assert_eq!(two.windows(14).filter(|w| w == b"numpy\nndarray\n").count(), 1);
    }

    #[test]
    fn whole_numbers_take_the_shortest_opcode() {
        let int = |value| {
            let mut pickle = Pickle { out: Vec::new(), known: Vec::new() };
            pickle.int(value);
            pickle.out
        };
        assert_eq!(int(255), [b'K', 255]);
        assert_eq!(int(65_535), [b'M', 255, 255]);
        assert_eq!(int(65_536), [b'J', 0, 0, 1, 0]);
        assert_eq!(int(-1), [b'J', 255, 255, 255, 255]);
        assert_eq!(int(1 << 40), [0x8a, 8, 0, 0, 0, 0, 0, 1, 0, 0]);
    }

    #[test]
    fn an_empty_list_is_an_empty_array() {
        let file = object_file(&[]).expect("fits");
        assert!(file[10..].starts_with(b"{'descr': '|O', 'fortran_order': False, 'shape': (0,), }"));
        assert!(file.ends_with(b"\x89](etb."));
    }
}
