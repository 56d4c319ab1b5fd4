//! The windows of a front: bays of a few kinds, in a rhythm that is the same from both ends, and storeys that
//! differ.

use schema::ObjectId;
use schema::geometry::Wall;
use simd::{F32x8, lerp, smoothstep};

use super::front_style::{Style, own};
use super::pattern::{Width, bars, bars_of};

/// Height of the rails before windows that reach the floor, metres.
const RAIL_M: f32 = 1.0;
/// Width of window frames and of the bars between panes, metres.
const FRAME_M: f32 = 0.06;

/// A window in its bay and storey, in shares of them.
#[derive(Clone, Copy)]
struct Kind {
    wide: f32,
    high: f32,
    /// Its lower edge.
    low: f32,
    /// Panes beside one another.
    panes: f32,
    /// Whether it reaches the floor and has rails before it.
    has_rails: bool,
}

impl Kind {
    /// The window that a style has in most bays.
    fn usual(style: &Style) -> Self {
        let [wide, high] = style.opening;
        let low = 0.5 - 0.5 * high + 0.05f32.min(0.4 * (1.0 - high));
        Self { wide, high, low, panes: style.panes, has_rails: false }
    }

    /// Another one beside it, by a random number: most often the same again.
    fn beside(self, wall: Wall, random: f32) -> Self {
        let to_floor = Self { low: 0.03, high: self.low + self.high - 0.03, has_rails: true, ..self };
        match wall {
            Wall::Curtain => self,
            // Loggias.
            Wall::Panels if random < 0.55 => Self { wide: 0.92, panes: 3.0, ..to_floor },
            _ if random < 0.25 => Self { wide: (1.5 * self.wide).min(0.86), panes: self.panes + 1.0, ..self },
            // A bath's, a stair's.
            _ if random < 0.45 => Self { wide: 0.55 * self.wide, panes: 1.0, ..self },
            _ if random < 0.75 => to_floor,
            // None at all: a flue's way.
            _ if random < 0.85 => Self { wide: 0.0, ..self },
            _ => self,
        }
    }
}

/// How the windows of a front differ.
pub(super) struct Windows {
    usual: Kind,
    /// Of the bays from either end to the middle, again and again.
    kinds: [Kind; 3],
    period: f32,
    /// Numbers of bays and storeys.
    cells: [f32; 2],
    /// Height of windows in the uppermost and in the second storey over that of others.
    top: f32,
    second: f32,
    /// The bay whose windows light the landings of a stair, half a storey higher than others.
    stair: Option<f32>,
    /// The lowest of these begins there, in storeys: over shops there is a cornice, where it would be cut.
    first_landing: f32,
    is_on_ground: bool,
}

impl Windows {
    #[inline]
    pub(super) fn new(
        wall: Wall,
        object: ObjectId,
        style: &Style,
        cells: [f32; 2],
        is_on_ground: bool,
    ) -> Self {
        let pick = |salt: i32| own(object, salt);
        let usual = Kind::usual(style);
        let period = [1.0, 2.0, 2.0, 3.0, 3.0][(5.0 * pick(6)) as usize];
        let kinds = [usual, usual.beside(wall, pick(7)), usual.beside(wall, pick(8))];
        let is_stone = matches!(wall, Wall::Plaster | Wall::Brick | Wall::Ashlar);
        let is_tall = is_stone && cells[1] > 2.5;
        let first_landing = if is_on_ground { 1.5 } else { 0.5 };
        let has_stair = is_stone && cells[0] > 2.5 && cells[1] > first_landing + 0.9 && pick(12) < 0.3;
        Self {
            usual,
            kinds,
            period,
            cells,
            top: if is_tall && pick(10) > 0.4 { 0.8 } else { 1.0 },
            second: if is_tall && pick(11) > 0.6 { 1.14 } else { 1.0 },
            stair: has_stair.then(|| (0.5 * cells[0]).floor()),
            first_landing,
            is_on_ground,
        }
    }

