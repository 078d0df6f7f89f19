//! What Smith's function leaves visible, against angle.

use super::steps;
use crate::bsdf::Direction;
use crate::models::microfacet::{Distribution, Roughness};
use crate::report::{Line, LinePlot};

pub(super) fn plot() -> LinePlot {
    let line = |name: &str, colour, make: fn(Roughness) -> Distribution, alpha: f64| {
        let d = make(Roughness::isotropic(alpha));
        let at = |degrees: f64| (degrees, d.g1(Direction::from_angles(degrees.to_radians(), 0.0)));
        Line::new(format!("{name}, α = {alpha}"), colour, steps(0.0, 89.9, 900).map(at).collect())
    };
    let pair = |(colour, alpha)| {
        [
            line("GGX", colour, Distribution::ggx, alpha),
            line("Beckmann", colour, Distribution::beckmann, alpha).dashed(),
        ]
    };
    LinePlot {
        title: "Smith's shadowing".into(),
        note: "The share of facets that is seen falls to 0 at grazing, sooner on rougher surfaces.".into(),
        x_name: "θ in degrees".into(),
        y_name: "G1".into(),
        x: (0.0, 90.0),
        y: (0.0, 1.0),
        lines: [0.1, 0.3, 0.6, 1.0].into_iter().enumerate().flat_map(pair).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn falls_with_angle_and_roughness_and_further_for_ggx() {
        let lines = plot().lines;
        for line in &lines {
            assert!(line.points.windows(2).all(|w| w[1].1 <= w[0].1 + 1e-12), "{}", line.name);
            assert!((line.points[0].1 - 1.0).abs() < 1e-12 && line.points[900].1 < 0.1);
        }
        for k in 0..lines.len() - 2 {
            assert!(lines[k + 2].points[600].1 < lines[k].points[600].1);
        }
        for pair in lines.chunks(2) {
            assert!(pair[0].points[700].1 < pair[1].points[700].1, "{}", pair[0].name);
        }
    }
}
