//! What changes when a parameter changes, at limits, and on the other side.

use super::draws::BLOCK;
use super::integrals::expected_directions;
use super::meter::{Halt, Meter, Watch};
use super::parts;
use super::probes;
use super::samples::{DiscreteDraw, Pilot, discrete_lobes};
use super::setup::Setup;
use super::tally::{Place, Tally, relative_error};
use crate::bsdf::{Direction, RandomNumbers, Samples, Subject, SubjectError, SubjectKind};
use crate::evidence::Figure;
use crate::registry::Role;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The same model with one parameter changed.
#[derive(Clone)]
pub struct Variant<'a> {
    /// Which parameter.
    pub parameter: String,
    /// Its value in the case.
    pub from: String,
    /// Its value here.
    pub to: String,
    /// At `to`, this limit must be reached.
    pub limit: Option<Role>,
    /// Makes the changed subject; `None` where the model refuses the change. Made
    /// when it is measured, and only if it is: some models take long to make.
    pub build: Arc<Build<'a>>,
}

/// Makes a subject, or cannot.
pub type Build<'a> = dyn Fn() -> Option<Arc<dyn Subject + 'a>> + Send + Sync + 'a;

/// What a changed parameter did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Variation {
    /// Which parameter.
    pub parameter: String,
    /// Its value in the case.
    pub from: String,
    /// The other value.
    pub to: String,
    /// Largest relative difference of eval, pdf or samples; infinite where
    /// even the channels differ.
    pub change: Figure,
    /// The limit tried, with what was measured there.
    pub limit: Option<Limit>,
}

/// What was found at a limit of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Limit {
    /// Median angle, in radians, between samples and the nearest of mirror and
    /// refracted directions, of normals the surface's, at this roughness.
    Narrow {
        /// The angle.
        median: Figure,
        /// The roughness.
        roughness: f64,
    },
    /// Share of flux that is reflected where the index is 1.
    Transparent {
        /// E[weight] over samples on wo's side, largest channel.
        reflected: Figure,
    },
}

/// A change below this is rounding.
pub const CHANGE: f64 = 1e-9;

const ROWS: usize = 128;
const LIMIT_DRAWS: usize = 1024;

impl Variation {
    /// Compares each variant with the subject itself.
    pub fn gather(
        meter: &Meter,
        setup: &Setup,
        pilot: &Pilot,
        watch: &Arc<Watch>,
        variants: &[Variant],
    ) -> Result<Vec<Self>, Halt> {
        let wi = probes::directions(setup, pilot, ROWS);
        // A parameter may well do nothing at the case's own wo: masking of a
        // smooth surface begins within a fraction of a degree of the horizon, and
        // beyond the critical angle (14.5° for an index of 4) all is reflected.
        let given = [setup.wo, oblique(setup, 60.0), oblique(setup, 89.9), oblique(setup, 10.0)];
        let own = Response::of(meter, setup, &given, &wi)?;
        let mut all = Vec::new();
        for variant in variants {
            // One value that changes something is enough; limits are for themselves.
            let known = all.iter().any(|v: &Self| v.parameter == variant.parameter && v.change.0 > CHANGE);
            if known && variant.limit.is_none() {
                continue;
            }
            let Some(subject) = (variant.build)() else { continue };
            // What goes wrong there is not the subject at its own parameters.
            let there = |halt: Halt| match halt {
                Halt::Subject(e @ (SubjectError::Panicked { .. } | SubjectError::Refused(_))) => {
                    let (name, value) = (&variant.parameter, &variant.to);
                    Halt::Subject(SubjectError::Refused(format!(
                        "with {name} = {value} in place of {}: {e}",
                        variant.from
                    )))
                }
                other => other,
            };
            let description = Meter::describe(&*subject).map_err(|e| there(e.into()))?;
            let other = Meter::new(&*subject, description, watch.clone());
            // As the case itself is measured, whatever the variant says of itself.
            other.cosine.set(meter.cosine.get());
            let change = if other.channels() == meter.channels() && other.dimensions() == meter.dimensions() {
                own.distance(&Response::of(&other, setup, &given, &wi).map_err(there)?)
            } else {
                f64::INFINITY
            };
            let limit = variant.limit.map(|role| limit(&other, setup, role, &variant.to));
            let limit = limit.transpose().map_err(there)?;
            all.push(Self {
                parameter: variant.parameter.clone(),
                from: variant.from.clone(),
                to: variant.to.clone(),
                change: change.into(),
                limit,
            });
        }
        Ok(all)
    }
}

/// All that a subject says at some directions and random numbers.
struct Response {
    numbers: Vec<f64>,
}

