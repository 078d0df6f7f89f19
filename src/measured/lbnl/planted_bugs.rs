//! Bugs planted in the sampler of a table are found; and without its cells even a
//! right one could not be measured.

use super::distribution::Distribution;
use super::subject::{Measured, Slice, Tamper};
use super::{Side, read};
use crate::bsdf::{ClaimsPatch, Description, Direction, Samples, Subject, SubjectError, Transport};
use crate::checks::Verdict;
use crate::engine::{CaseResult, Options, run};
use crate::evidence::Company;
use crate::sphere::{Cell, Chart, Shape};
use crate::suite::{Case, Plan, Settings};
use std::collections::BTreeSet;
use std::sync::Arc;

const BLIND: &[u8] = include_bytes!("../../../tests/data/lbnl/blind_klems_quarter.xml");

fn measure(subject: impl Subject + 'static) -> CaseResult<'static> {
    let case = Case {
        group: "table".into(),
        spelling: "table".into(),
        source: None,
        subject: Arc::new(subject),
        parameters: Default::default(),
        theta_deg: 60.0,
        phi_deg: 17.0,
        transport: Transport::Importance,
        claims: ClaimsPatch::default(),
        waivers: Vec::new(),
        company: Company::default(),
        reference: None,
        checks: Vec::new(),
        settings: Settings::default(),
    };
    let cases = vec![Arc::new(case)];
    let plan = Plan { suite: "test".into(), seed: 1, false_alarm: 1e-6, share: None, cases };
    run(&plan, &Options::default(), &mut |_| {}).cases.remove(0)
}

/// The checks that fail with this bug planted.
fn failing(tamper: Option<Tamper>) -> BTreeSet<&'static str> {
    let mut subject = Measured::new(read(BLIND).unwrap());
    subject.tamper = tamper;
    let result = measure(subject);
    let failed = result.findings.iter().filter(|f| f.outcome.verdict == Verdict::Fail);
    failed.map(|f| f.check).collect()
}

/// Sums of masses anew.
fn accumulate(slice: &mut Slice, masses: impl Iterator<Item = f64>) {
    let mut sum = 0.0;
    slice.cumulative = masses
        .map(|m| {
            sum += m;
            sum
        })
        .collect();
}

fn masses(slice: &Slice) -> Vec<f64> {
    let before = std::iter::once(&0.0).chain(&slice.cumulative);
    slice.cumulative.iter().zip(before).map(|(sum, before)| sum - before).collect()
}

fn set(names: &[&'static str]) -> BTreeSet<&'static str> {
    names.iter().copied().collect()
}

#[test]
fn nothing_is_found_where_nothing_is_planted() {
    assert_eq!(failing(None), set(&[]));
}

#[test]
fn a_patch_index_off_by_one() {
    let found = failing(Some(Box::new(|_, slice| {
        let mut shifted = masses(slice);
        shifted.rotate_right(1);
        accumulate(slice, shifted.into_iter());
    })));
    assert!(found.contains("goodness-of-fit"), "{found:?}");
}

/// f Ω in place of f Λ, with and without the density following.
#[test]
fn a_cosine_missing_from_the_mass_of_cells() {
    let without_cosine = |slice: &mut Slice| {
        let chart = Chart::new(0.0).shaped(Shape::ProjectedCylindrical);
        let mass =
            |(r, f): &(crate::bsdf::Rectangle, f64)| f * chart.solid_angle(&Cell { lo: r.lo, hi: r.hi });
        let wrong: Vec<f64> = slice.cells.iter().map(mass).collect();
        accumulate(slice, wrong.into_iter());
    };
    let found = failing(Some(Box::new(move |_, slice| {
        without_cosine(slice);
        let all = slice.cumulative.last().copied().unwrap();
        slice.cumulative.iter_mut().for_each(|sum| *sum *= slice.flux / all);
    })));
    assert!(found.contains("goodness-of-fit"), "{found:?}");
    let found = failing(Some(Box::new(move |_, slice| {
        without_cosine(slice);
        slice.flux = slice.cumulative.last().copied().unwrap();
    })));
    assert!(found.contains("normalization") && found.contains("goodness-of-fit"), "{found:?}");
}

#[test]
fn a_transposed_matrix() {
    let mut transposed = read(BLIND).unwrap();
    for block in transposed.reflection.iter_mut().chain(&mut transposed.transmission) {
        let Some(Distribution::Matrix(m)) = block else { unreachable!() };
        let n = m.incident.len();
        m.values = (0..n * n).map(|k| m.at(k % n, k / n)).collect();
    }
    let other = Measured::new(transposed);
    let found = failing(Some(Box::new(move |wo, slice| {
        *slice = other.make_slice(Side::of(wo).unwrap(), wo);
    })));
    assert!(found.contains("goodness-of-fit") && found.contains("normalization"), "{found:?}");
}

/// A right table that does not tell where its jumps are.
struct Untold(Measured);

impl Subject for Untold {
    fn describe(&self) -> Description {
        self.0.describe()
    }

    fn eval(
        &self,
        wo: Direction,
        wi: &[Direction],
        t: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        self.0.eval(wo, wi, t, out)
    }

    fn pdf(
        &self,
        wo: Direction,
        wi: &[Direction],
        t: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        self.0.pdf(wo, wi, t, out)
    }

    fn sample(&self, wo: Direction, u: &[f64], t: Transport, out: &mut Samples) -> Result<(), SubjectError> {
        self.0.sample(wo, u, t, out)
    }
}

#[test]
fn cells_are_what_makes_it_measurable() {
    let evaluations = |result: CaseResult| result.evidence.unwrap().integrals.unwrap().evaluations;
    let told = measure(Measured::new(read(BLIND).unwrap()));
    let untold = measure(Untold(Measured::new(read(BLIND).unwrap())));
    let passed = |r: &CaseResult| {
        r.findings.iter().all(|f| matches!(f.outcome.verdict, Verdict::Pass | Verdict::Skipped))
    };
    assert!(passed(&told));
    // It must not fail, but it cannot be decided, after ten times the work.
    assert!(!passed(&untold));
    assert!(untold.findings.iter().all(|f| f.outcome.verdict != Verdict::Fail));
    assert!(evaluations(untold) > 10 * evaluations(told));
}
