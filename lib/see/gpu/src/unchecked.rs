//! What wgpu does not check.
#![allow(
    unsafe_code,
    reason = "translated shaders are handed to the driver as they are, or it would fuse operations; and memory is \
              told by Vulkan alone"
)]

use wgpu::hal::api::Vulkan;

/// A shader of words that were translated from WGSL which the translator has validated.
pub(crate) fn shader_module(device: &wgpu::Device, name: &str, words: &[u32]) -> wgpu::ShaderModule {
    // Sizes of workgroups are for Metal alone.
    let entries = [wgpu::PassthroughShaderEntryPoint { name: name.into(), workgroup_size: (1, 1, 1) }];
    let descriptor = wgpu::ShaderModuleDescriptorPassthrough {
        label: Some(name),
        entry_points: (&entries[..]).into(),
        spirv: Some(words.into()),
        ..Default::default()
    };
    // SAFETY: the words are SPIR-V of a module that naga validated; decorations change no meaning.
    unsafe { device.create_shader_module_passthrough(descriptor) }
}

/// Memory of an adapter's own, bytes; the computer's for those that share it. None where Vulkan is not there.
pub(crate) fn memory_bytes(adapter: &wgpu::Adapter) -> Option<u64> {
    // SAFETY: the handles are only read while the adapter lives.
    let adapter = unsafe { adapter.as_hal::<Vulkan>() }?;
    let instance = adapter.shared_instance().raw_instance();
    // SAFETY: as above; the call has no other conditions.
    let memory = unsafe { instance.get_physical_device_memory_properties(adapter.raw_physical_device()) };
    let heaps = memory.memory_heaps.iter().take(memory.memory_heap_count as usize);
    // Bit 0 of a heap's flags: it is the device's own.
    heaps.filter(|heap| heap.flags.as_raw() & 1 != 0).map(|heap| heap.size).max()
}
