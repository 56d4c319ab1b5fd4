//! Renders cameras, lidar, radar, GNSS and IMU from the log.

fn main() -> std::process::ExitCode {
    arguments::stage::run(render_sensors::STAGE, build_stamp::STAMP)
}
