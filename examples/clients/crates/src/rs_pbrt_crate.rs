//! The crate `rs_pbrt` 0.9.12, pbrt-v3 in Rust, in f32.
//!
//! Its conventions: the normal is +z, both directions point away, the cosine is
//! left out, the flags are gonio's, the density of a specular lobe is its
//! probability, and a density of 0 says that there is no sample. A sampler
//! returns a value and a density, and the weight is made of them here, so that
//! `weight` says whether that value is the one which `f` gives.
//!
//! What a renderer calls is `Bsdf`, a sum of `Bxdf`s which asks the ones of the
//! right side. `through = "bxdf"` calls a `Bxdf` by itself.

use ::rs_pbrt::core::geometry::{Normal3f, Point2f, Vector3f};
use ::rs_pbrt::core::interaction::SurfaceInteraction;
use ::rs_pbrt::core::interpolation::integrate_catmull_rom;
use ::rs_pbrt::core::material::{Material, TransportMode};
use ::rs_pbrt::core::microfacet::{
    BeckmannDistribution, MicrofacetDistribution, TrowbridgeReitzDistribution,
};
use ::rs_pbrt::core::paramset::{ParamSet, TextureParams};
use ::rs_pbrt::core::pbrt::Spectrum as Rgb;
use ::rs_pbrt::core::reflection::{
    Bsdf as Sum, Bxdf, BxdfType, DisneyFresnel, FourierBSDF, FourierBSDFTable, Fresnel, FresnelBlend,
    FresnelConductor, FresnelDielectric, FresnelNoOp, FresnelSpecular, LambertianReflection,
    LambertianTransmission, MicrofacetReflection, MicrofacetTransmission, OrenNayar, SpecularReflection,
    SpecularTransmission,
};
use ::rs_pbrt::core::rng::FLOAT_ONE_MINUS_EPSILON;
use ::rs_pbrt::materials::disney::{
    DisneyClearCoat, DisneyDiffuse, DisneyFakeSS, DisneyMaterial, DisneyMicrofacetDistribution, DisneyRetro,
    DisneySheen,
};
use ::rs_pbrt::materials::glass::GlassMaterial;
use ::rs_pbrt::materials::hair::HairBSDF;
use ::rs_pbrt::materials::mixmat::MixMaterial;
use ::rs_pbrt::materials::plastic::PlasticMaterial;
use ::rs_pbrt::materials::translucent::TranslucentMaterial;
use ::rs_pbrt::materials::uber::UberMaterial;
use ::rs_pbrt::textures::constant::ConstantTexture;
use gonio::bsdf::{
    Bsdf, Claims, Description, Direction, FresnelFunction, Lobe, NormalDistribution, Precision, Sample,
    Spectrum, Table, Transport, TransportModes,
};
use gonio::registry::{Model, Parameters, Role};
use std::collections::HashMap;
use std::sync::Arc;

const ALL: u8 = BxdfType::BsdfAll as u8;

fn vector(w: Direction) -> Vector3f {
    Vector3f { x: w.x as f32, y: w.y as f32, z: w.z as f32 }
}

fn direction(w: Vector3f) -> Direction {
    Direction { x: w.x.into(), y: w.y.into(), z: w.z.into() }
}

/// Its colours, or the first channel where all are alike.
fn spectrum(f: Rgb, channels: usize) -> Spectrum {
    Spectrum::from_fn(channels, |k| f.c[k].into())
}

/// Two numbers in [0, 1), as its samplers give them.
fn point(u: &[f64]) -> Point2f {
    let below_one = |u: f64| (u as f32).min(FLOAT_ONE_MINUS_EPSILON);
    Point2f { x: below_one(u[0]), y: below_one(u[1]) }
}

/// A sum of its lobes for each mode of transport.
struct Client {
    radiance: Sum,
    importance: Sum,
    /// The first lobe is called by itself.
    alone: bool,
    description: Description,
}

impl Client {
    /// Of a model without colours.
    fn grey(mut self) -> Self {
        self.description.channels = vec!["value".into()];
        self
    }

    fn channels(&self) -> usize {
        self.description.channels.len()
    }

