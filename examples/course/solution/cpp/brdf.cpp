// The reference: Lambert, GGX facets, and both side by side.
#include "course.h"

static bool above(Vec3 wo, Vec3 wi) { return wo.z > 0 && wi.z > 0; }

static Vec3 sample_cosine(double u1, double u2) {
    const double r = sqrt(u1), phi = 2 * pi * u2;
    return {r * cos(phi), r * sin(phi), sqrt(1 - u1)};
}

static double cosine_pdf(Vec3 wi) { return wi.z / pi; }

// Facets: D of GGX, Lambda of Smith, and their normals.
static double ggx(double alpha, Vec3 h) {
    const double a2 = alpha * alpha;
    const double s = h.z * h.z * (a2 - 1) + 1;
    return a2 / (pi * s * s);
}

static double lambda(double alpha, Vec3 w) {
    const double tan2 = (1 - w.z * w.z) / (w.z * w.z);
    return (sqrt(1 + alpha * alpha * tan2) - 1) / 2;
}

static double masking(double alpha, Vec3 wo, Vec3 wi) {
    return 1 / (1 + lambda(alpha, wo) + lambda(alpha, wi));
}

static Vec3 sample_normal(double alpha, double u1, double u2) {
    const double cos2 = (1 - u1) / (1 + (alpha * alpha - 1) * u1);
    const double r = sqrt(1 - cos2), phi = 2 * pi * u2;
    return {r * cos(phi), r * sin(phi), sqrt(cos2)};
}

static double normal_pdf(double alpha, Vec3 h) { return ggx(alpha, h) * h.z; }

static Vec3 half_vector(Vec3 wo, Vec3 wi) { return normalize(wo + wi); }

static Vec3 reflect(Vec3 wo, Vec3 h) { return 2 * dot(wo, h) * h - wo; }

static double schlick(double f0, double cos) { return f0 + (1 - f0) * pow(1 - cos, 5); }

static double fresnel(double eta, double cos_i) {
    const double cos_t = sqrt(1 - (1 - cos_i * cos_i) / (eta * eta));
    const double rs = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    const double rp = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    return (rs * rs + rp * rp) / 2;
}

// Without the Fresnel term.
static double facets(double alpha, Vec3 wo, Vec3 wi) {
    const Vec3 h = half_vector(wo, wi);
    return ggx(alpha, h) * masking(alpha, wo, wi) / (4 * wo.z * wi.z);
}

static double facets_pdf(double alpha, Vec3 wo, Vec3 wi) {
    const Vec3 h = half_vector(wo, wi);
    return normal_pdf(alpha, h) / (4 * dot(wo, h));
}

double Diffuse::eval(Vec3 wo, Vec3 wi) const { return above(wo, wi) ? reflectance / pi : 0; }

double Diffuse::pdf(Vec3 wo, Vec3 wi) const { return above(wo, wi) ? cosine_pdf(wi) : 0; }

Sample Diffuse::sample(Vec3 wo, double u1, double u2) const {
    if (wo.z <= 0) return Sample();
    const Vec3 wi = sample_cosine(u1, u2);
    return {wi, eval(wo, wi) * wi.z / pdf(wo, wi), pdf(wo, wi), DIFFUSE};
}

double Metal::eval(Vec3 wo, Vec3 wi) const {
    if (!above(wo, wi)) return 0;
    return schlick(f0, dot(wo, half_vector(wo, wi))) * facets(alpha, wo, wi);
}

double Metal::pdf(Vec3 wo, Vec3 wi) const { return above(wo, wi) ? facets_pdf(alpha, wo, wi) : 0; }

Sample Metal::sample(Vec3 wo, double u1, double u2) const {
    const Vec3 h = sample_normal(alpha, u1, u2);
    const Vec3 wi = reflect(wo, h);
    if (!above(wo, wi)) return Sample();
    return {wi, eval(wo, wi) * wi.z / pdf(wo, wi), pdf(wo, wi), GLOSSY};
}

double Plastic::eval(Vec3 wo, Vec3 wi) const {
    if (!above(wo, wi)) return 0;
    const double base = reflectance / pi;
    const double coat = fresnel(eta, dot(wo, half_vector(wo, wi))) * facets(alpha, wo, wi);
    return (1 - ks) * base + ks * coat;
}

double Plastic::pdf(Vec3 wo, Vec3 wi) const {
    if (!above(wo, wi)) return 0;
    return (1 - ks) * cosine_pdf(wi) + ks * facets_pdf(alpha, wo, wi);
}

Sample Plastic::sample(Vec3 wo, double u1, double u2) const {
    Vec3 wi;
    Lobe lobe;
    if (u1 < ks) {
        wi = reflect(wo, sample_normal(alpha, u1 / ks, u2));
        lobe = GLOSSY;
    } else {
        wi = sample_cosine((u1 - ks) / (1 - ks), u2);
        lobe = DIFFUSE;
    }
    if (!above(wo, wi)) return Sample();
    return {wi, eval(wo, wi) * wi.z / pdf(wo, wi), pdf(wo, wi), lobe};
}
