//! The device in use.

use std::sync::Arc;

use gpu::{Adapter, Eyes, GpuRenderer};
use render::cpu::CpuRenderer;

use crate::choice::{Choice, named};
use crate::error::DeviceError;
use crate::renderer::DeviceRenderer;

/// What looks at scenes.
#[derive(Clone, Debug, Default)]
pub enum Device {
    /// The CPU.
    #[default]
    Cpu,
    /// A GPU, for what cameras and lights see; the CPU does the rest.
    Gpu(Arc<Eyes>),
}

impl Device {
    /// Opens the device that is meant. What it is, or why `auto` means the CPU, is a line of the log. Of a
    /// GPU's memory so many bytes are used at most; if nothing is said, half of what it has.
    ///
    /// # Errors
    /// There is no such adapter, the name fits several, or the one that is named is not usable.
    pub fn open(choice: &Choice, memory_bytes: Option<u64>) -> Result<Self, DeviceError> {
        let open = |adapter: &Adapter| {
            let eyes = gpu::eyes(adapter, memory_bytes)?;
            tracing::info!("{adapter} looks at scenes");
            Ok(eyes)
        };
        match choice {
            Choice::Cpu => Ok(Self::Cpu),
            Choice::Auto => match usable(&gpu::adapters(), open) {
                Ok(eyes) => Ok(Self::Gpu(eyes)),
                Err(why) => {
                    tracing::info!("the CPU looks at scenes: {}", why.join("; "));
                    Ok(Self::Cpu)
                }
            },
            Choice::Gpu => usable(&gpu::adapters(), open)
                .map(Self::Gpu)
                .map_err(|why| DeviceError::NoGpu { why: why.join("; ") }),
            Choice::Named(name) => {
                let adapters = gpu::adapters();
                let adapter = named(name, &adapters)?;
                open(adapter).map(Self::Gpu).map_err(|problem| DeviceError::Unusable {
                    name: name.clone(),
                    adapter: adapter.to_string(),
                    problem: Box::new(problem),
                })
            }
        }
    }

    /// Name, driver and memory, if it is a GPU.
    #[must_use]
    pub fn name(&self) -> Option<String> {
        match self {
            Self::Cpu => None,
            Self::Gpu(eyes) => Some(eyes.adapter().to_string()),
        }
    }

    /// A renderer of it, without meshes yet.
    #[must_use]
    pub fn renderer(&self) -> DeviceRenderer {
        match self {
            Self::Cpu => DeviceRenderer::Cpu(CpuRenderer::default()),
            Self::Gpu(eyes) => DeviceRenderer::Gpu(GpuRenderer::new(Arc::clone(eyes))),
        }
    }
}

/// The first GPU that is usable, or what is wrong with each adapter.
fn usable(
    adapters: &[Adapter],
    open: impl Fn(&Adapter) -> Result<Arc<Eyes>, gpu::GpuError>,
) -> Result<Arc<Eyes>, Vec<String>> {
    let mut why = Vec::new();
    for adapter in adapters {
        if adapter.is_software() {
            why.push(format!("{} is software, used by its name only", adapter.name()));
            continue;
        }
        match open(adapter) {
            Ok(eyes) => return Ok(eyes),
            Err(e) => why.push(format!("{adapter} is not usable: {e}")),
        }
    }
    if why.is_empty() {
        why.push("Vulkan has no adapter".to_owned());
    }
    Err(why)
}
