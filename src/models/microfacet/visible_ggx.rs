//! Many at once of GGX whose visible normals are drawn: values, densities and draws.

use super::ggx::{Ggx, VisibleNormals};
use super::{Distribution, Fresnel, Masking, NormalSampling, TorranceSparrow};
use crate::bsdf::{Direction, Lobe, Samples, Spectrum};
use crate::models::fresnel;

/// Draws side by side: two vectors of the widest registers.
const LANES: usize = 8;

/// Torrance and Sparrow's surface of GGX facets under Smith's masking, drawn by its
/// visible normals, as one `wo` sees it.
pub(super) struct VisibleGgx<'a> {
    surface: &'a TorranceSparrow,
    ggx: Ggx,
    wo: Direction,
    normals: VisibleNormals,
    /// The masked area of wo.
    masked: f64,
    /// Density of wi over D, and the inverse.
    factor: f64,
    per_factor: f64,
}

/// A draw but for what its facet reflects.
#[derive(Clone, Copy)]
struct Drawn {
    wi: Direction,
    /// wo·m
    om: f64,
    pdf: f64,
    /// The weight where all is reflected.
    scale: f64,
}

/// Within 1e-150 of the horizon f is beyond f64.
#[inline(always)]
fn is_valid(om: f64, wi_z: f64, pdf: f64, weight: f64) -> bool {
    (om > 0.0) & (wi_z > 0.0) & (pdf > 0.0) & (pdf < f64::INFINITY) & (weight.abs() < f64::INFINITY)
}

impl<'a> VisibleGgx<'a> {
    /// `None` of other surfaces, and from below.
    #[inline]
    pub(super) fn of(surface: &'a TorranceSparrow, wo: Direction) -> Option<Self> {
        let TorranceSparrow {
            distribution: Distribution::Ggx(ggx),
            masking: Masking::Smith,
            sampling: NormalSampling::Visible,
            ..
        } = surface
        else {
            return None;
        };
        let masked = ggx.backfacing_area(wo);
        (wo.z > 0.0).then(|| Self {
            surface,
            ggx: *ggx,
            wo,
            normals: ggx.seen_from(wo),
            masked,
            factor: 0.25 / (wo.z + masked),
            per_factor: 4.0 * (wo.z + masked),
        })
    }

    /// D is a factor of both f and pdf.
    #[inline(always)]
    fn draw(&self, u: [f64; 2]) -> Drawn {
        let m = self.normals.sample(u);
        let (wo, om) = (self.wo, self.wo.dot(m));
        let wi = wo.reflected(m);
        let masked = self.ggx.backfacing_area(wi);
        let geometry = 0.25 / (wo.z * wi.z + self.masked * wi.z + masked * wo.z);
        Drawn { wi, om, pdf: self.ggx.density(m) * self.factor, scale: geometry * wi.z * self.per_factor }
    }

    /// One draw.
    #[inline]
    pub(super) fn sample(&self, u: &[f64]) -> Option<(Direction, Spectrum, f64)> {
        let drawn = self.draw([u[0], u[1]]);
        let weight = self.surface.reflected(drawn.om, drawn.scale);
        is_valid(drawn.om, drawn.wi.z, drawn.pdf, weight[0]).then_some((drawn.wi, weight, drawn.pdf))
    }

    /// wo·m of the facet that reflects `wi` to wo, and its D; 0 where there is none.
    #[inline(always)]
    fn facet(&self, wi: Direction) -> (f64, f64) {
        let sum = self.wo + wi;
        let length = sum.length();
        let d = self.ggx.density(sum * (1.0 / length));
        (0.5 * length, if (wi.z > 0.0) & (length > 0.0) { d } else { 0.0 })
    }

    /// pdf at each of `wi`.
    pub(super) fn pdf_rows(&self, wi: &[Direction], out: &mut [f64]) {
        pulp::Arch::new().dispatch(Densities { view: self, wi, out });
    }

    /// f at each of `wi`, by channel.
    pub(super) fn eval_rows(&self, wi: &[Direction], out: &mut [f64]) {
        let channels = self.surface.channels();
        pulp::Arch::new().dispatch(Values { view: self, wi, channels, out });
    }

    /// What facets of these wo·m reflect of `scale` in a channel.
    #[inline(always)]
    fn reflected<const N: usize>(&self, channel: usize, om: &[f64; N], scale: &[f64; N]) -> [f64; N] {
        let mut weight = *scale;
        match self.surface.fresnel {
            Fresnel::None => {}
            Fresnel::Conductor(metal) => {
                let (eta, absorption) = metal.index()[channel];
                for k in 0..N {
                    weight[k] *= fresnel::conductor(om[k].min(1.0), eta, absorption);
                }
            }
            Fresnel::Schlick(f0) => {
                for k in 0..N {
                    weight[k] *= fresnel::schlick(om[k].min(1.0), f0);
                }
            }
            Fresnel::Dielectric(eta) => {
                for k in 0..N {
                    weight[k] *= fresnel::dielectric(om[k].min(1.0), eta);
                }
            }
        }
        weight
    }

    /// A draw for each pair of `u`, appended to `out`.
    pub(super) fn sample_rows(&self, u: &[[f64; 2]], out: &mut Samples) {
        out.wi.reserve(u.len());
        out.pdf.reserve(u.len());
        out.lobe.reserve(u.len());
        let from = out.weight.len();
        out.weight.resize(from + u.len() * out.channels, 0.0);
        pulp::Arch::new().dispatch(Rows { view: self, u, from, out });
    }
}

