//! Further facts about an object.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::table::{Cell, CellError, Column};

/// Of what type the values of a fact are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FactKind {
    /// A text.
    Word,
    /// `true` or `false`.
    Flag,
    /// A whole number.
    Whole,
    /// A number.
    Real,
}

impl FactKind {
    /// A value as it is told; none where it is not of this kind.
    fn told(self, value: &str) -> Option<String> {
        match self {
            Self::Word => Some(value.to_owned()),
            Self::Flag => value.parse::<bool>().ok().map(|flag| flag.to_string()),
            Self::Whole => value.parse::<i32>().ok().map(|number| number.to_string()),
            Self::Real => {
                value.parse::<f64>().ok().filter(|number| number.is_finite()).map(|number| number.to_string())
            }
        }
    }

    /// The type's name in `docs/schema.md`.
    #[must_use]
    pub const fn type_name(self) -> &'static str {
        match self {
            Self::Word => "string",
            Self::Flag => "bool",
            Self::Whole => "i32",
            Self::Real => "f64",
        }
    }
}

macro_rules! keys {
    ($( $(#[doc = $doc:literal])+ $variant:ident = $key:literal $kind:ident, )+) => {
        /// What a fact is about.
        #[derive(Clone, Debug, PartialEq, Eq)]
        pub enum Attribute {
            $( $(#[doc = $doc])+ $variant, )+
            /// A key that this version does not know.
            Other(String),
        }

        impl Attribute {
            /// Those that tables have a field for: key, type, meaning.
            pub const FIELDS: &'static [(&'static str, FactKind, &'static str)] =
                &[$( ($key, FactKind::$kind, concat!($($doc),+)) ),+];

            /// Its key in tables.
            #[must_use]
            pub fn key(&self) -> &str {
                match self {
                    $( Self::$variant => $key, )+
                    Self::Other(key) => key,
                }
            }
        }

        #[cfg(test)]
        const KNOWN: &[(Attribute, &str)] = &[$( (Attribute::$variant, $key) ),+];
    };
}

keys! {
    /// Base type of the model: `car`, `truck`, ...
    BaseType = "base_type" Word,
    /// `emergency`, `taxi`, `wheelchair`, `pram`, `dog`, ..., or nothing.
    SpecialType = "special_type" Word,
    /// How many wheels a vehicle has.
    NumberOfWheels = "number_of_wheels" Whole,
    /// Whether a vehicle has lamps.
    HasLights = "has_lights" Flag,
    /// Whether a vehicle has doors that open.
    HasDynamicDoors = "has_dynamic_doors" Flag,
    /// Generation of the model: 2 for all of ours, after the detail of their meshes.
    Generation = "generation" Whole,
    /// `female` or `male`.
    Gender = "gender" Word,
    /// `adult`, `child` or `elderly`.
    Age = "age" Word,
    /// Whether its driver ignores lights, signs, vehicles and walkers.
    Reckless = "reckless" Flag,
    /// Whether its driver ignores lights and signs.
    Distracted = "distracted" Flag,
    /// Whether a walker crosses roads anywhere.
    CrossesAnywhere = "crosses_anywhere" Flag,
    /// Whether a walker sits in a wheelchair.
    UseWheelchair = "use_wheelchair" Flag,
    /// Whether a walker of this model may sit in a wheelchair.
    CanUseWheelchair = "can_use_wheelchair" Flag,
    /// Whether a walker sits on a bench, for the whole scene.
    SitsOnBench = "sits_on_bench" Flag,
    /// Whether a walker cannot be hurt: never.
    IsInvincible = "is_invincible" Flag,
    /// How fast a walker goes, m/s.
    Speed = "speed" Real,
    /// How long a traffic light shows green, s.
    GreenTime = "green_time" Real,
    /// How long it shows yellow then, s.
    YellowTime = "yellow_time" Real,
    /// How long all lights of the junction show red then, s; its own red lasts until its next turn.
    RedTime = "red_time" Real,
    /// Number of a traffic light among those of its junction.
    PoleIndex = "pole_index" Whole,
    /// What a sign says: `stop`, `yield`, `speed_limit_50`, ... Warning signs before hazards do not have it.
    SignType = "sign_type" Word,
    /// The number on a sign.
    Value = "value" Real,
    /// Height of the ground below a traffic light or a sign, m.
    GroundZ = "ground_z_m" Real,
    /// Number of the hazard that it is part of.
    Hazard = "hazard" Whole,
}

/// Further facts about an object. Tables hold them as a struct with a field for each fact that this version
/// knows, and `other` for those that it does not. As a text they are a JSON object of strings: known ones
/// first, in the order of [`Attribute::FIELDS`].
///
/// Values are told as they come back: a number as the shortest text that means it. One that is not of the
/// fact's type (of an imported dataset) counts as a fact that this version does not know.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Attributes {
    /// By the place of their fields.
    known: BTreeMap<usize, String>,
    /// In the order in which they were said.
    other: Vec<(String, String)>,
}

impl Attributes {
    /// No facts.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// These facts and one more.
    #[must_use]
    pub fn with(mut self, attribute: Attribute, value: impl fmt::Display) -> Self {
        self.say(attribute, value);
        self
    }

    /// Says one more; what was said before of the same is forgotten.
    pub fn say(&mut self, attribute: Attribute, value: impl fmt::Display) {
        self.put(attribute.key(), value.to_string());
    }

    fn put(&mut self, key: &str, value: String) {
        let place = place_of(key);
        let told = place.and_then(|place| Some((place, Attribute::FIELDS[place].1.told(&value)?)));
        self.other.retain(|(other, _)| other != key);
        match told {
            Some((place, told)) => drop(self.known.insert(place, told)),
            None => {
                if let Some(place) = place {
                    self.known.remove(&place);
                }
                self.other.push((key.to_owned(), value));
            }
        }
    }

    /// What is said about something.
    #[must_use]
    pub fn get(&self, attribute: &Attribute) -> Option<&str> {
        let key = attribute.key();
        let known = place_of(key).and_then(|place| self.known.get(&place)).map(String::as_str);
        known.or_else(|| self.other.iter().find(|(other, _)| other == key).map(|(_, value)| value.as_str()))
    }

    /// Whether something is said to be true.
    #[must_use]
    pub fn is_true(&self, attribute: &Attribute) -> bool {
        self.get(attribute) == Some("true")
    }

    /// All facts: keys and values.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        let known = self.known.iter().map(|(&place, value)| (Attribute::FIELDS[place].0, value.as_str()));
        known.chain(self.other.iter().map(|(key, value)| (key.as_str(), value.as_str())))
    }
}

/// Number of the field that a fact has.
fn place_of(key: &str) -> Option<usize> {
    Attribute::FIELDS.iter().position(|(name, ..)| *name == key)
}

/// Name of the field for facts without a field: a JSON object of strings.
pub const OTHER_FACTS: &str = "other";

/// What is said by some objects about something that has a field.
fn values_of<T: FromStr>(rows: &[&Attributes], place: usize) -> Vec<Option<T>> {
    rows.iter().map(|row| row.known.get(&place)?.parse().ok()).collect()
}

/// A struct with a field for each fact.
impl Cell for Attributes {
    fn column<'a>(values: impl Iterator<Item = &'a Self>) -> Column {
        let rows: Vec<&Self> = values.collect();
        let field = |(place, (key, kind, _)): (usize, &(&'static str, FactKind, &str))| {
            let column = match kind {
                FactKind::Word => Column::OptStr(values_of(&rows, place)),
                FactKind::Flag => Column::OptBool(values_of(&rows, place)),
                FactKind::Whole => Column::OptI32(values_of(&rows, place)),
                FactKind::Real => Column::OptF64(values_of(&rows, place)),
            };
            (*key, column)
        };
        let mut fields: Vec<_> = Attribute::FIELDS.iter().enumerate().map(field).collect();
        let other = |row: &&Self| {
            let facts = Self { known: BTreeMap::new(), other: row.other.clone() };
            (!row.other.is_empty()).then(|| facts.to_string())
        };
        fields.push((OTHER_FACTS, Column::OptStr(rows.iter().map(other).collect())));
        Column::Struct(fields)
    }

    fn values(column: Column) -> Result<Vec<Self>, CellError> {
        let parse = |row: usize, text: &str| {
            text.parse::<Self>().map_err(|e| CellError::Text { row, problem: e.to_string() })
        };
        match column {
            Column::Struct(fields) => {
                let mut rows = Vec::new();
                for (place, (key, column)) in fields.into_iter().enumerate() {
                    rows.resize_with(column.len(), Self::default);
                    let texts: Vec<Option<String>> = match column {
                        Column::OptStr(values) => values,
                        Column::OptBool(values) => told(values),
                        Column::OptI32(values) => told(values),
                        Column::OptF64(values) => told(values),
                        _ => return Err(CellError::Type),
                    };
                    for (at, text) in texts.into_iter().enumerate() {
                        match text {
                            Some(text) if key == OTHER_FACTS => rows[at].other = parse(at, &text)?.other,
                            Some(text) => drop(rows[at].known.insert(place, text)),
                            None => {}
                        }
                    }
                }
                Ok(rows)
            }
            // Format 1: a JSON object of strings.
            Column::Str(texts) => texts.iter().enumerate().map(|(row, text)| parse(row, text)).collect(),
            _ => Err(CellError::Type),
        }
    }
}

fn told<T: fmt::Display>(values: Vec<Option<T>>) -> Vec<Option<String>> {
    values.into_iter().map(|value| Some(value?.to_string())).collect()
}

impl Serialize for Attributes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter())
    }
}

