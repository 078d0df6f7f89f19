//! What the course gives you: vectors, samples, and the three models with their
//! parameters. You write their functions, in brdf.rs.
//!
//! Directions are unit vectors that point away from the surface, whose normal is +z:
//! cos θ is the z of a direction. wo is given, wi is sampled.

use std::ops::{Add, Div, Mul, Neg, Sub};

pub use std::f64::consts::PI;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3 {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

pub const fn vec3(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3 { x, y, z }
}

impl Vec3 {
    pub fn dot(self, b: Vec3) -> f64 {
        self.x * b.x + self.y * b.y + self.z * b.z
    }

    pub fn cross(self, b: Vec3) -> Vec3 {
        vec3(self.y * b.z - self.z * b.y, self.z * b.x - self.x * b.z, self.x * b.y - self.y * b.x)
    }

    pub fn length(self) -> f64 {
        self.dot(self).sqrt()
    }

    pub fn normalized(self) -> Vec3 {
        self / self.length()
    }
}

impl Add for Vec3 {
    type Output = Vec3;
    fn add(self, b: Vec3) -> Vec3 {
        vec3(self.x + b.x, self.y + b.y, self.z + b.z)
    }
}

impl Sub for Vec3 {
    type Output = Vec3;
    fn sub(self, b: Vec3) -> Vec3 {
        vec3(self.x - b.x, self.y - b.y, self.z - b.z)
    }
}

impl Neg for Vec3 {
    type Output = Vec3;
    fn neg(self) -> Vec3 {
        vec3(-self.x, -self.y, -self.z)
    }
}

impl Mul<f64> for Vec3 {
    type Output = Vec3;
    fn mul(self, s: f64) -> Vec3 {
        vec3(self.x * s, self.y * s, self.z * s)
    }
}

impl Mul<Vec3> for f64 {
    type Output = Vec3;
    fn mul(self, a: Vec3) -> Vec3 {
        a * self
    }
}

impl Div<f64> for Vec3 {
    type Output = Vec3;
    fn div(self, s: f64) -> Vec3 {
        vec3(self.x / s, self.y / s, self.z / s)
    }
}

/// Which lobe a sample came from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lobe {
    Diffuse,
    Glossy,
}

/// A sampled direction with weight = f cos θi/pdf and its pdf per steradian.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub wi: Vec3,
    pub weight: f64,
    pub pdf: f64,
    pub lobe: Lobe,
}

/// What you write for each of the three.
pub trait Brdf {
    /// f in 1/sr, without the cosine; 0 where a direction is below the horizon.
    fn eval(&self, wo: Vec3, wi: Vec3) -> f64;

    /// The density with which `sample` draws wi, per steradian; 0 where it never does.
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f64;

    /// A draw from two random numbers in [0, 1); `None` where there is no sample.
    fn sample(&self, wo: Vec3, u1: f64, u2: f64) -> Option<Sample>;
}

pub struct Diffuse {
    /// In [0, 1].
    pub reflectance: f64,
}

pub struct Metal {
    /// Roughness, in [0.05, 1].
    pub alpha: f64,
    /// Reflectance of a facet at normal incidence, in [0, 1].
    pub f0: f64,
}

pub struct Plastic {
    /// Roughness of the coat, in [0.05, 1].
    pub alpha: f64,
    /// Index of refraction of the coat, in [1, 3].
    pub eta: f64,
    /// Share of the coat, in [0.05, 0.95].
    pub ks: f64,
    /// Of the base, in [0, 1].
    pub reflectance: f64,
}
