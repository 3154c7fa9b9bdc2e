//! Lengths of a log and a rig against how far the device reaches: millimetres taken for metres.

use std::collections::BTreeMap;

use haptical_model::{Device, JointType, Recording};

use crate::CalibrationError;

/// How far beyond the device's reach the middle reading of a column in metres may lie. Millimetres
/// lie a hundred to a thousand times as far.
const LARGEST_RATIO: f64 = 10.0;
/// Reach below which the device file does not say how large the device is \[m\].
const SMALLEST_REACH_M: f64 = 1e-3;

/// The median of a column, in words.
const MIDDLE_READING: &str = "middle reading";
/// Ratio where nothing but the rest of the device says how far a joint slides: rails are longer than arms.
const LARGEST_RATIO_OF_RAILS: f64 = 100.0;
/// How far apart two points may be that the device touches, in reaches; its lengths are nominal.
const PAIR_RATIO: f64 = 3.0;

/// Refuses columns that the device cannot have measured in metres, and distances between points of which it can
/// reach one at most.
///
/// The middle reading of a column decides, so that single wild readings do not.
///
/// ```
/// use haptical_calibration::check_reach;
/// use haptical_model::{Device, Recording};
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
/// let device = Device::load(path.as_ref())?.device;
/// let log = |distance: f64| Recording {
///     line: vec![2],
///     joint: vec![vec![0.0]; 7],
///     cable_m: vec![Some(vec![distance])],
///     ..Recording::default()
/// };
/// assert!(check_reach(&device, &log(0.4)).is_ok());
/// let refused = check_reach(&device, &log(400.0)).unwrap_err();
/// assert!(refused.to_string().contains("`cable_m` looks like millimetres"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`CalibrationError::LooksLikeMillimetres`], [`CalibrationError::Rig`] for a pair of touched points.
pub fn check_reach(device: &Device, recording: &Recording) -> Result<(), CalibrationError> {
    if !device.has_links() {
        return Ok(());
    }
    refuse_rails(device, recording)?;
    let reach_m = reach_m(device);
    if !reach_m.is_finite() || reach_m < SMALLEST_REACH_M {
        return Ok(());
    }
    refuse_pairs(device, reach_m)?;
    for Lengths {
        name,
        what,
        readings,
        farthest_m,
    } in lengths(device, recording, reach_m)
    {
        let Some((middle, line)) = middle(&readings, &recording.line) else {
            continue;
        };
        if middle > LARGEST_RATIO * farthest_m {
            return Err(CalibrationError::LooksLikeMillimetres {
                line,
                what: format!(
                    "`{name}` looks like millimetres: its {what} is {middle:.4}, and the \
                     device reaches {farthest_m:.4} m at most"
                ),
                next: "divide the column by 1000, or correct the lengths in the device file",
            });
        }
    }
    Ok(())
}

/// Columns of lengths.
struct Lengths {
    name: String,
    /// What is looked at, in words.
    what: &'static str,
    readings: Vec<f64>,
    /// How long they can be \[m\].
    farthest_m: f64,
}

fn lengths(device: &Device, recording: &Recording, reach_m: f64) -> Vec<Lengths> {
    let mut found = Vec::new();
    for (index, distances) in recording.cable_m.iter().enumerate() {
        let Some(distances) = distances else {
            continue;
        };
        let cable = device.cables.get(index);
        let anchor_m = cable.map_or([0.0; 3], |cable| cable.anchor_m);
        let name = match index {
            0 => "cable_m".to_owned(),
            _ => format!("cable{}_m", index + 1),
        };
        found.push(Lengths {
            name,
            what: MIDDLE_READING,
            readings: distances.clone(),
            farthest_m: reach_m + norm(anchor_m),
        });
    }
    if let Some([x, y, z]) = &recording.position_m {
        let tracker = device.tracker.as_ref();
        let is_placed = tracker.is_none_or(|tracker| tracker.base_known);
        // a tracker in a frame of its own may be anywhere: what it saw lies about the middle of that
        let runs = |row: usize| match device.has_run_bases() {
            true => recording.run_at(row),
            false => 0,
        };
        let mut middles = BTreeMap::new();
        for row in 0..x.len() {
            middles.entry(runs(row)).or_insert_with(|| match is_placed {
                true => [0.0; 3],
                false => [x, y, z].map(|axis| middle_of_run(axis, runs(row), runs)),
            });
        }
        let what = match is_placed {
            true => MIDDLE_READING,
            false => "middle distance from the middle of all",
        };
        let distances = (0..x.len()).map(|row| {
            let from = middles.get(&runs(row)).copied().unwrap_or_default();
            norm([x[row] - from[0], y[row] - from[1], z[row] - from[2]])
        });
        found.push(Lengths {
            name: "x_m, y_m, z_m".to_owned(),
            what,
            readings: distances.collect(),
            farthest_m: reach_m,
        });
    }
    found
}

