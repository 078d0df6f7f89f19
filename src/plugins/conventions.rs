//! The conventions of the code behind a plugin, and what they are in gonio's.

use super::instance::{Call, Function};
use crate::bsdf::{Direction, Lobe};
use serde::Deserialize;

/// What `sample` returns as weight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Weight {
    /// f·|cos θi|/p, as gonio has it.
    #[default]
    FCosOverPdf,
    /// f/p: the renderer multiplies the cosine.
    FOverPdf,
    /// f·|cos θi|: the renderer divides by p.
    FCos,
    /// f: the renderer does both.
    F,
}

impl Weight {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::FCosOverPdf, Self::FOverPdf, Self::FCos, Self::F];

    /// As a description has it.
    pub fn word(self) -> &'static str {
        match self {
            Self::FCosOverPdf => "f-cos-over-pdf",
            Self::FOverPdf => "f-over-pdf",
            Self::FCos => "f-cos",
            Self::F => "f",
        }
    }

    /// What makes of it f·|cos θi|/p.
    pub fn factor(self, abs_cos: f64, pdf: f64) -> f64 {
        match self {
            Self::FCosOverPdf => 1.0,
            Self::FOverPdf => abs_cos,
            Self::FCos => 1.0 / pdf,
            Self::F => abs_cos / pdf,
        }
    }
}

/// How a draw without a sample is told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Failure {
    /// By flags of 0.
    #[default]
    Flags,
    /// By a pdf of 0.
    ZeroPdf,
    /// By a weight of 0 in every channel.
    ZeroWeight,
}

/// Where the normal and the tangent are in the plugin's own coordinates: an axis for the
/// normal, x being the tangent, or both, for code that works in the space of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Up {
    /// z is the normal.
    #[default]
    Z,
    /// y is the normal.
    Y,
    /// A frame in another space.
    #[serde(untagged)]
    Frame(Frame),
}

/// Unit vectors at right angles.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, try_from = "Vectors")]
pub struct Frame {
    normal: Direction,
    tangent: Direction,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Vectors {
    normal: [f64; 3],
    tangent: [f64; 3],
}

impl TryFrom<Vectors> for Frame {
    type Error = String;

    fn try_from(Vectors { normal, tangent }: Vectors) -> Result<Self, String> {
        let (n, t) = (Direction::from(normal), Direction::from(tangent));
        let off = (n.length() - 1.0).abs().max((t.length() - 1.0).abs()).max(n.dot(t).abs());
        // Seven digits of f32 are enough; what is left is taken away.
        if !(off < 1e-6) {
            return Err(format!(
                "normal {normal:?} and tangent {tangent:?} are no unit vectors at right angles"
            ));
        }
        let normal = n.normalized();
        Ok(Self { normal, tangent: (t - normal * normal.dot(t)).normalized() })
    }
}

impl Up {
    /// Tangent, the direction at right angles to both, and normal.
    fn axes(self) -> [Direction; 3] {
        let (x, y, z) =
            (Direction::new(1.0, 0.0, 0.0), Direction::new(0.0, 1.0, 0.0), Direction::new(0.0, 0.0, 1.0));
        match self {
            Self::Z => [x, y, z],
            Self::Y => [x, -z, y],
            Self::Frame(Frame { normal, tangent }) => [tangent, normal.cross(tangent), normal],
        }
    }
}

/// Where the given direction points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Given {
    /// Away from the surface.
    #[default]
    Away,
    /// Along the ray, towards the surface.
    Towards,
}

/// The conventions of the code behind a plugin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Conventions {
    /// What `sample` returns as weight.
    pub weight: Weight,
    /// How a draw without a sample is told.
    pub failure: Failure,
    /// Where the normal is.
    pub up: Up,
    /// Where the given direction points.
    pub given: Given,
}

impl Conventions {
    /// The given direction as the plugin takes it.
    pub fn wo(&self, wo: Direction) -> [f64; 3] {
        let wo = if self.given == Given::Towards { -wo } else { wo };
        self.direction(wo)
    }

    /// A sampled direction as the plugin takes it.
    pub fn direction(&self, d: Direction) -> [f64; 3] {
        if self.up == Up::Z {
            return d.into();
        }
        let [t, b, n] = self.up.axes();
        (t * d.x + b * d.y + n * d.z).into()
    }

