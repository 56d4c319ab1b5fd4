//! What a row of the log's states says about an object: where it is, and which of its lamps burn.

use frames::{LocalOrigin, Object, Pose, World};
use glam::Affine3A;
use schema::lights;
use schema::tables::StateRow;

/// Whether its numbers can be used.
pub(crate) fn usable(state: &StateRow) -> bool {
    let norm: f64 = state.quaternion.iter().map(|q| q * q).sum();
    state.xyz_m.iter().all(|v| v.abs() < 1e8)
        && (0.5..2.0).contains(&norm)
        && state.steer_rad.is_finite()
        && state.phase_rad.is_finite()
        && state.gait_mps.is_finite()
        && state.seat_m.is_finite()
        && state.lean_rad.iter().all(|angle| angle.is_finite())
        && state.door_rad.iter().all(|angle| angle.is_finite())
}

/// Blinkers flash so often a second (the rule is 1 to 2 Hz), emergency lights to either side so often.
const BLINK_HZ: f64 = 1.5;
const EMERGENCY_HZ: f64 = 2.0;
/// The golden ratio: no two objects flash in step.
const OUT_OF_STEP: f64 = 0.618_033_988_749_895;

/// The lamps of a state that burn at a time: those that flash do so in the first half of their period; of the
/// emergency lights one half burns while the other is dark.
pub(crate) fn flashing(state: &StateRow, time_s: f64) -> u32 {
    let offset = OUT_OF_STEP * f64::from(state.id);
    let first_half = |hz: f64| (time_s * hz + offset).rem_euclid(1.0) < 0.5;
    let mut lamps = state.lights & !lights::EMERGENCY_OTHER;
    if !first_half(BLINK_HZ) {
        lamps &= !(lights::BLINK_LEFT | lights::BLINK_RIGHT);
    }
    if lamps & lights::EMERGENCY != 0 && !first_half(EMERGENCY_HZ) {
        lamps = lamps & !lights::EMERGENCY | lights::EMERGENCY_OTHER;
    }
    lamps
}

/// Its pose.
pub(crate) fn local_from_state(origin: &LocalOrigin, state: &StateRow) -> Affine3A {
    origin.local_from_body(&Pose::<World, Object>::from_xyz_wxyz(state.xyz_m, state.quaternion))
}

/// Where its wheels stand: its pose without the lean of the body on its springs.
pub(crate) fn local_from_level(origin: &LocalOrigin, state: &StateRow, leaning: Affine3A) -> Affine3A {
    let [roll, pitch] = state.lean_rad.map(f64::from);
    if [roll, pitch] == [0.0; 2] {
        return leaning;
    }
    let pose = Pose::<World, Object>::from_xyz_wxyz(state.xyz_m, state.quaternion);
    let [r, p, yaw] = pose.rpy();
    origin.local_from_body(&Pose::<World, Object>::from_xyz_rpy(state.xyz_m, [r - roll, p - pitch, yaw]))
}