    fn sum(&self, transport: Transport) -> &Sum {
        match transport {
            Transport::Radiance => &self.radiance,
            Transport::Importance => &self.importance,
        }
    }
}

impl Bsdf for Client {
    fn describe(&self) -> Description {
        self.description.clone()
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> Spectrum {
        let sum = self.sum(transport);
        let (o, i) = (vector(wo), vector(wi));
        if !self.alone {
            return spectrum(sum.f(&o, &i, ALL), self.channels());
        }
        // A lobe leaves the choice of the side to its caller.
        let side = if o.z * i.z > 0.0 { BxdfType::BsdfReflection } else { BxdfType::BsdfTransmission };
        let lobe = &sum.bxdfs[0];
        let f = if lobe.get_type() & side as u8 != 0 { lobe.f(&o, &i) } else { Rgb::new(0.0) };
        spectrum(f, self.channels())
    }

    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        let sum = self.sum(transport);
        let (o, i) = (vector(wo), vector(wi));
        f64::from(if self.alone { sum.bxdfs[0].pdf(&o, &i) } else { sum.pdf(&o, &i, ALL) })
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        let sum = self.sum(transport);
        let (o, u) = (vector(wo), point(u));
        let (mut i, mut pdf) = (Vector3f::default(), 0.0);
        let (f, kind);
        if self.alone {
            let mut flags = sum.bxdfs[0].get_type();
            f = sum.bxdfs[0].sample_f(&o, &mut i, &u, &mut pdf, &mut flags);
            kind = flags;
        } else {
            let mut flags = ALL;
            f = sum.sample_f(&o, &mut i, &u, &mut pdf, ALL, &mut flags);
            kind = flags;
        }
        if pdf == 0.0 {
            return None;
        }
        let wi = direction(i);
        let (pdf, cos) = (f64::from(pdf), wi.z.abs());
        // Lobes of both sides do not say on which one they drew.
        let sides = Lobe::REFLECTION.0 | Lobe::TRANSMISSION.0;
        let side = if wo.same_side(wi) { Lobe::REFLECTION } else { Lobe::TRANSMISSION };
        let lobe = if kind & sides == sides { kind & !sides | side.0 } else { kind };
        let weight = spectrum(f, self.channels()) * (cos / pdf);
        Some(Sample { wi, weight, pdf, lobe: Lobe(lobe) })
    }
}

fn described(name: &str, claims: impl FnOnce(&mut Claims)) -> Description {
    Description::new(name).channels(["r", "g", "b"]).dimensions(2).precision(Precision::F32).claims(claims)
}

/// The frame in which local and world directions are the same.
fn sum_of(lobes: Vec<Bxdf>) -> Sum {
    let up = Normal3f { x: 0.0, y: 0.0, z: 1.0 };
    Sum {
        eta: 1.0,
        ns: up,
        ng: up,
        ss: Vector3f { x: 1.0, y: 0.0, z: 0.0 },
        ts: Vector3f { x: 0.0, y: 1.0, z: 0.0 },
        bxdfs: lobes,
    }
}

/// One lobe, made for a mode and scaled as `MixMaterial` does.
fn lobe(
    p: &Parameters,
    make: impl Fn(TransportMode, Option<Rgb>) -> Bxdf,
    name: &str,
    claims: impl FnOnce(&mut Claims),
) -> Client {
    let scale = p.number("scale");
    let scale = (scale < 1.0).then(|| Rgb::new(scale as f32));
    let sum = |mode| sum_of(vec![make(mode, scale)]);
    Client {
        radiance: sum(TransportMode::Radiance),
        importance: sum(TransportMode::Importance),
        alone: p.text("through") == "bxdf",
        description: described(name, |c| {
            claims(c);
            c.lossless &= scale.is_none();
        }),
    }
}

/// With the parameters that [`lobe`] reads.
fn lobe_model(model: Model) -> Model {
    model
        .number("scale", 1.0, 0.0..=1.0, "share in a mixture")
        .choice("through", &["bsdf", "bxdf"], "called through the sum or by itself")
        .idle()
}

