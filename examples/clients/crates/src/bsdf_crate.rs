//! The crate `bsdf` 0.1.1, in f64.
//!
//! Its conventions are gonio's: the normal is +z, both directions point away,
//! the cosine is left out. It has no word for "no sample": what falls off the
//! support comes with pdf > 0 and the value 0. A sampler returns a value and a
//! density, and the weight is made of them here, so that `weight` says whether
//! that value is the one which `evaluate` gives.

use ::bsdf::conductive::Conductive;
use ::bsdf::disney::Disney;
use ::bsdf::emissive::Emissive;
use ::bsdf::ggx::GGX;
use ::bsdf::lambert::Lambert;
use ::bsdf::mix::Mix;
use ::bsdf::rough_glass::RoughGlass;
use ::bsdf::{BSDF, RgbD, RgbF, SampleIncomingResponse, SampleOutgoingResponse, Vec3d};
use gonio::bsdf::{
    Bsdf, Claims, Description, Direction, Lobe, NormalDistribution, OffSupport, Sample, Spectrum, Transport,
    TransportModes,
};
use gonio::registry::{Model, Parameters, Role};

type Material = Box<dyn BSDF + Send + Sync>;

/// Which of its functions stand for radiance.
#[derive(Clone, Copy, PartialEq)]
enum Reading {
    /// As documented: `evaluate` and `sample_incoming` are what a path from the
    /// eye needs.
    Documented,
    /// As the values are: `evaluate` is without (η_o/η_i)², which makes it the
    /// importance, and `sample_outgoing` gives the radiance.
    Swapped,
}

/// One of its materials.
struct Client {
    material: Material,
    reading: Reading,
    description: Description,
}

fn vector(w: Direction) -> Vec3d {
    Vec3d::new(w.x, w.y, w.z)
}

fn spectrum(f: RgbD) -> Spectrum {
    Spectrum::from_fn(3, |k| f[k])
}

impl Client {
    /// Whether the given direction is the crate's `omega_i`.
    fn is_turned(&self, transport: Transport) -> bool {
        self.reading == Reading::Swapped && transport == Transport::Radiance
    }
}

impl Bsdf for Client {
    fn describe(&self) -> Description {
        self.description.clone()
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> Spectrum {
        let (given, other) = (vector(wo), vector(wi));
        spectrum(if self.is_turned(transport) {
            self.material.evaluate(other, given)
        } else {
            self.material.evaluate(given, other)
        })
    }

    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        let (given, other) = (vector(wo), vector(wi));
        if self.is_turned(transport) {
            self.material.sample_outgoing_pdf(other, given)
        } else {
            self.material.sample_incoming_pdf(given, other)
        }
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        let u = Vec3d::new(u[0], u[1], u[2]);
        let (w, f, pdf) = if self.is_turned(transport) {
            let s = self.material.sample_outgoing(vector(wo), u);
            (s.omega_o, s.bsdf, s.pdf)
        } else {
            let s = self.material.sample_incoming(vector(wo), u);
            (s.omega_i, s.bsdf, s.pdf)
        };
        if w == Vec3d::ZERO {
            return None; // absorbed
        }
        let wi = Direction { x: w.x, y: w.y, z: w.z };
        // 0/0 where nothing is scattered.
        let weight = if f == RgbD::ZERO { RgbD::ZERO } else { f * (w.z.abs() / pdf) };
        let side = if wo.same_side(wi) { Lobe::REFLECTION } else { Lobe::TRANSMISSION };
        Some(Sample { wi, weight: spectrum(weight), pdf, lobe: Lobe(side.0 | Lobe::GLOSSY.0) })
    }
}

fn client(
    name: &str,
    material: impl BSDF + Send + Sync + 'static,
    reading: Reading,
    claims: impl FnOnce(&mut Claims),
) -> Client {
    let description = Description::new(name).channels(["r", "g", "b"]).claims(|c| {
        c.off_support = OffSupport::ZeroWeight;
        claims(c);
        if reading == Reading::Swapped {
            c.transport = TransportModes::Both;
        }
    });
    Client { material: Box::new(material), reading, description }
}

fn reading(p: &Parameters) -> Reading {
    match p.text("reading") {
        "swapped" => Reading::Swapped,
        _ => Reading::Documented,
    }
}

fn with_reading(model: Model) -> Model {
    model.choice("reading", &["documented", "swapped"], "which functions are radiance").idle()
}

fn with_ggx(model: Model) -> Model {
    with_stretch(model.number("roughness", 0.5, 0.0..=1.0, "square root of α").role(Role::Roughness))
}

