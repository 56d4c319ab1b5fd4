//! Watches traffic and tells what is wrong with it: scenes on towns of our own and, where they are at hand,
//! on real maps, judged by their logs alone. `make traffic-report`.
//!
//! Arguments: names of maps (`convoy/03`, `Town03`) to look at only these; `--seeds N` for scenes per map, or
//! `--seeds 5-9` for those; `--seconds N` for scenes as long as that; `--faults` to list single faults;
//! `--dump FOLDER` to write every track as CSV, for drawing.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "it is a report")]

#[path = "../../tests/traffic/common/mod.rs"]
mod common;
mod film;
mod lights;
mod motion;
mod people;
mod published;
mod scenes;
mod standing;
mod things;
mod touching;

use std::io::Write;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::film::{Film, Snap};
use crate::people::{Moves, People};
use crate::scenes::{Plan, plans};

/// Everything measured of one scene.
struct Report {
    name: String,
    vehicles: usize,
    walkers: usize,
    touching: touching::Touching,
    lights: lights::Lights,
    motion: motion::Motion,
    people: people::People,
    standing: standing::Standing,
    inside: things::Things,
}

fn watch(plan: &Plan, dump: Option<&Path>) -> Report {
    let (map, fixed, log) = plan.simulate();
    let mut film = Film::new(&map, &log);
    if let Some(folder) = dump
        && let Err(fault) = write(&film, &folder.join(plan.name().replace(['/', ' '], "-") + ".csv"))
    {
        println!("{}: {fault}", folder.display());
    }
    let touching = touching::find(&mut film);
    let fixed: Vec<_> = fixed.iter().chain(log.actors.iter().filter(|a| a.fixed)).collect();
    Report {
        name: plan.name(),
        vehicles: film.vehicles.iter().filter(|b| b.towed_by.is_none()).count(),
        walkers: film.walkers.len(),
        touching,
        lights: lights::measure(&film),
        motion: motion::measure(&film),
        people: people::measure(&film),
        standing: standing::measure(&film),
        inside: things::measure(&film, &fixed),
    }
}

/// One line for each state of each body: id, length, width, state, x, y, yaw, speed; of the
/// objects in hazards one line.
fn write(film: &Film<'_>, path: &Path) -> std::io::Result<()> {
    let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
    let mut line = |id: u16, [length, width]: [f64; 2], i: usize, s: &Snap| {
        let ([x, y, _], yaw, speed) = (<[f64; 3]>::from(s.at), s.yaw_rad, s.speed_mps);
        writeln!(file, "{id},{length},{width},{i},{x:.3},{y:.3},{yaw:.4},{speed:.3}")
    };
    for body in film.vehicles.iter().chain(&film.walkers) {
        for (i, s) in body.track.iter().enumerate() {
            line(body.id, body.size_m, i, s)?;
        }
    }
    for thing in &film.obstacles {
        line(thing.id, thing.size_m, 0, &thing.snap)?;
    }
    file.flush()
}

/// The seeds meant by `4` (1 to 4) or `5-9`.
fn seeds_of(text: &str) -> Option<RangeInclusive<u64>> {
    match text.split_once('-') {
        Some((first, last)) => Some(first.parse().ok()?..=last.parse().ok()?),
        None => Some(1..=text.parse().ok()?),
    }
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let (mut seeds, mut faults, mut dump, mut wanted) = (1..=4, false, None, Vec::new());
    let mut duration_s = scenes::DURATION_S;
    while let Some(word) = arguments.next() {
        match word.as_str() {
            "--seeds" => {
                let range = arguments.next().as_deref().and_then(seeds_of);
                seeds = range.unwrap_or_else(|| {
                    eprintln!("--seeds wants a number of seeds, or the first and the last as 5-9");
                    std::process::exit(2)
                });
            }
            "--seconds" => {
                let seconds = arguments.next().and_then(|word| word.parse().ok());
                duration_s = seconds.filter(|s| (1.0..=3600.0).contains(s)).unwrap_or_else(|| {
                    eprintln!("--seconds wants a number of seconds from 1 to 3600");
                    std::process::exit(2)
                });
            }
            "--faults" => faults = true,
            "--dump" => dump = arguments.next().map(PathBuf::from),
            _ => wanted.push(word),
        }
    }
    let plans = plans(&wanted, &seeds, duration_s);
    let next = AtomicUsize::new(0);
    let reports: Vec<Mutex<Option<Report>>> = plans.iter().map(|_| Mutex::new(None)).collect();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads.min(plans.len()) {
            scope.spawn(|| {
                while let Some((plan, slot)) = {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    plans.get(i).zip(reports.get(i))
                } {
                    let report = watch(plan, dump.as_deref());
                    if let Ok(mut slot) = slot.lock() {
                        *slot = Some(report);
                    }
                }
            });
        }
    });
    let reports: Vec<Report> =
        reports.into_iter().filter_map(|slot| slot.into_inner().ok().flatten()).collect();
    print(&reports, faults);
}

