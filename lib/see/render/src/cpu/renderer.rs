//! The renderer itself.

use std::sync::Arc;

use crate::{RenderError, Renderer, Scene};
use schema::geometry::{Snapshot, TriMesh};

use crate::cpu::meshes::Meshes;
use crate::cpu::scene::CpuScene;

/// Looks at meshes with the processor's cores, all those of the rayon pool it is called in.
#[derive(Debug, Default)]
pub struct CpuRenderer {
    meshes: Meshes,
}

impl Renderer for CpuRenderer {
    fn prepare(&mut self, meshes: &[Arc<TriMesh>]) -> Result<(), RenderError> {
        self.meshes.extend(meshes);
        Ok(())
    }

    fn place<'a>(&'a self, snapshot: &'a Snapshot) -> Result<Box<dyn Scene + 'a>, RenderError> {
        let (in_snapshot, prepared) = (snapshot.meshes.len(), self.meshes.len());
        if in_snapshot > prepared {
            return Err(RenderError::Unprepared { in_snapshot, prepared });
        }
        Ok(Box::new(CpuScene::new(&self.meshes, snapshot)))
    }
}
