//! Densities of a case along the plane of incidence, and around the normal.

use super::gathered::Evidence;
use super::plane::{Plane, forward_azimuth};
use super::stretch::Stretch;

/// Places along an axis: a few pixels each.
const PLACES: usize = 72;

/// Directions that a place along the plane is the mean of: so many along it, and across.
const ALONG: usize = 4;
const ACROSS: usize = 5;

/// Parts of a cell's side that are spread over azimuths.
const PARTS: usize = 6;

/// What was drawn, what pdf says and what the value is, at one place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Densities {
    /// The angle in degrees.
    pub degrees: f64,
    /// Of the samples of all attempts.
    pub drawn: f64,
    /// Of pdf.
    pub pdf: f64,
    /// Of the flux that leaves, over its total: where sampling is ideal it is the pdf.
    pub flux: f64,
}

/// What cells hold, by leaf: shares of draws, of pdf, and of the flux.
struct Shares {
    drawn: Vec<f64>,
    pdf: Vec<f64>,
    flux: Vec<f64>,
}

impl Shares {
    fn of(evidence: &Evidence) -> Option<Self> {
        let (partition, integrals) = (evidence.partition.as_ref()?, evidence.integrals.as_ref()?);
        let draws: u64 = evidence.draws.iter().map(|d| d.samples).sum();
        let (leaves, channels) = (partition.len(), integrals.value_error.len());
        // Saved evidence may come from anywhere.
        let whole = integrals.pdf.len() == leaves
            && integrals.value.len() == channels * leaves
            && evidence.draws.iter().all(|d| d.counts.len() == leaves);
        if draws == 0 || !whole {
            return None;
        }
        let front = evidence.wo.z > 0.0;
        let factor = |front_i| evidence.description.claims.flux_factor(front, front_i, evidence.scale());
        let flux = |leaf: usize| {
            let value: f64 = integrals.value[leaf * channels..][..channels].iter().sum();
            value * factor(partition.leaf_cell(leaf).is_front())
        };
        let total: f64 = (0..leaves).map(flux).sum();
        let flux = |leaf| if total > 0.0 { flux(leaf) / total } else { 0.0 };
        let drawn = |leaf: usize| evidence.draws.iter().map(|d| d.counts[leaf] as f64).sum::<f64>();
        Some(Self {
            drawn: (0..leaves).map(|leaf| drawn(leaf) / draws as f64).collect(),
            pdf: integrals.pdf.iter().map(|p| p.max(0.0)).collect(),
            flux: (0..leaves).map(flux).collect(),
        })
    }

    fn add(&self, to: &mut Densities, leaf: usize, factor: f64) {
        to.drawn += factor * self.drawn[leaf];
        to.pdf += factor * self.pdf[leaf];
        to.flux += factor * self.flux[leaf];
    }
}

/// Per steradian, by degrees in the plane of incidence (see [`Plane::theta`]), and the
/// axis on which the lobe is seen. `None` where nothing was drawn or integrated.
pub fn plane_densities(evidence: &Evidence) -> Option<(Stretch, Vec<Densities>)> {
    let shares = Shares::of(evidence)?;
    let partition = evidence.partition.as_ref()?;
    let chart = partition.chart();
    let plane = Plane::of(evidence.wo);
    let (stretch, near) = plane.stretch(evidence)?;
    let per_steradian: Vec<f64> =
        (0..partition.len()).map(|leaf| 1.0 / chart.solid_angle(&partition.leaf_cell(leaf))).collect();
    // Sides apart: a place at the horizon is on one of them.
    let ends = [-180.0, -90.0, 90.0, 180.0];
    let places = [PLACES / 2, PLACES, PLACES / 2];
    let mut found = Vec::new();
    for (range, places) in ends.windows(2).zip(places) {
        let (from, to) = (stretch.place(range[0]), stretch.place(range[1]));
        let angle = |t: f64| stretch.angle(from + t * (to - from));
        for k in 0..places {
            let at = |t: f64| angle((k as f64 + t) / places as f64);
            let mut here = Densities { degrees: at(0.5), ..Densities::default() };
            for i in 0..ALONG * ACROSS {
                let theta = at((0.5 + (i % ALONG) as f64) / ALONG as f64);
                let across = 2.0 * (0.5 + (i / ALONG) as f64) / ACROSS as f64 - 1.0;
                let leaf = partition.locate_direction(plane.beside(theta, across * near(theta)));
                shares.add(&mut here, leaf, per_steradian[leaf] / (ALONG * ACROSS) as f64);
            }
            found.push(here);
        }
    }
    Some((stretch, found))
}

/// Per degree, by [`forward_azimuth`], on an axis of azimuths. `None` where nothing was
/// drawn or integrated.
pub fn azimuth_densities(evidence: &Evidence, stretch: Stretch) -> Option<Vec<Densities>> {
    let shares = Shares::of(evidence)?;
    let partition = evidence.partition.as_ref()?;
    let (from, to) = (stretch.place(-180.0), stretch.place(180.0));
    let angle = |k: f64| stretch.angle(from + k / PLACES as f64 * (to - from));
    let place = |k: usize| Densities { degrees: angle(k as f64 + 0.5), ..Densities::default() };
    let mut found: Vec<Densities> = (0..PLACES).map(place).collect();
    let widths: Vec<f64> = (0..PLACES).map(|k| angle(k as f64 + 1.0) - angle(k as f64)).collect();
    for leaf in 0..partition.len() {
        let cell = partition.leaf_cell(leaf);
        for i in 0..PARTS * PARTS {
            let part = |k: usize| (k as f64 + 0.5) / PARTS as f64;
            let wi = partition.chart().to_direction(cell.at(part(i % PARTS), part(i / PARTS)));
            let at = (stretch.place(forward_azimuth(evidence.wo, wi)) - from) / (to - from);
            let k = ((at * PLACES as f64) as usize).min(PLACES - 1);
            shares.add(&mut found[k], leaf, 1.0 / ((PARTS * PARTS) as f64 * widths[k]));
        }
    }
    Some(found)
}
