//! What a GPU did of an agent-frame, by its own clock.

use device::{DeviceRenderer, Work};

/// A part, and what the device was asked for in it.
pub(crate) struct OnDevice {
    name: &'static str,
    work: Work,
}

/// Does a part once more, and notes what the device did meanwhile.
pub(crate) fn note<T>(
    rows: &mut Vec<OnDevice>,
    name: &'static str,
    renderer: &DeviceRenderer,
    part: impl FnOnce() -> T,
) {
    let Some(before) = renderer.work() else { return };
    std::hint::black_box(part());
    let after = renderer.work().unwrap_or_default();
    let work = Work {
        calls: after.calls - before.calls,
        kernel_ns: after.kernel_ns - before.kernel_ns,
        told_bytes: after.told_bytes - before.told_bytes,
        answered_bytes: after.answered_bytes - before.answered_bytes,
        ..after
    };
    rows.push(OnDevice { name, work });
}

#[expect(clippy::print_stdout, reason = "this is the benchmark's answer")]
pub(crate) fn print(name: &str, rows: &[OnDevice], renderer: &DeviceRenderer) {
    let Some(Work { views, rays, .. }) = renderer.work() else { return };
    let [by_gpu, by_cpu] = [[views.by_gpu, rays.by_gpu], [views.by_cpu, rays.by_cpu]];
    println!("\nOn {name}, by its own clock (views and rays by it: {by_gpu:?}, by the CPU: {by_cpu:?})");
    println!("| part | calls | kernels, ms | MiB there | MiB back |\n|---|---|---|---|---|");
    for OnDevice { name, work } in rows {
        let mib = |bytes: u64| bytes as f64 / f64::from(1u32 << 20);
        let Work { calls, kernel_ns, told_bytes, answered_bytes, .. } = *work;
        let (kernel_ms, there, back) = (kernel_ns as f64 * 1e-6, mib(told_bytes), mib(answered_bytes));
        println!("| {name} | {calls} | {kernel_ms:.2} | {there:.1} | {back:.1} |");
    }
}
