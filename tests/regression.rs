//! By which powers of cosines draws differ from pdf(): what theory says of real bugs.

use gonio::diagnosis::{Constant, Fitted, Pooled, Regression};
use gonio::engine::{Options, run};
use gonio::registry::{Registry, Spelling, Value};
use gonio::suite::{Overrides, load};

/// Polar angles of wo in degrees, and draws at each.
const THETA: [f64; 4] = [20.0, 45.0, 60.0, 75.0];
const DRAWS: u64 = 1 << 18;

fn pooled(subject: &str) -> Pooled {
    let spelling: Spelling = subject.parse().unwrap();
    let mut text = format!(
        "[suite]\nname = \"r\"\nsamples = \"2^13\"\ntheta = {THETA:?}\nphi = 33\n[[subject]]\nuse = \"{}\"\n",
        spelling.name
    );
    for (name, value) in &spelling.parameters {
        text += &match value {
            Value::Number(v) => format!("{name} = {v}\n"),
            Value::Text(v) => format!("{name} = \"{v}\"\n"),
        };
    }
    let only = Overrides { checks: vec!["goodness-of-fit".into()], ..Overrides::default() };
    let plan = load("r", &text, &Registry::builtin(), &only).unwrap().plan;
    let results = run(&plan, &Options::default(), &mut |_| {});
    Pooled::of(&results.cases.iter().collect::<Vec<_>>(), DRAWS)
}

fn is(fitted: Fitted, expected: f64) -> bool {
    let off = (fitted.value - expected).abs();
    off < 3.0 * fitted.error || off < 0.1
}

/// Exponents of cos θh, wo·h, cos θi, sin θh, and cos θo where it is fitted.
#[track_caller]
fn has_exponents(fit: &Regression, expected: [f64; 5]) {
    for (e, expected) in fit.exponents.iter().zip(expected) {
        assert!(e.is_none_or(|e| is(e, expected) && e.error < 0.05), "{fit:?}");
    }
    assert!(fit.reduced() > 0.9 && fit.reduced() < 1.1 && fit.is_factor(), "{}: {fit:?}", fit.reduced());
}

/// A constant and exponents of subjects whose pdf() is off by a product of powers.
#[test]
fn a_factor_is_found_with_its_exponents() {
    let (four, two_pi) = (4f64.ln(), std::f64::consts::TAU.ln());
    for (subject, c, exponents) in [
        ("torrance-sparrow:alpha=0.5,sampling=normals", 0.0, [0.0; 5]),
        ("torrance-sparrow:alpha=0.5", 0.0, [0.0; 5]),
        ("mutant-no-jacobian:sampling=normals", -four, [0.0, -1.0, 0.0, 0.0, 0.0]),
        ("mutant-pdf-d-without-cosine", 0.0, [1.0, 0.0, 0.0, 0.0, 0.0]),
        ("mutant-pdf-wo-n-for-wo-h:alpha=0.5", 0.0, [0.0, -1.0, 0.0, 0.0, 1.0]),
        ("mutant-pdf-of-half-vector-angle:alpha=0.5", -two_pi, [0.0, 0.0, 0.0, -1.0, 0.0]),
        ("mutant-cosine-said-uniform", 2f64.ln(), [0.0, 0.0, 1.0, 0.0, 0.0]),
        ("mutant-lambert-pdf-without-pi", -std::f64::consts::PI.ln(), [0.0; 5]),
    ] {
        let pooled = pooled(subject);
        let fit = pooled.fit(Constant::One).unwrap();
        has_exponents(&fit, exponents);
        let found = fit.constants[0];
        assert!((found.value - c).abs() < (4.0 * found.error).max(0.02), "{subject}: {found} for {c}");
        assert!(pooled.left_out() < 0.02, "{subject}: {}", pooled.left_out());
        let words = pooled.words().unwrap();
        assert!(!words.contains("c(θo)") && !words.contains("no product"), "{subject}: {words}");
    }
}

/// GGX's Smith masking at α = 0.5.
fn g1(theta: f64) -> f64 {
    let tan = theta.to_radians().tan();
    2.0 / (1.0 + (1.0 + 0.25 * tan * tan).sqrt())
}

