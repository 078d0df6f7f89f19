//! Whether a plugin keeps the conventions that it declares.
//!
//! What contradicts them is measured as it is, and told: a convention is no bug, and
//! as one it would hide the others.

use super::conventions::{Conventions, Failure, Given, Up, Weight};
use super::subject::Foreign;
use crate::bsdf::{Cosine, Direction, Precision, Samples, Subject, Transport};
use crate::statistics::streams::StreamKey;
use std::time::{Duration, Instant};

/// Draws at each of the given directions.
const DRAWS: usize = 64;

/// What a probe may take: a slow plugin is left to the measurement.
const LONGEST: Duration = Duration::from_secs(20);

/// θ and φ of the given directions in degrees: generic ones.
const GIVEN: [(f64, f64); 3] = [(25.0, 17.0), (50.0, 137.0), (70.0, 257.0)];

/// A convention is taken for the one in force where it holds for all but a few draws,
/// which may be those of a bug.
const MOST: f64 = 0.95;

/// A declared one that holds for so few is contradicted.
const FEW: f64 = 0.05;

/// The conventions in force, and what of `declared` they contradict. A plugin that
/// does not answer is left to the measurement.
pub fn conventions(subject: &Foreign, declared: Conventions) -> (Conventions, Vec<String>) {
    let description = subject.describe();
    if !(description.has.eval && description.has.pdf && description.has.sample)
        || description.claims.stochastic
    {
        return (declared, Vec::new());
    }
    let mut found = declared;
    let mut told = Vec::new();
    let deadline = Instant::now() + LONGEST;
    let Some(mut draws) = draw(subject, deadline) else { return (declared, told) };
    if let Some((other, theirs)) = frame(subject, declared, &draws, deadline) {
        if other.up != declared.up {
            let axis = |up| if up == Up::Z { "z" } else { "y" };
            let (is, said) = (axis(other.up), axis(declared.up));
            told.push(format!("its samples lie around +{is}, not +{said}: declare `up` = \"{is}\""));
        }
        if other.given != declared.given {
            let word = |given| if given == Given::Away { "away" } else { "towards" };
            let (is, said) = (word(other.given), word(declared.given));
            told.push(format!(
                "it samples only if the given direction points {is} and not {said}: declare `given` = \"{is}\""
            ));
        }
        (found, draws) = (other, theirs);
    }
    if found.failure == Failure::Flags && draws.iter().any(Draw::is_void) && draws.iter().any(Draw::is_good) {
        told.push(
            "some samples have weight 0 and pdf 0, and flags of a sample: declare `failure` = \"zero-pdf\", or \
             return flags of 0"
                .into(),
        );
        found.failure = Failure::ZeroPdf;
    }
    let good: Vec<&Draw> = draws.iter().filter(|draw| draw.is_good()).collect();
    if let Some(weight) = weight(subject, found, &good, deadline) {
        let (is, said) = (weight.word(), found.weight.word());
        told.push(format!("its weights are {is}, not {said}: declare `weight` = \"{is}\""));
        found.weight = weight;
    }
    (found, told)
}

/// A draw, with the value and density where it went.
struct Draw {
    wo: Direction,
    wi: Direction,
    /// As it is in gonio's convention if the declared one is right.
    weight: f64,
    returned_pdf: f64,
    continuous: bool,
    eval: f64,
    pdf: f64,
}

impl Draw {
    /// A sample that is none.
    fn is_void(&self) -> bool {
        self.continuous && self.returned_pdf == 0.0 && (self.weight == 0.0 || self.weight.is_nan())
    }

    /// One that says something about weights.
    fn is_good(&self) -> bool {
        self.continuous && self.pdf > 0.0 && self.eval > 0.0 && self.weight > 0.0 && self.pdf.is_finite()
    }
}

/// The given directions, over both sides where the subject has two.
fn given(subject: &dyn Subject) -> Vec<Direction> {
    let claims = subject.describe().claims;
    let front =
        GIVEN.iter().map(|(t, p): &(f64, f64)| Direction::from_angles(t.to_radians(), p.to_radians()));
    let back = front.clone().map(Direction::flipped).filter(|_| claims.transmissive || claims.two_sided);
    front.chain(back).collect()
}

fn random_numbers(k: usize, dimensions: usize) -> Vec<f64> {
    let mut u = vec![0.0; DRAWS * dimensions.max(1)];
    StreamKey::new(0).with("stage", "probe of conventions").block(k as u64).fill(true, &mut u);
    u
}

/// `None` where it does not answer.
fn draw(subject: &dyn Subject, deadline: Instant) -> Option<Vec<Draw>> {
    let description = subject.describe();
    let channels = description.channels.len();
    let mut draws = Vec::new();
    for (k, wo) in given(subject).into_iter().enumerate() {
        if Instant::now() > deadline {
            return None;
        }
        let mut samples = Samples::default();
        samples.clear(channels);
        let u = random_numbers(k, description.dimensions);
        if subject.sample(wo, &u, Transport::Radiance, &mut samples).is_err() {
            return None;
        }
        // What is no sample has no direction to ask for.
        for (wi, lobe) in samples.wi.iter_mut().zip(&samples.lobe) {
            if !lobe.is_valid() {
                *wi = wo;
            }
        }
        let n = samples.len();
        let (mut eval, mut pdf) = (vec![0.0; n * channels], vec![0.0; n]);
        if subject.eval(wo, &samples.wi, Transport::Radiance, &mut eval).is_err()
            || subject.pdf(wo, &samples.wi, Transport::Radiance, &mut pdf).is_err()
        {
            return None;
        }
        draws.extend((0..n).map(|j| Draw {
            wo,
            wi: samples.wi[j],
            // The first channel speaks for all.
            weight: samples.weight_of(j)[0],
            returned_pdf: samples.pdf[j],
            continuous: samples.lobe[j].is_continuous(),
            eval: eval[j * channels],
            pdf: pdf[j],
        }));
    }
    Some(draws)
}

