//! Numbers and names as text for people.

/// Thousands separated by commas: `27,337,066`.
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

/// A short number for an axis: `0`, `250`, `2.5k`, `1M`, `20G`.
pub(crate) fn short(value: f64) -> String {
    let (scaled, suffix) = [(1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k")]
        .into_iter()
        .find(|(unit, _)| value.abs() >= *unit)
        .map_or((value, ""), |(unit, suffix)| (value / unit, suffix));
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

/// Text for XML and HTML. Characters that XML cannot hold become U+FFFD.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | '\r' => out.push(c),
            '\u{FFFE}' | '\u{FFFF}' => out.push('\u{FFFD}'),
            c if c < ' ' => out.push('\u{FFFD}'),
            c => out.push(c),
        }
    }
    out
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
        let cases =
            [(0.0, "0"), (250.0, "250"), (2500.0, "2.5k"), (1e6, "1M"), (2e10, "20G"), (0.05, "0.05")];
        for (number, want) in cases {
            assert_eq!(short(number), want);
        }
    }

    #[test]
    fn markup_is_text() {
        assert_eq!(escaped("<a b=\"&\">\u{1}"), "&lt;a b=&quot;&amp;&quot;&gt;\u{FFFD}");
        assert_eq!(words("traffic_light"), "traffic light");
        assert_eq!(words("rsu_frames"), "RSU frames");
    }
}
