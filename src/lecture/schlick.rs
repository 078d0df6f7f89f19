//! Schlick's approximation is close for glass, and misses the dip of metals
//! before grazing.

use super::steps;
use crate::models::{Metal, fresnel};
use crate::report::{Line, LinePlot};

const GLASS: f64 = 1.5;

pub(super) fn plot() -> LinePlot {
    let both = |name: &str, colour, exact: &dyn Fn(f64) -> f64| {
        let at = |f: &dyn Fn(f64) -> f64| {
            steps(0.0, 90.0, 360).map(|d| (d, f(d.to_radians().cos()))).collect::<Vec<_>>()
        };
        let f0 = exact(1.0);
        [
            Line::new(name, colour, at(exact)),
            Line::new(format!("{name}, Schlick"), colour, at(&|cos| fresnel::schlick(cos, f0))).dashed(),
        ]
    };
    // Green light.
    let metal = |metal: Metal| {
        let (n, k) = metal.index()[1];
        move |cos: f64| fresnel::conductor(cos, n, k)
    };
    LinePlot {
        title: "Schlick against Fresnel".into(),
        note: "Good to 0.04 for glass; a metal's dip before grazing is not in it.".into(),
        x_name: "θ in degrees".into(),
        y_name: "reflectance".into(),
        x: (0.0, 90.0),
        y: (0.0, 1.0),
        lines: [
            both("glass, η = 1.5", 0, &|cos| fresnel::dielectric(cos, GLASS)),
            both("copper", 1, &metal(Metal::Copper)),
            both("aluminium", 2, &metal(Metal::Aluminium)),
        ]
        .concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn close_for_glass_and_blind_to_the_dip_of_metals() {
        let plot = plot();
        let errors = |k: usize| -> Vec<f64> {
            let pairs = plot.lines[2 * k].points.iter().zip(&plot.lines[2 * k + 1].points);
            pairs.map(|(exact, schlick)| schlick.1 - exact.1).collect()
        };
        let worst = |k| errors(k).into_iter().fold(0.0, |w: f64, e| w.max(e.abs()));
        assert!(worst(0) > 0.03 && worst(0) < 0.04, "{}", worst(0));
        // Aluminium's reflectance falls below that at normal incidence, Schlick's never does.
        let aluminium = &plot.lines[4].points;
        let least = aluminium.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert!(least.0 > 70.0 && least.1 < aluminium[0].1 - 0.03, "{least:?}");
        assert!(plot.lines[5].points.windows(2).all(|w| w[1].1 >= w[0].1));
        assert!(worst(2) > 0.05, "{}", worst(2));
    }
}
