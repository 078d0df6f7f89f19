//! `gonio check`.

use super::args::{Measuring, number, seconds};
use super::error::CliError;
use super::request::Request;
use crate::bsdf::{ClaimsPatch, Transport};
use crate::registry::{Registry, Spelling};
use crate::suite::{Entry, Mistake, PHI, Plan, SuiteError, SuiteFile, expand, fraction, positive, set_claim};
use clap::ValueEnum;
use std::ops::Range;
use std::time::Duration;
use toml::Spanned;

/// Arguments of `gonio check`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Without --theta, the six polar angles of a suite are measured, at both sides of \
    a subject that has two, each at one of its three azimuths in turn.")]
pub struct CheckArgs {
    /// NAME or NAME:KEY=VALUE,KEY=VALUE (`gonio list` shows them), or a measured file.
    pub subject: String,
    /// How to measure.
    #[command(flatten)]
    pub measuring: Measuring,
    /// Only this mode of transport; those that the subject claims if left out.
    #[arg(long, value_enum, value_name = "MODE")]
    pub transport: Option<Mode>,
    /// Probability of a false alarm in one test, in place of a share of --false-alarm.
    #[arg(long, value_name = "P", value_parser = in_0_1, conflicts_with = "false_alarm")]
    pub share: Option<f64>,
    /// Probability that a correct subject fails at all.
    #[arg(long, value_name = "P", value_parser = in_0_1)]
    pub false_alarm: Option<f64>,
    /// RMS relative error that counts as wrong; by the subject's precision if left out.
    #[arg(long, value_name = "X", value_parser = in_0_1)]
    pub tolerance: Option<f64>,
    /// A pass must have been able to see this much.
    #[arg(long, value_name = "X", value_parser = above_0)]
    pub detect: Option<f64>,
    /// Compare with this subject.
    #[arg(long, value_name = "SUBJECT")]
    pub reference: Option<String>,
    /// A claim in place of the subject's own, as reciprocal=false (may be repeated).
    #[arg(long, value_name = "NAME=VALUE", value_parser = pair)]
    pub claim: Vec<(String, String)>,
    /// What one direction may take.
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub time_limit: Option<f64>,
}

/// A mode of transport.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Mode {
    /// Light.
    Radiance,
    /// Its adjoint.
    Importance,
}

impl From<Mode> for Transport {
    fn from(mode: Mode) -> Self {
        match mode {
            Mode::Radiance => Self::Radiance,
            Mode::Importance => Self::Importance,
        }
    }
}

fn in_0_1(text: &str) -> Result<f64, String> {
    number(text, fraction)
}

fn above_0(text: &str) -> Result<f64, String> {
    number(text, positive)
}

fn pair(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE, as reciprocal=false")?;
    Ok((name.into(), value.into()))
}

impl CheckArgs {
    /// The plan of this one subject.
    pub fn request(&self, registry: &Registry) -> Result<Request, CliError> {
        if !self.measuring.outputs.to.is_empty() && self.measuring.out.is_none() {
            return Err(CliError::Usage {
                message: "--to writes beside a report, and `check` writes none without a folder".into(),
                help: "name the folder: --out DIR".into(),
            });
        }
        Ok(Request { full: true, ..Request::new(vec![self.plan(registry)?], &self.measuring, registry)? })
    }