/// The value below which a share of some values lies.
fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    values.get((share * last as f64).round() as usize).copied().unwrap_or(f64::NAN)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn print(reports: &[Report], faults: bool) {
    print_scenes(reports);
    print_counts(reports);
    print_motion(reports);
    print_people(reports);
    print_standing(reports);
    published::print(reports);
    if faults {
        reports.iter().for_each(print_faults);
    }
}

fn print_scenes(reports: &[Report]) {
    println!(
        "| scene | vehicles | walkers | collisions | with unruly | red runs | braking | offset | longest stand | gridlock | no reason |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for r in reports {
        let worst = |w: Option<(f64, usize, u16)>| w.map_or(0.0, |w| w.0);
        println!(
            "| {} | {} | {} | {} | {} | {} | {:.1} | {:.2} | {:.0} | {:.0} | {} |",
            r.name,
            r.vehicles,
            r.walkers,
            r.touching.ordinary.len() + r.touching.vehicle_walker.len() + r.touching.hazards.len(),
            r.touching.unruly,
            r.lights.red_runs.len(),
            worst(r.motion.worst_braking),
            worst(r.motion.worst_offset),
            worst(r.standing.longest),
            worst(r.standing.gridlock),
            r.standing.faults.len(),
        );
    }
}

/// What must not happen, how often it did in all scenes.
fn print_counts(reports: &[Report]) {
    let sum = |of: fn(&Report) -> usize| reports.iter().map(of).sum::<usize>();
    println!("\n| what | value |\n|---|---|");
    println!("| scenes | {} |", reports.len());
    println!("| collisions among ordinary drivers | {} |", sum(|r| r.touching.ordinary.len()));
    println!("| collisions with reckless, distracted or crashed ones | {} |", sum(|r| r.touching.unruly));
    println!("| ordinary drivers who touch a walker | {} |", sum(|r| r.touching.vehicle_walker.len()));
    println!("| ordinary drivers who touch a hazard or its people | {} |", sum(|r| r.touching.hazards.len()));
    println!("| walkers who touch a walker | {} |", sum(|r| r.touching.walker_walker));
    println!(
        "| walkers in a building, a parked car, a pole or another thing | {} |",
        sum(|r| r.inside.walkers.len())
    );
    println!("| ordinary drivers who touch such a thing | {} |", sum(|r| r.inside.vehicles.len()));
    println!(
        "| red-light runs of ordinary drivers (of {} passages) | {} |",
        sum(|r| r.lights.passages),
        sum(|r| r.lights.red_runs.len())
    );
    println!("| red-light runs of others | {} |", sum(|r| r.lights.unruly_runs));
}

/// How vehicles moved in all scenes.
fn print_motion(reports: &[Report]) {
    let all = |of: fn(&Report) -> &Vec<f64>| -> Vec<f64> { reports.iter().flat_map(of).copied().collect() };
    let mut a = all(|r| &r.motion.acceleration);
    let shares = [0.0, 0.001, 0.01, 0.99, 1.0].map(|s| format!("{:.2}", quantile(&mut a, s)));
    println!("| acceleration: least, 0.1 %, 1 %, 99 %, most, m/s2 | {} |", shares.join(", "));
    println!("| sideways acceleration, m/s2: {HIGH} | {} |", high(all(|r| &r.motion.sideways)));
    let jerk = all(|r| &r.motion.jerk).into_iter().map(f64::abs).collect();
    println!("| jerk over half a second, m/s3: {HIGH} | {} |", high(jerk));
    let mut v = all(|r| &r.motion.free_flow);
    println!(
        "| speed over limit in free flow: 5 %, mean, 95 % of {} | {:.2}, {:.2}, {:.2} |",
        v.len(),
        quantile(&mut v, 0.05),
        mean(&v),
        quantile(&mut v, 0.95)
    );
    let h = all(|r| &r.lights.headways_s);
    println!(
        "| saturation flow, vehicles per hour and lane (from {} gaps) | {:.0} |",
        h.len(),
        3600.0 / mean(&h)
    );
    let mut o = all(|r| &r.motion.offset_m);
    println!(
        "| offset from the lane: 99 %, 99.9 %, most, m | {:.2}, {:.2}, {:.2} |",
        quantile(&mut o, 0.99),
        quantile(&mut o, 0.999),
        quantile(&mut o, 1.0)
    );
    let mut s = all(|r| &r.motion.slide_mps);
    println!(
        "| sideways sliding of the rear axle: 99 %, 99.9 %, most, m/s | {:.2}, {:.2}, {:.2} |",
        quantile(&mut s, 0.99),
        quantile(&mut s, 0.999),
        quantile(&mut s, 1.0)
    );
    println!("| lane changes | {} |", reports.iter().map(|r| r.motion.lane_changes).sum::<usize>());
}

