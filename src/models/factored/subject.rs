//! A subject whose directions are drawn by factors.

use super::table::Table;
use super::{FactoredDensity, Factorisation, Given, Grid, Parameterisation, cache};
use crate::bsdf::{
    Cosine, Description, Direction, Has, Lobe, NativeCells, OffSupport, RandomNumbers, Sample, Samples,
    Spectrum, Subject, SubjectError, Transport,
};
use crate::models::blend::is_discrete;
use crate::registry::Model;
use std::sync::Arc;

/// Another subject's values with a sampler and a density of its own making: f·cos θi,
/// channels averaged, is tabulated and factored. eval and claims are the subject's;
/// the sampler it may have is not used.
pub struct Factored {
    subject: Arc<dyn Subject>,
    description: Description,
    density: Arc<FactoredDensity>,
}

/// What [`Factored::new`] does with a subject.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// What the factors are functions of.
    pub over: Parameterisation,
    /// Cells in θp.
    pub theta: usize,
    /// Cells in φp; an anisotropic subject is tabulated at half as many azimuths of wo.
    pub phi: usize,
    /// Polar angles of wo.
    pub theta_o: usize,
    /// Numbers of terms, and the cosine's share.
    pub factorisation: Factorisation,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            over: Parameterisation::HalfAngle,
            theta: 48,
            phi: 32,
            theta_o: 16,
            factorisation: Factorisation { outer: 4, inner: 3, floor: 0.02 },
        }
    }
}

/// A grid that puts more of the light at some wo elsewhere than it is does not see
/// the lobe.
const MISPLACED: f64 = 0.3;

/// The registered model `factored`.
pub(in crate::models) fn model() -> Model {
    let default = Options::default();
    let by = default.factorisation;
    Model::composed("factored", "another subject, sampled by factors (Lawrence et al. 2004)", |p, parts| {
        let count = |name: &str| match p.number(name) {
            n if n.fract() == 0.0 => Ok(n as usize),
            n => Err(format!("{name} = {n} is no whole number: write {name}={}", n.round())),
        };
        let over = match p.text("over") {
            "incident" => Parameterisation::Incident,
            _ => Parameterisation::HalfAngle,
        };
        let floor = p.number("floor");
        let factorisation = Factorisation { outer: count("outer")?, inner: count("inner")?, floor };
        let options = Options {
            over,
            theta: count("theta")?,
            phi: count("phi")?,
            theta_o: count("theta_o")?,
            factorisation,
        };
        Factored::new(parts.subject("subject"), options)
    })
    .subject("subject", "torrance-sparrow", "whose values are drawn; it reflects, without discrete lobes")
    .choice(
        "over",
        &["half-angle", "incident"],
        "what the factors are functions of; wi itself suits diffuse reflection",
    )
    .number("theta", default.theta as f64, 8.0..=64.0, "cells in its polar angle")
    .number("phi", default.phi as f64, 8.0..=64.0, "cells in its azimuth")
    .number("theta_o", default.theta_o as f64, 4.0..=32.0, "polar angles of wo")
    .number("outer", by.outer as f64, 1.0..=8.0, "terms F(wo) G(wp)")
    .number("inner", by.inner as f64, 1.0..=5.0, "terms u(θ) v(φ) of each G")
    .number("floor", by.floor, 0.01..=0.5, "share of draws that follow the cosine")
}

impl Factored {
    /// Tabulates and factors `subject`. `Err` with the reason where it cannot be
    /// factored: no eval, light on both sides, random values, discrete lobes, or
    /// lobes narrower than the grid.
    pub fn new(subject: Arc<dyn Subject>, options: Options) -> Result<Self, String> {
        let own = subject.describe();
        refuse(&*subject, &own)?;
        let isotropic = own.claims.isotropic;
        let given = Given::new(options.theta_o, if isotropic { 1 } else { (options.phi / 2).max(4) });
        let grid = Grid::new(options.over, options.theta, options.phi);
        let table = Table::of(&*subject, &grid, &given)?;
        seen(&table, &grid, &given)?;
        let density = cache::factored(&table, grid, given, isotropic, options.factorisation);
        let description = Description { name: "factored".into(), dimensions: 3, has: Has::default(), ..own };
        let description = description.claims(|c| {
            c.off_support = OffSupport::NoSample;
            c.rng = RandomNumbers::External;
        });
        Ok(Self { subject, description, density })
    }

    /// The density that is drawn from.
    pub fn density(&self) -> &FactoredDensity {
        &self.density
    }

    /// On which side wo is: a two-sided subject is turned over.
    fn side(&self, wo: Direction) -> f64 {
        if self.description.claims.two_sided && wo.z < 0.0 { -1.0 } else { 1.0 }
    }
}

/// Why a subject cannot be factored, whatever the grid.
fn refuse(subject: &dyn Subject, own: &Description) -> Result<(), String> {
    let name = &own.name;
    if !own.has.eval {
        return Err(format!("`{name}` has no eval: there are no values to factor"));
    }
    if own.claims.transmissive || !own.claims.reflective {
        return Err(format!(
            "`{name}` transmits: only reflection is factored; give it a subject that is reflective and not \
             transmissive"
        ));
    }
    if own.claims.stochastic {
        return Err(format!("the values of `{name}` are random: only what repeats itself can be factored"));
    }
    if is_discrete(subject, own) {
        return Err(format!(
            "`{name}` has a discrete lobe, which no density holds: give it a subject without (as \
             torrance-sparrow in place of conductor)"
        ));
    }
    Ok(())
}

