//! The pictures of a case and of a subject: what the report's folder and its page have.

use super::chosen::Pictured;
use super::disc::Caption;
use super::{albedo, azimuth, disc, furnace, lobe, plane, reciprocity_map, weights};
use crate::evidence::Evidence;

/// What a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// Samples, pdf and their difference on discs.
    Discs,
    /// Samples over pdf along the plane of incidence.
    Plane,
    /// Samples over pdf around the normal.
    Azimuth,
    /// The lobe in the plane of incidence.
    Lobe,
    /// How weights are spread.
    Weights,
    /// Where exchanging wo and wi changes the value.
    Reciprocity,
    /// Albedo of a subject against θ of wo.
    Albedo,
    /// Flux of a subject against θ of wo.
    Furnace,
}

impl Kind {
    /// The word for it in names of files: `case-0012-plane.svg`, `albedo-….svg`; discs
    /// have none, being the picture of a case.
    pub fn word(self) -> &'static str {
        match self {
            Self::Discs => "",
            Self::Plane => "plane",
            Self::Azimuth => "azimuth",
            Self::Lobe => "lobe",
            Self::Weights => "weights",
            Self::Reciprocity => "reciprocity",
            Self::Albedo => "albedo",
            Self::Furnace => "furnace",
        }
    }

    /// What it shows, as a heading.
    pub fn title(self) -> &'static str {
        match self {
            Self::Discs => "Samples, pdf and their difference",
            Self::Plane => "Samples over pdf along the plane of incidence",
            Self::Azimuth => "Samples over pdf by azimuth",
            Self::Lobe => "The lobe in the plane of incidence",
            Self::Weights => "Weights of samples",
            Self::Reciprocity => "Reciprocity",
            Self::Albedo => "Albedo against angle",
            Self::Furnace => "Flux against angle",
        }
    }

    /// The file of a case's picture, from the report's folder.
    pub fn of_case(self, index: usize) -> String {
        match self.word() {
            "" => format!("plots/case-{index:04}.svg"),
            word => format!("plots/case-{index:04}-{word}.svg"),
        }
    }
}

/// A picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// What it shows.
    pub kind: Kind,
    /// The same as a heading.
    pub title: &'static str,
    /// A whole document.
    pub svg: String,
}

fn picture(kind: Kind, svg: Option<String>) -> Option<Picture> {
    Some(Picture { kind, title: kind.title(), svg: svg? })
}

/// The pictures of a case that are `wanted`. `cases` are all of its subject and others:
/// its azimuths are drawn beside those of its neighbours.
pub fn of_case(case: &Pictured, cases: &[Pictured], wanted: impl Fn(Kind) -> bool) -> Vec<Picture> {
    let evidence = case.evidence;
    let theta = |e: &Evidence| e.wo.theta().to_degrees();
    let beside = |other: &&Pictured| {
        let e = other.evidence;
        other.index != case.index
            && (other.group, &e.subject, e.transport) == (case.group, &evidence.subject, evidence.transport)
            && (theta(e) - theta(evidence)).abs() < 1e-6
    };
    let draw = |kind| match kind {
        Kind::Discs => disc::picture(evidence, Caption { root_d: case.root_d }),
        Kind::Plane => plane::picture(evidence, case.diagnosed),
        Kind::Azimuth => {
            let others: Vec<&Evidence> = cases.iter().filter(beside).map(|c| c.evidence).collect();
            azimuth::picture(evidence, &others)
        }
        Kind::Lobe => lobe::picture(evidence),
        Kind::Weights => weights::picture(evidence),
        Kind::Reciprocity => reciprocity_map::picture(evidence),
        Kind::Albedo | Kind::Furnace => None,
    };
    OF_CASE.into_iter().filter(|kind| wanted(*kind)).filter_map(|kind| picture(kind, draw(kind))).collect()
}

/// What a case can be shown by, in the order of pages.
const OF_CASE: [Kind; 6] =
    [Kind::Discs, Kind::Plane, Kind::Azimuth, Kind::Lobe, Kind::Weights, Kind::Reciprocity];

/// The pictures of a subject's cases together.
pub fn of_subject(subject: &str, cases: &[&Evidence]) -> Vec<Picture> {
    let drawn =
        [(Kind::Albedo, albedo::albedo(subject, cases)), (Kind::Furnace, furnace::furnace(subject, cases))];
    drawn.into_iter().filter_map(|(kind, svg)| picture(kind, svg)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::{Lobe, evidence};
    use super::*;

    #[test]
    fn neighbours_share_subject_and_angle() {
        let lobe = Lobe { width: 0.3, cosine: 0.5, back: 0.0 };
        let all = [(60.0, 17.0, "a"), (60.0, 137.0, "a"), (30.0, 257.0, "a"), (60.0, 77.0, "b")]
            .map(|(theta, phi, subject)| evidence(subject, theta, phi, lobe, lobe));
        let cases: Vec<Pictured> = all
            .iter()
            .enumerate()
            .map(|(index, evidence)| Pictured {
                index,
                group: "g",
                evidence,
                suspicious: false,
                root_d: None,
                diagnosed: None,
            })
            .collect();
        let found = of_case(&cases[0], &cases, |_| true);
        let kinds: Vec<Kind> = found.iter().map(|p| p.kind).collect();
        assert_eq!(kinds, [Kind::Discs, Kind::Plane, Kind::Azimuth, Kind::Lobe, Kind::Reciprocity]);
        let azimuth = &found[2].svg;
        assert!(azimuth.contains("\nφo 137°\n"), "{azimuth}");
        assert!(!azimuth.contains("\nφo 257°\n") && !azimuth.contains("\nφo 77°\n"));
        assert_eq!(Kind::Plane.of_case(12), "plots/case-0012-plane.svg");
        assert_eq!(Kind::Discs.of_case(12), "plots/case-0012.svg");
    }
}