fn with_stretch(model: Model) -> Model {
    model.number("anisotropic", 0.0, 0.0..=1.0, "how far the lobe is stretched")
}

fn ggx(p: &Parameters) -> GGX {
    GGX::from_remapped(p.number("roughness"), p.number("anisotropic"))
}

/// A colour with three different channels.
fn colour(value: f64) -> RgbF {
    RgbF::new(value as f32, (0.75 * value) as f32, (0.5 * value) as f32)
}

fn lambert(value: f64) -> Lambert {
    Lambert { kd: colour(value) }
}

fn conductive(colour_of: f64, ggx: GGX, ior: f64) -> Conductive {
    Conductive { color: colour(colour_of), ggx, ior: ior as f32 }
}

/// Its trait for a material chosen at run time.
struct Any(Material);

impl BSDF for Any {
    fn sample_incoming(&self, omega_o: Vec3d, u: Vec3d) -> SampleIncomingResponse {
        self.0.sample_incoming(omega_o, u)
    }
    fn sample_outgoing(&self, omega_i: Vec3d, u: Vec3d) -> SampleOutgoingResponse {
        self.0.sample_outgoing(omega_i, u)
    }
    fn evaluate(&self, omega_o: Vec3d, omega_i: Vec3d) -> RgbD {
        self.0.evaluate(omega_o, omega_i)
    }
    fn sample_incoming_pdf(&self, omega_o: Vec3d, omega_i: Vec3d) -> f64 {
        self.0.sample_incoming_pdf(omega_o, omega_i)
    }
    fn sample_outgoing_pdf(&self, omega_o: Vec3d, omega_i: Vec3d) -> f64 {
        self.0.sample_outgoing_pdf(omega_o, omega_i)
    }
    fn emission(&self, omega_o: Vec3d) -> RgbD {
        self.0.emission(omega_o)
    }
    fn base_color(&self, omega_o: Vec3d) -> RgbD {
        self.0.base_color(omega_o)
    }
}

const IOR: f64 = 1.5;

fn part(name: &str) -> Any {
    let rough = GGX::from_remapped(0.5, 0.0);
    Any(match name {
        "conductive" => Box::new(conductive(0.9, rough, IOR)),
        "rough-glass" => Box::new(RoughGlass { ggx: rough, ior: IOR }),
        "emissive" => Box::new(Emissive { emission: RgbF::ONE }),
        _ => Box::new(lambert(0.8)),
    })
}

fn mix(p: &Parameters) -> Client {
    let names = [p.text("first"), p.text("second")];
    let mixed = Mix { b1: part(names[0]), b2: part(names[1]), factor: p.number("factor") as f32 };
    client("bsdf-mix", mixed, reading(p), |c| {
        c.isotropic = true;
        c.transmissive = names.contains(&"rough-glass");
        c.two_sided = !c.transmissive;
        c.eta = c.transmissive.then_some(IOR);
    })
}

fn disney(p: &Parameters) -> Client {
    let of = |name: &str| p.number(name) as f32;
    let material = Disney {
        base_color: colour(p.number("base_color")),
        emission: RgbF::ZERO,
        roughness: of("roughness"),
        anisotropic: of("anisotropic"),
        specular: of("specular"),
        anisotropic_rotation: of("rotation"),
        sheen: of("sheen"),
        sheen_tint: of("sheen_tint"),
        metallic: of("metallic"),
        clearcoat: of("clearcoat"),
        clearcoat_roughness: of("clearcoat_roughness"),
        transmission: of("transmission"),
        ior: of("ior"),
    };
    client("bsdf-disney", material, reading(p), |c| {
        c.isotropic = material.anisotropic == 0.0;
        c.transmissive = material.transmission > 0.0;
        c.two_sided = !c.transmissive;
        c.eta = c.transmissive.then_some(f64::from(material.ior));
    })
}

fn disney_model() -> Model {
    let model = Model::new("bsdf-disney", "crate bsdf: Disney", |p| Ok(disney(p))).number(
        "base_color",
        0.8,
        0.0..=1.0,
        "red of the base colour; green 3/4, blue 1/2 of it",
    );
    let model =
        with_stretch(model.number("roughness", 0.5, 0.0..=1.0, "square root of the specular lobe's α"))
            .idle()
            .number("rotation", 0.0, 0.0..=1.0, "turns the stretched lobe, in units of 180°")
            .idle();
    let model = [
        ("specular", 0.5, "strength of the reflection"),
        ("sheen", 0.0, "strength of the sheen"),
        ("sheen_tint", 0.0, "how much the sheen takes the base colour"),
        ("metallic", 0.0, "blends to a metal"),
        ("clearcoat", 0.0, "strength of the coat"),
        ("clearcoat_roughness", 0.3, "square root of the coat's α"),
        ("transmission", 0.0, "blends to glass"),
    ]
    .into_iter()
    .fold(model, |m, (name, default, doc)| m.number(name, default, 0.0..=1.0, doc).idle());
    with_reading(model.number("ior", 1.45, 1.1..=2.5, "of what is below, where light is transmitted").idle())
}

