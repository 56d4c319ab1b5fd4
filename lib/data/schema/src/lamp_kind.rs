//! What a light of the scenery belongs to.

use crate::text::words;

/// What a light of the scenery belongs to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LampKind {
    /// A street lamp.
    #[default]
    Street,
    /// The windows of a building.
    Building,
}

words! {
    LampKind, "lamp kind":
    Street = "street",
    Building = "building",
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_of_the_format() {
        assert_eq!(LampKind::ALL.iter().map(|k| k.name()).collect::<Vec<_>>().join(" "), "street building");
        for kind in LampKind::ALL {
            assert_eq!(kind.to_string().parse(), Ok(*kind));
        }
        let error = "head".parse::<LampKind>().expect_err("cars are no scenery").to_string();
        assert_eq!(error, "`head` is no lamp kind, expected one of street, building");
    }
}
