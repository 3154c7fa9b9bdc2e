//! An arm as a stick figure before and after, its deviation drawn larger than it is.

use crate::canvas::{Anchor, Canvas, Point, Rectangle, Stroke};
use crate::colour::Colour;
use crate::error::ReportError;
use crate::figure::clip::dashes;
use crate::figure::draw::marker;
use crate::figure::layout::{LINE_PX, MARGIN_PX, TEXT_PX, TITLE_LINE_PX, TITLE_PX, draw_title};
use crate::figure::series::Series;
use crate::text::{BOLD_FACTOR, widest_px, wrap};

/// Azimuth and elevation of the three-quarter view \[rad\]: those of the page that plays a log.
const VIEW: (f64, f64) = (0.9, 0.42);
/// Share of the arm's extent that the largest deviation is drawn as, at most.
const DRAWN_SHARE: f64 = 0.15;
/// Largest factor.
const LARGEST_GAIN: f64 = 1e6;
/// Radius of a joint and of the handle.
const JOINT_PX: f64 = 3.5;
const HANDLE_PX: f64 = 6.0;
/// Widths of the two arms' lines.
const BEFORE_PX: f64 = 2.0;
const AFTER_PX: f64 = 3.0;
/// Length of a dash and of the gap behind it.
const DASH_PX: (f64, f64) = (8.0, 5.0);
/// Smallest room for the arm.
const SMALLEST_PX: f64 = 80.0;
/// Widest line of a note, and the space below a note and beside their column.
const NOTE_PX: f64 = 130.0;
const NOTE_GAP_PX: f64 = 8.0;
/// Free space about the arm.
const ROOM_PX: f64 = 26.0;

/// An arm at one posture, as given and as identified.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ArmPicture {
    /// What the picture shows.
    pub title: String,
    /// Names of the two arms.
    pub names: [String; 2],
    /// Upwards; need not be of unit length.
    pub up: [f64; 3],
    /// The arm as given: base, joints, handle \[m\].
    pub before: Vec<[f64; 3]>,
    /// The arm as identified, point by point as `before` \[m\].
    pub after: Vec<[f64; 3]>,
    /// Words beside points, by their place in `before`.
    pub notes: Vec<(usize, String)>,
}

type Triple = [f64; 3];

