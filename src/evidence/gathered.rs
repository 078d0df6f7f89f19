//! All evidence of one case, and how it is gathered.

use super::draws::Draws;
use super::exact::{Repeats, corners, rotations};
use super::facets::Facets;
use super::fresnel::FresnelLaws;
use super::integrals::{Integrals, Integrated};
use super::jacobian::Jacobian;
use super::meter::{Evaluations, Halt, Meter, Sanity, Watch};
use super::pairs::Pairs;
use super::samples::{Pilot, SampleIdentities};
use super::setup::Setup;
use super::tally::Tally;
use super::variations::{Comparison, Variant, Variation, two_sided};
use crate::bsdf::{Claims, Cosine, Description, Direction, Subject, SubjectError, SubjectKind, Transport};
use crate::sphere::{Breaks, Chart, Partition, Point};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The cubature stops at this many directions: eight times what the
/// narrowest built-in lobe takes.
const MOST_EVALUATIONS: u64 = 600_000;

/// What checks ask for. The union is measured once per case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Measurement {
    /// All functions at hostile inputs.
    Corners,
    /// The pilot's samples and their identities.
    Samples,
    /// Exchanged directions.
    Pairs,
    /// Repeated calls.
    Repeats,
    /// Directions turned about the normal.
    Rotations,
    /// Derivatives of the sampler.
    Jacobian,
    /// Changed parameters, and the other side.
    Variations,
    /// Integrals of pdf over the cells.
    Masses,
    /// Those of the values besides.
    Integrals,
    /// Draws counted in the cells.
    Draws,
    /// Multiple importance sampling along with the draws.
    Mis,
    /// Another subject.
    Reference,
    /// What a distribution of normals integrates to.
    Facets,
    /// What a Fresnel function reflects at all angles.
    FresnelLaws,
}

impl Measurement {
    /// Every one.
    pub const ALL: [Self; 14] = [
        Self::Corners,
        Self::Samples,
        Self::Pairs,
        Self::Repeats,
        Self::Rotations,
        Self::Jacobian,
        Self::Variations,
        Self::Masses,
        Self::Integrals,
        Self::Draws,
        Self::Mis,
        Self::Reference,
        Self::Facets,
        Self::FresnelLaws,
    ];

    /// Whether it reads values of eval. Where no measurement of a case does, eval is not
    /// called.
    pub fn reads_eval(self) -> bool {
        !matches!(self, Self::Masses | Self::Draws | Self::Jacobian)
    }
}

/// Everything that was measured of one case. A part that is `None` was not
/// asked for, cannot be had of this subject, or was not reached before `halt`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// How the subject is written.
    pub subject: String,
    /// What it says of itself, with the claims in force.
    pub description: Description,
    /// The given direction.
    pub wo: Direction,
    /// The mode of transport.
    pub transport: Transport,
    /// The cosine convention that its values follow, where the probe found
    /// another one than declared.
    pub cosine_found: Option<Cosine>,
    /// What was found of every number that came back.
    pub sanity: Sanity,
    /// Rows of calls at hostile inputs.
    pub corners: Option<u64>,
    /// Identities of samples.
    pub samples: Option<SampleIdentities>,
    /// Exchanged directions.
    pub pairs: Option<Pairs>,
    /// Repeated calls.
    pub repeats: Option<Repeats>,
    /// Rotations about the normal.
    pub rotations: Option<Tally>,
    /// Derivatives of the sampler.
    pub jacobian: Option<Jacobian>,
    /// Changed parameters.
    pub variations: Option<Vec<Variation>>,
    /// Front and back of a two-sided subject.
    pub two_sided: Option<Tally>,
    /// What a table says that wo lies in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub given: Option<String>,
    /// The cells.
    pub partition: Option<Partition>,
    /// Integrals over the cells.
    pub integrals: Option<Integrals>,
    /// Draws by attempt: the first look, and its confirmation if one was asked for.
    pub draws: Vec<Draws>,
    /// The other subject.
    pub reference: Option<Comparison>,
    /// Integrals of a distribution of normals.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub facets: Option<Facets>,
    /// Laws of a Fresnel function.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fresnel: Option<FresnelLaws>,
    /// Directions evaluated.
    pub evaluations: Evaluations,
    /// What could not be measured, and why.
    #[serde(skip)]
    pub halts: Vec<(Measurement, Halt)>,
}

/// What a case measures besides its subject.
#[derive(Clone, Default)]
pub struct Company<'a> {
    /// The same model with other parameters.
    pub variants: Vec<Variant<'a>>,
    /// Another subject to compare with, and how it is written.
    pub reference: Option<(String, Arc<dyn Subject + 'a>)>,
    /// The relative difference of values that counts as none there; rounding where `None`.
    pub within: Option<f64>,
}

