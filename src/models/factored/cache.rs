//! Factorisations that were made before, by the content of their tables.

use super::table::Table;
use super::{FactoredDensity, Factorisation, Given, Grid, Parameterisation};
use crate::models::memo::Memo;
use std::sync::Arc;

/// The factorisation of a table, made once in a process.
pub fn factored(
    table: &Table,
    grid: Grid,
    given: Given,
    isotropic: bool,
    by: Factorisation,
) -> Arc<FactoredDensity> {
    static KNOWN: Memo<[u8; 32], FactoredDensity> = Memo::new();
    let mut hash = blake3::Hasher::new();
    let half_angle = grid.over == Parameterisation::HalfAngle;
    let shape = [grid.t.intervals(), grid.phi.intervals(), given.len(), by.outer, by.inner].map(|n| n as u64);
    hash.update(&shape.map(u64::to_le_bytes).concat());
    hash.update(&[u8::from(half_angle), u8::from(isotropic)]);
    hash.update(&by.floor.to_le_bytes());
    for value in &table.sites.values {
        hash.update(&value.to_le_bytes());
    }
    KNOWN.of(*hash.finalize().as_bytes(), || FactoredDensity::new(table, grid, given, isotropic, by))
}
