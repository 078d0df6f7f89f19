use super::*;
use crate::bsdf::{Bsdf, Description, Sample, Spectrum};
use crate::models::{HemisphereSampling, Lambert};
use crate::registry::Registry;
use crate::statistics::{binomial, uniformity};
use std::sync::Arc;

const WO: Direction = Direction::new(0.6, 0.0, 0.8);
const LAMBERT: Lambert = Lambert { reflectance: 0.8, sampling: HemisphereSampling::Cosine };

fn key(seed: u64) -> StreamKey {
    StreamKey::new(seed)
}

fn subject(spelling: &str) -> Arc<dyn Subject> {
    Registry::builtin().resolve(&spelling.parse().unwrap()).unwrap().subject
}

fn run(grid: FixedGrid, subject: &dyn Subject, wo: Direction) -> GridOutcome {
    grid.test(subject, wo, Transport::Radiance, grid.samples, &key(1)).unwrap()
}

/// Lambert with a wrong scale of pdf and a share of stray samples.
struct Wrong {
    scale: f64,
    stray: f64,
    to: fn(&[f64]) -> Direction,
}

impl Bsdf for Wrong {
    fn describe(&self) -> Description {
        Bsdf::describe(&LAMBERT).dimensions(3)
    }
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> Spectrum {
        Bsdf::eval(&LAMBERT, wo, wi, transport)
    }
    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        self.scale * Bsdf::pdf(&LAMBERT, wo, wi, transport)
    }
    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        let sample = Bsdf::sample(&LAMBERT, wo, u, transport)?;
        Some(if u[2] < self.stray { Sample { wi: (self.to)(u), ..sample } } else { sample })
    }
}

#[test]
fn a_constant_needs_the_least_evaluations() {
    for (grid, evaluations) in RECIPES.into_iter().zip([25 * 10 * 20, 25 * 80 * 160]) {
        let expected = grid.expect(&LAMBERT, WO, Transport::Radiance).unwrap();
        let mass: f64 = expected.probability.iter().sum();
        assert!((mass - 1.0).abs() < 1e-5, "{} {mass}", grid.name);
        assert_eq!(expected.evaluations, evaluations);
        // The lower hemisphere is empty to the last cell.
        let below = expected.probability.iter().filter(|p| **p == 0.0).count();
        assert_eq!(below, grid.theta * grid.phi / 2);
    }
}

#[test]
fn cells_hold_what_their_integrals_cover() {
    for grid in RECIPES {
        for row in 0..grid.theta {
            for column in 0..grid.phi {
                let middle = |[a, b]: [f64; 2]| 0.5 * (a + b);
                let (latitude, phi) = (middle(grid.latitudes(row)), middle(grid.longitudes(column)));
                assert_eq!(grid.cell(grid.spacing.direction(latitude, phi)), row * grid.phi + column);
            }
        }
        let last = grid.theta * grid.phi;
        for wi in [Direction::new(0.0, 0.0, 1.0 + 1e-9), Direction::new(f64::NAN, 0.0, f64::NAN)] {
            assert!(grid.cell(wi) < last);
        }
    }
}

#[test]
fn lambert_is_rejected_as_often_as_it_must() {
    for grid in RECIPES {
        let expected = grid.expect(&LAMBERT, WO, Transport::Radiance).unwrap();
        let outcomes = (0..40).map(|seed| {
            let observed = grid.observe(&LAMBERT, WO, Transport::Radiance, 100_000, &key(seed)).unwrap();
            grid.compare(&expected, &observed)
        });
        let mut p: Vec<f64> = outcomes.map(|o| o.p_value).collect();
        let rejected = p.iter().filter(|p| **p < grid.significance).count() as u64;
        let ln_tail = binomial::ln_upper_tail(rejected, 40, grid.significance);
        assert!(ln_tail > f64::ln(1e-3), "{} of 40 by {}", rejected, grid.name);
        let (d, uniform) = uniformity::kolmogorov_smirnov(&mut p);
        assert!(uniform > 1e-3, "{}: D = {d}", grid.name);
    }
}

#[test]
fn a_pdf_5_percent_too_large_is_rejected() {
    for grid in RECIPES {
        let wrong = Wrong { scale: 1.05, stray: 0.0, to: |_| WO };
        let outcome = run(grid, &wrong, WO);
        assert!(outcome.rejected && outcome.p_value < 1e-30 && outcome.reason.is_none(), "{outcome:?}");
    }
}

