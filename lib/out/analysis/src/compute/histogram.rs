//! Histograms of whole numbers over scenes.

/// At most this many bins; wider bins are taken when there would be more.
const MAX_BINS: u64 = 64;

/// A bin and how many values lie in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Bin {
    /// `7`, `20-39` or `400+`.
    pub(super) label: String,
    /// Smallest value in it.
    pub(super) lower: u64,
    pub(super) count: u64,
}

/// Counts values in bins aligned to 0, from the bin of the smallest value to the bin of the largest.
/// Values from `overflow` on share one bin.
pub(super) fn histogram(values: &[u64], width: u64, overflow: Option<u64>) -> Vec<Bin> {
    let (Some(&min), Some(&max)) = (values.iter().min(), values.iter().max()) else { return Vec::new() };
    let overflow = overflow.unwrap_or(u64::MAX);
    let (min, max) = (min.min(overflow), max.min(overflow));
    let mut width = width.max(1);
    // 1, 2, 5, 10, 20, 50, ... times the width asked for.
    for factor in [2.0, 2.5, 2.0].into_iter().cycle() {
        if max / width - min / width < MAX_BINS {
            break;
        }
        width = (width as f64 * factor) as u64;
    }
    let first = min / width;
    let mut counts = vec![0; (max / width - first + 1) as usize];
    for value in values {
        counts[((*value).min(overflow) / width - first) as usize] += 1;
    }
    let bin = |(i, count)| {
        let lower = (first + i as u64) * width;
        let label = match (lower >= overflow, width) {
            (true, _) => format!("{lower}+"),
            (false, 1) => lower.to_string(),
            (false, _) => format!("{lower}-{}", lower.saturating_add(width - 1)),
        };
        Bin { label, lower, count }
    };
    counts.into_iter().enumerate().map(bin).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bins(values: &[u64], width: u64, overflow: Option<u64>) -> Vec<(String, u64)> {
        histogram(values, width, overflow).into_iter().map(|bin| (bin.label, bin.count)).collect()
    }

    #[test]
    fn bins_are_aligned_to_zero_and_reach_from_smallest_to_largest() {
        assert_eq!(bins(&[8, 10, 10], 1, None), [("8".into(), 1), ("9".into(), 0), ("10".into(), 2)]);
        assert_eq!(
            bins(&[399, 400, 379, 2000], 20, Some(400)),
            [("360-379".into(), 1), ("380-399".into(), 1), ("400+".into(), 2)]
        );
        assert_eq!(bins(&[], 1, None), []);
        assert_eq!(bins(&[500], 20, Some(400)), [("400+".into(), 1)]);
    }

    #[test]
    fn any_range_fits_on_a_page() {
        let wide = histogram(&[0, 3, u64::MAX - 1], 1, None);
        assert!(wide.len() as u64 <= MAX_BINS);
        assert_eq!(wide.iter().map(|bin| bin.count).sum::<u64>(), 3);
        let hours = histogram(&[10, 3600], 1, None);
        assert_eq!((hours.len(), hours[0].label.as_str()), (37, "0-99"));
    }
}
