//! The whole command line of gonio for a BSDF of your own: register it beside
//! the built-in models and hand the registry to [`gonio::main`].
//!
//! ```text
//! cargo run --release --example own_command -- list paper
//! cargo run --release --example own_command -- check paper:k=2
//! cargo run --release --example own_command -- check paper-nan
//! cargo run --release --example own_command -- check hemispheres
//! cargo run --release --example own_command -- check film
//! ```

use gonio::bsdf::{
    Bsdf, Description, Direction, FresnelFunction, Lobe, NormalDistribution, Sample, Spectrum, Transport,
};
use gonio::registry::{Model, Parameters, Registry};
use std::f64::consts::PI;
use std::process::ExitCode;
use std::time::Duration;

fn main() -> ExitCode {
    let registry = Registry::builtin()
        .register(model("paper", "none"))
        .register(Model::distribution("hemispheres", "a surface of half spheres", |_| Ok(Hemispheres)))
        .register(
            Model::fresnel("film", "Schlick's approximation over a film that absorbs", |p| {
                Ok(Film { f0: p.number("f0"), absorption: p.number("absorption") })
            })
            .number("f0", 0.04, 0.0..=1.0, "reflectance at normal incidence")
            .number("absorption", 0.2, 0.0..=1.0, "of what passes the film"),
        );
    gonio::main(
        DEFECTS.iter().fold(registry, |r, defect| r.register(model(&format!("paper-{defect}"), defect))),
    )
}

/// The model as suites, `check` and `list` know it: a name, a line of words,
/// and parameters with their defaults and ranges. gonio checks what users type
/// against them, and builds one subject for each combination of values.
fn model(name: &str, defect: &'static str) -> Model {
    Model::new(name, "Minnaert's law, as a model of one's own", move |p| Paper::new(p, defect))
        .number("reflectance", 0.6, 0.0..=1.0, "albedo at k = 1, where the law is Lambert's")
        .number("k", 1.5, 1.0..=4.0, "how much darker it gets towards grazing light")
}

/// A matte reflector: f = ρ (k+1)/(2π) (cos θo cos θi)^(k−1).
struct Paper {
    reflectance: f64,
    k: f64,
    defect: &'static str,
}

impl Paper {
    fn new(parameters: &Parameters, defect: &'static str) -> Result<Self, String> {
        Ok(Self { reflectance: parameters.number("reflectance"), k: parameters.number("k"), defect })
    }
}

/// What gonio asks of a BSDF: four functions. Directions are unit vectors away
/// from the surface, whose normal is +z.
impl Bsdf for Paper {
    fn describe(&self) -> Description {
        // What it claims is what it is held to.
        Description::new("paper").dimensions(2).claims(|c| c.isotropic = true)
    }

    /// f, without the cosine.
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::zero(1);
        }
        let f = self.reflectance * (self.k + 1.0) / (2.0 * PI) * (wo.z * wi.z).powf(self.k - 1.0);
        Spectrum::from(self.broken_value(wi, f))
    }

    /// The density of `sample` per steradian: of cosᵏ θ, which f·cos θ goes with.
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let loud = if self.defect == "loud" { 1.02 } else { 1.0 };
        loud * (self.k + 1.0) / (2.0 * PI) * wi.z.powf(self.k)
    }

    /// A direction from two random numbers in [0, 1), with f·cos θ/pdf.
    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        let cos_theta = (1.0 - u[0]).powf(1.0 / (self.k + 1.0));
        let wi = Direction::from_angles(cos_theta.acos(), 2.0 * PI * u[1]);
        let pdf = self.pdf(wo, wi, transport);
        if !(pdf > 0.0) {
            return None;
        }
        let weight = self.eval(wo, wi, transport) * (wi.z / pdf);
        self.broken_sample(u, Sample { wi, weight, pdf, lobe: Lobe::DIFFUSE_REFLECTION })
    }
}

/// The parts of BSDFs can be measured by themselves: a distribution of normals
/// with its masking. Here every normal has as much area: D = 1/π, which is GGX
/// at α = 1.
struct Hemispheres;

impl NormalDistribution for Hemispheres {
    fn describe(&self) -> Description {
        Description::new("hemispheres").dimensions(2).claims(|c| c.isotropic = true)
    }

    fn density(&self, m: Direction) -> f64 {
        if m.z > 0.0 { 1.0 / PI } else { 0.0 }
    }

    /// Of a half sphere's visible area π(1 + cos θ)/2 a view can use π cos θ.
    fn g1(&self, w: Direction, _: Direction) -> f64 {
        2.0 * w.z / (1.0 + w.z)
    }

    fn sample(&self, u: &[f64]) -> Direction {
        Direction::from_angles(u[0].sqrt().asin(), 2.0 * PI * u[1])
    }
}

/// And a Fresnel function: the reflectance by angle.
struct Film {
    f0: f64,
    absorption: f64,
}

impl FresnelFunction for Film {
    fn describe(&self) -> Description {
        Description::new("film")
    }

    fn reflectance(&self, cos: f64) -> Spectrum {
        Spectrum::from(self.f0 + (1.0 - self.f0) * (1.0 - cos).powi(5))
    }

    fn transmittance(&self, cos: f64) -> Option<Spectrum> {
        Some(Spectrum::from((1.0 - self.reflectance(cos)[0]) * (1.0 - self.absorption)))
    }
}

// The rest is not needed for a BSDF of your own, nor is `loud` above: it makes
// `paper` misbehave in every way that gonio must survive and report.

/// How `paper-DEFECT` is broken. Models of their own, not values of a
/// parameter: `sensitivity` tries every value of those.
const DEFECTS: [&str; 9] =
    ["loud", "panics", "nan", "infinite", "negative", "long", "never", "slow", "hangs"];

impl Paper {
    /// Values that are wrong, late or missing.
    fn broken_value(&self, wi: Direction, f: f64) -> f64 {
        let aside = wi.x > 0.6;
        match self.defect {
            "nan" if aside => f64::NAN,
            "infinite" if aside => f64::INFINITY,
            "negative" if aside => -f,
            "slow" => {
                std::thread::sleep(Duration::from_micros(200));
                f
            }
            "hangs" => loop {
                std::thread::sleep(Duration::from_millis(100));
            },
            _ => f,
        }
    }

    /// Samples that are wrong or missing.
    fn broken_sample(&self, u: &[f64], sample: Sample) -> Option<Sample> {
        match self.defect {
            "panics" if u[0] > 0.999 => panic!("no entry {} in a table of 4", (u[0] * 5.0) as usize),
            "long" => Some(Sample { wi: sample.wi * 1.01, ..sample }),
            "never" => None,
            _ => Some(sample),
        }
    }
}
