//! The merged list and the tracks against the agents' lists.

use std::collections::BTreeMap;

use schema::DetectionClass;

use super::boxes::Labelled;
use super::counts::difficulty;
use crate::files::{Table, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::Scene;
use crate::space::{V3, apart, within};

/// Greatest difference of lengths and speeds that are added up, m and m/s.
const SUM: f64 = 1e-4;
/// Frames with fewer valid objects of a class are told apart in the report.
const FEW_OBJECTS: u64 = 5;

/// An object at a frame, from the lists of all agents.
pub(crate) struct Merged {
    pub(crate) class: DetectionClass,
    pub(crate) center_m: V3,
    speed_mps: f64,
    lidar: u64,
    radar: u64,
    /// Agents that saw it.
    pub(crate) seen_by: Vec<String>,
}

/// All objects by frame and id.
pub(crate) type Merges = BTreeMap<(i64, u16), Merged>;

/// A track as it adds up.
struct Track {
    class: DetectionClass,
    first: i64,
    last: i64,
    frames: i64,
    valid_frames: i64,
    points: [u64; 2],
    path_m: f64,
    max_speed_mps: f64,
    last_center_m: V3,
    seen_by: Vec<String>,
}

/// Boxes of all agents, by frame.
pub(crate) type Lists = BTreeMap<String, Vec<Vec<Labelled>>>;

/// Names of agents in order: vehicles by number, then RSUs.
fn rank(name: &str) -> (bool, u32) {
    let (kind, number) = name.split_once('_').unwrap_or((name, ""));
    (kind != "vehicle", number.parse().unwrap_or(u32::MAX))
}

fn merge(lists: &Lists) -> Merges {
    let mut names: Vec<&String> = lists.keys().collect();
    names.sort_by_key(|name| rank(name));
    let mut merged = BTreeMap::new();
    for name in names {
        for (frame, list) in lists[name].iter().enumerate() {
            for labelled in list {
                let object: &mut Merged =
                    merged.entry((frame as i64, labelled.id)).or_insert_with(|| Merged {
                        class: labelled.class,
                        center_m: labelled.center_m,
                        speed_mps: labelled.speed_mps,
                        lidar: 0,
                        radar: 0,
                        seen_by: Vec::new(),
                    });
                let Some(seen) = &labelled.seen else { continue };
                object.lidar += seen.lidar;
                object.radar += seen.radar;
                if seen.valid {
                    object.seen_by.push(name.clone());
                }
            }
        }
    }
    merged
}

/// Checks the merged tables of a scene, and counts what the report tells; all objects by frame.
///
/// `every`: there are boxes at frames 0, n, 2 n, ...: n.
pub(crate) fn check(scene: &Scene, lists: &Lists, every: u32, ledger: &mut Ledger) -> Merges {
    let merged = merge(lists);
    count(scene, &merged, every, ledger);
    if !scene.done.contains("merge-tracks") {
        ledger.skip(Rule::Tracks, "boxes are not merged yet");
        return merged;
    }
    let checked = check_frames(scene, &merged, ledger)
        .and_then(|()| check_tracks(scene, &merged, every, ledger))
        .and_then(|()| check_agents(scene, lists, every, ledger));
    ledger.read(checked);
    merged
}

fn count(scene: &Scene, merged: &Merges, every: u32, ledger: &mut Ledger) {
    let mut per_frame = vec![[0_u64; DetectionClass::ALL.len()]; scene.frames as usize];
    for ((frame, _), object) in merged {
        let is_valid = !object.seen_by.is_empty();
        let [all, valid, _] = &mut ledger.shares.boxes[object.class as usize];
        *all += 1;
        *valid += u64::from(is_valid);
        if let Some(frame) = usize::try_from(*frame).ok().and_then(|at| per_frame.get_mut(at)) {
            frame[object.class as usize] += u64::from(is_valid);
        }
    }
    ledger.shares.frames += u64::from(scene.frames.div_ceil(every));
    for frame in per_frame.into_iter().step_by(every as usize) {
        for (class, valid) in frame.into_iter().enumerate() {
            ledger.shares.boxes[class][2] += u64::from(valid < FEW_OBJECTS);
        }
    }
}

fn check_frames(scene: &Scene, merged: &Merges, ledger: &mut Ledger) -> Result<(), Unreadable> {
    let mut rows_found = 0;
    for rows in Table::open(&scene.file("tracks_frames.parquet"))?.batches()? {
        let (frames, ids, classes) = (rows.ints("frame")?, rows.ints("id")?, rows.texts("class")?);
        let centers = rows.vectors::<3>("center_m")?;
        let (lidar, radar) = (rows.ints("num_lidar_pts")?, rows.ints("num_radar_pts")?);
        let (valid, difficulties) = (rows.flags("valid_flag")?, rows.texts("difficulty")?);
        let seen_by = rows.text_lists("seen_by")?;
        for k in 0..rows.len() {
            rows_found += 1;
            let (frame, id) = (frames[k], u16::try_from(ids[k]).unwrap_or(0));
            let Some(object) = merged.get(&(frame, id)) else {
                ledger.off(Rule::Tracks, || {
                    format!("tracks_frames: frame {frame}: no agent lists object {id}")
                });
                continue;
            };
            let points = object.lidar + object.radar;
            let wrong = [
                ("class", classes[k] == object.class.name()),
                ("centre", within(apart(centers[k], object.center_m), SUM)),
                ("num_lidar_pts", lidar[k] == object.lidar as i64),
                ("num_radar_pts", radar[k] == object.radar as i64),
                ("valid_flag", valid[k] != object.seen_by.is_empty()),
                ("difficulty", difficulties[k] == difficulty(object.class, 0.0, points)),
                ("seen_by", seen_by[k] == object.seen_by),
            ];
            let wrong = wrong.into_iter().find(|(_, same)| !same);
            ledger.expect(Rule::Tracks, wrong.is_none(), || {
                format!(
                    "tracks_frames: frame {frame}: {} of object {id} is not the agents'",
                    wrong.map_or("", |w| w.0)
                )
            });
        }
    }
    ledger.expect(Rule::Tracks, rows_found == merged.len(), || {
        format!("tracks_frames: has {rows_found} rows, the agents list {} objects and frames", merged.len())
    });
    Ok(())
}

fn tracks_of(merged: &Merges, every: u32) -> BTreeMap<u16, Track> {
    let mut tracks: BTreeMap<u16, Track> = BTreeMap::new();
    for (&(frame, id), object) in merged {
        let track = tracks.entry(id).or_insert_with(|| Track {
            class: object.class,
            first: frame,
            last: frame,
            frames: 0,
            valid_frames: 0,
            points: [0; 2],
            path_m: 0.0,
            max_speed_mps: 0.0,
            last_center_m: object.center_m,
            seen_by: Vec::new(),
        });
        if track.frames > 0 && frame == track.last + i64::from(every) {
            track.path_m += apart(object.center_m, track.last_center_m);
        }
        (track.last, track.last_center_m) = (frame, object.center_m);
        track.frames += 1;
        track.valid_frames += i64::from(!object.seen_by.is_empty());
        track.points = [track.points[0] + object.lidar, track.points[1] + object.radar];
        track.max_speed_mps = track.max_speed_mps.max(object.speed_mps);
        track.seen_by.extend(object.seen_by.iter().cloned());
        track.seen_by.sort_by_key(|name| rank(name));
        track.seen_by.dedup();
    }
    tracks
}

fn check_tracks(scene: &Scene, merged: &Merges, every: u32, ledger: &mut Ledger) -> Result<(), Unreadable> {
    let tracks = tracks_of(merged, every);
    let mut rows_found = 0;
    for rows in Table::open(&scene.file("tracks.parquet"))?.batches()? {
        let (ids, classes) = (rows.ints("id")?, rows.texts("class")?);
        let (first, last, frames) =
            (rows.ints("first_frame")?, rows.ints("last_frame")?, rows.ints("frames")?);
        let valid = rows.ints("valid_frames")?;
        let (lidar, radar) = (rows.ints("num_lidar_pts")?, rows.ints("num_radar_pts")?);
        let (paths, speeds) = (rows.reals("path_m")?, rows.reals("max_speed_mps")?);
        let seen_by = rows.text_lists("seen_by")?;
        for k in 0..rows.len() {
            rows_found += 1;
            let id = u16::try_from(ids[k]).unwrap_or(0);
            let Some(track) = tracks.get(&id) else {
                ledger.off(Rule::Tracks, || format!("tracks: no agent lists object {id}"));
                continue;
            };
            let wrong = [
                ("class", classes[k] == track.class.name()),
                ("first_frame", first[k] == track.first),
                ("last_frame", last[k] == track.last),
                ("frames", frames[k] == track.frames),
                ("valid_frames", valid[k] == track.valid_frames),
                ("num_lidar_pts", lidar[k] == track.points[0] as i64),
                ("num_radar_pts", radar[k] == track.points[1] as i64),
                ("path_m", within(paths[k] - track.path_m, SUM * track.frames as f64)),
                ("max_speed_mps", within(speeds[k] - track.max_speed_mps, SUM)),
                ("seen_by", seen_by[k] == track.seen_by),
            ];
            let wrong = wrong.into_iter().find(|(_, same)| !same);
            ledger.expect(Rule::Tracks, wrong.is_none(), || {
                format!("tracks: {} of object {id} is not that of its frames", wrong.map_or("", |w| w.0))
            });
        }
    }
    ledger.expect(Rule::Tracks, rows_found == tracks.len(), || {
        format!("tracks: has {rows_found} rows, the agents list {} objects", tracks.len())
    });
    Ok(())
}

/// An object in the lists of one agent.
struct Sighted {
    first: i64,
    last: i64,
    frames: i64,
    /// First and last frames of the spans in which it was seen.
    seen: Vec<[i64; 2]>,
    points: [u64; 2],
    nearest_m: f64,
}

/// Objects by id and agent, from the agents' lists.
fn sighted(lists: &Lists, every: u32) -> BTreeMap<(u16, &str), Sighted> {
    let mut found: BTreeMap<(u16, &str), Sighted> = BTreeMap::new();
    for (name, frames) in lists {
        for (frame, list) in (0..).zip(frames) {
            for labelled in list {
                let sighted = found.entry((labelled.id, name)).or_insert_with(|| Sighted {
                    first: frame,
                    last: frame,
                    frames: 0,
                    seen: Vec::new(),
                    points: [0; 2],
                    nearest_m: f64::INFINITY,
                });
                sighted.last = frame;
                sighted.frames += 1;
                sighted.nearest_m = sighted.nearest_m.min(labelled.distance_m);
                let Some(seen) = &labelled.seen else { continue };
                sighted.points = [sighted.points[0] + seen.lidar, sighted.points[1] + seen.radar];
                if !seen.valid {
                    continue;
                }
                match sighted.seen.last_mut().filter(|span| span[1] + i64::from(every) == frame) {
                    Some(span) => span[1] = frame,
                    None => sighted.seen.push([frame; 2]),
                }
            }
        }
    }
    found
}

fn check_agents(scene: &Scene, lists: &Lists, every: u32, ledger: &mut Ledger) -> Result<(), Unreadable> {
    let sighted = sighted(lists, every);
    let mut rows_found = 0;
    for rows in Table::open(&scene.file("tracks_agents.parquet"))?.batches()? {
        let (ids, agents) = (rows.ints("id")?, rows.texts("agent")?);
        let (first, last, frames) =
            (rows.ints("first_frame")?, rows.ints("last_frame")?, rows.ints("frames")?);
        let (from, to) = (rows.int_lists("seen_from")?, rows.int_lists("seen_to")?);
        let (lidar, radar) = (rows.ints("num_lidar_pts")?, rows.ints("num_radar_pts")?);
        let nearest = rows.reals("min_distance_m")?;
        for k in 0..rows.len() {
            rows_found += 1;
            let (id, agent) = (u16::try_from(ids[k]).unwrap_or(0), agents[k].as_str());
            let Some(object) = sighted.get(&(id, agent)) else {
                ledger.off(Rule::Tracks, || format!("tracks_agents: {agent} never lists object {id}"));
                continue;
            };
            let ends = |end: usize| object.seen.iter().map(|span| span[end]).collect::<Vec<_>>();
            let wrong = [
                ("first_frame", first[k] == object.first),
                ("last_frame", last[k] == object.last),
                ("frames", frames[k] == object.frames),
                ("seen_from", from[k] == ends(0)),
                ("seen_to", to[k] == ends(1)),
                ("num_lidar_pts", lidar[k] == object.points[0] as i64),
                ("num_radar_pts", radar[k] == object.points[1] as i64),
                ("min_distance_m", within(nearest[k] - object.nearest_m, SUM)),
            ];
            let wrong = wrong.into_iter().find(|(_, same)| !same);
            ledger.expect(Rule::Tracks, wrong.is_none(), || {
                format!(
                    "tracks_agents: {} of object {id} is not that of {agent}'s list",
                    wrong.map_or("", |w| w.0)
                )
            });
        }
    }
    ledger.expect(Rule::Tracks, rows_found == sighted.len(), || {
        format!("tracks_agents: has {rows_found} rows, the agents' lists make {}", sighted.len())
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vehicles_come_by_number_before_rsus() {
        let mut names = ["rsu_0", "vehicle_10", "vehicle_2"];
        names.sort_by_key(|name| rank(name));
        assert_eq!(names, ["vehicle_2", "vehicle_10", "rsu_0"]);
    }
}
