/* Calls a plugin that it is linked with: MODEL PARAMETERS DIMENSIONS CHANNELS.
 * Writes the description and what is special about the handle. Of 0 dimensions:
 * f(z), in both modes. Else reads wo[3], n and u[n][dimensions] and writes a line a
 * row, of one channel: flags wi[3] weight pdf f(wi) pdf(wi). */

#include "gonio.h"

#include <stdio.h>
#include <stdlib.h>

static double *numbers(size_t n)
{
    double *array = (double *)calloc(n + 1, sizeof *array);
    if (array == NULL) {
        exit(2);
    }
    return array;
}

static int refused(void)
{
    const char *why = gonio_error();
    printf("refused: %s\n", why == NULL ? "no reason" : why);
    return 1;
}

int main(int count, char **arguments)
{
    static const double z[3] = {0.0, 0.0, 1.0};
    double wo[3], value[16], *u, *wi, *weight, *pdf, *flags, *f, *p;
    size_t n, k, dimensions, channels;
    int mode;
    const char *special;
    void *handle;
    if (count != 5) {
        return 2;
    }
    dimensions = (size_t)atoi(arguments[3]);
    channels = (size_t)atoi(arguments[4]);
    printf("%s\n", gonio_describe(NULL));
    handle = gonio_create(arguments[1], arguments[2]);
    if (handle == NULL) {
        return refused();
    }
    special = gonio_describe(handle);
    printf("%s\n", special == NULL ? "{}" : special);
    for (mode = GONIO_RADIANCE; dimensions == 0 && mode <= GONIO_IMPORTANCE; ++mode) {
        if (gonio_eval(handle, mode, z, 1, z, value) != 0) {
            return refused();
        }
        for (k = 0; k < channels; ++k) {
            printf("%.17g%c", value[k], k + 1 == channels ? '\n' : ' ');
        }
    }
    while (dimensions > 0 && scanf("%lf %lf %lf %zu", wo, wo + 1, wo + 2, &n) == 4) {
        u = numbers(n * dimensions);
        wi = numbers(3 * n);
        weight = numbers(n);
        pdf = numbers(n);
        flags = numbers(n);
        f = numbers(n);
        p = numbers(n);
        for (k = 0; k < n * dimensions; ++k) {
            if (scanf("%lf", u + k) != 1) {
                return 2;
            }
        }
        if (gonio_sample(handle, GONIO_RADIANCE, wo, n, u, wi, weight, pdf, flags) != 0 ||
            gonio_eval(handle, GONIO_RADIANCE, wo, n, wi, f) != 0 ||
            gonio_pdf(handle, GONIO_RADIANCE, wo, n, wi, p) != 0) {
            return refused();
        }
        for (k = 0; k < n; ++k) {
            printf("%g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", flags[k], wi[3 * k], wi[3 * k + 1],
                   wi[3 * k + 2], weight[k], pdf[k], f[k], p[k]);
        }
        free(u);
        free(wi);
        free(weight);
        free(pdf);
        free(flags);
        free(f);
        free(p);
    }
    gonio_destroy(handle);
    return 0;
}
