//! Bugs that the registry of explanations was not written for. Each says which causes
//! are right answers before any was diagnosed; that none fits, and doubt, always are.
//!
//! Each model is there twice, right and wrong: the right one passes, so that nothing
//! but the bug is diagnosed.

use gonio::bsdf::{Bsdf, Claims, Description, Direction, Lobe, Sample, Spectrum, Transport};
use gonio::checks::Verdict;
use gonio::diagnosis::diagnose_all;
use gonio::engine::{Options, Results, run};
use gonio::models::fresnel::{dielectric, schlick};
use gonio::models::microfacet::{Distribution, NormalSampling, RoughDielectric, Roughness};
use gonio::models::{HemisphereSampling, Lambert, Plastic};
use gonio::registry::{Model, Parameters, Registry};
use gonio::report::Diagnosis;
use gonio::suite::{Overrides, load};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};
use std::sync::Arc;

/// One bug: what is wrong, the causes that are right answers, and the model.
struct Bug {
    name: &'static str,
    what: &'static str,
    right: &'static [&'static str],
    declare: fn(Model) -> Model,
    build: fn(&Parameters, bool) -> Written,
}

static BUGS: [Bug; 19] = [
    Bug {
        name: "tangents-not-normalised",
        what: "the sampled lobe's tangents are sines long, and only wi is normalised",
        right: &["frame", "wrong-density"],
        declare: |m| m.number("exponent", 20.0, 1.0..=200.0, "of the lobe"),
        build: tangents_not_normalised,
    },
    Bug {
        name: "beckmann-d-and-no-4",
        what: "two: pdf() has Beckmann's D over a GGX sampler, and lacks the 4 of 1/(4 wo·h)",
        right: &["wrong-density", "implementation-drift", "constant-factor", "half-vector-jacobian"],
        declare: alpha,
        build: beckmann_d_and_no_4,
    },
    Bug {
        name: "separable-value-correlated-weight",
        what: "eval() has G1(wo) G1(wi), the weight 1/(1 + Λo + Λi)",
        right: &["implementation-drift", "masking", "weight"],
        declare: alpha,
        build: separable_value_correlated_weight,
    },
    Bug {
        name: "share-at-the-other-end",
        what: "the lobe's probability is made of θo in sample() and of θi in pdf()",
        right: &["lobe-probability", "swapped-arguments"],
        declare: |m| m,
        build: share_at_the_other_end,
    },
    Bug {
        name: "eta-squared-in-fresnel",
        what: "eval() hands η² to Fresnel's equations, the weight η",
        right: &["fresnel-argument", "implementation-drift", "parameter", "weight"],
        declare: |m| alpha(m).number("eta", 1.5, 1.1..=3.0, "index of refraction"),
        build: eta_squared_in_fresnel,
    },
    Bug {
        name: "retro-lobe-not-in-pdf",
        what: "a retro-reflective lobe is in eval() and sample(), and not in pdf()",
        right: &["lobe-probability", "wrong-density"],
        declare: |m| m,
        build: retro_lobe_not_in_pdf,
    },
    Bug {
        name: "sector-thinned",
        what: "a tenth of the draws in a sector of azimuths is lost, by a die of its own",
        right: &["wrong-density", "unnormalized-rejection"],
        declare: |m| m.number("reflectance", 0.7, 0.0..=1.0, "ρ"),
        build: sector_thinned,
    },
    Bug {
        name: "concentric-quarter-forgotten",
        what: "the concentric map of square to disc has π/4 a/b for π/2 − π/4 a/b",
        right: &["wrong-density", "frame"],
        declare: |m| m,
        build: concentric_quarter_forgotten,
    },
    Bug {
        name: "no-facet-cosine-and-wi-in-weight",
        what: "two: pdf() lacks cos θh, and the weight by hand divides by cos θi for cos θo",
        right: &["ndf-measure", "weight", "swapped-arguments"],
        declare: alpha,
        build: no_facet_cosine_and_wi_in_weight,
    },
    Bug {
        name: "eta-in-pdf-and-turned-back",
        what: "two: pdf() of what is transmitted has η (1/η from below) too many, and from below sees wi turned by π",
        right: &["refraction-jacobian", "frame"],
        declare: |m| alpha(m).number("eta", 1.5, 1.1..=3.0, "index of refraction"),
        build: eta_in_pdf_and_turned_back,
    },
    Bug {
        name: "vignette-in-pdf",
        what: "pdf() has a factor ((1 + cos γ)/2)⁴, γ from the mirror; weights are right",
        right: &["wrong-density"],
        declare: alpha,
        build: vignette_in_pdf,
    },
    Bug {
        name: "alpha-squared-in-d-of-value",
        what: "D in eval() is of α², Λ and all else of α; weights are right",
        right: &["implementation-drift", "parameter"],
        declare: alpha,
        build: alpha_squared_in_d_of_value,
    },
    Bug {
        name: "angle-for-cosine-in-choice",
        what: "sample() chooses the mirror by F(θ) for F(cos θ), and tells that share; pdf() is right",
        right: &["lobe-probability", "fresnel-argument", "parameter"],
        declare: |m| {
            m.number("reflectance", 0.6, 0.0..=1.0, "of the base").number(
                "eta",
                1.5,
                1.1..=3.0,
                "of the coat",
            )
        },
        build: angle_for_cosine_in_choice,
    },
    Bug {
        name: "clamped-horizon-and-no-g1",
        what: "two: draws below the horizon are lifted just above it, and pdf() lacks G1",
        right: &["unnormalized-rejection", "support", "wrong-density", "ndf-vndf-mismatch"],
        declare: alpha,
        build: clamped_horizon_and_no_g1,
    },
    Bug {
        name: "oren-nayar-without-order",
        what: "sin θo tan θi for sin max tan min in eval(); weights agree",
        right: &["swapped-arguments"],
        declare: |m| m.number("sigma", 30.0, 0.0..=60.0, "roughness in degrees"),
        build: oren_nayar_without_order,
    },
    Bug {
        name: "colours-in-reverse",
        what: "the weight has blue for red",
        right: &["weight", "implementation-drift", "swapped-arguments"],
        declare: |m| m,
        build: colours_in_reverse,
    },
    Bug {
        name: "thirty-two-azimuths",
        what: "sample() rounds a random number to 5 bits",
        right: &["numerics", "table", "wrong-density"],
        declare: |m| m.number("reflectance", 0.7, 0.0..=1.0, "ρ"),
        build: thirty_two_azimuths,
    },
    Bug {
        name: "other-masking-and-no-pi",
        what: "two: eval() masks Beckmann's facets by GGX's Λ, and its D lacks 1/π; weights are right",
        right: &["masking", "normalization", "constant-factor", "implementation-drift"],
        declare: alpha,
        build: other_masking_and_no_pi,
    },
    Bug {
        name: "always-front-eta-scale",
        what: "radiance is divided by η² both ways, in eval() and the weight",
        right: &["transport-mode", "eta-side"],
        declare: |m| alpha(m).number("eta", 1.5, 1.1..=3.0, "index of refraction"),
        build: always_front_eta_scale,
    },
];

