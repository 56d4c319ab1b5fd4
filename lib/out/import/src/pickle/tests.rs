use proptest::prelude::*;

use super::*;

fn problem(bytes: &[u8]) -> String {
    parse(bytes).expect_err("is refused").to_string()
}

/// `numpy.core.multiarray._reconstruct(numpy.ndarray, (0,), b'b')` and the beginning of its state.
const ARRAY: &[u8] = b"cnumpy.core.multiarray\n_reconstruct\ncnumpy\nndarray\nK\x00\x85C\x01b\x87R(K\x01";
/// `dtype('f8', False, True)` in its state.
const F8: &[u8] = b"cnumpy\ndtype\nX\x02\0\0\0f8\x89\x88\x87R(K\x03X\x01\0\0\0<NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\x00tb";

#[test]
fn plain_values_are_what_the_opcodes_say() {
    let value = parse(b"\x80\x03}(X\x01\0\0\0aK\x07X\x01\0\0\0bM\x2c\x01X\x01\0\0\0cJ\xff\xff\xff\xffX\x01\0\0\0dG\x3f\xf8\0\0\0\0\0\0X\x01\0\0\0e\x8a\x09\0\0\0\0\0\0\0\x80\0X\x01\0\0\0fNX\x01\0\0\0g\x88X\x01\0\0\0h](K\x01K\x02eu.");
    let value = value.expect("is read");
    let int = |key: &str| value.get(key).and_then(Value::whole::<i128>);
    assert_eq!((int("a"), int("b"), int("c")), (Some(7), Some(300), Some(-1)));
    assert_eq!(value.get("d"), Some(&Value::Float(1.5)));
    assert_eq!(int("e"), Some(1 << 63), "unsigned hashes of 64 bits");
    assert_eq!((value.get("f"), value.get("g")), (Some(&Value::None), Some(&Value::Bool(true))));
    assert_eq!(value.get("h"), Some(&Value::List(vec![Value::Int(1), Value::Int(2)])));
}

#[test]
fn arrays_are_read_in_either_order() {
    let numbers: Vec<u8> = (1..=6).flat_map(|v| f64::from(v).to_le_bytes()).collect();
    let of = |order: &[u8]| {
        let raw: &[u8] = &[b"C\x30".as_slice(), &numbers].concat();
        parse(&[b"\x80\x03", ARRAY, b"K\x02K\x03\x86", F8, order, raw, b"tb."].concat()).expect("is read")
    };
    let shape = vec![2, 3];
    assert_eq!(
        of(b"\x89"),
        Value::Numbers { shape: shape.clone(), values: vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0] }
    );
    assert_eq!(of(b"\x88"), Value::Numbers { shape, values: vec![1.0, 3.0, 5.0, 2.0, 4.0, 6.0] });
}

#[test]
fn an_array_that_is_recalled_is_the_finished_one() {
    // Remembered before its state is there, as Python does it.
    let start =
        b"cnumpy.core.multiarray\n_reconstruct\ncnumpy\nndarray\nK\x00\x85C\x01b\x87Rq\x00(K\x01K\x01\x85";
    let raw = [b"\x89C\x08".as_slice(), &2.5_f64.to_le_bytes()].concat();
    let value = parse(&[b"\x80\x03](".as_slice(), start, F8, &raw, b"tbh\x00e."].concat()).expect("is read");
    let one = Value::Numbers { shape: vec![1], values: vec![2.5] };
    assert_eq!(value, Value::List(vec![one.clone(), one]));
}