    fn plan(&self, registry: &Registry) -> Result<Plan<'static>, CliError> {
        let mut typed = Typed::default();
        let entry = self.entry(&mut typed, registry)?;
        let mut file = SuiteFile::new("check", SOURCE, &typed.text);
        file.false_alarm = self.false_alarm.unwrap_or(file.false_alarm);
        file.settings.tolerance = self.tolerance;
        file.settings.detect = self.detect.unwrap_or(file.settings.detect);
        file.settings.time_limit = self.time_limit.map_or(file.settings.time_limit, Duration::from_secs_f64);
        file.transport = self.transport.map(Transport::from);
        file.entries.push(entry);
        file.apply(&self.measuring.overrides());
        let mut plan = expand(&file, registry)?.plan;
        plan.share = self.share;
        if self.measuring.phi.is_empty() {
            // One azimuth for each polar angle, in turn.
            plan.cases.retain(|case| {
                let place = |theta: f64| file.theta.iter().position(|t| *t == theta);
                let other = || file.theta.iter().position(|t| 180.0 - t == case.theta_deg);
                let k = place(case.theta_deg).or_else(other).unwrap_or(0);
                case.phi_deg == PHI[k % PHI.len()]
            });
        }
        Ok(plan)
    }

    fn entry(&self, typed: &mut Typed, registry: &Registry) -> Result<Entry, CliError> {
        let spelled = |text: &str| registry.spelling_of_file(text).unwrap_or_else(|| text.into());
        let subject = spelled(&self.subject);
        let span = typed.push(&subject);
        let wrong = |typed: &Typed, m: Mistake| SuiteError::new(SOURCE, &typed.text, vec![m]);
        let spelling: Spelling = match subject.parse() {
            Ok(spelling) => spelling,
            Err(e) => return Err(wrong(typed, Mistake::of_registry(span, &e)).into()),
        };
        let mut parameters: Vec<(Spanned<String>, Vec<_>)> = Vec::new();
        let rest = (spelling.name.len() + 1).min(subject.len());
        let parts = Spelling::parts(&subject[rest..]);
        for ((start, part), (key, value)) in parts.into_iter().zip(&spelling.parameters) {
            let start = rest + start;
            let key_span = start..start + key.len();
            if parameters.iter().any(|(k, _)| k.get_ref() == key) {
                let mistake = Mistake::new(key_span, format!("`{key}` is given twice"), "the second time");
                return Err(wrong(typed, mistake.help("a subject has one value of each")).into());
            }
            let value = Spanned::new(start + key.len() + 1..start + part.len(), value.clone());
            parameters.push((Spanned::new(key_span, key.clone()), vec![value]));
        }
        let reference = self.reference.as_ref().map(|text| {
            typed.push("--reference");
            let text = spelled(text);
            Spanned::new(typed.push(&text), text)
        });
        let mut claims = ClaimsPatch::default();
        for (name, value) in &self.claim {
            typed.push("--claim");
            let all = typed.push(&format!("{name}={value}"));
            let name_end = all.start + name.len();
            let json = serde_json::from_str(value).unwrap_or_else(|_| value.as_str().into());
            set_claim(&mut claims, (name, all.start..name_end), (json, name_end + 1..all.end))
                .map_err(|m| wrong(typed, m))?;
        }
        Ok(Entry {
            model: Spanned::new(0..spelling.name.len(), spelling.name),
            label: None,
            parameters,
            claims,
            waivers: Vec::new(),
            reference,
            theta: None,
            phi: None,
            cover: None,
            samples: None,
        })
    }
}

const SOURCE: &str = "the command line";

/// The part of the command line that messages show, put together as it is read.
#[derive(Default)]
struct Typed {
    text: String,
}

impl Typed {
    fn push(&mut self, word: &str) -> Range<usize> {
        if !self.text.is_empty() {
            self.text.push(' ');
        }
        let start = self.text.len();
        self.text.push_str(word);
        start..self.text.len()
    }
}

#[cfg(test)]
mod tests {
    use super::super::args::{Args, Command};
    use super::*;
    use crate::suite::tests::registry;
    use crate::suite::{EMBEDDED, Overrides, load, reproduce};
    use clap::Parser;

