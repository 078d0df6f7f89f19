//! The rough interface between two dielectrics.

use super::{Distribution, NormalSampling, Roughness, half_vector, smith};
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport, TransportModes};
use crate::models::fresnel;
use crate::registry::{Model, Role};

/// Facets that reflect and refract, seen from both sides (B. Walter, S. R.
/// Marschner, H. Li and K. E. Torrance, *Microfacet models for refraction through
/// rough surfaces*, EGSR 2007, eqs. 20 and 21), with Smith's masking correlated by
/// height: 1/(1 + Λo + Λi) within one side (Heitz 2014, eq. 99),
/// B(1 + Λo, 1 + Λi) through the surface. A facet is drawn, then reflection with
/// the probability F of its own Fresnel reflectance, by a third random number.
///
/// Light is scattered once: what meets a second facet is lost, so R + T goes to 1
/// as α → 0 and is less above. In radiance mode transmission carries (η_o/η_i)².
#[derive(Clone, Debug)]
pub struct RoughDielectric {
    distribution: Distribution,
    eta: f64,
    sampling: NormalSampling,
}

/// Indices closer than this leave no digits of the facet that refracts: its
/// normal is known to ε/|η − 1|.
const CLOSEST: f64 = 1e-2;

/// The registered model `rough-dielectric`.
pub(in crate::models) fn model() -> Model {
    Model::new("rough-dielectric", "rough dielectric interface (Walter et al. 2007)", |p| {
        let alpha = Roughness::declared(p.number("alpha"), p.number("alpha_y"))?;
        RoughDielectric::new(
            match p.text("distribution") {
                "beckmann" => Distribution::beckmann(alpha),
                _ => Distribution::ggx(alpha),
            },
            p.number("eta"),
            match p.text("sampling") {
                "normals" => NormalSampling::All,
                _ => NormalSampling::Visible,
            },
        )
    })
    .number("alpha", 0.2, 1e-4..=1.0, "roughness along the tangent")
    .role(Role::Roughness)
    .number("alpha_y", 0.0, 0.0..=1.0, "roughness along the bitangent; 0: as alpha")
    .role(Role::Roughness)
    .choice("distribution", &["ggx", "beckmann"], "distribution D of facet normals")
    .number("eta", 1.5, 0.25..=4.0, "index of refraction of the back side over the front side")
    .role(Role::Eta)
    .choice("sampling", &["visible-normals", "normals"], "which normals are drawn")
}

/// A facet that joins two directions, seen from wo's side.
struct Facet {
    m: Direction,
    /// wo·m.
    cos_o: f64,
    /// The part F or 1 − F of the light that it sends this way.
    part: f64,
    /// wo·m |dωm/dωi|.
    spread: f64,
}

impl Facet {
    /// Reflects; |dωm/dωi| = 1/(4 wo·m) (Walter et al. 2007, eq. 14).
    #[inline]
    fn reflecting(m: Direction, cos_o: f64, eta: f64) -> Self {
        Self { m, cos_o, part: fresnel::dielectric(cos_o.min(1.0), eta), spread: 0.25 }
    }

    /// Refracts; |dωm/dωi| = η² |wi·m|/|wo + η wi|² (Walter et al. 2007, eq. 17).
    #[inline]
    fn refracting(m: Direction, cos_o: f64, cos_i: f64, length: f64, eta: f64) -> Self {
        let stretch = eta / length;
        Self {
            m,
            cos_o,
            part: fresnel::transmitted(cos_o, cos_i, eta),
            spread: cos_o * cos_i * stretch * stretch,
        }
    }

    /// The one that sends `wi` to `wo`, where wo.z > 0.
    #[inline]
    fn between(wo: Direction, wi: Direction, eta: f64) -> Option<Self> {
        if wi.z > 0.0 {
            let (m, cos) = half_vector::of_reflection(wo, wi)?;
            return Some(Self::reflecting(m, cos, eta));
        }
        let r = half_vector::of_refraction(wo, wi, eta)?;
        Some(Self::refracting(r.m, r.cos_o, r.cos_i, r.length, eta))
    }
}

impl RoughDielectric {
    /// With `eta` > 0, the index of the back side over the front side. `Err` with
    /// the reason where the indices are too close, and for the Gaussian, whose
    /// visible normals nobody knows how to draw.
    pub fn new(distribution: Distribution, eta: f64, sampling: NormalSampling) -> Result<Self, String> {
        if !(eta > 0.0 && eta.is_finite() && (eta - 1.0).abs() >= CLOSEST) {
            return Err(format!(
                "eta = {eta} must be positive and differ from 1 by {CLOSEST} at least: equal indices refract nothing"
            ));
        }
        if let (Distribution::Gaussian(_), NormalSampling::Visible) = (&distribution, sampling) {
            return Err("visible gaussian normals cannot be drawn; choose sampling=normals".into());
        }
        Ok(Self { distribution, eta, sampling })
    }

