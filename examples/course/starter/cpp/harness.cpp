// harness.cpp: what gonio calls, made of the functions of brdf.cpp. Not yours to change:
// grading puts the course's own in its place.
#include "course.h"
#include "gonio.h"
#include "gonio_parameters.h"
#if !defined(__wasm__)
#include <cstdlib>
#endif

static const char description[] = GONIO_JSON({
    "protocol": 1,
    "models": [{
        "name": "diffuse", "doc": "Lambert's reflector", "dimensions": 2,
        "claims": {"isotropic": true},
        "parameters": [
            {"name": "reflectance", "type": "number", "default": 0.5, "min": 0, "max": 1,
             "doc": "share of the light that is reflected"}
        ]
    }, {
        "name": "metal", "doc": "GGX facets, Smith's masking, Schlick's Fresnel term", "dimensions": 2,
        "claims": {"isotropic": true},
        "parameters": [
            {"name": "alpha", "type": "number", "default": 0.3, "min": 0.05, "max": 1,
             "doc": "roughness", "role": "roughness"},
            {"name": "f0", "type": "number", "default": 0.9, "min": 0, "max": 1,
             "doc": "reflectance of a facet at normal incidence"}
        ]
    }, {
        "name": "plastic", "doc": "a rough dielectric coat beside a diffuse base", "dimensions": 2,
        "claims": {"isotropic": true},
        "parameters": [
            {"name": "alpha", "type": "number", "default": 0.3, "min": 0.05, "max": 1,
             "doc": "roughness of the coat"},
            {"name": "eta", "type": "number", "default": 1.5, "min": 1, "max": 3,
             "doc": "index of refraction of the coat"},
            {"name": "ks", "type": "number", "default": 0.4, "min": 0.05, "max": 0.95,
             "doc": "share of the coat, and the probability with which it is drawn from"},
            {"name": "reflectance", "type": "number", "default": 0.8, "min": 0, "max": 1,
             "doc": "of the base"}
        ]
    }]
});

namespace {

struct Handle {
    enum { diffuse, metal, plastic } model;
    union {
        Diffuse of_diffuse;
        Metal of_metal;
        Plastic of_plastic;
    };
};

GONIO_THREAD const char *error = nullptr;

template <class Call> int with_model(const void *handle, const Call &call) {
    const Handle &h = *static_cast<const Handle *>(handle);
    switch (h.model) {
    case Handle::diffuse: call(h.of_diffuse); break;
    case Handle::metal: call(h.of_metal); break;
    case Handle::plastic: call(h.of_plastic); break;
    }
    return 0;
}

Vec3 row(const double *array, size_t k) { return {array[3 * k], array[3 * k + 1], array[3 * k + 2]}; }

int flags(Lobe lobe) {
    switch (lobe) {
    case DIFFUSE: return GONIO_REFLECTION | GONIO_DIFFUSE;
    case GLOSSY: return GONIO_REFLECTION | GONIO_GLOSSY;
    default: return GONIO_NONE;
    }
}

bool same(const char *a, const char *b) {
    while (*a != 0 && *a == *b) {
        ++a;
        ++b;
    }
    return *a == *b;
}

} // namespace

const char *gonio_describe(void *handle) {
    // A white diffuse reflector loses nothing.
    const Handle *h = static_cast<const Handle *>(handle);
    if (h == nullptr) return description;
    const bool white = h->model == Handle::diffuse && h->of_diffuse.reflectance == 1;
    return white ? GONIO_JSON({"claims": {"isotropic": true, "lossless": true}}) : nullptr;
}

const char *gonio_error(void) { return error; }

void *gonio_create(const char *model, const char *parameters) {
    Handle *h = static_cast<Handle *>(malloc(sizeof(Handle)));
    if (h == nullptr) {
        error = "out of memory";
        return nullptr;
    }
    const auto number = [&](const char *name, double otherwise) {
        return gonio_number(parameters, name, otherwise);
    };
    if (same(model, "diffuse")) {
        h->model = Handle::diffuse;
        h->of_diffuse = {number("reflectance", 0.5)};
    } else if (same(model, "metal")) {
        h->model = Handle::metal;
        h->of_metal = {number("alpha", 0.3), number("f0", 0.9)};
    } else if (same(model, "plastic")) {
        h->model = Handle::plastic;
        h->of_plastic = {number("alpha", 0.3), number("eta", 1.5), number("ks", 0.4),
                         number("reflectance", 0.8)};
    } else {
        error = "there are diffuse, metal and plastic";
        free(h);
        return nullptr;
    }
    return h;
}

void gonio_destroy(void *handle) { free(handle); }

int gonio_eval(void *handle, int, const double wo[3], size_t n, const double *wi, double *f) {
    return with_model(handle, [&](const auto &brdf) {
        for (size_t k = 0; k < n; ++k) f[k] = brdf.eval(row(wo, 0), row(wi, k));
    });
}

int gonio_pdf(void *handle, int, const double wo[3], size_t n, const double *wi, double *pdf) {
    return with_model(handle, [&](const auto &brdf) {
        for (size_t k = 0; k < n; ++k) pdf[k] = brdf.pdf(row(wo, 0), row(wi, k));
    });
}

int gonio_sample(void *handle, int, const double wo[3], size_t n, const double *u, double *wi,
                 double *weight, double *pdf, double *kinds) {
    return with_model(handle, [&](const auto &brdf) {
        for (size_t k = 0; k < n; ++k) {
            const Sample s = brdf.sample(row(wo, 0), u[2 * k], u[2 * k + 1]);
            wi[3 * k] = s.wi.x;
            wi[3 * k + 1] = s.wi.y;
            wi[3 * k + 2] = s.wi.z;
            weight[k] = s.weight;
            pdf[k] = s.pdf;
            kinds[k] = flags(s.lobe);
        }
    });
}
