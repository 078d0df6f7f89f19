//! Beckmann, Gaussian and GGX at one roughness: alike near the normal, and far
//! apart in the tail.

use super::steps;
use crate::bsdf::Direction;
use crate::models::microfacet::{Distribution, Roughness};
use crate::report::{Line, LinePlot};

const ALPHA: f64 = 0.2;

pub(super) fn plot() -> LinePlot {
    let alpha = Roughness::isotropic(ALPHA);
    let line = |name: &str, colour, d: Distribution| {
        let at = |degrees: f64| {
            let m = Direction::from_angles(degrees.to_radians(), 0.0);
            (degrees, d.density(m).log10())
        };
        Line::new(name, colour, steps(0.0, 89.5, 358).map(at).collect())
    };
    LinePlot {
        title: format!("Distributions of normals, α = {ALPHA}"),
        note: "Alike near the normal; the tail of GGX is longer by orders of magnitude.".into(),
        x_name: "θm in degrees".into(),
        y_name: "log₁₀ D in sr⁻¹".into(),
        x: (0.0, 90.0),
        y: (-6.0, 2.0),
        lines: vec![
            line("GGX", 0, Distribution::ggx(alpha)),
            line("Beckmann", 1, Distribution::beckmann(alpha)),
            line("Gaussian", 2, Distribution::gaussian(alpha)),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ggx_has_the_longer_tail() {
        let plot = plot();
        let at = |name: &str, degrees: f64| {
            plot.line(name).unwrap().points.iter().find(|p| p.0 == degrees).unwrap().1
        };
        for other in ["Beckmann", "Gaussian"] {
            assert!((at("GGX", 0.0) - at(other, 0.0)).abs() < 0.02, "{other}");
            assert!(at("GGX", 10.0) < at(other, 10.0));
            assert!(at("GGX", 40.0) > at(other, 40.0) + 3.0);
        }
    }
}
