// gonio.hpp: a plugin for gonio from a class. C++11, header only; with
// gonio_model.hpp, gonio.h and gonio_parameters.h.
//
//     #include "gonio.hpp"
//
//     class Lambert : public gonio::Bsdf {
//     public:
//         static gonio::Model model() {
//             gonio::Model m("lambert", "ideally diffuse reflection");
//             m.dimensions = 2;
//             m.claims.isotropic = true;
//             m.number("reflectance", 0.5, 0, 1, "share of the light that is reflected");
//             return m;
//         }
//         explicit Lambert(const gonio::Parameters &p) : reflectance(p.number("reflectance")) {}
//         gonio::Spectrum eval(gonio::Direction wo, gonio::Direction wi, gonio::Transport) const override;
//         double pdf(gonio::Direction wo, gonio::Direction wi, gonio::Transport) const override;
//         gonio::Sample sample(gonio::Direction wo, const double *u, gonio::Transport) const override;
//         ...
//     };
//
//     GONIO_PLUGIN(Lambert)              // once in a plugin; or several: GONIO_PLUGIN(Lambert, Ggx)
//
//     g++ -std=c++11 -O2 -shared -fPIC brdf.cpp -o brdf.so
//     gonio check ./brdf.so
//
// An exception that leaves a function fails that call, with its text. Without
// exceptions (-fno-exceptions) use gonio::refuse.
//
// SPDX-License-Identifier: MIT OR Apache-2.0

#ifndef GONIO_HPP
#define GONIO_HPP

#include "gonio_model.hpp"

#include <cmath>
#include <cstdlib>
#include <exception>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>

namespace gonio {

constexpr double pi = 3.14159265358979323846;

/// A unit vector in the local frame: +z the normal, +x the tangent.
struct Direction {
    double x, y, z;

    Direction operator+(Direction d) const { return {x + d.x, y + d.y, z + d.z}; }
    Direction operator-(Direction d) const { return {x - d.x, y - d.y, z - d.z}; }
    Direction operator-() const { return {-x, -y, -z}; }
    Direction operator*(double s) const { return {x * s, y * s, z * s}; }
    double dot(Direction d) const { return x * d.x + y * d.y + z * d.z; }
    double length() const { return std::sqrt(dot(*this)); }
    Direction normalized() const { return *this * (1.0 / length()); }
    /// Reflected about the unit vector `m`.
    Direction reflected(Direction m) const { return m * (2.0 * dot(m)) - *this; }
};

/// One value a channel, 16 at most. A single number is that of every channel.
class Spectrum {
public:
    Spectrum(double value = 0.0) {
        for (double &v : values_) v = value;
    }
    Spectrum(std::initializer_list<double> values) : Spectrum(0.0) {
        std::size_t k = 0;
        for (double v : values) {
            if (k < 16) values_[k++] = v;
        }
    }
    double &operator[](std::size_t channel) { return values_[channel]; }
    double operator[](std::size_t channel) const { return values_[channel]; }
    Spectrum operator*(double s) const {
        Spectrum product(*this);
        for (double &v : product.values_) v *= s;
        return product;
    }

private:
    double values_[16];
};

/// What is carried along the path.
enum class Transport { radiance = GONIO_RADIANCE, importance = GONIO_IMPORTANCE };

/// What `sample` returns. `flags` are GONIO_REFLECTION and so on, added up.
struct Sample {
    Direction wi;
    Spectrum weight;
    double pdf;
    int flags;

    /// No sample: absorbed, or below the horizon.
    Sample() : wi(), weight(), pdf(0.0), flags(GONIO_NONE) {}
    Sample(Direction wi_, Spectrum weight_, double pdf_, int flags_)
        : wi(wi_), weight(weight_), pdf(pdf_), flags(flags_) {}
};

/// What to derive from: write eval, pdf and sample for one direction each, a
/// static `model()`, and a constructor that takes `const Parameters &`. Objects
/// are constant once they are made; several threads may call the same one.
class Bsdf {
public:
    virtual ~Bsdf() {}

