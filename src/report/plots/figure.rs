//! The one place where pictures are drawn: an SVG in one visual language.
//!
//! Shapes and text come from plotters' SVG backend, which needs no fonts. It
//! knows whole pixels only, so everything is drawn ten times too large and the
//! picture is told its real size at the end.

use super::colours::{INK, PAPER, Rgb};
use super::raster::Raster;
use plotters::prelude::{DrawingBackend, FontStyle, FontTransform, IntoFont, SVGBackend, TextStyle};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{RGBAColor, ShapeStyle};
use std::fmt::Write;

/// No picture takes more bytes than this.
#[cfg(test)]
pub const MOST_BYTES: usize = 150_000;

/// Units of drawing per pixel.
const FINE: f64 = 10.0;

/// plotters divides font sizes by this.
const FONT_SCALE: f64 = 1.24;

/// Size of text in pixels: legible at half size.
pub const TEXT: f64 = 17.0;

/// A place in pixels from the upper left corner.
pub type At = (f64, f64);

/// How a line looks.
#[derive(Clone, Copy, Debug)]
pub struct Pen {
    /// Colour.
    pub colour: Rgb,
    /// Width in pixels.
    pub width: f64,
    /// 1 is opaque.
    pub opacity: f64,
    /// Whether it is dashed.
    pub dashed: bool,
}

impl Pen {
    /// An opaque, solid line.
    pub fn new(colour: Rgb, width: f64) -> Self {
        Self { colour, width, opacity: 1.0, dashed: false }
    }

    /// Dashed.
    pub fn dashed(self) -> Self {
        Self { dashed: true, ..self }
    }

    /// Of this opacity.
    pub fn opacity(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }
}

/// Which point of a text is placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its left end.
    Start,
    /// Its middle.
    Middle,
    /// Its right end.
    End,
}

/// How text looks. Its place is halfway up its letters.
#[derive(Clone, Copy, Debug)]
pub struct Type {
    /// Which point is placed.
    pub anchor: Anchor,
    /// Size in pixels.
    pub size: f64,
    /// Colour.
    pub colour: Rgb,
    /// Bold.
    pub bold: bool,
    /// A light rim, for text on a picture.
    pub rim: bool,
    /// Reads upwards.
    pub upwards: bool,
}

impl Type {
    /// Plain text of the usual size.
    pub fn new(anchor: Anchor) -> Self {
        Self { anchor, size: TEXT, colour: INK, bold: false, rim: false, upwards: false }
    }

    /// Of this size.
    pub fn size(self, size: f64) -> Self {
        Self { size, ..self }
    }

    /// Of this colour.
    pub fn colour(self, colour: Rgb) -> Self {
        Self { colour, ..self }
    }

    /// Bold.
    pub fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    /// With a light rim.
    pub fn rim(self) -> Self {
        Self { rim: true, ..self }
    }

    /// Upwards.
    pub fn upwards(self) -> Self {
        Self { upwards: true, ..self }
    }
}

/// A picture under way.
#[derive(Clone, Debug)]
pub struct Figure {
    width: f64,
    height: f64,
    title: String,
    description: String,
    body: String,
}

fn fine((x, y): At) -> (i32, i32) {
    ((x * FINE).round() as i32, (y * FINE).round() as i32)
}

fn style(colour: Rgb, opacity: f64, width: f64) -> ShapeStyle {
    let [r, g, b] = colour;
    let stroke_width = (width * FINE).round() as u32;
    ShapeStyle { color: RGBAColor(r, g, b, opacity), filled: true, stroke_width }
}

/// Text that XML takes: names of subjects come from anywhere.
fn printable(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') { ' ' } else { c })
        .collect()
}

