//! What headlights give in each direction.

use simd::F32x8;

/// How far headlights are followed, metres.
pub(super) const REACH_M: f32 = 64.0;
/// A headlight's lobe by tangents of angles from its middle, each over its half width.
#[inline]
fn lobe(across: F32x8, over: F32x8) -> F32x8 {
    let fall = 1.0 / (across * across + over * over + 1.0);
    fall * fall
}

/// Intensity of one headlight, kilocandela, by cosines of the angles between a direction and ahead, left and
/// up.
///
/// As UN Regulation 112 draws passing beams for right-hand traffic: below a cut-off 0.6 degrees under the
/// horizon that rises by 15 degrees on the right, brightest close under it, little above. Driving beams have
/// their middle on the horizon.
#[inline]
pub(super) fn intensity(is_high: bool, [ahead, left, up]: [F32x8; 3]) -> F32x8 {
    let forward = ahead.fast_max(F32x8::splat(0.05));
    let (h, v) = (left / forward, up / forward);
    let skirt = ahead.fast_max(F32x8::ZERO);
    let skirt = skirt * skirt * 0.25;
    let is_ahead = ahead.simd_gt(0.0).select(F32x8::ONE, F32x8::ZERO);
    if is_high {
        let near = lobe(h * (1.0 / 0.10), v * (1.0 / 0.06)) * 24.0;
        let wide = lobe(h * (1.0 / 0.40), (v + 0.05) * (1.0 / 0.10)) * 4.0;
        return (near + wide) * is_ahead + skirt;
    }
    let rise = (h * -0.268).fast_clamp(F32x8::ZERO, F32x8::splat(0.05));
    let below = ((rise - 0.010 - v) * (1.0 / 0.010) + 0.5).fast_clamp(F32x8::ZERO, F32x8::ONE);
    let near = lobe((h + 0.03) * (1.0 / 0.14), (v + 0.026) * (1.0 / 0.030)) * 9.0;
    let wide = lobe(h * (1.0 / 0.50), (v + 0.07) * (1.0 / 0.09)) * 2.5;
    (near + wide) * below * is_ahead + skirt
}

/// More than one headlight gives anything so far off its axis in plan, kilocandela: cosine of the least angle
/// there.
pub(super) fn most_kcd(is_high: bool, cos: f32) -> f32 {
    // Beyond the lobes' edges there is their skirt, which ends with the cosine.
    match cos {
        ..=0.0 => 0.0,
        ..0.3 => 0.03,
        ..0.6 => 0.15,
        ..0.9 => 1.0,
        _ if is_high => 29.0,
        _ => 12.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_direction_gets_more_than_is_said() {
        for is_high in [false, true] {
            for yaw_deg in -180..=180 {
                let (left, ahead) = frames::math::f32::sin_cos((yaw_deg as f32).to_radians());
                for pitch_deg in -60..=60 {
                    let (up, level) = frames::math::f32::sin_cos((pitch_deg as f32).to_radians());
                    let axes = [ahead * level, left * level, up].map(F32x8::splat);
                    let got = intensity(is_high, axes).to_array()[0];
                    assert!(got <= most_kcd(is_high, ahead), "{yaw_deg} {pitch_deg}: {got}");
                }
            }
        }
    }
}
