// Models that use what gonio.hpp offers; those of tests/sdk.rs.

#include "gonio.hpp"

using namespace gonio;

/// Everything that can be declared, in words that JSON must escape.
class Declared : public Bsdf {
public:
    static Model model() {
        Model m("declared", "a \"quoted\" \\ line\n\ttwo");
        m.channels = {"r", "g", "b"};
        m.dimensions = 4;
        m.f32 = true;
        m.claims.reciprocal = false;
        m.claims.transmissive = m.claims.two_sided = true;
        m.claims.eta = 1.5;
        m.claims.cosine = Cosine::included;
        m.claims.transport = Modes::both;
        m.claims.off_support = OffSupport::zero_weight;
        m.claims.rng = Random::internal;
        m.conventions.weight = Weight::f_over_pdf;
        m.conventions.failure = Failure::zero_pdf;
        m.conventions.up = Up::y;
        m.conventions.given = Given::towards;
        m.parallel = false;
        m.number("eta", 1.5, 1.0, 1e3, "index", Role::eta);
        m.choice("masking", {"smith", "v-cavity"}, "masking");
        m.file("table", "measured values");
        return m;
    }

    explicit Declared(const Parameters &p)
        : eta(p.number("eta")), masking(p.text("masking")), table(p.text("table")) {}

    /// Parameters as values: eta, masking, length of the path.
    Spectrum eval(Direction, Direction, Transport mode) const override {
        const double which = masking == "v-cavity" ? 1.0 : masking == "smith" ? 0.0 : -1.0;
        return {eta + (mode == Transport::importance ? 10.0 : 0.0), which, double(table.size())};
    }
    void describe(Model &m) const override {
        m.claims.eta = eta;
        if (masking == "v-cavity") {
            m.channels = {"value"};
            m.has = {"eval"};
        }
    }

private:
    double eta;
    std::string masking, table;
};

/// Fails as `how` says.
class Fails : public Bsdf {
public:
    static Model model() {
        Model m("fails");
        m.dimensions = 2;
        m.choice("how", {"refuse", "create", "undeclared", "throw", "int"}, "in which way");
        return m;
    }

    explicit Fails(const Parameters &p) : how(p.text("how")) {
        if (how == "create") refuse("not this one");
        if (how == "undeclared") p.number("alpha");
    }

    Spectrum eval(Direction, Direction, Transport) const override {
#if GONIO_EXCEPTIONS
        if (how == "throw") throw std::out_of_range("thrown on purpose");
        if (how == "int") throw 7;
#endif
        refuse("eval refuses");
        return 0.0;
    }
    Sample sample(Direction, const double *, Transport) const override { return Sample(); }

private:
    std::string how;
};

/// All rows at once.
class Batched : public Bsdf {
public:
    static Model model() {
        Model m("batched");
        m.dimensions = 1;
        return m;
    }
    explicit Batched(const Parameters &) {}
    Spectrum eval(Direction, Direction, Transport) const override { return -1.0; }
    double pdf(Direction, Direction wi, Transport) const override { return wi.z; }
    Sample sample(Direction wo, const double *u, Transport) const override {
        return u[0] < 0.5 ? Sample() : Sample(wo, 2.0, u[0], GONIO_REFLECTION | GONIO_DISCRETE);
    }
    void eval_batch(Direction wo, std::size_t n, const double *, Transport, std::size_t channels,
                    double *f) const override {
        for (std::size_t k = 0; k < n * channels; ++k) f[k] = double(k) + wo.x;
    }
};

GONIO_PLUGIN(Declared, Fails, Batched)
