//! GNSS and IMU against the poses.

use schema::FRAME_PERIOD_S;

use super::clouds::SIGMAS;
use crate::config::AgentConfig;
use crate::files::{Table, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::{AgentRow, AgentTrack, Scene};
use crate::space::{Motion, V3, add, cross, scale, sub, within, wrapped};

/// Radius of the sphere of the projection, m.
const EARTH_M: f64 = 6_378_137.0;
/// What readings without noise may be off, m.
const EXACT_M: f64 = 1e-6;
/// The same of accelerations (m/s2) and rates (rad/s).
const EXACT: f64 = 1e-4;
/// At frame 0 the velocity before comes from the log, which has 32 bits of it, m/s2.
const FIRST_MPS2: f64 = 2e-3;
const GRAVITY_MPS2: f64 = 9.81;

/// Checks the receivers of an agent.
pub(crate) fn check(
    scene: &Scene,
    name: &str,
    agent: &AgentTrack,
    config: &AgentConfig,
    ledger: &mut Ledger,
) {
    match config.gnss() {
        Some((mount, noise)) => {
            let checked = gnss(scene, name, agent, &mount, noise, ledger);
            ledger.read(checked);
        }
        None => ledger.skip(Rule::Gnss, format!("{}: carries none", kind(name))),
    }
    match config.imu() {
        Some((mount, noise)) => {
            let checked = imu(scene, name, agent, &mount, noise, ledger);
            ledger.read(checked);
        }
        None => ledger.skip(Rule::Imu, format!("{}: carries none", kind(name))),
    }
}

fn kind(name: &str) -> &str {
    name.split('_').next().unwrap_or(name)
}

/// A number of a PROJ text, as `+lat_0=49`.
fn projected(text: &str, key: &str) -> f64 {
    let parts = text.split_whitespace().filter_map(|part| part.strip_prefix('+')?.split_once('='));
    parts.filter(|(name, _)| *name == key).find_map(|(_, value)| value.parse().ok()).unwrap_or(0.0)
}

/// Place in the world of a fix: the inverse of the spherical Mercator projection whose scale is 1 at the
/// origin.
fn world_of([latitude, longitude, altitude]: V3, origin: [f64; 2]) -> V3 {
    let rad = f64::to_radians;
    let northing = |degrees: f64| libm::log(libm::tan(0.5 * rad(degrees) + std::f64::consts::FRAC_PI_4));
    let radius = EARTH_M * libm::cos(rad(origin[0]));
    [rad(longitude - origin[1]) * radius, (northing(latitude) - northing(origin[0])) * radius, altitude]
}

fn gnss(
    scene: &Scene,
    name: &str,
    agent: &AgentTrack,
    mount: &Motion,
    noise: V3,
    ledger: &mut Ledger,
) -> Result<(), Unreadable> {
    let projection = scene.facts["geo_reference"].as_str().unwrap_or_default();
    let origin = [projected(projection, "lat_0"), projected(projection, "lon_0")];
    // A degree of longitude is shorter than one of latitude, by the cosine; both cosines cancel in the
    // world's metres.
    let per_degree = EARTH_M.to_radians();
    let tolerance =
        [noise[1] * per_degree * libm::cos(origin[0].to_radians()), noise[0] * per_degree, noise[2]];
    let tolerance = tolerance.map(|sigma| EXACT_M + SIGMAS * sigma);
    for rows in Table::open(&scene.file(&format!("sensors/{name}/GNSS.parquet")))?.batches()? {
        let frames = rows.ints("frame")?;
        let (north, east) = (rows.reals("latitude_deg")?, rows.reals("longitude_deg")?);
        let up = rows.reals("altitude_m")?;
        for k in 0..rows.len() {
            let frame = frames[k];
            let Some(row) = row_at(agent, frame) else { break };
            let off =
                sub(world_of([north[k], east[k], up[k]], origin), row.world_from_agent.outward(mount.origin));
            let holds = (0..3).all(|axis| within(off[axis], tolerance[axis]));
            ledger.expect(Rule::Gnss, holds, || format!("frame {frame}: {name}'s fix is {off:.6?} m off"));
        }
    }
    Ok(())
}

fn row_at(agent: &AgentTrack, frame: i64) -> Option<&AgentRow> {
    usize::try_from(frame).ok().and_then(|frame| agent.rows.get(frame))
}

/// Velocity of a point of an agent in the world, m/s.
fn velocity_at(row: &AgentRow, lever_m: V3) -> V3 {
    add(row.velocity_mps, cross(row.turning_radps, row.world_from_agent.turn(lever_m)))
}

fn imu(
    scene: &Scene,
    name: &str,
    agent: &AgentTrack,
    mount: &Motion,
    [accel_noise, gyro_bias, gyro_noise]: V3,
    ledger: &mut Ledger,
) -> Result<(), Unreadable> {
    let before_first = scene.state(agent.id, -1).map(|state| AgentRow {
        world_from_agent: state.world_from_object,
        velocity_mps: state.velocity_mps,
        turning_radps: state.turning_radps,
    });
    for rows in Table::open(&scene.file(&format!("sensors/{name}/IMU.parquet")))?.batches()? {
        let frames = rows.ints("frame")?;
        let forces = rows.vectors::<3>("acceleration_mps2")?;
        let (rates, compass) = (rows.vectors::<3>("gyroscope_radps")?, rows.reals("compass_rad")?);
        for k in 0..rows.len() {
            let frame = frames[k];
            let Some(row) = row_at(agent, frame) else { break };
            let before = if frame == 0 { before_first } else { row_at(agent, frame - 1).copied() };
            let pose = row.world_from_agent.then(mount);
            let steps =
                before.map(|before| sub(velocity_at(row, mount.origin), velocity_at(&before, mount.origin)));
            let push = scale(steps.unwrap_or_default(), 1.0 / FRAME_PERIOD_S);
            let force = pose.turn_back(add(push, [0.0, 0.0, GRAVITY_MPS2]));
            let allowed = EXACT + SIGMAS * accel_noise + if frame == 0 { FIRST_MPS2 } else { 0.0 };
            let off = sub(forces[k], force);
            ledger.expect(Rule::Imu, off.iter().all(|o| within(*o, allowed)), || {
                format!("frame {frame}: {name}'s acceleration is {off:.6?} m/s2 off")
            });
            let off = sub(sub(rates[k], pose.turn_back(row.turning_radps)), [gyro_bias; 3]);
            ledger.expect(Rule::Imu, off.iter().all(|o| within(*o, EXACT + SIGMAS * gyro_noise)), || {
                format!("frame {frame}: {name}'s rates are {off:.6?} rad/s off")
            });
            let ahead = row.world_from_agent.ahead();
            let off = wrapped(compass[k] - libm::atan2(ahead[0], ahead[1]));
            ledger.expect(Rule::Imu, within(off, 1e-9), || {
                format!("frame {frame}: {name}'s compass is {off:.6} rad off")
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_minute_of_latitude_is_a_sea_mile() {
        let [east, north, up] = world_of([49.0 + 1.0 / 60.0, 8.0, 3.0], [49.0, 8.0]);
        // Of the sphere with the equator's radius: 1855.3 m; half a minute away the scale differs by some
        // 2e-4.
        assert!((north - 1855.3).abs() < 0.5, "{north}");
        assert!(east.abs() < 1e-9 && (up - 3.0).abs() < 1e-12);
        let [east, ..] = world_of([49.0, 8.0 + 1.0 / 60.0, 0.0], [49.0, 8.0]);
        assert!((east - 1855.3 * libm::cos(49.0_f64.to_radians())).abs() < 0.1, "{east}");
        assert_eq!(projected("+proj=tmerc +lat_0=49 +lon_0=8.5", "lon_0"), 8.5);
        assert_eq!(projected("", "lat_0"), 0.0);
    }
}
