/* gonio.h: what a shared library or a WebAssembly module offers to be measured
 * by gonio. C99 and C++11; nothing to link. docs/plugins.md has the whole
 * contract; this is its form in C.
 *
 * Write the seven functions below (those of wasm come with gonio_wasm.h), then
 *
 *     cc -O2 -shared -fPIC brdf.c -o brdf.so -lm
 *     gonio check ./brdf.so
 *
 * Directions are unit vectors in the local frame (+z the normal, +x the
 * tangent) that point away from the surface. `wo` is given, `wi` is sampled.
 * Arrays are row-major and dense; `channels` and `dimensions` are those of the
 * description.
 *
 * Threads. A worker process of gonio calls from one thread. With --in-process
 * several threads call at once, with different handles or with the same one,
 * unless the description says "parallel": false. A handle is destroyed when
 * nobody uses it any more, on any thread. So: a handle is not changed after
 * gonio_create, and the text of an error belongs to its thread (GONIO_THREAD).
 *
 * Strings are UTF-8 and end with 0. Those that gonio passes are valid during
 * the call. Those that a plugin returns stay its own:
 *   gonio_describe(NULL)     until the library is unloaded;
 *   gonio_describe(handle)   until the next call of it with that handle, or the
 *                            handle's end;
 *   gonio_error()            until the next call of anything on that thread.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef GONIO_H
#define GONIO_H

#include <stddef.h>

/* The version of this contract: "protocol" in the description. */
#define GONIO_PROTOCOL 1

/* mode: what is carried along the path. A plugin that does not claim
 * "transport": "both" may ignore it. */
enum {
    GONIO_RADIANCE = 0, /* light arrives along wi and leaves along wo */
    GONIO_IMPORTANCE = 1
};

/* flags of a sample, added up. GONIO_NONE is no sample: the draw was absorbed,
 * or fell below the horizon. */
enum {
    GONIO_NONE = 0,
    GONIO_REFLECTION = 1,
    GONIO_TRANSMISSION = 2,
    GONIO_DIFFUSE = 4, /* a wide continuous lobe */
    GONIO_GLOSSY = 8,  /* a continuous lobe around a direction */
    GONIO_DISCRETE = 16 /* a single direction; its pdf is a probability */
};

/* GONIO_EXPORT(name) makes a function visible to gonio, whatever the build says. */
#if defined(__wasm__)
#define GONIO_EXPORT(name) __attribute__((visibility("default"), export_name(#name)))
#elif defined(_WIN32)
#define GONIO_EXPORT(name) __declspec(dllexport)
#elif defined(__GNUC__)
#define GONIO_EXPORT(name) __attribute__((visibility("default")))
#else
#define GONIO_EXPORT(name)
#endif

/* Storage of one variable a thread, for the text of errors. */
#if defined(__wasm__)
#define GONIO_THREAD
#elif defined(__cplusplus)
#define GONIO_THREAD thread_local
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L && !defined(__STDC_NO_THREADS__)
#define GONIO_THREAD _Thread_local
#elif defined(_MSC_VER)
#define GONIO_THREAD __declspec(thread)
#elif defined(__GNUC__)
#define GONIO_THREAD __thread
#else
#define GONIO_THREAD /* the plugin is to say "parallel": false */
#endif

/* JSON written as JSON: GONIO_JSON({"name": "ggx", "dimensions": 2}) is a string. */
#define GONIO_JSON(...) #__VA_ARGS__

#ifdef __cplusplus
extern "C" {
#endif

/* With NULL, the description of all models of the plugin (JSON; NULL if that
 * failed, and gonio_error() says why).
 * With a handle, what is special about that subject: any of "channels",
 * "dimensions", "precision", "has", "claims", "conventions", in place of what
 * its model says; or NULL. */
GONIO_EXPORT(gonio_describe)
const char *gonio_describe(void *handle);

/* A subject of the model called `model`; `parameters` is a flat JSON object of
 * numbers and strings, as {"alpha": 0.3, "masking": "smith"} (gonio_parameters.h
 * reads it). NULL if there can be none, and gonio_error() says why. */
GONIO_EXPORT(gonio_create)
void *gonio_create(const char *model, const char *parameters);

/* The next three return 0, or anything else if they fail, and gonio_error() says
 * why. Each has one wo and n rows; every row stands for itself. Arrays do not
 * overlap, and are aligned as doubles are. */

/* wi[n][3] -> f[n][channels], in 1/sr, without the cosine. */
GONIO_EXPORT(gonio_eval)
int gonio_eval(void *handle, int mode, const double wo[3], size_t n, const double *wi, double *f);

/* wi[n][3] -> pdf[n], in 1/sr: the density of gonio_sample, without discrete
 * lobes. */
GONIO_EXPORT(gonio_pdf)
int gonio_pdf(void *handle, int mode, const double wo[3], size_t n, const double *wi, double *pdf);

/* u[n][dimensions], in [0, 1) -> wi[n][3], weight[n][channels], pdf[n], flags[n].
 * weight is f |cos theta_i| / pdf. Where flags are GONIO_NONE the rest of the
 * row is not read. */
GONIO_EXPORT(gonio_sample)
int gonio_sample(void *handle, int mode, const double wo[3], size_t n, const double *u, double *wi,
                 double *weight, double *pdf, double *flags);

/* Gives a subject up. */
GONIO_EXPORT(gonio_destroy)
void gonio_destroy(void *handle);

/* Why the last call on this thread that failed did so, or NULL. */
GONIO_EXPORT(gonio_error)
const char *gonio_error(void);

#if defined(__wasm__)
/* Memory of the module for gonio's arrays and strings, aligned to 8 bytes at
 * least; NULL if there is none. gonio frees it with the size that it asked for. */
GONIO_EXPORT(gonio_alloc)
void *gonio_alloc(size_t size);

GONIO_EXPORT(gonio_free)
void gonio_free(void *address, size_t size);
#endif

#ifdef __cplusplus
}
#endif

#endif
