//! Disney's principled model of 2012.

use super::lambert::sample_cosine;
use super::largest_albedo::largest_albedo;
use super::microfacet::half_vector;
use super::microfacet::{Ggx, Gtr1, Roughness};
use super::mixture;
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use crate::registry::{Model, Parameters};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// What an artist sets, each in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisneyParameters {
    /// Reflectances of the base, linear.
    pub base: [f64; 3],
    /// From the diffuse base to an approximation of subsurface scattering.
    pub subsurface: f64,
    /// From dielectric to metal.
    pub metallic: f64,
    /// Specular reflectance of a dielectric at normal incidence, in units of 0.08.
    pub specular: f64,
    /// How much of the base's hue that has.
    pub specular_tint: f64,
    /// Square root of the mean α.
    pub roughness: f64,
    /// Aspect of the highlight.
    pub anisotropic: f64,
    /// Added at grazing angles, for cloth.
    pub sheen: f64,
    /// How much of the base's hue that has.
    pub sheen_tint: f64,
    /// Strength of the second specular lobe.
    pub clearcoat: f64,
    /// Its smoothness.
    pub clearcoat_gloss: f64,
}

/// The BRDF of B. Burley, *Physically-based shading at Disney*, SIGGRAPH 2012 course
/// notes, §5, on the front side: a diffuse lobe with retro-reflection by roughness,
/// sheen, GTR2 (GGX) with α from the squared roughness, and a clearcoat of GTR1, with
/// Smith's masking of its own roughness, (½ + roughness/2)² and ¼ for the coat, as
/// a product of both directions.
///
/// Reciprocal: every term is symmetric. Its lobes are added to each other, none
/// taking from another, and the retro-reflection of the rough base alone exceeds
/// what arrives, so energy conservation is claimed only of parameters for which the
/// largest albedo, found when it is built, leaves a margin.
#[derive(Clone, Copy, Debug)]
pub struct Disney {
    p: DisneyParameters,
    specular: [f64; 3],
    sheen: [f64; 3],
    distribution: Ggx,
    masking_alpha2: f64,
    pub(crate) coat: Gtr1,
    /// Means over the channels by which lobes are chosen.
    diffuse_mean: f64,
    specular_mean: f64,
    energy_conserving: bool,
}

/// The α of the clearcoat's masking, squared.
const COAT_MASKING_ALPHA2: f64 = 0.25 * 0.25;

/// Reflectance of a clearcoat of index 1.5 at normal incidence.
const COAT_F0: f64 = 0.04;

/// The largest albedo that is safely below 1, given how well it is known.
const SAFE_ALBEDO: f64 = 0.95;

/// The registered model `disney`.
pub(super) fn model() -> Model {
    let unit = |model: Model, name: &str, default, doc| model.number(name, default, 0.0..=1.0, doc);
    let model = Model::new("disney", "the principled BRDF (Burley 2012)", Disney::declared);
    let model = unit(model, "r", 0.65, "red reflectance of the base, linear");
    let model = unit(model, "g", 0.4, "green");
    let model = unit(model, "b", 0.05, "blue");
    let model = unit(model, "metallic", 0.0, "0 dielectric, 1 metal");
    let model =
        unit(model, "subsurface", 0.0, "shape of the diffuse lobe: 1 approximates subsurface scattering")
            .only_if("metallic < 1 and the base is not black", |p| {
                dielectric(p) && ["r", "g", "b"].iter().any(|c| p.number(c) > 0.0)
            });
    let model = unit(model, "specular", 0.5, "reflectance of a dielectric at normal incidence, over 0.08")
        .only_if("metallic < 1", dielectric);
    let model = unit(model, "specular_tint", 0.0, "how much of the base's hue that has")
        .only_if("metallic < 1, specular > 0 and the base has a hue", |p| {
            dielectric(p) && has_hue(p) && p.number("specular") > 0.0
        });
    let model = unit(model, "roughness", 0.5, "α is its square");
    // At less, both α are at their minimum.
    let model = unit(model, "anisotropic", 0.0, "aspect of the highlight: 1 is 1 to 10")
        .only_if("roughness > 0.04", |p| p.number("roughness") > 0.04);
    let model =
        unit(model, "sheen", 0.0, "light added at grazing angles").only_if("metallic < 1", dielectric);
    let model = unit(model, "sheen_tint", 0.5, "how much of the base's hue that has")
        .only_if("metallic < 1, sheen > 0 and the base has a hue", |p| {
            dielectric(p) && has_hue(p) && p.number("sheen") > 0.0
        });
    let model = unit(model, "clearcoat", 0.0, "strength of the second specular lobe, over 0.25");
    unit(model, "clearcoat_gloss", 1.0, "its smoothness: α from 0.1 to 0.001")
        .only_if("clearcoat > 0", |p| p.number("clearcoat") > 0.0)
}

