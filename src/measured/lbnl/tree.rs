//! Tensor trees: f over the incident and outgoing square, refined where it varies.

use super::error::ReadError;
use super::numbers::{Token, Tokens};
use crate::bsdf::Rectangle;

/// The finest cell is 2⁻⁹ of the square's side: finer than what is simulated, and
/// a bound of the recursion and of the number of incident cells.
const DEEPEST: u32 = 9;

/// The first coordinate of rank 3 is ½ − sin θ/2 less this (Radiance's `FTINY`),
/// which keeps the sines of round angles, as of 30°, off the edges of cells.
const OFF_EDGE: f64 = 1e-6;

/// A node: all of its box has one value a cell of a grid, or it branches in two
/// along each dimension.
#[derive(Clone, Debug, PartialEq)]
enum Node {
    /// 2^rank parts; bit k of a part's number says that it is the upper one along
    /// dimension k.
    Branch(Vec<Node>),
    /// Values of a grid of 2^log2 cells along each dimension, the last one running
    /// fastest.
    Grid { log2: u32, values: Vec<f64> },
}

/// f in sr⁻¹ over [0,1]^rank: coordinates of the incident direction, then two of
/// the outgoing one.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    rank: usize,
    root: Node,
    depth: u32,
}

/// A cell of the outgoing square and its value.
pub type Leaf = (Rectangle, f64);

impl Tree {
    /// Reads a tree of `rank` 3 or 4 to the end of the block.
    pub fn read(rank: usize, tokens: &mut Tokens) -> Result<Self, ReadError> {
        let (root, depth) = read_node(rank, 0, tokens)?;
        match tokens.peek()? {
            Token::End => Ok(Self { rank, root, depth }),
            _ => Err(tokens.wrong("more after the end of the tree")),
        }
    }

    /// 3 or 4.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// log₂ of the finest cells along a side.
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// Number of coordinates of the incident direction.
    pub fn incident_rank(&self) -> usize {
        self.rank - 2
    }

    /// The first coordinate of rank 3, from the sine of the incident θ.
    pub fn radial(sin_theta: f64) -> f64 {
        (0.5 - OFF_EDGE - 0.5 * sin_theta).max(0.0)
    }

    /// The value at a point.
    pub fn at(&self, point: &[f64]) -> f64 {
        let mut local = [0.0; 4];
        local[..self.rank].copy_from_slice(point);
        let local = &mut local[..self.rank];
        let mut node = &self.root;
        loop {
            match node {
                Node::Branch(parts) => {
                    let mut part = 0;
                    for (k, x) in local.iter_mut().enumerate() {
                        let upper = *x >= 0.5;
                        part |= usize::from(upper) << k;
                        *x = 2.0 * *x - if upper { 1.0 } else { 0.0 };
                    }
                    node = &parts[part];
                }
                Node::Grid { log2, values } => {
                    let side = 1usize << log2;
                    let cell = |x: f64| ((x * side as f64) as usize).min(side - 1);
                    return values[local.iter().fold(0, |index, x| index * side + cell(*x))];
                }
            }
        }
    }

    /// The cells of the outgoing square, given the incident coordinates.
    pub fn outgoing(&self, incident: &[f64]) -> Vec<Leaf> {
        let mut leaves = Vec::new();
        let mut local = [0.0; 2];
        local[..incident.len()].copy_from_slice(incident);
        self.collect(&self.root, local, [0.0; 2], 1.0, &mut leaves);
        leaves
    }

    fn collect(&self, node: &Node, mut local: [f64; 2], lo: [f64; 2], size: f64, leaves: &mut Vec<Leaf>) {
        let given = self.incident_rank();
        match node {
            Node::Branch(parts) => {
                let mut part = 0;
                for (k, x) in local[..given].iter_mut().enumerate() {
                    let upper = *x >= 0.5;
                    part |= usize::from(upper) << k;
                    *x = 2.0 * *x - if upper { 1.0 } else { 0.0 };
                }
                let half = 0.5 * size;
                for free in 0..4 {
                    let at = [lo[0] + half * f64::from(free & 1), lo[1] + half * f64::from(free >> 1)];
                    self.collect(&parts[part | (free as usize) << given], local, at, half, leaves);
                }
            }
            Node::Grid { log2, values } => {
                let side = 1usize << log2;
                let cell = |x: f64| ((x * side as f64) as usize).min(side - 1);
                let first = local[..given].iter().fold(0, |index, x| index * side + cell(*x)) * side * side;
                let step = size / side as f64;
                for (k, value) in values[first..first + side * side].iter().enumerate() {
                    let corner = |i: usize, j: usize| [lo[0] + step * i as f64, lo[1] + step * j as f64];
                    let (i, j) = (k / side, k % side);
                    leaves.push((Rectangle { lo: corner(i, j), hi: corner(i + 1, j + 1) }, *value));
                }
            }
        }
    }
}

/// A node and the depth of what is below it.
fn read_node(rank: usize, above: u32, tokens: &mut Tokens) -> Result<(Node, u32), ReadError> {
    if tokens.peek()? != Token::Open {
        return Err(tokens.wrong("a node of the tree starts with `{`"));
    }
    tokens.next()?;
    if tokens.peek()? == Token::Open {
        if above == DEEPEST {
            return Err(tokens.wrong(format!("the tree is deeper than {DEEPEST} levels")));
        }
        let mut parts = Vec::with_capacity(1 << rank);
        let mut deepest = 0;
        for _ in 0..1 << rank {
            if tokens.peek()? != Token::Open {
                let found = parts.len();
                return Err(tokens.wrong(format!("a branch of {found} nodes where {} are needed", 1 << rank)));
            }
            let (part, depth) = read_node(rank, above + 1, tokens)?;
            parts.push(part);
            deepest = deepest.max(depth + 1);
        }
        if tokens.peek()? != Token::Close {
            return Err(tokens.wrong(format!("`}}` is due after {} nodes", 1 << rank)));
        }
        tokens.next()?;
        return Ok((Node::Branch(parts), deepest));
    }
    let start = tokens.place();
    let mut values = Vec::new();
    loop {
        match tokens.peek()? {
            Token::Value(value) => values.push(value),
            Token::Close => break,
            Token::Open => return Err(tokens.wrong("`{` among values")),
            Token::End => return Err(tokens.wrong("the tree ends before its last `}`")),
        }
        tokens.next()?;
    }
    let log2 = (0..=DEEPEST - above).find(|log2| {
        let cells = 1usize.checked_shl(rank as u32 * log2);
        cells == Some(values.len())
    });
    let Some(log2) = log2 else {
        let rule = format!("1, {}, {} and so on are possible", 1 << rank, 1 << (2 * rank));
        return Err(tokens.wrong_from(start, format!("a node of {} values; {rule}", values.len())));
    };
    tokens.next()?;
    Ok((Node::Grid { log2, values }, log2))
}
