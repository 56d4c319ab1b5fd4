//! Renders cameras, lidar, radar, GNSS and IMU from the log.

fn main() -> std::process::ExitCode {
    render_sensors::program(std::env::args_os().collect())
}
