//! Drawing primitives in px on the SVG backend of plotters.

use std::fmt::Display;

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
        Self { rgb: (red, green, blue), opacity: 1.0 }
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

/// Where a text stands relative to its point.
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
    pub(crate) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(crate) fn height(&self) -> f64 {
        self.bottom - self.top
    }
}

/// A picture in the making. The first failure of the backend is kept and returned at the end.
pub(crate) struct Canvas {
    body: String,
    size_px: (u32, u32),
    failure: Option<ReportError>,
}

impl Canvas {
    /// A white picture.
    pub(crate) fn new(width_px: u32, height_px: u32) -> Result<Self, ReportError> {
        let sides = 1..=LARGEST_SIDE_PX;
        if !sides.contains(&width_px) || !sides.contains(&height_px) {
            let largest_px = LARGEST_SIDE_PX;
            return Err(ReportError::PictureSize { width_px, height_px, largest_px });
        }
        let mut canvas = Self { body: String::new(), size_px: (width_px, height_px), failure: None };
        let page = canvas.page();
        canvas.fill(page, Colour::WHITE);
        Ok(canvas)
    }

    /// The whole picture.
    pub(crate) fn page(&self) -> Rectangle {
        let (width, height) = self.size_px;
        Rectangle { left: 0.0, top: 0.0, right: f64::from(width), bottom: f64::from(height) }
    }

    /// The SVG text, with `title` as the name that screen readers and tool tips give it.
    pub(crate) fn finish(self, title: &str) -> Result<String, ReportError> {
        if let Some(failure) = self.failure {
            return Err(failure);
        }
        let (width, height) = self.size_px;
        let (units_wide, units_high) = (units(f64::from(width)), units(f64::from(height)));
        Ok(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {units_wide} {units_high}\" role=\"img\">\n<title>{}</title>\n{}</svg>\n",
            maud::html! { (clean(title)) }.into_string(),
            self.body
        ))
    }

    /// Straight segments through the points.
    pub(crate) fn path(&mut self, points: &[Point], stroke: Stroke) {
        let style = ShapeStyle {
            color: stroke.colour.plotters(),
            filled: false,
            stroke_width: units(stroke.width_px).max(1).unsigned_abs(),
        };
        self.draw(|backend| backend.draw_path(points.iter().map(backend_point), &style));
    }

    /// A filled polygon.
    pub(crate) fn polygon(&mut self, points: &[Point], colour: Colour) {
        let style = fill_style(colour);
        self.draw(|backend| backend.fill_polygon(points.iter().map(backend_point), &style));
    }

    /// A filled rectangle.
    pub(crate) fn fill(&mut self, area: Rectangle, colour: Colour) {
        let style = fill_style(colour);
        let corners =
            (backend_point(&(area.left, area.top)), backend_point(&(area.right, area.bottom)));
        self.draw(|backend| backend.draw_rect(corners.0, corners.1, &style, true));
    }

    /// A filled circle.
    pub(crate) fn circle(&mut self, centre: Point, radius_px: f64, colour: Colour) {
        let style = fill_style(colour);
        let radius = units(radius_px).max(1).unsigned_abs();
        self.draw(|backend| backend.draw_circle(backend_point(&centre), radius, &style, true));
    }

    /// A text whose vertical centre is at the point.
    pub(crate) fn text(&mut self, text: &str, at: Point, size_px: f64, anchor: Anchor) {
        self.write(text, at, size_px, (anchor, VPos::Center), (FontStyle::Normal, false));
    }

    /// A text that reads upwards; `anchor` refers to its reading direction.
    pub(crate) fn upward_text(&mut self, text: &str, at: Point, size_px: f64, anchor: Anchor) {
        self.write(text, at, size_px, (anchor, VPos::Center), (FontStyle::Normal, true));
    }

    /// A bold text that starts at the point, which is on the foot of its line.
    pub(crate) fn heading(&mut self, text: &str, at: Point, size_px: f64) {
        let place = (Anchor::Start, VPos::Bottom);
        self.write(text, at, size_px, place, (FontStyle::Bold, false));
    }

    fn write(
        &mut self,
        text: &str,
        at: Point,
        size_px: f64,
        (anchor, vertical): (Anchor, VPos),
        (face, upward): (FontStyle, bool),
    ) {
        let horizontal = match anchor {
            Anchor::Start => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::End => HPos::Right,
        };
        let size = size_px * UNITS_PER_PX * BACKEND_FONT_FACTOR;
        let turn = if upward { FontTransform::Rotate270 } else { FontTransform::None };
        let font = FontDesc::new(FontFamily::SansSerif, size, face).transform(turn);
        let colour = Colour::INK.plotters();
        let style = TextStyle::from(font).color(&colour).pos(Pos::new(horizontal, vertical));
        let text = clean(text);
        self.draw(|backend| backend.draw_text(&text, &style, backend_point(&at)));
    }

    /// Runs one drawing call of the backend and appends what it wrote, without its frame.
    fn draw<E: Display>(
        &mut self,
        call: impl FnOnce(&mut SVGBackend<'_>) -> Result<(), E>,
    ) {
        if self.failure.is_some() {
            return;
        }
        let mut element = String::new();
        let outcome = call(&mut SVGBackend::with_string(&mut element, (1, 1)));
        if let Err(error) = outcome {
            self.failure = Some(ReportError::Drawing { message: error.to_string() });
        }
        self.body.push_str(&element);
    }
}

fn fill_style(colour: Colour) -> ShapeStyle {
    ShapeStyle { color: colour.plotters(), filled: true, stroke_width: 0 }
}

fn units(px: f64) -> i32 {
    (px * UNITS_PER_PX).round() as i32
}

fn backend_point(point: &Point) -> (i32, i32) {
    (units(point.0), units(point.1))
}
