//! Two other subjects, side by side.

use crate::bsdf::{
    Claims, Cosine, Description, Direction, Has, Lobe, NativeCells, OffSupport, Precision, RandomNumbers,
    Samples, Subject, SubjectError, Transport, TransportModes,
};
use crate::registry::Model;
use std::sync::Arc;

/// f = (1 − w) f₁ + w f₂ of two other subjects. Each is drawn from with its
/// weight as probability, the random number that chose is stretched to [0, 1)
/// again and handed on, and pdf and weight are those of the mixture whichever
/// was drawn from (E. Veach, *Robust Monte Carlo Methods for Light Transport
/// Simulation*, 1997, §9.2.4, the one-sample model).
pub struct Blend {
    parts: [Part; 2],
    description: Description,
}

struct Part {
    subject: Arc<dyn Subject>,
    share: f64,
    description: Description,
}

/// The registered model `blend`.
pub(super) fn model() -> Model {
    Model::composed("blend", "two subjects side by side: (1 − weight) f₁ + weight f₂", |p, parts| {
        Blend::new(parts.subject("first"), parts.subject("second"), p.number("weight"))
    })
    .subject("first", "lambert", "the first subject")
    .subject("second", "torrance-sparrow", "the second subject")
    .number("weight", 0.5, 0.0..=1.0, "share of the second subject")
}

impl Blend {
    /// `weight` in [0, 1] is the share of `second`. `Err` with the reason where
    /// the two cannot be one subject.
    pub fn new(first: Arc<dyn Subject>, second: Arc<dyn Subject>, weight: f64) -> Result<Self, String> {
        let part =
            |subject: Arc<dyn Subject>, share| Part { description: subject.describe(), subject, share };
        let parts = [part(first, 1.0 - weight), part(second, weight)];
        let description = described(&parts)?;
        Ok(Self { parts, description })
    }
}

fn described([a, b]: &[Part; 2]) -> Result<Description, String> {
    let (x, y) = (&a.description, &b.description);
    let channels = match (x.channels.len(), y.channels.len()) {
        (n, m) if n == m || m == 1 => x.channels.clone(),
        (1, _) => y.channels.clone(),
        (n, m) => return Err(format!("the first has {n} channels, the second {m}: choose equally many")),
    };
    let discrete = |p: &Part| p.share > 0.0 && is_discrete(&*p.subject, &p.description);
    if discrete(a) && discrete(b) {
        return Err(
            "both have discrete lobes, whose probabilities cannot be told apart where their directions \
                    meet: choose one without"
                .into(),
        );
    }
    if let (Some(p), Some(q)) = (x.claims.eta, y.claims.eta)
        && p != q
    {
        return Err(format!(
            "the first refracts with eta = {p}, the second with {q}: one interface has one eta"
        ));
    }
    // A part of share 0 has no say.
    let any = |of: fn(&Claims) -> bool| [a, b].iter().any(|p| p.share > 0.0 && of(&p.description.claims));
    let all = |of: fn(&Claims) -> bool| [a, b].iter().all(|p| p.share == 0.0 || of(&p.description.claims));
    let f32_part = [x, y].iter().any(|d| d.precision == Precision::F32);
    Ok(Description::new("blend")
        .channels(channels)
        .dimensions(x.dimensions.max(y.dimensions).max(1))
        .precision(if f32_part { Precision::F32 } else { Precision::F64 })
        .has(Has {
            eval: x.has.eval && y.has.eval,
            pdf: x.has.pdf && y.has.pdf,
            sample: x.has == Has::default() && y.has == Has::default(),
        })
        .claims(|c| {
            *c = Claims {
                reciprocal: all(|c| c.reciprocal),
                energy_conserving: all(|c| c.energy_conserving),
                lossless: all(|c| c.lossless),
                isotropic: all(|c| c.isotropic),
                reflective: any(|c| c.reflective),
                transmissive: any(|c| c.transmissive),
                two_sided: all(|c| c.two_sided),
                stochastic: any(|c| c.stochastic),
                eta: x.claims.eta.or(y.claims.eta),
                cosine: Cosine::Excluded,
                transport: match (x.claims.transport, y.claims.transport) {
                    (p, q) if p == q => p,
                    _ => TransportModes::Both,
                },
                off_support: match (x.claims.off_support, y.claims.off_support) {
                    (p, q) if p == q => p,
                    (OffSupport::ZeroWeight, _) | (_, OffSupport::ZeroWeight) => OffSupport::ZeroWeight,
                    _ => OffSupport::NoSample,
                },
                rng: if any(|c| c.rng == RandomNumbers::Internal) {
                    RandomNumbers::Internal
                } else {
                    RandomNumbers::External
                },
            };
        }))
}

