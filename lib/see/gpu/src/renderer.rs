//! A renderer whose cameras see by a GPU; rays are followed by the CPU.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

use rayon::prelude::*;
use render::cpu::{CpuRenderer, CpuScene};
use render::{CameraQuery, Hits, PinholeCamera, RayQuery, RenderError, Renderer, Scene, VisibilityBuffer};
use schema::geometry::{Snapshot, TriMesh};

use crate::device::{Gpu, Kernel};
use crate::error::GpuError;
use crate::job::{Asked, Job};
use crate::meshes::ResidentMeshes;
use crate::permits::Permits;

const SHADER: &str = include_str!("visibility.wgsl");
/// Most bytes that a call answers: all cameras of an agent-frame of 9 megapixels.
const ANSWER_BYTES: u64 = 112 << 20;
/// Calls on the device at a time, whatever the number of threads.
const AT_A_TIME: usize = 3;

/// A device with its kernels: opened once, used by any number of renderers.
#[derive(Debug)]
pub struct Eyes {
    gpu: Gpu,
    visibility: Kernel,
    permits: Permits,
}

impl Eyes {
    /// Compiles the kernels for a device.
    ///
    /// # Errors
    /// The driver refuses one.
    pub(crate) fn new(gpu: Gpu) -> Result<Self, GpuError> {
        let visibility = gpu.kernel("visibility", 4, SHADER)?;
        Ok(Self { gpu, visibility, permits: Permits::new(AT_A_TIME) })
    }

    /// The device.
    #[must_use]
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }
}

/// How many pictures were seen by which device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Seen {
    /// By the GPU.
    pub by_gpu: u64,
    /// By the CPU, because the GPU could not, or had failed.
    pub by_cpu: u64,
}

/// Sees with a GPU what cameras ask for, to the bit as [`CpuRenderer`] does, and follows rays with the CPU.
///
/// Where the device fails, or a scene does not fit on it, the CPU answers. That is said once.
#[derive(Debug)]
pub struct GpuRenderer {
    eyes: Arc<Eyes>,
    cpu: CpuRenderer,
    /// `None`: the device does not take them.
    resident: OnceLock<Option<ResidentMeshes>>,
    has_failed: AtomicBool,
    by_gpu: AtomicU64,
    by_cpu: AtomicU64,
}

impl GpuRenderer {
    /// A renderer without meshes.
    #[must_use]
    pub fn new(eyes: Arc<Eyes>) -> Self {
        Self {
            eyes,
            cpu: CpuRenderer::default(),
            resident: OnceLock::new(),
            has_failed: AtomicBool::new(false),
            by_gpu: AtomicU64::new(0),
            by_cpu: AtomicU64::new(0),
        }
    }

    /// How many pictures were seen so far.
    #[must_use]
    pub fn seen(&self) -> Seen {
        let count = |count: &AtomicU64| count.load(Ordering::Relaxed);
        Seen { by_gpu: count(&self.by_gpu), by_cpu: count(&self.by_cpu) }
    }

    /// The meshes on the device, which are uploaded when they are first asked for.
    fn resident(&self) -> Option<&ResidentMeshes> {
        let upload = || match ResidentMeshes::upload(&self.eyes.gpu, self.cpu.meshes()) {
            Ok(Some(resident)) => Some(resident),
            Ok(None) => {
                let name = self.eyes.gpu.name();
                tracing::warn!("the scene's meshes fit into no buffer of {name}: the CPU sees it");
                None
            }
            Err(e) => {
                self.fail(&e);
                None
            }
        };
        self.resident.get_or_init(upload).as_ref()
    }

    /// The device is not asked again.
    fn fail(&self, error: &GpuError) {
        if !self.has_failed.swap(true, Ordering::Relaxed) {
            let name = self.eyes.gpu.name();
            tracing::warn!("{name} does not answer any more, the CPU sees the rest of the scene: {error}");
        }
    }

    /// Draws views; `None` if the device failed.
    fn draw(&self, resident: &ResidentMeshes, asked: &[Asked<'_>]) -> Option<Vec<VisibilityBuffer>> {
        let most_words = ANSWER_BYTES.min(self.eyes.gpu.largest_buffer()) / 4;
        let mut pictures: Vec<VisibilityBuffer> = asked.par_iter().map(Asked::empty).collect();
        for job in Job::split(asked, most_words as usize) {
            let answers = match self.answers(resident, &job) {
                Ok(answers) => answers,
                Err(e) => {
                    self.fail(&e);
                    return None;
                }
            };
            let views = pictures.par_iter_mut().zip(asked).enumerate();
            views.for_each(|(number, (picture, asked))| job.store(&answers, number, asked, picture));
        }
        Some(pictures)
    }

    fn answers(&self, resident: &ResidentMeshes, job: &Job) -> Result<Vec<u32>, GpuError> {
        // Nothing parallel in here: a thread that waits for others may take up work that wants a permit.
        let _permit = self.eyes.permits.take();
        let gpu = &self.eyes.gpu;
        let words = gpu.upload(bytemuck::cast_slice(&job.words))?;
        let inputs = [&resident.nodes, &resident.corners, &resident.order, &words];
        gpu.run(&self.eyes.visibility, &inputs, job.workgroups(), job.answers)
    }
}

impl Renderer for GpuRenderer {
    fn prepare(&mut self, meshes: &[Arc<TriMesh>]) -> Result<(), RenderError> {
        self.resident = OnceLock::new();
        self.cpu.prepare(meshes)
    }

    fn place<'a>(&'a self, snapshot: &'a Snapshot) -> Result<Box<dyn Scene + 'a>, RenderError> {
        Ok(Box::new(GpuScene { renderer: self, cpu: self.cpu.scene(snapshot)? }))
    }
}

/// The instances of one frame.
struct GpuScene<'a> {
    renderer: &'a GpuRenderer,
    cpu: CpuScene<'a>,
}

impl GpuScene<'_> {
    /// What the device sees; `None` for what the CPU has to.
    fn seen(&self, queries: &[CameraQuery<'_>]) -> Option<Vec<VisibilityBuffer>> {
        if self.renderer.has_failed.load(Ordering::Relaxed) {
            return None;
        }
        let resident = self.renderer.resident()?;
        let ask = |query: &CameraQuery<'_>| Asked::new(self.cpu.tiled(query), query.outputs, resident);
        let asked = queries.par_iter().map(ask).collect::<Option<Vec<_>>>()?;
        self.renderer.draw(resident, &asked)
    }
}

impl Scene for GpuScene<'_> {
    fn snapshot(&self) -> &Snapshot {
        self.cpu.snapshot()
    }

    fn render(&self, queries: &[CameraQuery<'_>]) -> Result<Vec<VisibilityBuffer>, RenderError> {
        let (pictures, count) = match self.seen(queries) {
            Some(pictures) => (pictures, &self.renderer.by_gpu),
            None => (self.cpu.render(queries)?, &self.renderer.by_cpu),
        };
        count.fetch_add(queries.len() as u64, Ordering::Relaxed);
        Ok(pictures)
    }

    fn trace(&self, queries: &[RayQuery<'_>]) -> Result<Vec<Hits>, RenderError> {
        self.cpu.trace(queries)
    }

    fn beyond(&self, camera: &PinholeCamera, inner_px: f32, instances: &[u32]) -> Vec<u32> {
        self.cpu.beyond(camera, inner_px, instances)
    }
}
