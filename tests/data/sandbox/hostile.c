/* A Lambert whose eval() does what its parameter `deed` says. Where it got what it must not get, its value is 42. */
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

typedef struct { char deed[32]; } Subject;

const char *gonio_describe(void *handle) {
    return handle ? NULL
                  : "{\"protocol\":1,\"models\":[{\"name\":\"hostile\",\"dimensions\":2,\"parameters\":[{\"name\":"
                    "\"deed\",\"type\":\"choice\",\"options\":[\"none\"],\"idle\":true}]}]}";
}

void *gonio_create(const char *model, const char *parameters) {
    Subject *s = calloc(1, sizeof *s);
    const char *deed = strstr(parameters, "\"deed\":\"");
    (void)model;
    if (deed) sscanf(deed + 8, "%31[a-z0-9]", s->deed);
    return s;
}

void gonio_destroy(void *handle) { free(handle); }

static int reads(const char *path) {
    char text[16];
    FILE *file = fopen(path, "r");
    int got = file && fread(text, 1, sizeof text, file) > 0;
    if (file) fclose(file);
    return got;
}

static int writes(const char *path) {
    FILE *file = fopen(path, "w");
    int got = file && fputs("{\"score\": 100}", file) >= 0 && fclose(file) == 0;
    return got;
}

static void *waits(void *nothing) {
    for (;;) pause();
    return nothing;
}

static int does(const char *deed) {
    int k, got = 0;
    if (!strcmp(deed, "none")) return 0;
    if (!strcmp(deed, "rubric")) return reads("../rubric.toml") + reads("/source/x") + reads("../neighbour/brdf.c");
    if (!strcmp(deed, "passwd")) return reads("/etc/passwd") + reads("/etc/shadow");
    if (!strcmp(deed, "environ")) return reads("/proc/1/environ") + reads("/proc/1/cmdline") * 0;
    if (!strcmp(deed, "results"))
        return writes("/autograder/results/results.json") + writes("results.json") + writes("../results.json") +
               writes("/results.json") + writes("/usr/results.json") + writes("/dev/shm/results.json");
    if (!strcmp(deed, "sysctl")) return writes("/proc/sys/kernel/core_pattern") + writes("/proc/self/oom_score_adj");
    if (!strcmp(deed, "fork")) {
        for (k = 0; k < 100; k++) {
            pid_t pid = fork();
            if (pid == 0) for (;;) pause();
            got += pid > 0;
        }
        return got;
    }
    if (!strcmp(deed, "clone3")) {
        unsigned long long arguments[11] = {0};
        long pid = syscall(SYS_clone3, arguments, sizeof arguments);
        if (pid == 0) for (;;) pause();
        return pid > 0;
    }
    if (!strcmp(deed, "daemon")) {
        if (fork() == 0) { setsid(); if (fork() == 0) { close(0), close(1), close(2); for (;;) pause(); } _exit(0); }
        return 0;
    }
    if (!strcmp(deed, "shell")) { execl("/bin/sh", "sh", "-c", "echo out", NULL); return system("exit 7") == 7 << 8; }
    if (!strcmp(deed, "threads")) {
        pthread_t thread;
        for (k = 0; k < 2000; k++) pthread_create(&thread, NULL, waits, NULL);
        return 0;
    }
    if (!strcmp(deed, "thread")) {
        pthread_t thread;
        return pthread_create(&thread, NULL, waits, NULL) != 0;
    }
    if (!strcmp(deed, "allocate")) for (;;) {
        char *p = malloc(1 << 20);
        if (!p) abort();
        memset(p, 1, 1 << 20);
    }
    if (!strcmp(deed, "disk")) {
        char block[4096] = {0}, path[64];
        for (k = 0; k < 4; k++) {
            sprintf(path, "/tmp/%d", k);
            int file = open(path, O_CREAT | O_WRONLY, 0600);
            for (int n = 0; n < 64 << 8; n++) if (write(file, block, sizeof block) < 0) break;
        }
        sleep(20);
    }
    if (!strcmp(deed, "files")) {
        char path[64];
        for (k = 0; k < 10000000; k++) { sprintf(path, "/tmp/%d", k); close(open(path, O_CREAT, 0600)); }
    }
    if (!strcmp(deed, "socket")) {
        struct sockaddr_in to = {.sin_family = AF_INET, .sin_port = htons(80)};
        inet_pton(AF_INET, "127.0.0.1", &to.sin_addr);
        k = socket(AF_INET, SOCK_STREAM, 0);
        return k >= 0 || connect(k, (struct sockaddr *)&to, sizeof to) == 0;
    }
    if (!strcmp(deed, "local")) {
        struct { unsigned short family; char path[40]; } to = {AF_UNIX, "/run/docker.sock"};
        return connect(socket(AF_UNIX, SOCK_STREAM, 0), (struct sockaddr *)&to, sizeof to) == 0;
    }
    if (!strcmp(deed, "print")) for (;;) { puts("more and more"); fputs("and more\n", stderr); }
    if (!strcmp(deed, "loop")) for (;;) k = 0;
    if (!strcmp(deed, "stop")) { kill(getppid(), SIGSTOP); kill(1, SIGKILL); kill(-1, SIGKILL); return 0; }
    if (!strcmp(deed, "ptrace")) return ptrace(PTRACE_ATTACH, 1, 0, 0) == 0;
    if (!strcmp(deed, "namespace")) return unshare(CLONE_NEWUSER) == 0 || mount("x", "/tmp", "tmpfs", 0, "") == 0;
    if (!strcmp(deed, "filter")) return syscall(SYS_seccomp, 1, 8, &k) >= 0;
    if (!strcmp(deed, "remove")) return unlink("../rubric.toml") == 0 || rename("/tmp", "/work/../x") == 0;
#ifdef __x86_64__
    if (!strcmp(deed, "door32")) {
        /* getpid by the door of 32-bit programs. */
        __asm__ volatile("int $0x80" : "=a"(k) : "a"(20) : "memory");
        return 1;
    }
#endif
    return 1;
}

int gonio_eval(void *h, int mode, const double wo[3], size_t n, const double *wi, double *f) {
    int got = does(((Subject *)h)->deed);
    (void)mode, (void)wo, (void)wi;
    for (size_t k = 0; k < n; k++) f[k] = got ? 42 : 0.25;
    return 0;
}

int gonio_pdf(void *h, int mode, const double wo[3], size_t n, const double *wi, double *pdf) {
    (void)h, (void)mode, (void)wo;
    for (size_t k = 0; k < n; k++) pdf[k] = wi[3 * k + 2] > 0 ? wi[3 * k + 2] / 3.14159265358979323846 : 0;
    return 0;
}

int gonio_sample(void *h, int mode, const double wo[3], size_t n, const double *u, double *wi, double *weight,
                 double *pdf, double *flags) {
    (void)h, (void)mode, (void)wo;
    for (size_t k = 0; k < n; k++) {
        double r = sqrt(u[2 * k]), z = sqrt(1 - u[2 * k]), t = 2 * 3.14159265358979323846 * u[2 * k + 1];
        wi[3 * k] = r * cos(t), wi[3 * k + 1] = r * sin(t), wi[3 * k + 2] = z;
        weight[k] = 0.5, pdf[k] = z / 3.14159265358979323846, flags[k] = 5;
    }
    return 0;
}