/// `Err` where the grid does not see the lobes.
fn seen(table: &Table, grid: &Grid, given: &Given) -> Result<(), String> {
    let worst = (0..given.len())
        .map(|row| (row, table.misplaced(grid, row)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .filter(|(_, share)| !(*share <= MISPLACED));
    let Some((row, share)) = worst else { return Ok(()) };
    let wo = given.direction(row);
    Err(format!(
        "its lobe at wo = (θ {:.1}°, φ {:.1}°) is narrower than the grid of {} × {} cells, the first {:.2}° wide: \
         {:.0} % of the light lies elsewhere than its splines put it; use more theta and phi, or a rougher subject",
        wo.theta().to_degrees(),
        wo.phi().to_degrees(),
        grid.t.intervals(),
        grid.phi.intervals(),
        grid.first_width(),
        100.0 * share
    ))
}

impl Subject for Factored {
    fn describe(&self) -> Description {
        self.description.clone()
    }

    fn eval(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        self.subject.eval(wo, wi, transport, out)
    }

    fn pdf(
        &self,
        wo: Direction,
        wi: &[Direction],
        _: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        let side = self.side(wo);
        let over = |w: Direction| Direction::new(w.x, w.y, side * w.z);
        let density = self.density.given(over(wo));
        wi.iter().zip(out).for_each(|(wi, p)| *p = density.pdf(over(*wi)));
        Ok(())
    }

    fn sample(
        &self,
        wo: Direction,
        u: &[f64],
        transport: Transport,
        out: &mut Samples,
    ) -> Result<(), SubjectError> {
        let side = self.side(wo);
        let over = |w: Direction| Direction::new(w.x, w.y, side * w.z);
        let density = self.density.given(over(wo));
        let drawn: Vec<Option<Direction>> =
            u.chunks_exact(3).map(|u| density.sample([u[0], u[1], u[2]])).collect();
        let wi: Vec<Direction> = drawn.iter().flatten().map(|w| over(*w)).collect();
        let channels = self.description.channels.len();
        let mut value = vec![0.0; wi.len() * channels];
        self.subject.eval(wo, &wi, transport, &mut value)?;
        let lobe = match self.density.grid().over {
            Parameterisation::HalfAngle => Lobe::GLOSSY_REFLECTION,
            Parameterisation::Incident => Lobe::DIFFUSE_REFLECTION,
        };
        let mut values = value.chunks_exact(channels);
        for front in drawn {
            let sample = front.map(|front| {
                let wi = over(front);
                let pdf = density.pdf(front);
                let value = Spectrum::from(values.next().expect("each direction has its values"));
                let cosine = if self.description.claims.cosine == Cosine::Included { 1.0 } else { front.z };
                Sample { wi, weight: value * (cosine / pdf), pdf, lobe }
            });
            out.push(sample.as_ref());
        }
        Ok(())
    }

    fn hints(&self, wo: Direction) -> Vec<Direction> {
        self.subject.hints(wo)
    }

    fn cells(&self, wo: Direction) -> Option<NativeCells> {
        self.subject.cells(wo)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::Registry;

    fn factored(text: &str) -> Factored {
        let subject = Registry::builtin().resolve(&text.parse().unwrap()).unwrap().subject;
        let factorisation = Factorisation { outer: 2, inner: 2, floor: 0.02 };
        Factored::new(subject, Options { theta: 24, phi: 8, theta_o: 4, factorisation, ..Options::default() })
            .unwrap()
    }

    #[test]
    fn equal_values_are_factored_once_whatever_their_name() {
        let first = factored("torrance-sparrow");
        let same = factored("torrance-sparrow:sampling=normals");
        let other = factored("torrance-sparrow:alpha=0.21");
        assert!(Arc::ptr_eq(&first.density, &same.density));
        assert!(!Arc::ptr_eq(&first.density, &other.density));
    }

    #[test]
    fn probabilities_add_up_to_one_at_every_wo_and_a_black_subject_is_left_to_the_cosine() {
        let density = |text: &str, wo| factored(text).density.probabilities(wo).iter().sum::<f64>();
        for wo in [0.0, 0.1, 0.7, 1.5, 1.57].map(|theta| Direction::from_angles(theta, 2.0)) {
            assert!((density("torrance-sparrow", wo) - 1.0).abs() < 1e-12);
        }
        let wo = Direction::from_angles(0.7, 2.0);
        assert_eq!(density("lambert:reflectance=0", wo), 0.0);
        let pdf = factored("lambert:reflectance=0").density.given(wo).pdf(Direction::NORMAL);
        assert!((pdf - std::f64::consts::FRAC_1_PI).abs() < 1e-15);
    }

    #[test]
    fn nothing_breaks_at_the_ends() {
        let all = factored("torrance-sparrow");
        let last = 1.0 - f64::EPSILON / 2.0;
        let grazing = Direction::new(1.0, 0.0, 1e-12);
        for wo in [Direction::NORMAL, Direction::new(-0.0, -0.0, 1.0), grazing] {
            let density = all.density.given(wo);
            for u in [0.0, 0.5, last].iter().flat_map(|a| [0.0, last].map(|b| [*a, b, b])) {
                let wi = density.sample(u);
                assert!(
                    wi.is_none_or(|wi| density.pdf(wi) > 0.0 && density.pdf(wi).is_finite()),
                    "{wo:?} {u:?}"
                );
            }
            assert!(density.pdf(grazing.mirrored()).is_finite());
        }
        let below = all.density.given(Direction::new(0.6, 0.0, -0.8));
        assert_eq!((below.sample([0.5; 3]), below.pdf(Direction::NORMAL)), (None, 0.0));
    }
}
