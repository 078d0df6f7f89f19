//! The command that measures one case again, alone.

use super::file::SEED;
use super::plan::{Case, Plan, Settings};
use crate::bsdf::TransportModes;
use crate::evidence::Meter;
use serde_json::Value;

/// What to type to have `case` judged by `check` alone, on the terms of its
/// plan: `share` is the false-alarm share of one test. Waivers are left out: who
/// types this wants to see the failure.
pub fn reproduce(program: &str, plan: &Plan, case: &Case, share: f64, check: &str) -> String {
    let mut words = vec![program.to_string(), "check".into(), case.spelling.clone()];
    let mut option = |name: &str, value: String| words.extend([format!("--{name}"), value]);
    option("theta", case.theta_deg.to_string());
    option("phi", case.phi_deg.to_string());
    let claims = Meter::describe(&*case.subject).map(|d| d.claims).unwrap_or_default();
    let modes = case.claims.over(claims).transport;
    if modes == TransportModes::Both || modes.modes() != [case.transport] {
        option("transport", case.transport.to_string());
    }
    if plan.seed != SEED {
        option("seed", plan.seed.to_string());
    }
    let (default, own) = (Settings::default(), &case.settings);
    if own.samples != default.samples {
        option("samples", own.samples.to_string());
    }
    if let Some(tolerance) = own.tolerance {
        option("tolerance", tolerance.to_string());
    }
    if own.detect != default.detect {
        option("detect", own.detect.to_string());
    }
    if own.time_limit != default.time_limit {
        option("time-limit", own.time_limit.as_secs_f64().to_string());
    }
    let (usual, limits) = (&default.limits, &own.limits);
    if limits.call != usual.call {
        option("call-limit", limits.call.as_secs_f64().to_string());
    }
    if limits.memory != usual.memory {
        option("memory", limits.mebibytes().to_string());
    }
    if let Some(reference) = &case.reference {
        option("reference", reference.clone());
    }
    if let Ok(Value::Object(claims)) = serde_json::to_value(&case.claims) {
        for (name, value) in claims.iter().filter(|(_, value)| !value.is_null()) {
            let value = value.as_str().map_or_else(|| value.to_string(), str::to_string);
            option("claim", format!("{name}={value}"));
        }
    }
    option("share", format!("{share:e}"));
    option("check", check.into());
    if limits.in_process {
        words.push("--in-process".into());
    }
    words.iter().map(|w| quoted(w)).collect::<Vec<_>>().join(" ")
}

/// A word that a POSIX shell reads as it is.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=,@%+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_string()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn words_survive_a_shell() {
        let words = ["", "a b", "it's", "$HOME", "*", "x:alpha=0.1,f=ggx", "~", "\\", "\"q\"", "θ;rm"];
        for word in words {
            let run = std::process::Command::new("sh")
                .args(["-c", &format!("printf %s {}", quoted(word))])
                .output();
            assert_eq!(String::from_utf8_lossy(&run.unwrap().stdout), word);
        }
        assert_eq!(quoted("x:alpha=0.1,f=ggx"), "x:alpha=0.1,f=ggx");
    }
}