    /// A direction that the plugin returns.
    pub fn from_plugin(&self, direction: [f64; 3]) -> Direction {
        let d = Direction::from(direction);
        if self.up == Up::Z {
            return d;
        }
        let [t, b, n] = self.up.axes();
        Direction::new(t.dot(d), b.dot(d), n.dot(d))
    }

    /// The lobe of a draw with these flags, density and weights.
    pub fn lobe(&self, flags: f64, pdf: f64, weight: &[f64]) -> Result<Lobe, String> {
        let none = match self.failure {
            Failure::Flags => false,
            Failure::ZeroPdf => pdf == 0.0,
            Failure::ZeroWeight => weight.iter().all(|w| *w == 0.0),
        };
        if none {
            return Ok(Lobe::NONE);
        }
        if flags.fract() != 0.0 || !(0.0..32.0).contains(&flags) {
            return Err(format!(
                "sample() returned flags of {flags}, which are no sum of 1 (reflection), 2 (transmission), \
                 4 (diffuse), 8 (glossy) and 16 (discrete)"
            ));
        }
        Ok(Lobe(flags as u8))
    }
}

/// The parts of an answer to `sample`.
pub struct Drawn<'a> {
    /// wi[n][3].
    pub wi: &'a [f64],
    /// weight[n][channels].
    pub weight: &'a [f64],
    /// pdf[n].
    pub pdf: &'a [f64],
    /// flags[n].
    pub flags: &'a [f64],
}

impl<'a> Drawn<'a> {
    /// Of the answer to this call.
    pub fn of(call: &Call, answer: &'a [f64]) -> Self {
        debug_assert_eq!(call.function, Function::Sample);
        let (wi, rest) = answer.split_at(3 * call.rows);
        let (weight, rest) = rest.split_at(call.channels * call.rows);
        let (pdf, flags) = rest.split_at(call.rows);
        Self { wi, weight, pdf, flags }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_turn_there_and_back() {
        let d = Direction::new(0.36, 0.48, 0.8);
        let frame: Up = serde_json::from_str(r#"{"normal":[0.6,0,0.8],"tangent":[0,1,0]}"#).unwrap();
        for up in [Up::Z, Up::Y, frame] {
            let c = Conventions { up, ..Conventions::default() };
            assert!((c.from_plugin(c.direction(d)) - d).length() < 1e-15, "{up:?}");
        }
        let of = Conventions { up: frame, ..Conventions::default() };
        assert_eq!(of.direction(Direction::NORMAL), [0.6, 0.0, 0.8]);
        assert_eq!(of.direction(Direction::new(1.0, 0.0, 0.0)), [0.0, 1.0, 0.0]);
        let read = |text: &str| serde_json::from_str::<Up>(text);
        assert_eq!((read("\"z\"").unwrap(), read("\"y\"").unwrap()), (Up::Z, Up::Y));
        assert!(read(r#"{"normal":[0,0,2],"tangent":[1,0,0]}"#).is_err() && read("\"x\"").is_err());
        let y = Conventions { up: Up::Y, given: Given::Towards, ..Conventions::default() };
        assert_eq!(y.direction(Direction::NORMAL), [0.0, 1.0, 0.0]);
        assert_eq!(y.wo(d), [-0.36, -0.8, 0.48]);
        // Right-handed: the tangent, the normal and their cross product.
        let [t, n] = [y.direction(Direction::new(1.0, 0.0, 0.0)), y.direction(Direction::NORMAL)];
        let cross = Direction::from(t).cross(Direction::from(n));
        assert_eq!(y.from_plugin(cross.into()).y, -1.0);
    }

    #[test]
    fn draws_without_a_sample_are_told() {
        let of = |failure| Conventions { failure, ..Conventions::default() };
        assert_eq!(of(Failure::Flags).lobe(5.0, 0.0, &[0.0]), Ok(Lobe::DIFFUSE_REFLECTION));
        assert_eq!(of(Failure::Flags).lobe(0.0, 1.0, &[1.0]), Ok(Lobe::NONE));
        assert_eq!(of(Failure::ZeroPdf).lobe(5.0, 0.0, &[1.0]), Ok(Lobe::NONE));
        assert_eq!(of(Failure::ZeroWeight).lobe(5.0, 1.0, &[0.0, 0.0]), Ok(Lobe::NONE));
        for wrong in [0.5, -1.0, 32.0, f64::NAN, f64::INFINITY] {
            assert!(of(Failure::Flags).lobe(wrong, 1.0, &[1.0]).is_err(), "{wrong}");
        }
    }
}
