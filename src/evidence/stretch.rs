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
        // A mass reaches halfway to its neighbours, so that coarse ones look broad.
        let edge = |k: usize| match (k.checked_sub(1).and_then(|k| masses.get(k)), masses.get(k)) {
            (Some(a), Some(b)) => 0.5 * (a.0 + b.0),
            (Some(end), None) | (None, Some(end)) => end.0,
            (None, None) => f64::NAN,
        };
        // From each mass on to the first that completes the share.
        let (mut narrowest, mut past, mut held) = (None::<(f64, f64)>, 0, 0.0);
        for (first, (_, mass)) in masses.iter().enumerate() {
            while held < SHARE * total && past < masses.len() {
                held += masses[past].1;
                past += 1;
            }
            if held < SHARE * total || past <= first {
                break;
            }
            let (from, to) = (edge(first), edge(past));
            if to > from && narrowest.is_none_or(|(a, b)| to - from < b - a) {
                narrowest = Some((from, to));
            }
            held -= mass;
        }
        match narrowest {
            Some((from, to)) if TO_DEVIATION * (to - from) < NARROW => {
                Self::Around { middle: 0.5 * (from + to), width: TO_DEVIATION * (to - from) }
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

    /// How far off the plane, in degrees, a cell at this angle may be, `most` at most:
    /// nearer to the lobe's middle where its density falls fast.
    pub fn near(&self, x: f64, most: f64) -> f64 {
        match self {
            Self::Even => most,
            Self::Around { middle, width } => (0.25 * (x - middle).hypot(*width)).min(most),
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
            // The lobe holds a quarter, so that most of it makes up the share.
            assert!((0.8..5.0).contains(&(width / deviation)), "{width}");
        }
        assert_eq!(Stretch::of(bell(0.0, 10.0)), Stretch::Even);
        assert_eq!(Stretch::of([]), Stretch::Even);
        assert_eq!(Stretch::of([(3.0, 1.0)]), Stretch::Even, "of one mass nothing is known");
        let coarse = (0..30).map(|k| (3.0 * f64::from(k), if k == 20 { 100.0 } else { 1.0 }));
        assert_eq!(Stretch::of(coarse), Stretch::Even, "no narrower than masses are apart");
    }

    #[test]
    fn places_and_angles_are_inverse() {
        let stretch = Stretch::Around { middle: 40.0, width: 0.02 };
        for x in [-90.0, 39.9, 40.0, 40.01, 75.0] {
            assert!((stretch.angle(stretch.place(x)) - x).abs() < 1e-9);
        }
        assert_eq!(stretch.near(40.0, 8.0), 0.005);
        assert_eq!(stretch.near(-20.0, 8.0), 8.0);
    }
}
