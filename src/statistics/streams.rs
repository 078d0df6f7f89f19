//! Random streams with names instead of positions.
//!
//! Each block of random numbers is seeded by a keyed hash of what it is for (subject, direction,
//! check, …) and its index. Any block can be made without the ones before it, on any thread, and
//! adding a case to a suite changes no other case's numbers.
//!
//! xoshiro256++ (Blackman and Vigna 2021) gets its full 256-bit state from BLAKE3 in keyed mode.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// Names this way of making streams. Changing anything here changes every number ever drawn.
const DOMAIN: &str = "gonio random streams, version 1";

const PART: u8 = 1;
const BLOCK: u8 = 2;

/// What a family of blocks is for: a seed and a sequence of named parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StreamKey {
    key: [u8; 32],
}

impl StreamKey {
    /// The root of all streams of one suite seed.
    pub fn new(seed: u64) -> Self {
        StreamKey { key: blake3::derive_key(DOMAIN, &seed.to_le_bytes()) }
    }

    /// Extends the name. Order matters; lengths are hashed too, so that ("ab", "c") and
    /// ("a", "bc") differ. One BLAKE3 call, and the original stays usable.
    #[must_use]
    pub fn with(&self, name: &str, value: &str) -> Self {
        let mut hasher = blake3::Hasher::new_keyed(&self.key);
        hasher.update(&[PART]);
        for text in [name, value] {
            hasher.update(&(text.len() as u64).to_le_bytes());
            hasher.update(text.as_bytes());
        }
        StreamKey { key: *hasher.finalize().as_bytes() }
    }

    /// The stream of block `index`.
    pub fn block(&self, index: u64) -> Stream {
        let mut message = [BLOCK; 9];
        message[1..].copy_from_slice(&index.to_le_bytes());
        let seed = blake3::keyed_hash(&self.key, &message);
        Stream { generator: Xoshiro256PlusPlus::from_seed(*seed.as_bytes()) }
    }
}

/// Uniform random numbers of one block.
#[derive(Clone, Debug)]
pub struct Stream {
    generator: Xoshiro256PlusPlus,
}

impl Stream {
    /// 64 uniform bits.
    pub fn next_u64(&mut self) -> u64 {
        self.generator.next_u64()
    }

    /// Uniform on the multiples of 2⁻⁵³ in [0, 1).
    pub fn next_f64(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Uniform on the multiples of 2⁻²⁴ in [0, 1): every value survives conversion to f32, where
    /// rounding a 53-bit one could give 1.
    pub fn next_f32_grid(&mut self) -> f64 {
        (self.next_u64() >> 40) as f64 * (1.0 / (1u64 << 24) as f64)
    }

    /// Fills `out` with numbers of 24 bits ([`next_f32_grid`](Self::next_f32_grid)) or 53
    /// ([`next_f64`](Self::next_f64)).
    pub fn fill(&mut self, precision24: bool, out: &mut [f64]) {
        if precision24 {
            out.fill_with(|| self.next_f32_grid());
        } else {
            out.fill_with(|| self.next_f64());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(key: StreamKey) -> u64 {
        key.block(0).next_u64()
    }

    #[test]
    fn streams_never_change() {
        let key = StreamKey::new(42).with("subject", "ggx").with("check", "fit");
        let mut stream = key.block(3);
        let golden = [9_486_101_505_432_140_272, 1_551_322_319_220_442_507, 4_092_503_469_350_390_434];
        assert_eq!([stream.next_u64(), stream.next_u64(), stream.next_u64()], golden);
    }

    #[test]
    fn names_are_unambiguous() {
        let root = StreamKey::new(1);
        let keys = [
            root,
            StreamKey::new(2),
            root.with("ab", "c"),
            root.with("a", "bc"),
            root.with("", "abc"),
            root.with("abc", ""),
            root.with("ab", "c").with("", ""),
            root.with("a", "b").with("c", "d"),
            root.with("c", "d").with("a", "b"),
        ];
        for (i, a) in keys.iter().enumerate() {
            for b in &keys[..i] {
                assert_ne!(first(*a), first(*b));
            }
        }
        assert_eq!(first(root.with("ab", "c")), first(StreamKey::new(1).with("ab", "c")));
    }

    #[test]
    fn blocks_are_random_access_and_differ() {
        let key = StreamKey::new(9).with("check", "means");
        let in_order: Vec<u64> = (0..100).map(|i| key.block(i).next_u64()).collect();
        for i in (0..100).rev() {
            assert_eq!(key.block(i as u64).next_u64(), in_order[i]);
        }
        let distinct: std::collections::HashSet<_> = in_order.iter().collect();
        assert_eq!(distinct.len(), 100);
    }

    #[test]
    fn bits_are_balanced_within_and_across_blocks() {
        let key = StreamKey::new(5).with("test", "bits");
        let mut inside = key.block(0);
        let mut counts = [[0u32; 64]; 2];
        for i in 0..10_000 {
            for (count, word) in counts.iter_mut().zip([inside.next_u64(), key.block(i).next_u64()]) {
                for (bit, n) in count.iter_mut().enumerate() {
                    *n += (word >> bit & 1) as u32;
                }
            }
        }
        // 5σ of a fair bit over 10 000 draws is 250.
        assert!(counts.as_flattened().iter().all(|&n| n.abs_diff(5000) < 250), "{counts:?}");
    }

    #[test]
    fn grids_and_ranges() {
        let key = StreamKey::new(5).with("test", "grid");
        let (mut a, mut b, mut raw) = (key.block(0), key.block(0), key.block(0));
        let (mut wide, mut narrow) = ([0.0; 1000], [0.0; 1000]);
        a.fill(false, &mut wide);
        b.fill(true, &mut narrow);
        for (w, n) in wide.iter().zip(narrow) {
            let bits = raw.next_u64();
            assert_eq!(*w * 2f64.powi(53), (bits >> 11) as f64);
            assert_eq!(n * 2f64.powi(24), (bits >> 40) as f64);
            assert_eq!(f64::from(n as f32), n);
            assert!((0.0..1.0).contains(w) && (0.0..1.0).contains(&n));
        }
        let mean = wide.iter().sum::<f64>() / 1000.0;
        assert!((mean - 0.5).abs() < 5.0 / (12.0f64 * 1000.0).sqrt());
    }
}