fn dielectric(p: &Parameters) -> bool {
    p.number("metallic") < 1.0
}

fn has_hue(p: &Parameters) -> bool {
    p.number("r") != p.number("g") || p.number("g") != p.number("b")
}

/// From `a` to `b` by `t`.
#[inline]
fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// (1 − cos θ)⁵, the weight of Schlick's term.
#[inline]
fn schlick_weight(cos: f64) -> f64 {
    let m = (1.0 - cos).max(0.0);
    let m2 = m * m;
    m2 * m2 * m
}

/// Smith's masking by GGX over 2 cos θ.
#[inline]
fn masking_over_cosine(cos: f64, alpha2: f64) -> f64 {
    1.0 / (cos + (alpha2 + (1.0 - alpha2) * cos * cos).sqrt())
}

fn mean(values: [f64; 3]) -> f64 {
    values.iter().sum::<f64>() / 3.0
}

impl Disney {
    /// As the registered model reads its parameters.
    pub(crate) fn declared(p: &Parameters) -> Result<Self, String> {
        Ok(Self::new(DisneyParameters {
            base: ["r", "g", "b"].map(|c| p.number(c)),
            subsurface: p.number("subsurface"),
            metallic: p.number("metallic"),
            specular: p.number("specular"),
            specular_tint: p.number("specular_tint"),
            roughness: p.number("roughness"),
            anisotropic: p.number("anisotropic"),
            sheen: p.number("sheen"),
            sheen_tint: p.number("sheen_tint"),
            clearcoat: p.number("clearcoat"),
            clearcoat_gloss: p.number("clearcoat_gloss"),
        }))
    }

    /// From what an artist sets.
    pub fn new(p: DisneyParameters) -> Self {
        // Burley's approximation of luminance.
        let luminance = 0.3 * p.base[0] + 0.6 * p.base[1] + 0.1 * p.base[2];
        let tint = p.base.map(|c| if luminance > 0.0 { c / luminance } else { 1.0 });
        let specular = [0, 1, 2].map(|c| {
            let dielectric = 0.08 * p.specular * mix(1.0, tint[c], p.specular_tint);
            mix(dielectric, p.base[c], p.metallic)
        });
        let sheen = tint.map(|t| p.sheen * mix(1.0, t, p.sheen_tint) * (1.0 - p.metallic));
        let alpha = p.roughness * p.roughness;
        let aspect = (1.0 - 0.9 * p.anisotropic).sqrt();
        let alpha = Roughness { x: (alpha / aspect).max(0.001), y: (alpha * aspect).max(0.001) };
        let mut model = Self {
            p,
            specular,
            sheen,
            distribution: Ggx { alpha },
            masking_alpha2: (0.5 + 0.5 * p.roughness).powi(4),
            coat: Gtr1::new(mix(0.1, 0.001, p.clearcoat_gloss)),
            // A fifth of the sheen's light is where the cosine draws.
            diffuse_mean: mean(p.base) * (1.0 - p.metallic) + 0.2 * mean(sheen),
            specular_mean: mean(specular),
            energy_conserving: false,
        };
        let azimuths: &[f64] = if alpha.is_isotropic() { &[0.0] } else { &[0.0, FRAC_PI_4, FRAC_PI_2] };
        model.energy_conserving = largest_albedo(&model, azimuths) < SAFE_ALBEDO;
        model
    }

    /// Shares of the cosine, of normals visible from wo, and of the coat's normals.
    #[inline]
    pub(crate) fn shares(&self, wo: Direction) -> [f64; 3] {
        let weight = schlick_weight(wo.z);
        // Even where F(θo) = 0, some facets reflect.
        let specular = mix(self.specular_mean, 1.0, weight).max(f64::MIN_POSITIVE);
        let coat = 0.25 * self.p.clearcoat * mix(COAT_F0, 1.0, weight);
        mixture::shares([self.diffuse_mean, specular, coat])
    }

    /// The base's lobe over its reflectance.
    #[inline]
    fn diffuse(&self, wo: Direction, wi: Direction, om: f64) -> f64 {
        let (o, i) = (schlick_weight(wo.z), schlick_weight(wi.z));
        let retro = om * om * self.p.roughness;
        let both = |grazing: f64| mix(1.0, grazing, o) * mix(1.0, grazing, i);
        let plain = both(0.5 + 2.0 * retro);
        // After Hanrahan and Krueger.
        let subsurface = 1.25 * (both(retro) * (1.0 / (wo.z + wi.z) - 0.5) + 0.5);
        mix(plain, subsurface, self.p.subsurface) / PI
    }
}