impl<'de> Deserialize<'de> for Attributes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Facts;
        impl<'de> Visitor<'de> for Facts {
            type Value = Attributes;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object of strings")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Attributes, A::Error> {
                let mut facts = Attributes::new();
                while let Some((key, value)) = map.next_entry::<String, String>()? {
                    facts.put(&key, value);
                }
                Ok(facts)
            }
        }
        deserializer.deserialize_map(Facts)
    }
}

impl fmt::Display for Attributes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&serde_json::to_string(self).map_err(|_| fmt::Error)?)
    }
}

/// A text is no JSON object of strings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParseAttributesError {
    /// The text.
    pub text: String,
    /// What is wrong with it.
    pub problem: String,
}

impl fmt::Display for ParseAttributesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` is no JSON object of strings: {}", self.text, self.problem)
    }
}

impl std::error::Error for ParseAttributesError {}

impl FromStr for Attributes {
    type Err = ParseAttributesError;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let error =
            |e: serde_json::Error| ParseAttributesError { text: text.to_owned(), problem: e.to_string() };
        serde_json::from_str(text).map_err(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn keys_are_those_of_the_format() {
        let keys = "base_type special_type number_of_wheels has_lights has_dynamic_doors generation gender age \
                    reckless distracted crosses_anywhere use_wheelchair can_use_wheelchair sits_on_bench is_invincible speed \
                    green_time yellow_time red_time pole_index sign_type value ground_z_m hazard";
        assert_eq!(KNOWN.iter().map(|(_, key)| *key).collect::<Vec<_>>().join(" "), keys);
        for (attribute, key) in KNOWN {
            assert_eq!(attribute.key(), *key);
        }
    }

    #[test]
    fn unknown_keys_are_kept_and_other_texts_refused() {
        let text = r#"{"reckless":"true","distracted":"false","tow_bar":"left"}"#;
        let facts: Attributes = text.parse().expect("an object of strings");
        assert_eq!(facts.to_string(), text);
        assert!(facts.is_true(&Attribute::Reckless) && !facts.is_true(&Attribute::Distracted));
        assert!(!facts.is_true(&Attribute::UseWheelchair));
        assert_eq!(facts.get(&Attribute::Other("tow_bar".into())), Some("left"));
        for text in ["", "not json", "[]", r#"{"reckless":true}"#, "{} {}"] {
            let error = text.parse::<Attributes>().expect_err("is no object of strings").to_string();
            assert!(error.starts_with(&format!("`{text}` is no JSON object of strings: ")), "{error}");
        }
    }

    #[test]
    fn facts_have_fields_of_their_types() {
        let facts = [
            Attributes::new()
                .with(Attribute::Value, 50.0)
                .with(Attribute::SignType, "speed_limit")
                .with(Attribute::Reckless, true)
                .with(Attribute::GreenTime, "12.500")
                .with(Attribute::PoleIndex, 3),
            // Of an imported dataset: no number, no truth value, no key of ours.
            Attributes::new()
                .with(Attribute::Speed, "fast")
                .with(Attribute::Reckless, "True")
                .with(Attribute::Other("tow_bar".into()), "left"),
        ];
        let text = r#"{"reckless":"true","green_time":"12.5","pole_index":"3","sign_type":"speed_limit","value":"50"}"#;
        assert_eq!(facts[0].to_string(), text);
        let column = Attributes::column(facts.iter());
        let Column::Struct(fields) = &column else { panic!("{column:?}") };
        let field = |name: &str| fields.iter().find(|(key, _)| *key == name).expect("is a field").1.clone();
        assert_eq!(field("value"), Column::OptF64(vec![Some(50.0), None]));
        assert_eq!(field("reckless"), Column::OptBool(vec![Some(true), None]));
        assert_eq!(field("pole_index"), Column::OptI32(vec![Some(3), None]));
        assert_eq!(field("sign_type"), Column::OptStr(vec![Some("speed_limit".into()), None]));
        let other = r#"{"speed":"fast","reckless":"True","tow_bar":"left"}"#;
        assert_eq!(field("other"), Column::OptStr(vec![None, Some(other.into())]));
        assert_eq!(facts[1].get(&Attribute::Speed), Some("fast"));
        assert_eq!(Attributes::values(column), Ok(facts.to_vec()));
        let older = Column::Str(vec![text.into(), other.into()]);
        assert_eq!(Attributes::values(older), Ok(facts.to_vec()));
        // What is said again is said anew.
        let anew = facts[1].clone().with(Attribute::Speed, 1.5).with(Attribute::Value, "none");
        assert_eq!(anew.to_string(), r#"{"speed":"1.5","reckless":"True","tow_bar":"left","value":"none"}"#);
    }

    fn a_key() -> impl Strategy<Value = String> {
        let known = prop::sample::select(KNOWN.to_vec()).prop_map(|(_, key)| key.to_owned());
        prop_oneof![".*", known]
    }

    proptest! {
        #[test]
        fn any_strings_come_back(
            said in prop::collection::vec((a_key(), prop_oneof![".*", "true|-?[0-9]{1,12}([.][0-9]{1,3})?"]), 0..6)
        ) {
            let facts = said.iter().fold(Attributes::new(), |facts, (k, v)| facts.with(Attribute::Other(k.clone()), v));
            prop_assert_eq!(facts.to_string().parse::<Attributes>(), Ok(facts.clone()));
            prop_assert_eq!(Attributes::values(Attributes::column([&facts].into_iter())), Ok(vec![facts]));
        }
    }
}
