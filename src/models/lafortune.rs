//! Lafortune's generalised cosine lobes.

use super::lambert::sample_cosine;
use super::{cosine_lobe, mixture};
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use crate::registry::{Model, Parameters};
use std::f64::consts::{PI, TAU};

/// How many lobes the registered model has, besides the diffuse one.
const LOBES: usize = 3;

/// One lobe, ρ (n + 2)/2π (cx wo.x wi.x + cy wo.y wi.y + cz wo.z wi.z)ⁿ. In the
/// paper, ρ (n + 2)/2π is a factor of the c's; taken out, cx = cy = −1, cz = 1 is
/// the modified Phong lobe of reflectance ρ. A smaller cz moves the peak towards
/// grazing (off-specular), cx = cy > 0 makes a retro-reflective lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeneralisedCosine {
    /// ρ ≥ 0.
    pub rho: f64,
    /// The c's, by which wo is scaled to the lobe's axis.
    pub c: Direction,
    /// n ≥ 0.
    pub exponent: f64,
}

impl GeneralisedCosine {
    /// wo transformed: the axis of the lobe, of a length that scales it.
    #[inline]
    fn axis(&self, wo: Direction) -> Direction {
        Direction::new(self.c.x * wo.x, self.c.y * wo.y, self.c.z * wo.z)
    }

    #[inline]
    fn value(&self, wo: Direction, wi: Direction) -> f64 {
        if self.rho == 0.0 {
            return 0.0;
        }
        self.rho * (self.exponent + 2.0) / TAU * cosine_lobe::power(self.axis(wo).dot(wi), self.exponent)
    }

    /// Density of a draw about the axis.
    #[inline]
    fn density(&self, wo: Direction, wi: Direction) -> f64 {
        let axis = self.axis(wo);
        cosine_lobe::density(axis.dot(wi) / axis.length(), self.exponent)
    }

    /// ρ |axis|ⁿ: the reflectance if the axis were the normal.
    #[inline]
    fn reflectance(&self, wo: Direction) -> f64 {
        self.rho * cosine_lobe::power(self.axis(wo).length(), self.exponent)
    }

    /// The largest albedo that it may have: |axis| is at most the largest |c|, and
    /// a lobe of given axis length reflects most along the normal (see `phong`).
    fn bound(&self) -> f64 {
        let largest = self.c.x.abs().max(self.c.y.abs()).max(self.c.z.abs());
        self.rho * cosine_lobe::power(largest, self.exponent)
    }
}

/// f = ρd/π + Σ lobes on the front side (E. P. F. Lafortune, S.-C. Foo, K. E.
/// Torrance and D. P. Greenberg, *Non-linear approximation of reflectance
/// functions*, SIGGRAPH 1997, eq. 6). Each lobe is drawn about its axis, with a share
/// of its reflectance at wo; draws below the horizon are no sample.
///
/// Reciprocal by its form. It conserves energy by its parameters only: that is
/// claimed where ρd + Σ ρ max|c|ⁿ ≤ 1, which suffices and is not necessary.
#[derive(Clone, Debug)]
pub struct Lafortune {
    diffuse: f64,
    lobes: [GeneralisedCosine; LOBES],
}

