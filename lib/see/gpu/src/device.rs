//! A device in use.

use std::sync::mpsc;
use std::time::Duration;

use crate::adapter::Adapter;
use crate::error::GpuError;
use crate::shader::{EXACT, translate};
use crate::unchecked;

/// What has given no answer by then is taken for lost.
const TIMEOUT: Duration = Duration::from_secs(30);
/// Two moments.
const CLOCK_BYTES: u64 = 16;
/// Workgroups along a dimension that every device has.
const MOST_WORKGROUPS: u32 = 65_535;

/// A GPU in use, which computes as the CPU does: [`crate::open`] gives it.
#[derive(Debug)]
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    name: String,
    driver: String,
}

/// A shader on a device: it reads some buffers and writes one.
#[derive(Debug)]
pub struct Kernel {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

/// What a kernel answered.
#[derive(Debug, Default)]
pub struct Answer {
    /// 32-bit words.
    pub words: Vec<u32>,
    /// How long the device was at it, nanoseconds; 0 where it does not tell.
    pub kernel_ns: u64,
}

/// Bytes on a device.
#[derive(Debug)]
pub struct Resident {
    buffer: wgpu::Buffer,
}

impl Gpu {
    /// Opens an adapter's device, which may compute otherwise than the CPU.
    ///
    /// # Errors
    /// It lacks a feature, or the driver gives no device.
    pub(crate) fn untried(adapter: &Adapter) -> Result<Self, GpuError> {
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("convoy"),
            required_features: adapter.features()?,
            // The defaults are what browsers allow.
            required_limits: adapter.inner.limits(),
            ..wgpu::DeviceDescriptor::default()
        };
        let opened = pollster::block_on(adapter.inner.request_device(&descriptor));
        let (device, queue) = opened.map_err(GpuError::Open)?;
        Ok(Self { device, queue, name: adapter.name().to_owned(), driver: adapter.driver() })
    }

    /// The adapter's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Name and version of the driver.
    #[must_use]
    pub fn driver(&self) -> &str {
        &self.driver
    }

    /// The most bytes that a kernel can read from or write to one buffer.
    #[must_use]
    pub fn largest_buffer(&self) -> u64 {
        let limits = self.device.limits();
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
    }

    /// Gives the device back: it fails from then on, as one that is lost.
    pub fn destroy(&self) {
        self.device.destroy();
    }

    /// Puts bytes on the device: a multiple of four, not none.
    ///
    /// # Errors
    /// The device failed, or has no room.
    pub fn upload(&self, bytes: &[u8]) -> Result<Resident, GpuError> {
        self.catching(|| {
            let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("upload"),
                size: bytes.len() as u64,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            self.queue.write_buffer(&buffer, 0, bytes);
            Resident { buffer }
        })
    }

