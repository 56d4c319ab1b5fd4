//! Weather of one frame.

/// Weather parameters. Percentages are 0 to 100; angles are degrees because people set them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weather {
    /// Cloud cover, percent.
    pub cloudiness: f64,
    /// Rain, percent.
    pub precipitation: f64,
    /// Puddles, percent.
    pub precipitation_deposits: f64,
    /// Wind, percent.
    pub wind_intensity: f64,
    /// Sun's direction, degrees clockwise from north (+y) seen from above.
    pub sun_azimuth_deg: f64,
    /// Sun's height above the horizon, degrees, -90 to 90.
    pub sun_altitude_deg: f64,
    /// How wet surfaces look, percent.
    pub wetness: f64,
    /// Fog, percent.
    pub fog_density: f64,
    /// Where fog starts, metres.
    pub fog_distance_m: f64,
    /// How fog thins with height: 0 not at all, 5 lies on the ground.
    pub fog_falloff: f64,
    /// Light scattered by fog.
    pub scattering_intensity: f64,
    /// Haze (Mie scattering).
    pub mie_scattering_scale: f64,
    /// Air (Rayleigh scattering), 0.0331 on earth.
    pub rayleigh_scattering_scale: f64,
    /// Dust in the air, percent.
    pub dust_storm: f64,
}

impl Default for Weather {
    /// A clear noon.
    fn default() -> Self {
        Self {
            cloudiness: 0.0,
            precipitation: 0.0,
            precipitation_deposits: 0.0,
            wind_intensity: 0.0,
            sun_azimuth_deg: 180.0,
            sun_altitude_deg: 60.0,
            wetness: 0.0,
            fog_density: 0.0,
            fog_distance_m: 100.0,
            fog_falloff: 1.0,
            scattering_intensity: 1.0,
            mie_scattering_scale: 0.03,
            rayleigh_scattering_scale: 0.0331,
            dust_storm: 0.0,
        }
    }
}

impl Weather {
    /// Number of parameters.
    pub const COUNT: usize = 14;

    /// Names of the parameters, in array order.
    pub const NAMES: [&'static str; Self::COUNT] = [
        "cloudiness",
        "precipitation",
        "precipitation_deposits",
        "wind_intensity",
        "sun_azimuth_deg",
        "sun_altitude_deg",
        "wetness",
        "fog_density",
        "fog_distance_m",
        "fog_falloff",
        "scattering_intensity",
        "mie_scattering_scale",
        "rayleigh_scattering_scale",
        "dust_storm",
    ];

    /// The parameters as an array, in [`Weather::NAMES`] order.
    #[must_use]
    pub fn to_array(&self) -> [f64; Self::COUNT] {
        [
            self.cloudiness,
            self.precipitation,
            self.precipitation_deposits,
            self.wind_intensity,
            self.sun_azimuth_deg,
            self.sun_altitude_deg,
            self.wetness,
            self.fog_density,
            self.fog_distance_m,
            self.fog_falloff,
            self.scattering_intensity,
            self.mie_scattering_scale,
            self.rayleigh_scattering_scale,
            self.dust_storm,
        ]
    }

    /// The inverse of [`Weather::to_array`].
    #[must_use]
    pub fn from_array(values: [f64; Self::COUNT]) -> Self {
        let [
            cloudiness,
            precipitation,
            precipitation_deposits,
            wind_intensity,
            sun_azimuth_deg,
            sun_altitude_deg,
            wetness,
            fog_density,
            fog_distance_m,
            fog_falloff,
            scattering_intensity,
            mie_scattering_scale,
            rayleigh_scattering_scale,
            dust_storm,
        ] = values;
        Self {
            cloudiness,
            precipitation,
            precipitation_deposits,
            wind_intensity,
            sun_azimuth_deg,
            sun_altitude_deg,
            wetness,
            fog_density,
            fog_distance_m,
            fog_falloff,
            scattering_intensity,
            mie_scattering_scale,
            rayleigh_scattering_scale,
            dust_storm,
        }
    }

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

#[cfg(test)]
mod tests {
    use super::*;

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