/// What a material makes of a surface.
fn material(name: &str, material: &Material, claims: impl FnOnce(&mut Claims)) -> Result<Client, String> {
    let sum = |mode| {
        let mut surface = SurfaceInteraction::default();
        let plane = sum_of(Vec::new());
        (surface.dpdu, surface.dpdv) = (plane.ss, plane.ts);
        (surface.shading.dpdu, surface.shading.dpdv) = (plane.ss, plane.ts);
        (surface.common.n, surface.shading.n) = (plane.ng, plane.ns);
        surface.common.wo = Vector3f { x: 0.0, y: 0.0, z: 1.0 };
        material.compute_scattering_functions(&mut surface, mode, true, None, None);
        surface.bsdf.ok_or("no BSDF was made")
    };
    Ok(Client {
        radiance: sum(TransportMode::Radiance)?,
        importance: sum(TransportMode::Importance)?,
        alone: false,
        description: described(name, claims),
    })
}

/// Numbers as a scene file gives them, under its names.
fn scene(numbers: &[(&str, f64)], colours: &[(&str, Rgb)]) -> TextureParams {
    let mut set = ParamSet::default();
    for (name, value) in numbers {
        set.add_float((*name).into(), *value as f32);
    }
    for (name, value) in colours {
        set.add_rgb_spectrum((*name).into(), *value);
    }
    // α itself, not its square root.
    set.add_bool("remaproughness".into(), false);
    TextureParams::new(ParamSet::default(), set, Arc::new(HashMap::new()), Arc::new(HashMap::new()))
}

/// A colour with three different channels.
fn colour(value: f64) -> Rgb {
    Rgb::rgb(value as f32, (0.75 * value) as f32, (0.5 * value) as f32)
}

fn white(value: f64) -> Rgb {
    Rgb::new(value as f32)
}

fn with_alpha(model: Model) -> Model {
    model
        .number("alpha", 0.3, 0.001..=1.0, "roughness along the tangent")
        .role(Role::Roughness)
        .number("alpha_y", 0.0, 0.0..=1.0, "roughness along the bitangent; 0: as alpha")
        .role(Role::Roughness)
}

fn with_facets(model: Model) -> Model {
    model
        .choice("distribution", &["trowbridge-reitz", "beckmann", "disney"], "of facet normals")
        .choice("sampling", &["visible-normals", "normals"], "which normals are drawn")
        .only_when("distribution", &["trowbridge-reitz", "beckmann"])
}

fn alphas(p: &Parameters) -> (f32, f32) {
    let (x, y) = (p.number("alpha"), p.number("alpha_y"));
    (x as f32, if y > 0.0 { y } else { x } as f32)
}

fn facets(p: &Parameters, visible: bool) -> MicrofacetDistribution {
    let (x, y) = alphas(p);
    match p.text("distribution") {
        "beckmann" => MicrofacetDistribution::Beckmann(BeckmannDistribution::new(x, y, visible)),
        "disney" => MicrofacetDistribution::DisneyMicrofacet(DisneyMicrofacetDistribution::new(x, y)),
        _ => MicrofacetDistribution::TrowbridgeReitz(TrowbridgeReitzDistribution::new(x, y, visible)),
    }
}

fn distribution(p: &Parameters) -> MicrofacetDistribution {
    facets(p, p.text("sampling") == "visible-normals")
}

fn is_isotropic(p: &Parameters) -> bool {
    let (x, y) = alphas(p);
    x == y
}

fn with_fresnel(model: Model) -> Model {
    model
        .choice("fresnel", &["none", "dielectric", "conductor", "disney"], "reflectance")
        .number("eta", 1.5, 1.0..=4.0, "index of refraction of the inside")
        .only_when("fresnel", &["dielectric"])
}

fn fresnel(p: &Parameters) -> Fresnel {
    let eta = p.number("eta") as f32;
    match p.text("fresnel") {
        "dielectric" => Fresnel::Dielectric(FresnelDielectric { eta_i: 1.0, eta_t: eta }),
        // About copper.
        "conductor" => Fresnel::Conductor(FresnelConductor {
            eta_i: Rgb::new(1.0),
            eta_t: Rgb::rgb(0.2, 0.92, 1.1),
            k: Rgb::rgb(3.91, 2.45, 2.14),
        }),
        "disney" => Fresnel::Disney(DisneyFresnel::new(colour(0.8), 0.5, 1.5)),
        _ => Fresnel::NoOp(FresnelNoOp {}),
    }
}

