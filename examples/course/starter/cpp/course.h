// course.h: what the course gives you. Vectors, samples, and the three models with
// their parameters. You write their functions, in brdf.cpp.
//
// Directions are unit vectors that point away from the surface, whose normal is +z:
// cos(theta) is the z of a direction. wo is given, wi is sampled.
#ifndef COURSE_H
#define COURSE_H

// gonio builds your code without a C++ library, so include nothing else: the functions
// of math.h are here, and they and min, max, swap answer to std:: as well.
#if defined(__wasm__)
#include "gonio_wasm.h"
#define INFINITY __builtin_inf()
#define NAN __builtin_nan("")
inline bool isnan(double x) { return __builtin_isnan(x); }
inline bool isinf(double x) { return __builtin_isinf(x); }
inline bool isfinite(double x) { return __builtin_isfinite(x); }
inline double abs(double x) { return __builtin_fabs(x); }
namespace std {
using ::abs, ::acos, ::asin, ::atan, ::atan2, ::ceil, ::cos, ::exp, ::fabs, ::floor, ::fmax, ::fmin,
    ::isfinite, ::isinf, ::isnan, ::log, ::pow, ::sin, ::sqrt, ::tan;
template <class T> constexpr T min(T a, T b) { return b < a ? b : a; }
template <class T> constexpr T max(T a, T b) { return a < b ? b : a; }
template <class T> void swap(T &a, T &b) { const T old = a; a = b; b = old; }
} // namespace std
#else
#include <algorithm>
#include <cmath>
using std::abs, std::isfinite, std::isinf, std::isnan;
#endif
using std::max, std::min, std::swap;

constexpr double pi = 3.14159265358979323846;

struct Vec3 {
    double x, y, z;
};
inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(Vec3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
inline Vec3 operator*(double s, Vec3 a) { return a * s; }
inline Vec3 operator/(Vec3 a, double s) { return {a.x / s, a.y / s, a.z / s}; }
inline double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3 a) { return sqrt(dot(a, a)); }
inline Vec3 normalize(Vec3 a) { return a / length(a); }

// Which lobe a sample came from.
enum Lobe { NONE, DIFFUSE, GLOSSY };

// A sampled direction with weight = f cos(theta_i) / pdf and its pdf per steradian.
// Sample() is no sample: what you return where a draw falls below the horizon.
struct Sample {
    Vec3 wi = {0, 0, 1};
    double weight = 0;
    double pdf = 0;
    Lobe lobe = NONE;
};

// Each has the three functions; u1 and u2 are random numbers in [0, 1).
struct Diffuse {
    double reflectance; // in [0, 1]
    double eval(Vec3 wo, Vec3 wi) const;
    double pdf(Vec3 wo, Vec3 wi) const;
    Sample sample(Vec3 wo, double u1, double u2) const;
};

struct Metal {
    double alpha; // roughness, in [0.05, 1]
    double f0;    // reflectance of a facet at normal incidence, in [0, 1]
    double eval(Vec3 wo, Vec3 wi) const;
    double pdf(Vec3 wo, Vec3 wi) const;
    Sample sample(Vec3 wo, double u1, double u2) const;
};

struct Plastic {
    double alpha;       // roughness of the coat, in [0.05, 1]
    double eta;         // index of refraction of the coat, in [1, 3]
    double ks;          // share of the coat, in [0.05, 0.95]
    double reflectance; // of the base, in [0, 1]
    double eval(Vec3 wo, Vec3 wi) const;
    double pdf(Vec3 wo, Vec3 wi) const;
    Sample sample(Vec3 wo, double u1, double u2) const;
};

#endif
