//! An axis of angles on which a narrow lobe is seen, and what is far from it too.

/// A lobe is looked for as the narrowest range that holds this share of the mass.
const SHARE: f64 = 0.15;

/// Of a normal distribution that range is 0.19 standard deviations to either side.
const TO_DEVIATION: f64 = 0.5 / 0.19;

/// Wider lobes, in degrees, are seen as they are.
const NARROW: f64 = 5.0;

/// Degrees, as they are or spread around a narrow lobe: asinh((x − middle)/width), even
/// within the width and logarithmic beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stretch {
    /// As they are.
    Even,
    /// Around a lobe.
    Around {
        /// The lobe's middle, in degrees.
        middle: f64,
        /// About one standard deviation, in degrees.
        width: f64,
    },
}

impl Stretch {
    /// For masses at these degrees.
    pub fn of(masses: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut masses: Vec<(f64, f64)> =
            masses.into_iter().filter(|(x, mass)| x.is_finite() && *mass > 0.0).collect();
        masses.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = masses.iter().map(|m| m.1).sum();
        // From each mass on to the first that completes the share.
        let (mut narrowest, mut past, mut held) = (None::<(f64, f64)>, 0, 0.0);
        for (first, (from, mass)) in masses.iter().enumerate() {
            while held < SHARE * total && past < masses.len() {
                held += masses[past].1;
                past += 1;
            }
            if held < SHARE * total || past == 0 {
                break;
            }
            let to = masses[past - 1].0;
            if past > first && narrowest.is_none_or(|(a, b)| to - from < b - a) {
                narrowest = Some((*from, to));
            }
            held -= mass;
        }
        match narrowest {
            Some((from, to)) if TO_DEVIATION * (to - from) < NARROW => {
                // A single mass has no width that could be told.
                let width = (TO_DEVIATION * (to - from)).max(1e-6);
                Self::Around { middle: 0.5 * (from + to), width }
            }
            _ => Self::Even,
        }
    }

    /// The place of an angle in degrees.
    pub fn place(&self, x: f64) -> f64 {
        match self {
            Self::Even => x,
            Self::Around { middle, width } => ((x - middle) / width).asinh(),
        }
    }

    /// The angle at a place.
    pub fn angle(&self, place: f64) -> f64 {
        match self {
            Self::Even => place,
            Self::Around { middle, width } => middle + width * place.sinh(),
        }
    }

    /// How far off its plane, in degrees, a cell at this angle may be, `most` at most:
    /// nearer to the lobe's middle where its density falls fast.
    pub fn near(&self, x: f64, most: f64) -> f64 {
        match self {
            Self::Even => most,
            Self::Around { middle, width } => (0.5 * (x - middle).hypot(*width)).min(most),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bell(middle: f64, deviation: f64) -> impl Iterator<Item = (f64, f64)> {
        (-400..=400).map(move |k| {
            let t = f64::from(k) / 100.0;
            (middle + t * deviation, (-0.5 * t * t).exp())
        })
    }

    #[test]
    fn a_narrow_lobe_is_found_beside_a_broad_one() {
        for deviation in [1e-3, 0.05, 1.0] {
            let broad = bell(0.0, 30.0).map(|(x, m)| (x, 3.0 * m));
            let Stretch::Around { middle, width } = Stretch::of(bell(45.0, deviation).chain(broad)) else {
                panic!("deviation {deviation}")
            };
            assert!((middle - 45.0).abs() < 0.2 * deviation, "{middle}");
            assert!((0.8..2.0).contains(&(width / deviation)), "{width}");
        }
        assert_eq!(Stretch::of(bell(0.0, 10.0)), Stretch::Even);
        assert_eq!(Stretch::of([]), Stretch::Even);
        assert!(matches!(Stretch::of([(3.0, 1.0)]), Stretch::Around { middle: 3.0, .. }));
    }

    #[test]
    fn places_and_angles_are_inverse() {
        let stretch = Stretch::Around { middle: 40.0, width: 0.02 };
        for x in [-90.0, 39.9, 40.0, 40.01, 75.0] {
            assert!((stretch.angle(stretch.place(x)) - x).abs() < 1e-9);
        }
        assert_eq!(stretch.near(40.0, 8.0), 0.01);
        assert_eq!(stretch.near(-20.0, 8.0), 8.0);
    }
}