/// Gathers the evidence of one case; keeps what later looks need.
pub struct Gatherer<'a> {
    meter: Meter<'a>,
    setup: Setup,
    watch: Arc<Watch>,
    pilot: Pilot,
    /// Where the values are yet to be integrated.
    integrated: Option<Integrated>,
    evidence: Evidence,
}

impl<'a> Gatherer<'a> {
    /// Nothing measured yet.
    pub fn new(meter: Meter<'a>, setup: Setup, watch: Arc<Watch>, subject: &str) -> Self {
        let evidence = Evidence {
            subject: subject.to_string(),
            description: meter.description.clone(),
            wo: setup.wo,
            transport: setup.transport,
            cosine_found: None,
            sanity: Sanity::default(),
            corners: None,
            samples: None,
            pairs: None,
            repeats: None,
            rotations: None,
            jacobian: None,
            variations: None,
            two_sided: None,
            given: None,
            partition: None,
            integrals: None,
            draws: Vec::new(),
            reference: None,
            facets: None,
            fresnel: None,
            evaluations: Evaluations::default(),
            halts: Vec::new(),
        };
        Self { meter, setup, watch, pilot: Pilot::default(), integrated: None, evidence }
    }

    /// The evidence so far.
    pub fn evidence(&self) -> &Evidence {
        &self.evidence
    }

    /// The evidence, at the end.
    pub fn into_evidence(self) -> Evidence {
        self.evidence
    }

    /// Measures all that is asked for except the draws. Where the subject fails, the
    /// other measurements go on, unless it is out of time.
    pub fn prepare(&mut self, asked: &[Measurement], company: &Company) {
        use Measurement as M;
        let (has, kind) = (self.meter.description.has, self.meter.description.kind);
        let eval = self.setup.eval;
        // The pilot is always drawn: partitions and probes stand on it; and the
        // probe of the cosine's convention must not depend on what is asked for.
        let always = |step| match step {
            M::Samples => has.sample,
            M::Pairs => eval && has.eval && has.pdf && has.sample && kind == SubjectKind::Bsdf,
            _ => false,
        };
        let order = [
            M::Samples,
            M::Pairs,
            M::Corners,
            M::Repeats,
            M::Rotations,
            M::Jacobian,
            M::Variations,
            M::Facets,
            M::FresnelLaws,
        ];
        for step in order {
            if step == M::Corners && self.settle_cosine() {
                // Under the convention that was found.
                self.identities(company);
            }
            if (asked.contains(&step) || always(step))
                && let Err(halt) = self.measure(step, company)
            {
                self.halted(step, halt);
            }
        }
        if [M::Masses, M::Integrals, M::Draws].iter().any(|step| asked.contains(step))
            && (has.eval || has.pdf || has.sample)
            && !self.is_over()
            && let Err((step, halt)) = self.integrate()
        {
            self.halted(step, halt);
        }
        if let (true, false, Some((name, other))) =
            (asked.contains(&M::Reference), self.is_over(), &company.reference)
            && let Err(halt) = self.compare(name, &**other, company.within)
        {
            self.halted(M::Reference, halt);
        }
        self.account();
    }

    /// Calls eval where it was spared so far: a failure is to be explained and shown. What
    /// was judged stays as it is.
    pub fn complete(&mut self, company: &Company) {
        if self.setup.eval || self.is_over() {
            return;
        }
        self.setup.eval = true;
        let pilot = std::mem::take(&mut self.pilot);
        self.identities(company);
        if self.settle_cosine() {
            self.identities(company);
        }
        if self.pilot.wi != pilot.wi {
            // Its random numbers are its own: pdf was integrated by the first.
            self.pilot = pilot;
        }
        if let (false, Err(halt)) = (self.is_over(), self.integrate_values()) {
            self.halted(Measurement::Integrals, halt);
        }
        self.account();
    }

    /// What holds for each sample and each pair.
    fn identities(&mut self, company: &Company) {
        for step in [Measurement::Samples, Measurement::Pairs] {
            if let Err(halt) = self.measure(step, company) {
                self.halted(step, halt);
            }
        }
    }

    /// Draws on to `samples` in this attempt (0 the first, 1 the confirmation).
    pub fn draw(&mut self, attempt: usize, samples: u64) {
        if !self.is_over()
            && let Err(halt) = self.try_draw(attempt, samples)
        {
            self.halted(Measurement::Draws, halt);
        }
        self.account();
    }

