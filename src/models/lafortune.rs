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
    type Lit = fn(&Parameters) -> bool;
    let lobes: [(_, Lit, _); LOBES] = [
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::Phong;
    use crate::models::brute_force::{albedo, assert_sound};

    const R: Transport = Transport::Radiance;
    const DARK: GeneralisedCosine =
        GeneralisedCosine { rho: 0.0, c: Direction::new(-1.0, -1.0, 1.0), exponent: 1.0 };

    fn lobe(rho: f64, c: [f64; 3], exponent: f64) -> GeneralisedCosine {
        GeneralisedCosine { rho, c: c.into(), exponent }
    }

    #[test]
    fn with_a_mirror_lobe_it_is_phong() {
        let model = Lafortune::new(0.3, [lobe(0.6, [-1.0, -1.0, 1.0], 12.0), DARK, DARK]);
        let phong = Phong::new(0.3, 0.6, 12.0).unwrap();
        for (theta, phi) in [(0.2, 0.4), (0.9, 3.3), (1.4, 2.0)] {
            let (wo, wi) = (Direction::from_angles(0.9, 0.1), Direction::from_angles(theta, phi));
            let error = model.eval(wo, wi, R)[0] / phong.eval(wo, wi, R)[0] - 1.0;
            assert!(error.abs() < 1e-13, "{error}");
            assert!((model.pdf(wo, wi, R) / phong.pdf(wo, wi, R) - 1.0).abs() < 1e-13);
        }
    }

    /// A lobe of axis length l reflects lⁿ as much as one of unit length.
    #[test]
    fn albedo_at_normal_incidence_is_as_in_closed_form() {
        let lobes = [lobe(0.2, [-1.0, -1.0, 0.9], 10.0), lobe(0.1, [0.5, 0.5, 1.1], 3.0), DARK];
        let expected = 0.3 + 0.2 * 0.9f64.powi(10) + 0.1 * 1.1f64.powi(3);
        let a = albedo(&Lafortune::new(0.3, lobes), Direction::NORMAL, 0);
        assert!((a - expected).abs() < 2e-5, "{a} {expected}");
    }

    /// The off-specular lobe peaks nearer to grazing than the mirror, the
    /// retro-reflective one at wo.
    #[test]
    fn lobes_point_where_they_should() {
        let wo = Direction::from_angles(1.0, 0.4);
        assert!(lobe(1.0, [-1.0, -1.0, 0.6], 20.0).axis(wo).theta() > 1.1);
        assert!(lobe(1.0, [0.9, 0.9, 0.9], 8.0).axis(wo).angle(wo) < 1e-12);
    }

    #[test]
    fn energy_is_claimed_within_the_bound_only() {
        let off = lobe(0.6, [-1.0, -1.0, 0.5], 20.0);
        let safe = Lafortune::new(0.4, [off, DARK, DARK]);
        assert!(safe.describe().claims.energy_conserving);
        for theta in [0.0, 0.5, 1.0, 1.3, 1.5] {
            assert!(albedo(&safe, Direction::from_angles(theta, 0.2), 0) <= safe.albedo_bound() + 1e-5);
        }
        // A c above 1 makes up for ρ: at 1.1²⁰ it is 6.7 times as bright.
        let bright = Lafortune::new(0.4, [lobe(0.3, [-1.0, -1.0, 1.1], 20.0), DARK, DARK]);
        assert!(!bright.describe().claims.energy_conserving);
        assert!(albedo(&bright, Direction::NORMAL, 0) > 2.0);
    }

    #[test]
    fn edges_are_sound() {
        let lobes = [lobe(0.4, [-1.0, -1.0, 0.8], 20.0), lobe(0.1, [0.0, 0.0, -1.0], 4.0), DARK];
        assert_sound(&Lafortune::new(0.3, lobes));
        assert_sound(&Lafortune::new(0.0, [lobe(0.1, [0.0; 3], 1000.0), DARK, DARK]));
    }
}
