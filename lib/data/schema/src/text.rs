//! Types that tables hold as text.

use std::fmt;
use std::str::FromStr;

/// A type whose values stand in columns of strings, as the text that it displays and parses.
pub trait Text: fmt::Display + FromStr<Err: fmt::Display> {}

/// A text is none of a type's words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WordError {
    /// What was expected.
    pub what: &'static str,
    /// The text.
    pub text: String,
    /// The words there are.
    pub known: Vec<&'static str>,
}

impl fmt::Display for WordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` is no {}, expected one of {}", self.text, self.what, self.known.join(", "))
    }
}

impl std::error::Error for WordError {}

/// Gives each variant of an enum its word: names, parsing and [`Text`].
macro_rules! words {
    ($type:ident, $what:literal: $( $variant:ident = $word:literal, )+) => {
        impl $type {
            /// All of them.
            pub const ALL: &[Self] = &[$( Self::$variant ),+];

            /// Its word in tables.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $( Self::$variant => $word, )+
                }
            }
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $type {
            type Err = $crate::text::WordError;
            fn from_str(text: &str) -> Result<Self, Self::Err> {
                match text {
                    $( $word => Ok(Self::$variant), )+
                    _ => Err($crate::text::WordError {
                        what: $what,
                        text: text.to_owned(),
                        known: vec![$( $word ),+],
                    }),
                }
            }
        }

        impl $crate::text::Text for $type {}
    };
}
pub(crate) use words;
