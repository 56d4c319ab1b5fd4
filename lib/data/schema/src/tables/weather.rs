//! Weather of one frame.

use crate::table::{Cell, CellError, Column};

/// Names the weather's parameters, here and nowhere else: hands each one's meaning, name and value on a clear
/// noon to another macro. Percentages are 0 to 100; angles are degrees because people set them.
macro_rules! weather_parameters {
    ($then:ident) => {
        $then! {
            /// Cloud cover, percent.
            cloudiness = 0.0,
            /// Rain, percent.
            precipitation = 0.0,
            /// Puddles, percent.
            precipitation_deposits = 0.0,
            /// Wind, percent.
            wind_intensity = 0.0,
            /// Sun's direction, degrees clockwise from north (+y) seen from above.
            sun_azimuth_deg = 180.0,
            /// Sun's height above the horizon, degrees, -90 to 90.
            sun_altitude_deg = 60.0,
            /// How wet surfaces look, percent.
            wetness = 0.0,
            /// Fog, percent.
            fog_density = 0.0,
            /// Where fog starts, m.
            fog_distance_m = 100.0,
            /// How fog thins with height: 0 not at all, 5 lies on the ground.
            fog_falloff = 1.0,
            /// Light scattered by fog.
            scattering_intensity = 1.0,
            /// Haze (Mie scattering).
            mie_scattering_scale = 0.03,
            /// Air (Rayleigh scattering), 0.0331 on earth.
            rayleigh_scattering_scale = 0.0331,
            /// Dust in the air, percent.
            dust_storm = 0.0,
        }
    };
}
pub(super) use weather_parameters;

