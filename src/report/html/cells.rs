//! The cells of a case in few bytes, as the page's script reads them (script/cells.js).
//!
//! Little-endian: version, shape, flags; x axis of the chart and wo as f64; the number of
//! counts that a mass of 1 stands for as f64; the number of nodes; 2 bits a node in
//! preorder (0 a leaf, 2 or 3 a cut across axis 0 or 1); 16 bits a cut, its place within
//! the cell; by leaf the counts, then the expected counts in sixteenths. Numbers without
//! a width are LEB128.

use crate::bsdf::SubjectKind;
use crate::evidence::Evidence;
use crate::sphere::{Cell, Partition, Shape};

/// Of this layout.
const VERSION: u8 = 1;

/// Expected counts are kept in parts of this size.
const PARTS: f64 = 16.0;

/// Stands for a mass of 1 where nothing was drawn.
const UNDRAWN: f64 = (1u64 << 18) as f64;

/// Flags.
const HAS_COUNTS: u8 = 1;
const HAS_PDF: u8 = 2;
const ARE_NORMALS: u8 = 4;

/// Enough for every partition.
pub const ALL: usize = usize::MAX;

/// Cells where pages are crowded.
pub const COARSE: usize = 256;

/// The cells of a case, those deep in the tree pooled until at most `most` are left;
/// `None` where nothing was counted or integrated.
pub fn encode(evidence: &Evidence, most: usize) -> Option<Vec<u8>> {
    let partition = evidence.partition.as_ref()?;
    let draws = evidence.draws.first().filter(|d| d.samples > 0);
    let integrals = evidence.integrals.as_ref().filter(|_| evidence.description.has.pdf);
    let fits = draws.is_none_or(|d| d.counts.len() == partition.len())
        && integrals.is_none_or(|i| i.pdf.len() == partition.len());
    if !fits || (draws.is_none() && integrals.is_none()) {
        return None;
    }
    let chart = partition.chart();
    let shape = match chart.shape() {
        Shape::EqualArea => 0,
        Shape::ProjectedConcentric => 1,
        Shape::ProjectedCylindrical => 2,
    };
    let flag = |on: bool, flag: u8| if on { flag } else { 0 };
    let flags = flag(draws.is_some(), HAS_COUNTS)
        | flag(integrals.is_some(), HAS_PDF)
        | flag(evidence.description.kind == SubjectKind::Distribution, ARE_NORMALS);
    let mut bytes = vec![VERSION, shape, flags];
    let scale = draws.map_or(UNDRAWN, |d| d.samples as f64);
    let [x, y] = chart.x_axis();
    let wo = evidence.wo;
    for value in [x, y, wo.x, wo.y, wo.z, scale] {
        bytes.extend(value.to_le_bytes());
    }
    let leaves = tree(&mut bytes, partition, most);
    if let Some(draws) = draws {
        let sums = partition.sum_up(&draws.counts);
        leaves.iter().for_each(|node| number(&mut bytes, sums[*node]));
    }
    if let Some(integrals) = integrals {
        let sums = partition.sum_up(&integrals.pdf);
        // A conversion takes what is no number, or negative, for 0.
        leaves.iter().for_each(|node| number(&mut bytes, (sums[*node] * scale * PARTS).round() as u64));
    }
    Some(bytes)
}

/// Writes the tree; returns the nodes that are its leaves, in preorder.
fn tree(bytes: &mut Vec<u8>, partition: &Partition, most: usize) -> Vec<usize> {
    let depth = deepest(partition, most);
    let (mut codes, mut cuts, mut leaves) = (Vec::new(), Vec::new(), Vec::new());
    // Cells as they are read again: so rounding of a cut is not handed down.
    let mut open = vec![(0, partition.node_cell(0), 0)];
    while let Some((node, cell, at)) = open.pop() {
        let Some([left, right]) = partition.children(node).filter(|_| at < depth) else {
            codes.push(0u8);
            leaves.push(node);
            continue;
        };
        let (whole, part) = (partition.node_cell(node), partition.node_cell(left));
        let axis = usize::from(part.hi[0] == whole.hi[0]);
        let place = (part.hi[axis] - cell.lo[axis]) / cell.width(axis);
        let cut = (place * 65536.0).round().clamp(1.0, 65535.0);
        codes.push(2 + axis as u8);
        cuts.extend((cut as u16).to_le_bytes());
        let [below, above] = cell.split(axis, cut_of(&cell, axis, cut));
        open.extend([(right, above, at + 1), (left, below, at + 1)]);
    }
    number(bytes, codes.len() as u64);
    bytes.extend(codes.chunks(4).map(|four| four.iter().rev().fold(0, |byte, code| byte << 2 | code)));
    bytes.extend(cuts);
    leaves
}

