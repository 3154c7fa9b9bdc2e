//! Writes a device as JSON: one flat array per quantity, with names and units.

use haptical_runtime::{Capstan, Convention, GeneralRow, Joint, Motion, Pose, Transmission};
use serde_json::{Value, json};

use super::described::{Described, row_by_row};
use super::{Provenance, VERSION};
use crate::failure::Failure;

/// The text of the file.
pub(super) fn text(described: &Described, provenance: &Provenance) -> Result<String, Failure> {
    let rows: Vec<&GeneralRow> = std::iter::once(&described.base)
        .chain(&described.rows)
        .collect();
    let place = |pose: Option<&Pose>| pose.map(|pose| row_by_row(pose).0);
    let turn = |pose: Option<&Pose>| pose.map(|pose| row_by_row(pose).1);
    let origins = || rows.iter().map(|row| row.origin.as_ref());
    let driven_by: Vec<usize> = described
        .drives
        .iter()
        .map(|drive| drive.joint + 1)
        .collect();
    let row_column =
        |get: fn(&GeneralRow) -> f64| rows.iter().map(|row| get(row)).collect::<Vec<f64>>();
    let joint_column = |get: fn(&Joint) -> Value| {
        let column: Vec<Value> = described.joints.iter().map(get).collect();
        column
    };
    let ends = |end: usize| {
        let column: Vec<f64> = described.ranges.iter().map(|range| range[end]).collect();
        column
    };
    let export = json!({
        "format": "haptical-runtime",
        "format_version": 1,
        "haptical_version": VERSION,
        "device": provenance.device,
        "device_file": provenance.file,
        "device_sha256": provenance.sha256,
        "convention": match described.convention {
            Convention::Standard => "standard",
            Convention::Modified => "modified",
        },
        "units": {
            "home": "rad, m for a prismatic joint",
            "lowest_reading": "rad, m for a prismatic joint",
            "highest_reading": "rad, m for a prismatic joint",
            "offset": "rad, m for a prismatic joint",
            "chebyshev": "rad, m for a prismatic joint",
            "transmission_ratio": "1",
            "ratio_deviation": "1",
            "others": "in their names",
        },
        "rows": {
            "a_m": row_column(|row| row.link.a_m),
            "alpha_rad": row_column(|row| row.link.alpha_rad),
            "d_m": row_column(|row| row.link.d_m),
            "theta_offset_rad": row_column(|row| row.link.theta_rad),
            "beta_rad": row_column(|row| row.link.beta_rad),
            "b_m": row_column(|row| row.link.b_m),
            "origin_xyz_m": origins().map(place).collect::<Vec<_>>(),
            "origin_rotation": origins().map(turn).collect::<Vec<_>>(),
        },
        // of rows 1 to n; the row's variable is multiplier (home + output) + offset
        "drives": {
            "driven_by": driven_by,
            "type": described.drives.iter().map(|drive| motion(drive.motion)).collect::<Vec<_>>(),
            "multiplier": described.drives.iter().map(|drive| drive.multiplier).collect::<Vec<_>>(),
            "offset": described.drives.iter().map(|drive| drive.offset).collect::<Vec<_>>(),
        },
        "handle_xyz_m": place(described.handle.as_ref()),
        "handle_rotation": turn(described.handle.as_ref()),
        "joints": {
            "name": described.names,
            "type": joint_column(|joint| json!(motion(joint.motion))),
            "home": joint_column(|joint| json!(joint.home)),
            "lowest_reading": ends(0),
            "highest_reading": ends(1),
            "transmission_error": joint_column(|joint| json!(match joint.transmission {
                Transmission::Exact => "none",
                Transmission::Capstan(_) => "capstan",
                Transmission::Parallelogram(_) => "parallelogram",
                Transmission::Polynomial { .. } => "chebyshev",
            })),
            "transmission_ratio": joint_column(|joint| of_capstan(joint, |c| json!(c.transmission_ratio))),
            "drum_distance_m": joint_column(|joint| of_capstan(joint, |c| json!(c.drum_distance_m))),
            "input_drum_denominator_m":
                joint_column(|joint| of_capstan(joint, |c| json!(c.input_drum_denominator_m))),
            "offset": joint_column(|joint| of_capstan(joint, |c| json!(c.offset))),
            "ratio_deviation": joint_column(|joint| of_capstan(joint, |c| json!(c.ratio_deviation))),
            "output_drum_xy_m": joint_column(|joint| of_capstan(joint, |c| json!(c.output_drum_xy_m))),
            "input_drum_xy_m": joint_column(|joint| of_capstan(joint, |c| json!(c.input_drum_xy_m))),
            "parallelogram_lengths_m": joint_column(|joint| match &joint.transmission {
                Transmission::Parallelogram(parallelogram) => json!(parallelogram.lengths_m),
                _ => Value::Null,
            }),
            "chebyshev": joint_column(|joint| match &joint.transmission {
                Transmission::Polynomial { coefficients, .. } => json!(coefficients),
                _ => Value::Null,
            }),
        },
    });
    let mut text = serde_json::to_string_pretty(&export).map_err(Failure::internal)?;
    text.push('\n');
    Ok(text)
}

fn motion(motion: Motion) -> &'static str {
    match motion {
        Motion::Revolute => "revolute",
        Motion::Prismatic => "prismatic",
    }
}

/// A number of a joint's capstan; null for a joint without one.
fn of_capstan(joint: &Joint, get: fn(&Capstan) -> Value) -> Value {
    match &joint.transmission {
        Transmission::Capstan(capstan) => get(capstan),
        Transmission::Parallelogram(parallelogram) => get(&parallelogram.capstan),
        Transmission::Exact | Transmission::Polynomial { .. } => Value::Null,
    }
}
