//! Distances and positions of a log against how far the device reaches: millimetres taken for metres.

use std::path::Path;

use haptical_model::{Device, JointType, Recording};

use crate::failure::Failure;

/// How far beyond the device's reach the middle reading of a column in metres may lie. Millimetres
/// lie a hundred to a thousand times as far.
const LARGEST_RATIO: f64 = 10.0;
/// Reach below which the device file does not say how large the device is \[m\].
const SMALLEST_REACH_M: f64 = 1e-3;

/// Refuses columns that the device cannot have measured in metres.
pub(crate) fn refuse_millimetres(
    device: &Device,
    recording: &Recording,
    path: &Path,
) -> Result<(), Failure> {
    let reach_m = reach_m(device);
    if !device.has_links() || !reach_m.is_finite() || reach_m < SMALLEST_REACH_M {
        return Ok(());
    }
    let cables = recording.cable_m.iter().enumerate();
    let cables = cables.filter_map(|(index, distances)| {
        let anchor_m = device
            .cables
            .get(index)
            .map_or([0.0; 3], |cable| cable.anchor_m);
        let name = match index {
            0 => "cable_m".to_owned(),
            _ => format!("cable{}_m", index + 1),
        };
        Some((name, distances.clone()?, reach_m + norm(anchor_m)))
    });
    // A tracker in a frame of its own may stand anywhere.
    let is_placed = device
        .tracker
        .as_ref()
        .is_none_or(|tracker| tracker.base_known);
    let position = recording.position_m.as_ref().filter(|_| is_placed);
    let position = position.map(|[x, y, z]| {
        let rows = x.iter().zip(y).zip(z);
        let distances = rows.map(|((x, y), z)| norm([*x, *y, *z])).collect();
        ("x_m, y_m, z_m".to_owned(), distances, reach_m)
    });
    for (name, distances, farthest_m) in cables.chain(position) {
        let Some((middle, line)) = middle(&distances, &recording.line) else {
            continue;
        };
        if middle > LARGEST_RATIO * farthest_m {
            return Err(Failure::log_line(
                "looks-like-millimetres",
                format!(
                    "`{name}` looks like millimetres: its middle reading is {middle:.4}, and the \
                     device reaches {farthest_m:.4} m at most"
                ),
                path,
                line,
                "divide the column by 1000, or correct the lengths in the device file",
            ));
        }
    }
    Ok(())
}

/// Farthest that the handle can be from frame (-1) \[m\]; infinite where a joint slides without
/// limits.
fn reach_m(device: &Device) -> f64 {
    let links: f64 = device
        .links
        .iter()
        .map(|link| link.a_m.hypot(link.d_m))
        .sum();
    let slides = device
        .joints
        .iter()
        .filter(|joint| joint.joint_type == JointType::Prismatic);
    let slides: f64 = slides
        .map(|joint| joint.home_rad.abs() + joint.lower_rad.abs().max(joint.upper_rad.abs()))
        .sum();
    links + slides
}

fn norm([x, y, z]: [f64; 3]) -> f64 {
    x.hypot(y).hypot(z)
}

/// The median of the readings, and the line of the first.
fn middle(readings: &[f64], lines: &[u64]) -> Option<(f64, Option<u64>)> {
    let first = readings.iter().position(|reading| reading.is_finite())?;
    let mut sorted: Vec<f64> = readings.iter().copied().filter(|r| r.is_finite()).collect();
    let half = sorted.len() / 2;
    let (_, middle, _) = sorted.select_nth_unstable_by(half, f64::total_cmp);
    Some((*middle, lines.get(first).copied()))
}
