//! What a subject promises. A claim not made is a check skipped, in sight.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which quantity is carried along the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Transport {
    /// Light arrives along wi and leaves along wo; transmission carries (η_o/η_i)².
    #[default]
    Radiance,
    /// Importance arrives along wi; the adjoint of radiance.
    Importance,
}

impl Transport {
    /// The other mode.
    pub fn other(self) -> Self {
        match self {
            Self::Radiance => Self::Importance,
            Self::Importance => Self::Radiance,
        }
    }
}

impl std::fmt::Display for Transport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Radiance => "radiance",
            Self::Importance => "importance",
        })
    }
}

/// The modes of transport that a subject tells apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum TransportModes {
    /// Radiance only; the mode is ignored.
    #[default]
    Radiance,
    /// Importance only.
    Importance,
    /// Both, and each is measured.
    Both,
}

impl TransportModes {
    /// The modes to measure.
    pub fn modes(self) -> &'static [Transport] {
        match self {
            Self::Radiance => &[Transport::Radiance],
            Self::Importance => &[Transport::Importance],
            Self::Both => &[Transport::Radiance, Transport::Importance],
        }
    }
}

/// Whether `eval` contains the factor |cos θi|.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Cosine {
    /// `eval` is f in sr⁻¹.
    #[default]
    Excluded,
    /// `eval` is f·|cos θi|; gonio divides.
    Included,
}

/// What becomes of draws that fall off the support, as below the horizon.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OffSupport {
    /// They are *no sample*.
    #[default]
    NoSample,
    /// They are returned with pdf > 0 and zero weight, and pdf covers them.
    ZeroWeight,
    /// The sampler never draws one.
    Never,
}

/// Where the random numbers of `sample` come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum RandomNumbers {
    /// From the `u` that gonio passes.
    #[default]
    External,
    /// From a generator inside the subject; equal `u` need not give equal samples.
    Internal,
}

/// What a subject promises (each is tested where it can be).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Claims {
    /// eval(wo, wi)/η_o² = eval(wi, wo)/η_i² in radiance mode.
    pub reciprocal: bool,
    /// No direction reflects and transmits more flux than arrives.
    pub energy_conserving: bool,
    /// All flux that arrives leaves again: the white furnace is 1.
    pub lossless: bool,
    /// Turning wo and wi together about the normal changes nothing.
    pub isotropic: bool,
    /// Light can leave on the side it came from.
    pub reflective: bool,
    /// Light can leave on the other side.
    pub transmissive: bool,
    /// The back side behaves as the front side seen in a mirror (z → −z).
    pub two_sided: bool,
    /// eval and pdf are random, right on average only.
    pub stochastic: bool,
    /// Index of refraction of the back side over that of the front side, where
    /// light is refracted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub eta: Option<f64>,
    /// Whether `eval` contains |cos θi|.
    pub cosine: Cosine,
    /// The modes of transport it tells apart.
    pub transport: TransportModes,
    /// What becomes of draws off the support.
    pub off_support: OffSupport,
    /// Where its random numbers come from.
    pub rng: RandomNumbers,
}

impl Default for Claims {
    fn default() -> Self {
        Self {
            reciprocal: true,
            energy_conserving: true,
            lossless: false,
            isotropic: false,
            reflective: true,
            transmissive: false,
            two_sided: false,
            stochastic: false,
            eta: None,
            cosine: Cosine::default(),
            transport: TransportModes::default(),
            off_support: OffSupport::default(),
            rng: RandomNumbers::default(),
        }
    }
}

impl Claims {
    /// (η_i/η_o)², the factor s of flux by which energy weighs light that goes
    /// from wi's side to wo's side in radiance mode: 1 within one side, in
    /// importance mode, and where no eta is claimed.
    pub fn flux_factor(&self, front_o: bool, front_i: bool, transport: Transport) -> f64 {
        match (self.eta, transport) {
            (Some(eta), Transport::Radiance) if front_o != front_i => {
                if front_o {
                    eta * eta
                } else {
                    1.0 / (eta * eta)
                }
            }
            _ => 1.0,
        }
    }
}
