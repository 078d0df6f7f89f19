//! What the single-scattering GGX lobe loses, tabulated.

use super::chebyshev;
use crate::models::memo::Memo;
use std::sync::Arc;

/// Panels of the table of the loss and of the density of [`GgxLoss::sample`], and
/// terms of the polynomial in each: as many as bring the error below 1e-8 for
/// every α, see the tests.
const PANELS: usize = 24;
const TERMS: usize = 10;

/// Step of [`Rule`] and number of steps each way: features at the ends are analytic
/// in a strip of π/2 about the logit, so errors are e^(−π²/0.4) = 2e-11, and e^(−30)
/// is left out at each end.
const STEP: f64 = 0.4;
const STEPS: i32 = 75;

/// 1 − E(μ), with E the directional albedo at cos θ = μ of the isotropic GGX lobe
/// with height-correlated Smith masking and F = 1, for one α in [1e-4, 1]; its
/// mean over the hemisphere, and directions drawn in proportion to it.
///
/// The loss is 0 at grazing, where it goes as μ ln μ, largest about μ = α, and
/// falls as (α/μ)² beyond. Both tables run over v = ln(1 + μ/α)/ln(1 + 1/α) from 0
/// to 1, in which the mean loss of small α is spread evenly: the one of the loss
/// over w = v^¼, holding it over w² (1 + μ/α)⁻².
#[derive(Clone, Debug)]
pub struct GgxLoss {
    alpha: f64,
    /// ln(1 + 1/α).
    range: f64,
    /// Powers of the place in each panel, −1 to 1.
    loss: Vec<[f64; TERMS]>,
    average: f64,
    lobe: Vec<LobePanel>,
}

/// A piece of the density of [`GgxLoss::sample`] over v.
#[derive(Clone, Debug)]
struct LobePanel {
    /// Powers of the place in the panel, −1 to 1, of the density in that place.
    density: [f64; TERMS],
    /// And of its integral from −1 over the place: c + x Σ c_k xᵏ.
    constant: f64,
    integral: [f64; TERMS],
    /// Share of the draws below the panel, and in it.
    below: f64,
    share: f64,
}

impl GgxLoss {
    /// The table of this `alpha` in [1e-4, 1], made by quadrature in about a
    /// millisecond, once.
    pub fn of(alpha: f64) -> Arc<Self> {
        static KNOWN: Memo<u64, GgxLoss> = Memo::new();
        KNOWN.of(alpha.to_bits(), || Self::new(alpha))
    }

    fn new(alpha: f64) -> Self {
        let rule = Rule::new();
        let range = (1.0 / alpha).ln_1p();
        let mut table = Self { alpha, range, loss: Vec::new(), average: 0.0, lobe: Vec::new() };
        for p in 0..PANELS {
            table.loss.push(polynomial(|x| {
                let w = (p as f64 + 0.5 * (1.0 + x)) / PANELS as f64;
                let mu = table.cosine(w.powi(4));
                rule.loss(alpha, mu) * ((1.0 + mu / alpha) / w).powi(2)
            }));
        }
        let half = 0.5 / PANELS as f64;
        for p in 0..PANELS {
            let density = polynomial(|x| {
                let v = (2.0 * p as f64 + 1.0 + x) * half;
                let mu = table.cosine(v);
                2.0 * table.at(mu) * mu * (mu + alpha) * range * half
            });
            let panel = LobePanel::new(density, table.average);
            table.average += panel.share;
            table.lobe.push(panel);
        }
        let average = table.average;
        for panel in &mut table.lobe {
            *panel = LobePanel::new(panel.density.map(|c| c / average), panel.below / average);
        }
        table
    }

    /// The roughness.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }

    /// μ where ln(1 + μ/α)/ln(1 + 1/α) is `v`.
    #[inline]
    fn cosine(&self, v: f64) -> f64 {
        (self.alpha * (v * self.range).exp_m1()).min(1.0)
    }

    /// 1 − E(μ), at `mu` = cos θ in [0, 1].
    #[inline]
    pub fn at(&self, mu: f64) -> f64 {
        let x = mu / self.alpha;
        let w2 = (x.ln_1p() / self.range).sqrt();
        let place = w2.sqrt() * PANELS as f64;
        let panel = (place as usize).min(PANELS - 1);
        let polynomial = value(&self.loss[panel], 2.0 * (place - panel as f64) - 1.0);
        // Interpolation may dip below 0 by its error.
        (w2 * polynomial / ((1.0 + x) * (1.0 + x))).max(0.0)
    }

    /// Its mean over the hemisphere, 2∫(1 − E) μ dμ: Kulla and Conty's 1 − E_avg.
    #[inline]
    pub fn average(&self) -> f64 {
        self.average
    }

