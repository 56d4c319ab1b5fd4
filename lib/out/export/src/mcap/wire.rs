//! Protocol buffers as far as messages are written: fields in order of their numbers, proto3's defaults left
//! out.
//!
//! By hand: a message's fields stand in one list, from which its bytes and its description for readers both
//! follow (`prost` makes the first of them, and a build of `protoc` would have to make the second).

/// Numbers of types in descriptors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Double = 1,
    Int64 = 3,
    Int32 = 5,
    Fixed32 = 7,
    Bool = 8,
    String = 9,
    Message = 11,
    Bytes = 12,
    Enum = 14,
}

/// Wire types.
const VARINT: u32 = 0;
const FIXED_64: u32 = 1;
const DELIMITED: u32 = 2;
const FIXED_32: u32 = 5;

/// What a field of a type is in a descriptor.
#[derive(Clone, Copy)]
pub(crate) struct FieldType {
    pub(crate) kind: Kind,
    pub(crate) is_repeated: bool,
    /// The message that it holds, or that owns the enumeration that it holds.
    pub(crate) message: Option<fn() -> Described>,
    /// Name of the enumeration within that message.
    pub(crate) enumeration: Option<&'static str>,
}

impl FieldType {
    const fn plain(kind: Kind) -> Self {
        Self { kind, is_repeated: false, message: None, enumeration: None }
    }
}

/// A field of a message.
pub(crate) struct FieldOf {
    pub(crate) name: &'static str,
    pub(crate) number: u32,
    pub(crate) of: FieldType,
}

/// An enumeration of a message.
pub(crate) struct EnumOf {
    pub(crate) name: &'static str,
    pub(crate) values: &'static [(&'static str, u32)],
}

/// A message as readers need to know it.
pub(crate) struct Described {
    /// `foxglove`.
    pub(crate) package: &'static str,
    /// `Pose`.
    pub(crate) name: &'static str,
    pub(crate) fields: Vec<FieldOf>,
    pub(crate) enums: Vec<EnumOf>,
}

/// A value of a field.
pub(crate) trait Value {
    /// What a field of it is.
    const TYPE: FieldType;
    /// Appends it as a field of a number, unless it is the default.
    fn put(&self, number: u32, out: &mut Vec<u8>);
}

/// A message.
pub(crate) trait Message {
    /// What it is.
    fn describe() -> Described;
    /// Appends its fields.
    fn encode(&self, out: &mut Vec<u8>);
}

/// Appends a number, seven bits a byte.
pub(crate) fn varint(mut number: u64, out: &mut Vec<u8>) {
    while number >= 0x80 {
        out.push(number as u8 | 0x80);
        number >>= 7;
    }
    out.push(number as u8);
}

fn key(number: u32, wire: u32, out: &mut Vec<u8>) {
    varint(u64::from(number << 3 | wire), out);
}

fn delimited(number: u32, bytes: &[u8], out: &mut Vec<u8>) {
    key(number, DELIMITED, out);
    varint(bytes.len() as u64, out);
    out.extend_from_slice(bytes);
}

impl Value for f64 {
    const TYPE: FieldType = FieldType::plain(Kind::Double);
    fn put(&self, number: u32, out: &mut Vec<u8>) {
        // Minus zero is no default: its bits differ.
        if self.to_bits() != 0 {
            key(number, FIXED_64, out);
            out.extend_from_slice(&self.to_le_bytes());
        }
    }
}

impl Value for i64 {
    const TYPE: FieldType = FieldType::plain(Kind::Int64);
    fn put(&self, number: u32, out: &mut Vec<u8>) {
        if *self != 0 {
            key(number, VARINT, out);
            varint(*self as u64, out);
        }
    }
}

impl Value for i32 {
    const TYPE: FieldType = FieldType::plain(Kind::Int32);
    fn put(&self, number: u32, out: &mut Vec<u8>) {
        if *self != 0 {
            key(number, VARINT, out);
            // Negative numbers are as long as those of 64 bits.
            varint(i64::from(*self) as u64, out);
        }
    }
}

impl Value for u32 {
    const TYPE: FieldType = FieldType::plain(Kind::Fixed32);
    fn put(&self, number: u32, out: &mut Vec<u8>) {
        if *self != 0 {
            key(number, FIXED_32, out);
            out.extend_from_slice(&self.to_le_bytes());
        }
    }
}

impl Value for bool {
    const TYPE: FieldType = FieldType::plain(Kind::Bool);
    fn put(&self, number: u32, out: &mut Vec<u8>) {
        if *self {
            key(number, VARINT, out);
            out.push(1);
        }
    }
}

impl Value for String {
    const TYPE: FieldType = FieldType::plain(Kind::String);
    fn put(&self, number: u32, out: &mut Vec<u8>) {
        if !self.is_empty() {
            delimited(number, self.as_bytes(), out);
        }
    }
}

impl Value for Vec<u8> {
    const TYPE: FieldType = FieldType::plain(Kind::Bytes);
    fn put(&self, number: u32, out: &mut Vec<u8>) {
        if !self.is_empty() {
            delimited(number, self, out);
        }
    }
}

/// Packed.
impl Value for Vec<f64> {
    const TYPE: FieldType = FieldType { is_repeated: true, ..<f64 as Value>::TYPE };
    fn put(&self, number: u32, out: &mut Vec<u8>) {
        if !self.is_empty() {
            key(number, DELIMITED, out);
            varint(8 * self.len() as u64, out);
            self.iter().for_each(|value| out.extend_from_slice(&value.to_le_bytes()));
        }
    }
}

