// gonio_model.hpp: what a plugin tells gonio of its models (claims, conventions,
// parameters), and the parameters that come back. Part of gonio.hpp.
//
// SPDX-License-Identifier: MIT OR Apache-2.0

#ifndef GONIO_MODEL_HPP
#define GONIO_MODEL_HPP

#include "gonio.h"
#include "gonio_parameters.h"

#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#if defined(__cpp_exceptions) || defined(__EXCEPTIONS) || defined(_CPPUNWIND)
#define GONIO_EXCEPTIONS 1
#else
#define GONIO_EXCEPTIONS 0
#endif

// Variables of functions in headers are one for all libraries of a process, unless
// they are hidden.
#if defined(__GNUC__) && !defined(_WIN32)
#define GONIO_HIDDEN __attribute__((visibility("hidden")))
#else
#define GONIO_HIDDEN
#endif

namespace gonio {

// Of each the first is what gonio takes for granted.

/// Whether eval contains |cos theta_i|.
enum class Cosine { excluded, included };
/// The modes of transport that are told apart.
enum class Modes { radiance, importance, both };
/// What becomes of draws off the support, as below the horizon.
enum class OffSupport { no_sample, zero_weight, never };
/// Where random numbers come from: u, or a generator of one's own.
enum class Random { external, internal };
/// What sample returns as its weight.
enum class Weight { f_cos_over_pdf, f_over_pdf, f_cos, f };
/// How a draw without a sample is told.
enum class Failure { flags, zero_pdf, zero_weight };
/// Which axis is the normal; with y, x stays the tangent.
enum class Up { z, y, frame };
/// Whether wo points away from the surface, or along the ray towards it.
enum class Given { away, towards };

/// What a model promises, and is held to.
struct Claims {
    bool reciprocal = true;
    bool energy_conserving = true;
    bool lossless = false;
    bool isotropic = false;
    bool reflective = true;
    bool transmissive = false;
    bool two_sided = false;
    bool stochastic = false;
    double eta = 0.0; ///< index of the back over that of the front; 0 is none
    Cosine cosine = Cosine::excluded;
    Modes transport = Modes::radiance;
    OffSupport off_support = OffSupport::no_sample;
    Random rng = Random::external;
};

/// The conventions of the code behind the plugin; gonio converts.
struct Conventions {
    Weight weight = Weight::f_cos_over_pdf;
    Failure failure = Failure::flags;
    Up up = Up::z;
    Given given = Given::away;
    /// Where `up` is `Up::frame`: that which the code shades with, in the space of a
    /// scene; unit vectors at right angles.
    double normal[3] = {0.0, 0.0, 1.0};
    double tangent[3] = {1.0, 0.0, 0.0};
};

namespace detail GONIO_HIDDEN {

/// The text of the last error of this thread. No std::string, which would keep
/// the library from being unloaded.
struct Error {
    char text[1024];
    bool raised;
};

inline Error &error() {
    static GONIO_THREAD Error error = {{0}, false};
    return error;
}

inline void raise(const char *text) noexcept {
    Error &e = error();
    std::size_t k = 0;
    for (; text[k] != 0 && k + 1 < sizeof e.text; ++k) e.text[k] = text[k];
    e.text[k] = 0;
    e.raised = true;
}

inline const char *error_text() noexcept { return error().text[0] != 0 ? error().text : nullptr; }

/// As JSON; printf heeds the locale.
inline std::string json(double number) {
    char digits[40];
    std::string text;
    std::snprintf(digits, sizeof digits, "%.17g", number);
    for (const char *c = digits; *c != 0; ++c) {
        const bool known = (*c >= '0' && *c <= '9') || *c == '-' || *c == '+' || *c == 'e';
        if (known) {
            text += *c;
        } else if (text.empty() || text.back() != '.') {
            text += '.';
        }
    }
    return text;
}

inline std::string json(const double (&v)[3]) {
    return "[" + json(v[0]) + "," + json(v[1]) + "," + json(v[2]) + "]";
}

inline std::string json(const std::string &words) {
    std::string text = "\"";
    for (char c : words) {
        if (static_cast<unsigned char>(c) < 0x20) {
            char escape[8];
            std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(c));
            text += escape;
        } else {
            if (c == '"' || c == '\\') text += '\\';
            text += c;
        }
    }
    return text + '"';
}

inline std::string json(const char *words) { return json(std::string(words)); }

inline std::string json(const std::vector<std::string> &list) {
    std::string text = "[";
    for (const std::string &item : list) text += (text.size() > 1 ? "," : "") + json(item);
    return text + "]";
}

inline std::string json(bool value) { return value ? "true" : "false"; }

/// `"name":value`, one after the other.
class Object {
public:
    template <class Value> Object &add(const char *name, const Value &value) {
        return verbatim(name, json(value));
    }
    Object &verbatim(const char *name, const std::string &value) {
        text_ += (text_.empty() ? "" : ",") + json(name) + ":" + value;
        return *this;
    }
    /// The option at the place of `value` in its enum.
    template <class Enum> Object &option(const char *name, Enum value, const char *const *options) {
        return add(name, options[static_cast<int>(value)]);
    }
    const std::string &inside() const { return text_; }
    std::string whole() const { return "{" + text_ + "}"; }

private:
    std::string text_;
};

inline std::string json(const Claims &c) {
    static const char *const cosine[] = {"excluded", "included"};
    static const char *const transport[] = {"radiance", "importance", "both"};
    static const char *const off_support[] = {"no-sample", "zero-weight", "never"};
    static const char *const rng[] = {"external", "internal"};
    Object object;
    object.add("reciprocal", c.reciprocal).add("energy_conserving", c.energy_conserving);
    object.add("lossless", c.lossless).add("isotropic", c.isotropic).add("reflective", c.reflective);
    object.add("transmissive", c.transmissive).add("two_sided", c.two_sided).add("stochastic", c.stochastic);
    if (c.eta != 0.0) object.add("eta", c.eta);
    object.option("cosine", c.cosine, cosine).option("transport", c.transport, transport);
    object.option("off_support", c.off_support, off_support).option("rng", c.rng, rng);
    return object.whole();
}

inline std::string json(const Conventions &c) {
    static const char *const weight[] = {"f-cos-over-pdf", "f-over-pdf", "f-cos", "f"};
    static const char *const failure[] = {"flags", "zero-pdf", "zero-weight"};
    static const char *const up[] = {"z", "y"};
    static const char *const given[] = {"away", "towards"};
    Object object;
    object.option("weight", c.weight, weight).option("failure", c.failure, failure);
    if (c.up == Up::frame) {
        object.verbatim("up", Object().add("normal", c.normal).add("tangent", c.tangent).whole());
    } else {
        object.option("up", c.up, up);
    }
    object.option("given", c.given, given);
    return object.whole();
}

} // namespace detail

