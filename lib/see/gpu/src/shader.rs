//! Shaders: WGSL becomes SPIR-V in which no float operation may be fused with another.

use naga::back::spv::{self, ZeroInitializeWorkgroupMemoryMode};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ValidationFlags, Validator};

use crate::GpuError;

/// Exact division, reciprocal and square root, which every shader may call: `quotient`, `reciprocal`,
/// `square_root`.
pub const EXACT: &str = include_str!("exact.wgsl");

/// Words before the first instruction of a module.
const HEADER: usize = 5;
const OP_DECORATE: u32 = 71;
const NO_CONTRACTION: u32 = 42;
/// OpFNegate, OpFAdd, OpFSub, OpFMul, OpFDiv, OpVectorTimesScalar.
const ROUNDED: [u32; 6] = [127, 129, 131, 133, 136, 142];
/// Types and constants, before which decorations stand.
const FIRST_TYPE: u32 = 19;
const LAST_CONSTANT: u32 = 52;

/// Translates a shader. Accesses out of bounds are checked in builds with debug assertions alone.
///
/// # Errors
/// It is no valid WGSL.
pub fn translate(wgsl: &str) -> Result<Vec<u32>, GpuError> {
    let error = |problem: String| GpuError::Shader { problem };
    let module = naga::front::wgsl::parse_str(wgsl).map_err(|e| error(e.emit_to_string(wgsl)))?;
    let capabilities = Capabilities::FLOAT64
        | Capabilities::SHADER_INT64
        | Capabilities::SHADER_INT64_ATOMIC_MIN_MAX
        | Capabilities::IMMEDIATES;
    let info = Validator::new(ValidationFlags::all(), capabilities)
        .validate(&module)
        .map_err(|e| error(e.emit_to_string(wgsl)))?;
    let policy =
        if cfg!(debug_assertions) { BoundsCheckPolicy::Restrict } else { BoundsCheckPolicy::Unchecked };
    let options = spv::Options {
        lang_version: (1, 3),
        flags: spv::WriterFlags::empty(),
        // Bindings keep the numbers that the shader gives them.
        fake_missing_bindings: true,
        bounds_check_policies: BoundsCheckPolicies {
            index: policy,
            buffer: policy,
            image_load: policy,
            binding_array: policy,
        },
        zero_initialize_workgroup_memory: ZeroInitializeWorkgroupMemoryMode::None,
        // Bounded loops were seen to cost a hundredfold.
        force_loop_bounding: false,
        emit_int_div_checks: false,
        ..spv::Options::default()
    };
    let words = spv::write_vec(&module, &info, &options, None).map_err(|e| error(e.to_string()))?;
    decorated(&words).ok_or_else(|| error("the translator wrote no SPIR-V".into()))
}

/// The instructions of a module: opcode, and all its words.
pub(crate) fn instructions(words: &[u32]) -> impl Iterator<Item = (u32, &[u32])> {
    let mut rest = words.get(HEADER..).unwrap_or_default();
    std::iter::from_fn(move || {
        let first = *rest.first()?;
        let (instruction, after) = rest.split_at_checked((first >> 16).max(1) as usize)?;
        rest = after;
        Some((first & 0xFFFF, instruction))
    })
}

/// A module with `NoContraction` on every float operation that rounds.
fn decorated(words: &[u32]) -> Option<Vec<u32>> {
    let decorations =
        instructions(words).filter(|(opcode, _)| ROUNDED.contains(opcode)).flat_map(|(_, words)| {
            // Opcode, type, result.
            [3 << 16 | OP_DECORATE, words[2], NO_CONTRACTION]
        });
    let before_types = instructions(words)
        .take_while(|(opcode, _)| !(FIRST_TYPE..=LAST_CONSTANT).contains(opcode))
        .map(|(_, words)| words.len())
        .sum::<usize>();
    let (annotations, body) = words.split_at_checked(HEADER + before_types)?;
    Some(annotations.iter().copied().chain(decorations).chain(body.iter().copied()).collect())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_operation_that_rounds_is_decorated_once() {
        let wgsl = "
            @group(0) @binding(0) var<storage, read_write> all: array<vec4<f32>>;
            @compute @workgroup_size(1)
            fn main() {
                let v = all[0];
                all[1] = -(v * v + v) * 3.0 - v * v.x;
            }";
        let words = translate(wgsl).expect("is a shader");
        let rounded: Vec<u32> =
            instructions(&words).filter(|(op, _)| ROUNDED.contains(op)).map(|(_, words)| words[2]).collect();
        let decorated: Vec<u32> = instructions(&words)
            .filter(|(op, words)| *op == OP_DECORATE && words[2..] == [NO_CONTRACTION])
            .map(|(_, words)| words[1])
            .collect();
        assert!(rounded.len() >= 6, "{rounded:?}");
        assert_eq!(BTreeSet::from_iter(&rounded), BTreeSet::from_iter(&decorated));
        assert_eq!(rounded.len(), decorated.len());
        // All before the first type.
        let opcodes: Vec<u32> = instructions(&words).map(|(op, _)| op).collect();
        let last = opcodes.iter().rposition(|op| *op == OP_DECORATE).expect("has some");
        let first_type = opcodes.iter().position(|op| (FIRST_TYPE..=LAST_CONSTANT).contains(op));
        assert!(Some(last) < first_type);
    }

    #[test]
    fn what_is_no_shader_is_told_with_its_line() {
        let error = translate("fn main() {\n    let a = b;\n}").expect_err("b is nothing").to_string();
        assert!(error.contains(":2:") && error.contains('b'), "{error}");
    }
}