    /// The windows that eight places (in bays and storeys) belong to.
    #[inline]
    pub(super) fn at(&self, u: F32x8, v: F32x8, [wu, wv]: [Width; 2]) -> Opening {
        let [bays, storeys] = self.cells;
        let number = |x: F32x8, of: f32| x.floor().fast_clamp(F32x8::ZERO, F32x8::splat(of - 1.0));
        let bay = number(u, bays);
        let from_end = bay.fast_min((bays - 1.0) - bay);
        let turn = from_end - (from_end * (1.0 / self.period)).floor() * self.period;
        let of = |get: &dyn Fn(&Kind) -> f32| {
            let mut value = F32x8::splat(get(&self.kinds[0]));
            for k in 1..self.period as usize {
                value = turn.simd_eq(F32x8::splat(k as f32)).select(F32x8::splat(get(&self.kinds[k])), value);
            }
            value
        };
        let (mut wide, mut high, mut low) = (of(&|k| k.wide), of(&|k| k.high), of(&|k| k.low));
        let (mut panes, mut rails) = (of(&|k| k.panes), of(&|k| f32::from(u8::from(k.has_rails))));
        let usual = |value: f32| F32x8::splat(value);
        // Where there is ground outside, nobody steps out of a window.
        let ground = v.simd_lt(F32x8::splat(if self.is_on_ground { 1.0 } else { -1.0 }));
        high = ground.select(high.fast_min(usual(self.usual.high)), high);
        low = ground.select(low.fast_max(usual(self.usual.low)), low);
        rails = ground.select(F32x8::ZERO, rails);
        let mut lift = F32x8::ZERO;
        if let Some(stair) = self.stair {
            let is_stair = bay.simd_eq(F32x8::splat(stair));
            lift = is_stair.select(F32x8::splat(0.5), F32x8::ZERO);
            wide = is_stair.select(usual(0.8 * self.usual.wide), wide);
            high = is_stair.select(usual(self.usual.high), high);
            low = is_stair.select(usual(self.usual.low), low);
            panes = is_stair.select(F32x8::ONE, panes);
            rails = is_stair.select(F32x8::ZERO, rails);
        }
        let storey = number(v - lift, storeys);
        high = storey.simd_gt(F32x8::splat(storeys - 1.5)).select(high * self.top, high);
        high = storey.simd_eq(F32x8::ONE).select((high * self.second).fast_min(0.97 - low), high);
        // From far away all fade to the usual one.
        let far = smoothstep(0.35, 0.8, wu.w.fast_max(wv.w));
        wide = lerp(wide, usual(self.usual.wide), far);
        high = lerp(high, usual(self.usual.high), far);
        low = lerp(low, usual(self.usual.low), far);
        lift *= 1.0 - far;
        let is_cut = lift.simd_gt(F32x8::ZERO)
            & (v.simd_lt(F32x8::splat(self.first_landing)) | v.simd_gt(F32x8::splat(storeys - 0.5)));
        let is_none = is_cut | wide.simd_lt(F32x8::splat(0.02));
        Opening {
            left: 0.5 - wide * 0.5,
            low: low + lift,
            wide: wide.fast_max(F32x8::splat(0.02)),
            high,
            panes,
            rails: is_none.select(F32x8::ZERO, rails),
            lift,
            there: is_none.select(F32x8::ZERO, F32x8::ONE),
        }
    }
}

/// The windows that eight places belong to, in bays and storeys.
pub(super) struct Opening {
    pub(super) left: F32x8,
    pub(super) low: F32x8,
    pub(super) wide: F32x8,
    pub(super) high: F32x8,
    panes: F32x8,
    rails: F32x8,
    /// How much higher than its storey it is.
    pub(super) lift: F32x8,
    there: F32x8,
}

impl Opening {
    /// Share of the openings in the wall, and so far around them.
    #[inline]
    pub(super) fn share(&self, u: F32x8, v: F32x8, [wu, wv]: [Width; 2], around: [f32; 2]) -> F32x8 {
        let [du, dv] = around;
        let wide = (self.wide + 2.0 * du).fast_min(F32x8::ONE);
        bars_of(u - self.left + du, wide, wu)
            * bars_of(v - self.low + dv, (self.high + 2.0 * dv).fast_min(F32x8::ONE), wv)
            * self.there
    }

    /// Share of panes: the frame lies inside the opening, with bars between panes and, in some houses, one
    /// across at a share of their height.
    #[inline]
    pub(super) fn glass(
        &self,
        u: F32x8,
        v: F32x8,
        [wu, wv]: [Width; 2],
        cell_m: [f32; 2],
        transom: Option<f32>,
    ) -> F32x8 {
        let (fu, fv) = (FRAME_M / cell_m[0], FRAME_M / cell_m[1]);
        let none = F32x8::ZERO;
        let mut pane = bars_of(u - self.left - fu, (self.wide - 2.0 * fu).fast_max(none), wu)
            * bars_of(v - self.low - fv, (self.high - 2.0 * fv).fast_max(none), wv);
        for k in 1..4 {
            // Where there are fewer panes their last bar is the frame itself.
            let at = self.left + self.wide * (F32x8::splat(k as f32) / self.panes).fast_min(F32x8::ONE);
            pane *= 1.0 - bars(u - at + 0.5 * fu, fu, wu);
        }
        if let Some(share) = transom {
            pane *= 1.0 - bars(v - self.low - self.high * share + 0.5 * fv, fv, wv);
        }
        pane
    }

    /// Share of the sills below openings.
    #[inline]
    pub(super) fn ledge(&self, u: F32x8, v: F32x8, [wu, wv]: [Width; 2]) -> F32x8 {
        bars(v - self.low + 0.03, 0.03, wv)
            * bars_of(u - self.left + 0.025, self.wide + 0.05, wu)
            * (1.0 - self.rails)
            * self.there
    }