/// Its distribution of normals.
struct Normals(GGX);

impl NormalDistribution for Normals {
    fn describe(&self) -> Description {
        Description::new("bsdf-ggx").dimensions(2).claims(|c| c.isotropic = self.0.alpha_x == self.0.alpha_y)
    }
    fn density(&self, m: Direction) -> f64 {
        self.0.ndf(vector(m))
    }
    fn g1(&self, w: Direction, m: Direction) -> f64 {
        self.0.shadowing(vector(w), vector(m))
    }
    /// It has no way to draw them all but to look from above, where every normal
    /// is visible.
    fn sample(&self, u: &[f64]) -> Direction {
        self.sample_visible(Direction { x: 0.0, y: 0.0, z: 1.0 }, u).expect("always one")
    }
    fn draws_visible(&self) -> bool {
        true
    }
    fn sample_visible(&self, wo: Direction, u: &[f64]) -> Option<Direction> {
        let m = self.0.sample_vndf(vector(wo), u[0], u[1]);
        Some(Direction { x: m.x, y: m.y, z: m.z })
    }
    fn visible_pdf(&self, wo: Direction, m: Direction) -> f64 {
        self.0.vndf(vector(wo), vector(m))
    }
}

/// All of its models.
pub fn models() -> Vec<Model> {
    let lambert = Model::new("bsdf-lambert", "crate bsdf: Lambert", |p| {
        Ok(client("bsdf-lambert", lambert(p.number("kd")), Reading::Documented, |c| {
            (c.isotropic, c.two_sided) = (true, true);
        }))
    })
    .number("kd", 0.8, 0.0..=1.0, "red of the colour; green 3/4, blue 1/2 of it");

    let conductive = Model::new("bsdf-conductive", "crate bsdf: Conductive", |p| {
        let ggx = ggx(p);
        let material = conductive(p.number("color"), ggx, p.number("ior"));
        Ok(client("bsdf-conductive", material, Reading::Documented, |c| {
            (c.isotropic, c.two_sided) = (ggx.alpha_x == ggx.alpha_y, true);
        }))
    })
    .number("color", 0.8, 0.0..=1.0, "red of the colour at the normal; green 3/4, blue 1/2 of it")
    .number("ior", 1.5, 1.0..=2.0, "how fast it turns white towards grazing");

    let glass = Model::new("bsdf-rough-glass", "crate bsdf: RoughGlass", |p| {
        let (ggx, ior) = (ggx(p), p.number("ior"));
        Ok(client("bsdf-rough-glass", RoughGlass { ggx, ior }, reading(p), |c| {
            c.isotropic = ggx.alpha_x == ggx.alpha_y;
            (c.transmissive, c.eta) = (true, Some(ior));
        }))
    })
    .number("ior", 1.5, 0.5..=2.5, "of what is below over what is above")
    .role(Role::Eta);

    let mix = Model::new("bsdf-mix", "crate bsdf: Mix of two materials", |p| Ok(mix(p)))
        .choice("first", &["lambert", "conductive", "rough-glass", "emissive"], "at factor 0")
        .idle()
        .choice("second", &["conductive", "lambert", "rough-glass", "emissive"], "at factor 1")
        .idle()
        .number("factor", 0.3, 0.0..=1.0, "share of the second")
        .idle();

    let emissive = Model::new("bsdf-emissive", "crate bsdf: Emissive, which scatters nothing", |_| {
        Ok(client("bsdf-emissive", Emissive { emission: RgbF::ONE }, Reading::Documented, |c| {
            (c.isotropic, c.two_sided) = (true, true);
        }))
    });

    let normals = with_ggx(Model::distribution("bsdf-ggx", "crate bsdf: GGX", |p| Ok(Normals(ggx(p)))));

    vec![
        lambert,
        with_ggx(conductive),
        with_reading(with_ggx(glass)),
        with_reading(mix),
        emissive,
        disney_model(),
        normals,
    ]
}
