use super::*;

const RED: [u8; 3] = [200, 40, 40];
const BLUE: [u8; 3] = [30, 60, 210];

/// Red left, blue right.
fn halves(width: usize, height: usize) -> Vec<u8> {
    (0..width * height).flat_map(|i| if i % width < width / 2 { RED } else { BLUE }).collect()
}

fn is_near(image: &RgbImage, at: [u32; 2], want: [u8; 3]) -> bool {
    let start = 3 * (at[1] * image.width + at[0]) as usize;
    image.rgb[start..start + 3].iter().zip(want).all(|(got, want)| got.abs_diff(want) < 8)
}

#[test]
fn pixels_come_back() {
    let rgb = halves(64, 36);
    for style in [PngStyle::SMALL, PngStyle::FLAT, PngStyle::SMOOTH, PngStyle::FAST] {
        let file = encode_png([64, 36], &Pixels::Rgb(&rgb), style).expect("encodes");
        let image = decode_png(&file, Limits::SENSOR).expect("decodes");
        assert_eq!(image, RgbImage { width: 64, height: 36, rgb: rgb.clone() });
        assert_eq!(decode_any(&file, Limits::SENSOR).expect("decodes"), AnyImage { image, alpha: vec![] });
        let mut rows = PngRows::open(&file, Limits::SENSOR).expect("opens");
        let mut all = Vec::new();
        while let Some(row) = rows.next_row().expect("reads") {
            all.extend_from_slice(row);
        }
        assert_eq!((rows.size(), all), ([64, 36], rgb.clone()));
    }
    for chroma in [Chroma::Half, Chroma::ByQuality] {
        let file = encode_jpeg([64, 36], &rgb, 95, chroma).expect("encodes");
        let image = decode_jpeg(&file, Limits::SENSOR).expect("decodes");
        assert_eq!((image.width, image.height), (64, 36));
        assert!(is_near(&image, [8, 16], RED) && is_near(&image, [56, 16], BLUE));
        assert_eq!(jpeg_size(&file, Limits::SENSOR).expect("reads"), [64, 36]);
    }
}

#[test]
fn grey_and_palettes_are_expanded() {
    let grey = encode_png([3, 1], &Pixels::Grey(&[0, 9, 255]), PngStyle::FLAT).expect("encodes");
    let expected = AnyImage {
        image: RgbImage { width: 3, height: 1, rgb: vec![0, 0, 0, 9, 9, 9, 255, 255, 255] },
        alpha: vec![],
    };
    assert_eq!(decode_any(&grey, Limits::SENSOR).expect("decodes"), expected);
    let mut rows = Vec::new();
    write_grey_rows(&mut rows, [3, 2], PngStyle::FAST, |row, line| line[row as usize] = 7).expect("writes");
    let image = decode_any(&rows, Limits::SENSOR).expect("decodes").image;
    assert_eq!(image.rgb.chunks_exact(3).map(|p| p[0]).collect::<Vec<_>>(), [7, 0, 0, 0, 7, 0]);
    let palette = [[1, 2, 3], [4, 5, 6]].concat();
    let file = encode_png([2, 1], &Pixels::Indexed(&[1, 0], &palette), PngStyle::INDEXED).expect("encodes");
    let decoded = decode_any(&file, Limits::SENSOR).expect("decodes");
    assert_eq!((decoded.image.rgb, decoded.alpha), (vec![4, 5, 6, 1, 2, 3], vec![255, 0]));
}

#[test]
fn broken_large_and_other_files_are_errors() {
    let rgb = halves(64, 32);
    let jpeg = encode_jpeg([64, 32], &rgb, 80, Chroma::Half).expect("encodes");
    let png = encode_png([64, 32], &Pixels::Rgb(&rgb), PngStyle::SMALL).expect("encodes");
    for len in [0, 1, 10, 40] {
        assert!(decode_jpeg(&jpeg[..len], Limits::SENSOR).is_err(), "{len}");
        assert!(decode_png(&png[..len], Limits::SENSOR).is_err(), "{len}");
        assert!(decode_any(&png[..len], Limits::SENSOR).is_err(), "{len}");
    }
    assert!(decode_png(&png[..png.len() - 20], Limits::SENSOR).is_err());
    assert!(decode_png(&jpeg, Limits::SENSOR).is_err() && decode_jpeg(&png, Limits::SENSOR).is_err());
    let small = Limits::of_side(63);
    for refused in [decode_png(&png, small), decode_jpeg(&jpeg, small)] {
        let error = refused.expect_err("is too large");
        assert!(matches!(error, ImageError::Size { .. } | ImageError::Jpeg(_)), "{error}");
    }
    let grey = encode_png([3, 2], &Pixels::Grey(&[0; 6]), PngStyle::FLAT).expect("encodes");
    let error = png_size(&grey, Limits::SENSOR).expect_err("is grey");
    assert!(error.to_string().contains("expected red"), "{error}");
    assert!(encode_jpeg([70_000, 1], &[0; 210_000], 80, Chroma::Half).is_err());
    assert!(encode_png([3, 2], &Pixels::Rgb(&[0; 6]), PngStyle::FLAT).is_err());
}

#[test]
fn thumbnails_keep_shape_and_colours() {
    let jpeg = encode_jpeg([64, 36], &halves(64, 36), 95, Chroma::ByQuality).expect("encodes");
    let small = decode_jpeg(&shrink(&jpeg, 32, 95).expect("shrinks"), Limits::SENSOR).expect("decodes");
    assert_eq!((small.width, small.height), (32, 18));
    assert!(is_near(&small, [4, 9], RED) && is_near(&small, [28, 9], BLUE));
    assert!(shrink(&jpeg[..20], 32, 80).is_err() && shrink(&[], 32, 80).is_err());
}

#[test]
fn animations_show_their_frames() {
    let frames: Vec<Vec<u8>> =
        (0..4_u8).map(|i| [[10, 20, 30, 255], [i, 0, 0, 255], [7, 7, 7, 255]].concat()).collect();
    let mut file = Vec::new();
    let mut writer = AnimationWriter::new(&mut file, [3, 1], 4, 100).expect("begins");
    frames.iter().for_each(|frame| writer.push(frame.clone()).expect("fits"));
    writer.finish().expect("whole");
    let mut reader = png::Decoder::new(std::io::Cursor::new(&file)).read_info().expect("is a PNG");
    let mut shown = vec![0; 12];
    for frame in &frames {
        let mut next = vec![0; reader.output_buffer_size().expect("small")];
        reader.next_frame(&mut next).expect("is there");
        for (to, from) in
            shown.chunks_exact_mut(4).zip(next.chunks_exact(4)).filter(|(_, from)| from[3] == 255)
        {
            to.copy_from_slice(from);
        }
        assert_eq!(shown, *frame);
    }
}
