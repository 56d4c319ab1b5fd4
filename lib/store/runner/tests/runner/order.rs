//! Frames in order, part by part, however many threads compute them.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use rayon::ThreadPoolBuilder;
use runner::frames::{FrameGroup, Writer, in_turn};
use runner::{At, Place, Progress, ProgressMode, StageError};

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

/// What was taken: part and frame, or that the part was ended.
type Taken = Mutex<Vec<(u32, Option<u32>)>>;

/// Writes down what it takes of a part.
struct Notes<'a> {
    part: u32,
    taken: &'a Taken,
}

impl Writer<u32> for Notes<'_> {
    fn take(&mut self, frame: u32, result: u32) -> Result<(), StageError> {
        assert_eq!(frame, result);
        if (self.part, frame) == (1, 7) {
            return Err("full").at(|| Place::scene(7).frame(frame));
        }
        self.taken.lock().expect("nobody panics").push((self.part, Some(frame)));
        Ok(())
    }

    fn finish(self) -> Result<(), StageError> {
        self.taken.lock().expect("nobody panics").push((self.part, None));
        Ok(())
    }
}

/// Parts with numbers, and what takes them.
fn parts<W>(dues: &[&[u32]], writer: impl Fn(u32) -> W) -> Vec<Result<FrameGroup<u32, W>, StageError>> {
    let part = |(number, due): (u32, &&[u32])| {
        Ok(FrameGroup { due: due.to_vec(), seen: number, writer: writer(number) })
    };
    (0..).zip(dues).map(part).collect()
}

/// Later frames are ready first.
fn slow(frame: u32) -> Result<u32, StageError> {
    std::thread::sleep(Duration::from_millis(u64::from(9 - frame % 8)));
    Ok(frame)
}

#[test]
fn frames_are_taken_in_order() {
    let dues: [&[u32]; 4] = [&DUE, &[3, 4], &[], &[0]];
    for threads in [None, Some(1), Some(3)] {
        on(threads, || {
            let taken = Taken::default();
            let all = parts(&dues, |part| Notes { part, taken: &taken });
            in_turn(all, FRAMES, &progress(), |_, frame| slow(frame)).expect("nothing fails");
            let taken = taken.into_inner().expect("nobody panics");
            let frames: Vec<_> = taken.iter().filter_map(|(part, frame)| Some((*part, (*frame)?))).collect();
            let wanted = (0..).zip(dues).flat_map(|(part, due)| due.iter().map(move |frame| (part, *frame)));
            assert!(frames.into_iter().eq(wanted));
            // Parts are ended in their order, each when it is whole.
            let ended: Vec<_> = taken.iter().filter(|(_, frame)| frame.is_none()).map(|t| t.0).collect();
            assert_eq!(ended, [0, 1, 2, 3]);
            for (at, (part, _)) in taken.iter().enumerate().filter(|(_, (_, frame))| frame.is_none()) {
                assert!(taken[at + 1..].iter().all(|(later, _)| later > part), "{taken:?}");
            }
        });
    }
}

/// Counts what is taken.
struct Counting<'a>(&'a AtomicU32);

impl Writer<u32> for Counting<'_> {
    fn take(&mut self, _: u32, _: u32) -> Result<(), StageError> {
        self.0.fetch_add(1, Ordering::SeqCst);
        Ok(())
    }

    fn finish(self) -> Result<(), StageError> {
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
            let three = parts(&[all.as_slice(), &all, &all], |_| Counting(&taken));
            in_turn(three, FRAMES, &progress(), work).expect("nothing fails");
        });
        assert_eq!(taken.into_inner(), FRAMES);
        // The one that is being taken is still in hand.
        let most = most.into_inner() as usize;
        assert!((threads.min(2)..=threads + 2).contains(&most), "{threads} threads: {most}");
    }
}

/// Counts how many like it are open.
struct Open<'a>(&'a AtomicU32);

impl Writer<u32> for Open<'_> {
    fn take(&mut self, _: u32, _: u32) -> Result<(), StageError> {
        Ok(())
    }

    fn finish(self) -> Result<(), StageError> {
        self.0.fetch_sub(1, Ordering::SeqCst);
        Ok(())
    }
}