/// Another trial, after what the first showed was mended.
static SECOND: [Bug; 7] = [
    Bug {
        name: "weight-clamped-pdf-floored",
        what: "two: weights are at most 0.8, and pdf() is at least 0.03",
        right: &["weight", "numerics", "wrong-density", "support"],
        declare: |m| m,
        build: |_, wrong| {
            let [e, s, w, d] = [0.4; 4].map(|a| Distribution::ggx(Roughness::isotropic(a)));
            let (floor, most) = if wrong { (0.03, 0.8) } else { (0.0, 1.0) };
            let pdf = move |wo, wi| visible(&d, wo, wi).max(floor);
            let (q, f) = (pdf.clone(), move |wo, wi| grey(reflect(&e, wo, wi)));
            let weight = move |wo, wi: Direction| grey((reflect(&w, wo, wi) * wi.z / q(wo, wi)).min(most));
            Written::new(f, pdf, move |wo, u| by_visible(&s, wo, u)).weight(weight)
        },
    },
    Bug {
        name: "better-of-an-antithetic-pair",
        what: "sample() keeps one of two opposite draws, in proportion to f; pdf() is that of one draw",
        right: &["wrong-density"],
        declare: |m| m,
        build: |_, wrong| {
            let f = |wo: Direction, wi| 0.3 / PI + 0.3 * 22.0 / TAU * wo.mirrored().dot(wi).max(0.0).powi(20);
            let draw = move |wo, u: &[f64]| {
                let (one, other) = (cosine(u), cosine(&[1.0 - u[0], u[1] + 0.5]));
                let kept = !wrong || u[2] * (f(wo, one) + f(wo, other)) < f(wo, one);
                Some(if kept { one } else { other })
            };
            Written::new(move |wo, wi| grey(f(wo, wi)), |_, wi| wi.z / PI, draw)
        },
    },
    Bug {
        name: "hero-channel-only",
        what: "each colour has its α and its share of the draws; pdf() is that of green",
        right: &["lobe-probability", "wrong-density"],
        declare: |m| m,
        build: |_, wrong| {
            let d = [0.2, 0.35, 0.6].map(|a| Distribution::ggx(Roughness::isotropic(a)));
            let (e, s) = (d.clone(), d.clone());
            let f = move |wo, wi| Spectrum::from_fn(3, |k| 0.8 * reflect(&e[k], wo, wi));
            let pdf = move |wo, wi| {
                let p = |k: usize| visible(&d[k], wo, wi);
                if wrong { p(1) } else { (p(0) + p(1) + p(2)) / 3.0 }
            };
            Written::new(f, pdf, move |wo, u| by_visible(&s[((3.0 * u[2]) as usize).min(2)], wo, u))
        },
    },
    Bug {
        name: "staircase-and-soft-terminator",
        what: "two: pdf() is stored in 8 steps of θi, and eval() alone fades out below cos θi = 0.3",
        right: &["table", "numerics", "wrong-density", "implementation-drift", "masking"],
        declare: |m| m,
        build: |_, wrong| {
            let f = move |_, wi: Direction| {
                let x = if wrong { (wi.z / 0.3).min(1.0) } else { 1.0 };
                grey(0.7 / PI * x * x * (3.0 - 2.0 * x))
            };
            let pdf = move |_, wi: Direction| {
                let (step, k) = (FRAC_PI_2 / 8.0, (16.0 / PI * wi.theta()).floor());
                let mean = 0.5 * ((step * k).cos() + (step * (k + 1.0)).cos());
                if wrong { mean / PI } else { wi.z / PI }
            };
            Written::new(f, pdf, |_, u| Some(cosine(u))).weight(|_, _| grey(0.7))
        },
    },
    Bug {
        name: "hole-as-at-the-normal",
        what: "sample() passes through a hole by the share of holes at the normal, and tells that at wo",
        right: &["lobe-probability", "discrete-lobe"],
        declare: |m| m,
        build: |_, wrong| {
            let cover = |w: Direction| 1.0 - 0.4f64.powf(1.0 / w.z.abs());
            let f = move |wo: Direction, wi: Direction| {
                grey(if wo.same_side(wi) { 0.7 / PI * cover(wo) * cover(wi) } else { 0.0 })
            };
            let pdf = move |wo: Direction, wi: Direction, _: Transport| {
                if wo.same_side(wi) { cover(wo) * wi.z.abs() / PI } else { 0.0 }
            };
            let sample = move |wo: Direction, u: &[f64], t| {
                if u[2] >= cover(if wrong { Direction::NORMAL } else { wo }) {
                    let (wi, lobe) = (wo.mirrored().flipped(), Lobe::DISCRETE_TRANSMISSION);
                    return Some(Sample { wi, weight: grey(1.0), pdf: 1.0 - cover(wo), lobe });
                }
                let wi = if wo.z < 0.0 { cosine(u).flipped() } else { cosine(u) };
                let (pdf, lobe) = (pdf(wo, wi, t), Lobe::DIFFUSE_REFLECTION);
                (pdf > 0.0).then(|| Sample { wi, weight: f(wo, wi) * (wi.z.abs() / pdf), pdf, lobe })
            };
            let claims = Claims { isotropic: true, transmissive: true, two_sided: true, ..Claims::default() };
            let eval = Box::new(move |wo, wi, _| f(wo, wi));
            Written { claims, channels: 1, eval, pdf: Box::new(pdf), sample: Box::new(sample) }
        },
    },
    Bug {
        name: "bent-normal-and-gamma",
        what: "two: sample() alone is about a normal bent by 8°, and the weight has colours to the power 2.2",
        right: &["frame", "wrong-density", "weight", "implementation-drift", "parameter"],
        declare: |m| m,
        build: |_, wrong| {
            let [e, q, s, w] = [0.35; 4].map(|a| Distribution::ggx(Roughness::isotropic(a)));
            let colours = [0.9, 0.6, 0.3];
            let f = move |wo, wi| Spectrum::from_fn(3, |k| colours[k] * reflect(&e, wo, wi));
            let (sin, cos) = if wrong { 8f64.to_radians().sin_cos() } else { (0.0, 1.0) };
            let bent =
                move |w: Direction, s: f64| Direction::new(cos * w.x + s * w.z, w.y, cos * w.z - s * w.x);
            let draw = move |wo, u: &[f64]| Some(bent(by_visible(&s, bent(wo, -sin), u)?, sin));
            let power = if wrong { 2.2 } else { 1.0 };
            Written::new(f, move |wo, wi| visible(&q, wo, wi), draw).weight(move |wo, wi| {
                Spectrum::from_fn(3, |k| f64::powf(colours[k], power) * g2(&w, wo, wi) / w.g1(wo))
            })
        },
    },
    Bug {
        name: "wrapped-light",
        what: "cos θi is wrapped to (cos θi + 0.5)/1.5 in eval(); weights agree",
        right: &["normalization"],
        declare: |m| m,
        build: |_, wrong| {
            let wrap = if wrong { 0.5 } else { 0.0 };
            let f = move |_, wi: Direction| grey(0.7 / PI * (wi.z + wrap) / ((1.0 + wrap) * wi.z));
            Written::new(f, |_, wi| wi.z / PI, |_, u| Some(cosine(u)))
        },
    },
];

