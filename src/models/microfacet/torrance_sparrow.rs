//! Torrance and Sparrow's reflection from rough surfaces.

use super::visible_ggx::VisibleGgx;
use super::{Distribution, Roughness, half_vector, v_cavity};
use crate::bsdf::{
    Bsdf, Description, Direction, Lobe, Sample, Samples, Spectrum, SubjectError, Transport, each_density,
    each_value, one_by_one,
};
use crate::models::{Metal, fresnel};
use crate::registry::{Model, Parameters, Role};

/// How much light reaches a facet and leaves it unhindered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masking {
    /// Smith's, with masking and shadowing correlated by height:
    /// G2 = 1/(1 + Λo + Λi) (Heitz 2014, eq. 99).
    Smith,
    /// Torrance and Sparrow's V-shaped grooves.
    VCavity,
}

/// What part of the light a facet reflects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fresnel {
    /// All of it.
    None,
    /// Schlick's approximation, from the reflectance at normal incidence in [0, 1].
    Schlick(f64),
    /// A dielectric of this relative index; what is transmitted is lost.
    Dielectric(f64),
    /// A metal, one channel a wavelength.
    Conductor(Metal),
}

/// Which normals are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalSampling {
    /// Those that wo sees under the masking in use.
    Visible,
    /// All, with density D cos θ.
    All,
}

/// f = F D G2/(4 cos θo cos θi) on the front side (K. E. Torrance and E. M.
/// Sparrow, *Theory for off-specular reflection from roughened surfaces*, 1967;
/// R. L. Cook and K. E. Torrance 1982; B. Walter et al. 2007; E. Heitz,
/// *Understanding the masking-shadowing function*, 2014).
#[derive(Clone, Debug)]
pub struct TorranceSparrow {
    pub(crate) distribution: Distribution,
    pub(crate) masking: Masking,
    pub(crate) fresnel: Fresnel,
    pub(crate) sampling: NormalSampling,
}

/// The registered model `torrance-sparrow`.
pub(in crate::models) fn model() -> Model {
    Model::new(
        "torrance-sparrow",
        "reflection from microfacets (Torrance and Sparrow 1967)",
        TorranceSparrow::declared,
    )
    .number("alpha", 0.2, 1e-4..=1.0, "roughness along the tangent (gaussian: an angle in radians)")
    .role(Role::Roughness)
    .number("alpha_y", 0.0, 0.0..=1.0, "roughness along the bitangent; 0: as alpha")
    .role(Role::Roughness)
    .choice("distribution", &["ggx", "beckmann", "gaussian"], "distribution D of facet normals")
    .choice("masking", &["smith", "v-cavity"], "masking and shadowing G2 (smith: correlated by height)")
    .choice("fresnel", &["none", "schlick", "dielectric", "conductor"], "reflectance F of a facet")
    .number("f0", 0.04, 0.0..=1.0, "reflectance of a facet at normal incidence")
    .only_when("fresnel", &["schlick"])
    .number("eta", 1.5, 1.0..=4.0, "index of refraction of the inside over the outside")
    .role(Role::Eta)
    .only_when("fresnel", &["dielectric"])
    .choice("metal", &Metal::NAMES, "whose complex index of refraction")
    .only_when("fresnel", &["conductor"])
    .choice("sampling", &["visible-normals", "normals"], "which normals are drawn")
}

impl TorranceSparrow {
    /// As the registered model reads its parameters.
    pub(crate) fn declared(p: &Parameters) -> Result<Self, String> {
        let alpha = Roughness::declared(p.number("alpha"), p.number("alpha_y"))?;
        TorranceSparrow::new(
            match p.text("distribution") {
                "beckmann" => Distribution::beckmann(alpha),
                "gaussian" => Distribution::gaussian(alpha),
                _ => Distribution::ggx(alpha),
            },
            match p.text("masking") {
                "v-cavity" => Masking::VCavity,
                _ => Masking::Smith,
            },
            match p.text("fresnel") {
                "schlick" => Fresnel::Schlick(p.number("f0")),
                "dielectric" => Fresnel::Dielectric(p.number("eta")),
                "conductor" => Fresnel::Conductor(Metal::named(p.text("metal"))),
                _ => Fresnel::None,
            },
            match p.text("sampling") {
                "normals" => NormalSampling::All,
                _ => NormalSampling::Visible,
            },
        )
    }

