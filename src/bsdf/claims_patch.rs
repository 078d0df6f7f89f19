//! Claims in place of others.

use super::{Claims, Cosine, OffSupport, RandomNumbers, TransportModes};
use serde::{Deserialize, Serialize};

/// Claims that a suite makes in place of the subject's own, or a plugin in place of
/// the defaults.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "the fields are those of Claims")]
pub struct ClaimsPatch {
    pub reciprocal: Option<bool>,
    pub energy_conserving: Option<bool>,
    pub lossless: Option<bool>,
    pub isotropic: Option<bool>,
    pub reflective: Option<bool>,
    pub transmissive: Option<bool>,
    pub two_sided: Option<bool>,
    pub stochastic: Option<bool>,
    pub eta: Option<f64>,
    pub cosine: Option<Cosine>,
    pub transport: Option<TransportModes>,
    pub off_support: Option<OffSupport>,
    pub rng: Option<RandomNumbers>,
}

impl ClaimsPatch {
    /// Every name, for messages about unknown ones.
    pub const NAMES: [&str; 13] = [
        "reciprocal",
        "energy_conserving",
        "lossless",
        "isotropic",
        "reflective",
        "transmissive",
        "two_sided",
        "stochastic",
        "eta",
        "cosine",
        "transport",
        "off_support",
        "rng",
    ];

    /// The subject's claims with these in their place.
    pub fn over(&self, own: Claims) -> Claims {
        Claims {
            reciprocal: self.reciprocal.unwrap_or(own.reciprocal),
            energy_conserving: self.energy_conserving.unwrap_or(own.energy_conserving),
            lossless: self.lossless.unwrap_or(own.lossless),
            isotropic: self.isotropic.unwrap_or(own.isotropic),
            reflective: self.reflective.unwrap_or(own.reflective),
            transmissive: self.transmissive.unwrap_or(own.transmissive),
            two_sided: self.two_sided.unwrap_or(own.two_sided),
            stochastic: self.stochastic.unwrap_or(own.stochastic),
            eta: self.eta.or(own.eta),
            cosine: self.cosine.unwrap_or(own.cosine),
            transport: self.transport.unwrap_or(own.transport),
            off_support: self.off_support.unwrap_or(own.off_support),
            rng: self.rng.unwrap_or(own.rng),
        }
    }
}
