//! What a machine has, and what that enables.

mod python;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use indicatif::DecimalBytes;
use runner::forecast::Machine;
use runner::{EXIT_DONE, EXIT_SOME_FAILED, Graph, say};

/// What a stage may take of memory for each of its threads, bytes.
const THREAD_BYTES: u64 = 2 << 30;
/// What is taken of a disk by an hour or so of work with the published sensors, bytes.
const LITTLE_BYTES: u64 = 20_000_000_000;
/// Programs beside the stages.
const OTHERS: [&str; 4] = ["export", "import", "evaluate", "viz"];

/// What `convoy doctor` takes.
#[derive(Debug, clap::Args)]
pub(crate) struct DoctorArgs {
    /// Where datasets are to lie: the disk that is looked at.
    #[arg(long, value_name = "DIR", default_value = ".")]
    store: PathBuf,
}

/// Tells it, line by line; 1 where datasets cannot be made.
pub(crate) fn run(args: &DoctorArgs) -> u8 {
    row("version", runner::release(build_stamp::STAMP), "");
    let Machine { cores, times } = Machine::measured();
    row("processor", &processor(), &format!("{cores} threads work at once; --threads says otherwise"));
    row(
        "speed",
        &format!("a core takes {times:.1} times what forecasts count with"),
        "what else runs here counts",
    );
    memory(cores);
    disk(&args.store);
    let missing = missing_programs();
    match &missing[..] {
        [] => row("programs", "all are there", "datasets can be made"),
        missing => row(
            "programs",
            &format!("missing: {}", missing.join(", ")),
            "datasets cannot be made: install all",
        ),
    }
    devices();
    for (name, found, enables) in python::rows() {
        row(&name, &found, enables);
    }
    row("ffmpeg", &first_line("ffmpeg", &["-version"]), "films as MP4 beside animated PNG");
    if missing.is_empty() { EXIT_DONE } else { EXIT_SOME_FAILED }
}

/// A line: what was looked at, what there is, what it is for.
fn row(name: &str, found: &str, enables: &str) {
    let enables = if enables.is_empty() { String::new() } else { format!("  ({enables})") };
    say(&format!("{name:<12} {found}{enables}"));
}

/// The first line that a program prints, or that it is not there.
fn first_line(program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program).args(arguments).stderr(Stdio::null()).output();
    match output.ok().filter(|output| output.status.success()) {
        Some(output) => {
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            text.lines().next().unwrap_or("is there").to_owned()
        }
        None => "not found".to_owned(),
    }
}

/// A value of one of Linux's files of lines `key: value`.
fn value_in(text: &str, key: &str) -> Option<String> {
    let of_line = |line: &str| {
        let (name, value) = line.split_once(':')?;
        (name.trim() == key).then(|| value.trim().to_owned())
    };
    text.lines().find_map(of_line)
}

fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    value_in(&text, "model name").unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

/// Bytes of a line of `/proc/meminfo`, which counts in kB of 1024 bytes.
fn bytes_in(text: &str, key: &str) -> Option<u64> {
    value_in(text, key)?.strip_suffix(" kB")?.parse::<u64>().ok()?.checked_mul(1024)
}

fn memory(threads: usize) {
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let (Some(all), Some(free)) = (bytes_in(&text, "MemTotal"), bytes_in(&text, "MemAvailable")) else {
        return row("memory", "unknown", "");
    };
    let enough = (free / THREAD_BYTES).max(1);
    let enables = if enough >= threads as u64 {
        "enough for all threads: a stage takes up to 2 GiB for each".to_owned()
    } else {
        format!("a stage takes up to 2 GiB for each thread: --threads {enough} is safe")
    };
    row("memory", &format!("{} free of {}", DecimalBytes(free), DecimalBytes(all)), &enables);
}

fn disk(place: &Path) {
    // A folder that is not there yet lies on the disk of one above it.
    let whole = std::path::absolute(place).unwrap_or_else(|_| place.to_owned());
    let there = whole.ancestors().find(|folder| folder.exists());
    let found = there.and_then(|folder| rustix::fs::statvfs(folder).ok());
    let Some(found) = found else { return row("disk", "unknown", "") };
    let free = found.f_bavail.saturating_mul(found.f_frsize);
    let enables = if free < LITTLE_BYTES {
        "little: ask convoy forecast first"
    } else {
        "convoy forecast says what a dataset takes"
    };
    row("disk", &format!("{} free for {}", DecimalBytes(free), place.display()), enables);
}

/// Programs that are not beside this one.
fn missing_programs() -> Vec<&'static str> {
    let stages = Graph::get().stages.iter().map(|stage| stage.name);
    let is_missing = |name: &&str| {
        let program = runner::program_beside(name);
        program.is_ok_and(|program| !Path::new(program.get_program()).is_file())
    };
    stages.chain(OTHERS).filter(is_missing).collect()
}

/// What `render-sensors --device list` says, a row for each device.
fn devices() {
    let listed = runner::program_beside("render-sensors")
        .and_then(|mut program| program.args(["--device", "list"]).stderr(Stdio::null()).output());
    let text = listed.map(|output| String::from_utf8_lossy(&output.stdout).into_owned()).unwrap_or_default();
    for line in text.lines().filter(|line| !line.trim().is_empty()) {
        row("gpu", line.trim(), "");
    }
    if text.trim().is_empty() {
        row("gpu", "none by Vulkan", "none is needed: the processor gives the same bytes");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_linux_are_read() {
        let text = "MemTotal:       24576 kB\nMemAvailable:    4096 kB\nmodel name\t: A: B\n";
        assert_eq!(bytes_in(text, "MemTotal"), Some(24576 * 1024));
        assert_eq!(bytes_in(text, "SwapTotal"), None);
        assert_eq!(value_in(text, "model name").as_deref(), Some("A: B"));
    }
}
