//! What is known of a mutant, and all of them.

use crate::bsdf::Subject;
use crate::cause::Cause;
use crate::models;
use crate::registry::{Model, Parameters, Spelling};
use std::sync::Arc;

/// What the name of a mutant's model begins with, and that of a control's.
const PREFIX: [&str; 2] = ["mutant-", "control-"];

/// The parameter that grades a bug.
pub const STRENGTH: &str = "epsilon";

/// How strong a bug is, where it has a natural strength: a factor 1 + ε, a share
/// ε of the samples, a parameter off by ε. At 0 the mutant is the correct model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// In the kill matrix.
    pub default: f64,
    /// The largest that makes sense.
    pub most: f64,
    /// What ε is, with its unit.
    pub meaning: &'static str,
}

type Build = fn(&Parameters, f64) -> Result<Arc<dyn Subject>, String>;

/// A correct model with one bug.
#[derive(Clone, Debug)]
pub struct Mutant {
    /// Its name, without the prefix of its model's.
    pub name: &'static str,
    /// Causes that no measurement tells from its own, with the reason.
    pub equivalent: &'static [(Cause, &'static str)],
    /// What kind of bug it has; none of a negative control: correct code that looks
    /// wrong.
    pub cause: Option<Cause>,
    /// The bug in one line.
    pub what: &'static str,
    /// Where it was found: commits and issues of renderers, or whose mistake it is; the
    /// form that it takes where it is of no one place.
    pub source: &'static str,
    /// The correct model, spelled with the mutant's own defaults.
    pub of: &'static str,
    /// Numbers that a random mutant draws between these ends, in place of `of`'s.
    pub varied: &'static [(&'static str, f64, f64)],
    /// Polar angles of wo in degrees where it shows best.
    pub shows_at: &'static [f64],
    /// Checks that must fail, as the bug breaks their identity by more than they
    /// tolerate.
    pub must_fail: &'static [&'static str],
    /// Checks that may fail: their identity is broken, but by how much depends.
    pub may_fail: &'static [&'static str],
    /// Checks that must warn: conventions.
    pub must_warn: &'static [&'static str],
    /// How strong it is.
    pub strength: Option<Strength>,
    /// Only a comparison with the correct model can see it, so it is compared.
    pub compared: bool,
    build: Build,
}

impl Mutant {
    /// A mutant of the correct model spelled `of`; every other label is to be given.
    pub(super) fn new(name: &'static str, of: &'static str, what: &'static str, build: Build) -> Self {
        Self {
            name,
            cause: None,
            equivalent: &[],
            what,
            source: "",
            of,
            varied: &[],
            shows_at: &[30.0, 75.0],
            must_fail: &[],
            may_fail: &[],
            must_warn: &[],
            strength: None,
            compared: false,
            build,
        }
    }

