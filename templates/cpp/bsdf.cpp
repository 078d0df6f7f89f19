// @NAME@: a BSDF for gonio. It is Lambert's reflector, f = reflectance / pi; put
// your own in its place.
//
// Directions are unit vectors that point away from the surface, whose normal is
// +z: cos(theta) is the z of a direction. wo is given, wi is sampled.

#include "gonio.hpp"

using gonio::Direction;
using gonio::Sample;
using gonio::Spectrum;
using gonio::Transport;

class Lambert : public gonio::Bsdf {
public:
    /// What gonio is told. Claims are what the model is held to: one that is not
    /// made is not tested. gonio keeps parameters between their bounds.
    static gonio::Model model() {
        gonio::Model m("@NAME@", "ideally diffuse reflection");
        m.channels = {"value"};
        m.dimensions = 2; // numbers in u
        m.claims.isotropic = true;
        m.claims.reciprocal = true;
        m.claims.energy_conserving = true;
        m.number("reflectance", 0.5, 0.0, 1.0, "share of the light that is reflected");
        return m;
    }

    /// May throw, which gonio shows.
    explicit Lambert(const gonio::Parameters &parameters) : reflectance(parameters.number("reflectance")) {}

    /// The value of the BSDF in 1/sr, without the cosine; of several channels
    /// {r, g, b}.
    Spectrum eval(Direction wo, Direction wi, Transport) const override {
        return wo.z > 0.0 && wi.z > 0.0 ? reflectance / gonio::pi : 0.0;
    }

    /// The density of sample per steradian.
    double pdf(Direction wo, Direction wi, Transport) const override {
        return wo.z > 0.0 && wi.z > 0.0 ? wi.z / gonio::pi : 0.0;
    }

    /// A draw from u[dimensions] in [0, 1): wi, weight = f cos / pdf, pdf, flags;
    /// Sample() where nothing is drawn.
    Sample sample(Direction wo, const double *u, Transport mode) const override {
        if (!(wo.z > 0.0)) return Sample();
        // A point of the unit disc, lifted to the hemisphere: density cos / pi.
        const double r = std::sqrt(u[0]), phi = 2.0 * gonio::pi * u[1];
        const Direction wi = {r * std::cos(phi), r * std::sin(phi), std::sqrt(1.0 - u[0])};
        const double p = pdf(wo, wi, mode);
        return Sample(wi, eval(wo, wi, mode) * (wi.z / p), p, GONIO_REFLECTION | GONIO_DIFFUSE);
    }

private:
    double reflectance;
};

GONIO_PLUGIN(Lambert) // several: GONIO_PLUGIN(Lambert, Mirror)
