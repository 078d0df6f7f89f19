//! The colours of every picture: told apart by the colour-blind, and by their
//! lightness in print.

/// Red, green, blue.
pub type Rgb = [u8; 3];

/// Text and axes.
pub const INK: Rgb = [0x22, 0x22, 0x22];
/// Secondary text and ticks.
pub const SOFT_INK: Rgb = [0x55, 0x55, 0x55];
/// The page under every picture: light, so that a picture reads the same on a
/// dark page.
pub const PAPER: Rgb = [0xff, 0xff, 0xff];
/// Where a density is exactly 0.
pub const NOTHING: Rgb = [0xe4, 0xe4, 0xe4];
/// Where too little is expected to say anything.
pub const UNKNOWN: Rgb = [0xa8, 0xa8, 0xa8];
/// A range that chance explains.
pub const BAND: Rgb = [0xdc, 0xe9, 0xf3];

/// Lines: blue, vermilion and bluish green of M. Okabe and K. Ito, "Color
/// universal design" (2008), in the order of their contrast on paper.
pub const LINES: [Rgb; 3] = [[0x00, 0x72, 0xb2], [0xd5, 0x5e, 0x00], [0x00, 0x9e, 0x73]];

/// Dark violet to yellow, with lightness rising evenly, as matplotlib's viridis.
pub const SEQUENTIAL: [Rgb; 6] = [
    [0x44, 0x01, 0x54],
    [0x41, 0x44, 0x87],
    [0x2a, 0x78, 0x8e],
    [0x22, 0xa8, 0x84],
    [0x7a, 0xd1, 0x51],
    [0xfd, 0xe7, 0x25],
];

/// Blue, white, orange: both ends darken, and differ in hue for every kind of
/// colour vision.
pub const DIVERGING: [Rgb; 5] =
    [[0x08, 0x3c, 0x7a], [0x5b, 0xa0, 0xd0], [0xfa, 0xfa, 0xfa], [0xf0, 0x9a, 0x4a], [0x9a, 0x3a, 0x00]];

fn between(anchors: &[Rgb], t: f64) -> Rgb {
    let place = t.clamp(0.0, 1.0) * (anchors.len() - 1) as f64;
    let below = (place as usize).min(anchors.len() - 2);
    let part = place - below as f64;
    let (a, b) = (anchors[below], anchors[below + 1]);
    [0, 1, 2].map(|k| (f64::from(a[k]) + part * (f64::from(b[k]) - f64::from(a[k]))).round() as u8)
}

/// A colour for `t` in 0 (least) to 1 (most).
pub fn sequential(t: f64) -> Rgb {
    between(&SEQUENTIAL, t)
}

/// A colour for `t` in −1 to 1.
pub fn diverging(t: f64) -> Rgb {
    between(&DIVERGING, 0.5 * (t + 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lightness([r, g, b]: Rgb) -> f64 {
        let linear = |v: u8| (f64::from(v) / 255.0).powf(2.2);
        0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b)
    }

    #[test]
    fn more_is_lighter() {
        let steps: Vec<_> = (0..=50).map(|k| lightness(sequential(f64::from(k) / 50.0))).collect();
        assert!(steps.windows(2).all(|w| w[1] > w[0]), "{steps:?}");
    }

    #[test]
    fn both_signs_darken_alike() {
        for k in 1..=10 {
            let t = f64::from(k) / 10.0;
            let (below, above) = (lightness(diverging(-t)), lightness(diverging(t)));
            assert!(below < lightness(diverging(0.0)) && above < lightness(diverging(0.0)));
            assert!((below - above).abs() < 0.15, "at {t}: {below} and {above}");
        }
    }
}