/// Fails the call that is going on, with this text: throws, or, without
/// exceptions, marks it so, and whatever is returned is not used.
inline void refuse(const std::string &text) {
#if GONIO_EXCEPTIONS
    throw std::runtime_error(text);
#else
    detail::raise(text.c_str());
#endif
}

/// What the `sensitivity` check may know of a number: as roughness falls samples
/// gather around the mirror direction; at eta = 1 nothing is reflected.
enum class Role { none, roughness, eta };

/// What gonio is told of a model.
class Model {
public:
    explicit Model(std::string name_, std::string doc_ = "") : name(std::move(name_)), doc(std::move(doc_)) {}

    std::string name, doc;
    std::vector<std::string> channels = {"value"};
    int dimensions = 3;     ///< numbers in u
    bool f32 = false;       ///< computes in single precision; errors of that size are forgiven
    bool parallel = true;   ///< false: one process of the plugin, and one thread, at a time
    std::vector<std::string> has = {"eval", "pdf", "sample"};
    Claims claims;
    Conventions conventions;

    Model &number(const char *name_, double otherwise, double min, double max, const char *doc_,
                  Role role = Role::none) {
        detail::Object p = parameter(name_, "number", doc_);
        p.add("default", otherwise).add("min", min).add("max", max);
        if (role != Role::none) p.add("role", role == Role::eta ? "eta" : "roughness");
        return declare({name_, true, otherwise, ""}, p);
    }

    /// The first of the options is the default.
    Model &choice(const char *name_, std::vector<std::string> options, const char *doc_) {
        detail::Object p = parameter(name_, "choice", doc_).add("options", options);
        return declare({name_, false, 0.0, options.empty() ? "" : options[0]}, p);
    }

    /// A path, which must be given.
    Model &file(const char *name_, const char *doc_) {
        return declare({name_, false, 0.0, ""}, parameter(name_, "file", doc_));
    }

    /// What may differ by handle.
    std::string changing() const {
        return detail::Object()
            .add("channels", channels)
            .add("dimensions", static_cast<double>(dimensions))
            .add("precision", f32 ? "f32" : "f64")
            .add("has", has)
            .verbatim("claims", detail::json(claims))
            .verbatim("conventions", detail::json(conventions))
            .inside();
    }

    /// All of it.
    std::string json() const {
        return "{" + detail::Object().add("name", name).add("doc", doc).inside() + "," + changing() +
               ",\"parameters\":[" + declared_ + "]}";
    }

private:
    friend class Parameters;
    struct Declared {
        std::string name;
        bool is_number;
        double number;
        std::string text;
    };

    static detail::Object parameter(const char *name_, const char *type, const char *doc_) {
        return detail::Object().add("name", name_).add("type", type).add("doc", doc_);
    }
    Model &declare(Declared one, const detail::Object &object) {
        parameters_.push_back(std::move(one));
        declared_ += (declared_.empty() ? "" : ",") + object.whole();
        return *this;
    }

    std::vector<Declared> parameters_;
    std::string declared_; // JSON, one object a parameter
};

/// The values of a model's parameters, each by the name that `model()` declares.
class Parameters {
public:
    Parameters(const Model &model, const char *json) : model_(&model), json_(json) {}

    double number(const char *name) const {
        const Model::Declared *p = find(name, true);
        return p == nullptr ? 0.0 : gonio_number(json_, name, p->number);
    }

    /// The option of a choice, or the path of a file.
    std::string text(const char *name) const {
        const Model::Declared *p = find(name, false);
        if (p == nullptr) return "";
        // No string is longer than the JSON that it is in.
        std::vector<char> room(std::char_traits<char>::length(json_) + 1);
        return gonio_text(json_, name, room.data(), room.size()) ? std::string(room.data()) : p->text;
    }

private:
    const Model::Declared *find(const char *name, bool is_number) const {
        for (const Model::Declared &p : model_->parameters_) {
            if (p.name == name && p.is_number == is_number) return &p;
        }
        refuse(model_->name + " declares no " + (is_number ? "number" : "text") + " called " + name);
        return nullptr;
    }

    const Model *model_;
    const char *json_;
};

} // namespace gonio

#endif
