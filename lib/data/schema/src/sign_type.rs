//! What traffic signs say.

/// Words for what a sign says, as the attribute `sign_type` has them; a sign that says something else, or
/// nothing that is known, has the empty one. Numbers of speed limits are those on the board, whatever the
/// unit of the country.
pub const SIGN_TYPES: [&str; 58] = [
    "",
    "stop",
    "yield",
    "speed_limit",
    "speed_limit_20",
    "speed_limit_25",
    "speed_limit_30",
    "speed_limit_40",
    "speed_limit_50",
    "speed_limit_55",
    "speed_limit_60",
    "speed_limit_70",
    "speed_limit_75",
    "speed_limit_80",
    "speed_limit_90",
    "speed_limit_100",
    "speed_limit_110",
    "speed_limit_120",
    "speed_limit_20_min_15",
    "speed_limit_25_min_15",
    "speed_limit_30_min_15",
    "speed_limit_50_min_40",
    "speed_limit_55_min_40",
    "speed_limit_75_min_45",
    "highway",
    "billboard",
    "parking",
    "do_not_enter",
    "interchange",
    "no_left_turn",
    "bus_stop_no_parking",
    "clean_up_after_pet",
    "parking_time_limit",
    "no_bicycles",
    "no_parking",
    "no_parking_towing_enforced",
    "no_pedestrians",
    "no_standing",
    "cross_only_at_crosswalk",
    "pedestrian_crossing",
    "frequent_pedestrian_cyclist",
    "photo_enforced",
    "reserved_parking",
    "school_zone",
    "stop_for_pedestrians",
    "tow_away_zone",
    "yield_to_pedestrians",
    "passenger_cars_only",
    "accident_ahead",
    "animal_crossing",
    "lane_reduction",
    "michigan_left",
    "no_turns",
    "one_way",
    "roundabout",
    "bump_ahead",
    "uneven_road",
    "street_name",
];

/// The word for a speed limit of a number; the plain one where there is none with that number.
///
/// ```
/// use schema::speed_limit_type;
///
/// assert_eq!(speed_limit_type(30.0), "speed_limit_30");
/// assert_eq!(speed_limit_type(35.0), "speed_limit");
/// ```
#[must_use]
pub fn speed_limit_type(value: f64) -> &'static str {
    let numbered = |word: &&&str| {
        let number = word.strip_prefix("speed_limit_").and_then(|number| number.parse::<f64>().ok());
        number.is_some_and(|number| (number - value).abs() < 1e-6)
    };
    SIGN_TYPES.iter().find(numbered).copied().unwrap_or("speed_limit")
}

/// What the board of a sign shows besides its kind, as the variant of the object keeps it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SignFace {
    /// Bottom of the board over the ground, centimetres: at most 4095.
    pub bottom_cm: u16,
    /// Place of what it says in [`SIGN_TYPES`].
    pub sign_type: u8,
    /// The number on it; of boards with made-up names, which names. At most 16383; 0: none.
    pub number: u16,
}

impl SignFace {
    const BOTTOM_BITS: u32 = 12;
    const TYPE_BITS: u32 = 6;
    const NUMBER_BITS: u32 = 14;

    /// Of an object's variant.
    ///
    /// ```
    /// use schema::SignFace;
    ///
    /// let face = SignFace { bottom_cm: 220, sign_type: 3, number: 130 };
    /// assert_eq!(SignFace::from_variant(face.variant()), face);
    /// // A variant that is the bottom alone says nothing else.
    /// assert_eq!(SignFace::from_variant(220), SignFace { bottom_cm: 220, sign_type: 0, number: 0 });
    /// ```
    #[must_use]
    pub fn from_variant(variant: u32) -> Self {
        let bits = |from: u32, count: u32| variant >> from & ((1 << count) - 1);
        Self {
            bottom_cm: bits(0, Self::BOTTOM_BITS) as u16,
            sign_type: bits(Self::BOTTOM_BITS, Self::TYPE_BITS) as u8,
            number: bits(Self::BOTTOM_BITS + Self::TYPE_BITS, Self::NUMBER_BITS) as u16,
        }
    }

    /// The variant of an object.
    #[must_use]
    pub fn variant(self) -> u32 {
        let most = |value: u32, bits: u32| value.min((1 << bits) - 1);
        most(u32::from(self.bottom_cm), Self::BOTTOM_BITS)
            | most(u32::from(self.sign_type), Self::TYPE_BITS) << Self::BOTTOM_BITS
            | most(u32::from(self.number), Self::NUMBER_BITS) << (Self::BOTTOM_BITS + Self::TYPE_BITS)
    }

    /// The word for what it says.
    #[must_use]
    pub fn word(self) -> &'static str {
        SIGN_TYPES.get(usize::from(self.sign_type)).copied().unwrap_or_default()
    }
}

// All words have a place.
const _: () = assert!(SIGN_TYPES.len() <= 1 << SignFace::TYPE_BITS);
