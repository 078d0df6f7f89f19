//! gonio's goodness of fit, warm, for the comparison with Mitsuba: one request
//! a line of JSON on stdin, one answer a line on stdout. The other side answers
//! the same way (`mitsuba_side.py`), so that both are metered by the same clock
//! from outside. Everything runs on one thread.
//!
//! Besides the built-in subjects it knows `off-alpha`, the planted bug of equal
//! power: GGX drawn with alpha, whose pdf is that of alpha (1 + error).

use gonio::bsdf::{Bsdf, Description, Direction, Sample, Spectrum, Transport};
use gonio::checks::Verdict;
use gonio::engine::{Options, run_here};
use gonio::evidence::Evaluations;
use gonio::models::Metal;
use gonio::models::microfacet::{Distribution, Fresnel, Masking, NormalSampling, Roughness, TorranceSparrow};
use gonio::registry::{Model, Registry, Resolved};
use gonio::suite::{Case, Plan, Settings};
use serde::{Deserialize, Serialize};
use std::error::Error;
use std::io::{BufRead, Write};
use std::sync::Arc;

/// GGX drawn with one roughness and told with another.
struct OffAlpha {
    drawn: TorranceSparrow,
    told: TorranceSparrow,
}

impl Bsdf for OffAlpha {
    fn describe(&self) -> Description {
        Bsdf::describe(&self.drawn)
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> Spectrum {
        Bsdf::eval(&self.drawn, wo, wi, transport)
    }

    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        Bsdf::pdf(&self.told, wo, wi, transport)
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        Bsdf::sample(&self.drawn, wo, u, transport)
    }
}

fn off_alpha() -> Model {
    Model::new("off-alpha", "GGX drawn with alpha, told with alpha (1 + error)", |p| {
        let ggx = |alpha| {
            let distribution = Distribution::ggx(Roughness::isotropic(alpha));
            let fresnel = Fresnel::Conductor(Metal::Copper);
            TorranceSparrow::new(distribution, Masking::Smith, fresnel, NormalSampling::Visible)
        };
        let alpha = p.number("alpha");
        Ok::<_, String>(OffAlpha { drawn: ggx(alpha)?, told: ggx(alpha * (1.0 + p.number("error")))? })
    })
    .number("alpha", 0.1, 1e-3..=0.5, "roughness")
    .number("error", 0.0, 0.0..=1.0, "relative error of the pdf's roughness")
}

/// The check of one subject at one wo, once for each seed.
#[derive(Deserialize)]
struct Request {
    /// As on the command line.
    subject: String,
    /// Degrees.
    theta: f64,
    /// Degrees.
    phi: f64,
    samples: u64,
    false_alarm: f64,
    /// RMS relative cell error that counts as wrong; the subject's own if null.
    tolerance: Option<f64>,
    seeds: Vec<u64>,
}

#[derive(Serialize)]
struct Answer {
    verdicts: Vec<Verdict>,
    /// Of the last seed.
    evaluations: Evaluations,
}

fn answer(registry: &Registry, line: &str) -> Result<Answer, Box<dyn Error>> {
    let request: Request = serde_json::from_str(line)?;
    let Resolved { spelling, parameters, subject } = registry.resolve(&request.subject.parse()?)?;
    let case = Arc::new(Case {
        group: spelling.clone(),
        source: None,
        spelling,
        subject,
        parameters,
        theta_deg: request.theta,
        phi_deg: request.phi,
        transport: Transport::Radiance,
        claims: Default::default(),
        waivers: Vec::new(),
        company: Default::default(),
        reference: None,
        checks: vec!["goodness-of-fit".into()],
        settings: Settings { samples: request.samples, tolerance: request.tolerance, ..Settings::default() },
    });
    let mut verdicts = Vec::new();
    let mut evaluations = Evaluations::default();
    for seed in request.seeds {
        let cases = vec![case.clone()];
        let plan = Plan { suite: "peers".into(), seed, false_alarm: request.false_alarm, share: None, cases };
        let results = run_here(&plan, &Options::default());
        let result = &results.cases[0];
        verdicts.push(result.worst());
        evaluations = result.evidence.as_ref().ok_or("the subject was not measured")?.evaluations;
    }
    Ok(Answer { verdicts, evaluations })
}

fn main() -> Result<(), Box<dyn Error>> {
    let registry = Registry::builtin().register(off_alpha());
    let mut out = std::io::stdout();
    for line in std::io::stdin().lock().lines() {
        serde_json::to_writer(&mut out, &answer(&registry, &line?)?)?;
        writeln!(out)?;
        out.flush()?;
    }
    Ok(())
}
