//! Animated PNG files.

use std::io::Write;

use super::error::ImageError;

/// Writes frames of one size as an animated PNG: each says only what differs from the one before.
pub struct AnimationWriter<W: Write> {
    writer: png::Writer<W>,
    last: Vec<u8>,
}

impl<W: Write> AnimationWriter<W> {
    /// Begins a file for so many frames, each shown for `millis` milliseconds.
    ///
    /// # Errors
    /// The file cannot be written, or there are no frames.
    pub fn new(file: W, size_px: [u32; 2], frames: u32, millis: u16) -> Result<Self, ImageError> {
        let mut encoder = png::Encoder::new(file, size_px[0], size_px[1]);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_animated(frames, 0)?;
        encoder.set_frame_delay(millis, 1000)?;
        encoder.set_blend_op(png::BlendOp::Over)?;
        encoder.set_dispose_op(png::DisposeOp::None)?;
        Ok(Self { writer: encoder.write_header()?, last: Vec::new() })
    }

    /// Adds a frame: red, green, blue and opacity, a byte each.
    ///
    /// # Errors
    /// The file cannot be written, or the frame has another size.
    pub fn push(&mut self, frame: Vec<u8>) -> Result<(), ImageError> {
        let mut changed = frame.clone();
        for (now, before) in changed.chunks_exact_mut(4).zip(self.last.chunks_exact(4)) {
            if now == before {
                now.fill(0);
            }
        }
        self.writer.write_image_data(&changed)?;
        self.last = frame;
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// The file cannot be written, or frames are missing.
    pub fn finish(self) -> Result<(), ImageError> {
        Ok(self.writer.finish()?)
    }
}
