//! Noise of the chip: photons come one by one, and reading them out is not exact.

use random::Stream;
use rayon::prelude::*;

use super::film::Film;
use super::picture::Picture;

/// Pixels whose numbers are drawn together: four words at each of 16 counters.
const STRETCH: usize = 64;
/// What reading a pixel out is wrong by, electrons.
const READ_ELECTRONS: f64 = 4.0;
/// How many steps noise has.
const QUANTILES: usize = 1024;

/// The standard normal distribution at the middles of equal shares.
fn quantiles() -> Vec<f32> {
    // Its distribution function, by bisection: the error function's series converges fast where it is wanted.
    let below = |x: f64| 0.5 * (1.0 + frames::math::erf(x / std::f64::consts::SQRT_2));
    (0..QUANTILES)
        .map(|i| {
            let share = (i as f64 + 0.5) / QUANTILES as f64;
            let (mut low, mut high) = (-5.0, 5.0);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                *(if below(middle) < share { &mut low } else { &mut high }) = middle;
            }
            (0.5 * (low + high)) as f32
        })
        .collect()
}

/// Puts noise on pictures.
#[derive(Clone, Debug)]
pub struct Noise {
    /// Times the noise of a usual chip.
    strength: f64,
    quantiles: Vec<f32>,
    /// Film value at which each code begins to be the next one's, with the code's own slope: codes per film
    /// value.
    codes: Vec<(f64, f64)>,
}

impl Noise {
    /// `strength` times the noise of a usual chip.
    #[must_use]
    pub fn new(strength: f64) -> Self {
        Self { strength, quantiles: quantiles(), codes: Film::slopes() }
    }

    /// Standard deviation at each code, in codes: photons of a film value follow Poisson's law, whose
    /// variance is its mean.
    fn deviations(&self, electrons: f64) -> Vec<f32> {
        let of = |&(film, slope): &(f64, f64)| {
            let variance = film * electrons + READ_ELECTRONS * READ_ELECTRONS;
            (self.strength * variance.sqrt() / electrons * slope) as f32
        };
        self.codes.iter().map(of).collect()
    }

    /// A picture as the chip has it at a frame.
    #[must_use]
    pub fn on(&self, picture: &Picture, stream: &Stream, frame: u32) -> Picture {
        let deviations = self.deviations(f64::from(picture.electrons.max(1)));
        let mut noisy = picture.clone();
        noisy.rgb.par_chunks_mut(3 * STRETCH).enumerate().for_each(|(stretch, pixels)| {
            let words = stream.run_at::<16>(u64::from(frame) << 32 | (16 * stretch) as u64);
            let words = words.as_flattened();
            for (pixel, word) in pixels.as_chunks_mut::<3>().0.iter_mut().zip(words) {
                for (channel, value) in pixel.iter_mut().enumerate() {
                    let draw = self.quantiles[(word >> (10 * channel)) as usize % QUANTILES];
                    let code = f32::from(*value) + draw * deviations[usize::from(*value)];
                    // The cast holds it within 0 and 255.
                    *value = (code + 0.5).floor() as u8;
                }
            }
        });
        noisy
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(code: u8, electrons: u32) -> Picture {
        let (width, height) = (200, 150);
        Picture { width, height, rgb: vec![code; 3 * 200 * 150], electrons }
    }

    /// Mean and standard deviation of codes.
    fn spread(picture: &Picture) -> (f64, f64) {
        let n = picture.rgb.len() as f64;
        let mean = picture.rgb.iter().map(|&v| f64::from(v)).sum::<f64>() / n;
        let square = picture.rgb.iter().map(|&v| (f64::from(v) - mean) * (f64::from(v) - mean)).sum::<f64>();
        (mean, (square / n).sqrt())
    }

    #[test]
    fn noise_is_that_of_photons_and_readout() {
        let stream = Stream::new(1, 2, "test", 3);
        let noise = Noise::new(1.0);
        for (code, electrons) in [(118u8, 300u32), (118, 1200), (60, 300), (200, 1200)] {
            let (mean, deviation) = spread(&noise.on(&grey(code, electrons), &stream, 5));
            // The curve backwards by closed form, its slope by a difference.
            let film = |code: f64| {
                let c = code / 255.0;
                let l = if c <= 0.040_45 { c / 12.92 } else { frames::math::pow((c + 0.055) / 1.055, 2.4) };
                let (a, b, c) = (2.51 - 2.43 * l, 0.03 - 0.59 * l, -0.14 * l);
                (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)
            };
            let code = f64::from(code);
            let slope = 2.0 / (film(code + 1.0) - film(code - 1.0));
            let electrons = f64::from(electrons);
            let want = (film(code) * electrons + 16.0).sqrt() / electrons * slope;
            // Rounding adds a twelfth of a step.
            let want = (want * want + 1.0 / 12.0).sqrt();
            assert!((mean - code).abs() < 0.1 + 0.01 * want, "{mean} {code}");
            assert!((deviation / want - 1.0).abs() < 0.03, "{code} {electrons}: {deviation} {want}");
        }
    }

    #[test]
    fn white_stays_nearly_white() {
        let noisy = Noise::new(1.0).on(&grey(255, 1200), &Stream::new(1, 2, "test", 3), 5);
        let least = noisy.rgb.iter().min().expect("has pixels");
        assert!(*least > 230, "{least}");
    }

    #[test]
    fn frames_differ_and_none_is_none() {
        let stream = Stream::new(1, 2, "test", 3);
        let noise = Noise::new(1.0);
        let picture = grey(100, 500);
        let at = |frame| noise.on(&picture, &stream, frame);
        assert_eq!(at(1), at(1));
        let same = at(1).rgb.iter().zip(&at(2).rgb).filter(|(a, b)| a == b).count();
        assert!(same < 90_000 / 4, "{same} of 90000 are the same");
        assert_eq!(Noise::new(0.0).on(&picture, &stream, 1), picture);
    }
}
