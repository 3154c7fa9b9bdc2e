//! Cutting lines and polygons at the edge of the plot, and thinning lines that are finer than it.

use crate::canvas::{Point, Rectangle};

/// Lines with fewer points than this are drawn point by point.
const THINNED_FROM: usize = 2000;

/// The parts of a line that lie in the area, each as a line of its own.
pub(crate) fn clip_path(points: &[Point], area: &Rectangle) -> Vec<Vec<Point>> {
    let mut parts: Vec<Vec<Point>> = Vec::new();
    for pair in points.windows(2) {
        let Some((from, to)) = clip_segment(pair[0], pair[1], area) else {
            continue;
        };
        match parts.last_mut() {
            Some(part) if part.last() == Some(&from) => part.push(to),
            _ => parts.push(vec![from, to]),
        }
    }
    parts
}

/// The part of a segment inside the area (Liang and Barsky, 1984).
fn clip_segment(from: Point, to: Point, area: &Rectangle) -> Option<(Point, Point)> {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let (mut start, mut end) = (0.0_f64, 1.0_f64);
    let edges = [
        (-dx, from.0 - area.left),
        (dx, area.right - from.0),
        (-dy, from.1 - area.top),
        (dy, area.bottom - from.1),
    ];
    for (outward, distance) in edges {
        if outward == 0.0 {
            if distance < 0.0 {
                return None;
            }
        } else if outward < 0.0 {
            start = start.max(distance / outward);
        } else {
            end = end.min(distance / outward);
        }
    }
    if start > end {
        return None;
    }
    let at = |t: f64| (from.0 + t * dx, from.1 + t * dy);
    Some((
        if start == 0.0 { from } else { at(start) },
        if end == 1.0 { to } else { at(end) },
    ))
}

/// The part of a polygon inside the area (Sutherland and Hodgman, 1974).
pub(crate) fn clip_polygon(points: &[Point], area: &Rectangle) -> Vec<Point> {
    // Signed distances from the four edges, positive inside.
    let distances: [&dyn Fn(Point) -> f64; 4] = [
        &|p: Point| p.0 - area.left,
        &|p: Point| area.right - p.0,
        &|p: Point| p.1 - area.top,
        &|p: Point| area.bottom - p.1,
    ];
    let mut kept = points.to_vec();
    for distance in distances {
        let input = std::mem::take(&mut kept);
        for (index, &point) in input.iter().enumerate() {
            let previous = input[(index + input.len() - 1) % input.len()];
            let (before, here) = (distance(previous), distance(point));
            if (before < 0.0) != (here < 0.0) {
                let t = before / (before - here);
                kept.push((
                    previous.0 + t * (point.0 - previous.0),
                    previous.1 + t * (point.1 - previous.1),
                ));
            }
            if here >= 0.0 {
                kept.push(point);
            }
        }
    }
    kept
}

/// A long line with the first, lowest, highest and last point of each px column.
///
/// The drawn line covers the same px: a recording of 100 000 samples does not make a picture of
/// megabytes.
pub(crate) fn thin_path(points: Vec<Point>) -> Vec<Point> {
    if points.len() < THINNED_FROM {
        return points;
    }
    let mut kept: Vec<Point> = Vec::new();
    let mut start = 0;
    while start < points.len() {
        let column = points[start].0.floor();
        let length = points[start..]
            .iter()
            .take_while(|p| p.0.floor() == column)
            .count()
            .max(1);
        let run = &points[start..start + length];
        let (mut lowest, mut highest) = (0, 0);
        for (index, point) in run.iter().enumerate() {
            if point.1 < run[lowest].1 {
                lowest = index;
            }
            if point.1 > run[highest].1 {
                highest = index;
            }
        }
        let mut chosen = [0, lowest, highest, length - 1];
        chosen.sort_unstable();
        for (place, &index) in chosen.iter().enumerate() {
            if place == 0 || chosen[place - 1] != index {
                kept.push(run[index]);
            }
        }
        start += length;
    }
    kept
}

/// A line as dashes.
pub(crate) fn dashes(points: &[Point], dash_px: f64, gap_px: f64) -> Vec<Vec<Point>> {
    let mut parts = Vec::new();
    let mut current: Vec<Point> = points.first().map(|&p| vec![p]).unwrap_or_default();
    let (mut drawing, mut left) = (true, dash_px);
    for pair in points.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let t = done / length;
            let point = (from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1));
            if drawing {
                current.push(point);
                parts.push(std::mem::take(&mut current));
            } else {
                current = vec![point];
            }
            drawing = !drawing;
            left = if drawing { dash_px } else { gap_px };
        }
        left -= length - done;
        if drawing {
            current.push(to);
        }
    }
    if current.len() > 1 {
        parts.push(current);
    }
    parts
}