    /// A direction as seen from wo's side, where the normal is up, and the index
    /// of the far over the near side. The facets look the same from below, since
    /// D(−x, −y) = D(x, y).
    #[inline]
    fn upright(&self, wo: Direction, w: Direction) -> Direction {
        if wo.z < 0.0 { w.flipped() } else { w }
    }

    #[inline]
    fn relative_eta(&self, wo: Direction) -> f64 {
        if wo.z < 0.0 { 1.0 / self.eta } else { self.eta }
    }

    /// G2/(cos θo |cos θi|), finite up to the horizon; `o` the masked area of wo.
    #[inline]
    fn geometry(&self, wo: Direction, wi: Direction, o: f64) -> f64 {
        if wi.z > 0.0 {
            let i = self.distribution.backfacing_area(wi);
            return 1.0 / (wo.z * wi.z + o * wi.z + i * wo.z);
        }
        let z = -wi.z;
        let i = self.distribution.backfacing_area(wi.flipped());
        smith::opposite_sides(o / wo.z, i / z) / ((wo.z + o) * (z + i))
    }

    /// Density of m over D wo·m; `o` gives the masked area of wo.
    #[inline]
    fn density_factor(&self, wo: Direction, facet: &Facet, o: impl FnOnce() -> f64) -> f64 {
        match self.sampling {
            NormalSampling::All => facet.m.z / facet.cos_o,
            NormalSampling::Visible => 1.0 / (wo.z + o()),
        }
    }

    /// By what f in this mode is less than in importance mode.
    #[inline]
    fn per_mode(wi: Direction, eta: f64, transport: Transport) -> f64 {
        match transport {
            Transport::Radiance if wi.z < 0.0 => 1.0 / (eta * eta),
            _ => 1.0,
        }
    }
}

impl Bsdf for RoughDielectric {
    fn describe(&self) -> Description {
        Description::new("rough-dielectric").claims(|c| {
            c.transmissive = true;
            c.isotropic = self.distribution.alpha().is_isotropic();
            c.eta = Some(self.eta);
            c.transport = TransportModes::Both;
        })
    }

    #[inline]
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> Spectrum {
        let eta = self.relative_eta(wo);
        let (wo, wi) = (self.upright(wo, wo), self.upright(wo, wi));
        let Some(facet) = Facet::between(wo, wi, eta) else { return Spectrum::zero(1) };
        let d = self.distribution.density(facet.m);
        if d == 0.0 || facet.part == 0.0 {
            return Spectrum::zero(1);
        }
        let geometry = self.geometry(wo, wi, self.distribution.backfacing_area(wo));
        Spectrum::from(d * facet.part * facet.spread * geometry * Self::per_mode(wi, eta, transport))
    }

    #[inline]
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        let eta = self.relative_eta(wo);
        let (wo, wi) = (self.upright(wo, wo), self.upright(wo, wi));
        let Some(facet) = Facet::between(wo, wi, eta) else { return 0.0 };
        let d = self.distribution.density(facet.m);
        if d == 0.0 {
            return 0.0;
        }
        let seen = self.density_factor(wo, &facet, || self.distribution.backfacing_area(wo));
        d * facet.part * facet.spread * seen
    }

    #[inline]
    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z == 0.0 {
            return None;
        }
        let eta = self.relative_eta(wo);
        let given = wo;
        let wo = self.upright(given, given);
        let m = match self.sampling {
            NormalSampling::All => self.distribution.sample(u),
            NormalSampling::Visible => self.distribution.sample_visible(wo, u)?,
        };
        let cos_o = wo.dot(m);
        if cos_o <= 0.0 {
            return None;
        }
        let reflecting = Facet::reflecting(m, cos_o, eta);
        let (wi, facet, lobe) = if u[2] < reflecting.part {
            let wi = wo.reflected(m);
            if wi.z <= 0.0 {
                return None;
            }
            (wi, reflecting, Lobe::GLOSSY_REFLECTION)
        } else {
            let cos_i = fresnel::refracted_cosine(cos_o, eta)?;
            let wi = m * (cos_o / eta - cos_i) - wo * (1.0 / eta);
            if wi.z >= 0.0 {
                return None;
            }
            // |wo + η wi| = |wo·m − η cos θ|, the difference multiplied out.
            let length = ((eta - 1.0) * (eta + 1.0)).abs() / (cos_o + eta * cos_i);
            (wi, Facet::refracting(m, cos_o, cos_i, length, eta), Lobe::GLOSSY_TRANSMISSION)
        };
        // D, the part and the spread are factors of both f and pdf.
        let o = self.distribution.backfacing_area(wo);
        let seen = self.density_factor(wo, &facet, || o);
        let pdf = self.distribution.density(m) * facet.part * facet.spread * seen;
        let weight = self.geometry(wo, wi, o) * wi.z.abs() / seen * Self::per_mode(wi, eta, transport);
        // Within 1e-150 of the horizon f is beyond f64.
        let valid = pdf > 0.0 && pdf.is_finite() && weight.is_finite();
        valid.then_some(Sample { wi: self.upright(given, wi), weight: Spectrum::from(weight), pdf, lobe })
    }
}
