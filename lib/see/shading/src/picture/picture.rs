//! Colour pictures.

/// A colour picture: 8-bit sRGB, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue of each pixel.
    pub rgb: Vec<u8>,
    /// How many electrons a pixel of film value 1 has gathered: the fewer, the noisier.
    pub electrons: u32,
}