    /// Whether nothing more can be measured: out of time, broken, or stopped.
    pub fn is_over(&self) -> bool {
        let survivable = |halt: &Halt| {
            matches!(
                halt,
                Halt::Subject(
                    SubjectError::Panicked { .. }
                        | SubjectError::WrongLength { .. }
                        | SubjectError::Refused(_)
                )
            )
        };
        self.evidence.halts.iter().any(|(step, halt)| *step == Measurement::Draws || !survivable(halt))
    }

    fn halted(&mut self, step: Measurement, halt: Halt) {
        self.evidence.halts.push((step, halt));
    }

    fn account(&mut self) {
        self.evidence.sanity = self.meter.sanity();
        self.evidence.evaluations = self.meter.evaluations();
    }

    fn measure(&mut self, step: Measurement, company: &Company) -> Result<(), Halt> {
        if self.is_over() {
            return Ok(());
        }
        let (meter, setup, pilot) = (&self.meter, &self.setup, &self.pilot);
        let has = meter.description.has;
        let evidence = &mut self.evidence;
        match step {
            Measurement::Samples if has.sample => {
                let (identities, pilot) = SampleIdentities::gather(meter, setup)?;
                evidence.samples = Some(identities);
                self.pilot = pilot;
            }
            Measurement::Pairs if has.eval && meter.description.kind == SubjectKind::Bsdf => {
                evidence.pairs = Some(Pairs::gather(meter, setup, pilot)?)
            }
            Measurement::Corners => evidence.corners = Some(corners(meter, setup)?),
            Measurement::Repeats => evidence.repeats = Some(Repeats::gather(meter, setup, pilot)?),
            Measurement::Rotations => evidence.rotations = Some(rotations(meter, setup, pilot)?),
            Measurement::Jacobian if has.sample && has.pdf => {
                evidence.jacobian = Some(Jacobian::gather(meter, setup)?);
            }
            Measurement::Variations => {
                let variants = &company.variants;
                evidence.variations = Some(Variation::gather(meter, setup, pilot, &self.watch, variants)?);
                if setup.claims.two_sided {
                    evidence.two_sided = Some(two_sided(meter, setup, pilot)?);
                }
            }
            Measurement::Facets
                if meter.description.kind == SubjectKind::Distribution && setup.wo.z > 0.0 =>
            {
                evidence.facets = Some(Facets::gather(meter, setup, pilot)?);
            }
            Measurement::FresnelLaws if meter.description.kind == SubjectKind::Fresnel => {
                evidence.fresnel = Some(FresnelLaws::gather(meter, setup)?);
            }
            _ => {}
        }
        Ok(())
    }

    /// The probe of the cosine convention: where weights follow the other
    /// convention at every sample, and reciprocity, as far as it is claimed,
    /// holds under the other one and not under the declared one, the values are
    /// taken as they are meant.
    fn settle_cosine(&mut self) -> bool {
        let (Some(samples), Some(pairs)) = (&self.evidence.samples, &self.evidence.pairs) else {
            return false;
        };
        let reciprocal_other = pairs.reciprocity.is_broken() && !pairs.reciprocity_other.is_broken();
        let other = samples.suggests_other_cosine() && self.setup.claims.reciprocal && reciprocal_other;
        if other {
            let found = match self.meter.cosine.get() {
                Cosine::Excluded => Cosine::Included,
                Cosine::Included => Cosine::Excluded,
            };
            self.meter.cosine.set(found);
            self.evidence.cosine_found = Some(found);
        }
        other
    }

    fn integrate(&mut self) -> Result<(), (Measurement, Halt)> {
        self.integrate_pdf().map_err(|halt| (Measurement::Masses, halt))?;
        if self.setup.eval {
            self.integrate_values().map_err(|halt| (Measurement::Integrals, halt))?;
        }
        Ok(())
    }

    fn integrate_pdf(&mut self) -> Result<(), Halt> {
        let native = self.meter.cells(self.setup.wo)?;
        let breaks = native.as_ref().map(Breaks::new);
        let chart = breaks.as_ref().map_or_else(|| Chart::new(self.setup.wo.phi()), Breaks::chart);
        let (pilot, leaves) = (self.pilot_points(&chart), self.setup.leaves());
        let mut partition = match &breaks {
            Some(breaks) => Partition::build_along(breaks, pilot.clone(), leaves),
            None => Partition::build(chart, pilot.clone(), leaves),
        };
        self.evidence.given = native.map(|native| native.given);
        let (mut integrals, mut integrated) = self.masses(&partition, &pilot)?;
        let heavy = integrals.heavy_leaves(&integrated);
        if !pilot.is_empty() && heavy.iter().any(|h| *h) {
            partition = partition.refined(&heavy);
            (integrals, integrated) = self.masses(&partition, &pilot)?;
        }
        self.evidence.partition = Some(partition);
        self.evidence.integrals = Some(integrals);
        self.integrated = Some(integrated);
        Ok(())
    }