    fn check_of(registry: &Registry, line: &str) -> Result<Plan<'static>, CliError> {
        let Command::Check(args) = Args::parse_from(line.split(' ')).command else { panic!("{line}") };
        args.plan(registry)
    }

    fn check(line: &str) -> Result<Plan<'static>, CliError> {
        check_of(&registry(), line)
    }

    fn lines(line: &str) -> Vec<String> {
        match check(line) {
            Err(CliError::Suite(e)) => e.lines(),
            Err(e) => vec![e.to_string()],
            Ok(_) => Vec::new(),
        }
    }

    #[test]
    fn six_polar_angles_with_azimuths_in_turn() {
        let directions = |line: &str| -> Vec<_> {
            check(line).unwrap().cases.iter().map(|c| (c.theta_deg, c.phi_deg)).collect()
        };
        let six = [(0.0, 17.0), (30.0, 137.0), (60.0, 257.0), (75.0, 17.0), (85.0, 137.0), (89.0, 257.0)];
        assert_eq!(directions("gonio check lambert"), six);
        assert_eq!(directions("gonio check lambert --theta 40"), [(40.0, 17.0)]);
        assert_eq!(directions("gonio check lambert --theta 40 --phi 1 --phi 2"), [(40.0, 1.0), (40.0, 2.0)]);
        // Two sides, two modes.
        assert_eq!(directions("gonio check dielectric").len(), 24);
        assert_eq!(directions("gonio check dielectric --theta 150 --transport importance"), [(150.0, 17.0)]);
    }

    #[test]
    fn mistakes_are_shown_with_what_to_type() {
        for (line, part) in [
            ("gonio check lambart", "did you mean `lambert`?"),
            ("gonio check lambert:reflectence=1", "did you mean `reflectance`?"),
            ("gonio check lambert:reflectance", "is not KEY=VALUE"),
            ("gonio check lambert:reflectance=2", "did you mean `1`?"),
            ("gonio check lambert:reflectance=1,reflectance=0", "given twice"),
            ("gonio check lambert --reference lambart", "did you mean `lambert`?"),
            ("gonio check lambert --claim loss=true", "did you mean `lossless`?"),
            ("gonio check lambert --claim lossless=3", "cannot be 3"),
        ] {
            let found = lines(line);
            assert!(found.len() == 1 && found[0].contains(part), "{line}: {found:?}");
        }
        let error = check("gonio check lambert:reflectance=0.5,sampling=cosin").err().unwrap();
        assert_eq!(error.exit(), super::super::Exit::Usage);
        let CliError::Suite(error) = error else { panic!() };
        assert_eq!((error.mistakes[0].span.offset(), error.mistakes[0].span.len()), (33, 5));
    }

    fn assert_same(registry: &Registry, plan: &Plan, share: f64) {
        for case in &plan.cases {
            let line = reproduce("gonio", plan, case, share, "goodness-of-fit");
            let again = check_of(registry, &line).unwrap_or_else(|e| panic!("{line}: {e}"));
            assert_eq!(again.cases.len(), 1, "{line}");
            let one = &again.cases[0];
            assert_eq!((again.seed, again.share), (plan.seed, Some(share)), "{line}");
            assert_eq!(one.label(), case.label());
            assert_eq!((&one.parameters, &one.claims), (&case.parameters, &case.claims), "{line}");
            assert_eq!((&one.settings, &one.reference), (&case.settings, &case.reference), "{line}");
            assert_eq!(
                (one.transport, &one.checks[..]),
                (case.transport, &["goodness-of-fit".to_string()][..])
            );
            let variants = |c: &crate::suite::Case| -> Vec<_> {
                c.company.variants.iter().map(|v| (v.parameter.clone(), v.to.clone(), v.limit)).collect()
            };
            assert_eq!(variants(one), variants(case), "{line}");
        }
    }

    #[test]
    fn a_reproducing_command_gives_the_same_case_terms_and_share() {
        let builtin = Registry::builtin();
        for suite in &EMBEDDED[..2] {
            let plan = load(suite.name, suite.text, &builtin, &Overrides::default()).ok().unwrap().plan;
            assert_same(&builtin, &plan, 1e-6 / 4321.0);
        }
        let text = "[suite]\nseed=7\nsamples=12345\ntolerance=0.01\ndetect=0.2\ntime_limit=2.5\ntheta=[12.5,100]\nphi=-0.1\n\
            [[subject]]\nuse='dielectric'\nreference='lambert:reflectance=0.1'\n\
            claims={lossless=true,eta=1.25,off_support='zero-weight',transport='importance'}";
        let plan = load("t", text, &registry(), &Overrides::default()).ok().unwrap().plan;
        assert_eq!(plan.cases.len(), 4);
        assert_same(&registry(), &plan, 0.1 + 0.2);
    }

    #[test]
    fn only_what_differs_from_the_defaults_is_spelled() {
        let plan = check("gonio check lambert --theta 30").unwrap();
        let line = reproduce("gonio", &plan, &plan.cases[0], 1e-9, "mis");
        assert_eq!(line, "gonio check lambert --theta 30 --phi 17 --share 1e-9 --check mis");
    }
}