fn alpha(model: Model) -> Model {
    model.number("alpha", 0.4, 0.01..=1.0, "roughness")
}

// ---------------------------------------------------------------- the bugs

fn tangents_not_normalised(p: &Parameters, wrong: bool) -> Written {
    let n = p.number("exponent");
    let (kd, ks, share) = (0.3, 0.5, 0.6);
    let power = move |wo: Direction, wi: Direction| wo.mirrored().dot(wi).max(0.0).powf(n);
    let f = move |wo, wi| grey(kd / PI + ks * (n + 2.0) / TAU * power(wo, wi));
    let pdf = move |wo, wi: Direction| (1.0 - share) * wi.z / PI + share * (n + 1.0) / TAU * power(wo, wi);
    let draw = move |wo: Direction, u: &[f64]| {
        if u[2] >= share {
            return Some(cosine(u));
        }
        let axis = wo.mirrored();
        let mut t = Direction::new(0.0, 1.0, 0.0).cross(axis);
        if !wrong {
            t = t.normalized();
        }
        let b = axis.cross(t);
        let local = Direction::from_angles((1.0 - u[0]).powf(1.0 / (n + 1.0)).acos(), TAU * u[1]);
        Some((t * local.x + b * local.y + axis * local.z).normalized())
    };
    Written::new(f, pdf, draw)
}

