//! Processes of this machine, as `/proc` tells of them.

use std::fs;

/// Name of this machine, without what separates the parts of names of files.
pub(crate) fn host() -> String {
    let name = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    name.trim().replace(['~', '/'], "-")
}

/// What numbers of processes are unique in: this start of this machine, and the namespace of processes
/// (containers of one machine may share its name). None where `/proc` does not tell.
pub(crate) fn machine() -> Option<String> {
    let boot = fs::read_to_string("/proc/sys/kernel/random/boot_id").ok()?;
    let namespace = fs::read_link("/proc/self/ns/pid").ok()?;
    Some(format!("{} {}", boot.trim(), namespace.display()))
}

/// This machine in names of files: its own name, with a mark of what numbers of processes are unique in. So
/// containers that share a name do not take each other's processes for dead.
pub(crate) fn marked_host() -> String {
    let mark = blake3::hash(machine().unwrap_or_default().as_bytes()).to_hex();
    format!("{}+{}", host(), &mark[..8])
}

/// Whether a process of this machine still does anything. Where `/proc` does not tell, it counts as gone.
pub(crate) fn is_running(pid: u32) -> bool {
    started(pid).is_some()
}

/// When a process that still does anything was started, in ticks of this machine: what tells it from a later
/// one of the same number.
pub(crate) fn started(pid: u32) -> Option<u64> {
    let stat = fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // `pid (name) state ...`; a name may hold brackets. The start is the 22nd field of all.
    let mut fields = stat.rsplit(") ").next()?.split_whitespace();
    if matches!(fields.next()?, "Z" | "X") {
        return None;
    }
    fields.nth(18)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_runs_until_it_ends() {
        let own = std::process::id();
        assert!(is_running(own) && started(own) == started(own));
        let mut child = std::process::Command::new("sleep").arg("60").spawn().expect("starts");
        assert!(started(child.id()) >= started(own));
        child.kill().expect("is killed");
        child.wait().expect("is reaped");
        assert!(!is_running(child.id()));
    }
}
