//! The pilot: the first draws of a case. They shape the partition and carry
//! the identities that hold for each sample; they are never counted.

use super::draws::{BLOCK, density_near};
use super::integrals::{densities, values};
use super::meter::{Halt, Meter};
use super::setup::Setup;
use super::tally::{Place, Tally, relative_error};
use crate::bsdf::{Cosine, Direction, Lobe, Samples};
use serde::{Deserialize, Serialize};

/// A discrete draw of the pilot.
#[derive(Clone, Debug, PartialEq)]
pub struct DiscreteDraw {
    /// Its direction.
    pub wi: Direction,
    /// Its flags.
    pub lobe: Lobe,
    /// Its claimed probability.
    pub probability: f64,
    /// Its weight, by channel.
    pub weight: Vec<f64>,
}

impl DiscreteDraw {
    /// The claimed probability times the weight, by channel.
    pub fn throughput(&self) -> Vec<f64> {
        self.weight.iter().map(|w| w * self.probability).collect()
    }
}

/// The draws of the pilot, as far as others use them.
#[derive(Clone, Debug, Default)]
pub struct Pilot {
    /// Continuous samples.
    pub wi: Vec<Direction>,
    /// pdf there; empty where it was not asked for.
    pub pdf: Vec<f64>,
    /// eval there, by channel; likewise.
    pub value: Vec<f64>,
    /// Discrete samples of different directions.
    pub discrete: Vec<DiscreteDraw>,
    /// Draws in all.
    pub drawn: u64,
}

/// Identities that hold for each continuous sample.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SampleIdentities {
    /// Draws in all.
    pub drawn: u64,
    /// Draws with a sample.
    pub valid: u64,
    /// weight·pdf(wo, wi) = f·|cos θi|, under the cosine convention in force.
    pub weight: Tally,
    /// The same under the other convention of the cosine.
    pub weight_other: Tally,
    /// sample.pdf = pdf(wo, wi).
    pub returned_pdf: Tally,
    /// pdf(wo, wi) > 0.
    pub zero_pdf: Tally,
    /// A continuous sample that carries light leaves on the side that its flags tell.
    #[serde(default)]
    pub side: Tally,
    /// The most frequent direction among continuous samples, and its share.
    pub repeated: Option<(Direction, f64)>,
    /// pdf() and eval() do not stand out at the directions of discrete lobes.
    pub discrete_value: Option<Tally>,
}

impl SampleIdentities {
    /// Draws the pilot and looks at each of its samples.
    pub fn gather(meter: &Meter, setup: &Setup) -> Result<(Self, Pilot), Halt> {
        let mut found = Self {
            weight: Tally::new(setup.tolerance()),
            weight_other: Tally::new(setup.tolerance()),
            returned_pdf: Tally::new(setup.tolerance()),
            zero_pdf: Tally::new(0.0),
            side: Tally::new(0.0),
            ..Self::default()
        };
        let mut pilot = Pilot::default();
        let mut samples = Samples::default();
        let (mut u, mut value, mut density) = (Vec::new(), Vec::new(), Vec::new());
        let (d, channels) = (meter.dimensions(), meter.channels());
        let has = meter.description.has;
        for block in 0..setup.pilot_blocks() {
            u.resize(BLOCK as usize * d, 0.0);
            setup.key.with("stage", "pilot").block(block).fill(meter.coarse_u(), &mut u);
            meter.sample(setup.wo, &u, setup.transport, &mut samples)?;
            found.drawn += BLOCK;
            let rows: Vec<usize> = (0..samples.len()).filter(|k| samples.lobe[*k].is_continuous()).collect();
            let wi: Vec<Direction> = rows.iter().map(|k| samples.wi[*k]).collect();
            found.valid += samples.lobe.iter().filter(|lobe| lobe.is_valid()).count() as u64;
            pilot.add_discrete(&samples);
            densities(meter, setup, &wi, &mut density)?;
            if setup.eval {
                values(meter, setup, &wi, &mut value)?;
            }
            for (row, &k) in rows.iter().enumerate() {
                let wi = samples.wi[k];
                let place = || Place::pair(setup.wo, wi).drawn_by(&u[k * d..(k + 1) * d]);
                // Off the support, a draw of weight 0 says nothing.
                if samples.weight_of(k).iter().any(|w| *w > 0.0) {
                    let wrong = contradicts_side(samples.lobe[k], setup.wo, wi);
                    found.side.look(if wrong { 1.0 } else { 0.0 }, || {
                        place().value("flags", f64::from(samples.lobe[k].0))
                    });
                }
                if !has.pdf {
                    continue;
                }
                let (p, told) = (density[row], samples.pdf[k]);
                if p == 0.0 {
                    let there = density_near(meter, setup, wi)?;
                    found.zero_pdf.look(if there > 0.0 { 0.0 } else { 1.0 }, || {
                        place().value("pdf", 0.0).value("sample.pdf", told)
                    });
                    continue;
                }
                found.zero_pdf.look(0.0, place);
                found.returned_pdf.look(relative_error(told, p, setup.floor()), || {
                    place().value("sample.pdf", told).value("pdf", p)
                });
                if !(has.eval && setup.eval) {
                    continue;
                }
                let cosine = wi.abs_cos_theta();
                let other = match meter.cosine.get() {
                    Cosine::Excluded => 1.0,
                    Cosine::Included => cosine * cosine,
                };
                let (mut worst, mut worst_other) = ((0.0f64, 0), 0.0f64);
                for c in 0..channels {
                    let (w, f) = (samples.weight[k * channels + c], value[row * channels + c]);
                    let error = relative_error(w * p, f * cosine, setup.floor());
                    if !(error <= worst.0) {
                        worst = (error, c);
                    }
                    worst_other = worst_other.max(relative_error(w * p, f * other, setup.floor()));
                }
                let c = worst.1;
                found.weight.look(worst.0, || {
                    let f = value[row * channels + c];
                    place()
                        .value("weight", samples.weight[k * channels + c])
                        .value("pdf", p)
                        .value("eval", f)
                        .value("f·|cos θi|/pdf", f * cosine / p)
                });
                found.weight_other.look(worst_other, place);
            }
            pilot.wi.extend(wi);
            pilot.pdf.extend(&density);
            pilot.value.extend(&value);
        }
        pilot.drawn = found.drawn;
        found.repeated = pilot.most_repeated();
        if !pilot.discrete.is_empty() {
            found.discrete_value = Some(discrete_value(meter, setup, &pilot)?);
        }
        Ok((found, pilot))
    }

