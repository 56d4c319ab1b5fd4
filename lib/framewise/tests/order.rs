//! Frames in order, part by part, however many threads compute them.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use framewise::{Part, Taking, in_turn};
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

/// Some parts with numbers of their own.
fn parts(dues: &[&[u32]]) -> Vec<Result<Part<u32, u32>, StageError>> {
    let part = |(number, due): (u32, &&[u32])| Ok(Part { due: due.to_vec(), seen: number, writer: number });
    (0..).zip(dues).map(part).collect()
}

/// Later frames are ready first.
fn slow(frame: u32) -> Result<u32, StageError> {
    std::thread::sleep(Duration::from_millis(u64::from(9 - frame % 8)));
    Ok(frame)
}

/// What was taken: part and frame, or that the part was ended.
#[derive(Default)]
struct Taken(Vec<(u32, Option<u32>)>);

impl Taking<u32, u32> for &mut Taken {
    fn take(&mut self, part: &mut u32, frame: u32, result: u32) -> Result<(), StageError> {
        assert_eq!(frame, result);
        if (*part, frame) == (1, 7) {
            return Err("full").at(|| Place::scene(7).frame(frame));
        }
        self.0.push((*part, Some(frame)));
        Ok(())
    }

    fn finish(&mut self, part: u32) -> Result<(), StageError> {
        self.0.push((part, None));
        Ok(())
    }
}

#[test]
fn frames_are_taken_in_order() {
    let dues: [&[u32]; 4] = [&DUE, &[3, 4], &[], &[0]];
    let wanted: Vec<(u32, Option<u32>)> = (0..)
        .zip(dues)
        .flat_map(|(part, due)| due.iter().map(move |f| (part, Some(*f))).chain([(part, None)]))
        .collect();
    for threads in [None, Some(1), Some(3)] {
        on(threads, || {
            let mut taken = Taken::default();
            in_turn(parts(&dues), FRAMES, &progress(), |_, frame| slow(frame), &mut taken)
                .expect("nothing fails");
            assert_eq!(taken.0, wanted);
        });
    }
}

/// Counts what is taken.
struct Counting<'a>(&'a AtomicU32);

impl Taking<u32, u32> for Counting<'_> {
    fn take(&mut self, _: &mut u32, _: u32, _: u32) -> Result<(), StageError> {
        self.0.fetch_add(1, Ordering::SeqCst);
        Ok(())
    }

    fn finish(&mut self, _: u32) -> Result<(), StageError> {
        Ok(())
    }
}

#[test]
fn few_frames_are_in_hand() {
    for threads in [1, 2, 4] {
        let (begun, taken, most) = (AtomicU32::new(0), AtomicU32::new(0), AtomicU32::new(0));
        let work = |_: &u32, frame| {
            let in_hand = begun.fetch_add(1, Ordering::SeqCst) + 1 - taken.load(Ordering::SeqCst);
            most.fetch_max(in_hand, Ordering::SeqCst);
            slow(frame)
        };
        let all: Vec<u32> = (0..FRAMES / 3).collect();
        on(Some(threads), || {
            let three = [all.as_slice(), &all, &all];
            in_turn(parts(&three), FRAMES, &progress(), work, Counting(&taken)).expect("nothing fails");
        });
        assert_eq!(taken.into_inner(), FRAMES);
        // The one that is being taken is still in hand.
        let most = most.into_inner() as usize;
        assert!((threads.min(2)..=threads + 1).contains(&most), "{threads} threads: {most}");
    }
}

/// Lets the last frame of the first part be taken when a frame of the second has been begun.
struct Waiting<'a>(&'a Mutex<Receiver<()>>);

impl Taking<u32, u32> for Waiting<'_> {
    fn take(&mut self, _: &mut u32, _: u32, _: u32) -> Result<(), StageError> {
        Ok(())
    }

    fn finish(&mut self, part: u32) -> Result<(), StageError> {
        if part == 0 {
            let second_began = self.0.lock().expect("nobody panics").recv_timeout(Duration::from_secs(60));
            second_began.at(|| Place::scene(7))?;
        }
        Ok(())
    }
}

#[test]
fn the_next_part_is_begun_while_one_is_ended() {
    let (tell, begun) = channel();
    let work = |part: &u32, frame| {
        if *part == 1 {
            let _ = tell.send(());
        }
        slow(frame)
    };
    let begun = Mutex::new(begun);
    in_turn(parts(&[&[0, 1], &[0, 1]]), 2, &progress(), work, Waiting(&begun))
        .expect("none waits for the other");
}

#[test]
fn the_first_error_in_order_ends_it() {
    let broken = |part: &u32, frame: u32| match (part, frame) {
        (0, 8 | 30) => Err("broken").at(|| Place::scene(7).frame(frame)),
        _ => slow(frame),
    };
    let mut taken = Taken::default();
    let error = in_turn(parts(&[&DUE, &DUE]), FRAMES, &progress(), broken, &mut taken)
        .expect_err("frame 8 is broken");
    assert!(error.to_string().contains("frame 8"), "{error}");
    assert_eq!(taken.0, [0, 1, 7].map(|frame| (0, Some(frame))));

    // The second part's frame 7 is not taken.
    let mut taken = Taken::default();
    let error = in_turn(parts(&[&[5], &DUE]), FRAMES, &progress(), |_, f| slow(f), &mut taken)
        .expect_err("frame 7 is not taken");
    assert!(error.to_string().contains("frame 7"), "{error}");
    assert_eq!(taken.0, [(0, Some(5)), (0, None), (1, Some(0)), (1, Some(1))]);

    // What comes before a part that cannot be opened is taken.
    let mut taken = Taken::default();
    let mut all = parts(&[&[2, 3], &DUE]);
    all[1] = Err("shut").at(|| Place::scene(7).frame(44));
    let error = in_turn(all, FRAMES, &progress(), |_, f| slow(f), &mut taken).expect_err("is shut");
    assert!(error.to_string().contains("frame 44"), "{error}");
    assert_eq!(taken.0, [(0, Some(2)), (0, Some(3)), (0, None)]);
}

#[test]
fn a_panic_is_passed_on() {
    for threads in [None, Some(1), Some(2)] {
        let outcome = std::panic::catch_unwind(|| {
            on(threads, || {
                let panics = |_: &u32, frame| if frame == 7 { panic!("frame 7") } else { slow(frame) };
                let mut taken = Taken::default();
                let _ = in_turn(parts(&[&DUE]), FRAMES, &progress(), panics, &mut taken);
            });
        });
        assert!(outcome.is_err(), "{threads:?} threads");
    }
}