    /// f in 1/sr, without the cosine (or as `claims.cosine` says).
    virtual Spectrum eval(Direction wo, Direction wi, Transport mode) const = 0;

    /// The density of `sample` per steradian. Leave it out with
    /// `has = {"eval"}`, as `sample`.
    virtual double pdf(Direction, Direction, Transport) const {
        refuse("pdf is not written");
        return 0.0;
    }

    /// A draw from u[dimensions], in [0, 1).
    virtual Sample sample(Direction, const double *, Transport) const {
        refuse("sample is not written");
        return Sample();
    }

    /// Changes what `model()` says where it depends on parameters: channels,
    /// dimensions, f32, has, claims, conventions. Once, after the constructor.
    virtual void describe(Model &) const {}

    /// The same for n rows at once, for those who are faster that way: wi[n][3]
    /// to f[n][channels] and pdf[n].
    virtual void eval_batch(Direction wo, std::size_t n, const double *wi, Transport mode,
                            std::size_t channels, double *f) const {
        for (std::size_t k = 0; k < n; ++k) {
            const Spectrum value = eval(wo, {wi[3 * k], wi[3 * k + 1], wi[3 * k + 2]}, mode);
            for (std::size_t c = 0; c < channels; ++c) f[k * channels + c] = value[c];
        }
    }
    virtual void pdf_batch(Direction wo, std::size_t n, const double *wi, Transport mode, double *p) const {
        for (std::size_t k = 0; k < n; ++k) {
            p[k] = pdf(wo, {wi[3 * k], wi[3 * k + 1], wi[3 * k + 2]}, mode);
        }
    }
    /// u[n][dimensions] to wi[n][3], weight[n][channels], pdf[n], flags[n].
    virtual void sample_batch(Direction wo, std::size_t n, const double *u, std::size_t dimensions,
                              Transport mode, std::size_t channels, double *wi, double *weight, double *p,
                              double *flags) const {
        for (std::size_t k = 0; k < n; ++k) {
            const Sample s = sample(wo, u + k * dimensions, mode);
            wi[3 * k] = s.wi.x;
            wi[3 * k + 1] = s.wi.y;
            wi[3 * k + 2] = s.wi.z;
            for (std::size_t c = 0; c < channels; ++c) weight[k * channels + c] = s.weight[c];
            p[k] = s.pdf;
            flags[k] = s.flags;
        }
    }
};

namespace detail GONIO_HIDDEN {

/// A handle.
struct Instance {
    std::unique_ptr<Bsdf> bsdf;
    std::size_t channels, dimensions;
    std::string special; // what the description adds; empty if nothing
};

/// Runs `call`; 0, or 1 where it threw or refused.
template <class Call> int guarded(const Call &call) {
    error().raised = false;
#if GONIO_EXCEPTIONS
    try {
        call();
    } catch (const std::exception &e) {
        raise(e.what());
    } catch (...) {
        raise("something was thrown that is no std::exception");
    }
#else
    call();
#endif
    return error().raised ? 1 : 0;
}

inline Direction at(const double *w) { return {w[0], w[1], w[2]}; }

template <class B> Bsdf *make(const Parameters &parameters) { return new B(parameters); }

/// The models of a plugin.
template <class... Bsdfs> struct Plugin {
    static std::string description() {
        const Model models[] = {Bsdfs::model()...};
        std::string text;
        bool parallel = true;
        for (const Model &m : models) {
            text += (text.empty() ? "" : ",") + m.json();
            parallel = parallel && m.parallel;
        }
        return "{" + Object().add("protocol", double(GONIO_PROTOCOL)).add("parallel", parallel).inside() +
               ",\"models\":[" + text + "]}";
    }

    static const char *describe(void *handle) {
        if (handle != nullptr) {
            const std::string &special = static_cast<Instance *>(handle)->special;
            return special.empty() ? nullptr : special.c_str();
        }
        const char *text = nullptr;
        guarded([&] {
            static const std::string all = description();
            text = all.c_str();
        });
        return text;
    }

    static void *create(const char *name, const char *json) {
        std::unique_ptr<Instance> instance;
        const int failed = guarded([&] {
            const Model models[] = {Bsdfs::model()...};
            Bsdf *(*const makers[])(const Parameters &) = {&make<Bsdfs>...};
            std::size_t k = 0;
            while (k < sizeof...(Bsdfs) && models[k].name != name) ++k;
            if (k == sizeof...(Bsdfs)) return refuse(std::string("no model is called ") + name);
            std::unique_ptr<Bsdf> bsdf(makers[k](Parameters(models[k], json)));
            Model own = models[k];
            bsdf->describe(own);
            if (own.channels.empty() || own.channels.size() > 16) return refuse("channels must be 1 to 16");
            std::string special;
            if (own.changing() != models[k].changing()) special = "{" + own.changing() + "}";
            instance.reset(new Instance{std::move(bsdf), own.channels.size(),
                                        static_cast<std::size_t>(own.dimensions), std::move(special)});
        });
        return failed ? nullptr : instance.release();
    }
};

inline int eval(void *handle, int mode, const double *wo, std::size_t n, const double *wi, double *f) {
    const Instance &self = *static_cast<Instance *>(handle);
    return guarded([&] { self.bsdf->eval_batch(at(wo), n, wi, Transport(mode), self.channels, f); });
}

inline int pdf(void *handle, int mode, const double *wo, std::size_t n, const double *wi, double *p) {
    const Instance &self = *static_cast<Instance *>(handle);
    return guarded([&] { self.bsdf->pdf_batch(at(wo), n, wi, Transport(mode), p); });
}

inline int sample(void *handle, int mode, const double *wo, std::size_t n, const double *u, double *wi,
                  double *weight, double *p, double *flags) {
    const Instance &self = *static_cast<Instance *>(handle);
    return guarded([&] {
        self.bsdf->sample_batch(at(wo), n, u, self.dimensions, Transport(mode), self.channels, wi, weight, p,
                                flags);
    });
}

} // namespace detail
} // namespace gonio