fn escaped(text: &str) -> String {
    printable(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// At most `most` characters, an ellipsis in the last place where it was longer.
pub fn shortened(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_string();
    }
    text.chars().take(most.saturating_sub(1)).chain(['…']).collect()
}

impl Figure {
    /// An empty picture. `title` and `description` are what a screen reader says.
    pub fn new(width: f64, height: f64, title: &str, description: &str) -> Self {
        let (title, description) = (escaped(title), escaped(description));
        Self { width, height, title, description, body: String::new() }
    }

    /// What plotters draws, without the frame of a document.
    fn draw(&self, shapes: impl FnOnce(&mut SVGBackend)) -> String {
        let mut text = String::new();
        let size = ((self.width * FINE) as u32, (self.height * FINE) as u32);
        shapes(&mut SVGBackend::with_string(&mut text, size));
        let inner = text.split_once(">\n").map_or("", |(_, rest)| rest);
        let inner = inner.strip_suffix("</svg>\n").unwrap_or(inner);
        inner.replace(" opacity=\"1\"", "").replace(" stroke=\"none\" stroke-width=\"1\"", "")
    }

    fn add(&mut self, shapes: impl FnOnce(&mut SVGBackend)) {
        let drawn = self.draw(shapes);
        self.body.push_str(&drawn);
    }

    /// A line through points. Fewer than two draw nothing.
    pub fn line(&mut self, points: &[At], pen: Pen) {
        if points.len() < 2 {
            return;
        }
        let drawn = self.draw(|backend| {
            let path = points.iter().map(|p| fine(*p));
            backend.draw_path(path, &style(pen.colour, pen.opacity, pen.width)).expect("text takes it");
        });
        let dash = format!("<polyline stroke-dasharray=\"{0} {0}\" ", 4.0 * FINE * pen.width.max(1.0));
        self.body.push_str(&if pen.dashed { drawn.replace("<polyline ", &dash) } else { drawn });
    }

    /// A filled polygon.
    pub fn polygon(&mut self, points: &[At], colour: Rgb) {
        self.add(|backend| {
            let path = points.iter().map(|p| fine(*p));
            backend.fill_polygon(path, &style(colour, 1.0, 0.0)).expect("text takes it");
        });
    }

    /// A filled rectangle.
    pub fn rectangle(&mut self, upper_left: At, lower_right: At, colour: Rgb) {
        self.add(|backend| {
            let (from, to) = (fine(upper_left), fine(lower_right));
            backend.draw_rect(from, to, &style(colour, 1.0, 0.0), true).expect("text takes it");
        });
    }

    /// The outline of a rectangle.
    pub fn frame(&mut self, (x0, y0): At, (x1, y1): At, pen: Pen) {
        self.line(&[(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)], pen);
    }

    /// A filled circle.
    pub fn dot(&mut self, at: At, radius: f64, colour: Rgb) {
        self.add(|backend| {
            let radius = (radius * FINE) as u32;
            backend.draw_circle(fine(at), radius, &style(colour, 1.0, 0.1), true).expect("text takes it");
        });
    }

    /// The outline of a circle.
    pub fn circle(&mut self, at: At, radius: f64, pen: Pen) {
        self.add(|backend| {
            let (radius, style) = ((radius * FINE) as u32, style(pen.colour, pen.opacity, pen.width));
            backend.draw_circle(fine(at), radius, &style, false).expect("text takes it");
        });
    }

    /// A text.
    pub fn text(&mut self, at: At, text: &str, how: Type) {
        let text = printable(text);
        let drawn = self.draw(|backend| {
            let mut font = ("sans-serif", how.size * FINE * FONT_SCALE).into_font();
            if how.bold {
                font = font.style(FontStyle::Bold);
            }
            if how.upwards {
                font = font.transform(FontTransform::Rotate270);
            }
            let h_pos = match how.anchor {
                Anchor::Start => HPos::Left,
                Anchor::Middle => HPos::Center,
                Anchor::End => HPos::Right,
            };
            let [r, g, b] = how.colour;
            let colour = plotters::style::RGBColor(r, g, b);
            let style = TextStyle::from(font).color(&colour).pos(Pos::new(h_pos, VPos::Center));
            backend.draw_text(&text, &style, fine(at)).expect("text takes it");
        });
        let rim =
            "<text paint-order=\"stroke\" stroke=\"#FFFFFF\" stroke-width=\"35\" stroke-linejoin=\"round\" ";
        self.body.push_str(&if how.rim { drawn.replace("<text ", rim) } else { drawn });
    }

    /// An image with sharp pixels.
    pub fn image(&mut self, (x, y): At, (width, height): At, raster: &Raster) {
        let [x, y, width, height] = [x, y, width, height].map(|v| (v * FINE).round());
        writeln!(
            self.body,
            "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" href=\"{}\"/>",
            raster.data_uri()
        )
        .expect("a string takes every text");
    }

    /// The whole document.
    pub fn finish(self) -> String {
        let Self { width, height, title, description, body } = self;
        let (w, h) = (width * FINE, height * FINE);
        let [r, g, b] = PAPER;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {w} {h}\" role=\"img\">\n\
             <title>{title}</title>\n<desc>{description}</desc>\n\
             <rect width=\"{w}\" height=\"{h}\" rx=\"60\" fill=\"#{r:02x}{g:02x}{b:02x}\"/>\n{body}</svg>\n"
        )
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Whether every element is closed, in order, and no character is one that
    /// XML forbids. Enough of a parser for what is written here.
    pub fn assert_well_formed(svg: &str) {
        assert!(!svg.chars().any(|c| c.is_control() && c != '\n'));
        let mut open: Vec<&str> = Vec::new();
        let mut rest = svg;
        while let Some(start) = rest.find('<') {
            let outside = &rest[..start];
            assert!(!outside.contains('>'), "stray >: {outside}");
            for part in outside.split('&').skip(1) {
                assert!(
                    ["amp;", "lt;", "gt;", "quot;", "apos;"].iter().any(|e| part.starts_with(e)),
                    "{part}"
                );
            }
            let end = start + rest[start..].find('>').expect("an unfinished tag");
            let tag = &rest[start + 1..end];
            assert!(!tag.contains('<') && tag.matches('"').count().is_multiple_of(2), "{tag}");
            if let Some(name) = tag.strip_prefix('/') {
                assert_eq!(open.pop(), Some(name));
            } else if !tag.ends_with('/') {
                open.push(tag.split_whitespace().next().unwrap());
            }
            rest = &rest[end + 1..];
        }
        assert!(open.is_empty() && rest.trim().is_empty());
    }

    #[test]
    fn takes_hostile_names() {
        let draw = || {
            let mut figure = Figure::new(200.0, 100.0, "a<b & \"c\" ]]>", "d\u{0}e\u{7}");
            figure.text((10.0, 10.0), "<script>&\u{1b}[0m", Type::new(Anchor::Middle).bold().rim().upwards());
            figure.line(&[(0.0, 0.0), (10.25, 20.5)], Pen::new(INK, 1.5).dashed().opacity(0.5));
            figure.dot((5.0, 5.0), 2.0, INK);
            figure.polygon(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)], INK);
            figure.image((0.0, 0.0), (4.0, 4.0), &Raster::new(4, 4, vec![INK]));
            figure.finish()
        };
        let svg = draw();
        assert_well_formed(&svg);
        assert!(svg.contains("103,205") || svg.contains("102,205"), "{svg}");
        assert!(svg.contains("data:image/png;base64,iVBOR") && svg.contains("stroke-dasharray"));
        assert_eq!(svg, draw());
    }

    #[test]
    fn shortens_by_characters() {
        assert_eq!(shortened("θθθθ", 4), "θθθθ");
        assert_eq!(shortened("θθθθθ", 4), "θθθ…");
    }
}