    /// From its parts. The Gaussian has no known way to draw normals visible
    /// under Smith's masking.
    pub fn new(
        distribution: Distribution,
        masking: Masking,
        fresnel: Fresnel,
        sampling: NormalSampling,
    ) -> Result<Self, String> {
        if let (Distribution::Gaussian(_), Masking::Smith, NormalSampling::Visible) =
            (&distribution, masking, sampling)
        {
            return Err("gaussian normals visible under smith masking cannot be drawn; \
                        choose sampling=normals or masking=v-cavity"
                .into());
        }
        Ok(Self { distribution, masking, fresnel, sampling })
    }

    /// 1, or one a wavelength of a metal.
    pub(crate) fn channels(&self) -> usize {
        match self.fresnel {
            Fresnel::Conductor(_) => Metal::WAVELENGTHS.len(),
            _ => 1,
        }
    }

    /// F times `scale`, at the angle between a direction and its facet.
    #[inline]
    pub(crate) fn reflected(&self, cos: f64, scale: f64) -> Spectrum {
        match self.fresnel {
            Fresnel::None => Spectrum::from(scale),
            Fresnel::Schlick(f0) => Spectrum::from(scale * fresnel::schlick(cos.min(1.0), f0)),
            Fresnel::Dielectric(eta) => Spectrum::from(scale * fresnel::dielectric(cos.min(1.0), eta)),
            Fresnel::Conductor(metal) => {
                let index = metal.index();
                Spectrum::from_fn(index.len(), |c| {
                    scale * fresnel::conductor(cos.min(1.0), index[c].0, index[c].1)
                })
            }
        }
    }

    /// A normal as it is drawn for wo; it may face away.
    #[inline]
    pub(crate) fn facet(&self, wo: Direction, u: &[f64]) -> Option<Direction> {
        self.facet_of(wo, || self.masked_area(wo), u)
    }

    /// The same; `o` gives the masked area of wo where it is needed.
    #[inline]
    fn facet_of(&self, wo: Direction, o: impl FnOnce() -> f64, u: &[f64]) -> Option<Direction> {
        match (self.sampling, self.masking) {
            (NormalSampling::All, _) => Some(self.distribution.sample(u)),
            (NormalSampling::Visible, Masking::Smith) => self.distribution.sample_visible_of(wo, o, u),
            (NormalSampling::Visible, Masking::VCavity) => {
                Some(v_cavity::visible_wall(wo, self.distribution.sample(u), u[2]))
            }
        }
    }

    /// The area by which Smith's functions mask `w`; not used by grooves.
    #[inline]
    fn masked_area(&self, w: Direction) -> f64 {
        match self.masking {
            Masking::Smith => self.distribution.backfacing_area(w),
            Masking::VCavity => 0.0,
        }
    }

    /// G2/(4 cos θo cos θi), finite up to the horizon; `om` = wo·m, `o` the
    /// masked area of wo.
    #[inline]
    fn geometry(&self, wo: Direction, wi: Direction, m: Direction, om: f64, o: f64) -> f64 {
        match self.masking {
            Masking::Smith => 0.25 / (wo.z * wi.z + o * wi.z + self.masked_area(wi) * wo.z),
            Masking::VCavity => 0.25 * v_cavity::masking_shadowing_over_cosines(wo, wi, m, om),
        }
    }

    /// Density of wi over D: that of m, by Walter's Jacobian 1/(4 wo·m); `o`
    /// gives the masked area of wo where it is needed.
    #[inline]
    fn density_factor(&self, wo: Direction, m: Direction, om: f64, o: impl FnOnce() -> f64) -> f64 {
        match (self.sampling, self.masking) {
            (NormalSampling::All, _) => 0.25 * m.z / om,
            (NormalSampling::Visible, Masking::Smith) => 0.25 / (wo.z + o()),
            (NormalSampling::Visible, Masking::VCavity) => 0.25 * v_cavity::masking_over_cosine(wo, m, om),
        }
    }