impl Response {
    fn of(meter: &Meter, setup: &Setup, given: &[Direction], wi: &[Direction]) -> Result<Self, Halt> {
        let mut numbers = Vec::new();
        for wo in given {
            Self::at(meter, setup, *wo, wi, &mut numbers)?;
        }
        Ok(Self { numbers })
    }

    fn at(
        meter: &Meter,
        setup: &Setup,
        wo: Direction,
        wi: &[Direction],
        numbers: &mut Vec<f64>,
    ) -> Result<(), Halt> {
        let mut part = Vec::new();
        if meter.description.has.eval {
            meter.eval(wo, wi, setup.transport, &mut part)?;
            numbers.extend_from_slice(&part);
        }
        if meter.description.has.pdf {
            meter.pdf(wo, wi, setup.transport, &mut part)?;
            numbers.extend_from_slice(&part);
        }
        if meter.description.has.sample && meter.description.claims.rng == RandomNumbers::External {
            let samples = draw(meter, setup, wo, ROWS)?;
            for (k, d) in samples.wi.iter().enumerate() {
                numbers.extend([d.x, d.y, d.z, samples.pdf[k], f64::from(samples.lobe[k].0)]);
            }
            numbers.extend(samples.weight);
        }
        numbers.extend(parts::values(meter, &Setup { wo, ..setup.clone() }, wi)?);
        Ok(())
    }

    fn distance(&self, other: &Self) -> f64 {
        if self.numbers.len() != other.numbers.len() {
            return f64::INFINITY;
        }
        // However dark: a parameter that does nothing leaves every bit as it was.
        let change = |(a, b): (&f64, &f64)| relative_error(*a, *b, f64::MIN_POSITIVE);
        let errors = self.numbers.iter().zip(&other.numbers).map(change);
        errors.fold(0.0, f64::max)
    }
}

/// A direction on the side of wo, this many degrees from the normal, a radian
/// from its azimuth: at the normal that is a tangent, where half of an anisotropic
/// model's parameters do nothing.
fn oblique(setup: &Setup, theta_deg: f64) -> Direction {
    let d = Direction::from_angles(theta_deg.to_radians(), setup.wo.phi() + 1.0);
    if setup.wo.z > 0.0 { d } else { d.flipped() }
}

fn draw(meter: &Meter, setup: &Setup, wo: Direction, rows: usize) -> Result<Samples, Halt> {
    let mut u = vec![0.0; rows * meter.dimensions()];
    setup.key.with("stage", "variations").block(0).fill(meter.coarse_u(), &mut u);
    let mut samples = Samples::default();
    meter.sample(wo, &u, setup.transport, &mut samples)?;
    Ok(samples)
}

fn limit(meter: &Meter, setup: &Setup, role: Role, value: &str) -> Result<Limit, Halt> {
    let samples = draw(meter, setup, setup.wo, LIMIT_DRAWS)?;
    let rows: Vec<usize> = (0..samples.len()).filter(|k| samples.lobe[*k].is_valid()).collect();
    match role {
        Role::Roughness => {
            let expected = expected_directions(meter, setup)?;
            // The mirror direction, and the refracted one where there is one.
            let lobes: Vec<Direction> = match meter.description.kind {
                SubjectKind::Distribution => vec![Direction::NORMAL],
                _ => {
                    expected.iter().enumerate().filter(|(k, _)| *k == 0 || *k > 3).map(|(_, d)| *d).collect()
                }
            };
            let mut angles: Vec<f64> = rows
                .iter()
                .map(|k| lobes.iter().map(|d| d.angle(samples.wi[*k])).fold(f64::INFINITY, f64::min))
                .collect();
            angles.sort_by(f64::total_cmp);
            let median = angles.get(angles.len() / 2).copied().unwrap_or(f64::INFINITY);
            Ok(Limit::Narrow { median: median.into(), roughness: value.parse().unwrap_or(f64::NAN) })
        }
        Role::Eta => {
            let mut sums = vec![0.0; meter.channels()];
            for k in rows.into_iter().filter(|k| samples.wi[*k].same_side(setup.wo)) {
                for (sum, w) in sums.iter_mut().zip(samples.weight_of(k)) {
                    *sum += w / LIMIT_DRAWS as f64;
                }
            }
            Ok(Limit::Transparent { reflected: sums.into_iter().fold(0.0, f64::max).into() })
        }
    }
}

