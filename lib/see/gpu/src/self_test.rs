//! Whether a device computes as the CPU does.

use crate::adapter::Adapter;
use crate::device::Gpu;
use crate::error::GpuError;

/// One of the operations that answers hang on. Operands are a, b and c.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// a / b.
    Quotient,
    /// The square root of a.
    SquareRoot,
    /// 1 / a.
    Reciprocal,
    /// a b + c, rounded twice.
    ProductAndSum,
    /// c - a b, rounded twice.
    ProductLess,
    /// a b + c c in double precision, rounded at last to single.
    DoubleSum,
    /// a b in double precision, rounded to single.
    DoubleProduct,
    /// The greatest whole number that is not above a.
    Floor,
    /// The whole part of a, 32 bits with a sign.
    Whole,
    /// The bits of a as a number without a sign, as a float.
    FromUnsigned,
    /// The same with a sign.
    FromSigned,
}

/// An operation on numbers that are given by their bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Case {
    /// What is computed.
    pub operation: Operation,
    /// Bits of a, b and c.
    pub bits: [u32; 3],
}

const SHADER: &str = include_str!("arithmetic.wgsl");
const WORKGROUP: u32 = 64;
/// Cases of each operation that are tried when a device is opened.
const TRIED: u32 = 2048;

impl Operation {
    /// All of them, in the order of the shader's numbers.
    pub const ALL: [Self; 11] = [
        Self::Quotient,
        Self::SquareRoot,
        Self::Reciprocal,
        Self::ProductAndSum,
        Self::ProductLess,
        Self::DoubleSum,
        Self::DoubleProduct,
        Self::Floor,
        Self::Whole,
        Self::FromUnsigned,
        Self::FromSigned,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Quotient => "a / b",
            Self::SquareRoot => "sqrt(a)",
            Self::Reciprocal => "1 / a",
            Self::ProductAndSum => "a b + c",
            Self::ProductLess => "c - a b",
            Self::DoubleSum => "a b + c c in double precision",
            Self::DoubleProduct => "a b in double precision",
            Self::Floor => "floor(a)",
            Self::Whole => "the whole part of a",
            Self::FromUnsigned => "the float of an unsigned number",
            Self::FromSigned => "the float of a signed number",
        }
    }
}

impl Case {
    /// What the CPU answers, as bits.
    #[must_use]
    pub fn expected(&self) -> u32 {
        let [a, b, c] = self.bits.map(f32::from_bits);
        let [wide_a, wide_b, wide_c] = [a, b, c].map(f64::from);
        match self.operation {
            Operation::Quotient => (a / b).to_bits(),
            Operation::SquareRoot => a.sqrt().to_bits(),
            Operation::Reciprocal => (1.0 / a).to_bits(),
            Operation::ProductAndSum => (a * b + c).to_bits(),
            Operation::ProductLess => (c - a * b).to_bits(),
            Operation::DoubleSum => ((wide_a * wide_b + wide_c * wide_c) as f32).to_bits(),
            Operation::DoubleProduct => ((wide_a * wide_b) as f32).to_bits(),
            Operation::Floor => a.floor().to_bits(),
            Operation::Whole => (a as i32).cast_unsigned(),
            Operation::FromUnsigned => (self.bits[0] as f32).to_bits(),
            Operation::FromSigned => (self.bits[0].cast_signed() as f32).to_bits(),
        }
    }

    /// Whether an answer is the CPU's; of what is no number only that it is none counts.
    #[must_use]
    pub fn is_answered_by(&self, found: u32) -> bool {
        let expected = self.expected();
        let is_float = self.operation != Operation::Whole;
        found == expected || is_float && f32::from_bits(expected).is_nan() && f32::from_bits(found).is_nan()
    }
}

/// What a device answers to cases, in their order, as bits.
///
/// # Errors
/// The device failed.
pub fn arithmetic(gpu: &Gpu, cases: &[Case]) -> Result<Vec<u32>, GpuError> {
    let kernel = gpu.kernel("arithmetic", 1, SHADER)?;
    let number = |operation| Operation::ALL.iter().position(|other| *other == operation).unwrap_or_default();
    let words = |case: &Case| {
        let [a, b, c] = case.bits;
        [number(case.operation) as u32, a, b, c]
    };
    let input: Vec<u8> = cases.iter().flat_map(words).flat_map(u32::to_le_bytes).collect();
    if input.is_empty() {
        return Ok(Vec::new());
    }
    let workgroups = (cases.len() as u32).div_ceil(WORKGROUP);
    Ok(gpu.run(&kernel, &[&gpu.upload(&input)?], workgroups, cases.len())?.words)
}

/// Opens an adapter's device and tries whether it computes as the CPU does.
///
/// # Errors
/// It lacks a feature, the driver gives no device or fails, or an answer is not the CPU's: the first of them.
pub fn open(adapter: &Adapter) -> Result<Gpu, GpuError> {
    let gpu = Gpu::untried(adapter)?;
    let usual = (0..TRIED)
        .flat_map(|n| Operation::ALL.map(|operation| Case { operation, bits: operands(operation, n) }));
    let cases: Vec<Case> = usual.chain(special()).collect();
    let answers = arithmetic(&gpu, &cases)?;
    let wrong = cases.iter().zip(&answers).find(|(case, found)| !case.is_answered_by(**found));
    match wrong {
        None => Ok(gpu),
        Some((case, &found)) => Err(GpuError::Inexact {
            driver: gpu.driver().to_owned(),
            operation: case.operation.name(),
            operands: format!("{:#010x}, {:#010x}, {:#010x}", case.bits[0], case.bits[1], case.bits[2]),
            found,
            expected: case.expected(),
        }),
    }
}

/// Zeros, infinities and what is no number, divided by one another, and their roots.
fn special() -> impl Iterator<Item = Case> {
    let all = [0.0f32, -0.0, 1.0, -1.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN].map(f32::to_bits);
    let pairs = all.into_iter().flat_map(move |a| all.map(|b| [a, b, 0]));
    pairs.flat_map(|bits| {
        [Operation::Quotient, Operation::SquareRoot].map(|operation| Case { operation, bits })
    })
}

/// Bits of operands in the sizes that pictures and distances have, no two alike.
fn operands(operation: Operation, n: u32) -> [u32; 3] {
    // A hash of 32 bits that no two numbers share.
    let hash = |mut v: u32| {
        v = (v ^ v >> 16).wrapping_mul(0x7FEB_352D);
        v = (v ^ v >> 15).wrapping_mul(0x846C_A68B);
        v ^ v >> 16
    };
    let float = |word: u32, sign: u32| {
        let power = 127 - 12 + (word >> 24) % 24;
        sign << 31 | power << 23 | word & 0x7F_FFFF
    };
    let [a, b, c] = [0, 1, 2].map(|k| hash(3 * n + k + 1));
    let sign = |word: u32| word >> 31;
    match operation {
        Operation::FromUnsigned | Operation::FromSigned => [a, b, c],
        Operation::SquareRoot => [float(a, 0), 0, 0],
        // c is near -a b: what is left are the digits that a fused operation keeps.
        Operation::ProductAndSum | Operation::ProductLess => {
            let (a, b) = (float(a, sign(c)), float(b, sign(a)));
            let product = f32::from_bits(a) * f32::from_bits(b);
            let c = if operation == Operation::ProductAndSum { -product } else { product };
            [a, b, c.to_bits()]
        }
        _ => [float(a, sign(c)), float(b, sign(a)), float(c, sign(b))],
    }
}