fn beckmann_d_and_no_4(p: &Parameters, wrong: bool) -> Written {
    let (d, other) = (ggx(p), beckmann(p));
    let (e, s) = (d.clone(), d.clone());
    let f = move |wo, wi| grey(schlick_at(wo, wi) * reflect(&e, wo, wi));
    let pdf = move |wo: Direction, wi| {
        let (h, _) = half(wo, wi);
        if wrong { other.density(h) * d.g1(wo) / wo.z } else { visible(&d, wo, wi) }
    };
    Written::new(f, pdf, move |wo, u| by_visible(&s, wo, u))
}

fn separable_value_correlated_weight(p: &Parameters, wrong: bool) -> Written {
    let d = ggx(p);
    let (e, q, s, w) = (d.clone(), d.clone(), d.clone(), d);
    let f = move |wo, wi| {
        let value = reflect(&e, wo, wi);
        grey(if wrong { value / g2(&e, wo, wi) * e.g1(wo) * e.g1(wi) } else { value })
    };
    Written::new(f, move |wo, wi| visible(&q, wo, wi), move |wo, u| by_visible(&s, wo, u))
        .weight(move |wo, wi| grey(g2(&w, wo, wi) / w.g1(wo)))
}

fn share_at_the_other_end(_: &Parameters, wrong: bool) -> Written {
    let d = Distribution::ggx(Roughness::isotropic(0.3));
    let (e, s) = (d.clone(), d.clone());
    let share = |w: Direction| 0.25 + 0.7 * schlick(w.z, 0.04);
    let through = |w: Direction| 1.0 - schlick(w.z, 0.04);
    let f =
        move |wo, wi| grey(schlick_at(wo, wi) * reflect(&e, wo, wi) + 0.5 / PI * through(wo) * through(wi));
    let pdf = move |wo: Direction, wi: Direction| {
        let coat = share(if wrong { wi } else { wo });
        coat * visible(&d, wo, wi) + (1.0 - coat) * wi.z / PI
    };
    let draw = move |wo, u: &[f64]| if u[2] < share(wo) { by_visible(&s, wo, u) } else { Some(cosine(u)) };
    Written::new(f, pdf, draw)
}

fn eta_squared_in_fresnel(p: &Parameters, wrong: bool) -> Written {
    let (d, eta) = (ggx(p), p.number("eta"));
    let (e, q, s, w) = (d.clone(), d.clone(), d.clone(), d);
    let f = move |wo, wi| {
        grey(dielectric(half(wo, wi).1, if wrong { eta * eta } else { eta }) * reflect(&e, wo, wi))
    };
    Written::new(f, move |wo, wi| visible(&q, wo, wi), move |wo, u| by_visible(&s, wo, u))
        .weight(move |wo, wi| grey(dielectric(half(wo, wi).1, eta) * g2(&w, wo, wi) / w.g1(wo)))
}

