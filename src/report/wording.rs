//! Numbers of a report in words that people read.

use super::json::{CheckResult, WoAngles};
use crate::checks::{Effect, Verdict};
use crate::evidence::Place;

/// A ratio: in per cent where that reads well, else in powers of ten.
pub fn ratio(value: f64) -> String {
    let size = value.abs();
    if value.is_nan() {
        "not a number".into()
    } else if size.is_infinite() {
        if value > 0.0 { "∞".into() } else { "−∞".into() }
    } else if size == 0.0 {
        "0".into()
    } else if (1e-4..10.0).contains(&size) {
        minus(format!("{:.2} %", 100.0 * value))
    } else {
        minus(format!("{value:.1e}"))
    }
}

fn minus(text: String) -> String {
    match text.strip_prefix('-') {
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// The size of an error, its interval, and what is tolerated.
pub fn effect(effect: &Effect) -> String {
    let Effect { name, value, low, high, tolerance } = effect;
    let tolerated = ratio(tolerance.0);
    if low.0 == 0.0 && high.0 == 0.0 {
        // An estimate whose interval is empty at 0 says no more than this.
        return if tolerance.0 > 0.0 { format!("{name} < {tolerated}") } else { format!("{name} = 0") };
    }
    let exact = low == value && high == value;
    let interval = if exact { String::new() } else { format!(" ({})", range(low.0, high.0)) };
    format!("{name} = {}{interval}, tolerated {tolerated}", ratio(value.0))
}

/// `1.10 to 1.31 %`: the unit once where both have it.
pub fn range(low: f64, high: f64) -> String {
    let (low, high) = (ratio(low), ratio(high));
    match (low.strip_suffix(" %"), high.ends_with(" %")) {
        (Some(number), true) => format!("{number} to {high}"),
        _ => format!("{low} to {high}"),
    }
}

/// A probability by its decimal logarithm.
pub fn probability(log10: f64) -> String {
    if log10.is_nan() {
        "not a number".into()
    } else if log10 == f64::NEG_INFINITY {
        "0".into()
    } else if log10 > -3.0 {
        format!("{:.3}", 10f64.powf(log10.min(0.0)))
    } else {
        // Towards 1: never more certain than it was.
        format!("10^{}", log10.ceil())
    }
}

/// How certain a result is: p, the threshold, and the second run.
pub fn certainty(result: &CheckResult) -> Option<String> {
    let first = result.attempts.first().map(|a| a.log10_p).or(result.log10_p)?;
    let mut text = format!("p = {}", probability(first.0));
    if let Some(threshold) = result.threshold {
        text += &format!(", threshold {}", probability(threshold.0.log10()));
    }
    if let Some(second) = result.attempts.get(1) {
        let word = match result.verdict {
            Verdict::Fail | Verdict::Waived => "confirmed by a second run",
            _ => "not confirmed by a second run",
        };
        text += &format!(", {word}: p = {}", probability(second.log10_p.0));
    }
    Some(text)
}

/// What a result says: its effect, how certain that is, where it is worst, and why.
pub fn facts(result: &CheckResult) -> Vec<String> {
    let mut facts = Vec::new();
    if let Some(found) = &result.effect {
        let channel = result.channel.as_ref().map_or(String::new(), |c| format!(" (channel {c})"));
        facts.push(effect(found) + &channel);
    }
    facts.extend(certainty(result));
    facts.extend(result.worst.as_ref().map(worst));
    facts.push(result.message.clone());
    facts.extend(result.reason.clone().filter(|reason| *reason != result.message));
    facts
}

/// A given direction.
pub fn direction(wo: WoAngles) -> String {
    format!("θo {}° φo {}°", tidy(wo.theta_deg), tidy(wo.phi_deg))
}

/// At most four decimals, and no zeros at their end.
pub fn tidy(value: f64) -> String {
    let text = format!("{value:.4}");
    minus(text.trim_end_matches('0').trim_end_matches('.').to_string())
}

/// Where it is worst, and what was found there.
pub fn worst(place: &Place) -> String {
    let mut text = "worst".to_string();
    if let Some(wi) = place.wi {
        let phi = wi.phi().to_degrees().rem_euclid(360.0);
        text += &format!(" at θi {:.2}° φi {phi:.1}°", wi.theta().to_degrees());
    }
    let values: Vec<String> =
        place.values.iter().map(|(name, v)| format!("{name} = {}", figure(v.0))).collect();
    if !values.is_empty() {
        text += &format!(": {}", values.join(", "));
    }
    text
}

fn figure(value: f64) -> String {
    let size = value.abs();
    if value.is_nan() {
        "not a number".into()
    } else if size != 0.0 && !(1e-3..1e5).contains(&size) {
        minus(format!("{value:.3e}"))
    } else {
        tidy(value)
    }
}

/// Breaks lines at spaces so that they are at most `width` characters; words
/// that are longer stay whole. Lines that are broken already keep their indentation.
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for whole in text.lines() {
        let indent = &whole[..whole.len() - whole.trim_start().len()];
        let mut line = String::new();
        for word in whole.split_whitespace() {
            let used = line.chars().count();
            if used > 0 && used + 1 + word.chars().count() > width {
                lines.push(std::mem::take(&mut line));
            }
            line.push_str(if line.is_empty() { indent } else { " " });
            line.push_str(word);
        }
        lines.push(line);
    }
    if lines.is_empty() { vec![String::new()] } else { lines }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effects_read_well() {
        let of = |value, low, high, tolerance| effect(&Effect::interval("√D", (value, low, high), tolerance));
        assert_eq!(of(0.012, 0.011, 0.0131, 0.003), "√D = 1.20 % (1.10 to 1.31 %), tolerated 0.30 %");
        assert_eq!(of(0.0, 0.0, 0.0, 0.003), "√D < 0.30 %");
        assert_eq!(of(0.0, 0.0, 0.0, 0.0), "√D = 0");
        assert_eq!(of(-0.02, -0.03, 0.01, 1e-9), "√D = −2.00 % (−3.00 to 1.00 %), tolerated 1.0e-9");
        assert_eq!(of(f64::INFINITY, f64::INFINITY, f64::INFINITY, 1e-9), "√D = ∞, tolerated 1.0e-9");
    }

    #[test]
    fn probabilities_are_never_more_certain_than_they_were() {
        let logs = [-0.3, -2.99, -3.0, -34.9, f64::NEG_INFINITY, 0.0];
        let words = ["0.501", "0.001", "10^-3", "10^-34", "0", "1.000"];
        assert_eq!(logs.map(probability), words);
    }

    #[test]
    fn wraps_at_spaces_only() {
        assert_eq!(wrapped("one two three", 7), ["one two", "three"]);
        assert_eq!(wrapped("abcdefghij k", 3), ["abcdefghij", "k"]);
        assert_eq!(
            wrapped("said:\n  File x, line 1\n\nend", 12),
            ["said:", "  File x,", "  line 1", "", "end"]
        );
        assert_eq!(wrapped("", 3), [""]);
    }
}
