//! Rain and fog in a lidar's beams.
//!
//! Light that goes a way `r` and back through air of extinction `a` (per metre) arrives weaker by
//! `exp(-2 a r)` (Beer and Lambert); an echo's power is its intensity over `r^2`, and the lidar's detector
//! has a floor. So far Goodin, Carruth, Doude and Hudson, "Predicting the influence of rain on LIDAR in
//! ADAS", Electronics 8 (2019), whose floor is the power of a surface at the reach; here its reflectance is a
//! setting.
//!
//! * Fog sends light back everywhere: Hahner, Sakaridis, Dai and Van Gool, "Fog simulation on real LiDAR
//!   point clouds for 3D object detection in adverse weather", ICCV 2021, with the pulse and optics stated
//!   there.
//! * Rain is single drops in the beam: Kilic, Hegde, Sindagi, Cooper, Foster and Patel, "Lidar light
//!   scattering augmentation (LISA)", arXiv:2107.07004 (2021). Drops weaker than the floor are never drawn:
//!   those above it are a Poisson process of its own, so nothing is lost by that.

use random::unit_f32;
use schema::tables::Weather;
use settings::LidarSpec;

use shading::fog_extinction_per_m;

/// Rain at 100 percent, mm/h.
const FULL_RAIN_MMPH: f64 = 50.0;

/// Echo of fog at a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FogEcho {
    /// Where its peak is, metres.
    pub(super) range_m: f32,
    /// Its power: that of a white surface met straight on at a metre in clear air is 1.
    pub(super) power: f32,
}

/// What light that comes back from the air is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Backscatter {
    pub(super) range_m: f32,
    /// Power times squared range: the reflectance of a surface as bright in clear air.
    pub(super) intensity: f32,
    pub(super) power: f32,
}

/// The air of a frame, for one lidar.
#[derive(Clone, Debug)]
pub(super) struct Air {
    extinction_per_m: f32,
    /// Echoes below this power are not detected.
    floor: f32,
    fog: Option<FogEcho>,
    rain: Option<Rain>,
}

impl Air {
    /// The air of a weather; none for lidars that see through it.
    pub(super) fn of(spec: &LidarSpec, weather: &Weather) -> Option<Self> {
        let detected = spec.weather.as_ref()?.detected;
        let floor = detected / (spec.range_m * spec.range_m);
        let share = |percent: f64| (percent / 100.0).clamp(0.0, 1.0);
        let fog_per_m = f64::from(fog_extinction_per_m(share(weather.fog_density) as f32));
        let mmph = FULL_RAIN_MMPH * share(weather.precipitation);
        let drops = Drops::of(mmph);
        let extinction_per_m = fog_per_m + drops.extinction_per_m();
        let fog = fog_echo(fog_per_m, extinction_per_m, spec.range_m);
        Some(Self {
            extinction_per_m: extinction_per_m as f32,
            floor: floor as f32,
            fog: fog.filter(|fog| f64::from(fog.power) >= floor),
            rain: (mmph > 0.0).then(|| Rain::new(drops, extinction_per_m, floor, spec)),
        })
    }

    /// Share of light that comes back from a distance.
    pub(super) fn passes(&self, range_m: f32) -> f32 {
        frames::math::f32::exp(-2.0 * self.extinction_per_m * range_m)
    }

    /// Whether an echo of this power is detected.
    pub(super) fn detects(&self, power: f32) -> bool {
        power >= self.floor
    }

    /// The echo of fog in front of the nearest surface (or the end of the beam). Its distance scatters by ten
    /// metres times a number of the distribution Beta(2, 20), as in the authors' program, by an even random
    /// number.
    pub(super) fn fog_before(&self, nearest_m: f32, even: u32) -> Option<Backscatter> {
        let fog = self.fog?;
        let range_m = fog.range_m + 10.0 * beta_2_20(unit_f32(even));
        let intensity = (fog.power * fog.range_m * fog.range_m).min(1.0);
        (range_m < nearest_m).then_some(Backscatter { range_m, intensity, power: fog.power })
    }

    /// The brightest drop in front of the nearest surface, if one is bright enough. `words` gives the random
    /// words of a number.
    pub(super) fn drop_before(&self, nearest_m: f32, words: &dyn Fn(u32) -> [u32; 4]) -> Option<Backscatter> {
        self.rain.as_ref()?.brightest_before(nearest_m, words)
    }
}

