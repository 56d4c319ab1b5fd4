//! A renderer that asks a GPU.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;
use render::cpu::{CpuRenderer, CpuScene};
use render::{CameraQuery, Hits, PinholeCamera, RayQuery, RenderError, Renderer, Scene, VisibilityBuffer};
use schema::geometry::{Snapshot, TriMesh};

use crate::device::Kernel;
use crate::error::GpuError;
use crate::eyes::{Eyes, Opened};
use crate::job::{Asked, Job};
use crate::meshes::ResidentMeshes;
use crate::ray_job::{AskedRays, RayJob};

/// Most bytes that a call answers: all cameras of an agent-frame of 9 megapixels.
const ANSWER_BYTES: u64 = 112 << 20;

/// Fewer rays than these are the CPU's: it follows them before a device is asked.
const FEWEST_RAYS: u64 = 2048;

/// Who answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Answered {
    /// The GPU.
    pub by_gpu: u64,
    /// The CPU, because the GPU could not, or had failed.
    pub by_cpu: u64,
}

impl Answered {
    /// Counts answers, each for so many.
    fn add<T>(&mut self, answers: &[Option<T>], each: impl Fn(usize) -> u64) {
        for (number, answer) in answers.iter().enumerate() {
            let by = if answer.is_some() { &mut self.by_gpu } else { &mut self.by_cpu };
            *by += each(number);
        }
    }
}

/// What a renderer was asked for, and what its device had to do with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Views of cameras and lights.
    pub views: Answered,
    /// Rays, but for those of small questions, which are no device's.
    pub rays: Answered,
    /// Calls of the device.
    pub calls: u64,
    /// How long its kernels ran, nanoseconds; 0 where it does not tell.
    pub kernel_ns: u64,
    /// Bytes that were told it, meshes apart.
    pub told_bytes: u64,
    /// Bytes that it answered.
    pub answered_bytes: u64,
}

/// Answers with a GPU what cameras and rays ask for, to the bit as [`CpuRenderer`] does.
///
/// Where a question does not fit on the device, or no kernel can answer it, the CPU answers that one. Where
/// the device fails, the CPU answers all that was asked for, and the device is opened again: once for each
/// renderer, then it is given up. All of it is said once.
#[derive(Debug)]
pub struct GpuRenderer {
    eyes: Arc<Eyes>,
    cpu: CpuRenderer,
    state: Mutex<State>,
    work: Mutex<Work>,
}

/// A renderer's meshes on the device, and what befell it.
#[derive(Debug, Default)]
struct State {
    /// `None`: not yet, or not any more.
    loaded: Option<Arc<Loaded>>,
    /// The CPU sees the rest.
    is_given_up: bool,
    was_reopened: bool,
    was_full: bool,
}

#[derive(Debug)]
struct Loaded {
    opened: Arc<Opened>,
    meshes: ResidentMeshes,
}

impl GpuRenderer {
    /// A renderer without meshes.
    #[must_use]
    pub fn new(eyes: Arc<Eyes>) -> Self {
        Self { eyes, cpu: CpuRenderer::default(), state: Mutex::default(), work: Mutex::default() }
    }

    /// What was asked for so far.
    #[must_use]
    pub fn work(&self) -> Work {
        *self.note()
    }

    fn note(&self) -> MutexGuard<'_, Work> {
        self.work.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn name(&self) -> &str {
        self.eyes.adapter().name()
    }

    /// The meshes on the device, uploaded when they are first asked for; `None` where the CPU has to
    /// see.
    fn loaded(&self) -> Option<Arc<Loaded>> {
        let mut state = self.state();
        while state.loaded.is_none() && !state.is_given_up {
            let Some(opened) = self.eyes.opened() else {
                state.is_given_up = true;
                break;
            };
            match ResidentMeshes::upload(&opened.gpu, self.eyes.memory(), self.cpu.meshes()) {
                Ok(meshes) => state.loaded = Some(Arc::new(Loaded { opened, meshes })),
                Err(e @ GpuError::Memory { .. }) => {
                    tracing::warn!("the scene's meshes do not fit on {}, the CPU sees it: {e}", self.name());
                    state.is_given_up = true;
                }
                Err(e) => self.open_again(&mut state, &opened, &e),
            }
        }
        state.loaded.clone()
    }

