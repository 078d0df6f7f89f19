//! Cases of a subject as curves against θ of wo.

use super::colours::{LINES, Rgb};
use super::figure::Pen;
use crate::bsdf::{SubjectKind, Transport};
use crate::evidence::Evidence;

/// What is joined by a line: one mode, and one azimuth in microdegrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Series {
    importance: bool,
    azimuth: i64,
}

impl Series {
    /// How it looks: colours tell channels apart, dashes modes.
    pub fn pen(self, colour: Rgb) -> Pen {
        Pen { dashed: self.importance, ..Pen::new(colour, 2.0) }
    }
}

/// Something that was found at a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point<T> {
    /// θ of wo in degrees.
    pub theta: f64,
    /// Which line it belongs to.
    pub series: Series,
    /// What was found.
    pub found: T,
}

/// What `of` finds at each case, line by line, by θ.
pub fn points<T: Copy>(cases: &[&Evidence], of: impl Fn(&Evidence) -> Option<T>) -> Vec<Point<T>> {
    let point = |case: &&Evidence| {
        let azimuth = (case.wo.phi().to_degrees() * 1e6).round() as i64;
        let series = Series { importance: case.transport == Transport::Importance, azimuth };
        Some(Point { theta: case.wo.theta().to_degrees(), series, found: of(case)? })
    };
    let mut points: Vec<Point<T>> = cases.iter().filter_map(point).collect();
    // Azimuth means nothing on the normal: such a case belongs to the first line.
    let on_normal = |p: &Point<T>| p.theta < 1e-6 || p.theta > 180.0 - 1e-6;
    let first = points.iter().filter(|p| !on_normal(p)).map(|p| p.series.azimuth).min();
    for point in points.iter_mut().filter(|p| on_normal(p)) {
        point.series.azimuth = first.unwrap_or(point.series.azimuth);
    }
    points.sort_by(|a, b| a.series.cmp(&b.series).then(a.theta.total_cmp(&b.theta)));
    points
}

/// The different angles of points.
pub fn angles<T>(points: &[Vec<Point<T>>]) -> Vec<f64> {
    let mut angles: Vec<f64> = points.iter().flatten().map(|p| p.theta).collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    angles
}

/// Whether any of these cases carries importance, and has a dashed line.
pub fn any_importance(cases: &[&Evidence]) -> bool {
    cases.iter().any(|c| c.transport == Transport::Importance)
}

/// The names of the channels that colours tell apart, and how many there are; `None` of
/// cases without an albedo.
pub fn channels<'a>(cases: &[&'a Evidence]) -> Option<(Vec<&'a str>, usize)> {
    let first = cases.first()?;
    // The area of normals is 1 from everywhere, and no albedo.
    if first.description.kind != SubjectKind::Bsdf || !first.description.has.eval {
        return None;
    }
    let all = &first.description.channels;
    Some((all.iter().take(LINES.len()).map(String::as_str).collect(), all.len()))
}