/// Half-power width of the pulse, s, and speed of light, m/s.
const PULSE_S: f64 = 20e-9;
const LIGHT_MPS: f64 = 299_792_458.0;
/// The receiver begins to see the beam at the first of these distances and sees all of it at the second, m.
const OVERLAP_M: [f64; 2] = [0.9, 1.0];
/// Differential reflectivity that the model gives to a surface: 1e-6 / pi, per steradian.
const SURFACE_PER_SR: f64 = 1e-6 / std::f64::consts::PI;
/// Steps in which the pulse is followed, m.
const STEP_M: f64 = 0.05;

/// The peak of the echo of open fog, as equations 12 to 15 of Hahner et al. have it, over that of a white
/// surface; distances are those of the pulse's middle. None without fog.
fn fog_echo(fog_per_m: f64, extinction_per_m: f64, reach_m: f64) -> Option<FogEcho> {
    if fog_per_m <= 0.0 {
        return None;
    }
    // Backscatter by the meteorological optical range, ln 20 / a (Rasshofer, Spies and Spies, 2011).
    let back_per_sr = 0.046 * fog_per_m / frames::math::ln(20.0);
    let pulse_m = LIGHT_MPS * PULSE_S;
    let steps = (pulse_m / STEP_M) as u32;
    let response = |middle_m: f64| {
        let part = |k: u32| {
            let way_m = (f64::from(k) + 0.5) * pulse_m / f64::from(steps);
            let r = middle_m + 0.5 * pulse_m - way_m;
            let overlap = ((r - OVERLAP_M[0]) / (OVERLAP_M[1] - OVERLAP_M[0])).clamp(0.0, 1.0);
            if overlap <= 0.0 {
                return 0.0;
            }
            let shape = frames::math::sin(std::f64::consts::PI * way_m / pulse_m);
            shape * shape * overlap * frames::math::exp(-2.0 * extinction_per_m * r) / (r * r)
        };
        let sum: f64 = (0..steps).map(part).sum();
        // In time: twice as long as the way.
        sum * 2.0 * PULSE_S / f64::from(steps) * back_per_sr / SURFACE_PER_SR
    };
    // Beyond some metres it only falls.
    let places = (0..400).map(|k| STEP_M * f64::from(k)).filter(|place_m| *place_m < reach_m);
    let best = places.map(|place_m| (place_m, response(place_m))).max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(FogEcho { range_m: best.0 as f32, power: best.1 as f32 })
}

