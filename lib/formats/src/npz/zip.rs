//! The records of a zip file (PKWARE APPNOTE 6.3), as far as numpy archives use them.

/// Local file header, before each member's data.
pub(super) const LOCAL: u32 = 0x0403_4b50;
/// One entry of the central directory.
pub(super) const CENTRAL: u32 = 0x0201_4b50;
/// End of central directory, the last record.
pub(super) const END: u32 = 0x0605_4b50;
/// Its 64-bit version, which stands before it when numbers are too large.
pub(super) const END64: u32 = 0x0606_4b50;
/// Where the 64-bit version is.
pub(super) const LOCATOR64: u32 = 0x0706_4b50;

/// Length of [`LOCAL`] without name and extra field.
pub(super) const LOCAL_LEN: usize = 30;
/// Length of [`CENTRAL`] without name, extra field and comment.
pub(super) const CENTRAL_LEN: usize = 46;
/// Length of [`END`] without comment.
pub(super) const END_LEN: usize = 22;
/// Length of [`END64`].
pub(super) const END64_LEN: usize = 56;
/// Length of [`LOCATOR64`].
pub(super) const LOCATOR64_LEN: usize = 20;

/// Stored without compression.
pub(super) const STORED: u16 = 0;
/// DEFLATE.
pub(super) const DEFLATED: u16 = 8;

/// Id of the extra field with 64-bit sizes.
pub(super) const EXTRA64: u16 = 1;
/// The 1st of January 1980 (year from 1980 in the upper 7 bits, month, day): zip's earliest day, on every
/// member, so that bytes depend on data alone.
pub(super) const DATE: u16 = (1 << 5) | 1;

/// Appends little-endian numbers.
#[derive(Default)]
pub(super) struct Record(pub(super) Vec<u8>);

impl Record {
    pub(super) fn u16(mut self, value: u16) -> Self {
        self.0.extend_from_slice(&value.to_le_bytes());
        self
    }

    pub(super) fn u32(mut self, value: u32) -> Self {
        self.0.extend_from_slice(&value.to_le_bytes());
        self
    }

    pub(super) fn u64(mut self, value: u64) -> Self {
        self.0.extend_from_slice(&value.to_le_bytes());
        self
    }

    pub(super) fn bytes(mut self, bytes: &[u8]) -> Self {
        self.0.extend_from_slice(bytes);
        self
    }
}

/// Takes little-endian numbers off a slice; `None` at its end.
pub(super) struct Fields<'a>(pub(super) &'a [u8]);

impl<'a> Fields<'a> {
    pub(super) fn bytes(&mut self, len: usize) -> Option<&'a [u8]> {
        let (head, rest) = self.0.split_at_checked(len)?;
        self.0 = rest;
        Some(head)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*head)
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }
}