fn retro_lobe_not_in_pdf(_: &Parameters, wrong: bool) -> Written {
    let d = Distribution::ggx(Roughness::isotropic(0.3));
    let (e, s) = (d.clone(), d.clone());
    let (n, share) = (40.0, 0.3);
    let back = move |wo: Direction, wi: Direction| wo.dot(wi).max(0.0).powf(n);
    let f = move |wo, wi| grey(0.6 * reflect(&e, wo, wi) + 0.25 * (n + 2.0) / TAU * back(wo, wi));
    let pdf = move |wo, wi| {
        let retro = if wrong { 0.0 } else { (n + 1.0) / TAU * back(wo, wi) };
        (1.0 - share) * visible(&d, wo, wi) + share * retro
    };
    let draw = move |wo: Direction, u: &[f64]| {
        if u[2] >= share {
            return by_visible(&s, wo, u);
        }
        let t = Direction::new(0.0, 1.0, 0.0).cross(wo).normalized();
        let local = Direction::from_angles((1.0 - u[0]).powf(1.0 / (n + 1.0)).acos(), TAU * u[1]);
        Some(t * local.x + wo.cross(t) * local.y + wo * local.z)
    };
    Written::new(f, pdf, draw)
}

fn sector_thinned(p: &Parameters, wrong: bool) -> Written {
    let rho = p.number("reflectance");
    let draw = move |_, u: &[f64]| {
        let wi = cosine(u);
        let lost = wrong && u[2] < 0.1 && (0.7..1.9).contains(&wi.phi());
        (!lost).then_some(wi)
    };
    Written::new(move |_, _| grey(rho / PI), |_, wi| wi.z / PI, draw)
}

fn concentric_quarter_forgotten(_: &Parameters, wrong: bool) -> Written {
    let draw = move |_, u: &[f64]| {
        let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
        let (r, phi) = if a.abs() > b.abs() {
            (a, FRAC_PI_4 * b / a)
        } else if wrong {
            (b, FRAC_PI_4 * a / b)
        } else {
            (b, FRAC_PI_2 - FRAC_PI_4 * a / b)
        };
        (a != 0.0 || b != 0.0)
            .then(|| Direction::new(r * phi.cos(), r * phi.sin(), (1.0 - r * r).max(0.0).sqrt()))
    };
    Written::new(|_, _| grey(0.8 / PI), |_, wi| wi.z / PI, draw)
}

fn no_facet_cosine_and_wi_in_weight(p: &Parameters, wrong: bool) -> Written {
    let d = ggx(p);
    let (e, s, w) = (d.clone(), d.clone(), d.clone());
    let pdf = move |wo, wi| {
        let (h, om) = half(wo, wi);
        d.density(h) * if wrong { 1.0 } else { h.z } / (4.0 * om)
    };
    let draw = move |wo: Direction, u: &[f64]| {
        let m = s.sample(u);
        (wo.dot(m) > 0.0).then(|| wo.reflected(m))
    };
    Written::new(move |wo, wi| grey(reflect(&e, wo, wi)), pdf, draw).weight(move |wo, wi| {
        let (h, om) = half(wo, wi);
        grey(g2(&w, wo, wi) * om / (h.z * if wrong { wi.z } else { wo.z }))
    })
}

fn eta_in_pdf_and_turned_back(p: &Parameters, wrong: bool) -> Written {
    let eta = p.number("eta");
    let glass = RoughDielectric::new(ggx(p), eta, NormalSampling::Visible).unwrap();
    let mut model = Written::of(glass.clone());
    if wrong {
        model.pdf = Box::new(move |wo, wi, t| {
            let seen = if wo.z < 0.0 { wi.mirrored() } else { wi };
            let relative = if wo.z < 0.0 { 1.0 / eta } else { eta };
            Bsdf::pdf(&glass, wo, seen, t) * if wo.same_side(wi) { 1.0 } else { relative }
        });
    }
    model
}

fn vignette_in_pdf(p: &Parameters, wrong: bool) -> Written {
    let d = ggx(p);
    let (e, s, w) = (d.clone(), d.clone(), d.clone());
    let pdf = move |wo: Direction, wi| {
        let fall_off = if wrong { (0.5 + 0.5 * wo.mirrored().dot(wi)).powi(4) } else { 1.0 };
        visible(&d, wo, wi) * fall_off
    };
    Written::new(move |wo, wi| grey(reflect(&e, wo, wi)), pdf, move |wo, u| by_visible(&s, wo, u))
        .weight(move |wo, wi| grey(g2(&w, wo, wi) / w.g1(wo)))
}

fn alpha_squared_in_d_of_value(p: &Parameters, wrong: bool) -> Written {
    let d = ggx(p);
    let squared = Distribution::ggx(Roughness::isotropic(p.number("alpha").powi(2)));
    let (e, q, s, w) = (d.clone(), d.clone(), d.clone(), d);
    let f = move |wo, wi| {
        let h = half(wo, wi).0;
        grey(reflect(&e, wo, wi) * if wrong { squared.density(h) / e.density(h) } else { 1.0 })
    };
    Written::new(f, move |wo, wi| visible(&q, wo, wi), move |wo, u| by_visible(&s, wo, u))
        .weight(move |wo, wi| grey(g2(&w, wo, wi) / w.g1(wo)))
}