/// A factor of wo alone has a power of cos θo that is not whole, and does not fit; by a
/// constant for each wo it does, and the other exponents are whole.
#[test]
fn a_function_of_wo_is_no_whole_power_of_its_cosine() {
    let of_wo = |theta: f64| theta.to_radians().cos() / g1(theta);
    type Of = Option<fn(f64) -> f64>;
    for (subject, of, exponents, cos_o) in [
        ("mutant-all-normals-pdf-of-visible:distribution=ggx", None, [1.0, -1.0, 0.0, 0.0, 0.0], 0.64),
        ("mutant-visible-normals-pdf-of-all", None, [-1.0, 1.0, 0.0, 0.0, 0.0], -0.63),
        ("mutant-pdf-without-g1:alpha=0.5", Some(g1 as fn(f64) -> f64) as Of, [0.0; 5], 0.36),
        ("mutant-redrawn-below-horizon:alpha=0.5,sampling=normals", None, [0.0; 5], -0.21),
    ] {
        let pooled = pooled(subject);
        let one = pooled.fit(Constant::One).unwrap();
        let found = one.exponents[4].unwrap();
        assert!(!found.is_whole() && (found.value - cos_o).abs() < 0.06, "{subject}: {found}");
        let each = pooled.fit(Constant::EachWo).unwrap();
        has_exponents(&each, exponents);
        assert!(each.x2 <= one.x2 + 3.0, "{subject}");
        for (theta, c) in THETA.iter().zip(&each.constants) {
            let expected = match (of, exponents[0]) {
                (Some(of), _) => of(*theta).ln(),
                (None, power) if power != 0.0 => power * of_wo(*theta).ln(),
                _ => continue,
            };
            assert!((c.value - expected).abs() < (4.0 * c.error).max(0.02), "{subject} {theta}: {c}");
        }
        let words = pooled.words().unwrap();
        assert!(words.starts_with("log(observed/pdf) = c(θo)"), "{subject}: {words}");
    }
}

/// What is no product of powers leaves a χ² that says so.
#[test]
fn what_is_no_factor_is_called_none() {
    for subject in [
        "mutant-pdf-arguments-exchanged",
        "mutant-alpha-squared",
        "mutant-visible-pdf-without-d",
        "mutant-flipped-below-horizon:alpha=0.5,distribution=ggx,sampling=normals",
        "mutant-number-not-stretched",
        "mutant-half-vector-returned:sampling=normals",
    ] {
        let pooled = pooled(subject);
        for constant in [Constant::One, Constant::EachWo] {
            let fit = pooled.fit(constant).unwrap();
            assert!(fit.reduced() > 2.0 && !fit.is_factor(), "{subject}: {fit:?}");
        }
        let words = pooled.words().unwrap();
        assert!(words.starts_with("observed/pdf is no product of powers"), "{subject}: {words}");
    }
    // The lobes of plastic are smooth: five powers fit their sum, but none is whole.
    let shares = pooled("mutant-one-share-forgotten");
    assert!([Constant::One, Constant::EachWo].iter().all(|c| !shares.fit(*c).unwrap().is_factor()));
}

/// Three wo are too few: wo·h, cos θh and cos θo are hardly told apart.
#[test]
fn of_too_few_directions_nothing_is_fitted() {
    let text = "[suite]\nname = \"r\"\nsamples = \"2^13\"\ntheta = [20, 45, 60]\nphi = [33, 93]\n\
                [[subject]]\nuse = \"torrance-sparrow\"\n";
    let only = Overrides { checks: vec!["goodness-of-fit".into()], ..Overrides::default() };
    let plan = load("r", text, &Registry::builtin(), &only).unwrap().plan;
    let results = run(&plan, &Options::default(), &mut |_| {});
    let pooled = Pooled::of(&results.cases.iter().collect::<Vec<_>>(), 1 << 14);
    assert_eq!(pooled.directions(), 3);
    assert!(pooled.fit(Constant::One).is_none() && pooled.words().is_none());
}
