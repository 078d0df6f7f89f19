//! What is known of a failing subject.

use super::counts::Counts;
use crate::bsdf::{Cosine, Description, Direction, Lobe, Samples, Spectrum, Subject, SubjectKind, Transport};
use crate::checks::Verdict;
use crate::engine::CaseResult;
use crate::evidence::{Evidence, guarded};
use crate::registry::{Parameters, Value};
use crate::statistics::streams::StreamKey;
use std::collections::BTreeSet;
use std::sync::OnceLock;

/// Cases that are looked at: enough directions to tell wo's terms from wi's, on
/// both sides and in both modes, and no more than that costs.
const CASES: usize = 8;

/// Draws that are looked at again, one by one, for each case.
const DRAWS: usize = 384;

/// Directions spread over each side, besides.
const SPREAD: usize = 64;

/// What the functions return for one direction.
#[derive(Clone, Debug)]
pub struct Point {
    /// The direction.
    pub wi: Direction,
    /// pdf(wo, wi) in sr⁻¹; NaN where there is no such function.
    pub pdf: f64,
    /// eval(wo, wi) in sr⁻¹, cosine excluded.
    pub value: Spectrum,
    /// How it was drawn, where it was.
    pub drawn: Option<Drawn>,
}

/// How a direction was drawn.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// By these numbers.
    pub u: Vec<f64>,
    /// With these flags.
    pub lobe: Lobe,
    /// With this weight.
    pub weight: Spectrum,
    /// With this density.
    pub told: f64,
}

/// A case as explanations see it.
pub struct Seen<'a> {
    /// The given direction.
    pub wo: Direction,
    /// The mode of transport.
    pub transport: Transport,
    /// What was measured.
    pub evidence: &'a Evidence,
    /// Checks that failed here.
    pub failed: BTreeSet<&'static str>,
    /// Directions with what the functions return for them: continuous draws, and
    /// some spread over both sides.
    pub points: Vec<Point>,
    /// Discrete draws: direction, and how it was drawn.
    pub discrete: Vec<(Direction, Drawn)>,
}

/// A failing subject, its cases, and what it says of itself.
pub struct View<'a> {
    /// What it says of itself, with the claims in force.
    pub description: Description,
    /// The parameters that it declares.
    pub parameters: Parameters,
    /// Whether any of these is a number.
    pub declares_numbers: bool,
    /// Checks that failed somewhere.
    pub failed: BTreeSet<&'static str>,
    /// Its cases: failing ones, and of the others some.
    pub cases: Vec<Seen<'a>>,
    /// What it was compared with.
    pub reference: Option<&'a dyn Subject>,
    /// Counts of its first cases, once they were asked for.
    pub(super) counted: OnceLock<Vec<(usize, Counts)>>,
    subject: &'a dyn Subject,
}

fn failed(case: &CaseResult) -> BTreeSet<&'static str> {
    case.findings.iter().filter(|f| f.outcome.verdict == Verdict::Fail).map(|f| f.check).collect()
}