    /// A draw for a wo above the surface of the masked area `o`.
    #[inline]
    fn draw(&self, wo: Direction, o: f64, u: &[f64]) -> Option<Sample> {
        let m = self.facet_of(wo, || o, u)?;
        let om = wo.dot(m);
        let wi = wo.reflected(m);
        if om <= 0.0 || wi.z <= 0.0 {
            return None;
        }
        // D is a factor of both f and pdf, and wo's masking area of both others.
        let factor = self.density_factor(wo, m, om, || o);
        let pdf = self.distribution.density(m) * factor;
        let weight = self.reflected(om, self.geometry(wo, wi, m, om, o) * wi.z / factor);
        // Within 1e-150 of the horizon f is beyond f64.
        let valid = pdf > 0.0 && pdf.is_finite() && weight[0].is_finite();
        valid.then_some(Sample { wi, weight, pdf, lobe: Lobe::GLOSSY_REFLECTION })
    }
}

impl Bsdf for TorranceSparrow {
    fn describe(&self) -> Description {
        let third = self.sampling == NormalSampling::Visible && self.masking == Masking::VCavity;
        let description =
            Description::new("torrance-sparrow").dimensions(if third { 3 } else { 2 }).claims(|c| {
                c.isotropic = self.distribution.alpha().is_isotropic();
            });
        match self.fresnel {
            Fresnel::Conductor(_) => description.channels(Metal::WAVELENGTHS),
            _ => description,
        }
    }

