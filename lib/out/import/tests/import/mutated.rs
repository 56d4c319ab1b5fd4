//! Whatever is done to the bytes of a file, there is an answer, and no panic: what `fuzz/` does for hours,
//! for a moment.

use std::io::Cursor;

use codecs::NpzReader;
use import_core::{Rigs, Scene, json, npy, scan};
use random::Stream;

use crate::dataset;

/// Variants of some bytes: a few of them changed, left out, doubled, or the end cut off.
fn variants(seed: u64, bytes: &[u8], count: u64, mut look: impl FnMut(&[u8])) {
    for variant in 0..count {
        let mut stream = Stream::new(seed, variant, "test/mutated", 0);
        let mut below = |n: usize| stream.next_u32() as usize % n.max(1);
        let mut changed = bytes.to_vec();
        for _ in 0..=below(4) {
            let at = below(changed.len());
            match below(6) {
                0 => changed.truncate(at),
                1 if !changed.is_empty() => drop(changed.remove(at)),
                2 => {
                    let to = (at + below(60)).min(changed.len());
                    let part = changed[at..to].to_vec();
                    changed.splice(at..at, part);
                }
                // Numbers at the rim of their types, digits and brackets.
                3 => changed.splice(at..at, [0xff, 0xff, 0xff, 0x7f]).for_each(drop),
                4 if !changed.is_empty() => changed[at] = b"0(.)]}\xff"[below(7)],
                _ if !changed.is_empty() => changed[at] = below(256) as u8,
                _ => {}
            }
        }
        look(&changed);
    }
}

#[test]
fn mutated_lists_of_boxes_have_an_answer() {
    let good = dataset::boxes(3);
    npy::parse(&good).expect("is one");
    let mut refused = 0;
    variants(1, &good, 20_000, |bytes| refused += u32::from(npy::parse(bytes).is_err()));
    assert!(refused > 5_000, "{refused} of 20,000 were refused: the bytes are hardly changed");
}

#[test]
fn mutated_infos_have_an_answer() {
    let good = dataset::infos();
    let whole = |bytes: &[u8]| {
        let Ok(index) = scan(bytes) else { return 0 };
        let part =
            |range: &std::ops::Range<u64>| json::parse(&bytes[range.start as usize..range.end as usize]);
        if let Ok(metadata) = part(&index.metadata) {
            let _ = Rigs::of(&metadata);
        }
        let scenes =
            index.scenes.iter().filter_map(|(number, range)| Scene::of(part(range).ok()?, *number).ok());
        scenes.count()
    };
    assert_eq!(whole(good.as_bytes()), 2);
    let mut read = 0;
    variants(2, good.as_bytes(), 3_000, |bytes| read += whole(bytes));
    assert!((1..6_000).contains(&read), "{read} scenes were read");
}

#[test]
fn mutated_archives_have_an_answer() {
    let good = dataset::masks(3);
    let mut refused = 0;
    variants(3, &good, 20_000, |bytes| {
        let read = NpzReader::new(Cursor::new(bytes))
            .and_then(|reader| reader.with_max_bytes(1 << 20).read("data.npy"));
        refused += u32::from(read.is_err());
    });
    assert!(refused > 5_000, "{refused} of 20,000 were refused");
}