impl<'a> View<'a> {
    /// Of the cases of one subject; `None` where none failed, or nothing was measured.
    pub fn gather<'s: 'a>(cases: &[&'a CaseResult<'s>], parameters: &Parameters) -> Option<Self> {
        let measured: Vec<(&'a CaseResult<'s>, &'a Evidence)> =
            cases.iter().filter_map(|c| Some((*c, c.evidence.as_ref()?))).collect();
        let failed_anywhere: BTreeSet<_> = measured.iter().flat_map(|(c, _)| failed(c)).collect();
        let (first, evidence) = measured.first()?;
        if failed_anywhere.is_empty() {
            return None;
        }
        let mut view = Self {
            description: evidence.description.clone(),
            declares_numbers: parameters.0.values().any(|v| matches!(v, Value::Number(_))),
            parameters: parameters.clone(),
            failed: failed_anywhere,
            cases: Vec::new(),
            reference: first.case.company.reference.as_ref().map(|(_, subject)| &**subject as _),
            counted: OnceLock::new(),
            subject: &*first.case.subject,
        };
        // A claim declares as much.
        if let Some(eta) = view.description.claims.eta {
            view.parameters.0.entry("eta".into()).or_insert(Value::Number(eta));
        }
        // Those that fail most first; away from the normal, where terms differ.
        let mut order: Vec<_> = measured.iter().collect();
        let oblique = |c: &CaseResult| c.case.wo().z.abs() < 0.9999;
        order.sort_by_key(|(c, _)| (!oblique(c), usize::MAX - failed(c).len()));
        for (case, evidence) in order.into_iter().take(CASES) {
            let seen = view.look(case, evidence);
            view.cases.push(seen);
        }
        Some(view)
    }

    fn look(&self, case: &CaseResult, evidence: &'a Evidence) -> Seen<'a> {
        let (wo, transport) = (evidence.wo, evidence.transport);
        let mut seen =
            Seen { wo, transport, evidence, failed: failed(case), points: Vec::new(), discrete: Vec::new() };
        if self.description.kind == SubjectKind::Fresnel {
            return seen;
        }
        let mut directions: Vec<(Direction, Option<Drawn>)> = Vec::new();
        for (wi, drawn) in self.draws(evidence, wo, transport) {
            if drawn.lobe.is_discrete() {
                seen.discrete.push((wi, drawn));
            } else {
                directions.push((wi, Some(drawn)));
            }
        }
        directions.extend(spread().map(|wi| (wi, None)));
        let wi: Vec<Direction> = directions.iter().map(|d| d.0).collect();
        let pdf = self.pdf(wo, &wi, transport);
        let value = self.eval(wo, &wi, transport);
        for (k, (wi, drawn)) in directions.into_iter().enumerate() {
            seen.points.push(Point { wi, pdf: pdf[k], value: value[k], drawn });
        }
        seen
    }

    /// Draws with their numbers; what is no sample is left out.
    fn draws(&self, evidence: &Evidence, wo: Direction, transport: Transport) -> Vec<(Direction, Drawn)> {
        let d = self.description.dimensions.max(1);
        let mut u = vec![0.0; DRAWS * d];
        let key = StreamKey::new(0)
            .with("subject", evidence.description.key(&evidence.subject))
            .with("stage", "diagnosis");
        key.with("wo", &format!("{:x} {:x}", wo.x.to_bits(), wo.z.to_bits())).block(0).fill(false, &mut u);
        let samples = self.sample(wo, &u, transport);
        let sound = |k: &usize| {
            let unit = (samples.wi[*k].length() - 1.0).abs() < 1e-6;
            samples.lobe[*k].is_valid() && samples.pdf[*k] > 0.0 && unit
        };
        let drawn = |k: usize| {
            let (u, weight) = (u[k * d..(k + 1) * d].to_vec(), Spectrum::from(samples.weight_of(k)));
            (samples.wi[k], Drawn { u, lobe: samples.lobe[k], weight, told: samples.pdf[k] })
        };
        (0..samples.len()).filter(sound).map(drawn).collect()
    }

    /// Channels of its values.
    pub fn channels(&self) -> usize {
        self.description.channels.len().max(1)
    }

    /// f, cosine excluded; NaN where the function does not return.
    pub fn eval(&self, wo: Direction, wi: &[Direction], transport: Transport) -> Vec<Spectrum> {
        let channels = self.channels();
        let mut out = vec![f64::NAN; wi.len() * channels];
        if self.description.has.eval {
            let called = guarded("eval", || self.subject.eval(wo, wi, transport, &mut out));
            if called.is_err() {
                out.fill(f64::NAN);
            }
        }
        let found = self.cases.first().and_then(|c| c.evidence.cosine_found);
        let included = found.unwrap_or(self.description.claims.cosine) == Cosine::Included;
        let row = |(row, wi): (&[f64], &Direction)| {
            let scale = if included { 1.0 / wi.abs_cos_theta() } else { 1.0 };
            Spectrum::from(row).map(|f| f * scale)
        };
        out.chunks_exact(channels).zip(wi).map(row).collect()
    }

    /// Densities; NaN where the function does not return.
    pub fn pdf(&self, wo: Direction, wi: &[Direction], transport: Transport) -> Vec<f64> {
        let mut out = vec![f64::NAN; wi.len()];
        if self.description.has.pdf {
            let called = guarded("pdf", || self.subject.pdf(wo, wi, transport, &mut out));
            if called.is_err() {
                out.fill(f64::NAN);
            }
        }
        out
    }

    /// Draws as they come, sound or not; none where the function does not return.
    pub fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Samples {
        let mut samples = Samples::default();
        samples.clear(self.channels());
        if self.description.has.sample {
            let called = guarded("sample", || self.subject.sample(wo, u, transport, &mut samples));
            let rows = u.len() / self.description.dimensions.max(1);
            if called.is_err() || samples.len() != rows || samples.pdf.len() != rows {
                samples.clear(self.channels());
            }
        }
        samples
    }

    /// The subject itself.
    pub fn subject(&self) -> &'a dyn Subject {
        self.subject
    }

    /// Whether one of these failed.
    pub fn fails_any(&self, checks: &[&str]) -> bool {
        checks.iter().any(|c| self.failed.contains(c))
    }

    /// A declared number.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.parameters.0.get(name)? {
            Value::Number(v) => Some(*v),
            Value::Text(_) => None,
        }
    }
}

/// Directions of a spiral over both sides, off the horizon.
fn spread() -> impl Iterator<Item = Direction> {
    const GOLDEN: f64 = 2.399_963_229_728_653;
    (0..2 * SPREAD).map(|k| {
        let cos = 1.0 - (k as f64 + 0.5) / SPREAD as f64;
        Direction::from_angles(cos.acos(), 0.3 + GOLDEN * k as f64)
    })
}
