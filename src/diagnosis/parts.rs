//! What a factor may be made of at a pair of directions.

use crate::bsdf::{Direction, Transport};
use crate::models::fresnel;
use crate::models::microfacet::{Distribution, Fresnel, Masking, half_vector};

/// The parts of a model that are known.
#[derive(Clone, Debug, Default)]
pub struct Parts {
    /// D, of reflection and refraction by facets.
    pub distribution: Option<Distribution>,
    /// How facets hide each other.
    pub masking: Option<Masking>,
    /// F of a facet.
    pub fresnel: Option<Fresnel>,
    /// Index of the back side over the front side.
    pub eta: Option<f64>,
}

/// A pair of directions, as seen from wo's side, where the normal is up.
#[derive(Clone, Copy)]
pub struct At<'p> {
    /// What is known of the model.
    pub parts: &'p Parts,
    /// The given direction, above.
    pub wo: Direction,
    /// The other one.
    pub wi: Direction,
    /// Which channel.
    pub channel: usize,
    /// The mode of transport.
    pub transport: Transport,
    /// Index of the far over the near side.
    pub eta: Option<f64>,
    /// Whether wo was below.
    pub from_behind: bool,
    pub(super) facet: Option<Facet>,
}

/// The facet that joins the two.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    /// Its normal.
    pub m: Direction,
    /// wo·m.
    pub cos_o: f64,
    /// |wi·m|.
    pub cos_i: f64,
    /// |dωm/dωi|.
    pub jacobian: f64,
}

impl<'p> At<'p> {
    /// The pair, channel 0.
    pub fn new(parts: &'p Parts, wo: Direction, wi: Direction, transport: Transport) -> Self {
        let from_behind = wo.z < 0.0;
        let up = |w: Direction| if from_behind { w.flipped() } else { w };
        let eta = parts.eta.map(|eta| if from_behind { 1.0 / eta } else { eta });
        let (wo, wi) = (up(wo), up(wi));
        let facet = if wi.z > 0.0 {
            let found = half_vector::of_reflection(wo, wi);
            found.map(|(m, cos)| Facet { m, cos_o: cos, cos_i: cos, jacobian: 0.25 / cos })
        } else {
            let found = eta.and_then(|eta| Some((half_vector::of_refraction(wo, wi, eta)?, eta)));
            found.map(|(r, eta)| Facet {
                m: r.m,
                cos_o: r.cos_o,
                cos_i: r.cos_i,
                jacobian: r.cos_i * (eta / r.length).powi(2),
            })
        };
        Self { parts, wo, wi, channel: 0, transport, eta, from_behind, facet }
    }

    /// Both directions exchanged.
    pub fn exchanged(&self) -> Self {
        let back = |w: Direction| if self.from_behind { w.flipped() } else { w };
        let other = Self::new(self.parts, back(self.wi), back(self.wo), self.transport);
        Self { channel: self.channel, ..other }
    }

    /// Whether both are on one side.
    pub fn reflects(&self) -> bool {
        self.wi.z > 0.0
    }

    /// The facet, where they are on one side.
    pub fn half(&self) -> Option<Facet> {
        self.facet.filter(|_| self.reflects())
    }

    /// The facet, where they are not.
    pub fn refracting(&self) -> Option<Facet> {
        self.facet.filter(|_| !self.reflects())
    }

    /// The facet.
    pub fn facet(&self) -> Option<Facet> {
        self.facet
    }

    /// cos θo > 0.
    pub fn cos_o(&self) -> f64 {
        self.wo.z
    }

    /// |cos θi|.
    pub fn cos_i(&self) -> f64 {
        self.wi.z.abs()
    }

    /// D of the facet.
    pub fn d(&self) -> Option<f64> {
        Some(self.parts.distribution.as_ref()?.density(self.facet?.m))
    }

    /// Smith's G1 of a direction above or below.
    pub fn g1(&self, w: Direction) -> Option<f64> {
        let w = Direction::new(w.x, w.y, w.z.abs());
        Some(self.parts.distribution.as_ref()?.g1(w))
    }

    /// G1(wo).
    pub fn g1_o(&self) -> Option<f64> {
        self.g1(self.wo)
    }

    /// G1(wi).
    pub fn g1_i(&self) -> Option<f64> {
        self.g1(self.wi)
    }

    /// Smith's G2 of reflection, correlated by height (Heitz 2014, eq. 99).
    pub fn g2(&self) -> Option<f64> {
        let d = self.parts.distribution.as_ref()?;
        self.half()?;
        let (o, i) = (d.backfacing_area(self.wo), d.backfacing_area(self.wi));
        Some(self.wo.z * self.wi.z / (self.wo.z * self.wi.z + o * self.wi.z + i * self.wo.z))
    }

    /// F at this cosine, in the channel.
    pub fn fresnel(&self, cos: f64) -> Option<f64> {
        let cos = cos.min(1.0);
        Some(match self.parts.fresnel? {
            Fresnel::None => return None,
            Fresnel::Schlick(f0) => fresnel::schlick(cos, f0),
            Fresnel::Dielectric(eta) => fresnel::dielectric(cos, eta),
            Fresnel::Conductor(metal) => {
                let (n, k) = *metal.index().get(self.channel)?;
                fresnel::conductor(cos, n, k)
            }
        })
    }
}
