//! Where a tabulated subject has jumps.

/// A map of each hemisphere to a unit square that preserves projected solid
/// angle: a unit of area is π sr, and the density of a cosine-distributed
/// direction is constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Projection {
    /// The projected disc (x, y), r = sin θ, by the concentric map of Shirley
    /// and Chiu (1997): cells of tensor trees are squares of it.
    Concentric,
    /// u = φ/2π, v = sin² θ: patches of the Klems bases are rectangles of it.
    Cylindrical,
}

/// A rectangle of the two unit squares: u in [0,1] on the front, in [1,2] on the
/// back; v in [0,1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Lower corner.
    pub lo: [f64; 2],
    /// Upper corner.
    pub hi: [f64; 2],
}

/// The cells within which, for one wo, eval is smooth in wi, as piecewise
/// constant tables are. Together they cover both squares. Integrals are split
/// along their edges, and identities are not tried within rounding of one.
#[derive(Clone, Debug, PartialEq)]
pub struct NativeCells {
    /// The map whose rectangles they are.
    pub projection: Projection,
    /// The azimuth of its x axis (where u counts from), in radians.
    pub phi0: f64,
    /// All cells.
    pub cells: Vec<Rectangle>,
    /// How the table names what wo lies in: "incident patch 17 of …".
    pub given: String,
}
