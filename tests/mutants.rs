//! The quick kill matrix: each mutant is caught by every check whose identity it
//! breaks, and by no other; negative controls pass.

use gonio::calibration::quick_rows;
use gonio::cause::Cause;
use gonio::mutants::{Mutant, controls, of_cause};

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
fn negative_controls_pass() {
    are_labelled_rightly(controls());
}
