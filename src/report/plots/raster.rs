//! A small image with a palette, as a data URI.

use super::colours::Rgb;
use base64::Engine;

/// Pixels that name colours of a palette; colour 0 is transparent.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    width: usize,
    palette: Vec<Rgb>,
    pixels: Vec<u8>,
}

impl Raster {
    /// A transparent image. `palette` are the colours from 1 on, 255 at most.
    pub fn new(width: usize, height: usize, palette: Vec<Rgb>) -> Self {
        assert!(palette.len() < 256, "a palette has 255 colours at most");
        Self { width, palette, pixels: vec![0; width * height] }
    }

    /// Sets a pixel, rows counted from the top.
    pub fn set(&mut self, x: usize, y: usize, colour: u8) {
        self.pixels[y * self.width + x] = colour;
    }

    /// `data:image/png;base64,…`
    pub fn data_uri(&self) -> String {
        let height = self.pixels.len() / self.width;
        let mut palette = vec![255, 255, 255];
        palette.extend(self.palette.iter().flatten());
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, height as u32);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_palette(palette);
        encoder.set_trns(vec![0]);
        encoder.set_compression(png::Compression::High);
        encoder.set_filter(png::Filter::NoFilter);
        encoder
            .write_header()
            .and_then(|mut writer| writer.write_image_data(&self.pixels))
            .expect("memory takes every byte, and the sizes are right");
        format!("data:image/png;base64,{}", base64::engine::general_purpose::STANDARD.encode(bytes))
    }
}
