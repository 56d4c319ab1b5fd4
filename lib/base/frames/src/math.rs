//! Transcendental functions that give the same bits on every machine.
//!
//! `std`'s versions call the system's C library, whose last bit differs between versions and processors;
//! these are libm's portable ones. `sqrt`, `abs`, `floor`, `mul_add` are exact by IEEE 754 and need no
//! replacement.

pub use libm::{
    acos, asin, atan, atan2, cbrt, ceil, cos, erf, exp, hypot, log as ln, log2, log10, pow, sin, tan,
};

/// Sine and cosine together.
#[must_use]
pub fn sin_cos(angle_rad: f64) -> (f64, f64) {
    libm::sincos(angle_rad)
}

/// Single-precision versions.
pub mod f32 {
    pub use libm::{
        acosf as acos, asinf as asin, atan2f as atan2, atanf as atan, cosf as cos, expf as exp,
        hypotf as hypot, log2f as log2, log10f as log10, logf as ln, powf as pow, sinf as sin, tanf as tan,
    };

    /// Sine and cosine together.
    #[must_use]
    pub fn sin_cos(angle_rad: f32) -> (f32, f32) {
        libm::sincosf(angle_rad)
    }
}