fn dot(a: Triple, b: Triple) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Triple, b: Triple) -> Triple {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn unit(a: Triple) -> Triple {
    let size = dot(a, a).sqrt();
    match size > 0.0 {
        true => a.map(|axis| axis / size),
        false => [0.0, 0.0, 1.0],
    }
}

fn minus(a: Triple, b: Triple) -> Triple {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Directions of the picture: to the right and upwards.
fn view(up: Triple) -> [Triple; 2] {
    let up = unit(up);
    let sizes = up.map(f64::abs);
    let smallest = (0..3).fold(0, |least, axis| {
        if sizes[axis] < sizes[least] {
            axis
        } else {
            least
        }
    });
    let mut other = [0.0; 3];
    other[smallest] = 1.0;
    let first = unit(cross(up, other));
    let second = cross(up, first);
    let ((sa, ca), (se, ce)) = (VIEW.0.sin_cos(), VIEW.1.sin_cos());
    let along = |u: f64, v: f64, w: f64| {
        [0, 1, 2].map(|axis: usize| u * first[axis] + v * second[axis] + w * up[axis])
    };
    [along(-sa, ca, 0.0), along(-se * ca, -se * sa, ce)]
}

impl ArmPicture {
    /// How many times larger the deviation is drawn: 1, 2 or 5 times a power of ten, 1 at least.
    pub fn gain(&self) -> f64 {
        let size = |a: Triple| dot(a, a).sqrt();
        let pairs = self.before.iter().zip(&self.after);
        let largest = pairs
            .map(|(from, to)| size(minus(*to, *from)))
            .fold(0.0, f64::max);
        let wanted = DRAWN_SHARE * self.extent() / largest;
        if !wanted.is_finite() || wanted <= 1.0 {
            return 1.0;
        }
        let power = 10_f64.powf(wanted.min(LARGEST_GAIN).log10().floor());
        let step = [5.0, 2.0, 1.0]
            .into_iter()
            .find(|step| step * power <= wanted);
        step.unwrap_or(1.0) * power
    }

    /// Longest side of the box about the arm as given \[m\].
    fn extent(&self) -> f64 {
        let side = |axis: usize| {
            let ends = (f64::INFINITY, f64::NEG_INFINITY);
            let points = self.before.iter();
            let (low, high) = points.fold(ends, |(low, high), point| {
                (low.min(point[axis]), high.max(point[axis]))
            });
            high - low
        };
        (0..3).map(side).fold(0.0, f64::max)
    }

    /// The picture as SVG; the same arm gives the same bytes.
    ///
    /// # Examples
    /// ```
    /// use haptical_report::ArmPicture;
    /// let arm = ArmPicture {
    ///     title: "Lever".to_owned(),
    ///     names: ["as given".to_owned(), "identified".to_owned()],
    ///     up: [0.0, 0.0, 1.0],
    ///     before: vec![[0.0, 0.0, 0.0], [0.0, 0.0, 0.3], [0.2, 0.0, 0.3]],
    ///     after: vec![[0.0, 0.0, 0.0], [0.0, 0.0, 0.3], [0.2, 0.001, 0.3]],
    ///     notes: vec![(1, "joint 2: 0.29°".to_owned())],
    /// };
    /// assert_eq!(arm.gain(), 20.0);
    /// assert!(arm.to_svg(440, 330)?.contains("drawn 20 times"));
    /// # Ok::<(), haptical_report::ReportError>(())
    /// ```
    ///
    /// # Errors
    /// [`ReportError::Empty`] for an arm of fewer than two points or of no extent, [`ReportError::PointCount`] for arms of
    /// different lengths, [`ReportError::NonFinite`], [`ReportError::TooSmall`], [`ReportError::PictureSize`].
    pub fn to_svg(&self, wide_px: u32, high_px: u32) -> Result<String, ReportError> {
        self.check()?;
        let mut canvas = Canvas::new(wide_px, high_px)?;
        let page = canvas.page();
        let inner = page.width() - 2.0 * MARGIN_PX;
        let title = wrap(&self.title, TITLE_PX * BOLD_FACTOR, inner);
        draw_title(&mut canvas, &title, (0.0, 0.0));
        let gain = self.gain();
        let top = MARGIN_PX + title.len() as f64 * TITLE_LINE_PX;
        let top = self.draw_legend(&mut canvas, top, gain);
        let (notes, column_px) = self.column();
        let beside = match notes.is_empty() {
            true => 0.0,
            false => column_px + NOTE_GAP_PX,
        };
        let bottom = page.bottom - MARGIN_PX - LINE_PX;
        let area = Rectangle::new(MARGIN_PX, top, page.right - MARGIN_PX - beside, bottom);
        if area.height() < SMALLEST_PX || area.width() < SMALLEST_PX {
            let (left, needed) = ((area.width(), area.height()), (SMALLEST_PX, SMALLEST_PX));
            return Err(ReportError::too_small(&self.title, left, needed));
        }
        let pairs = self.before.iter().zip(&self.after);
        let larger: Vec<Triple> = pairs
            .map(|(from, to)| {
                [0, 1, 2].map(|axis: usize| from[axis] + gain * (to[axis] - from[axis]))
            })
            .collect();
        let place = Placement::new(self.up, &area, self.before.iter().chain(&larger));
        let [before, after] = [&self.before, &larger].map(|arm| {
            arm.iter()
                .map(|point| place.at(*point))
                .collect::<Vec<Point>>()
        });
        let colours = [Series::BEFORE, Series::AFTER].map(Colour::palette);
        for dash in dashes(&before, DASH_PX.0, DASH_PX.1) {
            canvas.path(&dash, Stroke::new(colours[0], BEFORE_PX));
        }
        canvas.path(&after, Stroke::new(colours[1], AFTER_PX));
        for (arm, index) in [(&before, Series::BEFORE), (&after, Series::AFTER)] {
            for (joint, at) in arm.iter().enumerate() {
                let is_handle = joint + 1 == arm.len();
                marker(
                    &mut canvas,
                    *at,
                    index,
                    if is_handle { HANDLE_PX } else { JOINT_PX },
                );
            }
        }
        let (x, y) = before[0];
        canvas.fill(
            Rectangle::new(x - 6.0, y - 6.0, x + 6.0, y + 6.0),
            Colour::AXIS,
        );
        let room = Rectangle::new(page.right - MARGIN_PX - column_px, top, page.right, bottom);
        draw_notes(&mut canvas, &room, notes, &before);
        place.draw_scale(&mut canvas, &page);
        Ok(canvas.finish(&self.title))
    }

    fn check(&self) -> Result<(), ReportError> {
        if self.before.len() != self.after.len() {
            return Err(ReportError::PointCount {
                figure: self.title.clone(),
                series: self.names[1].clone(),
                got: self.after.len(),
                needed: "as many as the other arm has",
            });
        }
        for (name, arm) in self.names.iter().zip([&self.before, &self.after]) {
            for (index, point) in arm.iter().enumerate() {
                if let Some(value) = point.iter().copied().find(|axis| !axis.is_finite()) {
                    return Err(ReportError::NonFinite {
                        place: format!("figure \"{}\", arm \"{name}\"", self.title),
                        index,
                        value,
                    });
                }
            }
        }
        let extent = self.extent();
        if self.before.len() < 2 || !extent.is_finite() || extent <= 0.0 {
            return Err(ReportError::empty(&self.title, "points"));
        }
        Ok(())
    }

    /// Draws the two names, the second with the factor, below `top`; where the room for the arm begins.
    fn draw_legend(&self, canvas: &mut Canvas, top: f64, gain: f64) -> f64 {
        let drawn = match gain > 1.0 {
            true => format!("{}, its deviation drawn {gain} times", self.names[1]),
            false => self.names[1].clone(),
        };
        let mut y = top + 0.5 * LINE_PX;
        let width = canvas.page().width() - 2.0 * MARGIN_PX - 32.0;
        let entries = [
            (self.names[0].clone(), Series::BEFORE),
            (drawn, Series::AFTER),
        ];
        for (name, index) in entries {
            let line = [(MARGIN_PX, y), (MARGIN_PX + 26.0, y)];
            let stroke = Stroke::new(Colour::palette(index), BEFORE_PX);
            if index == Series::BEFORE {
                for dash in dashes(&line, DASH_PX.0, DASH_PX.1) {
                    canvas.path(&dash, stroke);
                }
            } else {
                canvas.path(&line, stroke);
            }
            marker(canvas, (MARGIN_PX + 13.0, y), index, JOINT_PX + 0.5);
            for words in wrap(&name, TEXT_PX, width) {
                canvas.text(&words, (MARGIN_PX + 32.0, y), TEXT_PX, Anchor::Start);
                y += LINE_PX;
            }
        }
        y - 0.5 * LINE_PX + 4.0
    }

    /// The notes broken into lines, and the width of the column that they take.
    fn column(&self) -> (Vec<(usize, Vec<String>)>, f64) {
        let there = self
            .notes
            .iter()
            .filter(|(point, _)| *point < self.before.len());
        let notes: Vec<(usize, Vec<String>)> = there
            .map(|(point, words)| (*point, wrap(words, TEXT_PX, NOTE_PX)))
            .collect();
        let lines = notes.iter().flat_map(|(_, lines)| lines);
        let width = widest_px(lines, TEXT_PX);
        (notes, width)
    }
}

/// The notes in a column at the right of the arm, in the order of their points, each with a line to its own.
fn draw_notes(
    canvas: &mut Canvas,
    room: &Rectangle,
    mut notes: Vec<(usize, Vec<String>)>,
    points: &[Point],
) {
    notes.sort_by(|(a, _), (b, _)| points[*a].1.total_cmp(&points[*b].1));
    let height = |lines: &[String]| lines.len() as f64 * LINE_PX + NOTE_GAP_PX;
    let mut left = notes.iter().map(|(_, lines)| height(lines)).sum::<f64>();
    let mut top = room.top;
    for (point, lines) in &notes {
        let own = height(lines);
        // beside its point, below the notes before it, and with room for those behind it
        let wanted = points[*point].1 - 0.5 * own;
        top = wanted.min(room.bottom - left).max(top);
        left -= own;
        let first = top + 0.5 * LINE_PX;
        let end = (room.left - 4.0, first);
        canvas.path(&[points[*point], end], Stroke::new(Colour::AXIS, 0.8));
        for (index, line) in lines.iter().enumerate() {
            let at = (room.left, first + index as f64 * LINE_PX);
            canvas.text(line, at, TEXT_PX, Anchor::Start);
        }
        top += own;
    }
}

/// Where points of the arm are in the picture.
struct Placement {
    axes: [Triple; 2],
    /// Middle of all points in the view \[m\], and in the picture.
    centre: Point,
    middle: Point,
    px_per_m: f64,
}

impl Placement {
    fn new<'p>(up: Triple, area: &Rectangle, points: impl Iterator<Item = &'p Triple>) -> Self {
        let axes = view(up);
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        let mut sides = [ends; 2];
        for point in points {
            for (side, axis) in sides.iter_mut().zip(axes) {
                let at = dot(*point, axis);
                *side = (side.0.min(at), side.1.max(at));
            }
        }
        let [width, height] = sides.map(|(low, high)| (high - low).max(1e-12));
        let room = |px: f64| (px - 2.0 * ROOM_PX).max(1.0);
        Self {
            axes,
            centre: (
                0.5 * (sides[0].0 + sides[0].1),
                0.5 * (sides[1].0 + sides[1].1),
            ),
            middle: (
                0.5 * (area.left + area.right),
                0.5 * (area.top + area.bottom),
            ),
            px_per_m: (room(area.width()) / width).min(room(area.height()) / height),
        }
    }

    fn at(&self, point: Triple) -> Point {
        let [right, up] = self.axes.map(|axis| dot(point, axis));
        (
            self.middle.0 + self.px_per_m * (right - self.centre.0),
            self.middle.1 - self.px_per_m * (up - self.centre.1),
        )
    }

    /// A length of 1, 2 or 5 times a power of ten below a quarter of the picture, of the arm as given.
    fn draw_scale(&self, canvas: &mut Canvas, page: &Rectangle) {
        let most_m = 0.25 * page.width() / self.px_per_m;
        let power = 10_f64.powf(most_m.log10().floor());
        let step = [5.0, 2.0, 1.0]
            .into_iter()
            .find(|step| step * power <= most_m);
        let length_m = step.unwrap_or(1.0) * power;
        let (left, y) = (MARGIN_PX, page.bottom - MARGIN_PX);
        let right = left + length_m * self.px_per_m;
        let stroke = Stroke::new(Colour::AXIS, 1.2);
        canvas.path(
            &[(left, y - 4.0), (left, y), (right, y), (right, y - 4.0)],
            stroke,
        );
        let words = match length_m {
            _ if length_m >= 1.0 => format!("{length_m} m"),
            _ if length_m >= 1e-3 => format!("{} mm", (1e3 * length_m).round()),
            _ => format!("{length_m:e} m"),
        };
        canvas.text(&words, (right + 6.0, y - 2.0), TEXT_PX, Anchor::Start);
    }
}