    /// What failed is not asked again. All threads may say so of the same device.
    fn lose(&self, loaded: &Arc<Loaded>, error: &GpuError) {
        let mut state = self.state();
        if state.loaded.as_ref().is_some_and(|now| Arc::ptr_eq(now, loaded)) {
            state.loaded = None;
            self.open_again(&mut state, &loaded.opened, error);
        }
    }

    fn open_again(&self, state: &mut State, lost: &Arc<Opened>, error: &GpuError) {
        let name = self.name();
        if state.was_reopened {
            tracing::warn!("{name} failed again, the CPU does the rest of the run: {error}");
            state.is_given_up = true;
            self.eyes.give_up();
            return;
        }
        state.was_reopened = true;
        match self.eyes.reopen(lost) {
            Ok(()) => tracing::warn!("{name} failed, and is opened again: {error}"),
            Err(e) => {
                tracing::warn!("{name} failed, the CPU does the rest of the run: {error}; opened again: {e}");
                state.is_given_up = true;
            }
        }
    }

    /// What the device answers to so many questions; `None` for those that the CPU has to answer.
    fn answered<A: Send, T>(
        &self,
        count: usize,
        ask: impl Fn(&Loaded, usize) -> Option<A> + Sync,
        answer: impl Fn(&Loaded, &[A]) -> Result<Vec<T>, GpuError>,
    ) -> Vec<Option<T>> {
        let nothing = || (0..count).map(|_| None).collect();
        let Some(loaded) = self.loaded() else { return nothing() };
        let asked: Vec<Option<A>> = (0..count).into_par_iter().map(|number| ask(&loaded, number)).collect();
        let is_asked: Vec<bool> = asked.iter().map(Option::is_some).collect();
        let asked: Vec<A> = asked.into_iter().flatten().collect();
        match self.where_there_is_room(&asked, |some| answer(&loaded, some)) {
            Ok(answers) => {
                let mut answers = answers.into_iter();
                is_asked.into_iter().map(|is_asked| if is_asked { answers.next()? } else { None }).collect()
            }
            Err(e) => {
                self.lose(&loaded, &e);
                nothing()
            }
        }
    }

    /// Answers all questions together, or one by one, or those alone for which there is room.
    fn where_there_is_room<A, T>(
        &self,
        asked: &[A],
        answer: impl Fn(&[A]) -> Result<Vec<T>, GpuError>,
    ) -> Result<Vec<Option<T>>, GpuError> {
        match answer(asked) {
            Ok(answers) => return Ok(answers.into_iter().map(Some).collect()),
            Err(GpuError::Memory { problem }) => {
                if !std::mem::replace(&mut self.state().was_full, true) {
                    tracing::warn!("{} has no room for all at once: {problem}", self.name());
                }
            }
            Err(e) => return Err(e),
        }
        let alone = |one| match answer(std::slice::from_ref(one)) {
            Ok(answers) => Ok(answers.into_iter().next()),
            Err(GpuError::Memory { .. }) => Ok(None),
            Err(e) => Err(e),
        };
        asked.iter().map(alone).collect()
    }