    /// Compiles a shader that may call what [`EXACT`] has. Its entry point is `name`. It reads so many
    /// bindings, from 0 on, and writes the next one.
    ///
    /// # Errors
    /// It is no WGSL, or the driver refuses it.
    pub fn kernel(&self, name: &str, inputs: u32, wgsl: &str) -> Result<Kernel, GpuError> {
        let words = translate(&format!("{EXACT}\n{wgsl}"))?;
        self.catching(|| {
            let module = unchecked::shader_module(&self.device, name, &words);
            let entry = |binding, read_only| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Storage { read_only },
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            };
            let layout = self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(name),
                entries: &(0..=inputs).map(|binding| entry(binding, binding < inputs)).collect::<Vec<_>>(),
            });
            let of_pipeline = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(name),
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            });
            let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(name),
                layout: Some(&of_pipeline),
                module: &module,
                entry_point: Some(name),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            });
            Kernel { pipeline, layout }
        })
    }

    /// Runs a kernel over buffers, in so many workgroups, which answers so many words.
    ///
    /// # Errors
    /// The device failed, or has given no answer for 30 s.
    pub fn run(
        &self,
        kernel: &Kernel,
        inputs: &[&Resident],
        workgroups: u32,
        answers: usize,
    ) -> Result<Answer, GpuError> {
        if answers == 0 || workgroups == 0 {
            return Ok(Answer::default());
        }
        let bytes = 4 * answers as u64;
        // Behind the answers the two moments between which the kernel ran.
        let clock_at = bytes.next_multiple_of(8);
        let has_clock = self.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let (read_back, submission) = self.catching(|| {
            let buffer = |label, size, usage| {
                self.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some(label),
                    size,
                    usage: usage | wgpu::BufferUsages::COPY_SRC,
                    mapped_at_creation: false,
                })
            };
            let written = buffer("answers", bytes, wgpu::BufferUsages::STORAGE);
            let read_back = self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("read back"),
                size: clock_at + CLOCK_BYTES,
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            let clock = has_clock.then(|| {
                let moments = self.device.create_query_set(&wgpu::QuerySetDescriptor {
                    label: None,
                    ty: wgpu::QueryType::Timestamp,
                    count: 2,
                });
                (moments, buffer("clock", CLOCK_BYTES, wgpu::BufferUsages::QUERY_RESOLVE))
            });
            let buffers = inputs.iter().map(|input| &input.buffer).chain([&written]);
            let entries: Vec<wgpu::BindGroupEntry<'_>> = (0..)
                .zip(buffers)
                .map(|(binding, buffer)| wgpu::BindGroupEntry {
                    binding,
                    resource: buffer.as_entire_binding(),
                })
                .collect();
            let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &kernel.layout,
                entries: &entries,
            });
            let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let timestamp_writes = clock.as_ref().map(|(moments, _)| wgpu::ComputePassTimestampWrites {
                query_set: moments,
                beginning_of_pass_write_index: Some(0),
                end_of_pass_write_index: Some(1),
            });
            let mut pass =
                encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes });
            pass.set_pipeline(&kernel.pipeline);
            pass.set_bind_group(0, &group, &[]);
            let columns = workgroups.min(MOST_WORKGROUPS);
            pass.dispatch_workgroups(columns, workgroups.div_ceil(columns), 1);
            drop(pass);
            encoder.copy_buffer_to_buffer(&written, 0, &read_back, 0, bytes);
            if let Some((moments, resolved)) = &clock {
                encoder.resolve_query_set(moments, 0..2, resolved, 0);
                encoder.copy_buffer_to_buffer(resolved, 0, &read_back, clock_at, CLOCK_BYTES);
            }
            (read_back, self.queue.submit([encoder.finish()]))
        })?;
        let (told, mapped) = mpsc::channel();
        read_back.map_async(wgpu::MapMode::Read, .., move |outcome| {
            // Whoever asked may have given up.
            let _ = told.send(outcome);
        });
        let failed = |problem: String| GpuError::Device { problem };
        let wait = wgpu::PollType::Wait { submission_index: Some(submission), timeout: Some(TIMEOUT) };
        self.device.poll(wait).map_err(|e| failed(e.to_string()))?;
        // Another thread that waits may be the one to tell.
        let mapped = mapped.recv_timeout(TIMEOUT).map_err(|_| failed("no answer came".into()))?;
        mapped.map_err(|e| failed(e.to_string()))?;
        let view = read_back.get_mapped_range(..).map_err(|e| failed(e.to_string()))?;
        let words = view[..bytes as usize].as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word));
        let ticks = match view[clock_at as usize..].as_chunks::<8>().0 {
            [from, to] if has_clock => u64::from_le_bytes(*to).saturating_sub(u64::from_le_bytes(*from)),
            _ => 0,
        };
        let kernel_ns = (ticks as f64 * f64::from(self.queue.get_timestamp_period())) as u64;
        Ok(Answer { words: words.collect(), kernel_ns })
    }

    /// Calls, and takes what the driver says meanwhile for an error.
    fn catching<T>(&self, call: impl FnOnce() -> T) -> Result<T, GpuError> {
        let scopes =
            [wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Internal]
                .map(|filter| self.device.push_error_scope(filter));
        let called = call();
        let mut said = Vec::new();
        for scope in scopes.into_iter().rev() {
            said.extend(pollster::block_on(scope.pop()));
        }
        match said.first() {
            None => Ok(called),
            Some(error @ wgpu::Error::OutOfMemory { .. }) => {
                Err(GpuError::Memory { problem: error.to_string() })
            }
            Some(error) => Err(GpuError::Device { problem: error.to_string() }),
        }
    }
}
