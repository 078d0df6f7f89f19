//! Distributions of normals with their masking, as subjects of their own.

use super::{Distribution, Masking, Roughness, v_cavity};
use crate::bsdf::{Description, Direction, NormalDistribution};
use crate::registry::{Model, Parameters, Role};

/// A distribution of normals and how its facets hide each other: the parts D and
/// G1 of [`TorranceSparrow`](super::TorranceSparrow), by themselves.
#[derive(Clone, Debug)]
pub struct MaskedDistribution {
    /// D.
    pub distribution: Distribution,
    /// G1.
    pub masking: Masking,
}

/// The registered model `normals`.
pub(in crate::models) fn model() -> Model {
    Model::distribution(
        "normals",
        "distribution of facet normals with its masking",
        MaskedDistribution::declared,
    )
    .choice("distribution", &["ggx", "beckmann", "gaussian"], "distribution D of facet normals")
    .number("alpha", 0.2, 1e-4..=1.0, "roughness along the tangent (gaussian: an angle in radians)")
    .role(Role::Roughness)
    .number("alpha_y", 0.0, 0.0..=1.0, "roughness along the bitangent; 0: as alpha")
    .role(Role::Roughness)
    .choice("masking", &["smith", "v-cavity"], "masking G1 of facets by others")
}

impl MaskedDistribution {
    /// As the registered model reads its parameters.
    pub(crate) fn declared(p: &Parameters) -> Result<Self, String> {
        let alpha = Roughness::declared(p.number("alpha"), p.number("alpha_y"))?;
        Ok(MaskedDistribution {
            distribution: match p.text("distribution") {
                "beckmann" => Distribution::beckmann(alpha),
                "gaussian" => Distribution::gaussian(alpha),
                _ => Distribution::ggx(alpha),
            },
            masking: match p.text("masking") {
                "v-cavity" => Masking::VCavity,
                _ => Masking::Smith,
            },
        })
    }
}

impl NormalDistribution for MaskedDistribution {
    fn describe(&self) -> Description {
        // A wall of the groove takes a number of its own.
        let dimensions = if self.masking == Masking::VCavity { 3 } else { 2 };
        let name = match self.distribution {
            Distribution::Ggx(_) => "ggx",
            Distribution::Beckmann(_) => "beckmann",
            Distribution::Gaussian(_) => "gaussian",
        };
        Description::new(name)
            .dimensions(dimensions)
            .claims(|c| c.isotropic = self.distribution.alpha().is_isotropic())
    }

    #[inline]
    fn density(&self, m: Direction) -> f64 {
        self.distribution.density(m)
    }

    #[inline]
    fn g1(&self, w: Direction, m: Direction) -> f64 {
        match self.masking {
            Masking::Smith => self.distribution.g1(w),
            Masking::VCavity => w.z * v_cavity::masking_over_cosine(w, m, w.dot(m)),
        }
    }

    #[inline]
    fn sample(&self, u: &[f64]) -> Direction {
        self.distribution.sample(u)
    }

    fn draws_visible(&self) -> bool {
        self.masking == Masking::VCavity || !matches!(self.distribution, Distribution::Gaussian(_))
    }

    #[inline]
    fn sample_visible(&self, wo: Direction, u: &[f64]) -> Option<Direction> {
        match self.masking {
            Masking::Smith => self.distribution.sample_visible(wo, u),
            Masking::VCavity => Some(v_cavity::visible_wall(wo, self.distribution.sample(u), u[2])),
        }
    }

    fn lambda(&self, w: Direction) -> Option<f64> {
        (self.masking == Masking::Smith).then(|| self.distribution.lambda(w))
    }
}
