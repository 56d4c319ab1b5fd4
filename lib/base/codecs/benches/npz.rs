//! Time to encode and decode one voxel grid (1280 x 1280 x 80) of a town, on one core.

#![allow(clippy::print_stderr, reason = "the size belongs beside the time")]

use std::hint::black_box;
use std::io::Cursor;

use codecs::{DEFAULT_LEVEL, EncodedMember, NpzReader, NpzWriter, Scalar, encode_member};
use divan::Bencher;

const SHAPE: [usize; 3] = [1280, 1280, 80];

fn main() {
    divan::main();
}

/// Ground in every column, walls and crowns above some: 3.6 % of the cells are occupied, as in real grids.
fn grid() -> Vec<u8> {
    let mut grid = vec![0; SHAPE.iter().product()];
    for (i, column) in grid.chunks_exact_mut(SHAPE[2]).enumerate() {
        let (x, y) = (i / SHAPE[1], i % SHAPE[1]);
        // A fixed mixture of the bits of x and y makes ground rough and trees ragged.
        let noise = (x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B)) >> 7;
        let ground = 10 + (x / 200 + y / 300) % 3;
        column[ground] = if y % 320 < 90 { 1 } else { 10 };
        if noise % 8 == 0 {
            column[ground - 1] = 10;
        }
        if (x % 256 == 40 || y % 320 == 120) && y % 320 >= 120 {
            column[ground + 1..].fill(3);
        }
        if x % 160 < 70 && y % 320 > 200 && y % 320 < 318 {
            for (z, cell) in column.iter_mut().enumerate().skip(45) {
                if (noise >> (z % 16)) % 4 == 0 {
                    *cell = 9;
                }
            }
        }
    }
    grid
}

fn encode(grid: &[u8]) -> EncodedMember {
    encode_member("0000.npy", Scalar::U8, &SHAPE, grid, DEFAULT_LEVEL).expect("a valid grid")
}

#[divan::bench(sample_count = 10)]
fn encode_voxel_grid(bencher: Bencher) {
    let grid = grid();
    let occupied = grid.iter().filter(|&&label| label != 0).count();
    eprintln!(
        "occupied {:.2} %, encoded {} bytes",
        100.0 * occupied as f64 / grid.len() as f64,
        encode(&grid).compressed_len()
    );
    bencher.bench_local(|| encode(black_box(&grid)));
}

#[divan::bench(sample_count = 10)]
fn decode_voxel_grid(bencher: Bencher) {
    let mut writer = NpzWriter::new(Vec::new());
    writer.append(encode(&grid())).expect("no faults in memory");
    let archive = writer.finish().expect("no faults in memory");
    bencher.bench_local(|| {
        let mut reader = NpzReader::new(Cursor::new(black_box(&archive))).expect("readable");
        reader.read("0000.npy").expect("readable")
    });
}
