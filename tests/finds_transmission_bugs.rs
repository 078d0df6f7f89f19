//! Bugs of rough glass and of plastic are found by the checks whose identity they
//! break, and by no other.

mod common;

use common::glass::{Glass, GlassBug};
use common::measuring::{case, measure, told, verdicts};
use common::plastic::{PlasticBug, RoughCoat, SmoothCoat};
use gonio::bsdf::{Subject, Transport};
use gonio::checks::Verdict;
use gonio::models::Plastic;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Checks that must find a bug, and that may.
type Expected = (&'static [&'static str], &'static [&'static str]);

/// Measures `make()` at each `theta`, in both modes if `both`.
fn found(
    name: &str,
    make: impl Fn() -> Arc<dyn Subject>,
    thetas: &[f64],
    both: bool,
    (must, may): Expected,
) -> Result<BTreeSet<&'static str>, String> {
    let mut cases = Vec::new();
    for theta in thetas {
        cases.push(case(name, make(), *theta, 1 << 17));
        if both {
            let mut other = case(name, make(), *theta, 1 << 17);
            other.transport = Transport::Importance;
            cases.push(other);
        }
    }
    let results = measure(cases);
    let verdicts = verdicts(&results);
    let failed = verdicts.get(&Verdict::Fail).cloned().unwrap_or_default();
    let missed: Vec<_> = must.iter().filter(|c| !failed.contains(**c)).collect();
    let wrong: Vec<_> = failed.iter().filter(|c| !must.contains(c) && !may.contains(c)).collect();
    if !missed.is_empty() || !wrong.is_empty() || verdicts.contains_key(&Verdict::Error) {
        let all: Vec<_> =
            [Verdict::Fail, Verdict::Error].into_iter().flat_map(|v| told(&results, v)).collect();
        return Err(format!("{name} slips through {missed:?} and fails {wrong:?}: {all:#?}"));
    }
    Ok(verdicts.get(&Verdict::Warn).cloned().unwrap_or_default())
}

const GLASS: &[(GlassBug, Expected)] = &[
    (GlassBug::None, (&[], &[])),
    (GlassBug::SpuriousEta, (&["goodness-of-fit", "normalization", "jacobian", "albedo", "mis"], &[])),
    (GlassBug::SwappedCosine, (&["goodness-of-fit", "normalization", "jacobian"], &["albedo", "mis"])),
    (GlassBug::ReflectionJacobian, (&["goodness-of-fit", "normalization", "jacobian", "albedo", "mis"], &[])),
    // pdf() is above what any branch of the sampler gives, which is no breach of a
    // lower bound.
    (GlassBug::NotFolded, (&["goodness-of-fit", "normalization", "albedo", "mis"], &["jacobian"])),
    // Where facets are never drawn there is no light: the means are right.
    (GlassBug::NoSideTest, (&["goodness-of-fit", "normalization", "support"], &[])),
    (
        GlassBug::EtaNotInverted,
        (&["goodness-of-fit", "normalization"], &["support", "jacobian", "albedo", "mis"]),
    ),
    (GlassBug::FresnelAtNormal, (&["reciprocity"], &[])),
    (GlassBug::FlaggedReflection, (&["discrete-lobes"], &[])),
    // Both modes are claimed, and one is not there.
    (GlassBug::OneScale, (&["reciprocity"], &[])),
    (GlassBug::OneScaleAsConvention, (&[], &[])),
];

#[test]
fn bugs_of_rough_glass() {
    let mut errors = Vec::new();
    for (bug, expected) in GLASS {
        let convention = *bug == GlassBug::OneScaleAsConvention;
        let make = || Arc::new(Glass::new(0.4, 1.5, *bug)) as Arc<dyn Subject>;
        let told = if convention { BTreeSet::from(["reciprocity"]) } else { BTreeSet::new() };
        match found(&format!("{bug:?}"), make, &[30.0, 75.0, 120.0, 150.0], !convention, *expected) {
            Ok(warned) if warned == told => {}
            Ok(warned) => errors.push(format!("{bug:?} is warned of by {warned:?}")),
            Err(error) => errors.push(error),
        }
    }
    assert!(errors.is_empty(), "{}", errors.join("\n"));
}

const ROUGH: &[(PlasticBug, Expected)] = &[
    (PlasticBug::None, (&[], &[])),
    (
        PlasticBug::NotRescaled,
        (&["goodness-of-fit"], &["normalization", "support", "albedo", "mis", "jacobian"]),
    ),
    (PlasticBug::OtherProbability, (&["goodness-of-fit"], &["normalization", "albedo", "mis", "jacobian"])),
    (PlasticBug::NotFolded, (&["goodness-of-fit", "normalization", "albedo", "mis"], &["jacobian"])),
    // Without multiple importance sampling the mean is right all the same.
    (PlasticBug::OneLobe, (&["weight", "returned-pdf"], &["mis"])),
    (PlasticBug::OneWay, (&["reciprocity"], &[])),
];

#[test]
fn bugs_of_rough_plastic() {
    let mut errors = Vec::new();
    for (bug, expected) in ROUGH {
        let make = || Arc::new(RoughCoat::new(0.3, *bug)) as Arc<dyn Subject>;
        errors.extend(found(&format!("rough {bug:?}"), make, &[30.0, 60.0, 75.0], false, *expected).err());
    }
    assert!(errors.is_empty(), "{}", errors.join("\n"));
}

const SMOOTH: &[(PlasticBug, Expected)] = &[
    (PlasticBug::None, (&[], &[])),
    (
        PlasticBug::NotRescaled,
        (&["goodness-of-fit"], &["normalization", "support", "albedo", "mis", "jacobian"]),
    ),
    (PlasticBug::OtherProbability, (&["discrete-lobes", "albedo", "mis"], &[])),
];

#[test]
fn bugs_of_smooth_plastic() {
    let mut errors = Vec::new();
    for (bug, expected) in SMOOTH {
        let make = || Arc::new(SmoothCoat { right: Plastic::new(0.6, 1.5), bug: *bug }) as Arc<dyn Subject>;
        errors.extend(found(&format!("smooth {bug:?}"), make, &[30.0, 60.0, 75.0], false, *expected).err());
    }
    assert!(errors.is_empty(), "{}", errors.join("\n"));
}