#[test]
fn nothing_else_is_known() {
    let shell = b"cposix\nsystem\nX\x02\0\0\0ls\x85R.";
    assert_eq!(problem(shell), "byte 0: wants `posix.system`, which is not known here and never called");
    let new = b"\x80\x04\x8c\x05posix\x8c\x06system\x93.";
    assert_eq!(problem(new), "byte 17: wants `posix.system`, which is not known here and never called");
    for op in [
        b'i', b'o', b'\x81', b'\x92', b'P', b'Q', b'\x82', b'S', b'V', b'I', b'F', b'L', b'\x8b', b'\x8d',
        b'0', b'2',
    ] {
        assert_eq!(problem(&[op, b'.']), format!("byte 0: opcode {op:#04x} is not known here"));
    }
    assert_eq!(problem(b"cnumpy\ndtype\n)R."), "byte 14: a call that is not known here");
    assert_eq!(problem(b"cnumpy\ndtype\n."), "byte 14: a class where a value is expected");
}

#[test]
fn truncated_pickles_and_wrong_counts_are_refused() {
    let whole = b"\x80\x03}(X\x01\0\0\0aK\x07X\x01\0\0\0b](K\x01K\x02eu.";
    parse(whole).expect("is read");
    for end in 0..whole.len() {
        assert!(parse(&whole[..end]).is_err(), "{end} bytes");
    }
    for (bytes, want) in [
        (b"X\xff\xff\xff\xffab.".as_slice(), "byte 0: it ends early"),
        (
            b"\x95\xff\xff\xff\xff\xff\xff\xff\xffN.",
            "byte 0: a frame of 18446744073709551615 bytes, 2 are left",
        ),
        (b"e.", "byte 0: there is no mark"),
        (b"(K\x01\x86.", "byte 3: nothing is there to be taken"),
        (b"}(K\x01K\x02u.", "byte 6: a key that is no text"),
        (b"K\x01q\x05.", "byte 2: puts 5 into a memo of 0"),
        (b"h\x00.", "byte 0: the memo has no 0"),
        (b"NN.", "byte 2: it stops with values left"),
        (b"N.N", "byte 1: something behind the end"),
        (b"\x80\x06N.", "byte 0: protocol 6"),
        (b"X\x01\0\0\0\xff.", "byte 0: a text that is not UTF-8"),
    ] {
        assert_eq!(problem(bytes), want);
    }
    let huge = [b"\x80\x03", ARRAY, b"J\xff\xff\xff\x7fJ\xff\xff\xff\x7f\x86", F8, b"\x89C\x00tb."].concat();
    assert!(problem(&huge).ends_with("an array of shape [2147483647, 2147483647]"), "{}", problem(&huge));
    let short = [b"\x80\x03", ARRAY, b"K\x03\x85", F8, b"\x89C\x00tb."].concat();
    assert!(problem(&short).ends_with("elements that do not fill the shape [3]"));
}

#[test]
fn what_holds_itself_or_grows_without_end_is_refused() {
    let itself = b"]q\x00h\x00a.";
    assert!(problem(itself).ends_with("values are nested too deep, or hold themselves"));
    // Each list holds the one before it ten times.
    let mut bomb = b"](NNNNNNNNNNeq\x00".to_vec();
    for k in 0..12_u8 {
        bomb.extend_from_slice(b"](");
        (0..10).for_each(|_| bomb.extend_from_slice(&[b'h', k]));
        bomb.extend_from_slice(&[b'e', b'q', k + 1]);
    }
    // The lists before it are on the stack, too: take them into one.
    let bomb = [b"(".as_slice(), &bomb, b"t."].concat();
    assert!(problem(&bomb).ends_with("far more comes out of it than is in it"), "{}", problem(&bomb));
    let deep = [b"(".repeat(100), b".".to_vec()].concat();
    assert_eq!(problem(&deep), "byte 64: more than 64 marks within one another");
}

proptest! {
    /// Whatever the bytes are, there is an answer, and soon.
    #[test]
    fn any_bytes_have_an_answer(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = parse(&bytes);
    }

    /// So do bytes of which each is an opcode that is known.
    #[test]
    fn any_opcodes_have_an_answer(
        ops in prop::collection::vec(prop::sample::select(b"N\x88\x89K\x01q\x00h\x00](e}ua)\x85\x86\x87tsR\x94b.".to_vec()), 0..60)
    ) {
        let _ = parse(&ops);
    }
}
