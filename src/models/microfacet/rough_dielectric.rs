//! The rough interface between two dielectrics.

use super::{Distribution, NormalSampling, Roughness, half_vector, smith};
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport, TransportModes};
use crate::models::fresnel;
use crate::registry::{Model, Parameters, Role};

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
    pub(crate) distribution: Distribution,
    pub(crate) eta: f64,
    pub(crate) sampling: NormalSampling,
}

/// Indices closer than this leave no digits of the facet that refracts: its
/// normal is known to ε/|η − 1|.
const CLOSEST: f64 = 1e-2;

/// The registered model `rough-dielectric`.
pub(in crate::models) fn model() -> Model {
    Model::new(
        "rough-dielectric",
        "rough dielectric interface (Walter et al. 2007)",
        RoughDielectric::declared,
    )
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
    /// As the registered model reads its parameters.
    pub(crate) fn declared(p: &Parameters) -> Result<Self, String> {
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
    }

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
    pub(crate) fn upright(&self, wo: Direction, w: Direction) -> Direction {
        if wo.z < 0.0 { w.flipped() } else { w }
    }

    #[inline]
    pub(crate) fn relative_eta(&self, wo: Direction) -> f64 {
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
        let o = self.distribution.backfacing_area(wo);
        let m = match self.sampling {
            NormalSampling::All => self.distribution.sample(u),
            NormalSampling::Visible => self.distribution.sample_visible_of(wo, || o, u)?,
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
        let seen = self.density_factor(wo, &facet, || o);
        let pdf = self.distribution.density(m) * facet.part * facet.spread * seen;
        let weight = self.geometry(wo, wi, o) * wi.z.abs() / seen * Self::per_mode(wi, eta, transport);
        // Within 1e-150 of the horizon f is beyond f64.
        let valid = pdf > 0.0 && pdf.is_finite() && weight.is_finite();
        valid.then_some(Sample { wi: self.upright(given, wi), weight: Spectrum::from(weight), pdf, lobe })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::microfacet::{Fresnel, Masking, TorranceSparrow};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    const LAST: f64 = 1.0 - f64::EPSILON / 2.0;
    const MODES: [Transport; 2] = [Transport::Radiance, Transport::Importance];

    /// Every combination that can be built, isotropic and not.
    fn all() -> Vec<RoughDielectric> {
        let mut all = Vec::new();
        for (x, y) in [(1e-4, 1e-4), (0.2, 0.2), (1.0, 1.0), (0.05, 0.6)] {
            let alpha = Roughness { x, y };
            for d in [Distribution::ggx(alpha), Distribution::beckmann(alpha), Distribution::gaussian(alpha)]
            {
                for eta in [1.01, 1.5, 4.0, 0.4] {
                    for sampling in [NormalSampling::Visible, NormalSampling::All] {
                        all.extend(RoughDielectric::new(d.clone(), eta, sampling));
                    }
                }
            }
        }
        assert_eq!(all.len(), 4 * 4 * 5);
        all
    }

    fn ggx(alpha: f64, eta: f64) -> RoughDielectric {
        let d = Distribution::ggx(Roughness::isotropic(alpha));
        RoughDielectric::new(d, eta, NormalSampling::Visible).unwrap()
    }

    fn random() -> impl FnMut() -> f64 {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
        move || (random.next_u64() >> 11) as f64 * f64::EPSILON / 2.0
    }

    #[test]
    fn sample_eval_and_pdf_agree_in_both_modes_from_both_sides() {
        let mut uniform = random();
        for model in all() {
            let rough = model.distribution.alpha();
            // Rounding of m, magnified by the slope of D and by how little two near
            // indices refract.
            let tolerance = 1e-9 + 2e-12 / rough.x.min(rough.y) / (model.eta - 1.0).abs().min(1.0);
            for theta in [0.0f64, 30.0, 75.0, 89.0, 91.0, 130.0, 180.0] {
                let wo = Direction::from_angles(theta.to_radians(), 0.7);
                for k in 0..100 {
                    let (u, mode) = ([uniform(), uniform(), uniform()], MODES[k % 2]);
                    let Some(s) = model.sample(wo, &u, mode) else { continue };
                    let (f, pdf) = (model.eval(wo, s.wi, mode)[0], model.pdf(wo, s.wi, mode));
                    assert!((s.pdf / pdf - 1.0).abs() < tolerance, "{model:?} {theta} {s:?} {pdf}");
                    assert!((s.wi.length() - 1.0).abs() < 1e-14);
                    assert_eq!(s.lobe.contains(Lobe::REFLECTION), wo.same_side(s.wi));
                    let weight = f * s.wi.z.abs() / pdf;
                    assert!(
                        (s.weight[0] / weight - 1.0).abs() < tolerance,
                        "{model:?} {theta} {s:?} {weight}"
                    );
                    // Importance is the adjoint of radiance, and radiance over η² is
                    // the same both ways.
                    let adjoint = model.eval(s.wi, wo, mode.other())[0];
                    assert!((adjoint / f - 1.0).abs() < tolerance, "{model:?} {theta} {s:?}");
                    let eta2 = |w: Direction| if w.z > 0.0 { 1.0 } else { model.eta * model.eta };
                    let [there, back] = [(wo, s.wi), (s.wi, wo)]
                        .map(|(o, i)| model.eval(o, i, Transport::Radiance)[0] / eta2(o));
                    assert!((back / there - 1.0).abs() < tolerance, "{model:?} {theta} {s:?}");
                }
            }
        }
    }

    #[test]
    fn edges_give_valid_output_or_none() {
        let grazing = Direction::new(1.0, 0.0, 1e-300);
        let horizon = Direction::new(1.0, 0.0, 0.0);
        let views = [Direction::NORMAL, Direction::from_angles(1.5705, 2.0), grazing];
        for model in all() {
            for wo in views.into_iter().flat_map(|w| [w, w.flipped()]) {
                for u in (0..8).map(|k| [0, 1, 2].map(|b| if k >> b & 1 == 0 { 0.0 } else { LAST })) {
                    let Some(s) = model.sample(wo, &u, Transport::Radiance) else { continue };
                    assert!((s.wi.length() - 1.0).abs() < 1e-14 && s.wi.z != 0.0, "{model:?} {wo:?} {u:?}");
                    assert!(s.pdf > 0.0 && s.pdf.is_finite() && s.weight[0].is_finite());
                    assert!(model.sample(horizon, &u, Transport::Radiance).is_none());
                }
                for wi in [horizon, wo, -wo, wo.mirrored(), wo.flipped(), grazing, -grazing] {
                    for mode in MODES {
                        let (f, p) = (model.eval(wo, wi, mode)[0], model.pdf(wo, wi, mode));
                        assert!(f >= 0.0 && p >= 0.0, "{model:?} {wo:?} {wi:?}: {f} {p}");
                        assert!(wi.z != 0.0 || (f == 0.0 && p == 0.0));
                    }
                }
            }
        }
    }

    /// Reflection is Torrance and Sparrow's, and transmission Walter's eq. 21 as it
    /// is printed, for light that goes from i to o, with the masking of this model.
    #[test]
    fn equals_the_published_forms() {
        let (eta, alpha) = (1.5, Roughness::isotropic(0.4));
        let d = Distribution::ggx(alpha);
        let model = ggx(0.4, eta);
        let fresnel = Fresnel::Dielectric(eta);
        let mirror =
            TorranceSparrow::new(d.clone(), Masking::Smith, fresnel, NormalSampling::Visible).unwrap();
        let mode = Transport::Radiance;
        for (to, ti, phi) in [(0.3, 0.5, 2.0), (1.3, 1.1, 3.0), (0.0, 0.4, 1.0)] {
            let (wo, wi) = (Direction::from_angles(to, 0.2), Direction::from_angles(ti, 0.2 + phi));
            let reference = mirror.eval(wo, wi, mode)[0];
            assert!((model.eval(wo, wi, mode)[0] / reference - 1.0).abs() < 1e-13);
            for (o, i) in [(wo, -wi.rotated(3.0)), (-wo, wi.rotated(2.9))] {
                let index = |w: Direction| if w.z > 0.0 { 1.0 } else { eta };
                let (no, ni) = (index(o), index(i));
                let mut m = -(i * ni + o * no).normalized();
                let (om, im) = (o.dot(m), i.dot(m));
                if m.z < 0.0 {
                    m = -m;
                }
                let value = model.eval(o, i, mode)[0];
                if om * im >= 0.0 || o.dot(m) * o.z <= 0.0 {
                    assert_eq!(value, 0.0);
                    continue;
                }
                let up = |w: Direction| if w.z > 0.0 { w } else { w.flipped() };
                let [a, b] = [o, i].map(|w| d.lambda(up(w)));
                let g = (libm::lgamma(1.0 + a) + libm::lgamma(1.0 + b) - libm::lgamma(2.0 + a + b)).exp();
                let part = 1.0 - crate::models::fresnel::dielectric(im.abs(), no / ni);
                let printed = (im * om / (i.z * o.z)).abs() * no * no * part * g * d.density(m)
                    / (ni * im + no * om).powi(2);
                assert!((value / printed - 1.0).abs() < 1e-12, "{o:?} {i:?}: {value} {printed}");
            }
        }
    }

    /// Flux that is reflected and transmitted, by drawn weights.
    fn flux(model: &RoughDielectric, wo: Direction) -> [f64; 2] {
        let claims = model.describe().claims;
        let mut uniform = random();
        let n = 40_000;
        let mut flux = [0.0; 2];
        for _ in 0..n {
            let u = [uniform(), uniform(), uniform()];
            let Some(s) = model.sample(wo, &u, Transport::Radiance) else { continue };
            let factor = claims.flux_factor(wo.z > 0.0, s.wi.z > 0.0, Transport::Radiance);
            flux[usize::from(!wo.same_side(s.wi))] += s.weight[0] * factor / f64::from(n);
        }
        flux
    }

    #[test]
    fn loses_what_it_scatters_twice_and_nothing_when_smooth() {
        for theta in [0.0f64, 40.0, 80.0, 100.0, 150.0] {
            let wo = Direction::from_angles(theta.to_radians(), 0.7);
            for eta in [1.1, 1.5, 2.4] {
                let relative = if wo.z > 0.0 { eta } else { 1.0 / eta };
                let smooth = crate::models::fresnel::dielectric(wo.z.abs(), relative);
                let [r, t] = flux(&ggx(1e-4, eta), wo);
                // Half a per cent of chance, and the facets around a critical angle.
                assert!((r - smooth).abs() < 0.01 && (r + t - 1.0).abs() < 1e-3, "{theta} {eta}: {r} {t}");
                let mut last = 1.0;
                for alpha in [0.1, 0.4, 1.0] {
                    let sum: f64 = flux(&ggx(alpha, eta), wo).iter().sum();
                    assert!(sum < last && sum > 0.1, "{theta} {eta} {alpha}: {sum}");
                    last = sum;
                }
            }
        }
    }

    #[test]
    fn unbuildable_parameters_name_the_way_out() {
        let d = Distribution::gaussian(Roughness::isotropic(0.1));
        let build = |eta| RoughDielectric::new(d.clone(), eta, NormalSampling::Visible).unwrap_err();
        assert!(build(1.0).contains("eta = 1 must") && build(f64::NAN).contains("NaN"));
        assert!(build(1.5).contains("sampling=normals"));
    }
}
