//! Roughness along both tangents.

use crate::bsdf::Direction;

/// Roughness α along the tangent and the bitangent, each in [1e-4, 1]; what it
/// means is up to the distribution (a slope for GGX and Beckmann, an angle in
/// radians for Torrance and Sparrow's Gaussian).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// Along +x.
    pub x: f64,
    /// Along +y.
    pub y: f64,
}

impl Roughness {
    /// The same `alpha` in all azimuths.
    #[inline]
    pub fn isotropic(alpha: f64) -> Self {
        Self { x: alpha, y: alpha }
    }

    /// As models declare it: `alpha_y` = 0 means as `alpha`. `Err` says what to
    /// type where `alpha_y` is between.
    pub fn declared(alpha: f64, alpha_y: f64) -> Result<Self, String> {
        match alpha_y {
            0.0 => Ok(Self::isotropic(alpha)),
            y if y < 1e-4 => Err("alpha_y must be 0, which means as alpha, or from 1e-4 to 1".into()),
            y => Ok(Self { x: alpha, y }),
        }
    }

    /// Whether both are equal.
    #[inline]
    pub fn is_isotropic(self) -> bool {
        self.x == self.y
    }

    /// (αx x, αy y, z): takes a view direction to the configuration of unit
    /// roughness, and a normal of unit roughness to the surface (E. Heitz,
    /// *Understanding the masking-shadowing function*, JCGT 2014, §5.3). Not
    /// of unit length.
    #[inline(always)]
    pub fn scale(self, d: Direction) -> Direction {
        Direction::new(self.x * d.x, self.y * d.y, d.z)
    }

    /// (mx/αx)² + (my/αy)².
    #[inline(always)]
    pub fn scaled_square(self, m: Direction) -> f64 {
        let (x, y) = (m.x / self.x, m.y / self.y);
        x * x + y * y
    }
}