/// Other axes and senses and the draws under them, where samples come as they should and
/// under the declared ones they do not.
fn frame(
    subject: &Foreign,
    declared: Conventions,
    draws: &[Draw],
    deadline: Instant,
) -> Option<(Conventions, Vec<Draw>)> {
    let claims = subject.describe().claims;
    let told = matches!(declared.up, Up::Frame(_));
    if told || claims.transmissive || claims.two_sided || !claims.reflective {
        // A frame is not guessed, and samples may lie anywhere.
        return None;
    }
    // Half of them where the normal is another axis.
    if above(draws) > 0.75 {
        return None;
    }
    let others =
        [Up::Z, Up::Y].into_iter().flat_map(|up| [Given::Away, Given::Towards].map(|given| (up, given)));
    let others = others.map(|(up, given)| Conventions { up, given, ..declared }).filter(|c| *c != declared);
    let drawn = others.filter_map(|c| Some((c, draw(&subject.under(c), deadline)?)));
    // Changes of one thing come before changes of both.
    drawn
        .filter(|(_, draws)| above(draws) > MOST)
        .min_by_key(|(c, _)| usize::from(c.up != declared.up) + usize::from(c.given != declared.given))
}

/// Share of samples that lie above the surface; 0 where few draws are samples.
fn above(draws: &[Draw]) -> f64 {
    let samples: Vec<&Draw> = draws.iter().filter(|d| d.continuous && d.returned_pdf > 0.0).collect();
    if samples.len() * 4 < draws.len().max(1) {
        return 0.0;
    }
    samples.iter().filter(|d| d.wi.z > 0.0).count() as f64 / samples.len() as f64
}

/// Another convention of weights that holds where the declared one does not.
fn weight(subject: &Foreign, found: Conventions, draws: &[&Draw], deadline: Instant) -> Option<Weight> {
    let description = subject.describe();
    let tolerance = match description.precision {
        Precision::F64 => 1e-6,
        Precision::F32 => 1e-3,
    };
    // Where |cos θi| and pdf are 1 the conventions are one.
    let telling: Vec<&&Draw> =
        draws.iter().filter(|d| (d.wi.z.abs() - 1.0).abs() > 0.01 && (d.pdf - 1.0).abs() > 0.01).collect();
    if telling.len() < DRAWS / 4 {
        return None;
    }
    let holds = |candidate: Weight| -> f64 {
        let agreeing = telling.iter().filter(|d| {
            let cos = d.wi.abs_cos_theta();
            let f = if description.claims.cosine == Cosine::Included { d.eval / cos } else { d.eval };
            let raw = d.weight / found.weight.factor(cos, d.returned_pdf);
            let (is, due) = (raw * candidate.factor(cos, d.returned_pdf), f * cos / d.pdf);
            (is - due).abs() <= tolerance * due.abs()
        });
        agreeing.count() as f64 / telling.len() as f64
    };
    if holds(found.weight) > FEW {
        return None;
    }
    let other = Weight::ALL.into_iter().find(|w| *w != found.weight && holds(*w) > MOST)?;
    // A cosine in eval that is declared otherwise looks the same. It breaks reciprocity.
    let by_cosine = matches!(
        (found.weight, other),
        (Weight::FCosOverPdf, Weight::FOverPdf)
            | (Weight::FOverPdf, Weight::FCosOverPdf)
            | (Weight::FCos, Weight::F)
            | (Weight::F, Weight::FCos)
    );
    (!by_cosine || description.claims.reciprocal && is_reciprocal(subject, &telling, tolerance, deadline))
        .then_some(other)
}

/// Whether eval, as declared, is the same both ways at most of these draws.
fn is_reciprocal(subject: &Foreign, draws: &[&&Draw], tolerance: f64, deadline: Instant) -> bool {
    let description = subject.describe();
    let mut value = vec![0.0; description.channels.len()];
    let agreeing = draws.iter().filter(|d| {
        let answered =
            Instant::now() < deadline && subject.eval(d.wi, &[d.wo], Transport::Radiance, &mut value).is_ok();
        let (there, back) = match description.claims.cosine {
            Cosine::Included => (d.eval / d.wi.abs_cos_theta(), value[0] / d.wo.abs_cos_theta()),
            Cosine::Excluded => (d.eval, value[0]),
        };
        // η² of a transmitted pair belongs to another question.
        answered && d.wo.same_side(d.wi) && (there - back).abs() <= tolerance * there.abs()
    });
    agreeing.count() as f64 > MOST * draws.iter().filter(|d| d.wo.same_side(d.wi)).count() as f64
}