    /// cos θ of a direction whose density per steradian is
    /// (1 − E(μ)) μ/(π (1 − E_avg)), by inversion of `u` in [0, 1).
    pub fn sample(&self, u: f64) -> f64 {
        let k = self.lobe.partition_point(|p| p.below <= u).max(1) - 1;
        let panel = &self.lobe[k];
        let wanted = u - panel.below;
        // Newton's method, which bisection keeps within its bracket.
        let (mut low, mut high) = (-1.0, 1.0);
        let mut x = (2.0 * wanted / panel.share - 1.0).clamp(low, high);
        for _ in 0..60 {
            let off = panel.mass(x) - wanted;
            if off > 0.0 {
                high = x
            } else {
                low = x
            }
            let newton = x - off / value(&panel.density, x);
            let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
            let step = (next - x).abs();
            x = next;
            // The error of the next is like the square of this step.
            if step < SMALL_STEP {
                break;
            }
        }
        self.cosine((2.0 * k as f64 + 1.0 + x) * 0.5 / PANELS as f64)
    }
}

impl LobePanel {
    /// With this density, of a panel below which is the share `below`.
    fn new(density: [f64; TERMS], below: f64) -> Self {
        let integral = std::array::from_fn(|k| density[k] / (k + 1) as f64);
        let constant = value(&integral, -1.0);
        let mut panel = Self { density, constant, integral, below, share: 0.0 };
        panel.share = panel.mass(1.0);
        panel
    }

    /// The draws from the lower end of the panel to the place `x` in it.
    fn mass(&self, x: f64) -> f64 {
        self.constant + x * value(&self.integral, x)
    }
}

/// Powers of x of the polynomial through `f` at `N` Chebyshev points of [−1, 1].
fn polynomial<const N: usize>(f: impl FnMut(f64) -> f64) -> [f64; N] {
    let values: Vec<f64> = chebyshev::points(N).map(f).collect();
    let mut powers = chebyshev::powers(&chebyshev::coefficients(&values));
    powers.resize(N, 0.0);
    powers.try_into().expect("as many as points")
}

/// A step in a panel after which [`GgxLoss::sample`] is at rounding.
const SMALL_STEP: f64 = 1e-9;

