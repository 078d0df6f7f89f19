//! Directions in the local shading frame.

use super::Figure;
use serde::{Deserialize, Serialize};

/// A direction in the local shading frame: +z is the surface normal, +x the
/// tangent, right-handed, pointing **away** from the surface. Meant to be of
/// unit length; gonio checks this of what a subject returns and never
/// normalises it silently.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(from = "[Figure; 3]", into = "[Figure; 3]")]
#[schemars(with = "[Figure; 3]")]
pub struct Direction {
    /// Along the tangent.
    pub x: f64,
    /// Along the bitangent.
    pub y: f64,
    /// Along the normal; cos θ of a unit direction.
    pub z: f64,
}

impl Direction {
    /// The surface normal.
    pub const NORMAL: Self = Self::new(0.0, 0.0, 1.0);

    /// From components, as they are.
    pub const fn new(x: f64, y: f64, z: f64) -> Self {
        Self { x, y, z }
    }

    /// From the polar angle `theta` (from +z) and the azimuth `phi` (from +x),
    /// in radians.
    #[inline]
    pub fn from_angles(theta: f64, phi: f64) -> Self {
        let (sin_theta, cos_theta) = theta.sin_cos();
        let (sin_phi, cos_phi) = phi.sin_cos();
        Self::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
    }

    /// Polar angle from +z in [0, π], accurate near the pole and the horizon.
    #[inline]
    pub fn theta(self) -> f64 {
        self.x.hypot(self.y).atan2(self.z)
    }

    /// Azimuth from +x in (−π, π].
    #[inline]
    pub fn phi(self) -> f64 {
        self.y.atan2(self.x)
    }

    /// cos θ, the component along the normal.
    #[inline]
    pub fn cos_theta(self) -> f64 {
        self.z
    }

    /// |cos θ|.
    #[inline]
    pub fn abs_cos_theta(self) -> f64 {
        self.z.abs()
    }

    /// Scalar product.
    #[inline]
    pub fn dot(self, other: Self) -> f64 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Vector product.
    #[inline]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    /// Euclidean length.
    #[inline]
    pub fn length(self) -> f64 {
        self.dot(self).sqrt()
    }

    /// The same direction at unit length; NaN components for a zero vector.
    #[inline]
    pub fn normalized(self) -> Self {
        self * (1.0 / self.length())
    }

    /// Reflected about `axis` (unit length): 2 (self·axis) axis − self.
    #[inline]
    pub fn reflected(self, axis: Self) -> Self {
        axis * (2.0 * self.dot(axis)) - self
    }

    /// The mirror direction about the surface normal: (−x, −y, z).
    #[inline]
    pub fn mirrored(self) -> Self {
        Self::new(-self.x, -self.y, self.z)
    }

    /// Rotated about the surface normal by `angle` radians.
    #[inline]
    pub fn rotated(self, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self::new(cos * self.x - sin * self.y, sin * self.x + cos * self.y, self.z)
    }

    /// Seen from the other side of the surface: (x, y, −z).
    #[inline]
    pub fn flipped(self) -> Self {
        Self::new(self.x, self.y, -self.z)
    }

    /// Whether both are strictly on the same side of the surface.
    #[inline]
    pub fn same_side(self, other: Self) -> bool {
        self.z * other.z > 0.0
    }

    /// Whether every component is finite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }

    /// The angle between two unit directions in radians, accurate when small.
    #[inline]
    pub fn angle(self, other: Self) -> f64 {
        self.cross(other).length().atan2(self.dot(other))
    }
}

impl From<[Figure; 3]> for Direction {
    fn from([x, y, z]: [Figure; 3]) -> Self {
        Self::new(x.0, y.0, z.0)
    }
}

impl From<Direction> for [Figure; 3] {
    fn from(d: Direction) -> Self {
        [d.x, d.y, d.z].map(Figure)
    }
}

impl From<[f64; 3]> for Direction {
    #[inline]
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self::new(x, y, z)
    }
}

impl From<Direction> for [f64; 3] {
    #[inline]
    fn from(d: Direction) -> Self {
        [d.x, d.y, d.z]
    }
}

impl std::ops::Add for Direction {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl std::ops::Sub for Direction {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl std::ops::Mul<f64> for Direction {
    type Output = Self;
    #[inline]
    fn mul(self, scale: f64) -> Self {
        Self::new(self.x * scale, self.y * scale, self.z * scale)
    }
}

impl std::ops::Neg for Direction {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}
