//! Values per named channel.

use std::ops::{Deref, DerefMut, Mul};

/// The most channels a subject may have.
pub const MAX_CHANNELS: usize = 16;

/// 1 to [`MAX_CHANNELS`] values, one per channel of the subject, on the stack.
/// Dereferences to a slice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectrum {
    values: [f64; MAX_CHANNELS],
    channels: usize,
}

impl Spectrum {
    /// The same `value` in each of `channels` channels (at most [`MAX_CHANNELS`]).
    #[inline]
    pub fn uniform(channels: usize, value: f64) -> Self {
        assert!(
            (1..=MAX_CHANNELS).contains(&channels),
            "a spectrum has 1 to {MAX_CHANNELS} channels, not {channels}"
        );
        Self { values: [value; MAX_CHANNELS], channels }
    }

    /// Zero in each of `channels` channels.
    #[inline]
    pub fn zero(channels: usize) -> Self {
        Self::uniform(channels, 0.0)
    }

    /// Channel `c` holds `value(c)`.
    #[inline]
    pub fn from_fn(channels: usize, mut value: impl FnMut(usize) -> f64) -> Self {
        let mut spectrum = Self::zero(channels);
        for (c, v) in spectrum.iter_mut().enumerate() {
            *v = value(c);
        }
        spectrum
    }

    /// Channel by channel.
    #[inline]
    pub fn map(mut self, mut f: impl FnMut(f64) -> f64) -> Self {
        for v in self.iter_mut() {
            *v = f(*v);
        }
        self
    }

    /// Arithmetic mean over the channels.
    #[inline]
    pub fn mean(&self) -> f64 {
        self.iter().sum::<f64>() / self.channels as f64
    }
}

impl From<f64> for Spectrum {
    /// One channel.
    #[inline]
    fn from(value: f64) -> Self {
        Self::uniform(1, value)
    }
}

impl From<&[f64]> for Spectrum {
    #[inline]
    fn from(values: &[f64]) -> Self {
        Self::from_fn(values.len(), |c| values[c])
    }
}

impl Deref for Spectrum {
    type Target = [f64];
    #[inline]
    fn deref(&self) -> &[f64] {
        &self.values[..self.channels]
    }
}

impl DerefMut for Spectrum {
    #[inline]
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.values[..self.channels]
    }
}

impl Mul<f64> for Spectrum {
    type Output = Self;
    #[inline]
    fn mul(self, scale: f64) -> Self {
        self.map(|v| v * scale)
    }
}