macro_rules! define_weather {
    ($( #[doc = $doc:literal] $name:ident = $clear:literal, )+) => {
        /// Weather parameters. Percentages are 0 to 100; angles are degrees because people set them.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Weather {
            $( #[doc = $doc] pub $name: f64, )+
        }

        impl Default for Weather {
            /// A clear noon.
            fn default() -> Self {
                Self { $( $name: $clear, )+ }
            }
        }

        impl Weather {
            /// Names of the parameters, in array order.
            pub const NAMES: [&'static str; Self::COUNT] = [$( stringify!($name) ),+];
            /// Number of parameters.
            pub const COUNT: usize = [$( $clear ),+].len();

            /// The parameters as an array, in [`Weather::NAMES`] order.
            #[must_use]
            pub fn to_array(&self) -> [f64; Self::COUNT] {
                [$( self.$name ),+]
            }

            /// The inverse of [`Weather::to_array`].
            #[must_use]
            pub fn from_array([$( $name ),+]: [f64; Self::COUNT]) -> Self {
                Self { $( $name ),+ }
            }
        }
    };
}
weather_parameters!(define_weather);

impl Weather {
    /// The parameters that the published dataset has: its name, and ours.
    pub const PUBLISHED_NAMES: [(&'static str, &'static str); 10] = [
        ("cloudiness", "cloudiness"),
        ("precipitation", "precipitation"),
        ("precipitation_deposits", "precipitation_deposits"),
        ("wind_intensity", "wind_intensity"),
        ("sun_azimuth_angle", "sun_azimuth_deg"),
        ("sun_altitude_angle", "sun_altitude_deg"),
        ("wetness", "wetness"),
        ("fog_density", "fog_density"),
        ("fog_distance", "fog_distance_m"),
        ("fog_falloff", "fog_falloff"),
    ];

    /// The parameters that are percents, 0 to 100.
    pub const PERCENTS: [&'static str; 7] = [
        "cloudiness",
        "precipitation",
        "precipitation_deposits",
        "wind_intensity",
        "wetness",
        "fog_density",
        "dust_storm",
    ];

    /// Replaces parameters by name; unknown names are left to the configuration reader, which refuses them.
    #[must_use]
    pub fn with_overrides(self, overrides: &[(String, f64)]) -> Self {
        let mut values = self.to_array();
        for (name, value) in overrides {
            if let Some(i) = Self::NAMES.iter().position(|n| n == name) {
                values[i] = *value;
            }
        }
        Self::from_array(values)
    }

    /// Linear mix: `share` 0 is `self`, 1 is `other`. The azimuth does not wrap.
    #[must_use]
    pub fn mix(&self, other: &Self, share: f64) -> Self {
        let (a, b) = (self.to_array(), other.to_array());
        Self::from_array(std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share))
    }

    /// Unit vector from the ground towards the sun, in the world (x east, y north, z up).
    #[must_use]
    pub fn direction_to_sun(&self) -> [f64; 3] {
        let (sin_az, cos_az) = frames::math::sin_cos(frames::deg(self.sun_azimuth_deg));
        let (sin_alt, cos_alt) = frames::math::sin_cos(frames::deg(self.sun_altitude_deg));
        [sin_az * cos_alt, cos_az * cos_alt, sin_alt]
    }

    /// Whether street lamps should burn.
    #[must_use]
    pub fn is_night(&self) -> bool {
        self.sun_altitude_deg < 0.0
    }
}

/// A struct with a field for each parameter.
impl Cell for Weather {
    fn column<'a>(values: impl Iterator<Item = &'a Self>) -> Column {
        let mut columns = Self::NAMES.map(|_| Vec::new());
        for weather in values {
            for (column, value) in columns.iter_mut().zip(weather.to_array()) {
                column.push(value);
            }
        }
        Column::Struct(Self::NAMES.into_iter().zip(columns.map(Column::F64)).collect())
    }

    fn values(column: Column) -> Result<Vec<Self>, CellError> {
        match column {
            Column::Struct(fields) => {
                let columns: Vec<Vec<f64>> =
                    fields.into_iter().map(|(_, values)| f64::values(values)).collect::<Result<_, _>>()?;
                let columns: [Vec<f64>; Self::COUNT] = columns.try_into().map_err(|_| CellError::Type)?;
                let rows = 0..columns[0].len();
                Ok(rows.map(|row| Self::from_array(columns.each_ref().map(|column| column[row]))).collect())
            }
            // Format 1: numbers in this order.
            Column::FixedF64(Self::COUNT, flat) => {
                Ok(flat.as_chunks().0.iter().copied().map(Self::from_array).collect())
            }
            _ => Err(CellError::Type),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_struct_and_the_numbers_of_format_1_are_the_same_weather() {
        let all = [Weather::default(), Weather { cloudiness: 3.0, dust_storm: 4.0, ..Weather::default() }];
        let column = Weather::column(all.iter());
        let Column::Struct(fields) = &column else { panic!("{column:?}") };
        assert_eq!(fields[0], ("cloudiness", Column::F64(vec![0.0, 3.0])));
        assert_eq!(fields[13], ("dust_storm", Column::F64(vec![0.0, 4.0])));
        assert_eq!(Weather::values(column), Ok(all.to_vec()));
        let flat = all.iter().flat_map(Weather::to_array).collect();
        assert_eq!(Weather::values(Column::FixedF64(14, flat)), Ok(all.to_vec()));
        assert_eq!(Weather::values(Column::FixedF64(13, vec![0.0; 13])), Err(CellError::Type));
    }

    #[test]
    fn arrays_names_and_overrides_agree() {
        let weather = Weather::default().with_overrides(&[("fog_falloff".into(), 4.5)]);
        assert_eq!(weather.fog_falloff, 4.5);
        assert_eq!(Weather::from_array(weather.to_array()), weather);
        for (i, name) in Weather::NAMES.iter().enumerate() {
            let mut want = Weather::default().to_array();
            want[i] = 77.0;
            let got = Weather::default().with_overrides(&[((*name).to_owned(), 77.0)]);
            assert_eq!(got.to_array(), want);
            // The compiler knows the fields' names, too.
            let fields = format!("{got:?}");
            assert!(fields.contains(&format!(" {name}: 77.0")), "{name}: {fields}");
        }
    }

    #[test]
    fn the_sun_stands_where_the_angles_say() {
        let mut w = Weather { sun_azimuth_deg: 90.0, sun_altitude_deg: 0.0, ..Weather::default() };
        let [x, y, z] = w.direction_to_sun();
        assert!((x - 1.0).abs() < 1e-12 && y.abs() < 1e-12 && z.abs() < 1e-12);
        w.sun_altitude_deg = 90.0;
        assert!((w.direction_to_sun()[2] - 1.0).abs() < 1e-12);
    }

    #[test]
    fn mixing_hits_both_ends() {
        let a = Weather::default();
        let b = Weather { cloudiness: 80.0, ..a };
        assert_eq!(a.mix(&b, 0.0), a);
        assert_eq!(a.mix(&b, 1.0), b);
        assert_eq!(a.mix(&b, 0.25).cloudiness, 20.0);
    }
}