/// The number of the distribution Beta(2, 20) below which a share of it lies.
fn beta_2_20(share: f32) -> f32 {
    let below = |x: f32| {
        let y2 = (1.0 - x) * (1.0 - x);
        let y4 = y2 * y2;
        let y16 = y4 * y4 * y4 * y4;
        1.0 - y16 * y4 * (1.0 + 20.0 * x)
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        if below(middle) < share {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Sizes of raindrops by Marshall and Palmer (1948): `n(D) = 8000 exp(-s D)` a cubic metre and mm,
/// `s = 4.1 R^-0.21` per mm.
#[derive(Clone, Copy, Debug)]
struct Drops {
    /// `s`; infinite without rain.
    slope_per_mm: f64,
}

const DROPS_PER_M3_MM: f64 = 8000.0;
/// Smaller drops are left out, mm.
const SMALLEST_MM: f64 = 0.05;
/// Share of light that a drop sends straight back: Fresnel at the refractive index of water, 1.328.
const DROP_REFLECTANCE: f64 = 0.019_85;
/// Nothing is received from nearer drops, m.
const NEAREST_DROP_M: f64 = 1.5;
/// Steps of the table of distances, and most drops a beam.
const RANGES: usize = 512;
const MOST_DROPS: u32 = 48;

impl Drops {
    fn of(mmph: f64) -> Self {
        let slope_per_mm = if mmph > 0.0 { 4.1 * frames::math::pow(mmph, -0.21) } else { f64::INFINITY };
        Self { slope_per_mm }
    }

    /// Twice their cross-section (which is what drops much larger than the wave take away), summed over
    /// sizes: `pi 8000 / s^3` mm^2 a cubic metre.
    fn extinction_per_m(&self) -> f64 {
        let s = self.slope_per_mm;
        std::f64::consts::PI * DROPS_PER_M3_MM * 1e-6 / (s * s * s)
    }

    /// Drops above a size, a cubic metre.
    fn above_per_m3(&self, size_mm: f64) -> f64 {
        DROPS_PER_M3_MM / self.slope_per_mm * frames::math::exp(-self.slope_per_mm * size_mm)
    }
}

/// Drops that are bright enough to be detected, in one beam up to the lidar's reach.
#[derive(Clone, Debug)]
struct Rain {
    slope_per_mm: f32,
    extinction_per_m: f32,
    /// Width of the beam, mm a metre.
    width_mm_per_m: f32,
    /// Root of floor over a drop's reflectance, per metre.
    root_floor: f32,
    /// How many there are on average, and the chance that there is none.
    mean: f32,
    none: f32,
    /// Distances, m: evenly many drops are between neighbours.
    ranges_m: Vec<f32>,
}

impl Rain {
    fn new(drops: Drops, extinction_per_m: f64, floor: f64, spec: &LidarSpec) -> Self {
        let width_per_m = frames::math::tan(spec.beam.divergence_rad);
        let root_floor = (floor / DROP_REFLECTANCE).sqrt();
        // A drop as wide as the beam is as bright as one can be.
        let least_of_width = |r: f64| r * frames::math::exp(extinction_per_m * r) * root_floor;
        let per_m = |r: f64| {
            let share = least_of_width(r);
            if share > 1.0 {
                return 0.0;
            }
            let width_m = width_per_m * r;
            let area_m2 = 0.25 * std::f64::consts::PI * width_m * width_m;
            area_m2 * drops.above_per_m3((1e3 * width_m * share).max(SMALLEST_MM))
        };
        let nearest = NEAREST_DROP_M.min(spec.range_m);
        let step = (spec.range_m - nearest) / (16 * RANGES) as f64;
        let mut sums = vec![0.0];
        for k in 0..16 * RANGES {
            let last = sums.last().copied().unwrap_or(0.0);
            sums.push(last + step * per_m(nearest + (k as f64 + 0.5) * step));
        }
        let mean = sums.last().copied().unwrap_or(0.0);
        let range_of = |share: f64| {
            let at = sums.partition_point(|sum| *sum < share * mean).clamp(1, sums.len() - 1);
            let rest = (share * mean - sums[at - 1]) / (sums[at] - sums[at - 1]).max(f64::MIN_POSITIVE);
            (nearest + step * (at as f64 - 1.0 + rest)) as f32
        };
        Self {
            slope_per_mm: drops.slope_per_mm as f32,
            extinction_per_m: extinction_per_m as f32,
            width_mm_per_m: (1e3 * width_per_m) as f32,
            root_floor: root_floor as f32,
            mean: mean as f32,
            none: frames::math::exp(-mean) as f32,
            ranges_m: (0..=RANGES).map(|k| range_of(k as f64 / RANGES as f64)).collect(),
        }
    }

    fn brightest_before(&self, nearest_m: f32, words: &dyn Fn(u32) -> [u32; 4]) -> Option<Backscatter> {
        let count = poisson(self.mean, self.none, unit_f32(words(0)[0]));
        let mut brightest: Option<Backscatter> = None;
        for number in 0..count {
            let four = words(1 + number / 2);
            let [place, size] = if number % 2 == 0 { [four[0], four[1]] } else { [four[2], four[3]] };
            let range_m = self.range_m(unit_f32(place));
            if range_m >= nearest_m {
                continue;
            }
            let drop = self.echo(range_m, unit_f32(size));
            if brightest.is_none_or(|other| drop.power > other.power) {
                brightest = Some(drop);
            }
        }
        brightest
    }

    fn range_m(&self, share: f32) -> f32 {
        let at = share * RANGES as f32;
        let below = (at as usize).min(RANGES - 1);
        let [low, high] = [self.ranges_m[below], self.ranges_m[below + 1]];
        low + (high - low) * (at - below as f32)
    }

    /// The echo of a drop that is bright enough, of a size drawn by an even random number.
    fn echo(&self, range_m: f32, even: f32) -> Backscatter {
        use frames::math::f32::{exp, ln};
        let width_mm = self.width_mm_per_m * range_m;
        let least_mm = width_mm * range_m * exp(self.extinction_per_m * range_m) * self.root_floor;
        let size_mm = least_mm.max(SMALLEST_MM as f32) - ln(1.0 - even) / self.slope_per_mm;
        let share = (size_mm / width_mm).min(1.0);
        let passes = exp(-2.0 * self.extinction_per_m * range_m);
        let intensity = DROP_REFLECTANCE as f32 * share * share * passes;
        Backscatter { range_m, intensity, power: intensity / (range_m * range_m) }
    }
}

/// A number of the Poisson distribution of a mean, by an even random number; `none` is the chance of 0.
fn poisson(mean: f32, none: f32, even: f32) -> u32 {
    let (mut count, mut chance, mut below) = (0, none, none);
    while even >= below && count < MOST_DROPS {
        count += 1;
        chance *= mean / count as f32;
        below += chance;
    }
    count
}