fn is_coloured(p: &Parameters) -> bool {
    matches!(p.text("fresnel"), "conductor" | "disney")
}

fn with_eta(model: Model) -> Model {
    model.number("eta", 1.5, 1.0..=4.0, "index of refraction of the back side").role(Role::Eta)
}

/// Light that is refracted.
fn refracts(c: &mut Claims, eta: f64) {
    c.transmissive = true;
    c.eta = Some(eta);
    c.transport = TransportModes::Both;
}

fn smooth_lobes() -> Vec<Model> {
    let lambert = Model::new("pbrt-lambert", "rs_pbrt: LambertianReflection", |p| {
        let r = p.number("reflectance");
        let make = |_, scale| Bxdf::LambertianRefl(LambertianReflection::new(white(r), scale));
        Ok(lobe(p, make, "pbrt-lambert", |c| {
            (c.isotropic, c.two_sided, c.lossless) = (true, true, r == 1.0);
        })
        .grey())
    })
    .number("reflectance", 0.8, 0.0..=1.0, "albedo");

    let through = Model::new("pbrt-lambert-transmission", "rs_pbrt: LambertianTransmission", |p| {
        let t = p.number("transmittance");
        let make = |_, scale| Bxdf::LambertianTrans(LambertianTransmission::new(white(t), scale));
        Ok(lobe(p, make, "pbrt-lambert-transmission", |c| {
            (c.isotropic, c.two_sided, c.lossless) = (true, true, t == 1.0);
            (c.reflective, c.transmissive) = (false, true);
        })
        .grey())
    })
    .number("transmittance", 0.8, 0.0..=1.0, "albedo");

    let oren_nayar = Model::new("pbrt-oren-nayar", "rs_pbrt: OrenNayar", |p| {
        let (r, sigma) = (p.number("reflectance"), p.number("sigma"));
        let make = |_, scale| Bxdf::OrenNayarRefl(OrenNayar::new(white(r), sigma as f32, scale));
        Ok(lobe(p, make, "pbrt-oren-nayar", |c| {
            (c.isotropic, c.two_sided) = (true, true);
            // The A, B form returns up to 1.014 of what arrives at reflectance 1.
            c.energy_conserving = r <= 0.98;
        })
        .grey())
    })
    .number("reflectance", 0.8, 0.0..=1.0, "ρ")
    .number("sigma", 20.0, 0.0..=90.0, "spread of facet slopes, degrees");

    let mirror = Model::new("pbrt-specular-reflection", "rs_pbrt: SpecularReflection", |p| {
        let make = |_, scale| Bxdf::SpecRefl(SpecularReflection::new(white(1.0), fresnel(p), scale));
        let name = p.text("fresnel");
        let client = lobe(p, make, "pbrt-specular-reflection", |c| {
            c.isotropic = true;
            c.lossless = name == "none";
            c.two_sided = matches!(name, "none" | "conductor");
        });
        Ok(if is_coloured(p) { client } else { client.grey() })
    });

    let refraction = Model::new("pbrt-specular-transmission", "rs_pbrt: SpecularTransmission", |p| {
        let eta = p.number("eta");
        let make = |mode, scale| {
            Bxdf::SpecTrans(SpecularTransmission::new(white(1.0), 1.0, eta as f32, mode, scale))
        };
        Ok(lobe(p, make, "pbrt-specular-transmission", |c| {
            (c.isotropic, c.reflective) = (true, false);
            refracts(c, eta);
        })
        .grey())
    });

    let glass = Model::new("pbrt-fresnel-specular", "rs_pbrt: FresnelSpecular", |p| {
        let eta = p.number("eta");
        let make = |mode, scale| {
            Bxdf::FresnelSpec(FresnelSpecular::new(white(1.0), white(1.0), 1.0, eta as f32, mode, scale))
        };
        Ok(lobe(p, make, "pbrt-fresnel-specular", |c| {
            (c.isotropic, c.lossless) = (true, true);
            refracts(c, eta);
        })
        .grey())
    });

    let mirror = with_fresnel(mirror).role(Role::Eta);
    let models = [lambert, through, oren_nayar, mirror, with_eta(refraction), with_eta(glass)];
    models.into_iter().map(lobe_model).collect()
}

