//! The flux that leaves a surface where 1 arrives.

use super::gathered::Evidence;

/// ∫s f|cos θi| + Σ s P_k w_k of a channel over each side, with the flux factor s =
/// (η_i/η_o)² of transmission in radiance mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flux {
    /// On both: 1 of a lossless surface, less of others.
    pub total: f64,
    /// On wo's side.
    pub reflected: f64,
    /// On the other one.
    pub transmitted: f64,
    /// The cubature's error of the total.
    pub error: f64,
}

impl Evidence {
    /// The flux of each channel; `None` where it was not integrated, or discrete lobes
    /// were not drawn.
    pub fn fluxes(&self) -> Option<Vec<Flux>> {
        let (partition, integrals) = (self.partition.as_ref()?, self.integrals.as_ref()?);
        let claims = &self.description.claims;
        let front = self.wo.z > 0.0;
        let through = claims.flux_factor(front, !front, self.scale());
        let channels = self.description.channels.len();
        let discrete = match self.draws.first() {
            Some(draws) => &draws.discrete[..],
            None if self.description.has.sample => return None,
            None => &[],
        };
        // Saved evidence may come from anywhere.
        let whole = integrals.value.len() == partition.len() * channels
            && integrals.value_error.len() == channels
            && discrete.iter().all(|d| d.weight.len() == channels);
        if !whole {
            return None;
        }
        let of_channel = |c: usize| {
            let error = integrals.value_error[c] * through.max(1.0);
            let mut flux = Flux { total: 0.0, reflected: 0.0, transmitted: 0.0, error };
            let factor = |front_i: bool| if front_i == front { 1.0 } else { through };
            let mut add = |front_i: bool, value: f64| {
                flux.total += value;
                let side = if front_i == front { &mut flux.reflected } else { &mut flux.transmitted };
                *side += value;
            };
            for leaf in 0..partition.len() {
                let front_i = partition.leaf_cell(leaf).is_front();
                add(front_i, factor(front_i) * integrals.value[leaf * channels + c]);
            }
            for d in discrete {
                let front_i = d.wi.z > 0.0;
                add(front_i, factor(front_i) * d.probability * d.weight[c]);
            }
            flux
        };
        Some((0..channels).map(of_channel).collect())
    }
}
