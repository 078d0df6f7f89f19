//! What can be wrong with a BSDF: the causes that mutants are labelled with, a
//! diagnosis names, and the manual explains.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A kind of bug, by what it does to the three functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// A constant factor in pdf or in f.
    ConstantFactor,
    /// The Jacobian 1/(4 wo·h) of reflection about a half vector.
    HalfVectorJacobian,
    /// D taken for D cos θh, or the reverse.
    NdfMeasure,
    /// A wrong dot product, or exchanged arguments.
    SwappedArguments,
    /// A density in (θ, φ), area or projected solid angle.
    WrongMeasure,
    /// Normals drawn by one strategy, pdf of another; D or G1 missing.
    NdfVndfMismatch,
    /// The Jacobian of refraction, and its η².
    RefractionJacobian,
    /// The index of the wrong side, or total reflection mishandled.
    EtaSide,
    /// The probability of choosing a lobe.
    LobeProbability,
    /// A random number used twice, or not stretched after a choice.
    RandomNumberReuse,
    /// The sampler draws another density.
    WrongDensity,
    /// Samples redrawn or mirrored without dividing the pdf.
    UnnormalizedRejection,
    /// The horizon, the side or the support.
    Support,
    /// Frames, azimuths, the back side.
    Frame,
    /// The weight, or the pdf that comes with a sample.
    Weight,
    /// The functions evaluate different models.
    ImplementationDrift,
    /// The angle or the equations of the Fresnel term.
    FresnelArgument,
    /// Masking and shadowing.
    Masking,
    /// The normalisation of f.
    Normalization,
    /// Energy compensation, and mixing that is not linear.
    EnergyCompensation,
    /// Radiance taken for importance.
    TransportMode,
    /// Discrete lobes and flags.
    DiscreteLobe,
    /// NaN, infinity, cancellation, hostile inputs.
    Numerics,
    /// Units, slips, parameters without effect.
    Parameter,
    /// Tables looked up wrongly.
    Table,
}

impl Cause {
    /// Every one.
    pub const ALL: [Self; 25] = [
        Self::ConstantFactor,
        Self::HalfVectorJacobian,
        Self::NdfMeasure,
        Self::SwappedArguments,
        Self::WrongMeasure,
        Self::NdfVndfMismatch,
        Self::RefractionJacobian,
        Self::EtaSide,
        Self::LobeProbability,
        Self::RandomNumberReuse,
        Self::WrongDensity,
        Self::UnnormalizedRejection,
        Self::Support,
        Self::Frame,
        Self::Weight,
        Self::ImplementationDrift,
        Self::FresnelArgument,
        Self::Masking,
        Self::Normalization,
        Self::EnergyCompensation,
        Self::TransportMode,
        Self::DiscreteLobe,
        Self::Numerics,
        Self::Parameter,
        Self::Table,
    ];

    /// As reports and the manual name it.
    pub fn slug(self) -> &'static str {
        match self {
            Self::ConstantFactor => "constant-factor",
            Self::HalfVectorJacobian => "half-vector-jacobian",
            Self::NdfMeasure => "ndf-measure",
            Self::SwappedArguments => "swapped-arguments",
            Self::WrongMeasure => "wrong-measure",
            Self::NdfVndfMismatch => "ndf-vndf-mismatch",
            Self::RefractionJacobian => "refraction-jacobian",
            Self::EtaSide => "eta-side",
            Self::LobeProbability => "lobe-probability",
            Self::RandomNumberReuse => "random-number-reuse",
            Self::WrongDensity => "wrong-density",
            Self::UnnormalizedRejection => "unnormalized-rejection",
            Self::Support => "support",
            Self::Frame => "frame",
            Self::Weight => "weight",
            Self::ImplementationDrift => "implementation-drift",
            Self::FresnelArgument => "fresnel-argument",
            Self::Masking => "masking",
            Self::Normalization => "normalization",
            Self::EnergyCompensation => "energy-compensation",
            Self::TransportMode => "transport-mode",
            Self::DiscreteLobe => "discrete-lobe",
            Self::Numerics => "numerics",
            Self::Parameter => "parameter",
            Self::Table => "table",
        }
    }

    /// Its page of the manual, in Markdown that also reads well in a terminal.
    pub fn page(self) -> &'static str {
        macro_rules! page {
            ($slug:literal) => {
                include_str!(concat!("../docs/causes/", $slug, ".md"))
            };
        }
        match self {
            Self::ConstantFactor => page!("constant-factor"),
            Self::HalfVectorJacobian => page!("half-vector-jacobian"),
            Self::NdfMeasure => page!("ndf-measure"),
            Self::SwappedArguments => page!("swapped-arguments"),
            Self::WrongMeasure => page!("wrong-measure"),
            Self::NdfVndfMismatch => page!("ndf-vndf-mismatch"),
            Self::RefractionJacobian => page!("refraction-jacobian"),
            Self::EtaSide => page!("eta-side"),
            Self::LobeProbability => page!("lobe-probability"),
            Self::RandomNumberReuse => page!("random-number-reuse"),
            Self::WrongDensity => page!("wrong-density"),
            Self::UnnormalizedRejection => page!("unnormalized-rejection"),
            Self::Support => page!("support"),
            Self::Frame => page!("frame"),
            Self::Weight => page!("weight"),
            Self::ImplementationDrift => page!("implementation-drift"),
            Self::FresnelArgument => page!("fresnel-argument"),
            Self::Masking => page!("masking"),
            Self::Normalization => page!("normalization"),
            Self::EnergyCompensation => page!("energy-compensation"),
            Self::TransportMode => page!("transport-mode"),
            Self::DiscreteLobe => page!("discrete-lobe"),
            Self::Numerics => page!("numerics"),
            Self::Parameter => page!("parameter"),
            Self::Table => page!("table"),
        }
    }

    /// What is wrong, in one sentence: the first of its [page](Self::page).
    pub fn statement(self) -> &'static str {
        self.page().lines().nth(2).unwrap_or_default()
    }
}

impl std::fmt::Display for Cause {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.slug())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slugs_are_those_that_are_written() {
        for cause in Cause::ALL {
            assert_eq!(serde_json::to_string(&cause).unwrap(), format!("\"{}\"", cause.slug()));
        }
        let distinct: std::collections::BTreeSet<_> = Cause::ALL.iter().map(|c| c.slug()).collect();
        assert_eq!(distinct.len(), Cause::ALL.len());
    }

    #[test]
    fn each_page_is_that_of_its_cause_and_begins_with_one_sentence() {
        for cause in Cause::ALL {
            assert!(cause.page().starts_with(&format!("# {cause}: ")), "{cause}");
            let statement = cause.statement();
            assert!(statement.ends_with('.') && !statement.contains(". "), "{cause}: {statement}");
            let lines: Vec<_> = cause.page().lines().take(4).collect();
            assert!(lines[1].is_empty() && lines[3].is_empty(), "{cause}: a paragraph of one line");
        }
    }
}
