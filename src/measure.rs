//! A subject measured from a unit test or another program.

use crate::bsdf::{
    Description, Direction, FresnelFunction, NativeCells, NormalDistribution, Samples, Subject, SubjectError,
    SubjectKind, Transport,
};
use crate::checks::Verdict;
use crate::diagnosis::diagnose_here;
use crate::engine::{self, Options, Results};
use crate::registry::Parameters;
use crate::report::Diagnosis;
use crate::suite::{Case, Plan, Settings};
use std::sync::Arc;
use std::time::Duration;

/// What [`assert_valid`] may take: an unoptimised `cargo test` runs gonio
/// itself some twenty times slower than a release build.
const TIME_CAP: Duration = Duration::from_secs(10);

/// Polar angles and azimuths of wo, the most telling first, in case time runs
/// out; azimuths are generic, since a frame in the wrong basis hides at 0.
const DIRECTIONS: [(f64, f64); 6] =
    [(60.0, 257.0), (30.0, 137.0), (85.0, 17.0), (0.0, 17.0), (75.0, 137.0), (89.0, 257.0)];

/// A subject that is only lent.
struct Lent<'a, S>(&'a S);

impl<S: Subject> Subject for Lent<'_, S> {
    fn describe(&self) -> Description {
        self.0.describe()
    }

    fn eval(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        self.0.eval(wo, wi, transport, out)
    }

    fn pdf(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        self.0.pdf(wo, wi, transport, out)
    }

    fn sample(
        &self,
        wo: Direction,
        u: &[f64],
        transport: Transport,
        out: &mut Samples,
    ) -> Result<(), SubjectError> {
        self.0.sample(wo, u, transport, out)
    }

    fn hints(&self, wo: Direction) -> Vec<Direction> {
        self.0.hints(wo)
    }

    fn cells(&self, wo: Direction) -> Option<NativeCells> {
        self.0.cells(wo)
    }

    fn distribution(&self) -> Option<&dyn NormalDistribution> {
        self.0.distribution()
    }

    fn fresnel(&self) -> Option<&dyn FresnelFunction> {
        self.0.fresnel()
    }
}

/// Runs every check on `bsdf` at six directions (twelve where it transmits or
/// is two-sided, in each of its modes of transport), on this thread, for at
/// most `time_cap`; cases that time does not reach are skipped. What is wrong with
/// it [`diagnose_here`] says of the results.
pub fn measure<S: Subject>(bsdf: &S, settings: Settings, time_cap: Duration) -> Results<'_> {
    let description = crate::evidence::Meter::describe(bsdf);
    let (name, kind, claims) = match &description {
        Ok(d) => (d.name.clone(), d.kind, d.claims),
        Err(_) => ("subject".into(), SubjectKind::Bsdf, Default::default()),
    };
    let subject: Arc<dyn Subject + '_> = Arc::new(Lent(bsdf));
    let back = kind.has_directions() && (claims.transmissive || claims.two_sided);
    let directions = if kind.has_directions() { &DIRECTIONS[..] } else { &DIRECTIONS[..1] };
    let mut cases = Vec::new();
    for &(theta, phi) in directions {
        for theta in [Some(theta), back.then_some(180.0 - theta)].into_iter().flatten() {
            for transport in claims.transport.modes() {
                cases.push(Arc::new(Case {
                    group: name.clone(),
                    spelling: name.clone(),
                    source: None,
                    subject: subject.clone(),
                    parameters: Parameters::default(),
                    theta_deg: theta,
                    phi_deg: phi,
                    transport: *transport,
                    claims: Default::default(),
                    waivers: Vec::new(),
                    company: Default::default(),
                    reference: None,
                    checks: Vec::new(),
                    settings: settings.clone(),
                }));
            }
        }
    }
    let plan = Plan { suite: name, seed: 1, false_alarm: 1e-6, share: None, cases };
    engine::run_here(&plan, &Options { deadline: Some(time_cap), ..Options::default() })
}

/// Panics unless `bsdf` passes every check that it claims, with each failure and
/// the cause in the message. The seed is fixed: the same code cannot pass and fail.
/// Takes at most about ten seconds; what was not reached by then is told on
/// stderr, and is no failure.
///
/// # Panics
/// If a check fails or cannot be measured.
pub fn assert_valid<S: Subject>(bsdf: &S) {
    let settings =
        Settings { samples: 1 << 16, detect: f64::INFINITY, time_limit: TIME_CAP, ..Settings::default() };
    let results = measure(bsdf, settings, TIME_CAP);
    if let Some(partial) = &results.partial {
        eprintln!("gonio: {partial}");
    }
    let mut message = String::new();
    for case in &results.cases {
        for finding in &case.findings {
            let verdict = finding.outcome.verdict;
            if matches!(verdict, Verdict::Fail | Verdict::Error) {
                let line = format!(
                    "\n  {:5} {} at {}: {}",
                    verdict.word(),
                    finding.check,
                    case.case.label(),
                    finding.outcome.message
                );
                message.push_str(&line);
                if let Some(place) = &finding.outcome.worst {
                    message.push_str(&format!("\n        worst at {place}"));
                }
            }
        }
    }
    if message.is_empty() {
        return;
    }
    for found in Diagnosis::all(&results, diagnose_here(&results, &[])) {
        message.push_str(&format!("\n{found}"));
    }
    panic!("gonio found the BSDF wrong:{message}");
}
