//! A renderer of any device.

use std::sync::Arc;

use gpu::{GpuRenderer, Seen};
use render::cpu::CpuRenderer;
use render::{RenderError, Renderer, Scene};
use schema::geometry::{Snapshot, TriMesh};

/// A renderer of any device.
#[derive(Debug)]
pub enum DeviceRenderer {
    /// Of the CPU.
    Cpu(CpuRenderer),
    /// Of a GPU.
    Gpu(GpuRenderer),
}

impl DeviceRenderer {
    /// How many pictures which device has seen, if it is a GPU.
    #[must_use]
    pub fn seen(&self) -> Option<Seen> {
        match self {
            Self::Cpu(_) => None,
            Self::Gpu(renderer) => Some(renderer.seen()),
        }
    }
}

impl Renderer for DeviceRenderer {
    fn prepare(&mut self, meshes: &[Arc<TriMesh>]) -> Result<(), RenderError> {
        match self {
            Self::Cpu(renderer) => renderer.prepare(meshes),
            Self::Gpu(renderer) => renderer.prepare(meshes),
        }
    }

    fn place<'a>(&'a self, snapshot: &'a Snapshot) -> Result<Box<dyn Scene + 'a>, RenderError> {
        match self {
            Self::Cpu(renderer) => renderer.place(snapshot),
            Self::Gpu(renderer) => renderer.place(snapshot),
        }
    }
}
