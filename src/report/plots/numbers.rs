//! Numbers as pictures write them.

/// A number without the zeros after its last decimal.
pub struct Trim(pub f64);

impl std::fmt::Display for Trim {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let text = format!("{:.*}", f.precision().unwrap_or(6), self.0);
        f.write_str(text.trim_end_matches('0').trim_end_matches('.'))
    }
}

/// A count with its thousands set apart.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let head = digits.len() % 3;
    let mut text = digits[..head].to_string();
    for k in (head..digits.len()).step_by(3) {
        if !text.is_empty() {
            text.push('\u{2009}');
        }
        text.push_str(&digits[k..k + 3]);
    }
    text
}

/// Two digits of a factor.
pub fn two_digits(factor: f64) -> f64 {
    let unit = 10f64.powf(factor.log10().floor() - 1.0);
    (factor / unit).round() * unit
}

/// Three digits, or all before the decimal point.
pub fn three_digits(value: f64) -> String {
    if !(1e-3..1e6).contains(&value.abs()) && value != 0.0 {
        return format!("{value:.2e}").replace('-', "−");
    }
    let digits = (2.0 - value.abs().max(1e-3).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.digits$}").replace('-', "−")
}

/// 10ⁿ, or the number itself near 1.
pub fn power_of_ten(power: i32) -> String {
    match power {
        -2 => "0.01".into(),
        -1 => "0.1".into(),
        0 => "1".into(),
        1 => "10".into(),
        2 => "100".into(),
        _ => {
            let superscript = |c: char| match c {
                '-' => '⁻',
                '1' => '¹',
                '2' => '²',
                '3' => '³',
                digit => char::from_u32('⁰' as u32 + digit as u32 - '0' as u32).unwrap_or(digit),
            };
            format!("10{}", power.to_string().chars().map(superscript).collect::<String>())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!([7, 262_144, 1_000_000].map(count), ["7", "262\u{2009}144", "1\u{2009}000\u{2009}000"]);
        assert_eq!([-3, 2, 14].map(power_of_ten), ["10⁻³", "100", "10¹⁴"]);
        assert_eq!(format!("{:.4} {:.4} {:.4}", Trim(30.0), Trim(0.25), Trim(0.0)), "30 0.25 0");
    }
}