fn facet_lobes() -> Vec<Model> {
    let reflection = Model::new("pbrt-microfacet-reflection", "rs_pbrt: MicrofacetReflection", |p| {
        let make = |_, scale| {
            Bxdf::MicrofacetRefl(MicrofacetReflection::new(white(1.0), distribution(p), fresnel(p), scale))
        };
        let client = lobe(p, make, "pbrt-microfacet-reflection", |c| {
            c.isotropic = is_isotropic(p);
            c.two_sided = matches!(p.text("fresnel"), "none" | "conductor");
        });
        Ok(if is_coloured(p) { client } else { client.grey() })
    });

    let transmission = Model::new("pbrt-microfacet-transmission", "rs_pbrt: MicrofacetTransmission", |p| {
        let eta = p.number("eta");
        let make = |mode, scale| {
            let d = distribution(p);
            Bxdf::MicrofacetTrans(MicrofacetTransmission::new(white(1.0), d, 1.0, eta as f32, mode, scale))
        };
        Ok(lobe(p, make, "pbrt-microfacet-transmission", |c| {
            c.isotropic = is_isotropic(p);
            c.reflective = false;
            refracts(c, eta);
        })
        .grey())
    });

    let blend = Model::new("pbrt-fresnel-blend", "rs_pbrt: FresnelBlend", |p| {
        let (rd, rs) = (p.number("rd"), p.number("rs"));
        let make = |_, scale| {
            Bxdf::FresnelBlnd(FresnelBlend::new(white(rd), white(rs), Some(distribution(p)), scale))
        };
        Ok(lobe(p, make, "pbrt-fresnel-blend", |c| {
            c.isotropic = is_isotropic(p);
            c.two_sided = true;
        })
        .grey())
    })
    .number("rd", 0.5, 0.0..=1.0, "reflectance of the base")
    .number("rs", 0.05, 0.0..=1.0, "reflectance of the coat at the normal")
    .number("alpha", 0.3, 0.001..=1.0, "roughness along the tangent")
    .number("alpha_y", 0.0, 0.0..=1.0, "roughness along the bitangent; 0: as alpha");

    let reflection = with_fresnel(with_alpha(reflection)).role(Role::Eta);
    let models = [reflection, with_eta(with_alpha(transmission)), blend];
    models.into_iter().map(with_facets).map(lobe_model).collect()
}

/// A table of f·|cos θi| = 3ρ/4π cos²θi cos²θo (1 + g sin θi sin θo cos φ) on both
/// sides, which is smooth: splines run over an edge at the horizon.
fn table(rho: f64, g: f64) -> FourierBSDFTable {
    const NODES: usize = 81;
    let node = |k: usize| -1.0 + 2.0 * k as f64 / (NODES - 1) as f64;
    let mut table = FourierBSDFTable {
        eta: 1.0,
        m_max: 2,
        n_channels: 1,
        n_mu: NODES as i32,
        mu: (0..NODES).map(|k| node(k) as f32).collect(),
        recip: vec![f32::INFINITY, 1.0],
        cdf: vec![0.0; NODES * NODES],
        ..Default::default()
    };
    for o in 0..NODES {
        for i in 0..NODES {
            let (mu_o, mu_i) = (node(o), node(i));
            let a0 = 0.75 * rho / std::f64::consts::PI * (mu_i * mu_o).powi(2);
            let sines = ((1.0 - mu_i * mu_i) * (1.0 - mu_o * mu_o)).sqrt();
            table.a_offset.push(table.a.len() as i32);
            table.m.push(2);
            table.a0.push(a0 as f32);
            table.a.extend([a0 as f32, (g * sines * a0) as f32]);
        }
        integrate_catmull_rom(NODES as i32, &table.mu, o * NODES, &table.a0, &mut table.cdf);
    }
    table
}

