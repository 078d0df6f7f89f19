//! Tables that were made before.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// Tables of a kind kept at most, of up to 150 kB each; then all are dropped.
const MOST: usize = 256;

/// Tables by what they are made of, each made once in a process: cases of a suite, and
/// their variants, have many in common.
pub(super) struct Memo<K, V>(LazyLock<Mutex<HashMap<K, Arc<V>>>>);

impl<K: Eq + Hash, V> Memo<K, V> {
    /// None yet.
    pub(super) const fn new() -> Self {
        Self(LazyLock::new(Mutex::default))
    }

    /// The table of `key`, which `make` always makes the same. Others may be made
    /// meanwhile; of two that are made at once one is kept.
    pub(super) fn of(&self, key: K, make: impl FnOnce() -> V) -> Arc<V> {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = lock().get(&key) {
            return known.clone();
        }
        let made = Arc::new(make());
        let mut known = lock();
        if known.len() >= MOST {
            known.clear();
        }
        known.entry(key).or_insert(made).clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_made_once_and_they_do_not_pile_up() {
        static KNOWN: Memo<usize, usize> = Memo::new();
        let first = KNOWN.of(0, || 7);
        assert!(Arc::ptr_eq(&first, &KNOWN.of(0, || unreachable!("it is known"))));
        (0..3 * MOST).for_each(|k| assert_eq!(*KNOWN.of(k, || k + 7), k + 7));
        assert!(KNOWN.0.lock().unwrap().len() <= MOST);
    }
}