/// Middle of what a tracker saw along an axis in one run.
fn middle_of_run(axis: &[f64], run: i64, run_at: impl Fn(usize) -> i64) -> f64 {
    let rows = axis.iter().enumerate();
    let own: Vec<f64> = rows
        .filter(|(row, _)| run_at(*row) == run)
        .map(|(_, value)| *value)
        .collect();
    middle(&own, &[]).map_or(0.0, |(middle, _)| middle)
}

/// Readings of sliding joints against their limits, or the device's links where they have none.
fn refuse_rails(device: &Device, recording: &Recording) -> Result<(), CalibrationError> {
    let joints = device.joints.iter().zip(&recording.joint).enumerate();
    for (index, (joint, readings)) in joints {
        if joint.joint_type != JointType::Prismatic {
            continue;
        }
        let farthest_m = joint.lower_rad.abs().max(joint.upper_rad.abs());
        let (most_m, says) = if farthest_m.is_finite() {
            (
                LARGEST_RATIO * farthest_m,
                format!("its limits reach to {farthest_m:.4} m"),
            )
        } else {
            let links_m = links_m(device);
            (
                LARGEST_RATIO_OF_RAILS * links_m,
                format!("the device's links are {links_m:.4} m long"),
            )
        };
        let sizes: Vec<f64> = readings.iter().map(|reading| reading.abs()).collect();
        let Some((middle, line)) = middle(&sizes, &recording.line) else {
            continue;
        };
        if most_m > SMALLEST_REACH_M && middle > most_m {
            return Err(CalibrationError::LooksLikeMillimetres {
                line,
                what: format!(
                    "`theta{}_m` looks like millimetres: its middle reading is {middle:.4}, and {says}",
                    index + 1
                ),
                next: "divide the column by 1000, or correct the joint's limits in the device file",
            });
        }
    }
    Ok(())
}

/// Known distances between touched points.
fn refuse_pairs(device: &Device, reach_m: f64) -> Result<(), CalibrationError> {
    let mut pairs = device.contact_pairs.iter();
    let far = pairs.find(|pair| pair.distance_m > PAIR_RATIO * reach_m);
    far.map_or(Ok(()), |pair| {
        Err(CalibrationError::Rig {
            what: "[[contact_pair]]".to_owned(),
            message: format!(
                "distance_m = {} between `{}` and `{}` looks like millimetres, since the device reaches {reach_m:.4} m \
                 at most: divide it by 1000, or correct the lengths in the device file",
                pair.distance_m, pair.a, pair.b
            ),
        })
    })
}

/// Farthest that the handle can be from frame (-1) \[m\]; infinite where a joint slides without
/// limits.
fn reach_m(device: &Device) -> f64 {
    let slides = device
        .joints
        .iter()
        .filter(|joint| joint.joint_type == JointType::Prismatic);
    let slides: f64 = slides
        .map(|joint| joint.home_rad.abs() + joint.lower_rad.abs().max(joint.upper_rad.abs()))
        .sum();
    links_m(device) + slides
}

/// Lengths of all links \[m\], constant origins of a URDF included.
fn links_m(device: &Device) -> f64 {
    let links = device.links.iter();
    let links: f64 = links.map(|link| norm([link.a_m, link.b_m, link.d_m])).sum();
    let handles = device.hands.iter().filter_map(|hand| hand.handle.as_ref());
    let origins = device.origins.iter().flatten().chain(handles);
    links + origins.map(|origin| norm(origin.position_m)).sum::<f64>()
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