/// Front and back of a two-sided subject: all values at (wo, wi) equal those at
/// the flipped pair.
pub fn two_sided(meter: &Meter, setup: &Setup, pilot: &Pilot) -> Result<Tally, Halt> {
    let mut tally = Tally::new(setup.tolerance());
    let wi = probes::off_edges(meter, setup, probes::directions(setup, pilot, ROWS))?;
    let flipped: Vec<Direction> = wi.iter().map(|w| w.flipped()).collect();
    let (mut a, mut b) = (Vec::new(), Vec::new());
    if meter.description.has.eval {
        meter.eval(setup.wo, &wi, setup.transport, &mut a)?;
        meter.eval(setup.wo.flipped(), &flipped, setup.transport, &mut b)?;
        compare(&mut tally, (setup.wo, setup.floor()), &wi, ["eval", "from the other side"], &a, &b);
    }
    if meter.description.has.pdf {
        meter.pdf(setup.wo, &wi, setup.transport, &mut a)?;
        meter.pdf(setup.wo.flipped(), &flipped, setup.transport, &mut b)?;
        compare(&mut tally, (setup.wo, setup.floor()), &wi, ["pdf", "from the other side"], &a, &b);
    }
    Ok(tally)
}

/// How much a table resembles another subject, over directions drawn in
/// proportion to its light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Resemblance {
    /// Root mean square of (a − b)/max(a, b), of the channel where it is largest.
    pub rms: Figure,
    /// That channel.
    pub channel: usize,
    /// Directions compared.
    pub places: u64,
    /// Where the difference is largest.
    pub worst: Option<Place>,
}

impl Resemblance {
    /// Of two values at each of `wi`, row-major.
    fn of(setup: &Setup, wi: &[Direction], a: &[f64], b: &[f64]) -> Self {
        let channels = a.len() / wi.len().max(1);
        let difference = |k: usize| (a[k] - b[k]) / a[k].max(b[k]).max(setup.floor());
        let mean_square = |c: usize| {
            let squares = (c..a.len()).step_by(channels.max(1)).map(|k| difference(k).powi(2));
            squares.sum::<f64>() / wi.len().max(1) as f64
        };
        let largest = (0..channels).map(|c| (c, mean_square(c))).max_by(|x, y| x.1.total_cmp(&y.1));
        let (channel, square) = largest.unwrap_or((0, 0.0));
        let far = (0..a.len()).max_by(|x, y| difference(*x).abs().total_cmp(&difference(*y).abs()));
        let worst =
            far.map(|k| Place::pair(setup.wo, wi[k / channels]).value("eval", a[k]).value("reference", b[k]));
        Self { rms: square.sqrt().into(), channel, places: wi.len() as u64, worst }
    }
}

/// A comparison with another subject.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// How the other is written.
    pub name: String,
    /// eval of both.
    pub eval: Tally,
    /// RMS relative difference of eval over the light, where one of them is a table;
    /// then eval and pdf are not compared at each place.
    #[serde(default)]
    pub table: Option<Resemblance>,
    /// pdf of both.
    pub pdf: Tally,
    /// Discrete lobes of both: their directions, probabilities and weights.
    #[serde(default)]
    pub discrete: Tally,
    /// ∫ of the other's pdf by leaf, which the draws must follow.
    pub masses: Vec<f64>,
    /// The error of their sum.
    #[serde(default)]
    pub mass_error: f64,
    /// Why these masses cannot be relied on, if so.
    pub unreliable: Option<String>,
    /// Why the two cannot be compared, if so.
    pub incomparable: Option<String>,
}