#[inline]
fn value(powers: &[f64], x: f64) -> f64 {
    powers.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// The trapezoidal rule in the logit of the place between two ends: points
/// gather exponentially at both, so that a feature at an end needs no scale.
struct Rule {
    /// Share of the way from the first end, from the second, and the weight.
    points: Vec<(f64, f64, f64)>,
}

impl Rule {
    fn new() -> Self {
        let point = |k: i32| {
            let x = STEP * f64::from(k);
            let (first, second) = (1.0 / (1.0 + (-x).exp()), 1.0 / (1.0 + x.exp()));
            (first, second, STEP * first * second)
        };
        Self { points: (-STEPS..=STEPS).map(point).collect() }
    }

    /// 1 − E(μo), as a sum of positive terms.
    ///
    /// Light off visible normals leaves with density p(wi) = D G1(wo)/(4 cos θo),
    /// on both sides of the horizon, and integrates to 1 (the weak white furnace).
    /// Lost is what leaves below, and the share 1 − G2/G1 above. G2 does not depend
    /// on the azimuth φ between both directions, and ∫p dφ is elementary: with
    /// |wo + wi|² = P + Q cos φ, P = 2 + 2 μo μi, Q = 2 sin θo sin θi, M =
    /// (μo + μi)² and P' = P − (1 − α²) M,
    /// D = (α²/π) ((P + Q cos φ)/(P' + Q cos φ))².
    fn loss(&self, alpha: f64, mu: f64) -> f64 {
        let a2 = alpha * alpha;
        let sin2_o = (1.0 - mu) * (1.0 + mu);
        let sin_o = sin2_o.sqrt();
        // cos θ Λ(θ).
        let hidden = |cos: f64, sin2: f64| 0.5 * a2 * sin2 / (cos + (cos * cos + a2 * sin2).sqrt());
        let o = hidden(mu, sin2_o);
        // ∫p dφ at μi but for the factor α²/(2 (μo + o)), and sin²θi; `off` is
        // μi − μo and `sum` μi + μo, neither of which may be formed here.
        let density = |cos_i: f64, off: f64, sum: f64| {
            let sin2_i = ((1.0 - mu - off) * (1.0 + cos_i)).max(0.0);
            let sin_i = sin2_i.sqrt();
            let m = sum * sum;
            let difference = off * sum / (sin_o + sin_i);
            let total = sin_o + sin_i;
            // P'² − Q².
            let r = (difference * difference + a2 * m) * (total * total + a2 * m);
            let gap = (1.0 - a2) * m;
            (1.0 + (2.0 * gap + gap * gap * (sin2_o + sin2_i + a2 * m) / r) / r.sqrt(), sin2_i)
        };
        // 1 − G2/G1 times the density.
        let above = |cos_i: f64, off: f64| {
            let (density, sin2_i) = density(cos_i, off, mu + cos_i);
            let i = hidden(cos_i, sin2_i);
            density * i * mu / (mu * cos_i + o * cos_i + i * mu)
        };
        let top = 1.0 - mu;
        let sum: f64 = self
            .points
            .iter()
            .map(|&(first, second, weight)| {
                let below = density(-mu * second, -mu - mu * second, mu * first).0;
                let to_mirror = above(mu * first, -mu * second);
                let beyond = if top > 0.0 { above(mu + top * first, top * first) } else { 0.0 };
                weight * (mu * (below + to_mirror) + top * beyond)
            })
            .sum();
        if mu > 0.0 { 0.5 * a2 * sum / (mu + o) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Distribution, Fresnel, Masking, NormalSampling, Roughness, TorranceSparrow};
    use super::*;
    use crate::bsdf::{Bsdf, Direction, Transport};
    use std::time::{Duration, Instant};

    const ALPHAS: [f64; 8] = [1e-4, 1e-3, 0.01, 0.05, 0.2, 0.5, 0.8, 1.0];

    /// ∫ G2/(4 μo (…)) over the hemisphere at α = 1 and normal incidence is
    /// ∫ μ/(1 + μ) dμ = 1 − ln 2.
    #[test]
    fn keeps_1_minus_ln_2_at_alpha_1_and_normal_incidence() {
        let kept = 1.0 - GgxLoss::of(1.0).at(1.0);
        assert!((kept - (1.0 - 2f64.ln())).abs() < 1e-9, "{kept}");
        assert!((Rule::new().loss(1.0, 1.0) - 2f64.ln()).abs() < 1e-12);
    }

    /// The mean weight of evenly spread draws of visible normals, of a model that
    /// knows nothing of the table.
    #[test]
    fn is_what_drawn_weights_lack() {
        let (n, m) = (4000, 100);
        for alpha in [1e-3, 0.1, 0.5, 1.0] {
            let single = TorranceSparrow::new(
                Distribution::ggx(Roughness::isotropic(alpha)),
                Masking::Smith,
                Fresnel::None,
                NormalSampling::Visible,
            )
            .unwrap();
            for theta in [0.0f64, 45.0, 75.0, 85.0] {
                let wo = Direction::from_angles(theta.to_radians(), 0.3);
                let even = |k: i32, n: i32| (f64::from(k) + 0.5) / f64::from(n);
                let kept: f64 = (0..n * m)
                    .map(|k| [even(k / m, n), even(k % m, m)])
                    .filter_map(|u| single.sample(wo, &u, Transport::Radiance))
                    .map(|s| s.weight[0])
                    .sum();
                let loss = 1.0 - kept / f64::from(n * m);
                let table = GgxLoss::of(alpha).at(wo.z);
                assert!((table - loss).abs() < 1e-5, "{alpha} {theta}: {table} against {loss}");
            }
        }
    }

    #[test]
    fn the_table_follows_the_quadrature() {
        let rule = Rule::new();
        for alpha in ALPHAS {
            let table = GgxLoss::of(alpha);
            for i in 0..=1000 {
                let mu = (f64::from(i) / 1000.0).powi(4);
                let (value, exact) = (table.at(mu), rule.loss(alpha, mu));
                assert!((value - exact).abs() < 1e-8, "{alpha} {mu}: {value} against {exact}");
                assert!(value >= 0.0 && (i < 5 || (value / exact - 1.0).abs() < 0.05), "{alpha} {mu}");
            }
            assert_eq!(table.at(0.0), 0.0);
        }
    }

    /// Both sides of the inversion, and the mean by another rule.
    #[test]
    fn draws_in_proportion_to_the_loss() {
        for alpha in ALPHAS {
            let table = GgxLoss::of(alpha);
            let n = 400_000;
            let mean: f64 = (0..n)
                .map(|k| {
                    // Even steps of μ^(1/4), as the loss of small α is near 0.
                    let root = (f64::from(k) + 0.5) / f64::from(n);
                    2.0 * table.at(root.powi(4)) * root.powi(7) * 4.0 / f64::from(n)
                })
                .sum();
            assert!((mean / table.average() - 1.0).abs() < 1e-6, "{alpha}: {mean} {}", table.average());
            let h = 1e-6;
            for i in 1..200 {
                let u = f64::from(i) / 200.0;
                let mu = table.sample(u);
                let slope = (table.sample(u + h) - table.sample(u - h)) / (2.0 * h);
                let density = 2.0 * table.at(mu) * mu / table.average();
                assert!((slope * density - 1.0).abs() < 1e-5, "{alpha} {u}: {}", slope * density);
            }
            for u in [0.0, 1e-300, 1.0 - f64::EPSILON / 2.0] {
                assert!((0.0..=1.0).contains(&table.sample(u)), "{alpha} {u}");
            }
        }
    }

    #[test]
    fn tables_are_shared_and_made_in_milliseconds() {
        let first = GgxLoss::of(0.123);
        assert!(Arc::ptr_eq(&first, &GgxLoss::of(0.123)));
        let fastest = (0..20)
            .map(|_| {
                let start = Instant::now();
                assert!(GgxLoss::new(0.3).average() > 0.0);
                start.elapsed()
            })
            .min();
        assert!(fastest.unwrap() < Duration::from_millis(10), "{fastest:?}");
    }
}