    /// No measurement tells these causes from its own, for these reasons.
    pub(super) fn equivalent(self, equivalent: &'static [(Cause, &'static str)]) -> Self {
        Self { equivalent, ..self }
    }

    /// Where it was found.
    pub(super) fn source(self, source: &'static str) -> Self {
        Self { source, ..self }
    }

    /// Numbers of the correct model that may be drawn at random: name, least, most.
    pub(super) fn varied(self, varied: &'static [(&'static str, f64, f64)]) -> Self {
        Self { varied, ..self }
    }

    /// Polar angles in degrees where it shows best; 30 and 75 where not given.
    pub(super) fn shows_at(self, shows_at: &'static [f64]) -> Self {
        Self { shows_at, ..self }
    }

    /// Checks whose identity it breaks.
    pub(super) fn must_fail(self, must_fail: &'static [&'static str]) -> Self {
        Self { must_fail, ..self }
    }

    /// Checks whose identity it breaks, perhaps by less than they tolerate.
    pub(super) fn may_fail(self, may_fail: &'static [&'static str]) -> Self {
        Self { may_fail, ..self }
    }

    /// Checks that tell it as a convention.
    pub(super) fn must_warn(self, must_warn: &'static [&'static str]) -> Self {
        Self { must_warn, ..self }
    }

    /// Its strength ε in [0, most], `default` in the kill matrix.
    pub(super) fn strength(self, default: f64, most: f64, meaning: &'static str) -> Self {
        Self { strength: Some(Strength { default, most, meaning }), ..self }
    }

    /// It breaks no identity of its own: it is compared with the correct model.
    pub(super) fn compared(self) -> Self {
        Self { compared: true, ..self }
    }

    /// The name of its model: `gonio check NAME` measures it.
    pub fn model_name(&self) -> String {
        format!("{}{}", PREFIX[usize::from(self.cause.is_none())], self.name)
    }

    /// Its model: the parameters of the correct one, and `epsilon` where it is
    /// graded.
    ///
    /// # Panics
    /// If `of` names no built-in model, which a test excludes.
    pub fn model(&self) -> Model {
        let of: Spelling = self.of.parse().expect("a mutant says of what it is one");
        let base = models::all().into_iter().find(|m| m.name() == of.name);
        let base = base.unwrap_or_else(|| panic!("`{}` is a built-in model", of.name));
        let (build, graded) = (self.build, self.strength.is_some());
        let label = self.cause.map_or("nothing is wrong with it", Cause::slug);
        let model = Model::dynamic(self.model_name(), format!("{} [{label}]", self.what), move |p| {
            build(p, if graded { p.number(STRENGTH) } else { 1.0 })
        });
        let model = model.with_parameters_of(&base, &of.parameters);
        match self.strength {
            Some(s) => model.number(STRENGTH, s.default, 0.0..=s.most, s.meaning).idle(),
            None => model,
        }
    }
}

/// The mutants with this cause.
pub fn of_cause(cause: Cause) -> Vec<Mutant> {
    let mutants = match cause {
        Cause::ConstantFactor => super::constant_factor::mutants(),
        Cause::HalfVectorJacobian => super::half_vector_jacobian::mutants(),
        Cause::NdfMeasure => super::ndf_measure::mutants(),
        Cause::SwappedArguments => super::swapped_arguments::mutants(),
        Cause::WrongMeasure => super::wrong_measure::mutants(),
        Cause::NdfVndfMismatch => super::ndf_vndf_mismatch::mutants(),
        Cause::RefractionJacobian => super::refraction_jacobian::mutants(),
        Cause::EtaSide => super::eta_side::mutants(),
        Cause::LobeProbability => super::lobe_probability::mutants(),
        Cause::RandomNumberReuse => super::random_number_reuse::mutants(),
        Cause::WrongDensity => super::wrong_density::mutants(),
        Cause::UnnormalizedRejection => super::unnormalized_rejection::mutants(),
        Cause::Support => super::support::mutants(),
        Cause::Frame => super::frame::mutants(),
        Cause::Weight => super::weight::mutants(),
        Cause::ImplementationDrift => super::implementation_drift::mutants(),
        Cause::FresnelArgument => super::fresnel_argument::mutants(),
        Cause::Masking => super::masking::mutants(),
        Cause::Normalization => super::normalization::mutants(),
        Cause::EnergyCompensation => super::energy_compensation::mutants(),
        Cause::TransportMode => super::transport_mode::mutants(),
        Cause::DiscreteLobe => super::discrete_lobe::mutants(),
        Cause::Numerics => super::numerics::mutants(),
        Cause::Parameter => super::parameter::mutants(),
        Cause::Table => super::table::mutants(),
    };
    mutants.into_iter().map(|m| Mutant { cause: Some(cause), ..m }).collect()
}

/// Every mutant, by cause.
pub fn all() -> Vec<Mutant> {
    Cause::ALL.into_iter().flat_map(of_cause).collect()
}

/// The model of the mutant or control that is called `name`.
pub fn model(name: &str) -> Option<Model> {
    // Most names are none of a mutant, and there are many mutants.
    if !PREFIX.iter().any(|prefix| name.starts_with(prefix)) {
        return None;
    }
    all().into_iter().chain(controls()).find(|m| m.model_name() == name).map(|m| m.model())
}

/// Negative controls: correct code that looks wrong, which must pass.
pub fn controls() -> Vec<Mutant> {
    super::controls::controls()
}