#[test]
fn stray_samples_count_from_eleven_in_one_cell() {
    let down: fn(&[f64]) -> Direction = |_| Direction::new(0.0, 0.0, -1.0);
    let scattered: fn(&[f64]) -> Direction = |u| Direction::from_angles(PI - u[0], TAU * u[1]);
    for grid in RECIPES {
        let run = |stray, to| run(grid, &Wrong { scale: 1.0, stray, to }, WO);
        let outcome = run(1e-4, down);
        assert!(outcome.rejected && outcome.p_value == 0.0);
        assert!(outcome.reason.unwrap().contains("where none is expected"));
        // As many in different cells go by, and few in one.
        assert!(!run(1e-4, scattered).rejected);
        assert!(!run(3e-6, down).rejected);
    }
}

#[test]
fn narrow_lobes_of_correct_models_are_rejected() {
    let test = |grid: FixedGrid, alpha: &str, wo| {
        let subject = subject(&format!("torrance-sparrow:alpha={alpha}"));
        let expected = grid.expect(&*subject, wo, Transport::Radiance).unwrap();
        let observed = grid.observe(&*subject, wo, Transport::Radiance, grid.samples, &key(1)).unwrap();
        (expected.probability.iter().sum::<f64>(), grid.compare(&expected, &observed))
    };
    // The lobe around the pole, seen by one line of points: its mass and the
    // number of evaluations as a recursion in Python finds them.
    let (mass, outcome) = test(NORI, "0.01", Direction::NORMAL);
    assert!((mass - 1.571_654_783_007_44).abs() < 1e-12, "{mass}");
    assert_eq!(outcome.evaluations, 9000);
    assert!(outcome.rejected && outcome.p_value == 0.0, "{outcome:?}");
    // Finer cells see this one, and at grazing they too miss what is narrower.
    let (mass, outcome) = test(PBRT, "0.01", Direction::NORMAL);
    assert!((mass - 0.9999).abs() < 1e-4 && !outcome.rejected, "{mass} {outcome:?}");
    let grazing = Direction::from_angles(1.55, 0.7);
    let (mass, outcome) = test(PBRT, "0.0003", grazing);
    assert!(mass < 1e-3 && outcome.rejected, "{mass} {outcome:?}");
}

#[test]
fn what_no_cell_can_hold_is_rejected() {
    // A mirror has no continuous samples, and a black surface only such that are
    // dropped; both are correct.
    for spelling in ["conductor", "lambert:reflectance=0"] {
        let subject = subject(spelling);
        for grid in RECIPES {
            let outcome = run(grid, &*subject, WO);
            assert!(outcome.rejected, "{spelling}");
            assert_eq!(outcome.reason.is_some(), spelling == "conductor");
        }
    }
}

#[test]
fn broken_numbers_are_rejected() {
    let observed = Observed { counts: vec![50; 200], samples: 10_000 };
    let good = Expected { probability: vec![0.005; 200], evaluations: 0 };
    assert!(!NORI.compare(&good, &observed).rejected);
    for value in [f64::NAN, -0.005, f64::INFINITY] {
        let mut expected = good.clone();
        expected.probability[7] = value;
        let outcome = NORI.compare(&expected, &observed);
        assert!(outcome.rejected && outcome.p_value == 0.0, "{outcome:?}");
    }
}

#[test]
fn small_cells_are_pooled_from_the_smallest() {
    let grid = FixedGrid { theta: 1, phi: 6, ..NORI };
    // Expected 0, 1, 2, 6, 20, 71: the pool takes 1, 2 and, as 3 < 5, also 6.
    let probability = vec![0.71, 0.02, 0.2, 0.01, 0.0, 0.06];
    let observed = Observed { counts: vec![70, 4, 17, 2, 0, 7], samples: 100 };
    let outcome = grid.compare(&Expected { probability, evaluations: 0 }, &observed);
    let statistic = 16.0 / 9.0 + 9.0 / 20.0 + 1.0 / 71.0;
    assert!((outcome.statistic.0 - statistic).abs() < 1e-12);
    assert_eq!(outcome.dof, 2);
    // Two degrees of freedom are exponential.
    assert!((outcome.p_value - f64::exp(-0.5 * statistic)).abs() < 1e-12);
}

#[test]
fn sidak_is_exact_for_independent_tests() {
    assert_eq!(sidak(0.01, 0), sidak(0.01, 1));
    for tests in [1, 5, 1000] {
        let all_pass = (1.0 - sidak(0.01, tests)).powi(tests as i32);
        assert!((all_pass - 0.99).abs() < 1e-12);
    }
}

#[test]
fn a_subject_that_panics_is_an_error() {
    let wrong = Wrong { scale: 1.0, stray: 1.0, to: |_| panic!("no direction") };
    let result = NORI.test(&wrong, WO, Transport::Radiance, 1000, &key(1));
    assert!(matches!(result, Err(SubjectError::Panicked { function: "sample", .. })));
}
