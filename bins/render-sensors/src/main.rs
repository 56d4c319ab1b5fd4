//! Renders cameras, lidar, radar, GNSS and IMU from the log.

fn main() -> std::process::ExitCode {
    // It needs no configuration and no store.
    let words: Vec<String> = std::env::args().skip(1).collect();
    if words == ["--device", "list"] || words == ["--device=list"] {
        runner::say(device::list().trim_end());
        return std::process::ExitCode::SUCCESS;
    }
    arguments::stage::run(render_sensors::STAGE, build_stamp::STAMP)
}