/// Packed.
impl Value for Vec<u32> {
    const TYPE: FieldType = FieldType { is_repeated: true, ..<u32 as Value>::TYPE };
    fn put(&self, number: u32, out: &mut Vec<u8>) {
        if !self.is_empty() {
            key(number, DELIMITED, out);
            varint(4 * self.len() as u64, out);
            self.iter().for_each(|value| out.extend_from_slice(&value.to_le_bytes()));
        }
    }
}

impl<M: Message> Value for M {
    const TYPE: FieldType =
        FieldType { kind: Kind::Message, is_repeated: false, message: Some(M::describe), enumeration: None };
    fn put(&self, number: u32, out: &mut Vec<u8>) {
        key(number, DELIMITED, out);
        let start = out.len();
        self.encode(out);
        let mut length = Vec::with_capacity(4);
        varint((out.len() - start) as u64, &mut length);
        out.splice(start..start, length);
    }
}

impl<M: Message> Value for Vec<M> {
    const TYPE: FieldType = FieldType { is_repeated: true, ..<M as Value>::TYPE };
    fn put(&self, number: u32, out: &mut Vec<u8>) {
        self.iter().for_each(|message| message.put(number, out));
    }
}

/// Appends a number of an enumeration.
pub(crate) fn put_enum(value: u32, number: u32, out: &mut Vec<u8>) {
    if value != 0 {
        key(number, VARINT, out);
        varint(u64::from(value), out);
    }
}

/// Defines messages: for each its package, its fields with their numbers, and enumerations that belong to it.
macro_rules! messages {
    ($(
        $(#[doc = $doc:literal])+
        $message:ident in $package:literal {
            $( $(#[doc = $field_doc:literal])* $field:ident: $type:ty = $number:literal, )+
        }
        $( enum $enum:ident as $enum_name:literal { $( $variant:ident = $variant_name:literal $value:literal, )+ } )?
    )+) => { $(
        $(#[doc = $doc])+
        #[derive(Clone, Debug, Default, PartialEq)]
        #[allow(non_snake_case, reason = "calibrations have K, D, R and P")]
        pub(crate) struct $message {
            $( $(#[doc = $field_doc])* pub(crate) $field: $type, )+
        }

        impl $crate::mcap::wire::Message for $message {
            fn describe() -> $crate::mcap::wire::Described {
                #[allow(unused_imports, reason = "not every message has an enumeration")]
                use $crate::mcap::wire::{Described, EnumOf, FieldOf, Value};
                Described {
                    package: $package,
                    name: stringify!($message),
                    fields: vec![$( FieldOf {
                        name: stringify!($field).trim_start_matches("r#"),
                        number: $number,
                        of: <$type as Value>::TYPE,
                    } ),+],
                    enums: vec![$( EnumOf { name: $enum_name, values: &[$( ($variant_name, $value) ),+] } )?],
                }
            }

            fn encode(&self, out: &mut Vec<u8>) {
                use $crate::mcap::wire::Value;
                $( self.$field.put($number, out); )+
            }
        }

        $(
            /// An enumeration of the message above.
            #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
            #[allow(dead_code, reason = "all that the description lists")]
            pub(crate) enum $enum { #[default] $( $variant = $value ),+ }

            impl $crate::mcap::wire::Value for $enum {
                const TYPE: $crate::mcap::wire::FieldType = $crate::mcap::wire::FieldType {
                    kind: $crate::mcap::wire::Kind::Enum,
                    is_repeated: false,
                    message: Some(<$message as $crate::mcap::wire::Message>::describe),
                    enumeration: Some($enum_name),
                };
                fn put(&self, number: u32, out: &mut Vec<u8>) {
                    $crate::mcap::wire::put_enum(*self as u32, number, out);
                }
            }
        )?
    )+ };
}
pub(crate) use messages;

#[cfg(test)]
mod tests {
    use super::*;

    messages! {
        /// The examples of the encoding's own documentation.
        Test1 in "t" { a: i32 = 1, }
        /// A text.
        Test2 in "t" { b: String = 2, }
        /// A message in a message.
        Test3 in "t" { c: Test1 = 3, d: f64 = 4, e: u32 = 5, f: Vec<f64> = 6, g: bool = 7, h: Colour = 8, }
        enum Colour as "Colour" { Red = "RED" 0, Blue = "BLUE" 2, }
    }

    fn bytes(message: &impl Message) -> Vec<u8> {
        let mut out = Vec::new();
        message.encode(&mut out);
        out
    }

    #[test]
    fn bytes_are_those_of_the_documentation() {
        // protobuf.dev, "Encoding".
        assert_eq!(bytes(&Test1 { a: 150 }), [0x08, 0x96, 0x01]);
        assert_eq!(bytes(&Test1 { a: -2 })[1..], [0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1]);
        assert_eq!(bytes(&Test2 { b: "testing".into() }), *b"\x12\x07testing");
        assert_eq!(bytes(&Test3 { c: Test1 { a: 150 }, ..Test3::default() }), [0x1a, 3, 0x08, 0x96, 0x01]);
        let rest = Test3 { d: -0.0, e: 1, f: vec![0.0], g: true, h: Colour::Blue, ..Test3::default() };
        let mut want = vec![0x1a, 0, 0x21, 0, 0, 0, 0, 0, 0, 0, 0x80, 0x2d, 1, 0, 0, 0];
        want.extend([0x32, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0x38, 1, 0x40, 2]);
        assert_eq!(bytes(&rest), want);
    }

    #[test]
    fn long_messages_have_long_lengths() {
        let inner = Test2 { b: "x".repeat(300) };
        let mut out = Vec::new();
        inner.put(1, &mut out);
        // 300 bytes, their key and a length of two bytes: 303 = 0b10_0101111.
        assert_eq!((&out[..3], out.len()), (&[0x0a, 0xaf, 0x02][..], 306));
    }
}
