//! GPUs: which there are, whether they compute as the CPU does, shaders that may not be rearranged, and a
//! renderer that asks them ([`GpuRenderer`]).
//!
//! A device may change no byte of a dataset. Two things make that possible. Shaders are translated here
//! ([`translate`]): every float operation is marked so that the driver may not fuse it with another. And
//! divisions and roots, which devices round as they like, are computed from additions and multiplications
//! ([`EXACT`]). Whether a driver keeps to it is tried when its device is opened ([`open`]); one that does
//! not is not used, nor is one that sees a small scene otherwise than the CPU ([`eyes`]).
//!
//! ```no_run
//! for adapter in gpu::adapters() {
//!     match gpu::eyes(&adapter, None) {
//!         Ok(_) => println!("{adapter}: computes as the CPU does"),
//!         Err(e) => println!("{adapter}: not used: {e}"),
//!     }
//! }
//! ```

mod adapter;
mod device;
mod error;
mod eyes;
mod job;
mod memory;
mod meshes;
mod ray_job;
mod renderer;
mod self_scene;
mod self_test;
mod shader;
mod unchecked;

pub use adapter::{Adapter, adapters};
pub use device::{Answer, Gpu, Kernel, Resident};
pub use error::GpuError;
pub use eyes::Eyes;
pub use renderer::{Answered, GpuRenderer, Work};
pub use self_scene::eyes;
pub use self_test::{Case, Operation, arithmetic, open};
pub use shader::{EXACT, translate};
