//! How a key is declared, once: [`settings!`] makes the struct, its defaults and its reader of it, and with
//! them the page of keys, the JSON schema and the names in SimBEV2X.

use std::ops::RangeInclusive;

use frames::{deg, to_deg};

use crate::config_key::YamlName;
use crate::reader::Section;

/// Declares a section of the configuration:
///
// settings! {
//     /// How long scenes last.
//     pub struct TimingSettings {
//         /// Shortest scene, s.
//         min_duration_s: f64 = 8.0, within(1.0..=3600.0), yaml("min_scene_duration");
//     }
//     rule in_order;
// }
///
/// A field is a key of the same name: its type, its default, and methods of [`Key`] that say the rest. The
/// rule, a function, holds keys against each other.
macro_rules! settings {
    (
        $(#[doc = $about:literal])+
        $(#[derive($($derive:ident),+)])?
        $vis:vis struct $name:ident {
            $(
                $(#[doc = $doc:literal])+
                $(#[serde($($serde:tt)+)])?
                $field:ident : $type:ty = $default:expr $(, $how:ident ( $($arg:expr),* ))* ;
            )+
        }
        $(rule $rule:path;)?
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize $($(, $derive)+)?)]
        #[serde(default)]
        $vis struct $name {
            $(
                $(#[doc = $doc])+
                #[doc = concat!("\n\nKey: `= ", stringify!($default), $(", ", stringify!($how($($arg),*)),)* "`")]
                $(#[serde($($serde)+)])?
                $vis $field: $type,
            )+
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)+ }
            }
        }

        impl $crate::key::Settings for $name {
            fn read(section: &$crate::reader::Section<'_>, default: &Self) -> Self {
                let read = Self {
                    $($field: $crate::key::Key::<$type>::new(stringify!($field), concat!($($doc),+))
                        $(.$how($($arg),*))*
                        .read(section, &default.$field),)+
                };
                $($rule(section, &read);)?
                read
            }
        }
    };
}

/// Declares an enumeration whose values are words of the configuration.
macro_rules! choice {
    (
        $(#[doc = $about:literal])+
        $vis:vis enum $name:ident {
            $($(#[doc = $doc:literal])+ $(#[$default:ident])? $variant:ident = $word:literal,)+
        }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
        $vis enum $name {
            $($(#[doc = $doc])+ $(#[$default])? #[serde(rename = $word)] $variant,)+
        }

        #[allow(dead_code, reason = "some choices are only read")]
        impl $name {
            /// All of them.
            $vis const ALL: [Self; [$($word),+].len()] = [$(Self::$variant),+];

            /// Name in configurations, tables and reports.
            #[must_use]
            $vis fn name(self) -> &'static str {
                match self { $(Self::$variant => $word,)+ }
            }
        }

        impl $crate::key::Choice for $name {
            const WORDS: &'static [(&'static str, Self)] = &[$(($word, Self::$variant)),+];
        }
    };
}

pub(crate) use {choice, settings};

/// A section of the configuration.
pub(crate) trait Settings: Sized {
    /// Reads it; keys that are absent have the value of `default`.
    fn read(section: &Section<'_>, default: &Self) -> Self;
}

/// One of some words.
pub(crate) trait Choice: Copy + PartialEq + 'static {
    /// The words and their values.
    const WORDS: &'static [(&'static str, Self)];
}

/// A key's name here and in SimBEV2X, and its meaning.
#[derive(Clone, Debug)]
pub(crate) struct Name {
    pub(crate) key: &'static str,
    pub(crate) doc: &'static str,
    /// What counts without the key, in words.
    pub(crate) absent: &'static str,
    yaml: Vec<YamlName>,
}

/// A key with values of a type, read in some way.
pub(crate) struct Key<T, How = Plain> {
    name: Name,
    how: How,
    value: std::marker::PhantomData<fn() -> T>,
}

/// As its type says.
pub(crate) struct Plain;
/// A number in a range.
pub(crate) struct Within<B>(RangeInclusive<B>);
/// A number in a range, in another unit than that of the field.
pub(crate) struct Scaled {
    range: RangeInclusive<f64>,
    unit: &'static str,
    written: fn(f64) -> f64,
    value: fn(f64) -> f64,
}
/// Three angles in degrees.
pub(crate) struct DegreesEach;
/// One of some words.
pub(crate) struct Word;
/// A table of its own.
pub(crate) struct Table;
/// No key: the keys of the field's type stand among those of the section.
pub(crate) struct Flat;
/// The same, if the key, a flag, is true.
pub(crate) struct Switched;
/// By a function.
pub(crate) struct By<F>(F);
/// No key: the reader of the section knows the value.
pub(crate) struct Apart;

impl<T> Key<T> {
    /// A key named as its field, and its meaning.
    pub(crate) fn new(key: &'static str, doc: &'static str) -> Self {
        let name = Name { key, doc, absent: "none", yaml: Vec::new() };
        Self { name, how: Plain, value: std::marker::PhantomData }
    }

    fn how<How>(self, how: How) -> Key<T, How> {
        Key { name: self.name, how, value: self.value }
    }

    pub(crate) fn within(self, range: RangeInclusive<T::Bound>) -> Key<T, Within<T::Bound>>
    where
        T: Number,
    {
        self.how(Within(range))
    }

    /// 0 to 1.
    pub(crate) fn share(self) -> Key<T, Within<f64>> {
        self.how(Within(0.0..=1.0))
    }

    /// Radians here, degrees in the configuration.
    pub(crate) fn degrees(self, range: RangeInclusive<f64>) -> Key<T, Scaled> {
        // Degrees that are written with nine digits come back as they were.
        let written = |radians: f64| (to_deg(radians) * 1e9).round() / 1e9;
        self.how(Scaled { range, unit: "degrees", written, value: deg })
    }

    /// A thousandth of what the configuration says, in a unit such as `mrad`.
    pub(crate) fn milli(self, range: RangeInclusive<f64>, unit: &'static str) -> Key<T, Scaled> {
        let (written, value) = (|value| 1e3 * value, |written| 1e-3 * written);
        self.how(Scaled { range, unit, written, value })
    }

    pub(crate) fn degrees_each(self) -> Key<T, DegreesEach> {
        self.how(DegreesEach)
    }

    pub(crate) fn choice(self) -> Key<T, Word> {
        self.how(Word)
    }

    pub(crate) fn table(self) -> Key<T, Table> {
        self.how(Table)
    }

    pub(crate) fn flat(self) -> Key<T, Flat> {
        self.how(Flat)
    }

    pub(crate) fn switched(self) -> Key<T, Switched> {
        self.how(Switched)
    }

    pub(crate) fn by<F: Fn(&Section<'_>, &Name, T) -> T>(self, read: F) -> Key<T, By<F>> {
        self.how(By(read))
    }

    pub(crate) fn apart(self) -> Key<T, Apart> {
        self.how(Apart)
    }
}

impl<T, How> Key<T, How> {
    /// The key's name, where it is not that of the field.
    pub(crate) fn named(mut self, key: &'static str) -> Self {
        self.name.key = key;
        self
    }

    /// What counts without the key, in words.
    pub(crate) fn or(mut self, absent: &'static str) -> Self {
        self.name.absent = absent;
        self
    }

    /// A key of SimBEV2X with the same value.
    pub(crate) fn yaml(mut self, name: &'static str) -> Self {
        self.name.yaml.push(YamlName::Same(name));
        self
    }

    /// A key of SimBEV2X with percents instead of shares.
    pub(crate) fn yaml_percent(mut self, name: &'static str) -> Self {
        self.name.yaml.push(YamlName::Percent(name));
        self
    }

    /// A key within a mapping (`..._properties`) of SimBEV2X.
    pub(crate) fn yaml_in(mut self, mapping: &'static str, name: &'static str) -> Self {
        self.name.yaml.push(YamlName::In(mapping, name));
        self
    }

    /// Tells the names in SimBEV2X of a key that was read.
    fn told(&self, section: &Section<'_>) {
        section.named_there(self.name.key, &self.name.yaml);
    }
}

/// A list of tables, each a section.
pub(crate) fn tables<T: Settings + Default>(s: &Section<'_>, name: &Name, _: Vec<T>) -> Vec<T> {
    let read = |item: &Section<'_>| T::read(item, &T::default());
    let list = s.sections(name.key, name.absent, name.doc);
    read(&s.describe_item(name.key));
    list.unwrap_or_default().iter().map(read).collect()
}

/// A meaning with its unit.
fn in_unit(doc: &str, unit: &str) -> String {
    format!("{}, {unit}.", doc.trim().trim_end_matches('.'))
}

/// A type that a plain key has.
pub(crate) trait Value: Sized {
    fn read(section: &Section<'_>, name: &Name, default: &Self) -> Self;
}

/// A number, or none.
pub(crate) trait Number: Sized {
    type Bound: Copy;
    fn read(section: &Section<'_>, name: &Name, range: (Self::Bound, Self::Bound), default: &Self) -> Self;
}

impl<T: Value> Key<T, Plain> {
    pub(crate) fn read(self, section: &Section<'_>, default: &T) -> T {
        let read = T::read(section, &self.name, default);
        self.told(section);
        read
    }
}

impl<T: Number> Key<T, Within<T::Bound>> {
    pub(crate) fn read(self, section: &Section<'_>, default: &T) -> T {
        let range = (*self.how.0.start(), *self.how.0.end());
        let read = T::read(section, &self.name, range, default);
        self.told(section);
        read
    }
}

impl Key<f64, Scaled> {
    pub(crate) fn read(self, section: &Section<'_>, default: &f64) -> f64 {
        let Scaled { range, unit, written, value } = &self.how;
        let doc = in_unit(self.name.doc, unit);
        let (min, max) = (*range.start(), *range.end());
        let read = section.number(self.name.key, written(*default), min, max, &doc);
        self.told(section);
        value(read)
    }
}

impl Key<[f64; 3], DegreesEach> {
    pub(crate) fn read(self, section: &Section<'_>, default: &[f64; 3]) -> [f64; 3] {
        let doc = in_unit(self.name.doc, "degrees");
        section.triple(self.name.key, default.map(to_deg), &doc).map(deg)
    }
}

impl<T: Choice> Key<T, Word> {
    pub(crate) fn read(self, section: &Section<'_>, default: &T) -> T {
        let at = T::WORDS.iter().position(|(_, value)| value == default).unwrap_or(0);
        let read = section.choice(self.name.key, T::WORDS, at, self.name.doc);
        self.told(section);
        read
    }
}

impl<T: Settings> Key<T, Table> {
    pub(crate) fn read(self, section: &Section<'_>, default: &T) -> T {
        T::read(&section.section(self.name.key, self.name.doc), default)
    }
}

impl<T: Settings> Key<T, Flat> {
    pub(crate) fn read(self, section: &Section<'_>, default: &T) -> T {
        T::read(section, default)
    }
}

impl<T: Settings + Default> Key<Option<T>, Switched> {
    pub(crate) fn read(self, section: &Section<'_>, default: &Option<T>) -> Option<T> {
        let is_on = section.flag(self.name.key, default.is_some(), self.name.doc);
        self.told(section);
        let read = match default {
            Some(default) => T::read(section, default),
            None => T::read(section, &T::default()),
        };
        is_on.then_some(read)
    }
}

impl<T: Clone, F: Fn(&Section<'_>, &Name, T) -> T> Key<T, By<F>> {
    pub(crate) fn read(self, section: &Section<'_>, default: &T) -> T {
        let read = (self.how.0)(section, &self.name, default.clone());
        self.told(section);
        read
    }
}

impl<T: Clone> Key<T, Apart> {
    pub(crate) fn read(self, _: &Section<'_>, default: &T) -> T {
        default.clone()
    }
}

impl Value for bool {
    fn read(section: &Section<'_>, name: &Name, default: &Self) -> Self {
        section.flag(name.key, *default, name.doc)
    }
}

impl Value for String {
    fn read(section: &Section<'_>, name: &Name, default: &Self) -> Self {
        section.text(name.key, default, name.doc)
    }
}

impl Value for Option<String> {
    fn read(section: &Section<'_>, name: &Name, _: &Self) -> Self {
        section.optional_text(name.key, name.absent, name.doc)
    }
}

impl Value for Vec<String> {
    fn read(section: &Section<'_>, name: &Name, default: &Self) -> Self {
        section.texts(name.key, default, name.doc)
    }
}

impl Value for [f64; 3] {
    fn read(section: &Section<'_>, name: &Name, default: &Self) -> Self {
        section.triple(name.key, *default, name.doc)
    }
}

impl Value for Vec<[f64; 3]> {
    fn read(section: &Section<'_>, name: &Name, _: &Self) -> Self {
        section.points(name.key, name.absent, name.doc).unwrap_or_default()
    }
}

impl Value for Vec<[u8; 3]> {
    fn read(section: &Section<'_>, name: &Name, default: &Self) -> Self {
        section.colors(name.key, default, name.doc)
    }
}

impl Value for Option<Vec<f64>> {
    fn read(section: &Section<'_>, name: &Name, _: &Self) -> Self {
        section.numbers(name.key, name.absent, name.doc)
    }
}

impl Number for f64 {
    type Bound = Self;
    fn read(section: &Section<'_>, name: &Name, (min, max): (f64, f64), default: &Self) -> Self {
        section.number(name.key, *default, min, max, name.doc)
    }
}

impl Number for Option<f64> {
    type Bound = f64;
    fn read(section: &Section<'_>, name: &Name, (min, max): (f64, f64), _: &Self) -> Self {
        section.optional_number(name.key, name.absent, min, max, name.doc)
    }
}

/// Whole numbers; their ranges are within `i64`, as all of TOML's are.
macro_rules! whole {
    ($($type:ty),+) => {
        $(
            impl Number for $type {
                type Bound = Self;
                fn read(section: &Section<'_>, name: &Name, range: (Self, Self), default: &Self) -> Self {
                    let [low, high, number] = [range.0, range.1, *default].map(|n| n as i64);
                    section.integer(name.key, number, low, high, name.doc) as Self
                }
            }

            impl Number for Option<$type> {
                type Bound = $type;
                fn read(section: &Section<'_>, name: &Name, range: ($type, $type), _: &Self) -> Self {
                    let [low, high] = [range.0, range.1].map(|n| n as i64);
                    section.optional_integer(name.key, name.absent, low, high, name.doc).map(|n| n as $type)
                }
            }
        )+
    };
}

whole!(u8, u32, u64);
