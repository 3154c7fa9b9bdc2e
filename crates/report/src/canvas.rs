//! Drawing primitives in px, written as SVG.

use crate::colour::{Colour, style_element};
use crate::error::ReportError;
use crate::text::clean;

/// Coordinates are whole units; ten of them make a px, so that curves are not stepped.
const UNITS_PER_PX: f64 = 10.0;
/// Largest side of a picture, in px.
const LARGEST_SIDE_PX: u32 = 20_000;

/// A point in px, from the upper left corner.
pub(crate) type Point = (f64, f64);

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
    /// An empty picture.
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
        canvas.fill(page, Colour::PAPER);
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
        if colour.is_invisible() {
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

    /// A circle that is not filled.
    pub(crate) fn ring(&mut self, (x, y): Point, radius_px: f64, stroke: Stroke) {
        let ([x, y], radius) = ([x, y].map(units), units(radius_px).max(1));
        let (colour, width) = (
            stroke.colour.attributes("stroke"),
            units(stroke.width_px).max(1),
        );
        self.elements += &format!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"none\" {colour} stroke-width=\"{width}\"/>\n"
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

    /// The SVG text, with `title` as the name that screen readers and tool tips give it. It follows the reader's choice of
    /// a light or dark page.
    pub(crate) fn finish(&self, title: &str) -> String {
        let (width, height) = self.size_px;
        let [wide, high] = [width, height].map(|px| units(f64::from(px)));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {wide} {high}\" role=\"img\">\n<title>{}</title>\n{}{}</svg>\n",
            escaped(title),
            style_element(),
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