    #[inline]
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        let Some((m, om)) = half_vector::of_reflection(wo, wi) else {
            return Spectrum::zero(self.channels());
        };
        let d = self.distribution.density(m);
        if d == 0.0 {
            return Spectrum::zero(self.channels());
        }
        self.reflected(om, d * self.geometry(wo, wi, m, om, self.masked_area(wo)))
    }

    #[inline]
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        let Some((m, om)) = half_vector::of_reflection(wo, wi) else {
            return 0.0;
        };
        let d = self.distribution.density(m);
        if d == 0.0 { 0.0 } else { d * self.density_factor(wo, m, om, || self.masked_area(wo)) }
    }

    #[inline]
    fn sample(&self, wo: Direction, u: &[f64], _: Transport) -> Option<Sample> {
        if wo.z <= 0.0 {
            return None;
        }
        if let Some(view) = VisibleGgx::of(self, wo) {
            let drawn = view.sample(u);
            return drawn.map(|(wi, weight, pdf)| Sample { wi, weight, pdf, lobe: Lobe::GLOSSY_REFLECTION });
        }
        self.draw(wo, self.masked_area(wo), u)
    }

    fn eval_rows(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        if let Some(view) = VisibleGgx::of(self, wo).filter(|_| out.len() == wi.len() * self.channels()) {
            view.eval_rows(wi, out);
            return Ok(());
        }
        each_value(self, wo, wi, transport, out)
    }

    fn pdf_rows(&self, wo: Direction, wi: &[Direction], transport: Transport, out: &mut [f64]) {
        match VisibleGgx::of(self, wo) {
            Some(view) => view.pdf_rows(wi, out),
            None => each_density(self, wo, wi, transport, out),
        }
    }

    fn sample_rows(
        &self,
        wo: Direction,
        u: &[f64],
        transport: Transport,
        out: &mut Samples,
    ) -> Result<(), SubjectError> {
        if let Some(view) = VisibleGgx::of(self, wo).filter(|_| out.channels == self.channels()) {
            view.sample_rows(u.as_chunks().0, out);
            return Ok(());
        }
        if wo.z <= 0.0 || out.channels != self.channels() {
            return one_by_one(self, wo, u, transport, out);
        }
        let o = self.masked_area(wo);
        u.chunks_exact(Bsdf::describe(self).dimensions).for_each(|u| out.push(self.draw(wo, o, u).as_ref()));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::{Registry, Spelling};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    const LAST: f64 = 1.0 - f64::EPSILON / 2.0;
    const R: Transport = Transport::Radiance;

    /// Every combination that can be built, isotropic and not.
    fn all() -> Vec<TorranceSparrow> {
        let mut all = Vec::new();
        for (x, y) in [(1e-4, 1e-4), (0.2, 0.2), (1.0, 1.0), (0.05, 0.6)] {
            let alpha = Roughness { x, y };
            for masking in [Masking::Smith, Masking::VCavity] {
                for sampling in [NormalSampling::Visible, NormalSampling::All] {
                    for distribution in [
                        Distribution::ggx(alpha),
                        Distribution::beckmann(alpha),
                        Distribution::gaussian(alpha),
                    ] {
                        let fresnel = match sampling {
                            NormalSampling::All => Fresnel::Conductor(Metal::Gold),
                            NormalSampling::Visible => Fresnel::Dielectric(1.5),
                        };
                        all.extend(TorranceSparrow::new(distribution, masking, fresnel, sampling));
                    }
                }
            }
        }
        assert_eq!(all.len(), 44);
        all
    }

    #[test]
    fn sample_eval_and_pdf_agree() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
        let mut uniform = || (random.next_u64() >> 11) as f64 * f64::EPSILON / 2.0;
        for model in all() {
            let rough = model.distribution.alpha();
            // Rounding of m is magnified by the slope of D and, in pdf, by
            // finding m again from wi near the horizon.
            let tolerance = 1e-9 + 2e-12 / rough.x.min(rough.y);
            for theta in [0.0f64, 30.0, 75.0, 89.0] {
                let wo = Direction::from_angles(theta.to_radians(), 0.7);
                for _ in 0..200 {
                    let u = [uniform(), uniform(), uniform()];
                    let Some(s) = model.sample(wo, &u, R) else { continue };
                    let (f, pdf) = (model.eval(wo, s.wi, R), model.pdf(wo, s.wi, R));
                    assert!((s.pdf / pdf - 1.0).abs() < tolerance, "{model:?} {theta} {s:?} {pdf}");
                    assert!((s.wi.length() - 1.0).abs() < 1e-14);
                    for (w, f) in s.weight.iter().zip(f.iter()) {
                        assert!((w * pdf / (f * s.wi.z) - 1.0).abs() < 1e-9, "{model:?} {theta} {s:?}");
                    }
                    let swapped = model.eval(s.wi, wo, R);
                    assert!((swapped[0] / f[0] - 1.0).abs() < 1e-13);
                }
            }
        }
    }

    /// Many at once give the same bits as one by one, in whole vectors and in the rest.
    #[test]
    fn rows_are_what_each_draw_gives() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(8);
        let mut u: Vec<f64> =
            (0..66).map(|_| (random.next_u64() >> 11) as f64 * f64::EPSILON / 2.0).collect();
        u.extend([0.0, 0.0, LAST, LAST, 0.0, LAST, LAST, 0.0]);
        let mut models = all();
        for fresnel in [
            Fresnel::None,
            Fresnel::Schlick(0.04),
            Fresnel::Dielectric(1.5),
            Fresnel::Conductor(Metal::Copper),
        ] {
            for (x, y) in [(1e-4, 1e-4), (0.2, 0.2), (1.0, 0.1)] {
                let distribution = Distribution::ggx(Roughness { x, y });
                let visible = NormalSampling::Visible;
                models.extend(TorranceSparrow::new(distribution, Masking::Smith, fresnel, visible));
            }
        }
        for model in models {
            for wo in [0.0, 1.0, 1.5705, 2.0].map(|theta| Direction::from_angles(theta, 0.7)) {
                let (mut rows, mut each) = (Samples::default(), Samples::default());
                rows.clear(model.channels());
                each.clear(model.channels());
                model.sample_rows(wo, &u, R, &mut rows).unwrap();
                for u in u.chunks_exact(Bsdf::describe(&model).dimensions) {
                    each.push(model.sample(wo, u, R).as_ref());
                }
                assert_eq!(rows.lobe, each.lobe);
                assert_eq!((rows.wi, rows.weight, rows.pdf), (each.wi, each.weight, each.pdf));
            }
        }
    }

    /// Likewise for values and densities, off the support too.
    #[test]
    fn rows_are_what_each_direction_gives() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(9);
        let mut uniform = || (random.next_u64() >> 11) as f64 * f64::EPSILON / 2.0;
        let grazing = Direction::new(1.0, 0.0, 1e-300);
        for model in all() {
            for wo in [Direction::NORMAL, Direction::from_angles(1.2, 0.7), grazing, -Direction::NORMAL] {
                let mut wi = vec![wo, -wo, wo.mirrored(), grazing, grazing.mirrored(), Direction::default()];
                wi.extend((0..20).map(|_| Direction::from_angles(1.7 * uniform(), 6.3 * uniform())));
                let channels = model.channels();
                let (mut value, mut pdf) = (vec![f64::NAN; wi.len() * channels], vec![f64::NAN; wi.len()]);
                model.eval_rows(wo, &wi, R, &mut value).unwrap();
                model.pdf_rows(wo, &wi, R, &mut pdf);
                for (k, wi) in wi.iter().enumerate() {
                    let row = &value[k * channels..][..channels];
                    assert_eq!(row, &*model.eval(wo, *wi, R), "{model:?} {wo:?} {wi:?}");
                    assert_eq!(pdf[k], model.pdf(wo, *wi, R), "{model:?} {wo:?} {wi:?}");
                }
            }
        }
    }

    #[test]
    fn edges_give_valid_output_or_none() {
        let grazing = Direction::new(1.0, 0.0, 1e-300);
        let views = [Direction::NORMAL, Direction::from_angles(1.5705, 2.0), grazing];
        for model in all() {
            for u in (0..8).map(|k| [0, 1, 2].map(|b| if k >> b & 1 == 0 { 0.0 } else { LAST })) {
                for wo in views {
                    let Some(s) = model.sample(wo, &u, R) else { continue };
                    assert!((s.wi.length() - 1.0).abs() < 1e-14 && s.wi.z > 0.0, "{model:?} {wo:?} {u:?}");
                    assert!(s.pdf > 0.0 && s.pdf.is_finite() && s.weight.iter().all(|w| w.is_finite()));
                }
                for wo in [Direction::new(1.0, 0.0, 0.0), Direction::new(0.6, 0.0, -0.8)] {
                    assert!(model.sample(wo, &u, R).is_none());
                }
            }
            let horizon = Direction::new(1.0, 0.0, 0.0);
            for (wo, wi) in [(horizon, horizon), (horizon, Direction::NORMAL), (Direction::NORMAL, horizon)] {
                assert_eq!((model.eval(wo, wi, R)[0], model.pdf(wo, wi, R)), (0.0, 0.0));
            }
            for (wo, wi) in [(grazing, grazing), (grazing, grazing.mirrored()), (grazing, Direction::NORMAL)]
            {
                assert!(!model.eval(wo, wi, R)[0].is_nan() && !model.pdf(wo, wi, R).is_nan());
            }
        }
    }

    /// ∫∫ over the single-scattering GGX lobe at α = 1 and normal incidence is
    /// 1 − ln 2 (both forms of Smith's G2 are equal there: Λo = 0).
    #[test]
    fn loses_what_ggx_is_known_to_lose() {
        let ggx = TorranceSparrow::new(
            Distribution::ggx(Roughness::isotropic(1.0)),
            Masking::Smith,
            Fresnel::None,
            NormalSampling::Visible,
        )
        .unwrap();
        let n = 100_000;
        let weight = |k| {
            let u = [(f64::from(k) + 0.5) / f64::from(n), 0.3];
            ggx.sample(Direction::NORMAL, &u, R).map_or(0.0, |s| s.weight[0])
        };
        let albedo = (0..n).map(weight).sum::<f64>() / f64::from(n);
        assert!((albedo - (1.0 - 2f64.ln())).abs() < 1e-5, "{albedo}");
    }

    #[test]
    fn unbuildable_parameters_name_the_way_out() {
        let build = |text: &str| {
            let spelling: Spelling = text.parse().unwrap();
            Registry::builtin().resolve(&spelling).map(|r| r.subject.describe())
        };
        let message = |text: &str| build(text).unwrap_err().to_string();
        assert!(message("torrance-sparrow:distribution=gaussian").contains("sampling=normals"));
        assert!(message("torrance-sparrow:alpha_y=1e-5").contains("1e-4"));
        let described = build("torrance-sparrow:fresnel=conductor,metal=gold,alpha_y=0.3").unwrap();
        assert_eq!((described.channels.len(), described.claims.isotropic), (3, false));
        assert!(build("torrance-sparrow:alpha=0.3,alpha_y=0.3").unwrap().claims.isotropic);
    }
}