/// Whether a few draws find a discrete lobe.
pub(super) fn is_discrete(subject: &dyn Subject, description: &Description) -> bool {
    if !description.has.sample {
        return false;
    }
    let dimensions = description.dimensions.max(1);
    let u: Vec<f64> = (0..16 * dimensions).map(|k| (k as f64 * 0.618_033_988_749_895).fract()).collect();
    [0.3, 1.2, 2.0].iter().any(|theta| {
        let mut samples = Samples::default();
        samples.clear(description.channels.len());
        let wo = Direction::from_angles(*theta, 0.3);
        subject.sample(wo, &u, Transport::Radiance, &mut samples).is_ok()
            && samples.lobe.iter().any(|l| l.is_discrete())
    })
}

impl Part {
    /// f, cosine excluded, in as many channels as `out` has a row; one channel is
    /// all of them.
    fn eval(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        channels: usize,
    ) -> Result<Vec<f64>, SubjectError> {
        let own = self.description.channels.len();
        let mut value = vec![0.0; wi.len() * own];
        self.subject.eval(wo, wi, transport, &mut value)?;
        if self.description.claims.cosine == Cosine::Included {
            for (row, wi) in value.chunks_exact_mut(own).zip(wi) {
                row.iter_mut().for_each(|v| *v /= wi.abs_cos_theta());
            }
        }
        Ok((0..wi.len() * channels)
            .map(|k| value[k / channels * own + (k % channels).min(own - 1)])
            .collect())
    }
}

impl Part {
    /// One draw for each of `rows`, whose first number lies in [`below`, `below` +
    /// share) and is stretched to [0, 1).
    fn draw<'a>(
        &self,
        wo: Direction,
        rows: impl ExactSizeIterator<Item = &'a [f64]>,
        below: f64,
        transport: Transport,
    ) -> Result<Samples, SubjectError> {
        let dimensions = self.description.dimensions.max(1);
        let expected = rows.len();
        let mut u = Vec::with_capacity(expected * dimensions);
        for row in rows {
            // Below 1, whatever the division rounds to.
            let first = ((row[0] - below) / self.share).min(1.0 - f64::EPSILON / 2.0);
            u.push(first);
            u.extend(&row[1..dimensions]);
        }
        let mut drawn = Samples::default();
        drawn.clear(self.description.channels.len());
        self.subject.sample(wo, &u, transport, &mut drawn)?;
        if drawn.len() != expected {
            return Err(SubjectError::WrongLength { function: "sample", expected, got: drawn.len() });
        }
        Ok(drawn)
    }
}

impl Subject for Blend {
    fn describe(&self) -> Description {
        self.description.clone()
    }

    fn eval(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        out.fill(0.0);
        for part in self.parts.iter().filter(|p| p.share > 0.0) {
            let value = part.eval(wo, wi, transport, self.description.channels.len())?;
            out.iter_mut().zip(value).for_each(|(sum, v)| *sum += part.share * v);
        }
        Ok(())
    }

    fn pdf(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        out.fill(0.0);
        let mut density = vec![0.0; wi.len()];
        for part in self.parts.iter().filter(|p| p.share > 0.0) {
            part.subject.pdf(wo, wi, transport, &mut density)?;
            out.iter_mut().zip(&density).for_each(|(sum, p)| *sum += part.share * p);
        }
        Ok(())
    }