fn special_lobes() -> Vec<Model> {
    let disney = Model::new("pbrt-disney-lobe", "rs_pbrt: the lobes of DisneyMaterial", |p| {
        let roughness = p.number("roughness") as f32;
        let make = |_, scale| match p.text("lobe") {
            "fake-ss" => Bxdf::DisSS(DisneyFakeSS::new(white(0.8), roughness, scale)),
            "retro" => Bxdf::DisRetro(DisneyRetro::new(white(0.8), roughness, scale)),
            "sheen" => Bxdf::DisSheen(DisneySheen::new(white(0.8), scale)),
            "clearcoat" => Bxdf::DisClearCoat(DisneyClearCoat::new(1.0, p.number("gloss") as f32, scale)),
            _ => Bxdf::DisDiff(DisneyDiffuse::new(white(0.8), scale)),
        };
        Ok(lobe(p, make, "pbrt-disney-lobe", |c| {
            (c.isotropic, c.two_sided) = (true, true);
            // "1.25 scale is used to (roughly) preserve albedo"
            c.energy_conserving = p.text("lobe") != "fake-ss";
        })
        .grey())
    })
    .choice("lobe", &["diffuse", "fake-ss", "retro", "sheen", "clearcoat"], "which of them")
    .number("roughness", 0.5, 0.0..=1.0, "of the base")
    .only_when("lobe", &["fake-ss", "retro"])
    .number("gloss", 0.1, 0.001..=0.1, "α of the coat's distribution")
    .only_when("lobe", &["clearcoat"]);

    let hair = Model::new("pbrt-hair", "rs_pbrt: HairBSDF", |p| {
        let of = |name: &str| p.number(name) as f32;
        let make = |_, scale| {
            let sigma = colour(p.number("sigma_a"));
            Bxdf::Hair(HairBSDF::new(of("h"), 1.55, sigma, of("beta_m"), of("beta_n"), of("tilt"), scale))
        };
        Ok(lobe(p, make, "pbrt-hair", |c| {
            c.transmissive = true;
            // A_p depends on the angle of wo alone (d'Eon et al. 2011).
            c.reciprocal = false;
        }))
    })
    .number("h", 0.3, -1.0..=1.0, "offset across the fibre")
    .number("sigma_a", 0.3, 0.0..=10.0, "absorption in red; green 3/4, blue 1/2 of it")
    .number("beta_m", 0.3, 0.05..=1.0, "roughness along the fibre")
    .number("beta_n", 0.3, 0.05..=1.0, "roughness around the fibre")
    .number("tilt", 2.0, 0.0..=10.0, "of the scales, degrees");

    let fourier = Model::new("pbrt-fourier", "rs_pbrt: FourierBSDF of a table made here", |p| {
        let table = Arc::new(table(p.number("reflectance"), p.number("lean")));
        let make = |mode, scale| Bxdf::Fourier(FourierBSDF::new(table.clone(), mode, scale));
        let mut client = lobe(p, make, "pbrt-fourier", |c| {
            (c.isotropic, c.transmissive, c.reciprocal) = (true, true, false);
        });
        client.description = client.description.table(Table::default());
        Ok(client.grey())
    })
    .number("reflectance", 0.8, 0.0..=1.0, "ρ")
    .number("lean", 0.5, 0.0..=1.0, "g");

    [disney, hair, fourier].into_iter().map(lobe_model).collect()
}

fn texture(value: f64) -> Arc<ConstantTexture<Rgb>> {
    Arc::new(ConstantTexture::new(white(value)))
}

fn with_roughness(model: Model) -> Model {
    model.number("alpha", 0.3, 0.0..=1.0, "roughness; 0: smooth, where it can be").role(Role::Roughness)
}