/// Arguments of [`VisibleGgx::sample_rows`].
struct Rows<'a> {
    view: &'a VisibleGgx<'a>,
    u: &'a [[f64; 2]],
    /// Where its weights begin.
    from: usize,
    out: &'a mut Samples,
}

impl Rows<'_> {
    /// Arrays a number, and plain loops over them, are what the compiler makes vectors of.
    #[inline(always)]
    fn fill<const N: usize>(&mut self, at: usize, u: &[[f64; 2]; N]) {
        let [mut x, mut y, mut z, mut om, mut pdf, mut scale] = [[0.0; N]; 6];
        let [mut first, mut second] = [[0.0; N]; 2];
        for k in 0..N {
            [first[k], second[k]] = u[k];
        }
        for k in 0..N {
            let d = self.view.draw([first[k], second[k]]);
            (x[k], y[k], z[k]) = (d.wi.x, d.wi.y, d.wi.z);
            (om[k], pdf[k], scale[k]) = (d.om, d.pdf, d.scale);
        }
        let mut valid = [false; N];
        let channels = self.out.channels;
        let weights = &mut self.out.weight[self.from + at * channels..][..N * channels];
        for c in 0..channels {
            let weight = self.view.reflected(c, &om, &scale);
            if c == 0 {
                for k in 0..N {
                    valid[k] = is_valid(om[k], z[k], pdf[k], weight[k]);
                }
            }
            for k in 0..N {
                weights[k * channels + c] = if valid[k] { weight[k] } else { 0.0 };
            }
        }
        let (mut wi, mut lobe) = ([Direction::default(); N], [Lobe::NONE; N]);
        for k in 0..N {
            wi[k] = if valid[k] { Direction::new(x[k], y[k], z[k]) } else { Direction::default() };
            pdf[k] = if valid[k] { pdf[k] } else { 0.0 };
            lobe[k] = if valid[k] { Lobe::GLOSSY_REFLECTION } else { Lobe::NONE };
        }
        self.out.wi.extend_from_slice(&wi);
        self.out.pdf.extend_from_slice(&pdf);
        self.out.lobe.extend_from_slice(&lobe);
    }
}

impl pulp::NullaryFnOnce for Rows<'_> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        let (many, rest) = self.u.as_chunks::<LANES>();
        for (chunk, u) in many.iter().enumerate() {
            self.fill(chunk * LANES, u);
        }
        for (k, u) in rest.iter().enumerate() {
            self.fill(many.len() * LANES + k, &[*u]);
        }
    }
}

/// x, y and z of each.
#[inline(always)]
fn coordinates<const N: usize>(directions: &[Direction; N]) -> [[f64; N]; 3] {
    let mut all = [[0.0; N]; 3];
    for k in 0..N {
        (all[0][k], all[1][k], all[2][k]) = (directions[k].x, directions[k].y, directions[k].z);
    }
    all
}

/// Arguments of [`VisibleGgx::pdf_rows`].
struct Densities<'a> {
    view: &'a VisibleGgx<'a>,
    wi: &'a [Direction],
    out: &'a mut [f64],
}

impl Densities<'_> {
    #[inline(always)]
    fn of<const N: usize>(&self, wi: &[Direction; N]) -> [f64; N] {
        let [x, y, z] = coordinates(wi);
        let mut pdf = [0.0; N];
        for k in 0..N {
            let (_, d) = self.view.facet(Direction::new(x[k], y[k], z[k]));
            pdf[k] = if d == 0.0 { 0.0 } else { d * self.view.factor };
        }
        pdf
    }
}

impl pulp::NullaryFnOnce for Densities<'_> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        let out = std::mem::take(&mut self.out);
        let (many, rest) = self.wi.as_chunks::<LANES>();
        let (to_many, to_rest) = out.as_chunks_mut::<LANES>();
        for (wi, out) in many.iter().zip(to_many) {
            *out = self.of(wi);
        }
        for (wi, out) in rest.iter().zip(to_rest) {
            [*out] = self.of(&[*wi]);
        }
    }
}

/// Arguments of [`VisibleGgx::eval_rows`].
struct Values<'a> {
    view: &'a VisibleGgx<'a>,
    wi: &'a [Direction],
    channels: usize,
    out: &'a mut [f64],
}

impl Values<'_> {
    #[inline(always)]
    fn fill<const N: usize>(&mut self, at: usize, wi: &[Direction; N]) {
        let (view, wo) = (self.view, self.view.wo);
        let [x, y, z] = coordinates(wi);
        let [mut om, mut density, mut scale] = [[0.0; N]; 3];
        for k in 0..N {
            let wi = Direction::new(x[k], y[k], z[k]);
            (om[k], density[k]) = view.facet(wi);
            let masked = view.ggx.backfacing_area(wi);
            scale[k] = density[k] * (0.25 / (wo.z * wi.z + view.masked * wi.z + masked * wo.z));
        }
        let out = &mut self.out[at * self.channels..][..N * self.channels];
        for c in 0..self.channels {
            let value = view.reflected(c, &om, &scale);
            for k in 0..N {
                out[k * self.channels + c] = if density[k] == 0.0 { 0.0 } else { value[k] };
            }
        }
    }
}

impl pulp::NullaryFnOnce for Values<'_> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        let (many, rest) = self.wi.as_chunks::<LANES>();
        for (chunk, wi) in many.iter().enumerate() {
            self.fill(chunk * LANES, wi);
        }
        for (k, wi) in rest.iter().enumerate() {
            self.fill(many.len() * LANES + k, &[*wi]);
        }
    }
}