    fn sample(
        &self,
        wo: Direction,
        u: &[f64],
        transport: Transport,
        out: &mut Samples,
    ) -> Result<(), SubjectError> {
        let channels = self.description.channels.len();
        let rows: Vec<&[f64]> = u.chunks_exact(self.description.dimensions).collect();
        out.wi.resize(rows.len(), Direction::default());
        out.weight.resize(rows.len() * channels, 0.0);
        out.pdf.resize(rows.len(), 0.0);
        out.lobe.resize(rows.len(), Lobe::NONE);
        let first = self.parts[0].share;
        for (k, part) in self.parts.iter().enumerate().filter(|(_, p)| p.share > 0.0) {
            let mine: Vec<usize> =
                (0..rows.len()).filter(|r| usize::from(rows[*r][0] >= first) == k).collect();
            let below = if k == 0 { 0.0 } else { first };
            let drawn = part.draw(wo, mine.iter().map(|r| rows[*r]), below, transport)?;
            let other = &self.parts[1 - k];
            let place =
                |j: usize| if drawn.lobe[j].is_continuous() { drawn.wi[j] } else { Direction::NORMAL };
            let places: Vec<Direction> = (0..drawn.len()).map(place).collect();
            let (mut value, mut density) = (vec![0.0; mine.len() * channels], vec![0.0; mine.len()]);
            if other.share > 0.0 {
                value = other.eval(wo, &places, transport, channels)?;
                other.subject.pdf(wo, &places, transport, &mut density)?;
            }
            for (j, r) in mine.iter().enumerate() {
                let own = part.share * drawn.pdf[j];
                let mixed = own + other.share * density[j];
                let continuous = drawn.lobe[j].is_continuous() && mixed > 0.0;
                out.lobe[*r] = drawn.lobe[j];
                out.wi[*r] = drawn.wi[j];
                out.pdf[*r] = if continuous { mixed } else { own };
                let weight = drawn.weight_of(j);
                for c in 0..channels {
                    // Of a discrete lobe share and probability cancel.
                    let w = weight[c.min(weight.len() - 1)];
                    let theirs = other.share * value[j * channels + c] * places[j].abs_cos_theta();
                    out.weight[r * channels + c] = if continuous { (own * w + theirs) / mixed } else { w };
                }
            }
        }
        Ok(())
    }

    fn hints(&self, wo: Direction) -> Vec<Direction> {
        self.parts.iter().flat_map(|p| p.subject.hints(wo)).collect()
    }

    fn cells(&self, wo: Direction) -> Option<NativeCells> {
        // Two tables have no common cells in general.
        let mut all = self.parts.iter().filter(|p| p.share > 0.0).filter_map(|p| p.subject.cells(wo));
        all.next().filter(|_| all.next().is_none())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::{Registry, Resolved};

    fn blend(text: &str) -> Result<Resolved, String> {
        let spelling = text.parse().map_err(|e: crate::registry::RegistryError| e.to_string())?;
        Registry::builtin().resolve(&spelling).map_err(|e| e.to_string())
    }

    #[test]
    fn value_and_density_are_those_of_the_mixture() {
        let b = blend("blend:first=(lambert:reflectance=0.5,sampling=uniform),weight=0.25").unwrap();
        let lambert = blend("lambert:reflectance=0.5,sampling=uniform").unwrap().subject;
        let ggx = blend("torrance-sparrow").unwrap().subject;
        let (wo, wi) = (Direction::from_angles(0.5, 0.2), [Direction::from_angles(0.6, 3.0)]);
        let at = |s: &Arc<dyn Subject>| {
            let (mut f, mut p) = ([0.0], [0.0]);
            s.eval(wo, &wi, Transport::Radiance, &mut f).unwrap();
            s.pdf(wo, &wi, Transport::Radiance, &mut p).unwrap();
            [f[0], p[0]]
        };
        let (l, g) = (at(&lambert), at(&ggx));
        assert_eq!(at(&b.subject), [0, 1].map(|k| 0.75 * l[k] + 0.25 * g[k]));
        assert_eq!(b.spelling, "blend:first=(lambert:reflectance=0.5,sampling=uniform),weight=0.25");
        let again = blend(&b.spelling).unwrap();
        assert_eq!((again.spelling, again.parameters), (b.spelling, b.parameters));
    }

    #[test]
    fn what_cannot_be_one_subject_is_told() {
        for (text, part) in [
            ("blend:first=dielectric,second=conductor", "both have discrete lobes"),
            ("blend:first=lambart", "in `first`: no subject is called `lambart`; did you mean `lambert`?"),
            ("blend:first=lambert:reflectance=2", "in `first`: `reflectance`"),
            ("blend:first=(lambert", "parenthesis"),
            ("blend:first=", "a subject: NAME"),
            ("blend:weight=0.5,first", "is not KEY=VALUE"),
        ] {
            let message = blend(text).err().unwrap();
            assert!(message.contains(part), "{text}: {message}");
        }
        // With no share of one, the other's claims hold.
        let claims = |text: &str| blend(text).unwrap().subject.describe().claims;
        assert!(claims("blend:first=dielectric,weight=0").lossless);
        assert!(!claims("blend:first=dielectric,weight=0.1").lossless);
    }
}