/// What [`high`] tells.
const HIGH: &str = "50 %, 99 %, 99.9 %, most";

/// The middle and the upper end of some values.
fn high(mut values: Vec<f64>) -> String {
    [0.5, 0.99, 0.999, 1.0].map(|s| format!("{:.2}", quantile(&mut values, s))).join(", ")
}

/// How people moved in all scenes.
fn print_people(reports: &[Report]) {
    type Kind = fn(&People) -> &Moves;
    let kinds: [(&str, Kind); 2] = [("on foot", |p| &p.on_foot), ("wheelchairs, prams", |p| &p.rolling)];
    for (name, kind) in kinds {
        let all = |of: fn(&Moves) -> &Vec<f64>| -> String {
            high(reports.iter().flat_map(|r| of(kind(&r.people))).copied().collect())
        };
        println!("| {name}: speed of those who walk, m/s: {HIGH} | {} |", all(|m| &m.speed_mps));
        println!(
            "| {name}: turning while standing, degrees/s: {HIGH} | {} |",
            all(|m| &m.turn_standing_degps)
        );
        println!("| {name}: turning while walking, degrees/s: {HIGH} | {} |", all(|m| &m.turn_walking_degps));
        println!("| {name}: acceleration, m/s2: {HIGH} | {} |", all(|m| &m.acceleration));
        println!("| {name}: acceleration upwards, m/s2: {HIGH} | {} |", all(|m| &m.upwards));
        println!("| {name}: share of the speed that is sideways: {HIGH} | {} |", all(|m| &m.aside));
    }
}

/// Why vehicles stood in all scenes.
fn print_standing(reports: &[Report]) {
    let mut reasons = std::collections::BTreeMap::new();
    for (name, count) in reports.iter().flat_map(|r| &r.standing.reasons) {
        *reasons.entry(*name).or_insert(0) += count;
    }
    let total: usize = reasons.values().sum();
    for (name, count) in &reasons {
        println!("| standing: {name} | {:.1} % |", 100.0 * *count as f64 / total.max(1) as f64);
    }
}

/// The single faults of a scene.
fn print_faults(r: &Report) {
    println!(
        "{}: collisions {:?}, walkers {:?}, hazards {:?}, red {:?}",
        r.name, r.touching.ordinary, r.touching.vehicle_walker, r.touching.hazards, r.lights.red_runs
    );
    println!("  walkers in things {:?}, drivers {:?}", r.inside.walkers, r.inside.vehicles);
    println!("  braking {:?}, offset {:?}", r.motion.worst_braking, r.motion.worst_offset);
    println!("  sideways {:?}", r.motion.worst_sideways);
    for moves in [&r.people.on_foot, &r.people.rolling] {
        println!("  acceleration {:?}, turn {:?}", moves.worst_acceleration, moves.worst_turn);
    }
    println!("  longest {:?}, gridlock {:?}", r.standing.longest, r.standing.gridlock);
    let mut ids: Vec<(u16, usize)> = r.standing.faults.iter().map(|(i, id)| (*id, *i)).collect();
    ids.sort_unstable();
    for chunk in ids.chunk_by(|a, b| a.0 == b.0) {
        println!(
            "  no reason: {} from {} to {} ({})",
            chunk[0].0,
            chunk[0].1,
            chunk[chunk.len() - 1].1,
            chunk.len()
        );
    }
}
