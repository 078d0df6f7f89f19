//! The reference in Rust: Lambert, GGX facets, and both side by side.

use crate::course::*;

fn above(wo: Vec3, wi: Vec3) -> bool {
    wo.z > 0.0 && wi.z > 0.0
}

fn sample_cosine(u1: f64, u2: f64) -> Vec3 {
    let (r, phi) = (u1.sqrt(), 2.0 * PI * u2);
    vec3(r * phi.cos(), r * phi.sin(), (1.0 - u1).sqrt())
}

fn cosine_pdf(wi: Vec3) -> f64 {
    wi.z / PI
}

fn ggx(alpha: f64, h: Vec3) -> f64 {
    let a2 = alpha * alpha;
    let s = h.z * h.z * (a2 - 1.0) + 1.0;
    a2 / (PI * s * s)
}

fn lambda(alpha: f64, w: Vec3) -> f64 {
    let tan2 = (1.0 - w.z * w.z) / (w.z * w.z);
    ((1.0 + alpha * alpha * tan2).sqrt() - 1.0) / 2.0
}

fn masking(alpha: f64, wo: Vec3, wi: Vec3) -> f64 {
    1.0 / (1.0 + lambda(alpha, wo) + lambda(alpha, wi))
}

fn sample_normal(alpha: f64, u1: f64, u2: f64) -> Vec3 {
    let cos2 = (1.0 - u1) / (1.0 + (alpha * alpha - 1.0) * u1);
    let (r, phi) = ((1.0 - cos2).sqrt(), 2.0 * PI * u2);
    vec3(r * phi.cos(), r * phi.sin(), cos2.sqrt())
}

fn normal_pdf(alpha: f64, h: Vec3) -> f64 {
    ggx(alpha, h) * h.z
}

fn half_vector(wo: Vec3, wi: Vec3) -> Vec3 {
    (wo + wi).normalized()
}

fn reflect(wo: Vec3, h: Vec3) -> Vec3 {
    2.0 * wo.dot(h) * h - wo
}

fn schlick(f0: f64, cos: f64) -> f64 {
    f0 + (1.0 - f0) * (1.0 - cos).powi(5)
}

fn fresnel(eta: f64, cos_i: f64) -> f64 {
    let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (eta * eta)).sqrt();
    let rs = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let rp = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    (rs * rs + rp * rp) / 2.0
}

/// Without the Fresnel term.
fn facets(alpha: f64, wo: Vec3, wi: Vec3) -> f64 {
    let h = half_vector(wo, wi);
    ggx(alpha, h) * masking(alpha, wo, wi) / (4.0 * wo.z * wi.z)
}

fn facets_pdf(alpha: f64, wo: Vec3, wi: Vec3) -> f64 {
    let h = half_vector(wo, wi);
    normal_pdf(alpha, h) / (4.0 * wo.dot(h))
}

/// What is above the horizon, with weight and pdf.
fn drawn(brdf: &impl Brdf, wo: Vec3, wi: Vec3, lobe: Lobe) -> Option<Sample> {
    if !above(wo, wi) {
        return None;
    }
    let pdf = brdf.pdf(wo, wi);
    Some(Sample { wi, weight: brdf.eval(wo, wi) * wi.z / pdf, pdf, lobe })
}

impl Brdf for Diffuse {
    fn eval(&self, wo: Vec3, wi: Vec3) -> f64 {
        if above(wo, wi) { self.reflectance / PI } else { 0.0 }
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f64 {
        if above(wo, wi) { cosine_pdf(wi) } else { 0.0 }
    }

    fn sample(&self, wo: Vec3, u1: f64, u2: f64) -> Option<Sample> {
        drawn(self, wo, sample_cosine(u1, u2), Lobe::Diffuse)
    }
}

impl Brdf for Metal {
    fn eval(&self, wo: Vec3, wi: Vec3) -> f64 {
        if !above(wo, wi) {
            return 0.0;
        }
        schlick(self.f0, wo.dot(half_vector(wo, wi))) * facets(self.alpha, wo, wi)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f64 {
        if above(wo, wi) { facets_pdf(self.alpha, wo, wi) } else { 0.0 }
    }

    fn sample(&self, wo: Vec3, u1: f64, u2: f64) -> Option<Sample> {
        let h = sample_normal(self.alpha, u1, u2);
        drawn(self, wo, reflect(wo, h), Lobe::Glossy)
    }
}

impl Brdf for Plastic {
    fn eval(&self, wo: Vec3, wi: Vec3) -> f64 {
        if !above(wo, wi) {
            return 0.0;
        }
        let base = self.reflectance / PI;
        let coat = fresnel(self.eta, wo.dot(half_vector(wo, wi))) * facets(self.alpha, wo, wi);
        (1.0 - self.ks) * base + self.ks * coat
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f64 {
        if !above(wo, wi) {
            return 0.0;
        }
        (1.0 - self.ks) * cosine_pdf(wi) + self.ks * facets_pdf(self.alpha, wo, wi)
    }

    fn sample(&self, wo: Vec3, u1: f64, u2: f64) -> Option<Sample> {
        if u1 < self.ks {
            let h = sample_normal(self.alpha, u1 / self.ks, u2);
            drawn(self, wo, reflect(wo, h), Lobe::Glossy)
        } else {
            let wi = sample_cosine((u1 - self.ks) / (1.0 - self.ks), u2);
            drawn(self, wo, wi, Lobe::Diffuse)
        }
    }
}