impl Bsdf for Disney {
    fn describe(&self) -> Description {
        Description::new("disney").channels(["r", "g", "b"]).dimensions(2).claims(|c| {
            c.isotropic = self.distribution.alpha.is_isotropic();
            c.energy_conserving = self.energy_conserving;
        })
    }

    #[inline]
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        let Some((m, om)) = half_vector::of_reflection(wo, wi) else {
            return Spectrum::zero(3);
        };
        let weight = schlick_weight(om);
        let masking = |alpha2| masking_over_cosine(wo.z, alpha2) * masking_over_cosine(wi.z, alpha2);
        let diffuse = (1.0 - self.p.metallic) * self.diffuse(wo, wi, om);
        let specular = self.distribution.density(m) * masking(self.masking_alpha2);
        let mut coat = 0.0;
        if self.p.clearcoat > 0.0 {
            let fresnel = mix(COAT_F0, 1.0, weight);
            coat = 0.25 * self.p.clearcoat * fresnel * self.coat.density(m) * masking(COAT_MASKING_ALPHA2);
        }
        Spectrum::from_fn(3, |c| {
            let base = diffuse * self.p.base[c] + weight * self.sheen[c];
            base + specular * mix(self.specular[c], 1.0, weight) + coat
        })
    }

    #[inline]
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        let Some((m, om)) = half_vector::of_reflection(wo, wi) else {
            return 0.0;
        };
        let [cosine, specular, coat] = self.shares(wo);
        // D max(0, wo·m)/(cos θo + backfacing area) over 4 wo·m.
        let visible = 0.25 * self.distribution.density(m) / (wo.z + self.distribution.backfacing_area(wo));
        let mut pdf = cosine * wi.z / PI + specular * visible;
        if coat > 0.0 {
            pdf += coat * self.coat.density(m) * m.z / (4.0 * om);
        }
        pdf
    }

    #[inline]
    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z <= 0.0 {
            return None;
        }
        let (chosen, first) = mixture::choose(self.shares(wo), u[0]);
        let u = [first, u[1]];
        let (wi, lobe) = match chosen {
            0 => (sample_cosine(&u), Lobe::DIFFUSE_REFLECTION),
            1 => (wo.reflected(self.distribution.sample_visible(wo, &u)), Lobe::GLOSSY_REFLECTION),
            _ => (wo.reflected(self.coat.sample(&u)), Lobe::GLOSSY_REFLECTION),
        };
        let pdf = Bsdf::pdf(self, wo, wi, transport);
        let weight = Bsdf::eval(self, wo, wi, transport) * (wi.z / pdf);
        let valid = pdf > 0.0 && pdf.is_finite() && weight.iter().all(|w| w.is_finite());
        valid.then_some(Sample { wi, weight, pdf, lobe })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::brute_force::{albedo, assert_sound};

    const R: Transport = Transport::Radiance;

    const PLAIN: DisneyParameters = DisneyParameters {
        base: [0.65, 0.4, 0.05],
        subsurface: 0.0,
        metallic: 0.0,
        specular: 0.5,
        specular_tint: 0.0,
        roughness: 0.5,
        anisotropic: 0.0,
        sheen: 0.0,
        sheen_tint: 0.5,
        clearcoat: 0.0,
        clearcoat_gloss: 1.0,
    };

    const ALL: DisneyParameters = DisneyParameters {
        subsurface: 0.3,
        metallic: 0.2,
        specular_tint: 0.4,
        anisotropic: 0.6,
        sheen: 0.7,
        clearcoat: 0.8,
        clearcoat_gloss: 0.5,
        ..PLAIN
    };

    /// The notes' formulas once more, written with angles.
    #[test]
    fn equals_the_published_form() {
        let p = ALL;
        let (wo, wi) = (Direction::from_angles(0.8, 0.3), Direction::from_angles(1.1, 2.4));
        let h = (wo + wi).normalized();
        let (cos_d, fo, fi) = (h.dot(wi), (1.0 - wo.z).powi(5), (1.0 - wi.z).powi(5));
        let fd90 = 0.5 + 2.0 * p.roughness * cos_d * cos_d;
        let fd = (1.0 + (fd90 - 1.0) * fo) * (1.0 + (fd90 - 1.0) * fi);
        let fss90 = p.roughness * cos_d * cos_d;
        let fss = (1.0 + (fss90 - 1.0) * fo) * (1.0 + (fss90 - 1.0) * fi);
        let ss = 1.25 * (fss * (1.0 / (wo.z + wi.z) - 0.5) + 0.5);
        let fh = (1.0 - cos_d).powi(5);
        // GTR2 by the angles of h, GGX's G1 by the tangent.
        let aspect = (1.0 - 0.9 * p.anisotropic).sqrt();
        let (ax, ay) = (p.roughness.powi(2) / aspect, p.roughness.powi(2) * aspect);
        let (t, phi) = (h.theta(), h.phi());
        let e = (phi.cos() / ax).powi(2) + (phi.sin() / ay).powi(2);
        let d = 1.0 / (PI * ax * ay * (t.sin().powi(2) * e + t.cos().powi(2)).powi(2));
        let g1 = |w: Direction, a: f64| 2.0 / (1.0 + (1.0 + (a * w.theta().tan()).powi(2)).sqrt());
        let both = |a: f64| g1(wo, a) * g1(wi, a) / (4.0 * wo.z * wi.z);
        let a: f64 = 0.1 + (0.001 - 0.1) * p.clearcoat_gloss;
        let coat_d = (a * a - 1.0) / (PI * (a * a).ln() * (1.0 + (a * a - 1.0) * t.cos().powi(2)));
        let coat = 0.25 * p.clearcoat * coat_d * (0.04 + 0.96 * fh) * both(0.25);
        let luminance = 0.3 * 0.65 + 0.6 * 0.4 + 0.1 * 0.05;
        let f = Disney::new(p).eval(wo, wi, R);
        for c in 0..3 {
            let tint = p.base[c] / luminance;
            let dielectric = 0.08 * p.specular * (1.0 + p.specular_tint * (tint - 1.0));
            let f0 = dielectric + p.metallic * (p.base[c] - dielectric);
            let sheen = p.sheen * (1.0 + p.sheen_tint * (tint - 1.0)) * fh;
            let base = (fd + p.subsurface * (ss - fd)) * p.base[c] / PI + sheen;
            let specular = d * both((0.5 + p.roughness / 2.0f64).powi(2)) * (f0 + (1.0 - f0) * fh);
            let expected = (1.0 - p.metallic) * base + specular + coat;
            assert!((f[c] / expected - 1.0).abs() < 1e-12, "{c}: {} {expected}", f[c]);
        }
    }

    #[test]
    fn is_reciprocal() {
        let model = Disney::new(ALL);
        for (a, b) in [(0.1, 1.5), (0.8, 1.1), (1.55, 1.5)] {
            let (wo, wi) = (Direction::from_angles(a, 0.3), Direction::from_angles(b, 2.4));
            let (f, g) = (model.eval(wo, wi, R), model.eval(wi, wo, R));
            assert!(f.iter().zip(g.iter()).all(|(f, g)| (f / g - 1.0).abs() < 1e-12));
        }
    }

    /// The albedo of the rough white base alone, in black specular, is above 1 at
    /// grazing view: the retro-reflection is added.
    #[test]
    fn energy_is_claimed_where_it_is_conserved() {
        let white = DisneyParameters { base: [1.0; 3], specular: 0.0, roughness: 1.0, ..PLAIN };
        let cases = [
            (white, false),
            (PLAIN, true),
            (DisneyParameters { base: [0.3; 3], subsurface: 1.0, ..PLAIN }, true),
            (DisneyParameters { base: [0.9; 3], subsurface: 1.0, ..PLAIN }, false),
            (DisneyParameters { base: [0.8; 3], clearcoat: 1.0, roughness: 1.0, ..PLAIN }, false),
            (DisneyParameters { base: [0.9; 3], metallic: 1.0, ..PLAIN }, true),
            (DisneyParameters { sheen: 1.0, sheen_tint: 1.0, base: [0.0, 0.0, 0.8], ..PLAIN }, false),
        ];
        for (p, conserves) in cases {
            let model = Disney::new(p);
            assert_eq!(model.describe().claims.energy_conserving, conserves, "{p:?}");
            let degrees = [0.0f64, 40.0, 60.0, 72.0, 80.0, 86.0, 89.0];
            let largest = degrees
                .map(|d| Direction::from_angles(d.to_radians(), 0.0))
                .into_iter()
                .flat_map(|wo| [0, 2].map(|c| albedo(&model, wo, c)))
                .fold(0.0, f64::max);
            assert_eq!(largest <= 1.0, conserves, "{p:?}: {largest}");
            let found = largest_albedo(&model, &[0.0]);
            assert!((found / largest - 1.0).abs() < 0.05, "{p:?}: {found} {largest}");
        }
    }

    #[test]
    fn edges_are_sound() {
        assert_sound(&Disney::new(ALL));
        assert_sound(&Disney::new(DisneyParameters { roughness: 0.0, specular: 0.0, ..ALL }));
        assert_sound(&Disney::new(DisneyParameters { base: [0.0; 3], specular: 0.0, ..PLAIN }));
        assert_sound(&Disney::new(DisneyParameters {
            metallic: 1.0,
            roughness: 1.0,
            anisotropic: 1.0,
            ..ALL
        }));
    }
}
