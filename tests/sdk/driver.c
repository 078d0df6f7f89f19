/* Calls a plugin that it is linked with: MODEL PARAMETERS DIMENSIONS, one channel.
 * Reads wo[3], n and u[n][dimensions]. Writes the description, what is special
 * about the handle, and a line a row: flags wi[3] weight pdf f(wi) pdf(wi). */

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
    double wo[3], *u, *wi, *weight, *pdf, *flags, *f, *p;
    size_t n, k, dimensions;
    const char *special;
    void *handle;
    if (count != 4) {
        return 2;
    }
    dimensions = (size_t)atoi(arguments[3]);
    printf("%s\n", gonio_describe(NULL));
    handle = gonio_create(arguments[1], arguments[2]);
    if (handle == NULL) {
        return refused();
    }
    special = gonio_describe(handle);
    printf("%s\n", special == NULL ? "{}" : special);
    while (scanf("%lf %lf %lf %zu", wo, wo + 1, wo + 2, &n) == 4) {
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