    /// Share of the shutters that stand open at both sides.
    #[inline]
    pub(super) fn shutters(&self, u: F32x8, v: F32x8, [wu, wv]: [Width; 2]) -> F32x8 {
        let leaf = self.wide * 0.5;
        // Where there is no room for both there are none.
        let fits = (self.wide * 2.0).simd_lt(F32x8::splat(0.96)).select(self.there, F32x8::ZERO);
        let beside =
            bars_of(u - self.left + leaf, self.wide * 2.0, wu) - bars_of(u - self.left, self.wide, wu);
        beside.fast_max(F32x8::ZERO) * bars_of(v - self.low, self.high, wv) * fits
    }

    /// Share of the rails before windows that reach the floor: bars, or sheets.
    #[inline]
    pub(super) fn rails(
        &self,
        u: F32x8,
        v: F32x8,
        [wu, wv]: [Width; 2],
        [bay_m, storey_m]: [f32; 2],
        are_sheets: bool,
    ) -> F32x8 {
        if self.rails.simd_gt(F32x8::ZERO).none() {
            return F32x8::ZERO;
        }
        let beside = 0.03;
        let before = bars_of(u - self.left + beside, (self.wide + 2.0 * beside).fast_min(F32x8::ONE), wu);
        let (height, rail) = (RAIL_M / storey_m, 0.05 / storey_m);
        let below = bars(v - self.low, height, wv);
        let top = bars(v - self.low - height + rail, rail, wv);
        const APART_M: f32 = 0.12;
        let upright = if are_sheets {
            below
        } else {
            bars(u * (bay_m / APART_M), 0.18, Width::new(wu.w * (bay_m / APART_M))) * below
        };
        before * upright.fast_max(top) * self.rails
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wide_of(windows: &Windows, bay: f32, storey: f32) -> (f32, f32) {
        let near = [Width::new(F32x8::splat(0.01)); 2];
        let at = windows.at(F32x8::splat(bay + 0.5), F32x8::splat(storey + 0.5), near);
        (at.wide.to_array()[0], at.high.to_array()[0])
    }

    fn of(object: ObjectId, cells: [f32; 2]) -> Windows {
        let style = Style::of(Wall::Plaster, &|salt| own(object, salt));
        Windows::new(Wall::Plaster, object, &style, cells, true)
    }

    #[test]
    fn bays_are_the_same_from_both_ends_and_fronts_differ() {
        let mut seen = std::collections::BTreeSet::new();
        for object in 1..200 {
            let mut windows = of(object, [7.0, 4.0]);
            windows.stair = None;
            let row: Vec<_> = (0..7).map(|bay| wide_of(&windows, bay as f32, 1.0)).collect();
            for bay in 0..7 {
                assert_eq!(row[bay], row[6 - bay], "object {object}");
            }
            seen.insert(
                row.iter().map(|(wide, _)| (wide / row[0].0 * 10.0).round() as i32).collect::<Vec<_>>(),
            );
        }
        assert!(seen.len() >= 5, "{seen:?}");
    }

    #[test]
    fn stairs_have_windows_above_the_cornice_over_shops_alone() {
        let near = [Width::new(F32x8::splat(0.01)); 2];
        let mut seen = 0;
        for object in 1..200 {
            for storeys in [2.0, 3.0, 5.0] {
                let windows = of(object, [5.0, storeys]);
                let Some(stair) = windows.stair else { continue };
                assert!(storeys > 2.5, "object {object}");
                for step in 0..(40.0 * storeys) as usize {
                    let v = (step as f32 + 0.5) / 40.0;
                    let at = windows.at(F32x8::splat(stair + 0.5), F32x8::splat(v), near);
                    if at.there.to_array()[0] > 0.0 {
                        assert!((1.5..storeys - 0.5).contains(&v), "object {object}: {v}");
                        seen += 1;
                    }
                }
            }
        }
        assert!(seen > 100, "{seen}");
    }

    #[test]
    fn openings_cover_the_shares_of_their_cells() {
        // The mean over a window's cell is its area, however wide a pixel is.
        for object in 1..40 {
            let windows = of(object, [5.0, 3.0]);
            for (bay, storey) in [(0.0, 0.0), (1.0, 1.0), (3.0, 2.0)] {
                let n = 200;
                let (mut sum, mut want) = (0.0, 0.0);
                for i in 0..n * n {
                    let u = bay + ((i % n) as f32 + 0.5) / n as f32;
                    let v = storey + ((i / n) as f32 + 0.5) / n as f32;
                    let (u, v) = (F32x8::splat(u), F32x8::splat(v));
                    let thin = [Width::new(F32x8::splat(1e-4)); 2];
                    let at = windows.at(u, v, thin);
                    if at.lift.to_array()[0] > 0.0 {
                        continue;
                    }
                    sum += at.share(u, v, thin, [0.0; 2]).to_array()[0];
                    want += at.there.to_array()[0] * at.wide.to_array()[0] * at.high.to_array()[0];
                    assert!(at.low.to_array()[0] >= 0.0 && (at.low + at.high).to_array()[0] <= 1.0);
                }
                let cells = (n * n) as f32;
                assert!(
                    (sum - want).abs() / cells < 0.01,
                    "object {object}: {} {}",
                    sum / cells,
                    want / cells
                );
            }
        }
    }
}
