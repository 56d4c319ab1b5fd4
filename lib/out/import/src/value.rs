//! Values as pickles and JSON texts hold them.

/// A value that Python wrote.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// `None`, or `null`.
    None,
    /// A truth value.
    Bool(bool),
    /// A whole number.
    Int(i128),
    /// Any other number; in JSON `NaN` and `Infinity`, too.
    Float(f64),
    /// A text.
    Text(String),
    /// Bytes.
    Bytes(Vec<u8>),
    /// A list, a tuple, or an array of objects.
    List(Vec<Value>),
    /// A dictionary with texts as keys, in the order of the file.
    Dict(Vec<(String, Value)>),
    /// An array of numbers, in C order.
    Numbers {
        /// Lengths of its dimensions.
        shape: Vec<usize>,
        /// Its values.
        values: Vec<f64>,
    },
}

impl Value {
    /// What a dictionary has under a key: of several the last, as in Python.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Self> {
        let Self::Dict(entries) = self else { return None };
        entries.iter().rev().find(|(name, _)| name == key).map(|(_, value)| value)
    }

    /// A number.
    #[must_use]
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Int(value) => Some(*value as f64),
            Self::Float(value) => Some(*value),
            _ => None,
        }
    }

    /// A text.
    #[must_use]
    pub fn text(&self) -> Option<&str> {
        if let Self::Text(text) = self { Some(text) } else { None }
    }

    /// A truth value.
    #[must_use]
    pub fn flag(&self) -> Option<bool> {
        if let Self::Bool(flag) = self { Some(*flag) } else { None }
    }

    /// A whole number that fits.
    #[must_use]
    pub fn whole<T: TryFrom<i128>>(&self) -> Option<T> {
        if let Self::Int(value) = self { T::try_from(*value).ok() } else { None }
    }

    /// So many numbers: an array of whatever shape, or nested lists.
    #[must_use]
    pub fn numbers<const N: usize>(&self) -> Option<[f64; N]> {
        let mut found = Vec::with_capacity(N);
        self.gather(N, &mut found)?;
        found.try_into().ok()
    }

    fn gather(&self, most: usize, found: &mut Vec<f64>) -> Option<()> {
        match self {
            Self::Numbers { values, .. } if found.len() + values.len() <= most => found.extend(values),
            Self::List(list) => list.iter().try_for_each(|item| item.gather(most, found))?,
            other if found.len() < most => found.push(other.number()?),
            _ => return None,
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_out_of_arrays_and_nested_lists() {
        let nested = Value::List(vec![
            Value::List(vec![Value::Int(1), Value::Float(2.5)]),
            Value::Numbers { shape: vec![2], values: vec![3.0, 4.0] },
        ]);
        assert_eq!(nested.numbers(), Some([1.0, 2.5, 3.0, 4.0]));
        assert_eq!(nested.numbers::<3>(), None, "too many");
        assert_eq!(nested.numbers::<5>(), None, "too few");
        assert_eq!(Value::List(vec![Value::Text("1".into())]).numbers::<1>(), None);
    }

    #[test]
    fn of_equal_keys_the_last_counts() {
        let dict = Value::Dict(vec![("a".into(), Value::Int(1)), ("a".into(), Value::Int(300))]);
        assert_eq!(dict.get("a").and_then(Value::whole::<u16>), Some(300));
        assert_eq!(dict.get("a").and_then(Value::whole::<u8>), None);
    }
}
