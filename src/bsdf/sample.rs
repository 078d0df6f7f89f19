//! What `sample` returns, one draw or a batch of draws.

use super::{Direction, Spectrum};
use serde::{Deserialize, Serialize};

/// What kind of lobe a sample came from, as the flags of the subject protocol:
/// reflection 1, transmission 2, diffuse 4, glossy 8, discrete 16; 0 says that
/// there is no sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Lobe(pub u8);

impl Lobe {
    /// No sample: the draw was absorbed or fell off the support.
    pub const NONE: Self = Self(0);
    /// wi on the side of wo.
    pub const REFLECTION: Self = Self(1);
    /// wi on the other side.
    pub const TRANSMISSION: Self = Self(2);
    /// A wide continuous lobe, as Lambert's.
    pub const DIFFUSE: Self = Self(4);
    /// A continuous lobe around a direction.
    pub const GLOSSY: Self = Self(8);
    /// A single direction (a delta function); its `pdf` is a probability.
    pub const DISCRETE: Self = Self(16);
    /// Continuous diffuse reflection.
    pub const DIFFUSE_REFLECTION: Self = Self(1 | 4);
    /// Continuous glossy reflection.
    pub const GLOSSY_REFLECTION: Self = Self(1 | 8);
    /// Continuous glossy transmission.
    pub const GLOSSY_TRANSMISSION: Self = Self(2 | 8);
    /// Mirror reflection.
    pub const DISCRETE_REFLECTION: Self = Self(1 | 16);
    /// Refraction through a smooth interface.
    pub const DISCRETE_TRANSMISSION: Self = Self(2 | 16);

    /// Whether there is a sample at all.
    #[inline]
    pub fn is_valid(self) -> bool {
        self != Self::NONE
    }

    /// Whether the sample is one of a discrete lobe.
    #[inline]
    pub fn is_discrete(self) -> bool {
        self.contains(Self::DISCRETE)
    }

    /// Whether the sample is of a continuous lobe.
    #[inline]
    pub fn is_continuous(self) -> bool {
        self.is_valid() && !self.is_discrete()
    }

    /// Whether all flags of `other` are set.
    #[inline]
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

impl std::fmt::Display for Lobe {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if !self.is_valid() {
            return f.write_str("no sample");
        }
        let names = [
            (Self::DISCRETE, "discrete"),
            (Self::DIFFUSE, "diffuse"),
            (Self::GLOSSY, "glossy"),
            (Self::REFLECTION, "reflection"),
            (Self::TRANSMISSION, "transmission"),
        ];
        let mut first = true;
        for (flag, name) in names {
            if self.contains(flag) {
                if !first {
                    f.write_str(" ")?;
                }
                f.write_str(name)?;
                first = false;
            }
        }
        Ok(())
    }
}

/// One draw of a [`Bsdf`](super::Bsdf).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The sampled direction, unit length.
    pub wi: Direction,
    /// f·|cos θi|/p per channel; of a discrete lobe its value over its probability.
    pub weight: Spectrum,
    /// Density of `wi` in sr⁻¹ over all continuous lobes; of a discrete lobe
    /// the probability of drawing it.
    pub pdf: f64,
    /// Which kind of lobe it came from.
    pub lobe: Lobe,
}

/// A batch of draws, one array a field; row `k` belongs to row `k` of `u`.
#[derive(Clone, Debug, Default)]
pub struct Samples {
    /// Channels of `weight`.
    pub channels: usize,
    /// The directions.
    pub wi: Vec<Direction>,
    /// Weights, row-major: `weight[k * channels + c]`.
    pub weight: Vec<f64>,
    /// Densities (sr⁻¹) or, of discrete lobes, probabilities.
    pub pdf: Vec<f64>,
    /// Lobes; [`Lobe::NONE`] where there is no sample.
    pub lobe: Vec<Lobe>,
}

impl Samples {
    /// Empties the batch and sets the number of channels.
    pub fn clear(&mut self, channels: usize) {
        self.channels = channels;
        self.wi.clear();
        self.weight.clear();
        self.pdf.clear();
        self.lobe.clear();
    }

    /// Number of rows.
    #[inline]
    pub fn len(&self) -> usize {
        self.lobe.len()
    }

    /// Whether there is no row.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.lobe.is_empty()
    }

    /// Appends one draw; no sample where it has no lobe. The weight must have
    /// `self.channels` values.
    #[inline]
    pub fn push(&mut self, sample: Option<&Sample>) {
        match sample.filter(|s| s.lobe.is_valid()) {
            Some(s) => {
                self.wi.push(s.wi);
                // A copy of so few would be a call.
                s.weight.iter().for_each(|w| self.weight.push(*w));
                self.pdf.push(s.pdf);
                self.lobe.push(s.lobe);
            }
            None => {
                self.wi.push(Direction::default());
                self.weight.resize(self.weight.len() + self.channels, 0.0);
                self.pdf.push(0.0);
                self.lobe.push(Lobe::NONE);
            }
        }
    }

    /// Weights of row `k`, one a channel.
    #[inline]
    pub fn weight_of(&self, k: usize) -> &[f64] {
        &self.weight[k * self.channels..(k + 1) * self.channels]
    }
}