fn materials() -> Vec<Model> {
    let glass = Model::new("pbrt-glass", "rs_pbrt: GlassMaterial", |p| {
        let (alpha, eta) = (p.number("alpha"), p.number("eta"));
        let mut scene = scene(
            &[("uroughness", alpha), ("vroughness", alpha), ("eta", eta)],
            &[("Kr", white(1.0)), ("Kt", white(1.0))],
        );
        material("pbrt-glass", &GlassMaterial::create(&mut scene), |c| {
            (c.isotropic, c.lossless) = (true, alpha == 0.0);
            refracts(c, eta);
        })
        .map(Client::grey)
    });
    let plastic = Model::new("pbrt-plastic", "rs_pbrt: PlasticMaterial", |p| {
        let mut scene = scene(
            &[("roughness", p.number("alpha"))],
            &[("Kd", colour(p.number("kd"))), ("Ks", white(p.number("ks")))],
        );
        material("pbrt-plastic", &PlasticMaterial::create(&mut scene), |c| {
            (c.isotropic, c.two_sided) = (true, true);
        })
    })
    .number("kd", 0.5, 0.0..=1.0, "red of the base; green 3/4, blue 1/2 of it")
    .number("ks", 0.5, 0.0..=1.0, "strength of the reflection")
    .number("alpha", 0.3, 0.001..=1.0, "roughness");
    let translucent = Model::new("pbrt-translucent", "rs_pbrt: TranslucentMaterial", |p| {
        let mut scene = scene(
            &[("roughness", p.number("alpha"))],
            &[
                ("Kd", white(p.number("kd"))),
                ("Ks", white(p.number("ks"))),
                ("reflect", white(0.5)),
                ("transmit", white(0.5)),
            ],
        );
        material("pbrt-translucent", &TranslucentMaterial::create(&mut scene), |c| {
            c.isotropic = true;
            refracts(c, 1.5);
        })
    })
    .number("kd", 0.25, 0.0..=1.0, "strength of the diffuse lobes")
    .number("ks", 0.25, 0.0..=1.0, "strength of the glossy lobes")
    .number("alpha", 0.3, 0.001..=1.0, "roughness")
    .only_if("ks > 0", |p| p.number("ks") > 0.0);
    let uber = Model::new("pbrt-uber", "rs_pbrt: UberMaterial", |p| {
        let mut scene = scene(
            &[("roughness", p.number("alpha")), ("eta", 1.5)],
            &[
                ("Kd", white(p.number("kd"))),
                ("Ks", white(p.number("ks"))),
                ("Kr", white(p.number("kr"))),
                ("Kt", white(0.0)),
                ("opacity", white(p.number("opacity"))),
            ],
        );
        material("pbrt-uber", &UberMaterial::create(&mut scene), |c| {
            c.isotropic = true;
            c.transmissive = p.number("opacity") < 1.0;
        })
    })
    .number("kd", 0.25, 0.0..=1.0, "strength of the diffuse lobe")
    .number("ks", 0.25, 0.0..=1.0, "strength of the glossy lobe")
    .number("kr", 0.0, 0.0..=1.0, "strength of the mirror")
    .number("opacity", 1.0, 0.0..=1.0, "what is let through unseen is the rest")
    .number("alpha", 0.3, 0.001..=1.0, "roughness")
    .only_if("ks > 0", |p| p.number("ks") > 0.0);

    vec![with_eta(with_roughness(glass)), plastic, translucent, uber, disney_material(), mix()]
}

fn disney_material() -> Model {
    const NUMBERS: [(&str, f64, &str); 6] = [
        ("roughness", 0.5, "square root of α"),
        ("metallic", 0.0, "blends to a metal"),
        ("anisotropic", 0.0, "how far the lobe is stretched"),
        ("sheen", 0.0, "strength of the sheen"),
        ("clearcoat", 0.0, "strength of the coat"),
        ("spectrans", 0.0, "blends to glass"),
    ];
    let model = Model::new("pbrt-disney", "rs_pbrt: DisneyMaterial", |p| {
        let mut numbers: Vec<_> = NUMBERS.iter().map(|(name, ..)| (*name, p.number(name))).collect();
        numbers.extend([("eta", 1.5), ("clearcoatgloss", 0.0)]);
        let mut scene = scene(&numbers, &[("color", colour(p.number("color")))]);
        material("pbrt-disney", &DisneyMaterial::create(&mut scene), |c| {
            c.isotropic = p.number("anisotropic") == 0.0;
            if p.number("spectrans") > 0.0 {
                refracts(c, 1.5);
            }
        })
    })
    .number("color", 0.8, 0.0..=1.0, "red of the colour; green 3/4, blue 1/2 of it");
    NUMBERS.iter().fold(model, |m, (name, default, doc)| m.number(name, *default, 0.0..=1.0, doc).idle())
}

