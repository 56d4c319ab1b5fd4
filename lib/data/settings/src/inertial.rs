//! GNSS and IMU.

use crate::key::{Key, Name, settings};
use crate::mount::Mount;
use crate::reader::Section;

settings! {
    /// A GNSS receiver.
    pub struct GnssSpec {
        /// Where its antenna sits.
        mount: Mount = Mount::upright([0.0; 3], 0.0), flat();
        /// Standard deviation of latitude and longitude, degrees.
        noise_deg: [f64; 2] = [4e-7, 4e-7], by(noise_deg);
        /// Standard deviation of the altitude, m.
        noise_altitude_m: f64 = 0.04, within(0.0..=100.0), yaml_in("gnss_properties", "noise_alt_stddev");
        /// Fixes are taken at frames 0, n, 2 n, ...
        every_n_frames: u32 = 1, within(1..=1000);
    }
}

fn noise_deg(s: &Section<'_>, _: &Name, d: [f64; 2]) -> [f64; 2] {
    let latitude = Key::new("noise_latitude_deg", "Standard deviation of the latitude, degrees.");
    let longitude = Key::new("noise_longitude_deg", "Standard deviation of the longitude, degrees.");
    [
        latitude.within(0.0..=1.0).yaml_in("gnss_properties", "noise_lat_stddev").read(s, &d[0]),
        longitude.within(0.0..=1.0).yaml_in("gnss_properties", "noise_lon_stddev").read(s, &d[1]),
    ]
}

settings! {
    /// An inertial measurement unit.
    pub struct ImuSpec {
        /// Where it sits.
        mount: Mount = Mount::upright([0.0; 3], 0.0), flat();
        /// Standard deviation of each acceleration, m/s2.
        noise_accel_mps2: f64 = 1.7e-4, within(0.0..=10.0), yaml_in("imu_properties", "noise_accel_stddev_x"),
            yaml_in("imu_properties", "noise_accel_stddev_y"), yaml_in("imu_properties", "noise_accel_stddev_z");
        /// Constant bias of each rate, rad/s.
        gyro_bias_radps: f64 = 1.7e-4, within(0.0..=1.0), yaml_in("imu_properties", "noise_gyro_bias_x"),
            yaml_in("imu_properties", "noise_gyro_bias_y"), yaml_in("imu_properties", "noise_gyro_bias_z");
        /// Standard deviation of each rate, rad/s.
        noise_gyro_radps: f64 = 5.6e-6, within(0.0..=1.0), yaml_in("imu_properties", "noise_gyro_stddev_x"),
            yaml_in("imu_properties", "noise_gyro_stddev_y"), yaml_in("imu_properties", "noise_gyro_stddev_z");
        /// It is read at frames 0, n, 2 n, ...
        every_n_frames: u32 = 1, within(1..=1000);
    }
}
