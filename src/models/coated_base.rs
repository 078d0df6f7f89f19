//! A diffuse base under a clear coat.

use super::mixture;
use std::f64::consts::PI;

/// Lambert's reflector of reflectance ρ under a dielectric interface: light passes
/// the coat, is reflected diffusely, and what the coat sends back from inside, the
/// share r, is reflected again and again (J. L. Saunderson, *Calculation of the
/// color of pigmented plastics*, JOSA 1942):
///
/// f = T(wo) T(wi) ρ/(π η² (1 − ρ r)).
///
/// By reciprocity of the interface what passes from inside is 1 − r = T̄/η², with
/// T̄ = ∫ T(w) cos θ/π the mean transmittance from outside. The base then gives
/// back T(wo) times the share ρ (1 − r)/(1 − ρ r) of the light, which is all of it
/// where ρ = 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CoatedBase {
    /// f/(T T), in sr⁻¹.
    value: f64,
    /// What leaves of the light that passes the coat.
    share: f64,
}

impl CoatedBase {
    /// With a base of `reflectance` ρ in [0, 1], `eta` ≥ 1 the index of the coat,
    /// and `mean` = T̄ in [0, 1].
    pub(crate) fn new(reflectance: f64, eta: f64, mean: f64) -> Self {
        let passes = mean / (eta * eta);
        // 1 − ρ r
        let absorbed = (1.0 - reflectance) + reflectance * passes;
        Self { value: reflectance / (PI * eta * eta * absorbed), share: reflectance * passes / absorbed }
    }

    /// f in sr⁻¹ between directions with these transmittances of the coat.
    #[inline]
    pub(crate) fn value(&self, passing_o: f64, passing_i: f64) -> f64 {
        self.value * passing_o * passing_i
    }

    /// Albedo at a direction with this transmittance.
    #[inline]
    pub(crate) fn albedo(&self, passing_o: f64) -> f64 {
        self.share * passing_o
    }
}

/// Two lobes, of which the first is drawn with its share of the albedo.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lobes {
    /// Probability of the first.
    pub first: f64,
    /// Probability of the second, 1 − `first` without its cancellation.
    pub second: f64,
}

impl Lobes {
    /// From the albedos of both; the second where both are black.
    #[inline]
    pub(crate) fn by_albedo(first: f64, second: f64) -> Self {
        let sum = first + second;
        if sum == 0.0 {
            return Self { first: 0.0, second: 1.0 };
        }
        Self { first: first / sum, second: second / sum }
    }

    /// The number `u` in [0, 1) chooses a lobe and is stretched to [0, 1) again:
    /// whether the first was chosen, and the number for it.
    #[inline]
    pub(crate) fn choose(&self, u: f64) -> (bool, f64) {
        let (lobe, rest) = mixture::choose([self.first, self.second], u);
        (lobe == 0, rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_white_base_gives_all_back() {
        for (eta, mean) in [(1.0, 1.0), (1.5, 0.9), (4.0, 0.3)] {
            let base = CoatedBase::new(1.0, eta, mean);
            assert!((base.albedo(0.7) - 0.7).abs() < 1e-15);
            assert_eq!(CoatedBase::new(0.0, eta, mean).value(1.0, 1.0), 0.0);
            // The sum over internal reflections, term by term.
            let (rho, r) = (0.6f64, 1.0 - mean / (eta * eta));
            let series: f64 = (0..400).map(|k| rho * (rho * r).powi(k) * (1.0 - r)).sum();
            assert!((CoatedBase::new(rho, eta, mean).albedo(1.0) - series).abs() < 1e-14);
        }
        // A coat of nothing leaves Lambert's reflector.
        assert!((CoatedBase::new(0.5, 1.0, 1.0).value(1.0, 1.0) - 0.5 / PI).abs() < 1e-16);
    }

    #[test]
    fn choice_uses_its_number_up() {
        let last = 1.0 - f64::EPSILON / 2.0;
        for (a, b) in [(0.3, 0.6), (1e-300, 1.0), (1.0, 1e-300), (0.0, 1.0), (1.0, 0.0), (0.1, 1e-17)] {
            let lobes = Lobes::by_albedo(a, b);
            for u in [0.0, 1e-17, 0.2, 1.0 / 3.0, 0.9, last] {
                let (first, rest) = lobes.choose(u);
                assert!((0.0..1.0).contains(&rest), "{a} {b} {u}: {rest}");
                assert!(if first { a > 0.0 } else { b > 0.0 }, "{a} {b} {u}");
            }
        }
        assert_eq!(Lobes::by_albedo(0.0, 0.0).choose(0.3), (false, 0.3));
        let lobes = Lobes::by_albedo(1.0, 3.0);
        assert_eq!((lobes.choose(0.125), lobes.choose(0.625)), ((true, 0.5), (false, 0.5)));
    }
}
