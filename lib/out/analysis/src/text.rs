//! Numbers and names as text for people.

/// Thousands separated by commas: `27,337,066`, and `1,234.50`. Ours, because cells come with their decimals
/// fixed: indicatif's and num-format's counts are of whole numbers, or with as many decimals as they like.
pub(crate) fn grouped(number: &str) -> String {
    let (sign, rest) = number.strip_prefix('-').map_or(("", number), |rest| ("-", rest));
    let (whole, fraction) = rest.split_once('.').map_or((rest, ""), |(whole, fraction)| (whole, fraction));
    let mut text = sign.to_owned();
    for (i, digit) in whole.chars().enumerate() {
        if i > 0 && (whole.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    if !fraction.is_empty() {
        text.push('.');
        text.push_str(fraction);
    }
    text
}

/// A count as people say it: in full up to a million, then `27.3 million`.
pub(crate) fn spoken(count: u64) -> String {
    let said = |unit: f64, name: &str| {
        let scaled = count as f64 / unit;
        // Three digits.
        let decimals = if scaled < 9.995 { 2 } else { usize::from(scaled < 99.95) };
        let digits = format!("{scaled:.decimals$}");
        format!("{} {name}", digits.trim_end_matches('0').trim_end_matches('.'))
    };
    match count {
        0..1_000_000 => grouped(&count.to_string()),
        1_000_000..1_000_000_000 => said(1e6, "million"),
        _ => said(1e9, "billion"),
    }
}

/// A size as people say it: `1.50 GB`.
pub(crate) fn size(bytes: u64) -> String {
    indicatif::DecimalBytes(bytes).to_string()
}

/// A time as people say it: `45 s`, `3 min 20 s`, `2 h 16 min`. indicatif's is in one unit alone.
pub(crate) fn duration(seconds: u64) -> String {
    let (large, small, names) = match seconds {
        0..60 => return format!("{seconds} s"),
        60..3600 => (seconds / 60, seconds % 60, ["min", "s"]),
        _ => (seconds / 3600, seconds % 3600 / 60, ["h", "min"]),
    };
    match small {
        0 => format!("{} {}", grouped(&large.to_string()), names[0]),
        _ => format!("{} {} {small} {}", grouped(&large.to_string()), names[0], names[1]),
    }
}

/// A short number for an axis: `0`, `250`, `2.5k`, `1M`, `20G`.
pub(crate) fn short(value: f64) -> String {
    let (scaled, suffix) = [(1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k")]
        .into_iter()
        .find(|(unit, _)| value.abs() >= *unit)
        .map_or((value, ""), |(unit, suffix)| (value / unit, suffix));
    // What three decimals would make nothing of has its power of ten.
    if scaled != 0.0 && scaled.abs() < 0.001 {
        return format!("{scaled:.0e}");
    }
    let digits = format!("{scaled:.3}");
    format!("{}{suffix}", digits.trim_end_matches('0').trim_end_matches('.'))
}

/// A name of code as words: `traffic_light` is `traffic light`, `rsu_frames` is `RSU frames`.
pub(crate) fn words(name: &str) -> String {
    let word = |word: &str| match word {
        "bev" => "BEV".to_owned(),
        "rsu" => "RSU".to_owned(),
        "rsus" => "RSUs".to_owned(),
        other => other.to_owned(),
    };
    name.split('_').map(word).collect::<Vec<_>>().join(" ")
}

/// A document without the characters that XML cannot hold, escaped or not: they become U+FFFD.
pub(crate) fn printable(document: &str) -> String {
    let forbidden =
        |c: char| (c < ' ' && !matches!(c, '\t' | '\n' | '\r')) || matches!(c, '\u{FFFE}' | '\u{FFFF}');
    document.replace(forbidden, "\u{FFFD}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped_and_shortened() {
        let cases = [
            ("0", "0"),
            ("999", "999"),
            ("1000", "1,000"),
            ("27337066", "27,337,066"),
            ("-1234.5678", "-1,234.5678"),
        ];
        for (number, want) in cases {
            assert_eq!(grouped(number), want);
        }
        let cases = [
            (0.0, "0"),
            (250.0, "250"),
            (2500.0, "2.5k"),
            (1e6, "1M"),
            (2e10, "20G"),
            (0.05, "0.05"),
            (2e-4, "2e-4"),
        ];
        for (number, want) in cases {
            assert_eq!(short(number), want);
        }
    }

    #[test]
    fn large_numbers_are_in_units_of_people() {
        let counts = [
            (0, "0"),
            (999_999, "999,999"),
            (1_000_000, "1 million"),
            (27_337_066, "27.3 million"),
            (123_456_789, "123 million"),
            (2_040_000_000, "2.04 billion"),
        ];
        for (count, want) in counts {
            assert_eq!(spoken(count), want);
        }
        let times =
            [(45, "45 s"), (180, "3 min"), (200, "3 min 20 s"), (8190, "2 h 16 min"), (7_200_000, "2,000 h")];
        for (seconds, want) in times {
            assert_eq!(duration(seconds), want);
        }
        assert_eq!([size(999), size(1_500_000_000)], ["999 B", "1.50 GB"]);
    }

    #[test]
    fn names_are_words() {
        assert_eq!(printable("a\u{1}\tb\u{FFFE}\n"), "a\u{FFFD}\tb\u{FFFD}\n");
        assert_eq!(words("traffic_light"), "traffic light");
        assert_eq!(words("rsu_frames"), "RSU frames");
    }
}
