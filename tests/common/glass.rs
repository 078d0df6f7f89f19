//! Rough glass written for the tests, with one bug at a time.

use super::{Bug, Ggx};
use gonio::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport, TransportModes};

/// What is wrong with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GlassBug {
    None,
    /// pdf() of transmission has a factor η² too many.
    SpuriousEta,
    /// pdf() of transmission has |wo·h| for |wi·h|.
    SwappedCosine,
    /// pdf() of transmission has the Jacobian of reflection.
    ReflectionJacobian,
    /// sample() refracts by η from both sides.
    EtaNotInverted,
    /// pdf() of transmission does not ask on which sides of the facet wo and wi are.
    NoSideTest,
    /// pdf() lacks the probability of the lobe.
    NotFolded,
    /// Radiance is transmitted as importance, while both modes are claimed.
    OneScale,
    /// The same, and radiance alone is claimed.
    OneScaleAsConvention,
    /// Fresnel at n·wo in place of h·wo, in all functions.
    FresnelAtNormal,
    /// sample() flags what is transmitted as reflection.
    FlaggedReflection,
}

/// Isotropic GGX, visible normals, separable masking through the surface; the
/// index of the back over the front is `eta`.
pub struct Glass {
    facets: Ggx,
    pub eta: f64,
    pub bug: GlassBug,
}

/// Unpolarised reflectance as in textbooks.
fn fresnel(cos_i: f64, eta: f64) -> f64 {
    let sin2 = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin2 >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2).sqrt();
    let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    0.5 * (s * s + p * p)
}

/// 1 − [`fresnel`], from the cosines on both sides.
fn transmitted(cos_i: f64, cos_t: f64, eta: f64) -> f64 {
    let amplitude = |a: f64| 4.0 * eta * cos_i * cos_t / (a * a);
    0.5 * (amplitude(cos_i + eta * cos_t) + amplitude(eta * cos_i + cos_t))
}

impl Glass {
    pub fn new(alpha: f64, eta: f64, bug: GlassBug) -> Self {
        Self { facets: Ggx::new(alpha, Bug::None), eta, bug }
    }

    fn g1(&self, w: Direction) -> f64 {
        1.0 / (1.0 + self.facets.lambda(w, self.facets.alpha))
    }

    fn reflectance(&self, wo: Direction, h: Direction, eta: f64) -> f64 {
        let cos = if self.bug == GlassBug::FresnelAtNormal { wo.z } else { wo.dot(h).abs() };
        fresnel(cos, eta)
    }

    /// f (as importance) and the right pdf, seen from above, η being that of the
    /// other side over this one.
    fn both(&self, wo: Direction, wi: Direction, eta: f64, bug: GlassBug) -> (f64, f64) {
        if wo.z <= 0.0 || wi.z == 0.0 {
            return (0.0, 0.0);
        }
        let reflects = wi.z > 0.0;
        let h = if reflects { wo + wi } else { wo + wi * eta };
        let length = h.length();
        if !(length > 0.0) {
            return (0.0, 0.0);
        }
        let h = h * (1f64.copysign(h.z) / length);
        let (om, im) = (wo.dot(h), wi.dot(h));
        let d = self.facets.d(h, self.facets.alpha);
        let f = self.reflectance(wo, h, eta);
        let visible = self.g1(wo) * om.abs() * d / wo.z;
        if reflects {
            let g = 1.0
                / (1.0
                    + self.facets.lambda(wo, self.facets.alpha)
                    + self.facets.lambda(wi, self.facets.alpha));
            let part = if bug == GlassBug::NotFolded { 1.0 } else { f };
            return (f * d * g / (4.0 * wo.z * wi.z), part * visible / (4.0 * om));
        }
        if bug != GlassBug::NoSideTest && (om <= 0.0 || im >= 0.0) {
            return (0.0, 0.0);
        }
        let spread = eta * eta / (om + eta * im).powi(2);
        // 1 − F without its cancellation near the critical angle, where that is
        // what is meant.
        let textbook = self.bug == GlassBug::FresnelAtNormal || bug == GlassBug::NoSideTest;
        let through = if textbook { 1.0 - f } else { transmitted(om, -im, eta) };
        let value = through * d * self.g1(wo) * self.g1(wi) * spread * (om * im / (wo.z * wi.z)).abs();
        let jacobian = match bug {
            GlassBug::SpuriousEta => eta * eta * spread * im.abs(),
            GlassBug::SwappedCosine => spread * om.abs(),
            GlassBug::ReflectionJacobian => 0.25 / om.abs(),
            _ => spread * im.abs(),
        };
        let part = if bug == GlassBug::NotFolded { 1.0 } else { through };
        (value, part * visible * jacobian)
    }

    fn seen(&self, wo: Direction, wi: Direction, bug: GlassBug) -> (f64, f64) {
        if wo.z < 0.0 {
            self.both(wo.flipped(), wi.flipped(), 1.0 / self.eta, bug)
        } else {
            self.both(wo, wi, self.eta, bug)
        }
    }
}

impl Bsdf for Glass {
    fn describe(&self) -> Description {
        Description::new("ad-hoc-glass").claims(|c| {
            c.isotropic = true;
            c.transmissive = true;
            c.eta = Some(self.eta);
            if self.bug != GlassBug::OneScaleAsConvention {
                c.transport = TransportModes::Both;
            }
        })
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> Spectrum {
        let eta = if wo.z > 0.0 { self.eta } else { 1.0 / self.eta };
        let scaled = !matches!(self.bug, GlassBug::OneScale | GlassBug::OneScaleAsConvention);
        let divide = transport == Transport::Radiance && !wo.same_side(wi) && scaled;
        let f = self.seen(wo, wi, GlassBug::None).0;
        Spectrum::from(if divide { f / (eta * eta) } else { f })
    }

    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        self.seen(wo, wi, self.bug).1
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z == 0.0 {
            return None;
        }
        let up = |w: Direction| if wo.z < 0.0 { w.flipped() } else { w };
        let eta = if wo.z < 0.0 { 1.0 / self.eta } else { self.eta };
        let o = up(wo);
        let h = self.facets.visible_normal(o, u);
        let (wi, lobe) = if u[2] < self.reflectance(o, h, eta) {
            (o.reflected(h), Lobe::GLOSSY_REFLECTION)
        } else {
            let eta = if self.bug == GlassBug::EtaNotInverted { self.eta } else { eta };
            let c = o.dot(h);
            let cos2 = 1.0 - (1.0 - c * c) / (eta * eta);
            if cos2 <= 0.0 {
                return None;
            }
            let cos_t = cos2.sqrt();
            ((h * (c / eta - cos_t) - o * (1.0 / eta)).normalized(), Lobe::GLOSSY_TRANSMISSION)
        };
        if (wi.z > 0.0) != (lobe == Lobe::GLOSSY_REFLECTION) {
            return None;
        }
        let lobe = if self.bug == GlassBug::FlaggedReflection { Lobe::GLOSSY_REFLECTION } else { lobe };
        let wi = up(wi);
        let pdf = Bsdf::pdf(self, wo, wi, transport);
        let weight = Bsdf::eval(self, wo, wi, transport) * (wi.z.abs() / pdf);
        (pdf > 0.0 && wi.is_finite()).then_some(Sample { wi, weight, pdf, lobe })
    }
}