    fn masses(&self, partition: &Partition, points: &[Point]) -> Result<(Integrals, Integrated), Halt> {
        let pilot = (&self.pilot, points);
        Integrals::masses(&self.meter, &self.setup, partition, pilot, MOST_EVALUATIONS)
    }

    fn integrate_values(&mut self) -> Result<(), Halt> {
        let (meter, setup, pilot) = (&self.meter, &self.setup, &self.pilot);
        if let (Some(partition), Some(integrals), Some(integrated)) =
            (&self.evidence.partition, &mut self.evidence.integrals, self.integrated.take())
        {
            integrals.add_values(meter, setup, partition, pilot, integrated, MOST_EVALUATIONS)?;
        }
        Ok(())
    }

    fn pilot_points(&self, chart: &Chart) -> Vec<Point> {
        let mut points = Vec::new();
        chart.to_points(&self.pilot.wi, &mut points);
        points
    }

    fn compare(&mut self, name: &str, other: &dyn Subject, within: Option<f64>) -> Result<(), Halt> {
        let description = Meter::describe(other)?;
        let claims: Claims = description.claims;
        let other = Meter::new(other, description, self.watch.clone());
        let mut comparison =
            Comparison::gather(&self.meter, &self.setup, &self.pilot, (name, &other), within)?;
        let in_distribution = comparison.table.is_none() && other.description.has.pdf;
        if let (Some(partition), true) = (&self.evidence.partition, in_distribution) {
            let points = self.pilot_points(partition.chart());
            let pilot = (&self.pilot.of_another(), &points[..]);
            let setup = Setup { claims, ..self.setup.clone() };
            let (integrals, _) = Integrals::masses(&other, &setup, partition, pilot, MOST_EVALUATIONS)?;
            comparison.unreliable = integrals.masses_reliable().err();
            comparison.mass_error = integrals.mass().1;
            comparison.masses = integrals.pdf;
        }
        self.evidence.reference = Some(comparison);
        Ok(())
    }

    fn try_draw(&mut self, attempt: usize, samples: u64) -> Result<(), Halt> {
        let (Some(partition), Some(integrals)) = (&self.evidence.partition, &self.evidence.integrals) else {
            return Ok(());
        };
        if !self.meter.description.has.sample {
            return Ok(());
        }
        while self.evidence.draws.len() <= attempt {
            let next = self.evidence.draws.len() as u32;
            self.evidence.draws.push(Draws::new(next, partition.len(), self.meter.channels()));
        }
        let draws = &mut self.evidence.draws[attempt];
        draws.extend(&self.meter, &self.setup, partition, &integrals.pdf, samples)
    }
}

impl Evidence {
    /// Whether nothing suggests that the subject does anything: no valid
    /// sample, no pdf anywhere, and no number that is wrong (of which 0 or no
    /// sample was made).
    pub fn looks_unimplemented(&self) -> bool {
        let no_sample = self.samples.as_ref().is_some_and(|s| s.valid == 0);
        let no_density = self.integrals.as_ref().is_none_or(|i| i.mass().0 == 0.0);
        let claims = &self.description.claims;
        // A one-sided subject may well do nothing when seen from behind.
        let claimed = self.wo.z > 0.0 || claims.transmissive || claims.two_sided;
        let sound = self.sanity.tallies.values().all(|tally| !tally.is_broken());
        no_sample && no_density && sound && claimed && self.description.has.sample
    }

    /// The mode of transport by whose scale (η_o/η_i)² transmission goes, which is
    /// not the one measured where reciprocity tells that a subject has the other.
    pub fn scale(&self) -> Transport {
        match &self.pairs {
            Some(pairs) if pairs.follows_other_mode() => self.transport.other(),
            _ => self.transport,
        }
    }

    /// Whether no light leaves at all, by a measured integral and the discrete
    /// lobes met.
    pub fn is_black(&self) -> bool {
        let dark =
            |i: &Integrals| !i.value.is_empty() && (0..i.value_error.len()).all(|c| i.albedo(c).0 == 0.0);
        let discrete = self.draws.iter().flat_map(|d| &d.discrete);
        self.integrals.as_ref().is_some_and(dark) && discrete.flat_map(|d| &d.weight).all(|w| *w == 0.0)
    }
}
