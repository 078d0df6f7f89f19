//! Matrices over Klems's patches of the hemisphere.

use crate::bsdf::Rectangle;
use std::f64::consts::TAU;

/// Angles that differ by less are the same, in degrees: files write a digit or two.
const SAME_ANGLE: f64 = 1e-4;

/// More patches than any basis has: Klems full has 145.
const MOST_PATCHES: usize = 1 << 12;

/// A ring of equal patches, the first of them around azimuth 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Its polar angles in degrees.
    pub lower: f64,
    /// The larger one.
    pub upper: f64,
    /// How many patches it has.
    pub patches: usize,
}

/// A partition of the hemisphere into rings of patches.
#[derive(Clone, Debug, PartialEq)]
pub struct Basis {
    /// As the file names it.
    pub name: String,
    rings: Vec<Ring>,
    /// sin² of the rings' upper angles, the last exactly 1.
    edges: Vec<f64>,
    /// The first patch of each ring.
    first: Vec<usize>,
    patches: usize,
}

/// The standard bases: limits of the rings in degrees and patches in each
/// (J. H. Klems, "A new method for predicting the solar heat gain of complex
/// fenestration systems", ASHRAE Transactions 100, 1994; halves and quarters as in
/// Radiance's `bsdf_m.c`).
const STANDARD: [(&str, &[f64], &[usize]); 3] = [
    (
        "LBNL/Klems Full",
        &[0.0, 5.0, 15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0, 90.0],
        &[1, 8, 16, 20, 24, 24, 24, 16, 12],
    ),
    ("LBNL/Klems Half", &[0.0, 6.5, 19.5, 32.5, 45.5, 58.5, 71.5, 90.0], &[1, 8, 12, 16, 20, 12, 8]),
    ("LBNL/Klems Quarter", &[0.0, 9.0, 27.0, 45.0, 63.0, 90.0], &[1, 8, 12, 12, 8]),
];

impl Basis {
    /// The standard basis of this name, if it is one.
    pub fn standard(name: &str) -> Option<Self> {
        let (name, limits, counts) = STANDARD.into_iter().find(|s| s.0.eq_ignore_ascii_case(name))?;
        let ring = |k: usize| Ring { lower: limits[k], upper: limits[k + 1], patches: counts[k] };
        Some(Self::new(name, (0..counts.len()).map(ring).collect()).expect("the standard ones are right"))
    }

