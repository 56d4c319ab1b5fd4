//! Renders cameras, lidar, radar, GNSS and IMU from the log.

fn main() -> std::process::ExitCode {
    pipeline::run_stage(render_sensors::STAGE, build_stamp::STAMP)
}
