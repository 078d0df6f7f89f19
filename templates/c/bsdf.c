/* @NAME@: a BSDF for gonio. It is Lambert's reflector, f = reflectance / pi; put
 * your own in its place. include/gonio.h says what each function must do.
 *
 * Directions are unit vectors that point away from the surface, whose normal is
 * +z: cos(theta) is the z of a direction. wo is given, wi is sampled.
 */

#include "gonio.h"
#include "gonio_parameters.h"

#if defined(__wasm__)
#include "gonio_wasm.h" /* a bare WebAssembly module has no C library */
#else
#include <math.h>
#include <stdlib.h>
#endif

static const double PI = 3.14159265358979323846;

/* What gonio is told. Claims are what the model is held to: one that is not made
 * is not tested. gonio keeps parameters between min and max. */
static const char description[] = GONIO_JSON({
    "protocol": 1,
    "models": [{
        "name": "@NAME@",
        "doc": "ideally diffuse reflection",
        "channels": ["value"],
        "dimensions": 2,
        "claims": {"isotropic": true, "reciprocal": true, "energy_conserving": true},
        "parameters": [{
            "name": "reflectance", "type": "number", "default": 0.5, "min": 0, "max": 1,
            "doc": "share of the light that is reflected"
        }]
    }]
});

/* A subject: a model with values for its parameters. Nothing changes it once it
 * is made, so that any thread may use it. */
typedef struct {
    double reflectance;
} subject;

static GONIO_THREAD const char *error = NULL;

const char *gonio_describe(void *handle)
{
    /* Where claims depend on parameters, a handle has a description of its own. */
    return handle == NULL ? description : NULL;
}

const char *gonio_error(void)
{
    return error;
}

void *gonio_create(const char *model, const char *parameters)
{
    subject *self = (subject *)malloc(sizeof *self);
    (void)model; /* there is only one */
    if (self == NULL) {
        error = "out of memory";
        return NULL;
    }
    self->reflectance = gonio_number(parameters, "reflectance", 0.5);
    return self;
}

void gonio_destroy(void *handle)
{
    free(handle);
}

/* The value of the BSDF in 1/sr, without the cosine: wi[n][3] -> f[n]. */
int gonio_eval(void *handle, int mode, const double wo[3], size_t n, const double *wi, double *f)
{
    const subject *self = (const subject *)handle;
    size_t k;
    (void)mode; /* radiance or importance: the same where nothing is refracted */
    for (k = 0; k < n; ++k) {
        f[k] = wo[2] > 0.0 && wi[3 * k + 2] > 0.0 ? self->reflectance / PI : 0.0;
    }
    return 0;
}

/* The density of gonio_sample per steradian: wi[n][3] -> pdf[n]. */
int gonio_pdf(void *handle, int mode, const double wo[3], size_t n, const double *wi, double *pdf)
{
    size_t k;
    (void)handle;
    (void)mode;
    for (k = 0; k < n; ++k) {
        const double cosine = wi[3 * k + 2];
        pdf[k] = wo[2] > 0.0 && cosine > 0.0 ? cosine / PI : 0.0;
    }
    return 0;
}

/* Draws from u[n][dimensions] in [0, 1): wi[n][3], weight[n] = f cos / pdf, pdf[n],
 * and flags[n], which are GONIO_NONE where nothing is drawn. */
int gonio_sample(void *handle, int mode, const double wo[3], size_t n, const double *u, double *wi,
                 double *weight, double *pdf, double *flags)
{
    const subject *self = (const subject *)handle;
    size_t k;
    (void)mode;
    for (k = 0; k < n; ++k) {
        /* A point of the unit disc, lifted to the hemisphere: density cos / pi. */
        const double r = sqrt(u[2 * k]), phi = 2.0 * PI * u[2 * k + 1];
        const double cosine = sqrt(1.0 - u[2 * k]);
        if (!(wo[2] > 0.0)) {
            flags[k] = GONIO_NONE;
            continue;
        }
        wi[3 * k] = r * cos(phi);
        wi[3 * k + 1] = r * sin(phi);
        wi[3 * k + 2] = cosine;
        pdf[k] = cosine / PI;
        weight[k] = self->reflectance; /* the cosine and pi cancel */
        flags[k] = GONIO_REFLECTION | GONIO_DIFFUSE;
    }
    return 0;
}