    /// Whether eval seems to follow the other convention of the cosine than it
    /// declares: the declared one is broken nearly everywhere, the other
    /// nowhere. A weight that lacks the cosine looks the same; reciprocity
    /// tells them apart.
    pub fn suggests_other_cosine(&self) -> bool {
        self.weight.checked > 0 && self.weight.share() > 0.9 && !self.weight_other.is_broken()
    }
}

/// Whether a lobe is flagged as one side's alone, and `wi` lies on the other.
fn contradicts_side(lobe: Lobe, wo: Direction, wi: Direction) -> bool {
    let told = lobe.contains(Lobe::REFLECTION);
    told != lobe.contains(Lobe::TRANSMISSION) && told != wi.same_side(wo)
}

impl Pilot {
    /// The same directions, of whose functions nothing is known.
    pub fn of_another(&self) -> Self {
        Self { pdf: Vec::new(), value: Vec::new(), ..self.clone() }
    }

    fn add_discrete(&mut self, samples: &Samples) {
        for k in (0..samples.len()).filter(|k| samples.lobe[*k].is_discrete()) {
            let (wi, lobe, probability) = (samples.wi[k], samples.lobe[k], samples.pdf[k]);
            let near = |d: &DiscreteDraw| (d.wi - wi).length() < 1e-4 && d.lobe == lobe;
            if self.discrete.len() < 16 && !self.discrete.iter().any(near) {
                let weight = samples.weight_of(k).to_vec();
                self.discrete.push(DiscreteDraw { wi, lobe, probability, weight });
            }
        }
    }

    /// The direction that comes most often bit for bit among the first
    /// thousands, and its share.
    fn most_repeated(&self) -> Option<(Direction, f64)> {
        let first = self.wi.iter().take(BLOCK as usize);
        let mut bits: Vec<[u64; 3]> = first.map(|d| [d.x.to_bits(), d.y.to_bits(), d.z.to_bits()]).collect();
        let looked_at = bits.len() as f64;
        bits.sort_unstable();
        let longest = bits.chunk_by(|a, b| a == b).max_by_key(|run| run.len())?;
        let [x, y, z] = longest[0].map(f64::from_bits);
        (longest.len() > 1).then(|| (Direction::new(x, y, z), longest.len() as f64 / looked_at))
    }
}

/// The discrete lobes that a pilot of `meter` meets.
pub(super) fn discrete_lobes(meter: &Meter, setup: &Setup) -> Result<Vec<DiscreteDraw>, Halt> {
    let (mut pilot, mut samples) = (Pilot::default(), Samples::default());
    let mut u = vec![0.0; BLOCK as usize * meter.dimensions()];
    for block in 0..setup.pilot_blocks() {
        setup.key.with("stage", "pilot").block(block).fill(meter.coarse_u(), &mut u);
        meter.sample(setup.wo, &u, setup.transport, &mut samples)?;
        pilot.add_discrete(&samples);
    }
    Ok(pilot.discrete)
}

/// pdf and eval at each discrete direction against those 1e-5 rad beside it: a
/// delta function that leaks into them is there and nowhere else.
fn discrete_value(meter: &Meter, setup: &Setup, pilot: &Pilot) -> Result<Tally, Halt> {
    const BESIDE: f64 = 1e-5;
    let mut tally = Tally::new(0.5);
    let mut there = Vec::new();
    for draw in &pilot.discrete {
        let tangent = draw.wi.cross(Direction::new(0.6, 0.8, 0.0)).normalized();
        let beside = (draw.wi + tangent * BESIDE).normalized();
        let mut look = |name: &str, width: usize, values: &[f64]| {
            for c in 0..width {
                let (at, near) = (values[c], values[width + c]);
                tally.look(relative_error(at, near, setup.floor()), || {
                    Place::pair(setup.wo, draw.wi).value(name, at).value("beside", near)
                });
            }
        };
        if meter.description.has.pdf {
            meter.pdf(setup.wo, &[draw.wi, beside], setup.transport, &mut there)?;
            look("pdf", 1, &there);
        }
        if meter.description.has.eval && setup.eval {
            meter.eval(setup.wo, &[draw.wi, beside], setup.transport, &mut there)?;
            look("eval", meter.channels(), &there);
        }
    }
    Ok(tally)
}
