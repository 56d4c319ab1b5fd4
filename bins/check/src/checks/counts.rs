//! Counts of boxes against a recount.

use std::collections::BTreeMap;

use schema::DetectionClass;

use super::boxes::Labelled;
use super::cameras::Sight;
use super::clouds::{Cloud, Kind};
use crate::files::{Table, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::Scene;

/// Points this near to a box's faces may count or not, m: lidars have them as 32-bit metres, radars as
/// angles.
const EDGE_M: f64 = 1e-4;

/// Pixels of an agent's objects, by frame, id and tag: `visible.parquet`.
pub(crate) type Visible = BTreeMap<(i64, u16, u8), u64>;

/// Reads the pixels that an agent's cameras are said to have counted.
pub(crate) fn read_visible(scene: &Scene, agent: &str) -> Result<Visible, Unreadable> {
    let mut visible = Visible::new();
    for rows in Table::open(&scene.file(&format!("sensors/{agent}/visible.parquet")))?.batches()? {
        let (frames, ids) = (rows.ints("frame")?, rows.ints("id")?);
        let (tags, pixels) = (rows.ints("tag")?, rows.ints("pixels")?);
        for k in 0..rows.len() {
            let key = (frames[k], u16::try_from(ids[k]).unwrap_or(0), tags[k] as u8);
            *visible.entry(key).or_default() += pixels[k].unsigned_abs();
        }
    }
    Ok(visible)
}

/// Pixels by id and tag, over all cameras.
fn pixels_of(sights: &[Sight<'_>]) -> BTreeMap<(u16, u8), u64> {
    let mut pixels = BTreeMap::new();
    for (part, patch) in sights.iter().flat_map(|sight| &sight.parts) {
        if part.0 != 0 {
            *pixels.entry(*part).or_default() += patch.pixels;
        }
    }
    pixels
}

/// The table of visible objects against the images of a frame.
pub(crate) fn check_visible(visible: &Visible, sights: &[Sight<'_>], frame: usize, ledger: &mut Ledger) {
    let counted = pixels_of(sights);
    let at = frame as i64;
    let told = visible.range((at, 0, 0)..(at + 1, 0, 0)).map(|(&(_, id, tag), &pixels)| ((id, tag), pixels));
    let told: BTreeMap<(u16, u8), u64> = told.collect();
    for (part, pixels) in &counted {
        let said = told.get(part).copied().unwrap_or(0);
        ledger.expect(Rule::Pictures, said == *pixels, || {
            format!("frame {frame}: visible.parquet says {said} pixels of object and tag {part:?}, there are {pixels}")
        });
    }
    for (part, said) in told.iter().filter(|(part, _)| !counted.contains_key(part)) {
        ledger.off(Rule::Pictures, || {
            format!(
                "frame {frame}: visible.parquet says {said} pixels of object and tag {part:?}, there are none"
            )
        });
    }
}

/// What decides the numbers of a box besides its points.
pub(crate) struct Evidence<'a> {
    pub(crate) clouds: &'a [Cloud<'a>],
    /// None where no instance images are kept.
    pub(crate) sights: Option<&'a [Sight<'a>]>,
    pub(crate) valid_by_image: bool,
}

/// Points, pixels, flag and difficulty of the boxes of a frame.
pub(crate) fn check(boxes: &[Labelled], evidence: &Evidence<'_>, frame: usize, ledger: &mut Ledger) {
    let pixels = evidence.sights.map(pixels_of);
    let counts = |kind: Kind| {
        let mut counts = vec![[0_u64; 2]; boxes.len()];
        for point in
            evidence.clouds.iter().filter(|c| c.ranger.kind == kind).flat_map(Cloud::surfaces_in_world)
        {
            for (count, labelled) in counts.iter_mut().zip(boxes) {
                let far = (0..3).map(|i| (point[i] - labelled.center_m[i]).abs()).fold(0.0, f64::max);
                // No annotated object is larger than 30 m.
                if far < 30.0 && labelled.holds(point, EDGE_M) {
                    count[1] += 1;
                    count[0] += u64::from(labelled.holds(point, -EDGE_M));
                }
            }
        }
        counts
    };
    let (lidar, radar) = (counts(Kind::Lidar), counts(Kind::Radar));
    for (k, labelled) in boxes.iter().enumerate() {
        let Some(seen) = &labelled.seen else { continue };
        let mut expect = |holds: bool, words: &dyn Fn() -> String| {
            ledger.expect(Rule::Counts, holds, || {
                format!("frame {frame}: object {} ({}): {}", labelled.id, labelled.class.name(), words())
            });
        };
        for (name, said, [least, most]) in
            [("num_lidar_pts", seen.lidar, lidar[k]), ("num_radar_pts", seen.radar, radar[k])]
        {
            expect((least..=most).contains(&said), &|| {
                format!("{name} is {said}, counted {least} to {most}")
            });
        }
        if let Some(pixels) = &pixels {
            let parts = labelled.tags.iter().filter_map(|&tag| pixels.get(&(labelled.id, tag)));
            let counted: u64 = parts.sum();
            expect(seen.pixels == counted, &|| format!("num_pixels is {}, counted {counted}", seen.pixels));
        }
        let valid = seen.lidar + seen.radar > 0 || (evidence.valid_by_image && seen.pixels > 0);
        expect(seen.valid == valid, &|| format!("valid_flag is {}", seen.valid));
        let wanted = difficulty(labelled.class, labelled.distance_m, seen.lidar + seen.radar);
        expect(seen.difficulty == wanted, &|| format!("difficulty is {}, not {wanted}", seen.difficulty));
    }
}

/// How hard an object is to detect, by the published table of distances (m) and points.
pub(crate) fn difficulty(class: DetectionClass, distance_m: f64, points: u64) -> &'static str {
    use DetectionClass::*;
    let (near, far, many, some) = match class {
        Car => (30.0, 60.0, 80, 30),
        Truck | Bus => (40.0, 80.0, 100, 40),
        Pedestrian | Motorcycle | Bicycle => (20.0, 40.0, 40, 20),
        TrafficLight | TrafficSign | TrafficCone | Barrier => (20.0, 40.0, 20, 10),
    };
    match (distance_m, points) {
        (d, p) if d < near && p >= many => "easy",
        (d, p) if d < far && p >= some => "medium",
        _ => "hard",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_objects_of_many_points_are_easy() {
        assert_eq!(difficulty(DetectionClass::Car, 29.9, 80), "easy");
        assert_eq!(difficulty(DetectionClass::Car, 30.0, 80), "medium");
        assert_eq!(difficulty(DetectionClass::Car, 10.0, 79), "medium");
        assert_eq!(difficulty(DetectionClass::Bus, 80.0, 900), "hard");
        assert_eq!(difficulty(DetectionClass::TrafficCone, 5.0, 9), "hard");
    }
}