/// The registered model `lafortune`.
pub(super) fn model() -> Model {
    let lobe = |p: &Parameters, k: usize| {
        let number = |name: &str| p.number(&format!("{name}{k}"));
        GeneralisedCosine {
            rho: number("rho"),
            c: Direction::new(number("cx"), number("cy"), number("cz")),
            exponent: number("n"),
        }
    };
    let model = Model::new(
        "lafortune",
        "diffuse and up to three generalised cosine lobes (Lafortune et al. 1997)",
        move |p| Ok(Lafortune::new(p.number("kd"), [lobe(p, 1), lobe(p, 2), lobe(p, 3)])),
    )
    .number("kd", 0.3, 0.0..=1.0, "share of the light that is reflected diffusely");
    // An off-specular lobe, a retro-reflective one, and a forward one at grazing.
    let lobes: [(_, fn(&Parameters) -> bool, _); LOBES] = [
        ("rho1 > 0", |p| p.number("rho1") > 0.0, [0.4, -1.0, -1.0, 0.8, 20.0]),
        ("rho2 > 0", |p| p.number("rho2") > 0.0, [0.15, 0.9, 0.9, 0.9, 8.0]),
        ("rho3 > 0", |p| p.number("rho3") > 0.0, [0.1, -1.0, -1.0, 0.3, 60.0]),
    ];
    lobes.into_iter().enumerate().fold(model, |model, (k, (words, lit, defaults))| {
        let name = |letter: &str| format!("{letter}{}", k + 1);
        let [rho, cx, cy, cz, n] = defaults;
        let c = |model: Model, letter, default, doc| {
            model.number(&name(letter), default, -1.2..=1.2, doc).only_if(words, lit)
        };
        let model = model.number(&name("rho"), rho, 0.0..=1.0, "ρ of the lobe; 0: no such lobe");
        let model = c(model, "cx", cx, "scale of x: −1 for a mirror, 1 for a retro-reflector");
        let model = c(model, "cy", cy, "scale of y");
        let model = c(model, "cz", cz, "scale of z: below |cx|, the peak moves towards grazing");
        let doc = "exponent: the larger, the narrower the lobe";
        model.number(&name("n"), n, 0.0..=1000.0, doc).only_if(words, lit)
    })
}

impl Lafortune {
    /// Over a diffuse part of reflectance `diffuse` ≥ 0.
    pub fn new(diffuse: f64, lobes: [GeneralisedCosine; LOBES]) -> Self {
        Self { diffuse, lobes }
    }

    /// The diffuse part's share, and the lobes'.
    #[inline]
    fn shares(&self, wo: Direction) -> [f64; LOBES + 1] {
        let [a, b, c] = self.lobes.map(|lobe| lobe.reflectance(wo));
        mixture::shares([self.diffuse, a, b, c])
    }

    /// An upper bound of the albedo in all directions.
    pub fn albedo_bound(&self) -> f64 {
        self.diffuse + self.lobes.iter().map(GeneralisedCosine::bound).sum::<f64>()
    }
}

impl Bsdf for Lafortune {
    fn describe(&self) -> Description {
        Description::new("lafortune").dimensions(2).claims(|c| {
            c.isotropic = self.lobes.iter().all(|l| l.rho == 0.0 || l.c.x == l.c.y);
            // Sums such as 0.9 + 0.1 may round to more than 1.
            c.energy_conserving = self.albedo_bound() <= 1.0 + 4.0 * f64::EPSILON;
            c.lossless = self.diffuse == 1.0 && self.lobes.iter().all(|l| l.rho == 0.0);
        })
    }

    #[inline]
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::zero(1);
        }
        let lobes: f64 = self.lobes.iter().map(|lobe| lobe.value(wo, wi)).sum();
        Spectrum::from(self.diffuse / PI + lobes)
    }

    #[inline]
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let [diffuse, lobes @ ..] = self.shares(wo);
        let lobes = self.lobes.iter().zip(lobes).filter(|(_, share)| *share > 0.0);
        diffuse * wi.z / PI + lobes.map(|(lobe, share)| share * lobe.density(wo, wi)).sum::<f64>()
    }

    #[inline]
    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z <= 0.0 {
            return None;
        }
        let (chosen, first) = mixture::choose(self.shares(wo), u[0]);
        let (wi, lobe) = if chosen == 0 {
            (sample_cosine(&[first, u[1]]), Lobe::DIFFUSE_REFLECTION)
        } else {
            let lobe = &self.lobes[chosen - 1];
            let axis = lobe.axis(wo).normalized();
            (cosine_lobe::sample(axis, lobe.exponent, &[first, u[1]]), Lobe::GLOSSY_REFLECTION)
        };
        let pdf = Bsdf::pdf(self, wo, wi, transport);
        let weight = Bsdf::eval(self, wo, wi, transport) * (wi.z / pdf);
        (pdf > 0.0).then_some(Sample { wi, weight, pdf, lobe })
    }

    fn hints(&self, wo: Direction) -> Vec<Direction> {
        let axes = self.lobes.iter().filter(|l| l.reflectance(wo) > 0.0).map(|l| l.axis(wo).normalized());
        axes.collect()
    }
}
