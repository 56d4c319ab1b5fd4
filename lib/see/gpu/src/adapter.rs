//! Adapters: the GPUs, and what stands in for one, that Vulkan knows of.

use std::fmt;

use indicatif::BinaryBytes;
use wgpu::{Backends, Features};

use crate::error::GpuError;
use crate::unchecked;

/// What shaders need, by name.
const NEEDED: [(Features, &str); 5] = [
    (Features::SHADER_F64, "64-bit floats in shaders (shaderFloat64)"),
    (Features::SHADER_INT64, "64-bit integers in shaders (shaderInt64)"),
    (Features::SHADER_INT64_ATOMIC_MIN_MAX, "64-bit atomics (shaderBufferInt64Atomics)"),
    (Features::PASSTHROUGH_SHADERS, "shaders as SPIR-V"),
    (Features::IMMEDIATES, "push constants"),
];
/// What is used where it is there.
const WELCOME: Features = Features::TIMESTAMP_QUERY.union(Features::PIPELINE_CACHE);

/// A GPU that Vulkan knows of, or a stand-in for one.
#[derive(Clone, Debug)]
pub struct Adapter {
    pub(crate) inner: wgpu::Adapter,
    info: wgpu::AdapterInfo,
    memory_bytes: Option<u64>,
}

/// All adapters, in the order in which Vulkan names them; none where there is no Vulkan.
#[must_use]
pub fn adapters() -> Vec<Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: Backends::VULKAN,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let found = pollster::block_on(instance.enumerate_adapters(Backends::VULKAN));
    let adapter = |inner: wgpu::Adapter| {
        let (info, memory_bytes) = (inner.get_info(), unchecked::memory_bytes(&inner));
        Adapter { inner, info, memory_bytes }
    };
    found.into_iter().map(adapter).collect()
}

impl Adapter {
    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.info.name
    }

    /// Name and version of its driver.
    #[must_use]
    pub fn driver(&self) -> String {
        format!("{} {}", self.info.driver, self.info.driver_info).trim().to_owned()
    }

    /// Memory of its own, bytes, as far as Vulkan tells.
    #[must_use]
    pub fn memory_bytes(&self) -> Option<u64> {
        self.memory_bytes
    }

    /// Whether it is a program on the CPU.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// The features that a device of it is opened with.
    ///
    /// # Errors
    /// It lacks one that shaders need.
    pub(crate) fn features(&self) -> Result<Features, GpuError> {
        let there = self.inner.features();
        let needed = NEEDED.iter().try_fold(Features::empty(), |all, (feature, name)| {
            there.contains(*feature).then_some(all | *feature).ok_or(GpuError::Feature { feature: name })
        })?;
        Ok(needed | there & WELCOME)
    }
}

impl fmt::Display for Adapter {
    /// Name, driver and memory.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (driver {}", self.name(), self.driver())?;
        if let Some(bytes) = self.memory_bytes {
            write!(f, ", {}", BinaryBytes(bytes))?;
        }
        f.write_str(")")
    }
}