fn angle_for_cosine_in_choice(p: &Parameters, wrong: bool) -> Written {
    let eta = p.number("eta");
    let plastic = Plastic::new(p.number("reflectance"), eta);
    let mut model = Written::of(plastic);
    model.sample = Box::new(move |wo, u, t| {
        if wo.z <= 0.0 {
            return None;
        }
        // The right share of the base is the pdf at the normal, over 1/π.
        let base = Bsdf::pdf(&plastic, wo, Direction::NORMAL, t) * PI;
        let reflected = dielectric(wo.z, eta);
        let albedo = reflected * base / (1.0 - base);
        let seen = if wrong { dielectric(wo.theta().min(1.0), eta) } else { reflected };
        let share = seen / (seen + albedo);
        if u[2] < share {
            let weight = grey(reflected / share);
            return Some(Sample { wi: wo.mirrored(), weight, pdf: share, lobe: Lobe::DISCRETE_REFLECTION });
        }
        let wi = cosine(u);
        let weight = Bsdf::eval(&plastic, wo, wi, t) * (PI / (1.0 - share));
        let pdf = (1.0 - share) * wi.z / PI;
        (pdf > 0.0).then_some(Sample { wi, weight, pdf, lobe: Lobe::DIFFUSE_REFLECTION })
    });
    model
}

fn clamped_horizon_and_no_g1(p: &Parameters, wrong: bool) -> Written {
    let d = ggx(p);
    let (e, s) = (d.clone(), d.clone());
    let pdf = move |wo, wi| visible(&d, wo, wi) / if wrong { d.g1(wo) } else { 1.0 };
    let draw = move |wo, u: &[f64]| {
        let mut wi = by_visible(&s, wo, u)?;
        if wrong && wi.z < 0.02 {
            wi.z = 0.02;
            wi = wi.normalized();
        }
        Some(wi)
    };
    Written::new(move |wo, wi| grey(schlick_at(wo, wi) * reflect(&e, wo, wi)), pdf, draw)
}

fn oren_nayar_without_order(p: &Parameters, wrong: bool) -> Written {
    let s2 = p.number("sigma").to_radians().powi(2);
    let (a, b) = (1.0 - 0.5 * s2 / (s2 + 0.33), 0.45 * s2 / (s2 + 0.09));
    let f = move |wo: Direction, wi: Direction| {
        let planar = wo.x * wi.x + wo.y * wi.y;
        // sin θo sin θi cos Δφ over the cosine that tan has.
        let cos = if wrong { wi.z } else { wo.z.max(wi.z) };
        grey(0.6 / PI * (a + b * planar.max(0.0) / cos))
    };
    Written::new(f, |_, wi| wi.z / PI, |_, u| Some(cosine(u)))
}

fn colours_in_reverse(_: &Parameters, wrong: bool) -> Written {
    let d = Distribution::ggx(Roughness::isotropic(0.35));
    let (e, q, s, w) = (d.clone(), d.clone(), d.clone(), d);
    let tint = |k: usize, wo, wi| schlick(half(wo, wi).1, [0.9, 0.6, 0.3][k]);
    let f = move |wo, wi| Spectrum::from_fn(3, |k| tint(k, wo, wi) * reflect(&e, wo, wi));
    let mut model = Written::new(f, move |wo, wi| visible(&q, wo, wi), move |wo, u| by_visible(&s, wo, u))
        .weight(move |wo, wi| {
            Spectrum::from_fn(3, |k| tint(if wrong { 2 - k } else { k }, wo, wi) * g2(&w, wo, wi) / w.g1(wo))
        });
    model.channels = 3;
    model
}

fn thirty_two_azimuths(p: &Parameters, wrong: bool) -> Written {
    let wall = Lambert { reflectance: p.number("reflectance"), sampling: HemisphereSampling::Cosine };
    let mut model = Written::of(wall);
    model.sample = Box::new(move |wo, u, t| {
        let v = if wrong { (32.0 * u[1]).floor() / 32.0 } else { u[1] };
        Bsdf::sample(&wall, wo, &[u[0], v], t)
    });
    model
}

fn other_masking_and_no_pi(p: &Parameters, wrong: bool) -> Written {
    let (d, other) = (beckmann(p), ggx(p));
    let (e, q, s, w) = (d.clone(), d.clone(), d.clone(), d);
    let f = move |wo, wi| {
        let changed = if wrong { PI * g2(&other, wo, wi) / g2(&e, wo, wi) } else { 1.0 };
        grey(0.3 * reflect(&e, wo, wi) * changed)
    };
    Written::new(f, move |wo, wi| visible(&q, wo, wi), move |wo, u| by_visible(&s, wo, u))
        .weight(move |wo, wi| grey(0.3 * g2(&w, wo, wi) / w.g1(wo)))
}

