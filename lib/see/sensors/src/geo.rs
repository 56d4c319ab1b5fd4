//! From metres of the map to degrees of the globe.

use frames::math;

/// Radius of the sphere of the Mercator projection, metres.
const EARTH_RADIUS_M: f64 = 6_378_137.0;

/// Where a map's origin is on the globe.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GeoOrigin {
    /// Latitude, degrees.
    pub latitude_deg: f64,
    /// Longitude, degrees.
    pub longitude_deg: f64,
    /// Altitude, metres.
    pub altitude_m: f64,
}

impl GeoOrigin {
    /// Latitude and longitude in degrees and altitude in metres of a world point.
    ///
    /// Spherical Mercator scaled by the cosine of the origin's latitude, so that a metre of the map is a
    /// metre at the origin: east is the world's x, north its y.
    #[must_use]
    pub fn geodetic_from_world(&self, world_xyz_m: [f64; 3]) -> [f64; 3] {
        let scaled_radius_m = EARTH_RADIUS_M * math::cos(frames::deg(self.latitude_deg));
        let north_rad = mercator_north(frames::deg(self.latitude_deg)) + world_xyz_m[1] / scaled_radius_m;
        let latitude = 2.0 * math::atan(math::exp(north_rad)) - std::f64::consts::FRAC_PI_2;
        [
            frames::to_deg(latitude),
            self.longitude_deg + frames::to_deg(world_xyz_m[0] / scaled_radius_m),
            self.altitude_m + world_xyz_m[2],
        ]
    }

    /// The inverse of [`GeoOrigin::geodetic_from_world`].
    #[must_use]
    pub fn world_from_geodetic(&self, geodetic: [f64; 3]) -> [f64; 3] {
        let scaled_radius_m = EARTH_RADIUS_M * math::cos(frames::deg(self.latitude_deg));
        let north_rad =
            mercator_north(frames::deg(geodetic[0])) - mercator_north(frames::deg(self.latitude_deg));
        [
            frames::deg(geodetic[1] - self.longitude_deg) * scaled_radius_m,
            north_rad * scaled_radius_m,
            geodetic[2] - self.altitude_m,
        ]
    }
}

/// Northing of a latitude on the unit sphere's Mercator map.
fn mercator_north(latitude_rad: f64) -> f64 {
    math::ln(math::tan(0.5 * latitude_rad + std::f64::consts::FRAC_PI_4))
}
