//! Programs as benchmarks run them: seconds, processor seconds, memory at its peak.

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Clock ticks a second in `/proc` (fixed on Linux).
const TICKS: f64 = 100.0;

/// What a program took.
pub struct Taken {
    /// Seconds.
    pub wall_s: f64,
    /// Processor seconds, with those of programs that it started.
    pub core_s: f64,
    /// Most memory of it alone, megabytes.
    pub peak_mb: f64,
}

/// Processor seconds of all programs that ended.
fn children_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // Behind the name in brackets, which may hold anything: user and system time of children are the 14th and
    // 15th.
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |i: usize| fields.get(i).and_then(|f| f.parse::<f64>().ok()).unwrap_or(0.0);
    (ticks(13) + ticks(14)) / TICKS
}

/// Most memory that a running program had so far, megabytes.
fn peak_mb(child: &Child) -> Option<f64> {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse::<f64>().ok().map(|kib| kib * 1024.0 / 1e6)
}

/// Runs a program of the workspace to its end.
///
/// # Panics
/// It fails.
#[must_use]
pub fn run(name: &str, arguments: &[&str]) -> Taken {
    let program = crate::program(name);
    let (before_s, start) = (children_s(), Instant::now());
    let mut child = Command::new(&program)
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let mut most_mb: f64 = 0.0;
    let status = loop {
        most_mb = most_mb.max(peak_mb(&child).unwrap_or(0.0));
        if let Some(status) = child.try_wait().expect("the program is ours") {
            break status;
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    assert!(status.success(), "{} {} failed", program.display(), arguments.join(" "));
    Taken { wall_s: start.elapsed().as_secs_f64(), core_s: children_s() - before_s, peak_mb: most_mb }
}