fn always_front_eta_scale(p: &Parameters, wrong: bool) -> Written {
    let eta = p.number("eta");
    let glass = RoughDielectric::new(ggx(p), eta, NormalSampling::Visible).unwrap();
    let scale = move |wo: Direction, wi: Direction, t: Transport| {
        let leaves = wo.z < 0.0 && wi.z > 0.0 && t == Transport::Radiance;
        if wrong && leaves { eta.powi(-4) } else { 1.0 }
    };
    let mut model = Written::of(glass.clone());
    let other = glass.clone();
    model.eval = Box::new(move |wo, wi, t| Bsdf::eval(&other, wo, wi, t) * scale(wo, wi, t));
    model.sample = Box::new(move |wo, u, t| {
        let mut sample = Bsdf::sample(&glass, wo, u, t)?;
        sample.weight = sample.weight * scale(wo, sample.wi, t);
        Some(sample)
    });
    model
}

// ------------------------------------------------------- what they are made of

type Eval = Box<dyn Fn(Direction, Direction, Transport) -> Spectrum + Send + Sync>;
type Pdf = Box<dyn Fn(Direction, Direction, Transport) -> f64 + Send + Sync>;
type Draw = Box<dyn Fn(Direction, &[f64], Transport) -> Option<Sample> + Send + Sync>;

/// A BSDF of three closures.
struct Written {
    claims: Claims,
    channels: usize,
    eval: Eval,
    pdf: Pdf,
    sample: Draw,
}

/// Both above.
fn lit(wo: Direction, wi: Direction) -> bool {
    wo.z > 0.0 && wi.z > 0.0
}

impl Written {
    /// A reflector of these where both directions are above, whose weight is
    /// f cos θi/pdf; `draw` may fall below.
    fn new(
        f: impl Fn(Direction, Direction) -> Spectrum + Send + Sync + 'static,
        pdf: impl Fn(Direction, Direction) -> f64 + Send + Sync + 'static,
        draw: impl Fn(Direction, &[f64]) -> Option<Direction> + Send + Sync + 'static,
    ) -> Self {
        let (f, pdf) = (Arc::new(f), Arc::new(pdf));
        let (value, density) = (f.clone(), pdf.clone());
        let channels = f(Direction::NORMAL, Direction::NORMAL).len();
        Self {
            claims: Claims { isotropic: true, ..Claims::default() },
            channels,
            eval: Box::new(move |wo, wi, _| if lit(wo, wi) { f(wo, wi) } else { Spectrum::zero(channels) }),
            pdf: Box::new(move |wo, wi, _| if lit(wo, wi) { pdf(wo, wi) } else { 0.0 }),
            sample: Box::new(move |wo, u, _| {
                let wi = if wo.z > 0.0 { draw(wo, u)? } else { return None };
                let pdf = if lit(wo, wi) { density(wo, wi) } else { 0.0 };
                let weight = || value(wo, wi) * (wi.z / pdf);
                (pdf > 0.0).then(|| Sample { wi, weight: weight(), pdf, lobe: Lobe::GLOSSY_REFLECTION })
            }),
        }
    }

    /// With a weight of its own.
    fn weight(mut self, by: impl Fn(Direction, Direction) -> Spectrum + Send + Sync + 'static) -> Self {
        let sample = self.sample;
        self.sample = Box::new(move |wo, u, t| {
            let drawn = sample(wo, u, t)?;
            Some(Sample { weight: by(wo, drawn.wi), ..drawn })
        });
        self
    }

    /// As a model that is right.
    fn of(model: impl Bsdf + Clone + 'static) -> Self {
        let (claims, channels) = (model.describe().claims, model.describe().channels.len());
        let [e, p, s] = [model.clone(), model.clone(), model];
        Self {
            claims,
            channels,
            eval: Box::new(move |wo, wi, t| e.eval(wo, wi, t)),
            pdf: Box::new(move |wo, wi, t| p.pdf(wo, wi, t)),
            sample: Box::new(move |wo, u, t| s.sample(wo, u, t)),
        }
    }
}

impl Bsdf for Written {
    fn describe(&self) -> Description {
        let names = (0..self.channels).map(|k| format!("c{k}"));
        Description::new("written").channels(names).claims(|c| *c = self.claims)
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> Spectrum {
        (self.eval)(wo, wi, transport)
    }

    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        (self.pdf)(wo, wi, transport)
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        (self.sample)(wo, u, transport)
    }

    fn hints(&self, wo: Direction) -> Vec<Direction> {
        vec![wo.mirrored(), wo]
    }
}

