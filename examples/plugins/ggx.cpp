// A rough mirror in C++: ggx.c once more, from a class. Torrance and Sparrow's
// reflection with the GGX distribution of normals, Smith's masking (correlated by
// height) and normals drawn as wo sees them.

#include "gonio.hpp"

using gonio::Direction;
using gonio::Sample;
using gonio::Spectrum;
using gonio::Transport;

class Ggx : public gonio::Bsdf {
public:
    /// What gonio is told: it measures the claims, and checks parameters before
    /// they come here.
    static gonio::Model model() {
        gonio::Model m("ggx", "rough mirror: GGX, Smith masking, visible normals");
        m.dimensions = 2;
        m.claims.isotropic = true;
        m.number("alpha", 0.2, 1e-4, 1.0, "roughness, a slope", gonio::Role::roughness);
        return m;
    }

    explicit Ggx(const gonio::Parameters &parameters) : alpha(parameters.number("alpha")) {}

    Spectrum eval(Direction wo, Direction wi, Transport) const override {
        Direction m;
        return half_vector(wo, wi, m) ? density(m) * geometry(wo, wi) : 0.0;
    }

    double pdf(Direction wo, Direction wi, Transport) const override {
        Direction m;
        return half_vector(wo, wi, m) ? density(m) * density_factor(wo) : 0.0;
    }

    Sample sample(Direction wo, const double *u, Transport) const override {
        const Direction m = visible_normal(wo, u);
        const Direction wi = wo.reflected(m);
        if (!(wo.z > 0.0 && wo.dot(m) > 0.0 && wi.z > 0.0)) return Sample(); // below the horizon
        const double p = density(m) * density_factor(wo);
        const double weight = geometry(wo, wi) * wi.z / density_factor(wo); // D is in both
        if (!(p > 0.0 && std::isfinite(p) && std::isfinite(weight))) return Sample();
        return Sample(wi, weight, p, GONIO_REFLECTION | GONIO_GLOSSY);
    }

private:
    /// D(m) per steradian; the integral of D cos(theta) is 1 (Walter et al. 2007).
    double density(Direction m) const {
        const double x = m.x / alpha, y = m.y / alpha;
        const double s = x * x + y * y + m.z * m.z;
        return m.z > 0.0 ? 1.0 / (gonio::pi * alpha * alpha * s * s) : 0.0;
    }

    /// Smith's Lambda(w) times cos(theta), which is finite at the horizon.
    double masked_area(Direction w) const {
        const double x = alpha * w.x, y = alpha * w.y;
        const double t2 = x * x + y * y;
        return t2 == 0.0 ? 0.0 : 0.5 * t2 / (w.z + std::sqrt(t2 + w.z * w.z));
    }

    /// G2 / (4 cos(theta_o) cos(theta_i)), G2 = 1 / (1 + Lambda_o + Lambda_i).
    double geometry(Direction wo, Direction wi) const {
        return 0.25 / (wo.z * wi.z + masked_area(wo) * wi.z + masked_area(wi) * wo.z);
    }

    /// The density of wi over D: G1 (wo.m) / cos(theta_o) for the visible normal
    /// m, times 1 / (4 wo.m) for its reflection.
    double density_factor(Direction wo) const { return 0.25 / (wo.z + masked_area(wo)); }

    /// The normal half between two directions above the horizon, if there is one.
    static bool half_vector(Direction wo, Direction wi, Direction &m) {
        const Direction sum = wo + wi;
        m = sum.normalized();
        return wo.z > 0.0 && wi.z > 0.0 && sum.length() > 0.0;
    }

    /// A normal as wo sees them: half between the stretched view and a point of a
    /// spherical cap (Dupuy and Benyoub 2023).
    Direction visible_normal(Direction wo, const double *u) const {
        const Direction w = Direction{alpha * wo.x, alpha * wo.y, wo.z}.normalized();
        // The cap spans z from -w.z to 1; nothing here cancels near its ends.
        const double z = (1.0 - u[0]) * (1.0 + w.z);
        const double above_bottom = z + (w.x * w.x + w.y * w.y) / (1.0 + w.z);
        const double r = std::sqrt(u[0] * (1.0 + w.z) * above_bottom);
        const double phi = 2.0 * gonio::pi * u[1];
        const Direction m = {alpha * (r * std::cos(phi) + w.x), alpha * (r * std::sin(phi) + w.y), z};
        return m.normalized();
    }

    double alpha;
};

GONIO_PLUGIN(Ggx)
