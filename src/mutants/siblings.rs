//! Models beside a correct one, and draws by another choice of its lobes.

use super::altered::R;
use crate::bsdf::{Bsdf, Direction, Lobe};
use crate::models::Phong;
use crate::models::coated_base::Lobes;
use crate::models::lambert::sample_cosine;
use crate::models::microfacet::{Distribution, RoughPlastic, Roughness, TorranceSparrow};

/// The model with this roughness in place of its own.
pub(super) fn with_alpha(m: &TorranceSparrow, alpha: Roughness) -> TorranceSparrow {
    let distribution = match m.distribution {
        Distribution::Ggx(_) => Distribution::ggx(alpha),
        Distribution::Beckmann(_) => Distribution::beckmann(alpha),
        Distribution::Gaussian(_) => Distribution::gaussian(alpha),
    };
    TorranceSparrow { distribution, ..m.clone() }
}

/// The model with its roughness times `factor`.
pub(super) fn with_alpha_times(m: &TorranceSparrow, factor: f64) -> TorranceSparrow {
    let Roughness { x, y } = m.distribution.alpha();
    with_alpha(m, Roughness { x: x * factor, y: y * factor })
}

/// Draws of another model.
pub(super) fn draws_of<M>(
    other: impl Bsdf + 'static,
) -> impl Fn(&M, Direction, &[f64]) -> Option<(Direction, Lobe)> {
    move |_, wo, u| {
        let s = other.sample(wo, u, R)?;
        Some((s.wi, s.lobe))
    }
}

/// Both lobes of Phong's model, each as a model of its own: the diffuse one and the
/// glossy one, of which `eval` is for a weight of 1.
pub(super) fn lobes_of(m: &Phong) -> [Phong; 2] {
    [(1.0, 0.0), (0.0, 1.0)].map(|(kd, ks)| Phong::new(kd, ks, m.exponent).expect("they add up to 1"))
}

/// Draws of a rough plastic by another choice than its own: given the
/// probabilities of the coat and the base and the first number, whether it is the
/// coat, and the number for the lobe.
pub(super) fn plastic_by(
    choice: impl Fn(Lobes, f64) -> (bool, f64),
) -> impl Fn(&RoughPlastic, Direction, &[f64]) -> Option<(Direction, Lobe)> {
    move |m, wo, u| {
        if wo.z <= 0.0 {
            return None;
        }
        let (coat, first) = choice(m.lobes(wo.z).0, u[0]);
        if !coat {
            return Some((sample_cosine(&[first, u[1]]), Lobe::DIFFUSE_REFLECTION));
        }
        let s = m.coat.sample(wo, &[first, u[1]], R)?;
        Some((s.wi, s.lobe))
    }
}
