//! Reads any bytes as an archive of arrays. What a member is said to be is what comes out of it, however it
//! is taken.

#![no_main]

use std::io::Cursor;

use codecs::{NpzReader, archive_of};
use libfuzzer_sys::fuzz_target;

/// Larger arrays are refused.
const MAX_BYTES: u64 = 1 << 20;

fuzz_target!(|bytes: &[u8]| {
    let Ok(reader) = NpzReader::new(Cursor::new(bytes)) else { return };
    let mut reader = reader.with_max_bytes(MAX_BYTES);
    let names: Vec<String> = reader.members().map(str::to_owned).collect();
    for name in names.iter().take(20) {
        let packed = reader.read_packed(name);
        let Ok(array) = reader.read(name) else { continue };
        let packed = packed.expect("what can be read can be taken out");
        assert_eq!((&packed.dtype, &packed.shape), (&array.dtype, &array.shape));
        assert!(array.bytes.len() as u64 <= MAX_BYTES);
        // In an archive of its own it is the same.
        let Ok(member) = packed.member.renamed("data.npy") else { continue };
        let archive = archive_of(member).expect("fits");
        let again = NpzReader::new(Cursor::new(archive)).expect("is one").read("data.npy").expect("reads");
        assert_eq!(again, array);
    }
});