fn grey(value: f64) -> Spectrum {
    Spectrum::from(value)
}

fn ggx(p: &Parameters) -> Distribution {
    Distribution::ggx(Roughness::isotropic(p.number("alpha")))
}

fn beckmann(p: &Parameters) -> Distribution {
    Distribution::beckmann(Roughness::isotropic(p.number("alpha")))
}

/// h, and wo·h.
fn half(wo: Direction, wi: Direction) -> (Direction, f64) {
    let sum = wo + wi;
    (sum.normalized(), (0.5 * sum.length()).min(1.0))
}

fn schlick_at(wo: Direction, wi: Direction) -> f64 {
    schlick(half(wo, wi).1, 0.04)
}

/// Smith's, correlated by height.
fn g2(d: &Distribution, wo: Direction, wi: Direction) -> f64 {
    1.0 / (1.0 + d.lambda(wo) + d.lambda(wi))
}

/// D G2/(4 cos θo cos θi).
fn reflect(d: &Distribution, wo: Direction, wi: Direction) -> f64 {
    d.density(half(wo, wi).0) * g2(d, wo, wi) / (4.0 * wo.z * wi.z)
}

/// Density of wi where visible normals are drawn.
fn visible(d: &Distribution, wo: Direction, wi: Direction) -> f64 {
    d.density(half(wo, wi).0) * d.g1(wo) / (4.0 * wo.z)
}

fn by_visible(d: &Distribution, wo: Direction, u: &[f64]) -> Option<Direction> {
    Some(wo.reflected(d.sample_visible(wo, u)?))
}

fn cosine(u: &[f64]) -> Direction {
    let (sin, cos) = (TAU * u[1]).sin_cos();
    Direction::new(u[0].sqrt() * cos, u[0].sqrt() * sin, (1.0 - u[0]).sqrt())
}

// ---------------------------------------------------------------- the trials

/// All bugs, and from where each is seen.
fn trials() -> impl Iterator<Item = (&'static Bug, &'static str)> {
    let first = BUGS.iter().map(|bug| (bug, "theta = [20, 45, 65, 80]\nphi = [17, 137, 257]"));
    first.chain(SECOND.iter().map(|bug| (bug, "theta = [25, 55, 78]\nphi = [17, 137]")))
}

impl Bug {
    /// Measured as a user's model is, beside the built-in ones.
    fn measured(&self, wo: &str, wrong: bool) -> (Registry, Results<'static>) {
        let build = self.build;
        let model = Model::new(self.name, "a model of one's own", move |p| Ok(build(p, wrong)));
        let registry = Registry::builtin().register((self.declare)(model));
        let text = format!(
            "[suite]\nname = \"unseen\"\nsamples = 65536\ndetect = 1\n{wo}\ntime_limit = 20\n\
             [[subject]]\nuse = \"{}\"\n",
            self.name
        );
        let plan = load("unseen", &text, &registry, &Overrides::default()).unwrap().plan;
        let results = run(&plan, &Options::default(), &mut |_| {});
        (registry, results)
    }
}

/// Which checks fail.
fn failing(results: &Results) -> Vec<&'static str> {
    let mut checks = Vec::new();
    for finding in results.cases.iter().flat_map(|c| &c.findings) {
        let bad = matches!(finding.outcome.verdict, Verdict::Fail | Verdict::Error);
        if bad && !checks.contains(&finding.check) {
            checks.push(finding.check);
        }
    }
    checks
}

#[test]
fn nothing_but_the_bug_is_wrong() {
    for (bug, wo) in trials() {
        let failed = failing(&bug.measured(wo, false).1);
        assert!(failed.is_empty(), "{}, without its bug: {failed:?}", bug.name);
        let failed = failing(&bug.measured(wo, true).1);
        assert!(!failed.is_empty(), "{}", bug.name);
    }
}

#[test]
fn no_wrong_cause_is_named_with_confidence() {
    let mut wrong = Vec::new();
    for (bug, wo) in trials() {
        let (registry, results) = bug.measured(wo, true);
        let verdicts = diagnose_all(&results, &Arc::new(registry.explanations()), &Options::default());
        let all = Diagnosis::all(&results, verdicts);
        println!(
            "\n## {}: {}\nright: {}; fail: {:?}",
            bug.name,
            bug.what,
            bug.right.join(", "),
            failing(&results)
        );
        for said in &all {
            println!("confident: {}\n{said}\n{:?}", said.confident, said.runner_up);
            let right = said.cause.as_deref().is_some_and(|c| bug.right.contains(&c));
            if said.confident && !right {
                wrong.push(format!("{}: {}", bug.name, said.statement));
            }
        }
        if all.is_empty() {
            println!("no diagnosis");
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
