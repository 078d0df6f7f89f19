//! Complex indices of refraction of four metals.

/// Metals whose complex index n + ik is known at [`Metal::WAVELENGTHS`].
///
/// Gold, silver and copper: P. B. Johnson and R. W. Christy, *Optical constants
/// of the noble metals*, Phys. Rev. B 6, 4370 (1972), the rows at 2.01, 2.26
/// and 2.75 eV as tabulated. Aluminium: A. D. Rakić, *Algorithm for the
/// determination of intrinsic optical constants of metal films: application to
/// aluminum*, Appl. Opt. 34, 4755 (1995), between whose rows at 442.80, 476.87,
/// 516.60, 563.57 and 619.93 nm n and k are interpolated linearly in wavelength.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metal {
    /// Al.
    Aluminium,
    /// Au.
    Gold,
    /// Ag.
    Silver,
    /// Cu.
    Copper,
}

impl Metal {
    /// Vacuum wavelengths of the channels.
    pub const WAVELENGTHS: [&str; 3] = ["616.8nm", "548.6nm", "450.9nm"];

    /// Names, as parameters spell them.
    pub(super) const NAMES: [&str; 4] = ["aluminium", "gold", "silver", "copper"];

    /// The metal of one of [`Self::NAMES`].
    pub(super) fn named(name: &str) -> Self {
        match name {
            "gold" => Self::Gold,
            "silver" => Self::Silver,
            "copper" => Self::Copper,
            _ => Self::Aluminium,
        }
    }

    /// (n, k) at each of [`Self::WAVELENGTHS`].
    pub fn index(self) -> [(f64, f64); 3] {
        match self {
            Self::Aluminium => [(1.3497, 7.3707), (1.0093, 6.6111), (0.6364, 5.4652)],
            Self::Gold => [(0.21, 3.272), (0.43, 2.455), (1.38, 1.914)],
            Self::Silver => [(0.06, 4.152), (0.06, 3.586), (0.04, 2.657)],
            Self::Copper => [(0.30, 3.205), (1.02, 2.577), (1.24, 2.397)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::fresnel;

    /// Reflectances at normal incidence from an independent measurement at 620,
    /// 550 and 450 nm: K. M. McPeak et al., *Plasmonic films can easily be
    /// better: rules and recipes*, ACS Photonics 2, 326 (2015).
    #[test]
    fn reflects_as_another_measurement() {
        let published = [
            (Metal::Aluminium, [0.9084, 0.9157, 0.9219], 0.005),
            (Metal::Gold, [0.9521, 0.8475, 0.3904], 0.07),
            (Metal::Silver, [0.9895, 0.9876, 0.9802], 0.01),
            (Metal::Copper, [0.9640, 0.6747, 0.5816], 0.07),
        ];
        for (metal, expected, tolerance) in published {
            for ((n, k), r) in metal.index().into_iter().zip(expected) {
                let f = fresnel::conductor(1.0, n, k);
                let direct = ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k);
                assert!((f - direct).abs() < 1e-14);
                assert!((f - r).abs() < tolerance, "{metal:?}: {f} against {r}");
            }
        }
    }
}
