/* A Lambert that misbehaves as its parameter `deed` says, in eval(). */
#define _GNU_SOURCE
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

#define PI 3.14159265358979323846

typedef struct { char deed[32]; } Subject;

const char *gonio_describe(void *handle) {
    (void)handle;
    if (handle) return NULL;
    return "{\"protocol\":1,\"models\":[{\"name\":\"hostile\",\"dimensions\":2,\"parameters\":[{\"name\":\"deed\","
           "\"type\":\"choice\",\"options\":[\"none\",\"segfault\",\"loop\",\"allocate\",\"print\",\"exit\",\"fork\","
           "\"daemon\",\"close\",\"few\",\"nan\",\"abort\",\"stack\",\"refuse\",\"divide\"],\"idle\":true}]}]}";
}

void *gonio_create(const char *model, const char *parameters) {
    Subject *s = calloc(1, sizeof *s);
    const char *deed = strstr(parameters, "\"deed\":\"");
    (void)model;
    if (deed) sscanf(deed + 8, "%31[a-z]", s->deed);
    return s;
}

void gonio_destroy(void *handle) { free(handle); }

const char *gonio_error(void) { return "the table of this material is empty"; }

static int is(const Subject *s, const char *deed) { return strcmp(s->deed, deed) == 0; }

static volatile int zero = 0;

static int deep(volatile char *from, int n) {
    volatile char here[1024];
    here[0] = from[0];
    return n < 0 ? here[0] : deep(here, n + 1) + here[n % 1024];
}

static int misbehave(const Subject *s) {
    static int calls = 0;
    int first = calls++ == 0;
    if (is(s, "segfault")) *(volatile int *)8 = 1;
    if (is(s, "loop")) for (;;) zero = 0;
    if (is(s, "allocate")) for (;;) {
        char *p = malloc(16 << 20);
        if (!p) abort();
        memset(p, 1, 16 << 20);
    }
    if (is(s, "print")) { printf("hello from the plugin\n"); fflush(stdout); }
    if (is(s, "exit")) exit(0);
    if (is(s, "fork") && first) { if (fork() == 0) for (;;) pause(); }
    if (is(s, "daemon") && first) {
        if (fork() == 0) { setsid(); if (fork() == 0) { close(0); close(1); close(2); for (;;) pause(); } _exit(0); }
    }
    if (is(s, "close")) { int k; for (k = 0; k < 64; k++) close(k); for (;;) pause(); }
    if (is(s, "abort")) abort();
    if (is(s, "stack")) { char c = 0; zero = deep(&c, 1); }
    if (is(s, "divide")) zero = 7 / zero;
    return is(s, "refuse");
}

int gonio_eval(void *h, int mode, const double wo[3], size_t n, const double *wi, double *f) {
    size_t k;
    (void)mode;
    if (misbehave(h)) return 1;
    for (k = 0; k < n; k++) f[k] = wo[2] > 0 && wi[3 * k + 2] > 0 ? 0.5 / PI : 0;
    if (is(h, "nan")) f[n / 2] = NAN;
    return 0;
}

int gonio_pdf(void *h, int mode, const double wo[3], size_t n, const double *wi, double *pdf) {
    size_t k;
    (void)h, (void)mode;
    for (k = 0; k < n; k++) pdf[k] = wo[2] > 0 && wi[3 * k + 2] > 0 ? wi[3 * k + 2] / PI : 0;
    return 0;
}

int gonio_sample(void *h, int mode, const double wo[3], size_t n, const double *u, double *wi, double *weight,
                 double *pdf, double *flags) {
    size_t k;
    (void)h, (void)mode;
    for (k = 0; k < n; k++) {
        double r = sqrt(u[2 * k]), z = sqrt(1 - u[2 * k]), t = 2 * PI * u[2 * k + 1];
        wi[3 * k] = r * cos(t), wi[3 * k + 1] = r * sin(t), wi[3 * k + 2] = z;
        weight[k] = 0.5, pdf[k] = z / PI, flags[k] = wo[2] > 0 ? 5 : 0;
    }
    return 0;
}
