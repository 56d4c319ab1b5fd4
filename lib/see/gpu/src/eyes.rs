//! A device with its kernels, and what becomes of it when it fails.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::adapter::Adapter;
use crate::device::{Gpu, Kernel};
use crate::error::GpuError;
use crate::memory::Memory;
use crate::self_test::open;

const VISIBILITY: &str = concat!(include_str!("outline.wgsl"), "\n", include_str!("visibility.wgsl"));
const RAYS: &str = concat!(include_str!("outline.wgsl"), "\n", include_str!("rays.wgsl"));
/// What kernels read: nodes, corners, triangles' numbers, and the job.
const INPUTS: u32 = 4;
/// The memory of a device that does not tell how much it has.
const UNTOLD_BYTES: u64 = 4 << 30;

/// A device that sees: opened once, used by any number of renderers. [`crate::eyes`] gives it.
#[derive(Debug)]
pub struct Eyes {
    adapter: Adapter,
    memory: Arc<Memory>,
    /// `None`: it failed too often.
    opened: Mutex<Option<Arc<Opened>>>,
}

/// A device that was opened, and its kernels.
#[derive(Debug)]
pub(crate) struct Opened {
    pub(crate) gpu: Gpu,
    pub(crate) visibility: Kernel,
    pub(crate) rays: Kernel,
}

impl Opened {
    fn new(adapter: &Adapter) -> Result<Self, GpuError> {
        let gpu = open(adapter)?;
        let visibility = gpu.kernel("visibility", INPUTS, VISIBILITY)?;
        let rays = gpu.kernel("rays", INPUTS, RAYS)?;
        Ok(Self { gpu, visibility, rays })
    }
}

impl Eyes {
    /// Opens an adapter's device, tries its arithmetic and compiles the kernels.
    ///
    /// # Errors
    /// It lacks a feature, the driver gives no device or refuses a kernel, or an answer is wrong.
    pub(crate) fn new(adapter: &Adapter) -> Result<Self, GpuError> {
        let opened = Mutex::new(Some(Arc::new(Opened::new(adapter)?)));
        Ok(Self { adapter: adapter.clone(), memory: Memory::new(u64::MAX), opened })
    }

    /// From now on it uses so many bytes at most; if nothing is said, half of what the adapter has: another
    /// process may use the rest.
    pub(crate) fn limit_memory(&self, bytes: Option<u64>) {
        let half = || self.adapter.memory_bytes().unwrap_or(UNTOLD_BYTES) / 2;
        self.memory.limit(bytes.unwrap_or_else(half));
    }

    /// What it is: name and driver.
    #[must_use]
    pub fn adapter(&self) -> &Adapter {
        &self.adapter
    }

    /// Gives the device back: all calls fail from then on, as if it was lost. For tests.
    pub fn lose(&self) {
        if let Some(opened) = self.opened() {
            opened.gpu.destroy();
        }
    }

    pub(crate) fn memory(&self) -> &Arc<Memory> {
        &self.memory
    }

    /// The device; `None` once it was given up.
    pub(crate) fn opened(&self) -> Option<Arc<Opened>> {
        self.lock().clone()
    }

    /// Opens the device again that was lost, unless somebody has done so already.
    ///
    /// # Errors
    /// It cannot be opened. It is given up.
    pub(crate) fn reopen(&self, lost: &Arc<Opened>) -> Result<(), GpuError> {
        let mut opened = self.lock();
        if opened.as_ref().is_some_and(|now| Arc::ptr_eq(now, lost)) {
            *opened = None;
            *opened = Some(Arc::new(Opened::new(&self.adapter)?));
        }
        Ok(())
    }

    /// Nobody gets the device any more.
    pub(crate) fn give_up(&self) {
        *self.lock() = None;
    }

    fn lock(&self) -> MutexGuard<'_, Option<Arc<Opened>>> {
        self.opened.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
