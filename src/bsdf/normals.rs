//! What a microfacet distribution is to gonio, and how it becomes a subject.

use super::{Cosine, Description, Direction, Lobe, Samples, Subject, SubjectError, SubjectKind, Transport};

/// What an author of a microfacet distribution implements: a density D of facet
/// normals m, how much of the facets a direction sees, and how normals are
/// drawn. z is the normal of the surface; normals lie above, m.z > 0.
///
/// [`Normals`] makes it a [`Subject`].
pub trait NormalDistribution: Send + Sync {
    /// Name, dimensions of u, precision; of the claims only `isotropic` is looked
    /// at.
    fn describe(&self) -> Description;

    /// D(m) in sr⁻¹, which is facet area per area of surface and solid angle:
    /// ∫D cos θm dm = 1. 0 below the horizon.
    fn density(&self, m: Direction) -> f64;

    /// G1(w, m) in [0, 1]: of the facets of normal m, w·m > 0, the part that is
    /// seen from `w`, w.z > 0.
    fn g1(&self, w: Direction, m: Direction) -> f64;

    /// A normal with the density [`pdf`](Self::pdf).
    fn sample(&self, u: &[f64]) -> Direction;

    /// Density of [`sample`](Self::sample) in sr⁻¹: D cos θm.
    fn pdf(&self, m: Direction) -> f64 {
        self.density(m) * m.z.max(0.0)
    }

    /// Whether [`sample_visible`](Self::sample_visible) draws normals.
    fn draws_visible(&self) -> bool {
        false
    }

    /// A normal among those seen from `wo`, wo.z > 0, with the density
    /// [`visible_pdf`](Self::visible_pdf).
    fn sample_visible(&self, _wo: Direction, _u: &[f64]) -> Option<Direction> {
        None
    }

    /// Density of [`sample_visible`](Self::sample_visible) in sr⁻¹:
    /// G1(wo, m) max(0, wo·m) D(m)/cos θo (E. Heitz and E. d'Eon 2014).
    fn visible_pdf(&self, wo: Direction, m: Direction) -> f64 {
        visible_density(self, wo, m)
    }

    /// Smith's Λ(w), w.z > 0, where masking is Smith's (B. G. Smith 1967).
    fn lambda(&self, _w: Direction) -> Option<f64> {
        None
    }
}

/// G1 max(0, wo·m) D/cos θo, from the functions themselves.
fn visible_density<D: NormalDistribution + ?Sized>(d: &D, wo: Direction, m: Direction) -> f64 {
    let facing = wo.dot(m);
    if facing <= 0.0 {
        return 0.0;
    }
    let density = d.density(m);
    if density == 0.0 { 0.0 } else { d.g1(wo, m) * facing * density / wo.z }
}

/// A distribution of normals as a subject: in place of wi stand normals m, on
/// the front side. Of all normals `eval` is D, which integrates with its cosine
/// to 1; of those visible from wo it is their density G1 max(0, wo·m) D/cos θo,
/// cosine included, which integrates to 1 too. `pdf` and `sample` are those of
/// the author.
#[derive(Clone, Debug)]
pub struct Normals<D> {
    distribution: D,
    visible: bool,
}

impl<D: NormalDistribution> Normals<D> {
    /// All normals are drawn.
    pub fn all(distribution: D) -> Self {
        Self { distribution, visible: false }
    }

    /// Those visible from wo are drawn. `Err` with what to do where the
    /// distribution has no way to draw them.
    pub fn visible(distribution: D) -> Result<Self, String> {
        if !distribution.draws_visible() {
            let name = distribution.describe().name;
            return Err(format!(
                "visible normals of {name} cannot be drawn with this masking; choose sampling=normals"
            ));
        }
        Ok(Self { distribution, visible: true })
    }

    fn value(&self, wo: Direction, m: Direction) -> f64 {
        if wo.z <= 0.0 {
            0.0
        } else if self.visible {
            visible_density(&self.distribution, wo, m)
        } else {
            self.distribution.density(m)
        }
    }

    fn density(&self, wo: Direction, m: Direction) -> f64 {
        if wo.z <= 0.0 {
            0.0
        } else if self.visible {
            self.distribution.visible_pdf(wo, m)
        } else {
            self.distribution.pdf(m)
        }
    }
}

impl<D: NormalDistribution> Subject for Normals<D> {
    fn describe(&self) -> Description {
        let mut description = self.distribution.describe().channels(["value"]).claims(|c| {
            c.reciprocal = false;
            c.lossless = true;
            c.reflective = true;
            c.transmissive = false;
            c.two_sided = false;
            c.cosine = if self.visible { Cosine::Included } else { Cosine::Excluded };
        });
        description.kind = SubjectKind::Distribution;
        description
    }

    fn eval(
        &self,
        wo: Direction,
        m: &[Direction],
        _: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        for (m, value) in m.iter().zip(out) {
            *value = self.value(wo, *m);
        }
        Ok(())
    }

    fn pdf(&self, wo: Direction, m: &[Direction], _: Transport, out: &mut [f64]) -> Result<(), SubjectError> {
        for (m, density) in m.iter().zip(out) {
            *density = self.density(wo, *m);
        }
        Ok(())
    }

    fn sample(&self, wo: Direction, u: &[f64], _: Transport, out: &mut Samples) -> Result<(), SubjectError> {
        let dimensions = self.distribution.describe().dimensions.max(1);
        for u in u.chunks_exact(dimensions) {
            let m = match (wo.z > 0.0, self.visible) {
                (false, _) => None,
                (true, true) => self.distribution.sample_visible(wo, u),
                (true, false) => Some(self.distribution.sample(u)),
            };
            let Some(m) = m else {
                out.push(None);
                continue;
            };
            let pdf = self.density(wo, m);
            let cosine = if self.visible { 1.0 } else { m.abs_cos_theta() };
            out.wi.push(m);
            out.weight.push(if pdf > 0.0 { self.value(wo, m) * cosine / pdf } else { 0.0 });
            out.pdf.push(pdf);
            out.lobe.push(Lobe::GLOSSY_REFLECTION);
        }
        Ok(())
    }

    /// Normals of smooth surfaces gather around z.
    fn hints(&self, _: Direction) -> Vec<Direction> {
        vec![Direction::NORMAL]
    }

    fn distribution(&self) -> Option<&dyn NormalDistribution> {
        Some(&self.distribution)
    }
}
