//! Factorisations that were made before, by the content of their tables.

use super::table::Table;
use super::{FactoredDensity, Factorisation, Given, Grid, Parameterisation};
use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// A few ten kilobytes each; never dropped, since suites come back to all of theirs.
static KNOWN: LazyLock<Mutex<HashMap<[u8; 32], Arc<FactoredDensity>>>> = LazyLock::new(Mutex::default);

/// The factorisation of a table, made once in a process.
pub fn factored(
    table: &Table,
    grid: Grid,
    given: Given,
    isotropic: bool,
    by: Factorisation,
) -> Arc<FactoredDensity> {
    let mut hash = blake3::Hasher::new();
    let half_angle = grid.over == Parameterisation::HalfAngle;
    let shape = [grid.t.intervals(), grid.phi.intervals(), given.len(), by.outer, by.inner].map(|n| n as u64);
    hash.update(&shape.map(u64::to_le_bytes).concat());
    hash.update(&[u8::from(half_angle), u8::from(isotropic)]);
    hash.update(&by.floor.to_le_bytes());
    for value in &table.sites.values {
        hash.update(&value.to_le_bytes());
    }
    let key = *hash.finalize().as_bytes();
    let lock = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = lock().get(&key) {
        return known.clone();
    }
    let made = Arc::new(FactoredDensity::new(table, grid, given, isotropic, by));
    lock().entry(key).or_insert(made).clone()
}