fn mix() -> Model {
    Model::new("pbrt-mix", "rs_pbrt: MixMaterial of plastic and smooth glass", |p| {
        let mut plastic = scene(&[("roughness", 0.3)], &[("Kd", white(0.5)), ("Ks", white(0.5))]);
        let mut glass = scene(&[("eta", 1.5)], &[("Kr", white(1.0)), ("Kt", white(1.0))]);
        let (first, second) = (PlasticMaterial::create(&mut plastic), GlassMaterial::create(&mut glass));
        let mixed = Material::Mix(Box::new(MixMaterial::new(first, second, texture(p.number("amount")))));
        material("pbrt-mix", &mixed, |c| {
            c.isotropic = true;
            refracts(c, 1.5);
        })
    })
    .number("amount", 0.5, 0.0..=1.0, "of the plastic")
}

/// Its distributions of normals. `sampling` is gonio's parameter here.
struct Normals {
    all: MicrofacetDistribution,
    visible: MicrofacetDistribution,
    is_isotropic: bool,
}

impl NormalDistribution for Normals {
    fn describe(&self) -> Description {
        Description::new("pbrt-normals")
            .dimensions(2)
            .precision(Precision::F32)
            .claims(|c| c.isotropic = self.is_isotropic)
    }
    /// D is the same on both sides.
    fn density(&self, m: Direction) -> f64 {
        if m.z > 0.0 { self.all.d(&vector(m)).into() } else { 0.0 }
    }
    /// It knows the direction alone.
    fn g1(&self, w: Direction, m: Direction) -> f64 {
        if w.dot(m) > 0.0 { self.all.g1(&vector(w)).into() } else { 0.0 }
    }
    fn sample(&self, u: &[f64]) -> Direction {
        let up = Vector3f { x: 0.0, y: 0.0, z: 1.0 };
        direction(self.all.sample_wh(&up, &point(u)))
    }
    fn pdf(&self, m: Direction) -> f64 {
        let up = Vector3f { x: 0.0, y: 0.0, z: 1.0 };
        if m.z > 0.0 { self.all.pdf(&up, &vector(m)).into() } else { 0.0 }
    }
    fn draws_visible(&self) -> bool {
        true
    }
    fn sample_visible(&self, wo: Direction, u: &[f64]) -> Option<Direction> {
        Some(direction(self.visible.sample_wh(&vector(wo), &point(u))))
    }
    /// It takes |wo·m|: reflection asks for none that faces away.
    fn visible_pdf(&self, wo: Direction, m: Direction) -> f64 {
        if m.z > 0.0 && wo.dot(m) > 0.0 { self.visible.pdf(&vector(wo), &vector(m)).into() } else { 0.0 }
    }
    fn lambda(&self, w: Direction) -> Option<f64> {
        Some(self.all.lambda(&vector(w)).into())
    }
}

/// Its Fresnel functions.
struct Reflectance {
    fresnel: Fresnel,
    eta: Option<f64>,
}

impl FresnelFunction for Reflectance {
    fn describe(&self) -> Description {
        let description = described("pbrt-fresnel", |c| {
            c.eta = self.eta;
            c.transmissive = self.eta.is_some();
        });
        if self.eta.is_some() { description.channels(["value"]) } else { description }
    }
    fn reflectance(&self, cos: f64) -> Spectrum {
        spectrum(self.fresnel.evaluate(cos as f32), if self.eta.is_some() { 1 } else { 3 })
    }
}

fn parts() -> Vec<Model> {
    let normals =
        with_alpha(Model::distribution("pbrt-normals", "rs_pbrt: its distributions of normals", |p| {
            Ok(Normals { all: facets(p, false), visible: facets(p, true), is_isotropic: is_isotropic(p) })
        }))
        .choice("distribution", &["trowbridge-reitz", "beckmann"], "of facet normals");

    let fresnel = with_fresnel(Model::fresnel("pbrt-fresnel", "rs_pbrt: its Fresnel functions", |p| {
        let eta = (p.text("fresnel") == "dielectric").then(|| p.number("eta"));
        Ok(Reflectance { fresnel: fresnel(p), eta })
    }));

    vec![normals, fresnel]
}

/// All of its models.
pub fn models() -> Vec<Model> {
    [smooth_lobes(), facet_lobes(), special_lobes(), materials(), parts()].concat()
}
