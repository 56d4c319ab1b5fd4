//! When a lidar's rays were fired, and which of its beam's returns each one is.

use arrow_array::types::{Float32Type, UInt8Type, UInt16Type};
use schema::{FRAME_PERIOD_S, ReturnKind};

use super::clouds::{Cloud, SIGMAS};
use crate::config::ScanConfig;
use crate::files::Unreadable;
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::Scene;
use crate::space::norm;

/// Nearer to the sensor's axis than this, a point has no azimuth, m.
const AXIS_M: f64 = 0.1;
/// Distances of 32 bits may differ by this, m.
const RANGE_M: f64 = 1e-3;

/// Checks times and returns of a lidar's frame.
pub(crate) fn check(
    scene: &Scene,
    cloud: &Cloud<'_>,
    frame: usize,
    ledger: &mut Ledger,
) -> Result<(), Unreadable> {
    let Some(scan) = &cloud.ranger.scan else { return Ok(()) };
    check_times(scan, cloud, frame, ledger);
    check_returns(scene, scan, cloud, frame, ledger)
}

fn check_times(scan: &ScanConfig, cloud: &Cloud<'_>, frame: usize, ledger: &mut Ledger) {
    let (mut off, mut worst) = (0, 0.0_f64);
    for (point, &offset_s) in cloud.fired.iter().zip(&cloud.offsets_s) {
        let unlike = match scan.slices {
            None => f64::from(offset_s).abs(),
            Some(slices) => late_by(scan, slices, *point, f64::from(offset_s)),
        };
        if unlike > 0.0 || unlike.is_nan() {
            off += 1;
            worst = worst.max(unlike);
        }
    }
    ledger.fine(Rule::ScanTimes, cloud.fired.len() as u64 - off);
    ledger.all_off(Rule::ScanTimes, off, "", || {
        let name = &cloud.ranger.name;
        format!("frame {frame}: {off} returns of {name} were fired up to {worst:.6} s farther from the frame or their column's time than allowed")
    });
}

/// How much more than allowed a ray's time differs from that of its column, s.
fn late_by(scan: &ScanConfig, slices: f64, fired: [f64; 3], offset_s: f64) -> f64 {
    let [x, y, _] = fired;
    if libm::hypot(x, y) < AXIS_M {
        return 0.0;
    }
    let turned = (0.5 * scan.horizontal_fov_rad - libm::atan2(y, x)) / scan.horizontal_fov_rad;
    let wanted = FRAME_PERIOD_S * (turned + 0.5 / scan.columns - 1.0);
    // A scan all around ends where it begins.
    let unlike = [-FRAME_PERIOD_S, 0.0, FRAME_PERIOD_S].map(|turn| (offset_s - wanted + turn).abs());
    let nearest = unlike[0].min(unlike[1]).min(unlike[2]);
    nearest - FRAME_PERIOD_S * (0.5 / slices + 1.0 / scan.columns)
}

fn check_returns(
    scene: &Scene,
    scan: &ScanConfig,
    cloud: &Cloud<'_>,
    frame: usize,
    ledger: &mut Ledger,
) -> Result<(), Unreadable> {
    let (name, table) = (&cloud.ranger.name, &cloud.ranger.table);
    let is_told = ["return_number", "return_count", "return_kind"].map(|column| table.has(column));
    ledger.expect(Rule::Returns, is_told == [scan.tells_returns; 3], || {
        format!("{name}: its table and its configuration disagree on whether returns are told apart")
    });
    if is_told != [true; 3] {
        return Ok(());
    }
    let row = table.row(cloud.ranger.row_of(frame))?;
    let (numbers, counts) =
        (row.first_list::<UInt8Type>("return_number")?, row.first_list::<UInt8Type>("return_count")?);
    let (rings, cosines) =
        (row.first_list::<UInt16Type>("ring")?, row.first_list::<Float32Type>("cos_angle")?);
    let all = cloud.points.len();
    if [numbers.len(), counts.len(), rings.len(), cosines.len()] != [all; 4] {
        return Err(Unreadable::new(table.path(), format!("row {frame}: lists are not equally long")));
    }
    let [fog, rain] = scene.fog_and_rain.get(frame).copied().unwrap_or_default();
    let farther_m = 2.0 * SIGMAS * cloud.ranger.noise_m + RANGE_M;
    let range = |k: usize| norm(cloud.fired[k]);
    let fault = |k: usize| -> Option<&'static str> {
        let (number, count) = (numbers[k], counts[k]);
        let goes_on = k > 0
            && (counts[k - 1], rings[k - 1]) == (count, rings[k])
            && cloud.offsets_s[k - 1] == cloud.offsets_s[k]
            && numbers[k - 1] + 1 == number;
        let ends = number == count || numbers.get(k + 1).is_some_and(|next| *next == number + 1);
        if number == 0 || number > count || !ends || (number > 1 && !goes_on) {
            return Some("is numbered out of turn");
        }
        if u64::from(count) > scan.returns {
            return Some("is of more returns of its beam than are asked for");
        }
        if number > 1 && range(k) < range(k - 1) - farther_m {
            return Some("is nearer than the one before it");
        }
        let there = match cloud.kinds[k] {
            kind if kind == ReturnKind::Surface as u8 => return None,
            kind if kind == ReturnKind::BehindGlass as u8 => {
                return (!scan.glass)
                    .then_some("is from behind glass, and the lidar does not see through any");
            }
            kind if kind == ReturnKind::Fog as u8 => fog > 0.0,
            kind if kind == ReturnKind::Rain as u8 => rain > 0.0,
            _ => return Some("is of no known kind"),
        };
        if !(there && scan.weather) {
            return Some("is of weather that there is not, or that the lidar does not feel");
        }
        let is_nobodys = (cloud.ids[k], cloud.tags[k], cosines[k]) == (0, 0, 0.0);
        (!is_nobodys).then_some("is of the air, and has an id, a tag or an angle")
    };
    for k in 0..all {
        let fault = fault(k);
        ledger.expect(Rule::Returns, fault.is_none(), || {
            format!("frame {frame}: return {k} of {name} {}", fault.unwrap_or_default())
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_is_fired_when_its_azimuth_says() {
        let scan = ScanConfig {
            columns: 100.0,
            horizontal_fov_rad: std::f64::consts::TAU,
            slices: Some(50.0),
            compensated: true,
            tells_returns: false,
            beam_rad: 0.0,
            returns: 1,
            weather: false,
            glass: false,
        };
        // Ahead is the middle of the turn: 25 ms before the frame; half a slice is 0.5 ms, a column as much.
        let late = |y: f64, offset: f64| late_by(&scan, 50.0, [10.0, y, 1.0], offset);
        assert!(late(0.0, -0.0247) <= 0.0 && late(0.0, -0.0235) > 0.0 && late(0.0, -0.026) > 0.0);
        // To the left it was before that.
        assert!(late(1e6, -0.0374) <= 0.0 && late(-1e6, -0.0124) <= 0.0 && late(1e6, -0.0124) > 0.0);
        // Right behind is where the turn begins and ends.
        assert!([-0.0499, -1e-4].iter().all(|&t| late_by(&scan, 50.0, [-10.0, 1e-9, 0.0], t) <= 0.0));
        assert_eq!(late_by(&scan, 50.0, [0.0, 0.0, -3.0], -0.049), 0.0);
    }
}
