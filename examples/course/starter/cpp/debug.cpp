// debug.cpp: your functions in a program of your own, for a debugger or printf:
//
//     c++ -std=c++17 -g debug.cpp brdf.cpp -o debug && ./debug
#include "course.h"
#include <cstdio>

template <class Brdf> static void show(const char *name, const Brdf &brdf) {
    const Vec3 wo = normalize({0.5, 0.2, 0.7});
    std::printf("%s\n", name);
    for (int k = 0; k < 4; ++k) {
        const double u1 = (k + 0.5) / 4, u2 = 0.3 + 0.2 * k;
        const Sample s = brdf.sample(wo, u1, u2);
        if (s.lobe == NONE) {
            std::printf("  u %.3f %.3f  no sample\n", u1, u2);
            continue;
        }
        const double f = brdf.eval(wo, s.wi), p = brdf.pdf(wo, s.wi);
        std::printf("  u %.3f %.3f  wi %7.4f %7.4f %7.4f  f %.6f  pdf %.6f  sample.pdf %.6f", u1, u2, s.wi.x,
                    s.wi.y, s.wi.z, f, p, s.pdf);
        std::printf("  weight %.6f  f cos/pdf %.6f\n", s.weight, f * s.wi.z / p);
    }
}

int main() {
    show("diffuse", Diffuse{0.5});
    show("metal", Metal{0.3, 0.9});
    show("plastic", Plastic{0.3, 1.5, 0.4, 0.8});
}
