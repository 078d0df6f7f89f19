//! Copper is red because its reflectance falls where blue begins, and loses its
//! colour at grazing angles, where everything reflects.

use super::steps;
use crate::models::{Metal, fresnel};
use crate::report::{Line, LinePlot};

/// Wavelength in nm, n and k of copper: H.-J. Hagemann, W. Gudat and C. Kunz,
/// *Optical constants from the far infrared to the x-ray region*, DESY report
/// SR-74/7 (1974), table 3, from 3.0 down to 1.85 eV.
const INDEX: [(f64, f64, f64); 10] = [
    (413.3, 1.184, 2.21),
    (442.8, 1.169, 2.36),
    (476.9, 1.152, 2.50),
    (516.6, 1.121, 2.60),
    (539.1, 1.037, 2.59),
    (563.6, 0.826, 2.60),
    (590.4, 0.468, 2.81),
    (619.9, 0.272, 3.24),
    (652.5, 0.214, 3.67),
    (670.2, 0.215, 3.86),
];

fn plot(title: &str, note: &str, x_name: &str, x: (f64, f64), lines: Vec<Line>) -> LinePlot {
    LinePlot {
        title: title.into(),
        note: note.into(),
        x_name: x_name.into(),
        y_name: "reflectance".into(),
        x,
        y: (0.4, 1.0),
        lines,
    }
}

/// The channels of the model `conductor`.
pub(super) fn against_angle() -> LinePlot {
    let line = |c: usize, colour| {
        let (n, k) = Metal::Copper.index()[c];
        let at = |degrees: f64| (degrees, fresnel::conductor(degrees.to_radians().cos(), n, k));
        Line::new(Metal::WAVELENGTHS[c], colour, steps(0.0, 90.0, 180).map(at).collect())
    };
    plot(
        "Copper against angle",
        "Red, green and blue meet at 1: at grazing angles copper is a white mirror.",
        "θ in degrees",
        (0.0, 90.0),
        vec![line(0, 1), line(1, 2), line(2, 0)],
    )
}

pub(super) fn against_wavelength() -> LinePlot {
    let line = |(colour, degrees): (usize, f64)| {
        let cos = degrees.to_radians().cos();
        let at = |(nm, n, k): (f64, f64, f64)| (nm, fresnel::conductor(cos, n, k));
        Line::new(format!("θ = {degrees}°"), colour, INDEX.map(at).to_vec())
    };
    plot(
        "Copper against wavelength",
        "The edge near 580 nm is what makes copper red; it flattens towards grazing angles.",
        "wavelength in nm",
        (400.0, 680.0),
        [0.0, 60.0, 80.0, 88.0].into_iter().enumerate().map(line).collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copper_is_red_and_turns_white() {
        let plot = against_angle();
        let at = |line: usize, degrees: f64| {
            plot.lines[line].points.iter().find(|p| p.0 == degrees).expect("a step").1
        };
        let colour = |degrees| at(0, degrees) - at(2, degrees);
        assert!(colour(0.0) > 0.3, "{}", colour(0.0));
        assert!(colour(89.0) < 0.2 * colour(0.0) && at(2, 90.0) > 0.999_999, "{}", colour(89.0));
    }

    #[test]
    fn the_edge_flattens_and_both_measurements_agree() {
        let plot = against_wavelength();
        let rise = |line: usize| plot.lines[line].points[9].1 - plot.lines[line].points[0].1;
        assert!((0..3).all(|k| rise(k) > rise(k + 1)), "{:?}", [0, 1, 2, 3].map(rise));
        // Johnson and Christy's copper, the model's, at 616.8 and 450.9 nm.
        let model = against_angle();
        for (line, nm) in [(0, 619.9), (2, 442.8)] {
            let other = plot.lines[0].points.iter().find(|p| p.0 == nm).unwrap().1;
            assert!((model.lines[line].points[0].1 - other).abs() < 0.02);
        }
    }
}
