//! Further facts about an object.

use std::fmt;
use std::str::FromStr;

use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::text::Text;

macro_rules! keys {
    ($( $(#[doc = $doc:literal])+ $variant:ident = $key:literal, )+) => {
        /// What a fact is about.
        #[derive(Clone, Debug, PartialEq, Eq)]
        pub enum Attribute {
            $( $(#[doc = $doc])+ $variant, )+
            /// A key that this version does not know.
            Other(String),
        }

        impl Attribute {
            /// Its key in tables.
            #[must_use]
            pub fn key(&self) -> &str {
                match self {
                    $( Self::$variant => $key, )+
                    Self::Other(key) => key,
                }
            }

            fn from_key(key: &str) -> Self {
                match key {
                    $( $key => Self::$variant, )+
                    _ => Self::Other(key.to_owned()),
                }
            }
        }

        #[cfg(test)]
        const KNOWN: &[(Attribute, &str)] = &[$( (Attribute::$variant, $key) ),+];
    };
}

keys! {
    /// Base type of the model: `car`, `truck`, ...
    BaseType = "base_type",
    /// `emergency`, `taxi`, `wheelchair`, `pram`, `dog`, ..., or nothing.
    SpecialType = "special_type",
    /// How many wheels a vehicle has.
    NumberOfWheels = "number_of_wheels",
    /// Whether a vehicle has lamps.
    HasLights = "has_lights",
    /// Whether a vehicle has doors that open.
    HasDynamicDoors = "has_dynamic_doors",
    /// Generation of the model: 2 for all of ours, after the detail of their meshes.
    Generation = "generation",
    /// `female` or `male`.
    Gender = "gender",
    /// `adult`, `child` or `elderly`.
    Age = "age",
    /// Whether its driver ignores lights, signs, vehicles and walkers.
    Reckless = "reckless",
    /// Whether its driver ignores lights and signs.
    Distracted = "distracted",
    /// Whether a walker crosses roads anywhere.
    CrossesAnywhere = "crosses_anywhere",
    /// Whether a walker sits in a wheelchair.
    UseWheelchair = "use_wheelchair",
    /// Whether a walker of this model may sit in a wheelchair.
    CanUseWheelchair = "can_use_wheelchair",
    /// Whether a walker sits on a bench, for the whole scene.
    SitsOnBench = "sits_on_bench",
    /// Whether a walker cannot be hurt: never.
    IsInvincible = "is_invincible",
    /// How fast a walker goes, m/s.
    Speed = "speed",
    /// How long a traffic light shows green, s.
    GreenTime = "green_time",
    /// How long it shows yellow then, s.
    YellowTime = "yellow_time",
    /// How long all lights of the junction show red then, s; its own red lasts until its next turn.
    RedTime = "red_time",
    /// Number of a traffic light among those of its junction.
    PoleIndex = "pole_index",
    /// What a sign says: one of [`crate::SIGN_TYPES`]. Warning signs before hazards do not have it.
    SignType = "sign_type",
    /// The number on a sign.
    Value = "value",
    /// Height of the ground below a traffic light or a sign, m.
    GroundZ = "ground_z_m",
    /// Number of the hazard that it is part of.
    Hazard = "hazard",
}

/// Further facts about an object, in the order in which they were said: a JSON object of strings in tables.
///
/// Keys of another version are kept, so that its stores can be read and copied; what is no JSON object of
/// strings is refused.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Attributes(Vec<(Attribute, String)>);

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

    /// Says one more.
    pub fn say(&mut self, attribute: Attribute, value: impl fmt::Display) {
        self.0.push((attribute, value.to_string()));
    }

    /// What is said about something.
    #[must_use]
    pub fn get(&self, attribute: &Attribute) -> Option<&str> {
        self.0.iter().find(|(key, _)| key == attribute).map(|(_, value)| value.as_str())
    }

    /// Whether something is said to be true.
    #[must_use]
    pub fn is_true(&self, attribute: &Attribute) -> bool {
        self.get(attribute) == Some("true")
    }
}

impl Serialize for Attributes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(attribute, value)| (attribute.key(), value)))
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
                    facts.0.push((Attribute::from_key(&key), value));
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

impl Text for Attributes {}

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
            assert_eq!((attribute.key(), &Attribute::from_key(key)), (*key, attribute));
        }
    }

    #[test]
    fn unknown_keys_are_kept_and_other_texts_refused() {
        let text = r#"{"reckless":"true","tow_bar":"left","distracted":"false"}"#;
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

    proptest! {
        /// The text is the one that joins quoted words with commas, members in the order in which they were
        /// said.
        #[test]
        fn plain_words_are_written_as_they_are(
            said in prop::collection::vec((0..KNOWN.len(), "[a-z0-9_. -]{0,12}"), 0..8)
        ) {
            let facts = said.iter().fold(Attributes::new(), |facts, (i, value)| facts.with(KNOWN[*i].0.clone(), value));
            let members: Vec<String> =
                said.iter().map(|(i, value)| format!("\"{}\":\"{value}\"", KNOWN[*i].1)).collect();
            let text = format!("{{{}}}", members.join(","));
            prop_assert_eq!(facts.to_string(), text.clone());
            prop_assert_eq!(text.parse::<Attributes>(), Ok(facts));
        }

        #[test]
        fn any_strings_come_back(said in prop::collection::vec((".*", ".*"), 0..4)) {
            let facts = said.iter().fold(Attributes::new(), |facts, (k, v)| facts.with(Attribute::from_key(k), v));
            prop_assert_eq!(facts.to_string().parse::<Attributes>(), Ok(facts));
        }
    }
}
