//! Frames in order, however many threads compute them.

use std::sync::atomic::{AtomicU32, Ordering};

use framewise::in_frame_order;
use pipeline::{At, Place, Progress, ProgressMode, StageError};
use rayon::ThreadPoolBuilder;

const FRAMES: u32 = 60;
const DUE: [u32; 6] = [0, 1, 7, 8, 30, 59];

/// Runs `work` on a pool of so many threads, or beside the common pool, as programs do.
fn on(threads: Option<usize>, work: impl FnOnce() + Send) {
    match threads {
        None => work(),
        Some(n) => ThreadPoolBuilder::new().num_threads(n).build().expect("threads").install(work),
    }
}

fn progress() -> Progress {
    Progress::start(ProgressMode::None, "test".into(), 0)
}

/// Later frames are ready first.
fn slow(frame: u32) -> Result<u32, StageError> {
    std::thread::sleep(std::time::Duration::from_millis(u64::from(9 - frame % 8)));
    Ok(frame)
}

#[test]
fn frames_are_taken_in_order() {
    for threads in [None, Some(1), Some(3)] {
        on(threads, || {
            let mut taken = Vec::new();
            let take = |frame, result| {
                taken.push([frame, result]);
                Ok(())
            };
            in_frame_order((&DUE, FRAMES), &progress(), slow, take).expect("nothing fails");
            assert_eq!(taken, DUE.map(|frame| [frame; 2]));
        });
    }
}

#[test]
fn few_frames_are_in_hand() {
    for threads in [1, 2, 4] {
        let (begun, taken, most) = (AtomicU32::new(0), AtomicU32::new(0), AtomicU32::new(0));
        let work = |frame| {
            let in_hand = begun.fetch_add(1, Ordering::SeqCst) + 1 - taken.load(Ordering::SeqCst);
            most.fetch_max(in_hand, Ordering::SeqCst);
            slow(frame)
        };
        let take = |_, _| {
            taken.fetch_add(1, Ordering::SeqCst);
            Ok(())
        };
        let all: Vec<u32> = (0..FRAMES).collect();
        on(Some(threads), || {
            in_frame_order((&all, FRAMES), &progress(), work, take).expect("nothing fails");
        });
        assert_eq!(taken.into_inner(), FRAMES);
        // The one that is being taken is still in hand.
        let most = most.into_inner() as usize;
        assert!((threads.min(2)..=threads + 1).contains(&most), "{threads} threads: {most}");
    }
}

#[test]
fn the_first_error_in_order_ends_it() {
    let broken = |frame: u32| match frame {
        8 | 30 => Err("broken").at(|| Place::scene(7).frame(frame)),
        _ => slow(frame),
    };
    let mut taken = Vec::new();
    let take = |frame, _| {
        taken.push(frame);
        Ok(())
    };
    let error = in_frame_order((&DUE, FRAMES), &progress(), broken, take).expect_err("frame 8 is broken");
    assert!(error.to_string().contains("frame 8"), "{error}");
    assert_eq!(taken, [0, 1, 7]);

    let full = |frame: u32, _: u32| match frame {
        7 => Err("full").at(|| Place::scene(7).frame(frame)),
        _ => Ok(()),
    };
    let error = in_frame_order((&DUE, FRAMES), &progress(), slow, full).expect_err("frame 7 is not taken");
    assert!(error.to_string().contains("frame 7"), "{error}");
}

#[test]
fn a_panic_is_passed_on() {
    for threads in [None, Some(1), Some(2)] {
        let outcome = std::panic::catch_unwind(|| {
            on(threads, || {
                let panics = |frame: u32| if frame == 7 { panic!("frame 7") } else { slow(frame) };
                let _ = in_frame_order((&DUE, FRAMES), &progress(), panics, |_, _| Ok(()));
            });
        });
        assert!(outcome.is_err(), "{threads:?} threads");
    }
}
