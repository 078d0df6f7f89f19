//! All that a file says of one wavelength band.

use super::distribution::Distribution;
use crate::bsdf::Direction;

/// A side of the surface, in this frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// z > 0.
    Front,
    /// z < 0.
    Back,
}

impl Side {
    /// Both.
    pub const BOTH: [Self; 2] = [Self::Front, Self::Back];

    /// The side that a direction points to; none along the surface.
    pub fn of(d: Direction) -> Option<Self> {
        match d.z {
            z if z > 0.0 => Some(Self::Front),
            z if z < 0.0 => Some(Self::Back),
            _ => None,
        }
    }

    /// The other one.
    pub fn opposite(self) -> Self {
        match self {
            Self::Front => Self::Back,
            Self::Back => Self::Front,
        }
    }

    /// What [WINDOW](super) calls light that arrives from this side.
    pub fn in_window(self) -> &'static str {
        match self {
            Self::Front => "Back",
            Self::Back => "Front",
        }
    }
}

impl std::fmt::Display for Side {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Front => "front",
            Self::Back => "back",
        })
    }
}

/// The scattering of one wavelength band.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The material's name in the file.
    pub name: String,
    /// The band: `Visible`, `Solar`.
    pub wavelength: String,
    /// What the file lacks, and what of it was not read.
    pub notes: Vec<String>,
    /// By the side that light arrives from, front first.
    pub(super) reflection: [Option<Distribution>; 2],
    /// Likewise.
    pub(super) transmission: [Option<Distribution>; 2],
}

impl Table {
    /// What light from `from` to `to` meets, if the file has it.
    pub(super) fn distribution(&self, from: Side, to: Side) -> Option<&Distribution> {
        let blocks = if from == to { &self.reflection } else { &self.transmission };
        blocks[from as usize].as_ref()
    }

    /// The distributions of light from `from`, by the side that it goes to.
    pub(super) fn scattered(&self, from: Side) -> impl Iterator<Item = (Side, &Distribution)> {
        Side::BOTH.into_iter().filter_map(move |to| Some((to, self.distribution(from, to)?)))
    }

    /// f in sr⁻¹ of light that arrives along `wo` and leaves along `wi` (both point
    /// away from the surface); 0 along the surface and where the file has nothing.
    pub fn value(&self, wo: Direction, wi: Direction) -> f64 {
        let (Some(from), Some(to)) = (Side::of(wo), Side::of(wi)) else { return 0.0 };
        self.distribution(from, to).map_or(0.0, |d| d.value(wo, wi))
    }

    /// Whether it has any reflection, and any transmission.
    pub fn has(&self) -> (bool, bool) {
        let any = |blocks: &[Option<Distribution>; 2]| blocks.iter().any(Option::is_some);
        (any(&self.reflection), any(&self.transmission))
    }
}
