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
    /// Whether light goes the other way than where it was read.
    reversed: bool,
}

/// A cell of the outgoing square and its value.
pub type Leaf = (Rectangle, f64);

impl Tree {
    /// Reads a tree of `rank` 3 or 4 to the end of the block.
    pub fn read(rank: usize, tokens: &mut Tokens) -> Result<Self, ReadError> {
        let (root, depth) = read_node(rank, 0, tokens)?;
        match tokens.peek()? {
            Token::End => Ok(Self { rank, root, depth, reversed: false }),
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

    /// The first coordinate of rank 3, from the sine of the incident θ.
    pub fn radial(sin_theta: f64) -> f64 {
        (0.5 - OFF_EDGE - 0.5 * sin_theta).max(0.0)
    }

    /// The same scattering with light going the other way: f(−out, −in), so that the
    /// squares change places and are turned about their middles. Not of rank 3, whose
    /// outgoing cells would be no rectangles.
    pub fn backwards(&self) -> Option<Self> {
        (self.rank == 4).then(|| Self { reversed: !self.reversed, ..self.clone() })
    }

    /// The dimensions of the incident coordinates, and those of the outgoing ones.
    fn dimensions(&self) -> (&'static [usize], [usize; 2]) {
        match (self.rank, self.reversed) {
            (3, _) => (&[0], [1, 2]),
            (_, false) => (&[0, 1], [2, 3]),
            (_, true) => (&[2, 3], [0, 1]),
        }
    }

    /// A coordinate of the tree as it was read.
    fn as_read(&self, x: f64) -> f64 {
        if self.reversed { 1.0 - x } else { x }
    }

    /// The value at an incident and an outgoing point.
    pub fn at(&self, incident: &[f64], outgoing: [f64; 2]) -> f64 {
        let (given, free) = self.dimensions();
        let mut local = [0.0; 4];
        for (k, x) in given.iter().zip(incident).chain(free.iter().zip(&outgoing)) {
            local[*k] = self.as_read(*x);
        }
        let local = &mut local[..self.rank];
        let mut node = &self.root;
        loop {
            match node {
                Node::Branch(parts) => {
                    let mut part = 0;
                    for (k, x) in local.iter_mut().enumerate() {
                        part |= descend(x) << k;
                    }
                    node = &parts[part];
                }
                Node::Grid { log2, values } => {
                    return values[local.iter().fold(0, |index, x| (index << log2) + cell(*x, *log2))];
                }
            }
        }
    }

    /// The cells of the outgoing square, given the incident coordinates.
    pub fn outgoing(&self, incident: &[f64]) -> Vec<Leaf> {
        let mut leaves = Vec::new();
        let mut local = [0.0; 2];
        local.iter_mut().zip(incident).for_each(|(l, x)| *l = self.as_read(*x));
        self.collect(&self.root, local, [0.0; 2], 1.0, &mut leaves);
        if self.reversed {
            for (r, _) in &mut leaves {
                *r = Rectangle { lo: r.hi.map(|x| 1.0 - x), hi: r.lo.map(|x| 1.0 - x) };
            }
        }
        leaves
    }

    fn collect(&self, node: &Node, mut local: [f64; 2], lo: [f64; 2], size: f64, leaves: &mut Vec<Leaf>) {
        let (given, free) = self.dimensions();
        match node {
            Node::Branch(parts) => {
                let mut part = 0;
                for (k, x) in given.iter().zip(&mut local) {
                    part |= descend(x) << k;
                }
                let half = 0.5 * size;
                for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let at = [lo[0] + half * i as f64, lo[1] + half * j as f64];
                    self.collect(&parts[part | i << free[0] | j << free[1]], local, at, half, leaves);
                }
            }
            Node::Grid { log2, values } => {
                let side = 1usize << log2;
                let step = size / side as f64;
                let mut index = [0; 4];
                for (k, x) in given.iter().zip(local) {
                    index[*k] = cell(x, *log2);
                }
                for (i, j) in (0..side).flat_map(|i| (0..side).map(move |j| (i, j))) {
                    (index[free[0]], index[free[1]]) = (i, j);
                    let value = values[index[..self.rank].iter().fold(0, |sum, k| (sum << log2) + k)];
                    let corner = |i: usize, j: usize| [lo[0] + step * i as f64, lo[1] + step * j as f64];
                    leaves.push((Rectangle { lo: corner(i, j), hi: corner(i + 1, j + 1) }, value));
                }
            }
        }
    }
}

/// Which half `x` is in, to which it is stretched.
fn descend(x: &mut f64) -> usize {
    let upper = *x >= 0.5;
    *x = 2.0 * *x - if upper { 1.0 } else { 0.0 };
    usize::from(upper)
}

/// Which of 2^log2 cells `x` is in.
fn cell(x: f64, log2: u32) -> usize {
    let side = 1usize << log2;
    ((x * side as f64) as usize).min(side - 1)
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