    fn draw(&self, loaded: &Loaded, asked: &[Asked<'_>]) -> Result<Vec<VisibilityBuffer>, GpuError> {
        let mut pictures: Vec<VisibilityBuffer> = asked.par_iter().map(Asked::empty).collect();
        for job in Job::split(asked, most_words(loaded)) {
            let kernel = &loaded.opened.visibility;
            let answers = self.call(loaded, kernel, (&job.words, job.workgroups()), job.answers)?;
            let views = pictures.par_iter_mut().zip(asked).enumerate();
            views.for_each(|(number, (picture, asked))| job.store(&answers, number, asked, picture));
        }
        Ok(pictures)
    }

    fn follow(&self, loaded: &Loaded, asked: &[AskedRays<'_>]) -> Result<Vec<Hits>, GpuError> {
        let mut hits: Vec<Hits> = asked.iter().map(|asked| Hits::none(asked.rays())).collect();
        for job in RayJob::split(asked, &loaded.meshes, most_words(loaded)) {
            let kernel = &loaded.opened.rays;
            let answers = self.call(loaded, kernel, (&job.words, job.workgroups()), job.answers)?;
            hits.par_iter_mut().enumerate().for_each(|(number, hits)| job.store(&answers, number, hits));
        }
        Ok(hits)
    }

    fn call(
        &self,
        loaded: &Loaded,
        kernel: &Kernel,
        (words, workgroups): (&[u32], u32),
        answers: usize,
    ) -> Result<Vec<u32>, GpuError> {
        // Nothing parallel in here: a thread that waits for others may take up work that wants memory, too.
        let Loaded { opened, meshes } = loaded;
        // Answers are there twice: where they are written, and where they are read.
        let _held = self.eyes.memory().call(4 * (words.len() + 2 * answers) as u64)?;
        let told = opened.gpu.upload(bytemuck::cast_slice(words))?;
        let inputs = [&meshes.nodes, &meshes.corners, &meshes.order, &told];
        let answer = opened.gpu.run(kernel, &inputs, workgroups, answers)?;
        let mut work = self.note();
        work.calls += 1;
        work.kernel_ns += answer.kernel_ns;
        work.told_bytes += 4 * words.len() as u64;
        work.answered_bytes += 4 * answers as u64;
        Ok(answer.words)
    }
}

/// The most words that a call may answer.
fn most_words(loaded: &Loaded) -> usize {
    (ANSWER_BYTES.min(loaded.opened.gpu.largest_buffer()) / 4) as usize
}

impl Renderer for GpuRenderer {
    fn prepare(&mut self, meshes: &[Arc<TriMesh>]) -> Result<(), RenderError> {
        *self.state() = State::default();
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

impl Scene for GpuScene<'_> {
    fn snapshot(&self) -> &Snapshot {
        self.cpu.snapshot()
    }

    fn render(&self, queries: &[CameraQuery<'_>]) -> Result<Vec<VisibilityBuffer>, RenderError> {
        let ask = |loaded: &Loaded, number: usize| {
            let query: &CameraQuery<'_> = &queries[number];
            Asked::new(self.cpu.tiled(query), query.outputs, &loaded.meshes)
        };
        let draw = |loaded: &Loaded, asked: &[Asked<'_>]| self.renderer.draw(loaded, asked);
        let seen = self.renderer.answered(queries.len(), ask, draw);
        self.renderer.note().views.add(&seen, |_| 1);
        filled(seen, queries, |queries| self.cpu.render(queries))
    }

    fn trace(&self, queries: &[RayQuery<'_>]) -> Result<Vec<Hits>, RenderError> {
        let rays = |number: usize| queries[number].rays.directions.len() as u64;
        if (0..queries.len()).map(rays).sum::<u64>() < FEWEST_RAYS {
            return self.cpu.trace(queries);
        }
        let placements = self.cpu.placements(queries);
        let ask = |loaded: &Loaded, number: usize| {
            let query: &RayQuery<'_> = &queries[number];
            AskedRays::new(query, placements.of(query), &loaded.meshes)
        };
        let follow = |loaded: &Loaded, asked: &[AskedRays<'_>]| self.renderer.follow(loaded, asked);
        let met = self.renderer.answered(queries.len(), ask, follow);
        self.renderer.note().rays.add(&met, rays);
        filled(met, queries, |queries| self.cpu.trace(queries))
    }

    fn beyond(&self, camera: &PinholeCamera, inner_px: f32, instances: &[u32]) -> Vec<u32> {
        self.cpu.beyond(camera, inner_px, instances)
    }
}

/// The answers, with those of the CPU where the device gave none.
fn filled<Q: Copy, T>(
    mut answers: Vec<Option<T>>,
    queries: &[Q],
    by_cpu: impl FnOnce(&[Q]) -> Result<Vec<T>, RenderError>,
) -> Result<Vec<T>, RenderError> {
    let missing: Vec<usize> = (0..queries.len()).filter(|&number| answers[number].is_none()).collect();
    let asked: Vec<Q> = missing.iter().map(|&number| queries[number]).collect();
    for (number, answer) in missing.into_iter().zip(by_cpu(&asked)?) {
        answers[number] = Some(answer);
    }
    Ok(answers.into_iter().flatten().collect())
}
