//! The renderer itself.

use std::sync::Arc;

use crate::{RenderError, Renderer, Scene};
use schema::geometry::{Snapshot, TriMesh};

use crate::cpu::scene::CpuScene;
use crate::prepared::Meshes;

/// Looks at meshes with the processor's cores, all those of the rayon pool it is called in.
#[derive(Debug, Default)]
pub struct CpuRenderer {
    meshes: Meshes,
}

impl CpuRenderer {
    /// The meshes that were prepared.
    #[must_use]
    pub fn meshes(&self) -> &Meshes {
        &self.meshes
    }

    /// Puts the instances of one frame over the prepared meshes, as [`Renderer::place`] does.
    ///
    /// # Errors
    /// The snapshot lists more meshes than were prepared.
    pub fn scene<'a>(&'a self, snapshot: &'a Snapshot) -> Result<CpuScene<'a>, RenderError> {
        let (in_snapshot, prepared) = (snapshot.meshes.len(), self.meshes.len());
        if in_snapshot > prepared {
            return Err(RenderError::Unprepared { in_snapshot, prepared });
        }
        Ok(CpuScene::new(&self.meshes, snapshot))
    }
}

impl Renderer for CpuRenderer {
    fn prepare(&mut self, meshes: &[Arc<TriMesh>]) -> Result<(), RenderError> {
        self.meshes.extend(meshes);
        Ok(())
    }

    fn place<'a>(&'a self, snapshot: &'a Snapshot) -> Result<Box<dyn Scene + 'a>, RenderError> {
        Ok(Box::new(self.scene(snapshot)?))
    }
}
