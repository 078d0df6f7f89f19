//! The quick kill matrix: each mutant is caught by every check whose identity it
//! breaks, and by no other; negative controls pass.

use gonio::calibration::quick_rows;
use gonio::cause::Cause;
use gonio::checks;
use gonio::mutants::{Mutant, all, controls, of_cause};
use gonio::registry::Value;
use std::collections::BTreeSet;

fn are_labelled_rightly(mutants: Vec<Mutant>) {
    let errors: Vec<_> = quick_rows(&mutants).iter().flat_map(|row| row.errors()).collect();
    assert!(errors.is_empty(), "{}", errors.join("\n"));
}

macro_rules! killed {
    ($($name:ident: $cause:ident;)*) => {
        $(#[test]
        fn $name() {
            are_labelled_rightly(of_cause(Cause::$cause));
        })*
    };
}

killed! {
    constant_factor: ConstantFactor;
    half_vector_jacobian: HalfVectorJacobian;
    ndf_measure: NdfMeasure;
    swapped_arguments: SwappedArguments;
    wrong_measure: WrongMeasure;
    ndf_vndf_mismatch: NdfVndfMismatch;
    refraction_jacobian: RefractionJacobian;
    eta_side: EtaSide;
    lobe_probability: LobeProbability;
    random_number_reuse: RandomNumberReuse;
    wrong_density: WrongDensity;
    unnormalized_rejection: UnnormalizedRejection;
    support: Support;
    frame: Frame;
    weight: Weight;
    implementation_drift: ImplementationDrift;
    fresnel_argument: FresnelArgument;
    masking: Masking;
    normalization: Normalization;
    energy_compensation: EnergyCompensation;
    transport_mode: TransportMode;
    discrete_lobe: DiscreteLobe;
    numerics: Numerics;
    parameter: Parameter;
    table: Table;
}

#[test]
fn labels_name_what_there_is() {
    let mut names = BTreeSet::new();
    for m in all().into_iter().chain(controls()) {
        assert!(names.insert(m.model_name()), "{} is there twice", m.model_name());
        assert!(!m.source.is_empty() && !m.shows_at.is_empty(), "{}", m.name);
        let labels = [m.must_fail, m.may_fail, m.must_warn].concat();
        assert!(labels.iter().all(|id| checks::find(id).is_some()), "{}: {labels:?}", m.name);
        assert_eq!(labels.iter().collect::<BTreeSet<_>>().len(), labels.len(), "{}: {labels:?}", m.name);
        let model = m.model();
        for (name, least, most) in m.varied {
            let parameter = model.parameter(name).unwrap_or_else(|e| panic!("{}: {e}", m.name));
            let taken = |v: &f64| parameter.check(&Value::Number(*v)).is_ok();
            assert!(least < most && taken(least) && taken(most), "{}: {name} from {least} to {most}", m.name);
        }
    }
    for cause in Cause::ALL {
        assert!(of_cause(cause).len() >= 2, "{}", cause.slug());
    }
}

#[test]
fn negative_controls_pass() {
    are_labelled_rightly(controls());
}
