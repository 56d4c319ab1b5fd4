//! Arithmetic of every adapter that there is, over all digits.

use gpu::{Case, Gpu, Operation, arithmetic};

use crate::common::with_each;

#[track_caller]
fn hold(gpu: &Gpu, cases: &[Case]) {
    for cases in cases.chunks(1 << 19) {
        let answers = arithmetic(gpu, cases).expect("the device answers");
        assert_eq!(answers.len(), cases.len());
        let wrong: Vec<(&Case, &u32)> =
            cases.iter().zip(&answers).filter(|(case, found)| !case.is_answered_by(**found)).collect();
        assert!(
            wrong.is_empty(),
            "{}: {} wrong, {:x?}",
            gpu.driver(),
            wrong.len(),
            &wrong[..wrong.len().min(4)]
        );
    }
}

#[test]
fn reciprocals_and_roots_are_exact_over_all_digits() {
    with_each(gpu::open, |gpu| {
        for (operation, binades) in [(Operation::Reciprocal, 127..128u32), (Operation::SquareRoot, 127..129)]
        {
            for power in binades {
                let case = |digits: u32| Case { operation, bits: [power << 23 | digits, 0, 0] };
                hold(&gpu, &(0..1 << 23).map(case).collect::<Vec<_>>());
            }
        }
    });
}

#[test]
fn quotients_are_exact_next_to_the_middle_between_two_floats() {
    // Numerators for which the quotient by b lies next to a middle between two floats: m b with an odd m of
    // 25 bits, rounded to 24, and its neighbours.
    with_each(gpu::open, |gpu| {
        let mut cases = Vec::new();
        let mut word = 1u32;
        for _ in 0..1 << 18 {
            word = word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let b = 1 << 23 | word >> 9;
            word = word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let middle = 1 << 24 | (word >> 8) | 1;
            let near = (u64::from(middle) * u64::from(b)) as f32;
            for off in [-1, 0, 1] {
                let a = near.to_bits().wrapping_add_signed(off);
                cases.push(Case { operation: Operation::Quotient, bits: [a, (b as f32).to_bits(), 0] });
            }
        }
        hold(&gpu, &cases);
    });
}

#[test]
fn sizes_and_signs_of_all_kinds_are_exact() {
    let special =
        [0.0f32, -0.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 1.0, -3.0, 1e18, 1e-18, f32::MAX];
    // Quotients that are too small for a normal float are not promised.
    let is_promised = |[a, b]: &[f32; 2]| {
        let q = (a / b).abs();
        *a == 0.0 || b.is_infinite() || q.is_nan() || q >= f32::MIN_POSITIVE
    };
    let pairs = special.iter().flat_map(|a| special.map(|b| [*a, b])).filter(is_promised);
    let quotients = pairs.map(|[a, b]| (Operation::Quotient, a, b));
    let roots = special.iter().map(|a| (Operation::SquareRoot, *a, 0.0));
    let cases: Vec<Case> = quotients
        .chain(roots)
        .map(|(operation, a, b)| Case { operation, bits: [a.to_bits(), b.to_bits(), 0] })
        .collect();
    // Of all usual sizes.
    let sized = (1..=253u32).flat_map(|power| {
        (0..64u32).flat_map(move |k| {
            let a = power << 23 | (k.wrapping_mul(0x9E37_79B9) >> 9);
            let b = 127 << 23 | (k.wrapping_mul(0x85EB_CA6B) >> 9);
            [
                Case { operation: Operation::SquareRoot, bits: [a, 0, 0] },
                Case { operation: Operation::Quotient, bits: [(power.max(2)) << 23 | a & 0x7F_FFFF, b, 0] },
            ]
        })
    });
    let cases: Vec<Case> = cases.into_iter().chain(sized).collect();
    with_each(gpu::open, |gpu| hold(&gpu, &cases));
}

#[test]
fn a_wrong_answer_is_told() {
    let case = Case { operation: Operation::ProductAndSum, bits: [1.1f32, 1.3, -1.43].map(f32::to_bits) };
    let [a, b, c] = case.bits.map(f32::from_bits);
    assert!(case.is_answered_by((a * b + c).to_bits()));
    assert!(!case.is_answered_by(a.mul_add(b, c).to_bits()), "fused");
    let none = Case { operation: Operation::SquareRoot, bits: [(-1.0f32).to_bits(), 0, 0] };
    assert!(none.is_answered_by(0x7FC0_0001) && !none.is_answered_by(0));
}