impl Comparison {
    /// Compares values at many directions with another subject, which is written so; masses
    /// are integrated elsewhere. `within` is the relative difference that counts as none, in
    /// place of rounding.
    pub fn gather(
        meter: &Meter,
        setup: &Setup,
        pilot: &Pilot,
        (name, other): (&str, &Meter),
        within: Option<f64>,
    ) -> Result<Self, Halt> {
        let tolerance = within.unwrap_or(setup.tolerance());
        let mut found = Self {
            name: name.into(),
            eval: Tally::new(tolerance),
            pdf: Tally::new(tolerance),
            discrete: Tally::new(tolerance),
            ..Self::default()
        };
        if other.channels() != meter.channels() {
            found.incomparable =
                Some(format!("{} channels here, {} there", meter.channels(), other.channels()));
            return Ok(found);
        }
        if other.description.kind != meter.description.kind {
            let kinds = [meter, other].map(|m| m.description.kind.noun());
            found.incomparable = Some(format!("a {} here, a {} there", kinds[0], kinds[1]));
            return Ok(found);
        }
        let (mut a, mut b) = (Vec::new(), Vec::new());
        let tabulated = [meter, other].iter().any(|m| m.description.table.is_some());
        if tabulated && meter.description.has.eval && other.description.has.eval {
            let step = (pilot.wi.len() / (32 * ROWS)).max(1);
            let wi: Vec<Direction> = pilot.wi.iter().step_by(step).copied().collect();
            meter.eval(setup.wo, &wi, setup.transport, &mut a)?;
            other.eval(setup.wo, &wi, setup.transport, &mut b)?;
            found.table = Some(Resemblance::of(setup, &wi, &a, &b));
            return Ok(found);
        }
        let wi = probes::off_edges(meter, setup, probes::directions(setup, pilot, 4 * ROWS))?;
        // What is compared loosely is compared where there is something.
        let floor = |reference: &[f64]| {
            let largest = reference.iter().copied().filter(|v| v.is_finite()).fold(0.0, f64::max);
            setup.floor().max(within.map_or(0.0, |_| NOTHING * largest))
        };
        if meter.description.has.eval && other.description.has.eval {
            meter.eval(setup.wo, &wi, setup.transport, &mut a)?;
            other.eval(setup.wo, &wi, setup.transport, &mut b)?;
            compare(&mut found.eval, (setup.wo, floor(&b)), &wi, ["eval", "reference"], &a, &b);
        }
        if meter.description.has.pdf && other.description.has.pdf {
            meter.pdf(setup.wo, &wi, setup.transport, &mut a)?;
            other.pdf(setup.wo, &wi, setup.transport, &mut b)?;
            compare(&mut found.pdf, (setup.wo, floor(&b)), &wi, ["pdf", "reference"], &a, &b);
        }
        if meter.description.has.sample && other.description.has.sample {
            let theirs = discrete_lobes(other, setup)?;
            compare_lobes(&mut found.discrete, setup, &pilot.discrete, &theirs);
        }
        let (a, b) = (parts::values(meter, setup, &wi)?, parts::values(other, setup, &wi)?);
        // Transmittance and polarisation may be told by one alone.
        let shared = match meter.description.kind {
            SubjectKind::Fresnel => parts::COMPARED * meter.channels(),
            _ => a.len(),
        };
        for (a, b) in a.into_iter().zip(b).take(shared) {
            found.eval.look(relative_error(a, b, setup.floor()), || {
                let place = Place { wo: setup.wo, ..Place::default() };
                place.value("value", a).value("reference", b)
            });
        }
        Ok(found)
    }
}

/// Values below this part of the largest are nothing where the suite compares loosely: what
/// is cut off there, or lost to cancellation, no picture shows.
const NOTHING: f64 = 1e-6;

fn compare(
    tally: &mut Tally,
    (wo, floor): (Direction, f64),
    wi: &[Direction],
    names: [&str; 2],
    a: &[f64],
    b: &[f64],
) {
    let width = (a.len() / wi.len().max(1)).max(1);
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        tally.look(relative_error(*a, *b, floor), || {
            Place::pair(wo, wi[k / width]).value(names[0], *a).value(names[1], *b)
        });
    }
}

/// A discrete lobe that a pilot meets so often on average is missed with probability
/// e⁻³² = 1e-14.
const MET: f64 = 32.0;

/// So near, in radians, two discrete directions are those of one lobe, or within the
/// tolerance, where that is more.
const SAME: f64 = 1e-4;

/// Each discrete lobe of either against the other's nearest one, whatever their flags.
fn compare_lobes(tally: &mut Tally, setup: &Setup, own: &[DiscreteDraw], theirs: &[DiscreteDraw]) {
    let nearest = |to: &DiscreteDraw, among: &[DiscreteDraw]| -> Option<DiscreteDraw> {
        let off = |d: &DiscreteDraw| (d.wi - to.wi).length();
        let near = among.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
        (off(near) < SAME.max(setup.tolerance())).then(|| near.clone())
    };
    let missing = |tally: &mut Tally, lobe: &DiscreteDraw, name: &str| {
        // A rare one may have been missed.
        if lobe.probability * (setup.pilot_blocks() * BLOCK) as f64 >= MET {
            tally.look(1.0, || Place::pair(setup.wo, lobe.wi).value(name, lobe.probability));
        }
    };
    for lobe in own {
        let Some(other) = nearest(lobe, theirs) else {
            missing(tally, lobe, "probability, and none in the reference");
            continue;
        };
        let place =
            |name: &str, a: f64, b: f64| Place::pair(setup.wo, lobe.wi).value(name, a).value("reference", b);
        let angle = (lobe.wi - other.wi).length();
        tally.look(angle, || place("radians off", angle, 0.0));
        let (a, b) = (lobe.probability, other.probability);
        tally.look(relative_error(a, b, setup.floor()), || place("probability", a, b));
        for (a, b) in lobe.weight.iter().zip(&other.weight) {
            tally.look(relative_error(*a, *b, setup.floor()), || place("weight", *a, *b));
        }
    }
    for lobe in theirs.iter().filter(|lobe| nearest(lobe, own).is_none()) {
        missing(tally, lobe, "probability in the reference, and none here");
    }
}
