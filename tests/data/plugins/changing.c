/* A diffuse material with parts that a fix changes (-DFIXED): `left` reflects more
 * than arrives, `right` is not reciprocal, and `third` is drawn less well after the fix:
 * 80 % of the draws count. */
#include "gonio.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#ifdef FIXED
#define IS_FIXED 1
#else
#define IS_FIXED 0
#endif

/* The share of even draws for which 2∫µ²/(w/2 + (1 − w)µ) dµ is 1/0.8. */
#define EVEN 0.861

typedef struct { int left, right, third; } Subject;

const char *gonio_describe(void *handle) {
    if (handle) return NULL;
    return "{\"protocol\":1,\"models\":[{\"name\":\"changing\",\"dimensions\":3,\"claims\":{\"isotropic\":true},"
           "\"parameters\":[{\"name\":\"part\",\"type\":\"choice\",\"options\":[\"sound\",\"left\",\"right\",\"third\"],"
           "\"idle\":true}]}]}";
}

void *gonio_create(const char *model, const char *parameters) {
    Subject *s = calloc(1, sizeof *s);
    (void)model;
    s->left = strstr(parameters, "left") && !IS_FIXED;
    s->right = strstr(parameters, "right") && !IS_FIXED;
    s->third = strstr(parameters, "third") && IS_FIXED;
    return s;
}

void gonio_destroy(void *handle) { free(handle); }

const char *gonio_error(void) { return ""; }

static double value(const Subject *s, const double *wo, const double *wi) {
    if (!(wo[2] > 0 && wi[2] > 0)) return 0;
    return (s->left ? 1.1 : 0.5) / PI * (s->right ? 0.8 + 0.2 * wo[2] : 1);
}

static double density(const Subject *s, const double *wo, const double *wi) {
    if (!(wo[2] > 0 && wi[2] > 0)) return 0;
    return s->third ? EVEN / (2 * PI) + (1 - EVEN) * wi[2] / PI : wi[2] / PI;
}

int gonio_eval(void *handle, int mode, const double wo[3], size_t n, const double *wi, double *f) {
    (void)mode;
    for (size_t k = 0; k < n; k++) f[k] = value(handle, wo, wi + 3 * k);
    return 0;
}

int gonio_pdf(void *handle, int mode, const double wo[3], size_t n, const double *wi, double *p) {
    (void)mode;
    for (size_t k = 0; k < n; k++) p[k] = density(handle, wo, wi + 3 * k);
    return 0;
}

int gonio_sample(void *handle, int mode, const double wo[3], size_t n, const double *u, double *wi, double *weight,
                 double *pdf, double *flags) {
    const Subject *s = handle;
    (void)mode;
    for (size_t k = 0; k < n; k++, u += 3, wi += 3) {
        double z = s->third && u[2] < EVEN ? u[0] : sqrt(1 - u[0]), r = sqrt(1 - z * z), phi = 2 * PI * u[1];
        wi[0] = r * cos(phi), wi[1] = r * sin(phi), wi[2] = z;
        double p = density(s, wo, wi);
        flags[k] = p > 0 ? 1 + 4 : 0;
        weight[k] = p > 0 ? value(s, wo, wi) * z / p : 0;
        pdf[k] = p;
    }
    return 0;
}
