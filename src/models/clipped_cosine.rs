//! Linearly transformed cosines, clipped to the upper hemisphere.

use crate::bsdf::Direction;
use crate::sphere::sin_cos_turns;
use std::f64::consts::PI;

/// Directions M w/|M w| of the upper hemisphere, with M the matrix of the rows
/// (a, 0, b), (0, c, 0), (d, 0, 1) and w a direction drawn by its cosine among
/// those that M leaves above the horizon (J. Portsmouth, P. Kutz and S. Hill,
/// *EON: a practical energy-preserving rough diffuse BRDF*, JCGT 14, 2025, §4;
/// after E. Heitz et al., *Real-time polygonal-light shading with linearly
/// transformed cosines*, 2016).
#[derive(Clone, Copy, Debug)]
pub(super) struct ClippedCosine {
    a: f64,
    b: f64,
    c: f64,
    d: f64,
    /// Share of the cosine that is not clipped.
    kept: f64,
}

impl ClippedCosine {
    /// For a, c > 0, d ≤ 0 and a > b d.
    #[inline]
    pub(super) fn new(a: f64, b: f64, c: f64, d: f64) -> Self {
        // The horizon of M w is the plane d x + z = 0. Seen from above, it halves
        // the disc by an ellipse whose half axis is the cosine of its tilt.
        Self { a, b, c, d, kept: 0.5 * (1.0 + 1.0 / (1.0 + d * d).sqrt()) }
    }

    /// Whether it may be drawn from, see [`Self::new`].
    #[cfg(test)]
    pub(super) fn is_valid(&self) -> bool {
        self.a > 0.0 && self.c > 0.0 && self.d <= 0.0 && self.a > self.b * self.d
    }

    /// The density per steradian at `w` with w.z > 0.
    #[inline]
    pub(super) fn pdf(&self, w: Direction) -> f64 {
        let Self { a, b, c, d, kept } = *self;
        let minor = a - b * d;
        // M⁻¹ w times det M/c.
        let back = Direction::new(w.x - b * w.z, minor / c * w.y, a * w.z - d * w.x);
        if back.z <= 0.0 {
            return 0.0;
        }
        // cos/π over what is kept, times the area that M takes away,
        // 1/(det M |M⁻¹ w|³); det M = c · minor.
        let square = back.dot(back);
        back.z * minor * minor / (c * PI * kept * square * square)
    }

    /// A direction, by `u` in [0, 1)²; w.z may round to 0.
    #[inline]
    pub(super) fn sample(&self, u: &[f64]) -> Direction {
        let r = u[0].sqrt();
        let (sin, cos) = sin_cos_turns(u[1]);
        let (x, y) = (r * cos, r * sin);
        // Chords of the disc shrink to what is kept of them, on the side of −x.
        let chord = (1.0 - y * y).max(0.0).sqrt();
        let x = self.kept * (chord - x) - chord;
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        Direction::new(self.a * x + self.b * z, self.c * y, self.d * x + z).normalized()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [(f64, f64, f64, f64); 4] =
        [(1.0, 0.0, 1.0, 0.0), (1.02, 0.8, 1.2, -0.5), (0.96, 0.3, 0.97, -0.2), (1.0, 0.5, 1.0, 0.0)];

    #[test]
    fn density_is_normalised() {
        for (a, b, c, d) in ALL {
            let lobe = ClippedCosine::new(a, b, c, d);
            let (n, m) = (2000, 400);
            let mut sum = 0.0;
            for i in 0..n {
                let z = (f64::from(i) + 0.5) / f64::from(n);
                for j in 0..m {
                    let phi = (f64::from(j) + 0.5) / f64::from(m) * 2.0 * PI;
                    sum += lobe.pdf(Direction::from_angles(z.acos(), phi));
                }
            }
            let mass = sum * 2.0 * PI / f64::from(n * m);
            assert!((mass - 1.0).abs() < 1e-5, "{lobe:?}: {mass}");
        }
    }

    /// The area that u covers, by central differences, is the density's inverse.
    #[test]
    fn sampling_follows_the_density() {
        let h = 1e-6;
        for (a, b, c, d) in ALL {
            let lobe = ClippedCosine::new(a, b, c, d);
            for (u, v) in [(0.05, 0.1), (0.3, 0.36), (0.6, 0.7), (0.97, 0.9), (0.9, 0.5), (0.9, 0.02)] {
                let at = |u, v| lobe.sample(&[u, v]);
                let du = at(u + h, v) - at(u - h, v);
                let dv = at(u, v + h) - at(u, v - h);
                let area = du.cross(dv).length() / (4.0 * h * h);
                let w = at(u, v);
                assert!(w.z > 0.0 && (area * lobe.pdf(w) - 1.0).abs() < 1e-5, "{lobe:?} {u} {v}");
            }
        }
    }

    #[test]
    fn without_a_transform_it_is_the_cosine() {
        let lobe = ClippedCosine::new(1.0, 0.0, 1.0, 0.0);
        let w = Direction::from_angles(0.7, 0.3);
        assert!((lobe.pdf(w) - w.z / PI).abs() < 1e-15);
    }
}