fn cut_of(cell: &Cell, axis: usize, cut: f64) -> f64 {
    cell.lo[axis] + cell.width(axis) * (cut / 65536.0)
}

/// The depth to which a tree may be shown so that it has at most `most` leaves.
fn deepest(partition: &Partition, most: usize) -> usize {
    if partition.len() <= most {
        return usize::MAX;
    }
    let mut depths = vec![0usize; partition.nodes()];
    // Nodes by depth, and leaves.
    let mut counts: Vec<(usize, usize)> = Vec::new();
    for node in 0..partition.nodes() {
        let depth = depths[node];
        if counts.len() <= depth {
            counts.resize(depth + 1, (0, 0));
        }
        counts[depth].0 += 1;
        match partition.children(node) {
            Some(children) => children.iter().for_each(|child| depths[*child] = depth + 1),
            None => counts[depth].1 += 1,
        }
    }
    let mut above = 0;
    let mut deepest = 0;
    for (depth, (nodes, leaves)) in counts.iter().enumerate() {
        if above + nodes > most {
            break;
        }
        above += leaves;
        deepest = depth;
    }
    deepest
}

fn number(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

#[cfg(test)]
mod tests {
    use super::super::super::plots::synthetic::gallery;
    use super::*;

    /// As the script reads them: sums of counts and of sixteenths, and the leaves.
    fn read(bytes: &[u8]) -> (u64, u64, usize) {
        let mut at = 3 + 6 * 8;
        let number = |at: &mut usize| {
            let (mut value, mut shift) = (0u64, 0);
            loop {
                let byte = bytes[*at];
                *at += 1;
                value |= u64::from(byte & 0x7f) << shift;
                shift += 7;
                if byte < 0x80 {
                    return value;
                }
            }
        };
        let nodes = number(&mut at) as usize;
        at += nodes.div_ceil(4) + 2 * (nodes / 2);
        let leaves = nodes / 2 + 1;
        let counts = (0..leaves).map(|_| number(&mut at)).sum();
        let expected = (0..leaves).map(|_| number(&mut at)).sum();
        assert_eq!(at, bytes.len(), "all is read");
        (counts, expected, leaves)
    }

    #[test]
    fn every_count_is_kept_in_a_few_bytes_a_cell() {
        for (name, evidence) in gallery() {
            let draws: u64 = evidence.draws[0].counts.iter().sum();
            let mass: f64 = evidence.integrals.as_ref().unwrap().pdf.iter().sum();
            for most in [ALL, COARSE] {
                let bytes = encode(&evidence, most).unwrap();
                let (counts, expected, leaves) = read(&bytes);
                assert_eq!(counts, draws, "{name}");
                let expected = expected as f64 / PARTS / draws as f64;
                assert!((expected - mass).abs() < 1e-3, "{name}: {expected} of {mass}");
                assert!(bytes.len() < 64 + 8 * leaves, "{name}: {} bytes", bytes.len());
                assert!(leaves <= most && leaves > 100, "{name}: {leaves}");
            }
        }
    }

    #[test]
    fn what_has_no_cells_has_no_bytes() {
        let (_, mut evidence) = gallery().remove(0);
        let shorter = evidence.draws[0].counts.len() - 1;
        evidence.draws[0].counts.truncate(shorter);
        assert_eq!(encode(&evidence, ALL), None, "counts of another tree");
        evidence.partition = None;
        assert_eq!(encode(&evidence, ALL), None);
    }
}
