//! A renderer of any device, and its painter.

use std::sync::Arc;

use gpu::{GpuRenderer, Work};
use render::cpu::CpuRenderer;
use render::{RenderError, Renderer, Scene};
use schema::geometry::{Snapshot, TriMesh};
use shading::{CpuPainter, Painter, StillWorld};

/// A renderer of any device.
#[derive(Debug)]
pub enum DeviceRenderer {
    /// Of the CPU.
    Cpu(CpuRenderer),
    /// Of a GPU.
    Gpu(GpuRenderer),
}

impl DeviceRenderer {
    /// A painter of it, which keeps what lights see of what stands still in a world; without one it keeps
    /// nothing.
    #[must_use]
    pub fn painter<'a>(&'a self, world: Option<&'a dyn StillWorld>) -> Box<dyn Painter + 'a> {
        Box::new(world.map_or_else(CpuPainter::default, |world| CpuPainter::new(self, world)))
    }

    /// What was asked of a GPU, if it is one.
    #[must_use]
    pub fn work(&self) -> Option<Work> {
        match self {
            Self::Cpu(_) => None,
            Self::Gpu(renderer) => Some(renderer.work()),
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