    /// Names of the standard bases.
    pub fn standard_names() -> impl Iterator<Item = &'static str> {
        STANDARD.into_iter().map(|s| s.0)
    }

    /// From rings that follow on each other from 0° to 90°; else what is wrong,
    /// and with which ring.
    pub fn new(name: &str, rings: Vec<Ring>) -> Result<Self, (usize, String)> {
        let mut reached = 0.0;
        let mut first = Vec::new();
        let mut patches = 0;
        for (k, ring) in rings.iter().enumerate() {
            if !((ring.lower - reached).abs() <= SAME_ANGLE && ring.upper > ring.lower) {
                let found = format!("from {}° to {}°", ring.lower, ring.upper);
                return Err((k, format!("a ring {found} where one from {reached}° is due")));
            }
            if ring.patches == 0 || ring.patches > MOST_PATCHES - patches {
                let rule = format!("1 to {} are possible there", MOST_PATCHES - patches);
                return Err((k, format!("a ring of {} patches; {rule}", ring.patches)));
            }
            first.push(patches);
            patches += ring.patches;
            reached = ring.upper;
        }
        if !((reached - 90.0f64).abs() <= SAME_ANGLE) {
            return Err((rings.len().max(1) - 1, format!("the rings end at {reached}°, not at 90°")));
        }
        let mut edges: Vec<f64> = rings.iter().map(|r| r.upper.to_radians().sin().powi(2)).collect();
        *edges.last_mut().expect("there are rings") = 1.0;
        Ok(Self { name: name.into(), rings, edges, first, patches })
    }

    /// Whether both part the hemisphere in the same way.
    pub fn agrees_with(&self, other: &Self) -> bool {
        let same = |(a, b): (&Ring, &Ring)| (a.upper - b.upper).abs() <= SAME_ANGLE && a.patches == b.patches;
        self.rings.len() == other.rings.len() && self.rings.iter().zip(&other.rings).all(same)
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.patches
    }

    /// The ring of a patch, and its place there.
    fn ring_of(&self, patch: usize) -> (usize, usize) {
        let ring = self.first.partition_point(|f| *f <= patch) - 1;
        (ring, patch - self.first[ring])
    }

    /// The patch at (x, y) of a unit direction.
    pub fn patch(&self, [x, y]: [f64; 2]) -> usize {
        let v = x * x + y * y;
        let ring = self.edges.partition_point(|e| *e <= v).min(self.edges.len() - 1);
        let n = self.rings[ring].patches;
        let turns = y.atan2(x) / TAU;
        let k = (turns * n as f64 + 0.5).floor().rem_euclid(n as f64) as usize;
        self.first[ring] + k.min(n - 1)
    }

    /// Its rectangles in (φ/2π, sin² θ): two where azimuth 0 is inside of it.
    pub fn rectangles(&self, patch: usize) -> Vec<Rectangle> {
        let (ring, k) = self.ring_of(patch);
        let v0 = if ring == 0 { 0.0 } else { self.edges[ring - 1] };
        let v1 = self.edges[ring];
        let n = self.rings[ring].patches as f64;
        let between = |u0: f64, u1: f64| Rectangle { lo: [u0, v0], hi: [u1, v1] };
        match k {
            _ if n == 1.0 => vec![between(0.0, 1.0)],
            0 => vec![between(0.0, 0.5 / n), between(1.0 - 0.5 / n, 1.0)],
            _ => vec![between((k as f64 - 0.5) / n, (k as f64 + 0.5) / n)],
        }
    }

    /// (x, y) of the middle of a patch's solid angle: half of its sin², its azimuth.
    pub fn middle(&self, patch: usize) -> [f64; 2] {
        let (ring, k) = self.ring_of(patch);
        let v0 = if ring == 0 { 0.0 } else { self.edges[ring - 1] };
        let r = if ring == 0 { 0.0 } else { (0.5 * (v0 + self.edges[ring])).sqrt() };
        let (sin, cos) = (TAU * k as f64 / self.rings[ring].patches as f64).sin_cos();
        [r * cos, r * sin]
    }

    /// The patch opposite, seen from the normal; `None` where that is no patch.
    pub fn opposite(&self, patch: usize) -> Option<usize> {
        let (ring, k) = self.ring_of(patch);
        match self.rings[ring].patches {
            1 => Some(patch),
            n if n % 2 == 0 => Some(self.first[ring] + (k + n / 2) % n),
            _ => None,
        }
    }

    /// "patch 17 of 145 of LBNL/Klems Full (θ 15° to 25°, φ 11° to 34°)", counted
    /// from 1; azimuths are those of light that left the other way.
    pub fn describe(&self, patch: usize) -> String {
        let (ring, k) = self.ring_of(patch);
        let Ring { lower, upper, patches } = self.rings[ring];
        let name = &self.name;
        let part = format!("patch {} of {} of {name} (θ {lower}° to {upper}°", patch + 1, self.patches);
        if patches == 1 {
            return format!("{part})");
        }
        let phi = |half: f64| (360.0 * (k as f64 + half) / patches as f64 * 10.0).round() / 10.0;
        format!("{part}, basis azimuth {}° to {}°)", phi(-0.5), phi(0.5))
    }
}

/// f by incident and outgoing patch.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    /// Patches of incident light.
    pub incident: Basis,
    /// Patches of outgoing light.
    pub outgoing: Basis,
    /// `values[incident * outgoing.len() + outgoing]` in sr⁻¹.
    pub values: Vec<f64>,
}

impl Matrix {
    /// f of two patches.
    pub fn at(&self, incident: usize, outgoing: usize) -> f64 {
        self.values[incident * self.outgoing.len() + outgoing]
    }

    /// The same scattering with light going the other way, if patches have
    /// opposites.
    pub fn reversed(&self) -> Option<Self> {
        let (incident, outgoing) = (self.outgoing.clone(), self.incident.clone());
        let mut values = Vec::with_capacity(self.values.len());
        for i in 0..incident.len() {
            for o in 0..outgoing.len() {
                values.push(self.at(self.incident.opposite(o)?, self.outgoing.opposite(i)?));
            }
        }
        Some(Self { incident, outgoing, values })
    }
}