#[test]
fn few_parts_are_open() {
    for due in [vec![], vec![0]] {
        let (open, most) = (AtomicU32::new(0), AtomicU32::new(0));
        let part = |seen: u32| {
            most.fetch_max(open.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
            Ok(FrameGroup { due: due.clone(), seen, writer: Open(&open) })
        };
        in_turn((0..50).map(part), 1, &progress(), |_, frame| slow(frame)).expect("nothing fails");
        // Three that wait or are being taken from, and one that is being ended.
        assert_eq!(open.into_inner(), 0);
        assert!((1..=4).contains(&most.into_inner()), "{due:?}");
    }
}

/// Does not end its first part before the second one's last frame was taken.
struct Waiting<'a> {
    part: u32,
    all_taken: &'a (Sender<()>, Mutex<Receiver<()>>),
}

impl Writer<u32> for Waiting<'_> {
    fn take(&mut self, frame: u32, _: u32) -> Result<(), StageError> {
        if (self.part, frame) == (1, 9) {
            self.all_taken.0.send(()).at(|| Place::scene(7))?;
        }
        Ok(())
    }

    fn finish(self) -> Result<(), StageError> {
        if self.part == 0 {
            let told = self.all_taken.1.lock().expect("nobody panics");
            told.recv_timeout(Duration::from_secs(60)).at(|| Place::scene(7))?;
        }
        Ok(())
    }
}

#[test]
fn nobody_waits_for_the_end_of_a_part() {
    let (tell, told) = channel();
    let all_taken = (tell, Mutex::new(told));
    let all: Vec<u32> = (0..10).collect();
    let two = parts(&[&all, &all], |part| Waiting { part, all_taken: &all_taken });
    in_turn(two, 10, &progress(), |_, frame| slow(frame)).expect("the second part's frames are taken");
}

#[test]
fn the_first_error_in_order_ends_it() {
    let run = |dues: &[&[u32]], shut: bool, work: &(dyn Fn(u32, u32) -> Result<u32, StageError> + Sync)| {
        let taken = Taken::default();
        let mut all = parts(dues, |part| Notes { part, taken: &taken });
        if shut {
            all[1] = Err("shut").at(|| Place::scene(7).frame(44));
        }
        let error = in_turn(all, FRAMES, &progress(), |part, frame| work(*part, frame)).expect_err("fails");
        (error.to_string(), taken.into_inner().expect("nobody panics"))
    };
    let broken = |part, frame| match (part, frame) {
        (0, 8 | 30) => Err("broken").at(|| Place::scene(7).frame(frame)),
        _ => slow(frame),
    };
    let (error, taken) = run(&[&DUE, &DUE], false, &broken);
    assert!(error.contains("frame 8"), "{error}");
    assert_eq!(taken, [0, 1, 7].map(|frame| (0, Some(frame))));

    // The second part's frame 7 is not taken; the first part is ended all the same.
    let (error, mut taken) = run(&[&[5], &DUE], false, &|_, frame| slow(frame));
    assert!(error.contains("frame 7"), "{error}");
    taken.sort_unstable();
    assert_eq!(taken, [(0, None), (0, Some(5)), (1, Some(0)), (1, Some(1))]);

    // What comes before a part that cannot be opened is taken.
    let (error, taken) = run(&[&[2, 3], &DUE], true, &|_, frame| slow(frame));
    assert!(error.contains("frame 44"), "{error}");
    assert_eq!(taken, [(0, Some(2)), (0, Some(3)), (0, None)]);
}

/// Cannot be ended.
struct Endless(u32);

impl Writer<u32> for Endless {
    fn take(&mut self, frame: u32, _: u32) -> Result<(), StageError> {
        if self.0 == 1 && frame == 7 { Err("full").at(|| Place::scene(7).frame(frame)) } else { Ok(()) }
    }

    fn finish(self) -> Result<(), StageError> {
        std::thread::sleep(Duration::from_millis(50));
        Err("no room").at(|| Place::scene(7).frame(self.0))
    }
}

#[test]
fn an_error_at_the_end_of_a_part_comes_before_those_of_the_next() {
    for dues in [vec![&DUE[..]], vec![&DUE[..], &DUE[..]], vec![&[], &[7]]] {
        let error =
            in_turn(parts(&dues, Endless), FRAMES, &progress(), |_, frame| slow(frame)).expect_err("fails");
        assert!(error.to_string().contains("frame 0: no room"), "{error}");
    }
}

#[test]
fn a_panic_is_passed_on() {
    for threads in [None, Some(1), Some(2)] {
        let outcome = std::panic::catch_unwind(|| {
            on(threads, || {
                let panics = |_: &u32, frame| if frame == 7 { panic!("frame 7") } else { slow(frame) };
                let _ = in_turn(parts(&[&DUE], Endless), FRAMES, &progress(), panics);
            });
        });
        assert!(outcome.is_err(), "{threads:?} threads");
    }
}
