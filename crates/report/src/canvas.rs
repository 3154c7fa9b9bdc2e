//! Drawing primitives in px on the SVG backend of plotters.

use plotters::backend::DrawingBackend;
use plotters::prelude::{RGBAColor, SVGBackend, ShapeStyle};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontDesc, FontFamily, FontStyle, FontTransform, TextStyle};

use crate::error::ReportError;
use crate::text::clean;

/// The backend knows whole units only; ten of them make a px, so that curves are not stepped.
const UNITS_PER_PX: f64 = 10.0;
/// Largest side of a picture, in px.
const LARGEST_SIDE_PX: u32 = 20_000;
/// The backend divides a font size by this factor before writing it.
const BACKEND_FONT_FACTOR: f64 = 1.24;

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

    fn plotters(self) -> RGBAColor {
        RGBAColor(self.rgb.0, self.rgb.1, self.rgb.2, self.opacity)
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

/// One thing drawn.
#[derive(Debug, Clone, PartialEq)]
enum Element {
    Path(Vec<Point>, Stroke),
    Polygon(Vec<Point>, Colour),
    Fill(Rectangle, Colour),
    Circle(Point, f64, Colour),
    Text(Lettering),
}

/// A text with its place and face.
#[derive(Debug, Clone, PartialEq)]
struct Lettering {
    text: String,
    at: Point,
    size_px: f64,
    anchor: Anchor,
    bold: bool,
    upward: bool,
}

/// A picture in the making: elements in drawing order.
#[derive(Debug, Clone)]
pub(crate) struct Canvas {
    elements: Vec<Element>,
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
            elements: Vec::new(),
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
        self.elements.push(Element::Path(points.to_vec(), stroke));
    }

    /// A filled polygon.
    pub(crate) fn polygon(&mut self, points: &[Point], colour: Colour) {
        self.elements
            .push(Element::Polygon(points.to_vec(), colour));
    }

    /// A filled rectangle.
    pub(crate) fn fill(&mut self, area: Rectangle, colour: Colour) {
        self.elements.push(Element::Fill(area, colour));
    }

    /// A filled circle.
    pub(crate) fn circle(&mut self, centre: Point, radius_px: f64, colour: Colour) {
        self.elements
            .push(Element::Circle(centre, radius_px, colour));
    }

    /// A text whose vertical centre is at the point.
    pub(crate) fn text(&mut self, text: &str, at: Point, size_px: f64, anchor: Anchor) {
        self.letter(text, at, size_px, anchor, (false, false));
    }

    /// A text that reads upwards; `anchor` refers to its reading direction.
    pub(crate) fn upward_text(&mut self, text: &str, at: Point, size_px: f64, anchor: Anchor) {
        self.letter(text, at, size_px, anchor, (false, true));
    }

    /// A bold text that starts at the point.
    pub(crate) fn heading(&mut self, text: &str, at: Point, size_px: f64) {
        self.letter(text, at, size_px, Anchor::Start, (true, false));
    }

    fn letter(
        &mut self,
        text: &str,
        at: Point,
        size_px: f64,
        anchor: Anchor,
        (bold, upward): (bool, bool),
    ) {
        let text = clean(text);
        self.elements.push(Element::Text(Lettering {
            text,
            at,
            size_px,
            anchor,
            bold,
            upward,
        }));
    }

    /// The SVG text, with `title` as the name that screen readers and tool tips give it.
    pub(crate) fn finish(&self, title: &str) -> Result<String, ReportError> {
        let (width, height) = self.size_px;
        let (wide, high) = (units(f64::from(width)), units(f64::from(height)));
        let failure = |message: String| ReportError::Drawing { message };
        let mut drawn = String::new();
        let mut backend = SVGBackend::with_string(&mut drawn, (1, 1));
        let mut elements = self.elements.iter();
        let outcome = elements.try_for_each(|element| element.draw(&mut backend));
        let present = |()| backend.present().map_err(|error| error.to_string());
        outcome.and_then(present).map_err(failure)?;
        drop(backend);
        // The opening tag of the backend knows one size only; ours has px outside, units inside.
        let (_, body) = drawn
            .split_once(">\n")
            .ok_or_else(|| failure("no opening tag".to_owned()))?;
        Ok(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {wide} {high}\" role=\"img\">\n<title>{}</title>\n{body}",
            maud::html! { (clean(title)) }.into_string(),
        ))
    }
}

impl Element {
    fn draw<B: DrawingBackend>(&self, backend: &mut B) -> Result<(), String> {
        let outcome = match self {
            Self::Path(points, stroke) => {
                let style = ShapeStyle {
                    color: stroke.colour.plotters(),
                    filled: false,
                    stroke_width: units(stroke.width_px).max(1).unsigned_abs(),
                };
                backend.draw_path(points.iter().map(backend_point), &style)
            }
            Self::Polygon(points, colour) => {
                backend.fill_polygon(points.iter().map(backend_point), &fill_style(*colour))
            }
            Self::Fill(area, colour) => {
                let upper_left = backend_point(&(area.left, area.top));
                let lower_right = backend_point(&(area.right, area.bottom));
                backend.draw_rect(upper_left, lower_right, &fill_style(*colour), true)
            }
            Self::Circle(centre, radius_px, colour) => {
                let radius = units(*radius_px).max(1).unsigned_abs();
                backend.draw_circle(backend_point(centre), radius, &fill_style(*colour), true)
            }
            Self::Text(lettering) => return lettering.draw(backend),
        };
        outcome.map_err(|error| error.to_string())
    }
}

impl Lettering {
    fn draw<B: DrawingBackend>(&self, backend: &mut B) -> Result<(), String> {
        let horizontal = match self.anchor {
            Anchor::Start => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::End => HPos::Right,
        };
        let face = if self.bold {
            FontStyle::Bold
        } else {
            FontStyle::Normal
        };
        let turn = if self.upward {
            FontTransform::Rotate270
        } else {
            FontTransform::None
        };
        let size = self.size_px * UNITS_PER_PX * BACKEND_FONT_FACTOR;
        let font = FontDesc::new(FontFamily::SansSerif, size, face).transform(turn);
        let colour = Colour::INK.plotters();
        let style = TextStyle::from(font)
            .color(&colour)
            .pos(Pos::new(horizontal, VPos::Center));
        let outcome = backend.draw_text(&self.text, &style, backend_point(&self.at));
        outcome.map_err(|error| error.to_string())
    }
}

fn fill_style(colour: Colour) -> ShapeStyle {
    ShapeStyle {
        color: colour.plotters(),
        filled: true,
        stroke_width: 0,
    }
}

fn units(px: f64) -> i32 {
    (px * UNITS_PER_PX).round() as i32
}

fn backend_point(point: &Point) -> (i32, i32) {
    (units(point.0), units(point.1))
}
