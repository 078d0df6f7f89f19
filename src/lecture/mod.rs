//! Figures of a lecture on reflection, drawn from gonio's own models: one file a
//! figure, each with a test of the point that it makes.

mod copper;
mod distributions;
mod factored;
mod off_specular;
mod proposals;
mod schlick;
mod shadowing;

use crate::report::LinePlot;

/// A figure that can be drawn.
pub struct LectureFigure {
    /// Its name: that of its file.
    pub name: &'static str,
    /// What it shows.
    pub doc: &'static str,
    /// Makes it.
    pub plot: fn() -> LinePlot,
}

/// Every figure, in the order of the lecture.
pub fn all() -> [LectureFigure; 11] {
    [
        LectureFigure {
            name: "copper-angle",
            doc: "copper's reflectance against angle, at three wavelengths",
            plot: copper::against_angle,
        },
        LectureFigure {
            name: "copper-wavelength",
            doc: "copper's reflectance against wavelength, at four angles",
            plot: copper::against_wavelength,
        },
        LectureFigure {
            name: "schlick",
            doc: "Schlick's approximation against Fresnel's equations, for glass and metals",
            plot: schlick::plot,
        },
        LectureFigure {
            name: "distributions",
            doc: "Beckmann, Gaussian and GGX side by side: the longer tail of GGX",
            plot: distributions::plot,
        },
        LectureFigure { name: "shadowing", doc: "Smith's shadowing against angle", plot: shadowing::plot },
        LectureFigure {
            name: "off-specular-magnesium-oxide",
            doc: "the off-specular peak of Torrance and Sparrow, for a dielectric",
            plot: off_specular::magnesium_oxide,
        },
        LectureFigure {
            name: "off-specular-aluminium",
            doc: "the off-specular peak of Torrance and Sparrow, for a metal",
            plot: off_specular::aluminium,
        },
        LectureFigure {
            name: "factored-cook-torrance",
            doc: "factored sampling beside uniform, cosine and best-fit-lobe sampling, glossy",
            plot: factored::cook_torrance,
        },
        LectureFigure {
            name: "factored-oren-nayar",
            doc: "the same for diffuse reflection",
            plot: factored::oren_nayar,
        },
        LectureFigure { name: "factored-ward", doc: "the same for Ward's lobe", plot: factored::ward },
        LectureFigure {
            name: "factored-anisotropic",
            doc: "the same for anisotropic glossy reflection",
            plot: factored::anisotropic,
        },
    ]
}

/// A table that can be written.
pub struct LectureTable {
    /// Its name: that of its file.
    pub name: &'static str,
    /// What it shows.
    pub doc: &'static str,
    /// Makes it.
    pub text: fn() -> String,
}

/// Every table.
pub fn tables() -> [LectureTable; 1] {
    [LectureTable {
        name: "factored-efficiency",
        doc: "χ², variance and largest weight of factored, uniform, cosine and best-fit-lobe sampling",
        text: factored::table,
    }]
}

/// `n` + 1 even steps from `from` to `to`.
fn steps(from: f64, to: f64, n: u32) -> impl Iterator<Item = f64> {
    (0..=n).map(move |k| from + (to - from) * f64::from(k) / f64::from(n))
}
