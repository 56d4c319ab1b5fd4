//! Kinds of images that cameras make: the one list of them.
//!
//! A kind's entry below says all that others need: its tables, how it is kept, the flag that switches it on.
//! Configuration, tables, counts and docs follow from it. `sensors` says how the image is made and what its
//! rows are: rows are not here, because the planner knows kinds of images and no tables of sensors.
//! What it costs stands in `forecast`.

use std::collections::BTreeMap;

use serde::ser::{Serialize, SerializeMap, Serializer};
use serde::{Deserialize, Deserializer};

/// How the values of an image are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageEncoding {
    /// A JPEG file in a binary column.
    Jpeg,
    /// A PNG file in a binary column.
    Png,
    /// Plain columns of numbers, row by row.
    Columns,
}

/// What is known of a kind of image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageSpec {
    /// What stands before the camera's name in the names of its tables, and its name in counts.
    pub prefix: &'static str,
    /// What a pixel holds.
    pub doc: &'static str,
    /// How it is kept.
    pub encoding: ImageEncoding,
    /// Key of the camera's configuration that switches it on.
    pub flag: &'static str,
    /// Whether it is on by default.
    pub by_default: bool,
    /// Its name in the plural, for people.
    pub plural: &'static str,
}

/// A type that stands for a kind of image.
pub trait OfKind {
    /// Which kind.
    const KIND: ImageKind;
}

macro_rules! image_kinds {
    ($(
        $(#[doc = $doc:literal])+
        $image_kind:ident {
            prefix: $prefix:literal,
            encoding: $encoding:ident,
            flag: $flag:literal,
            by_default: $by_default:literal,
            plural: $plural:literal,
        }
    )+) => {
        /// A kind of image.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum ImageKind { $( $(#[doc = $doc])+ $image_kind, )+ }

        impl ImageKind {
            /// All kinds.
            pub const ALL: &'static [Self] = &[$( Self::$image_kind ),+];

            /// What is known of it.
            #[must_use]
            pub const fn spec(self) -> ImageSpec {
                match self {
                    $( Self::$image_kind => ImageSpec {
                        prefix: $prefix,
                        doc: concat!($($doc),+),
                        encoding: ImageEncoding::$encoding,
                        flag: $flag,
                        by_default: $by_default,
                        plural: $plural,
                    }, )+
                }
            }
        }

        $(
            $(#[doc = $doc])+
            #[derive(Debug)]
            pub enum $image_kind {}

            impl OfKind for $image_kind {
                const KIND: ImageKind = ImageKind::$image_kind;
            }
        )+
    };
}

image_kinds! {
    /// Colour, 8-bit sRGB.
    Rgb {
        prefix: "RGB",
        encoding: Jpeg,
        flag: "rgb",
        by_default: true,
        plural: "RGB images",
    }
    /// The colour of the tag.
    Semantic {
        prefix: "SEG",
        encoding: Png,
        flag: "semantic",
        by_default: false,
        plural: "semantic images",
    }
    /// Red the tag, green the object id's low byte, blue its high byte.
    Instance {
        prefix: "IST",
        encoding: Png,
        flag: "instance",
        by_default: true,
        plural: "instance images",
    }
    /// 24-bit planar depth (of fisheyes along the ray), red lowest, 1000 m at 2^24 - 1.
    Depth {
        prefix: "DPT",
        encoding: Png,
        flag: "depth",
        by_default: false,
        plural: "depth images",
    }
    /// Optical flow: motion on the screen since the last frame.
    Flow {
        prefix: "FLW",
        encoding: Columns,
        flag: "flow",
        by_default: false,
        plural: "flow images",
    }
}

impl ImageKind {
    /// Name of a camera's table of this kind: `RGB-CAM_FRONT`.
    #[must_use]
    pub fn table(self, camera: &str) -> String {
        format!("{}-{camera}", self.spec().prefix)
    }
}

/// Some kinds of images. Serialises as one flag a kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageSet {
    wanted: [bool; ImageKind::ALL.len()],
}

impl ImageSet {
    /// No image at all.
    pub const NONE: Self = Self { wanted: [false; ImageKind::ALL.len()] };

    /// These kinds.
    #[must_use]
    pub fn of(kinds: &[ImageKind]) -> Self {
        let mut set = Self::NONE;
        kinds.iter().for_each(|kind| set.set(*kind, true));
        set
    }

    /// Whether a kind is among them.
    #[must_use]
    pub const fn has(self, kind: ImageKind) -> bool {
        self.wanted[kind as usize]
    }

    /// Adds or removes a kind.
    pub const fn set(&mut self, kind: ImageKind, wanted: bool) {
        self.wanted[kind as usize] = wanted;
    }

    /// These and one more.
    #[must_use]
    pub const fn with(mut self, kind: ImageKind) -> Self {
        self.set(kind, true);
        self
    }

    /// All but one.
    #[must_use]
    pub const fn without(mut self, kind: ImageKind) -> Self {
        self.set(kind, false);
        self
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self == Self::NONE
    }

    /// The kinds, in the order of [`ImageKind::ALL`].
    pub fn iter(self) -> impl Iterator<Item = ImageKind> {
        ImageKind::ALL.iter().copied().filter(move |kind| self.has(*kind))
    }
}

impl Default for ImageSet {
    fn default() -> Self {
        let wanted = ImageKind::ALL.iter().copied().filter(|kind| kind.spec().by_default);
        Self::of(&wanted.collect::<Vec<_>>())
    }
}

impl Serialize for ImageSet {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(ImageKind::ALL.len()))?;
        for kind in ImageKind::ALL {
            map.serialize_entry(kind.spec().flag, &self.has(*kind))?;
        }
        map.end()
    }
}

/// A kind without a flag is wanted as it is by default.
impl<'de> Deserialize<'de> for ImageSet {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let flags = BTreeMap::<String, bool>::deserialize(deserializer)?;
        let mut images = Self::default();
        for &kind in ImageKind::ALL {
            if let Some(&wanted) = flags.get(kind.spec().flag) {
                images.set(kind, wanted);
            }
        }
        Ok(images)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn no_two_kinds_share_a_table_or_a_flag() {
        let specs: Vec<ImageSpec> = ImageKind::ALL.iter().map(|kind| kind.spec()).collect();
        let prefixes: BTreeSet<_> = specs.iter().map(|s| s.prefix).collect();
        let flags: BTreeSet<_> = specs.iter().map(|s| s.flag).collect();
        assert_eq!([prefixes.len(), flags.len()], [specs.len(); 2]);
        assert_eq!(ImageKind::Rgb.table("CAM_FRONT"), "RGB-CAM_FRONT");
    }

    #[test]
    fn sets_remember_and_serialise_their_kinds() {
        let set = ImageSet::default();
        assert_eq!(set.iter().collect::<Vec<_>>(), [ImageKind::Rgb, ImageKind::Instance]);
        let set = set.with(ImageKind::Flow).without(ImageKind::Rgb);
        assert!(set.has(ImageKind::Flow) && !set.has(ImageKind::Rgb) && !set.is_empty());
        assert_eq!(ImageSet::of(&[ImageKind::Flow, ImageKind::Instance]), set);
        let text = serde_json::to_string(&set).expect("serialises");
        assert_eq!(text, r#"{"rgb":false,"semantic":false,"instance":true,"depth":false,"flow":true}"#);
    }
}
