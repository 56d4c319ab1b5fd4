//! Broken archives give errors that name what is wrong; nothing panics or sets much memory aside.

use std::error::Error;
use std::io::{self, Cursor, ErrorKind, Read, Seek, SeekFrom, Write};

use codecs::{Array, DEFAULT_LEVEL, DType, NpzError, NpzReader, NpzWriter, Scalar, encode_member};
use proptest::prelude::*;

fn archive() -> Vec<u8> {
    let mut writer = NpzWriter::new(Vec::new());
    let sparse: Vec<u8> = (0..4000_u32).map(|i| u8::from(i % 97 == 0)).collect();
    writer
        .append(encode_member("0000.npy", Scalar::Bool, &[4, 1000], &sparse, DEFAULT_LEVEL).expect("valid"))
        .expect("in memory");
    writer
        .append(encode_member("0001.npy", Scalar::F32, &[5, 3], &[7; 60], 0).expect("valid"))
        .expect("in memory");
    writer.finish().expect("in memory")
}

/// Largest array that is read here, and what reading takes besides: buffers and the decompressor.
const MAX_BYTES: u64 = 1 << 20;
const BESIDES: u64 = 512 << 10;

/// Reads every member; no array or claim of one may take more memory than it is allowed.
fn read_all(bytes: &[u8]) -> Result<Vec<Array>, NpzError> {
    read_each(bytes)?.into_iter().collect()
}

/// What becomes of each member.
fn read_each(bytes: &[u8]) -> Result<Vec<Result<Array, NpzError>>, NpzError> {
    let mut results = Ok(Vec::new());
    let taken = allocation_counter::measure(|| {
        results = NpzReader::new(Cursor::new(bytes)).map(|reader| {
            let mut reader = reader.with_max_bytes(MAX_BYTES);
            let names: Vec<String> = reader.members().map(str::to_owned).collect();
            names.iter().map(|name| reader.read(name)).collect()
        });
    });
    let allowed = 2 * bytes.len() as u64 + MAX_BYTES + BESIDES;
    assert!(taken.bytes_max <= allowed, "{} bytes of memory, {allowed} are allowed", taken.bytes_max);
    results
}

fn message(bytes: &[u8]) -> String {
    read_all(bytes).expect_err("the archive is broken").to_string()
}

fn find(bytes: &[u8], what: &[u8]) -> usize {
    bytes.windows(what.len()).position(|window| window == what).expect("present")
}

#[test]
fn every_cut_is_noticed() {
    let whole = archive();
    assert_eq!(read_all(&whole).expect("whole").len(), 2);
    for len in 0..whole.len() {
        let error = read_all(&whole[..len]).expect_err("cut");
        assert!(matches!(error, NpzError::Truncated { .. }), "{len}: {error}");
    }
}

#[test]
fn every_flipped_bit_is_survived_and_data_never_changes_silently() {
    let whole = archive();
    let want = read_all(&whole).expect("whole");
    for bit in 0..8 * whole.len() {
        let mut bytes = whole.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        // Versions, times and attributes mean nothing here; everything else must be noticed.
        if let Ok(got) = read_all(&bytes) {
            assert_eq!(got, want, "bit {bit}");
        }
    }
}

#[test]
fn faults_are_named() {
    let whole = archive();
    assert_eq!(message(b"not a zip"), message(&whole[..100]));
    assert_eq!(
        message(&whole[..100]),
        "end of archive: truncated: no record with the central directory's place, as in every zip"
    );

    let mut bytes = whole.clone();
    let stored_data = find(&bytes, &[7; 60]);
    bytes[stored_data] = 8;
    assert!(message(&bytes).starts_with("0001.npy: bad checksum: the archive says "));

    let mut bytes = whole.clone();
    let numpy = find(&bytes, b"\x93NUMPY");
    bytes[numpy] = 0;
    assert_eq!(message(&bytes), "0001.npy: corrupt: wrong magic: the member is not a NPY array");

    let mut bytes = whole.clone();
    bytes[0] = b'Q';
    assert_eq!(message(&bytes), "0000.npy: corrupt: Invalid signature: expected 0x04034b50, got 0x04034b51");

    let central = find(&whole, b"PK\x01\x02");
    let mut bytes = whole.clone();
    bytes[central + 10] = 12;
    assert_eq!(message(&bytes), "0000.npy: unsupported: compression method 12");

    let mut bytes = whole.clone();
    bytes[central + 8] = 1;
    assert_eq!(message(&bytes), "0000.npy: unsupported: encryption");

    // 4000 bytes and a header cannot be 4 GB; a possible size beyond the limit is refused as such.
    let mut bytes = whole.clone();
    bytes[central + 24..central + 28].copy_from_slice(&4_000_000_000_u32.to_le_bytes());
    assert!(message(&bytes).contains("4000000000 bytes cannot come out of"));
    let error = NpzReader::new(Cursor::new(&whole)).expect("whole").with_max_bytes(100).read("0000.npy");
    assert_eq!(error.expect_err("too large").to_string(), "0000.npy: has 4128 bytes, the limit is 100");

    let error = NpzReader::new(Cursor::new(&whole)).expect("whole").read("0002.npy");
    assert_eq!(error.expect_err("absent").to_string(), "0002.npy: no such member");
}

#[test]
fn a_shape_that_lies_sets_no_memory_aside() {
    let whole = archive();
    let mut bytes = whole.clone();
    let shape = find(&bytes, b"(5, 3), }");
    // Over the spaces that end the header.
    let lie = b"(9999999, 3), }";
    bytes[shape..shape + lie.len()].copy_from_slice(lie);
    assert_eq!(message(&bytes), "0001.npy: corrupt: shape [9999999, 3] does not make 188 bytes");
}