/// Once in a plugin, outside of any namespace: what gonio.h declares, for these
/// classes.
#define GONIO_PLUGIN(...)                                                                              \
    const char *gonio_describe(void *handle) {                                                         \
        return ::gonio::detail::Plugin<__VA_ARGS__>::describe(handle);                                 \
    }                                                                                                  \
    void *gonio_create(const char *model, const char *parameters) {                                    \
        return ::gonio::detail::Plugin<__VA_ARGS__>::create(model, parameters);                        \
    }                                                                                                  \
    int gonio_eval(void *h, int mode, const double wo[3], size_t n, const double *wi, double *f) {     \
        return ::gonio::detail::eval(h, mode, wo, n, wi, f);                                           \
    }                                                                                                  \
    int gonio_pdf(void *h, int mode, const double wo[3], size_t n, const double *wi, double *p) {      \
        return ::gonio::detail::pdf(h, mode, wo, n, wi, p);                                            \
    }                                                                                                  \
    int gonio_sample(void *h, int mode, const double wo[3], size_t n, const double *u, double *wi,     \
                     double *weight, double *p, double *flags) {                                       \
        return ::gonio::detail::sample(h, mode, wo, n, u, wi, weight, p, flags);                       \
    }                                                                                                  \
    void gonio_destroy(void *h) { delete static_cast<::gonio::detail::Instance *>(h); }                \
    const char *gonio_error(void) { return ::gonio::detail::error_text(); }                            \
    GONIO_PLUGIN_MEMORY

#if defined(__wasm__)
#define GONIO_PLUGIN_MEMORY                                                                            \
    void *gonio_alloc(size_t size) { return std::malloc(size); }                                       \
    void gonio_free(void *address, size_t) { std::free(address); }
#else
#define GONIO_PLUGIN_MEMORY
#endif

#endif
