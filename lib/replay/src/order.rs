//! Frames computed in parallel, handed over in order.

use formats::{EncodedMember, NpzError, NpzWriter};
use pipeline::{Place, Progress, StageError};
use rayon::prelude::*;
use store::{StoreError, Unit};

/// Computes `frame` for `0..frames` on all threads and hands the results to `take` in frame order. At most as
/// many results as there are threads are held at a time, so memory stays bounded; the result does not depend on
/// the number of threads.
///
/// # Errors
/// The first error in frame order, from either function, or a wish to stop.
pub fn in_frame_order<T: Send>(
    frames: u32,
    progress: &Progress,
    frame: impl Fn(u32) -> Result<T, StageError> + Sync,
    mut take: impl FnMut(u32, T) -> Result<(), StageError>,
) -> Result<(), StageError> {
    let batch = rayon::current_num_threads().max(1) as u32;
    let mut start = 0;
    while start < frames {
        let end = frames.min(start + batch);
        let results: Vec<Result<T, StageError>> = (start..end).into_par_iter().map(&frame).collect();
        for (number, result) in (start..end).zip(results) {
            take(number, result?)?;
            progress.advance(1)?;
        }
        start = end;
    }
    Ok(())
}

/// Computes one array per frame like [`in_frame_order`] and writes them as one archive among a unit's files. `take` gets
/// what else `frame` found.
///
/// # Errors
/// As [`in_frame_order`], or the archive cannot be written.
pub fn archive_frames<T: Send>(
    unit: &mut Unit<'_>,
    key: &str,
    frames: u32,
    progress: &Progress,
    frame: impl Fn(u32) -> Result<(EncodedMember, T), StageError> + Sync,
    mut take: impl FnMut(T),
) -> Result<(), StageError> {
    let file = unit.file(key)?;
    let location = file.location().to_owned();
    let failed = |frame: Option<u32>, error: NpzError| match error {
        NpzError::Io(source) => StoreError::write(&location, "write", source).into(),
        refused => StageError::Failed {
            place: Box::new(Place { frame, ..Place::file(&location) }),
            source: refused.into(),
        },
    };
    let mut writer = NpzWriter::new(file);
    in_frame_order(frames, progress, frame, |number, (member, found)| {
        take(found);
        writer.append(member).map_err(|e| failed(Some(number), e))
    })?;
    let file = writer.finish().map_err(|e| failed(None, e))?;
    unit.add(file.finish(frames.into())?);
    Ok(())
}