#[test]
fn what_cannot_be_written_is_refused() {
    let long = "x".repeat(256);
    for name in ["", "a/b.npy", "..\\b", "ä.npy", long.as_str()] {
        assert!(encode_member(name, Scalar::U8, &[1], &[0], 0).is_err(), "{name}");
    }
    for (shape, len) in [(vec![2, 2], 3), (vec![], 0), (vec![usize::MAX, 2], 4), (vec![1; 65], 1)] {
        assert!(encode_member("a.npy", Scalar::U8, &shape, &vec![0; len], 2).is_err(), "{shape:?}");
    }
    assert!(encode_member("a.npy", DType::Record(Vec::new()), &[1], &[], 2).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn noise_is_no_archive(
        head in proptest::collection::vec(any::<u8>(), 0..200),
        tail in proptest::collection::vec(any::<u8>(), 16),
    ) {
        // With an end record's magic in place the reader looks deeper.
        let mut bytes = head;
        bytes.extend_from_slice(b"PK\x05\x06");
        bytes.extend_from_slice(&tail);
        bytes.extend_from_slice(&[0, 0]);
        // A few noises announce an empty directory, which is an empty archive.
        if let Ok(arrays) = read_all(&bytes) {
            prop_assert!(arrays.is_empty());
        }
    }

    #[test]
    fn many_changed_bytes_are_survived(
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..20),
    ) {
        let mut bytes = archive();
        for (index, value) in changes {
            let at = index.index(bytes.len());
            bytes[at] = value;
        }
        // What is read at all is one of the arrays that were written.
        let written = read_all(&archive()).expect("whole");
        for array in read_each(&bytes).into_iter().flatten().flatten() {
            prop_assert!(written.contains(&array), "{:?}", array);
        }
    }

    #[test]
    fn arrays_come_back(
        lens in proptest::collection::vec(0_usize..20, 0..4),
        fill in proptest::collection::vec(any::<u8>(), 1..50),
        level in 0_u32..10,
    ) {
        let dtype = DType::Record(vec![("x".into(), Scalar::F32), ("id".into(), Scalar::U16)]);
        let len = lens.iter().product::<usize>() * 6;
        let bytes: Vec<u8> = fill.iter().copied().cycle().take(len).collect();
        let member = encode_member("0000.npy", dtype.clone(), &lens, &bytes, level).expect("valid");
        prop_assert_eq!(&member, &encode_member("0000.npy", dtype.clone(), &lens, &bytes, level).expect("valid"));
        let mut writer = NpzWriter::new(Vec::new());
        writer.append(member).expect("in memory");
        let archive = writer.finish().expect("in memory");
        prop_assert_eq!(read_all(&archive).expect("whole"), vec![Array { dtype, shape: lens, bytes }]);
    }
}

/// Large members cross the pieces that encoding works in.
#[test]
fn a_member_of_many_pieces_comes_back() {
    let bytes: Vec<u8> = (0..1_000_003_u32).map(|i| (i.wrapping_mul(0x9E37_79B9) >> 24) as u8).collect();
    for level in [0, 1, DEFAULT_LEVEL, 9] {
        let mut writer = NpzWriter::new(Vec::new());
        writer
            .append(encode_member("0000.npy", Scalar::U8, &[1_000_003], &bytes, level).expect("valid"))
            .expect("in memory");
        let archive = writer.finish().expect("in memory");
        assert!(read_all(&archive).expect("whole")[0].bytes == bytes, "level {level}");
    }
}

/// A stream that takes or gives so many bytes, then fails.
struct Failing<S> {
    stream: S,
    left: usize,
    kind: ErrorKind,
}

impl<S: Write> Write for Failing<S> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.left == 0 {
            return Err(self.kind.into());
        }
        let written = self.stream.write(&bytes[..bytes.len().min(self.left)])?;
        self.left -= written;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.left == 0 { Err(self.kind.into()) } else { self.stream.flush() }
    }
}

impl<S: Read> Read for Failing<S> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.left == 0 {
            return Err(self.kind.into());
        }
        let len = buffer.len().min(self.left);
        let read = self.stream.read(&mut buffer[..len])?;
        self.left -= read;
        Ok(read)
    }
}

impl<S: Seek> Seek for Failing<S> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.stream.seek(to)
    }
}

/// The kind of the stream's error below an archive's.
fn kind_below(error: &NpzError) -> Option<ErrorKind> {
    error.source()?.downcast_ref::<io::Error>().map(io::Error::kind)
}

#[test]
fn the_streams_error_keeps_its_kind() {
    let whole = archive();
    for left in 0..=whole.len() {
        let mut writer = NpzWriter::new(Failing { stream: Vec::new(), left, kind: ErrorKind::StorageFull });
        let member =
            |name, level| encode_member(name, Scalar::Bool, &[400], &[1; 400], level).expect("valid");
        let result = writer.append(member("0000.npy", DEFAULT_LEVEL)).and_then(|()| {
            writer.append(member("0001.npy", 0))?;
            writer.finish().map(drop)
        });
        let error = result.expect_err("too little room");
        assert_eq!(kind_below(&error), Some(ErrorKind::StorageFull), "{left}: {error}");
    }
    let read = |left| {
        let stream = Failing { stream: Cursor::new(&whole), left, kind: ErrorKind::TimedOut };
        let mut reader = NpzReader::new(stream)?;
        let names: Vec<String> = reader.members().map(str::to_owned).collect();
        names.iter().try_for_each(|name| reader.read(name).map(drop))
    };
    let enough =
        (0..10 * whole.len()).find(|&left| read(left).is_ok()).expect("some number of bytes is enough");
    for left in 0..enough {
        let error = read(left).expect_err("too few bytes");
        assert_eq!(kind_below(&error), Some(ErrorKind::TimedOut), "{left}: {error}");
    }
}
