//! Drawing primitives in px, written as SVG.

use crate::error::ReportError;
use crate::text::clean;

/// Coordinates are whole units; ten of them make a px, so that curves are not stepped.
const UNITS_PER_PX: f64 = 10.0;
/// Largest side of a picture, in px.
const LARGEST_SIDE_PX: u32 = 20_000;

/// A point in px, from the upper left corner.
pub(crate) type Point = (f64, f64);

/// A colour with its opacity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Colour {
    rgb: (u8, u8, u8),
    opacity: f64,
}

impl Colour {
    pub(crate) const WHITE: Self = Self::opaque(255, 255, 255);
    pub(crate) const INK: Self = Self::opaque(0x22, 0x22, 0x22);
    pub(crate) const AXIS: Self = Self::opaque(0x55, 0x55, 0x55);
    pub(crate) const GRID: Self = Self::opaque(0xe2, 0xe2, 0xe2);

    const fn opaque(red: u8, green: u8, blue: u8) -> Self {
        Self {
            rgb: (red, green, blue),
            opacity: 1.0,
        }
    }

    /// Colour of the palette by Okabe and Ito, Color Universal Design, 2008; the yellow, which is
    /// the faintest on white, comes last.
    pub(crate) fn palette(index: usize) -> Self {
        match index % 8 {
            0 => Self::opaque(0x00, 0x72, 0xb2),
            1 => Self::opaque(0xd5, 0x5e, 0x00),
            2 => Self::opaque(0x00, 0x9e, 0x73),
            3 => Self::opaque(0xcc, 0x79, 0xa7),
            4 => Self::opaque(0xe6, 0x9f, 0x00),
            5 => Self::opaque(0x56, 0xb4, 0xe9),
            6 => Self::opaque(0x00, 0x00, 0x00),
            _ => Self::opaque(0xf0, 0xe4, 0x42),
        }
    }

    pub(crate) fn with_opacity(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }

    /// Opacity and colour as attributes of SVG, the colour under the name `paint`.
    fn attributes(self, paint: &str) -> String {
        let ((red, green, blue), opacity) = (self.rgb, self.opacity);
        format!("opacity=\"{opacity}\" {paint}=\"#{red:02X}{green:02X}{blue:02X}\"")
    }
}

/// Colour and width of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) colour: Colour,
    pub(crate) width_px: f64,
}

impl Stroke {
    pub(crate) fn new(colour: Colour, width_px: f64) -> Self {
        Self { colour, width_px }
    }
}

/// The side of a text that is at its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// An upright rectangle in px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rectangle {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Rectangle {
    pub(crate) fn new(left: f64, top: f64, right: f64, bottom: f64) -> Self {
        Self {
            left,
            top,
            right,
            bottom,
        }
    }

    pub(crate) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(crate) fn height(&self) -> f64 {
        self.bottom - self.top
    }
}

/// A picture in the making: the elements of SVG in drawing order.
#[derive(Debug, Clone)]
pub(crate) struct Canvas {
    elements: String,
    size_px: (u32, u32),
}

impl Canvas {
    /// A white picture.
    pub(crate) fn new(width_px: u32, height_px: u32) -> Result<Self, ReportError> {
        let sides = 1..=LARGEST_SIDE_PX;
        if !sides.contains(&width_px) || !sides.contains(&height_px) {
            return Err(ReportError::PictureSize {
                width_px,
                height_px,
                largest_px: LARGEST_SIDE_PX,
            });
        }
        let mut canvas = Self {
            elements: String::new(),
            size_px: (width_px, height_px),
        };
        let page = canvas.page();
        canvas.fill(page, Colour::WHITE);
        Ok(canvas)
    }

    /// The whole picture.
    pub(crate) fn page(&self) -> Rectangle {
        let (width, height) = self.size_px;
        Rectangle::new(0.0, 0.0, f64::from(width), f64::from(height))
    }

    /// Straight segments through the points.
    pub(crate) fn path(&mut self, points: &[Point], stroke: Stroke) {
        let colour = stroke.colour.attributes("stroke");
        let (width, points) = (units(stroke.width_px).max(1), list(points));
        self.elements += &format!(
            "<polyline fill=\"none\" {colour} stroke-width=\"{width}\" points=\"{points}\"/>\n"
        );
    }

    /// A filled polygon.
    pub(crate) fn polygon(&mut self, points: &[Point], colour: Colour) {
        let (fill, points) = (colour.attributes("fill"), list(points));
        self.elements += &format!("<polygon {fill} points=\"{points}\"/>\n");
    }

    /// A filled rectangle; none where it could not be seen.
    pub(crate) fn fill(&mut self, area: Rectangle, colour: Colour) {
        if colour.opacity == 0.0 {
            return;
        }
        let [x, y] = [area.left, area.top].map(units);
        let (width, height) = (units(area.right) - x, units(area.bottom) - y);
        let fill = colour.attributes("fill");
        self.elements += &format!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" {fill} stroke=\"none\"/>\n"
        );
    }

    /// A filled circle.
    pub(crate) fn circle(&mut self, (x, y): Point, radius_px: f64, colour: Colour) {
        let ([x, y], radius) = ([x, y].map(units), units(radius_px).max(1));
        let fill = colour.attributes("fill");
        self.elements += &format!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {fill} stroke=\"none\" stroke-width=\"0\"/>\n"
        );
    }

    /// A text whose vertical centre is at the point.
    pub(crate) fn text(&mut self, text: &str, at: Point, size_px: f64, anchor: Anchor) {
        self.letter(text, at, size_px, anchor, "");
    }

    /// A text that reads upwards; `anchor` refers to its reading direction.
    pub(crate) fn upward_text(&mut self, text: &str, at: Point, size_px: f64, anchor: Anchor) {
        let [x, y] = [at.0, at.1].map(units);
        let turn = format!(" transform=\"rotate(270, {x}, {y})\"");
        self.letter(text, at, size_px, anchor, &turn);
    }

    /// A bold text that starts at the point.
    pub(crate) fn heading(&mut self, text: &str, at: Point, size_px: f64) {
        self.letter(text, at, size_px, Anchor::Start, " font-weight=\"bold\"");
    }

    fn letter(&mut self, text: &str, at: Point, size_px: f64, anchor: Anchor, more: &str) {
        let [x, y] = [at.0, at.1].map(units);
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let (size, fill) = (size_px * UNITS_PER_PX, Colour::INK.attributes("fill"));
        let text = escaped(text);
        self.elements += &format!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.5ex\" text-anchor=\"{anchor}\" font-family=\"sans-serif\" \
             font-size=\"{size}\" {fill}{more}>\n{text}\n</text>\n"
        );
    }

    /// The SVG text, with `title` as the name that screen readers and tool tips give it.
    pub(crate) fn finish(&self, title: &str) -> String {
        let (width, height) = self.size_px;
        let [wide, high] = [width, height].map(|px| units(f64::from(px)));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {wide} {high}\" role=\"img\">\n<title>{}</title>\n{}</svg>\n",
            escaped(title),
            self.elements,
        )
    }
}

/// Text on one line, as SVG writes it.
fn escaped(text: &str) -> String {
    maud::html! { (clean(text)) }.into_string()
}

fn list(points: &[Point]) -> String {
    let point = |&(x, y): &Point| format!("{},{} ", units(x), units(y));
    points.iter().map(point).collect()
}

fn units(px: f64) -> i32 {
    (px * UNITS_PER_PX).round() as i32
}
