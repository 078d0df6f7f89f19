/* A rough mirror in C: Torrance and Sparrow's reflection with the GGX
 * distribution of normals, Smith's masking (correlated by height) and normals
 * drawn as wo sees them. What gonio itself calls `torrance-sparrow`, in the same
 * formulas and from the same u.
 *
 * The same file is a shared library and a WebAssembly module: README.md.
 */

#include "gonio.h"
#include "gonio_parameters.h"

#if defined(__wasm__)
#include "gonio_wasm.h"
#else
#include <math.h>
#include <stdlib.h>
#endif

static const double PI = 3.14159265358979323846;

static const char description[] = GONIO_JSON({
    "protocol": 1,
    "models": [{
        "name": "ggx",
        "doc": "rough mirror: GGX, Smith masking, visible normals",
        "dimensions": 2,
        "claims": {"isotropic": true},
        "parameters": [{
            "name": "alpha", "type": "number", "default": 0.2, "min": 0.0001, "max": 1,
            "doc": "roughness, a slope", "role": "roughness"
        }]
    }]
});

/* What a handle is. It is never changed, so that any thread may use it. */
typedef struct {
    double alpha;
} ggx;

static GONIO_THREAD const char *error = NULL;

const char *gonio_describe(void *handle)
{
    return handle == NULL ? description : NULL;
}

const char *gonio_error(void)
{
    return error;
}

void *gonio_create(const char *model, const char *parameters)
{
    ggx *self;
    (void)model; /* there is one */
    self = (ggx *)malloc(sizeof *self);
    if (self == NULL) {
        error = "out of memory";
        return NULL;
    }
    self->alpha = gonio_number(parameters, "alpha", 0.2);
    if (!(self->alpha >= 1e-4 && self->alpha <= 1.0)) {
        error = "alpha must be from 0.0001 to 1";
        free(self);
        return NULL;
    }
    return self;
}

void gonio_destroy(void *handle)
{
    free(handle);
}

typedef struct {
    double x, y, z;
} vector;

static vector add(vector a, vector b)
{
    const vector sum = {a.x + b.x, a.y + b.y, a.z + b.z};
    return sum;
}

static vector scaled(vector a, double s)
{
    const vector product = {a.x * s, a.y * s, a.z * s};
    return product;
}

static double dot(vector a, vector b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static double length(vector a)
{
    return sqrt(dot(a, a));
}

static vector normalized(vector a)
{
    return scaled(a, 1.0 / length(a));
}

static vector row(const double *array, size_t k)
{
    const vector v = {array[3 * k], array[3 * k + 1], array[3 * k + 2]};
    return v;
}

/* D(m) per steradian; the integral of D cos(theta) is 1 (Walter et al. 2007). */
static double density(const ggx *self, vector m)
{
    const double x = m.x / self->alpha, y = m.y / self->alpha;
    const double s = x * x + y * y + m.z * m.z;
    return m.z > 0.0 ? 1.0 / (PI * self->alpha * self->alpha * s * s) : 0.0;
}

/* Smith's Lambda(w) times cos(theta), which is finite at the horizon. */
static double masked_area(const ggx *self, vector w)
{
    const double x = self->alpha * w.x, y = self->alpha * w.y;
    const double t2 = x * x + y * y;
    return t2 == 0.0 ? 0.0 : 0.5 * t2 / (w.z + sqrt(t2 + w.z * w.z));
}

/* G2 / (4 cos(theta_o) cos(theta_i)), G2 = 1 / (1 + Lambda_o + Lambda_i). */
static double geometry(const ggx *self, vector wo, vector wi)
{
    return 0.25 / (wo.z * wi.z + masked_area(self, wo) * wi.z + masked_area(self, wi) * wo.z);
}

/* The density of wi over D: G1 (wo.m) / cos(theta_o) for the visible normal m,
 * times 1 / (4 wo.m) for its reflection. */
static double density_factor(const ggx *self, vector wo)
{
    return 0.25 / (wo.z + masked_area(self, wo));
}

/* The normal half between two directions above the horizon; 0 if there is none. */
static int half_vector(vector wo, vector wi, vector *m)
{
    const vector sum = add(wo, wi);
    const double l = length(sum);
    *m = scaled(sum, 1.0 / l);
    return wo.z > 0.0 && wi.z > 0.0 && l > 0.0;
}

int gonio_eval(void *handle, int mode, const double wo[3], size_t n, const double *wi, double *f)
{
    const ggx *self = (const ggx *)handle;
    const vector o = row(wo, 0);
    vector m;
    size_t k;
    (void)mode; /* reflection is the same in both */
    for (k = 0; k < n; ++k) {
        const vector i = row(wi, k);
        f[k] = half_vector(o, i, &m) ? density(self, m) * geometry(self, o, i) : 0.0;
    }
    return 0;
}

int gonio_pdf(void *handle, int mode, const double wo[3], size_t n, const double *wi, double *pdf)
{
    const ggx *self = (const ggx *)handle;
    const vector o = row(wo, 0);
    const double factor = density_factor(self, o);
    vector m;
    size_t k;
    (void)mode;
    for (k = 0; k < n; ++k) {
        pdf[k] = half_vector(o, row(wi, k), &m) ? density(self, m) * factor : 0.0;
    }
    return 0;
}

/* A normal as wo sees them, from u[2]: half between the stretched view and a
 * point of a spherical cap (Dupuy and Benyoub 2023). */
static vector visible_normal(const ggx *self, vector wo, const double *u)
{
    const vector stretched = {self->alpha * wo.x, self->alpha * wo.y, wo.z};
    const vector w = normalized(stretched);
    /* The cap spans z from -w.z to 1; nothing here cancels near its ends. */
    const double z = (1.0 - u[0]) * (1.0 + w.z);
    const double above_bottom = z + (w.x * w.x + w.y * w.y) / (1.0 + w.z);
    const double r = sqrt(u[0] * (1.0 + w.z) * above_bottom);
    const double phi = 2.0 * PI * u[1];
    const vector m = {self->alpha * (r * cos(phi) + w.x), self->alpha * (r * sin(phi) + w.y), z};
    return normalized(m);
}

int gonio_sample(void *handle, int mode, const double wo[3], size_t n, const double *u, double *wi,
                 double *weight, double *pdf, double *flags)
{
    const ggx *self = (const ggx *)handle;
    const vector o = row(wo, 0);
    const double factor = density_factor(self, o);
    size_t k;
    (void)mode;
    for (k = 0; k < n; ++k) {
        const vector m = visible_normal(self, o, u + 2 * k);
        const double om = dot(o, m);
        const vector i = add(scaled(m, 2.0 * om), scaled(o, -1.0));
        flags[k] = GONIO_NONE;
        if (!(o.z > 0.0 && om > 0.0 && i.z > 0.0)) {
            continue; /* below the horizon: no sample */
        }
        wi[3 * k] = i.x;
        wi[3 * k + 1] = i.y;
        wi[3 * k + 2] = i.z;
        pdf[k] = density(self, m) * factor;
        weight[k] = geometry(self, o, i) * i.z / factor; /* D is in both */
        if (pdf[k] > 0.0 && pdf[k] - pdf[k] == 0.0 && weight[k] - weight[k] == 0.0) {
            flags[k] = GONIO_REFLECTION | GONIO_GLOSSY;
        }
    }
    return 0;
}
