//! The bytes of a MERL `.binary` file: three i32, the cells along θh, θd and φd,
//! then f64 for each cell (φd fastest, θh slowest) of red, then of green, then of
//! blue, all little-endian. Times [`SCALE`] they are f in sr⁻¹; negative ones are
//! missing.

use super::bytes::{Cursor, FormatError};
use super::half_difference::HalfDifference;
use super::merl::{DIMENSIONS, MerlTable, SCALE, centre};
use crate::bsdf::Direction;
use rayon::prelude::*;

pub(super) const NAME: &str = "MERL .binary";

/// Bytes before the first value.
const HEADER: usize = 12;

/// Whether the content can be meant as a MERL table: it has its dimensions, or as
/// many values as the dimensions that it has.
pub(super) fn is_merl(bytes: &[u8]) -> bool {
    let mut cursor = Cursor::new(NAME, bytes);
    let mut next = || cursor.i32("").ok();
    let Some([a, b, c]) = next().zip(next()).zip(next()).map(|((a, b), c)| [a, b, c]) else {
        return false;
    };
    let ordinary = [a, b, c].map(|n| (1..=10_000).contains(&n)) == [true; 3];
    let promised = i128::from(a) * i128::from(b) * i128::from(c) * 24 + HEADER as i128;
    let swapped = [a, b, c].map(i32::swap_bytes);
    let known = DIMENSIONS.map(|n| n as i32);
    [a, b, c] == known || swapped == known || ordinary && promised == bytes.len() as i128
}

impl MerlTable {
    /// Reads the content of a file and validates all of it.
    pub fn read(bytes: &[u8]) -> Result<Self, FormatError> {
        Self::read_sized(bytes, DIMENSIONS)
    }

    /// As [`read`](Self::read), of a table with other dimensions.
    pub(super) fn read_sized(bytes: &[u8], dimensions: [usize; 3]) -> Result<Self, FormatError> {
        let mut cursor = Cursor::new(NAME, bytes);
        let mut found = [0; 3];
        for (n, axis) in found.iter_mut().zip(["θh", "θd", "φd"]) {
            *n = cursor.i32(&format!("the number of cells along {axis}"))?;
        }
        let [h, d, p] = dimensions;
        if found.map(i64::from) != dimensions.map(|n| n as i64) {
            let [a, b, c] = found;
            let swapped = found.map(i32::swap_bytes).map(i64::from) == dimensions.map(|n| n as i64);
            let why = if swapped { ", the right ones in big-endian order" } else { "" };
            let message = format!("the dimensions are {a} × {b} × {c}{why}; they must be {h} × {d} × {p}");
            return Err(FormatError::new(NAME, 0, message));
        }
        let cells = h * d * p;
        let needed = cells * 24;
        let data = &bytes[HEADER..];
        if data.len() != needed {
            let message = format!(
                "{h} × {d} × {p} cells of three f64 need {needed} bytes after the header, and there are {}: \
                 the file is {}",
                data.len(),
                if data.len() < needed { "truncated" } else { "too long" }
            );
            return Err(FormatError::new(NAME, bytes.len().min(HEADER + needed), message));
        }
        let mut values = vec![[0.0; 3]; cells];
        let wrong = |c: usize| {
            move |(k, (cell, stored)): (usize, (&mut [f64; 3], &[u8]))| {
                let v = f64::from_le_bytes(stored.try_into().expect("chunks of eight"));
                cell[c] = v * SCALE[c];
                (!v.is_finite()).then_some((k, v))
            }
        };
        for (c, plane) in data.chunks_exact(cells * 8).enumerate() {
            let stored = plane.par_chunks_exact(8);
            let first = values
                .par_iter_mut()
                .zip(stored)
                .enumerate()
                .with_min_len(1 << 14)
                .filter_map(wrong(c))
                .min_by_key(|(k, _)| *k);
            if let Some((k, v)) = first {
                let message = format!(
                    "the value of channel {} at θh cell {}, θd cell {}, φd cell {} is {v}; it must be a \
                     finite number (negative where data are missing)",
                    ["r", "g", "b"][c],
                    k / (d * p),
                    k / p % d,
                    k % p
                );
                return Err(FormatError::new(NAME, HEADER + (c * cells + k) * 8, message));
            }
        }
        Ok(Self::new(dimensions, values))
    }

    /// The content of a file that tabulates `value`, f in sr⁻¹ of (wo, wi) for r, g
    /// and b, at the centre of each cell. Where a cell reaches above the horizon
    /// and its centre does not, the directions of the centre are lifted to 0.5°
    /// above it; cells wholly below hold −1.
    pub fn bake(value: impl Fn(Direction, Direction) -> [f64; 3] + Sync) -> Vec<u8> {
        Self::bake_sized(DIMENSIONS, value)
    }

    /// As [`bake`](Self::bake), with other dimensions.
    pub(super) fn bake_sized(
        dimensions: [usize; 3],
        value: impl Fn(Direction, Direction) -> [f64; 3] + Sync,
    ) -> Vec<u8> {
        let [h, d, p] = dimensions;
        let cells: Vec<[f64; 3]> = (0..h * d * p)
            .into_par_iter()
            .map(|index| {
                let cell = [index / (d * p), index / p % d, index % p];
                if !reaches_up(dimensions, cell) {
                    return [-1.0; 3];
                }
                let [wo, wi] = centre(dimensions, cell).pair().map(lifted);
                let f = value(wo, wi);
                [0, 1, 2].map(|c| f[c] / SCALE[c])
            })
            .collect();
        let mut bytes = Vec::with_capacity(HEADER + cells.len() * 24);
        for n in dimensions {
            bytes.extend((n as i32).to_le_bytes());
        }
        for c in 0..3 {
            bytes.extend(cells.iter().flat_map(|cell| cell[c].to_le_bytes()));
        }
        bytes
    }
}

/// Whether any corner of a cell has both directions above the horizon.
fn reaches_up([h, d, p]: [usize; 3], [i, j, k]: [usize; 3]) -> bool {
    use std::f64::consts::{FRAC_PI_2, PI};
    let corner = |a: usize, b: usize, c: usize| HalfDifference {
        theta_h: (a as f64 / h as f64).powi(2) * FRAC_PI_2,
        theta_d: b as f64 / d as f64 * FRAC_PI_2,
        phi_d: c as f64 / p as f64 * PI,
    };
    // Steeper half vectors and smaller differences are higher up.
    [k, k + 1].iter().any(|c| corner(i, j, *c).pair().iter().all(|w| w.z > 0.0))
}

/// At least 0.5° above the horizon.
fn lifted(w: Direction) -> Direction {
    let lowest = 0.5f64.to_radians().sin();
    if w.z >= lowest { w } else { Direction::new(w.x, w.y, lowest * w.x.hypot(w.y)).normalized() }
}
