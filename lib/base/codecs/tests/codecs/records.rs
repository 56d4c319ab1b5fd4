//! Arrays of records, compressed by our own encoder and read back by another decoder.

use std::io::Read;

use codecs::{NpzReader, NpzWriter, Repeats, Scalar, encode_records};
use flate2::read::DeflateDecoder;
use proptest::prelude::*;

/// An array through an archive and back.
fn back(bytes: &[u8], repeats: Repeats<'_>) -> (Vec<u8>, usize) {
    let member = encode_records("a.npy", Scalar::U8, &[bytes.len()], bytes, repeats).expect("valid");
    let size = member.compressed_len();
    let mut writer = NpzWriter::new(Vec::new());
    writer.append(member).expect("new");
    let archive = writer.finish().expect("memory");
    let mut reader = NpzReader::new(std::io::Cursor::new(archive)).expect("an archive");
    (reader.read("a.npy").expect("its checksum holds").bytes, size)
}

/// Records that keep some of their bytes, as points and their labels do.
fn records() -> impl Strategy<Value = (Vec<u8>, usize)> {
    let piece = prop_oneof![
        (any::<u8>(), 1..700_usize).prop_map(|(byte, n)| vec![byte; n]),
        prop::collection::vec(any::<u8>(), 0..300),
        prop::collection::vec(0..4_u8, 0..300),
    ];
    (prop::collection::vec(piece, 0..6), 1..40_usize, 1..400_usize).prop_map(|(pieces, length, times)| {
        let seed = pieces.concat();
        let mut bytes = seed.clone();
        for i in 0..times {
            let record: Vec<u8> =
                (0..length).map(|k| seed.get((i * k) % 97).copied().unwrap_or(k as u8)).collect();
            bytes.extend(record);
        }
        (bytes, length)
    })
}

proptest! {
    #[test]
    fn any_bytes_come_back(
        (bytes, length) in records(), others in prop::collection::vec(0..40_000_usize, 0..3), step in 0..5_usize,
    ) {
        let distances: Vec<usize> = [length].into_iter().chain(others).collect();
        let (found, _) = back(&bytes, Repeats { distances: &distances, step });
        prop_assert_eq!(found, bytes);
    }
}

#[test]
fn every_length_and_distance_of_a_repeat_comes_back() {
    // Random bytes of so many, then the same again to some length, then others: one repeat.
    let mut state = 1_u32;
    let mut noise = |n: usize| -> Vec<u8> {
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        (0..n).map(|_| next()).collect()
    };
    let distances = (0..15)
        .flat_map(|k| [(1 << k) - 1, 1 << k, (1 << k) + 1, 3 << k])
        .filter(|d| (1..=32_768).contains(d));
    let cases = distances.map(|d| (d, 40)).chain((3..=600).map(|length| (700, length)));
    for (distance, length) in cases {
        let mut bytes = noise(distance);
        for i in 0..length {
            bytes.push(bytes[i]);
        }
        bytes.extend(noise(9));
        let (found, _) = back(&bytes, Repeats { distances: &[distance], step: 1 });
        assert_eq!(found, bytes, "{length} bytes from {distance} before");
    }
}

#[test]
fn codes_of_very_unequal_frequencies_are_cut_to_15_bits() {
    // Counts of the Fibonacci numbers make the deepest trees: 22 symbols would need 21 bits.
    let (mut bytes, mut counts) = (Vec::new(), (1_usize, 1_usize));
    for symbol in 0..22_u8 {
        bytes.extend(std::iter::repeat_n(symbol, counts.0));
        counts = (counts.1, counts.0 + counts.1);
    }
    assert!(bytes.len() < 65_536, "one block");
    assert_eq!(back(&bytes, Repeats::NONE).0, bytes);
}

#[test]
fn sizes_are_what_the_frequencies_say() {
    let overhead = 128 + 5 + 2; // The header in a block of its own, and the last block.
    // Four bytes equally often, and the end of the block: codes of 2, 2, 2, 3 and 3 bits, so 2.25 bits a
    // byte.
    let four: Vec<u8> = (0..60_000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 30) as u8).collect();
    let (found, size) = back(&four, Repeats::NONE);
    assert_eq!(found, four);
    assert!((16_875..16_875 + 200 + overhead).contains(&size), "{size}");
    // Records of four random bytes and eight that stay. Of five symbols one is the repeat: 2 bits, and 1 + 2
    // for its distance; the others share three quarters of the codes, 8.4 bits each. Makes 4.84 bytes, and
    // 0.06 for the codes of two blocks.
    let noise = |i: u32| i.wrapping_mul(2_654_435_761).rotate_left(i % 31).wrapping_mul(i | 1).to_le_bytes();
    let records: Vec<u8> =
        (0..5_000_u32).flat_map(|i| [noise(i), [9, 0, 0, 0], [3, 0, 0, 0]].concat()).collect();
    let repeats = Repeats { distances: &[12], step: 4 };
    let (found, size) = back(&records, repeats);
    assert_eq!(found, records);
    let bytes_a_record = (size - overhead) as f64 / 5_000.0;
    assert!((4.8..5.0).contains(&bytes_a_record), "{bytes_a_record}");
    assert!(back(&records, Repeats::NONE).1 > size + 5_000, "without repeats it is larger");
}

#[test]
fn nothing_and_one_byte_are_streams_too() {
    for bytes in [&[][..], &[7][..], &[0; 5][..], &[255; 65_536][..], &[1; 65_537][..]] {
        assert_eq!(back(bytes, Repeats { distances: &[1], step: 1 }).0, bytes);
        assert_eq!(back(bytes, Repeats::NONE).0, bytes);
    }
}

#[test]
fn the_stream_ends_where_a_decoder_ends() {
    let bytes: Vec<u8> = (0..100_000_u32).map(|i| (i / 7) as u8).collect();
    let member =
        encode_records("a.npy", Scalar::U8, &[100_000], &bytes, Repeats { distances: &[7], step: 1 });
    let archive = codecs::archive_of(member.expect("valid")).expect("memory");
    // Local header: 30 bytes and the name, lengths of name and extra field at 26 and 28.
    let at = 30 + usize::from(archive[26]) + usize::from(archive[28]) + 256 * usize::from(archive[29]);
    let mut decoder = DeflateDecoder::new(&archive[at..]);
    let mut plain = Vec::new();
    decoder.read_to_end(&mut plain).expect("a stream");
    assert_eq!(plain[plain.len() - bytes.len()..], bytes);
    assert_eq!(
        archive[at + decoder.total_in() as usize..][..4],
        *b"PK\x07\x08",
        "the sizes stand behind the data"
    );
}
