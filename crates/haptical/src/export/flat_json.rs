//! Writes a device as JSON: one flat array per quantity, with names and units.

use crate::files::{UNSEALED, sealed_json};
use haptical_runtime::{
    Capstan, Convention, Effect, GeneralRow, Joint, Motion, Pose, Transmission,
};
use serde_json::{Map, Value, json};

use super::compensation::Compensation;
use super::described::{Described, row_by_row};
use super::{COMMAND, Provenance, VERSION};
use crate::error::Error as Failure;

/// The text of the file.
pub(super) fn text(described: &Described, provenance: &Provenance) -> Result<String, Failure> {
    let rows: Vec<&GeneralRow> = std::iter::once(&described.base)
        .chain(&described.rows)
        .collect();
    let place = |pose: Option<&Pose>| pose.map(|pose| row_by_row(pose).0);
    let turn = |pose: Option<&Pose>| pose.map(|pose| row_by_row(pose).1);
    let origins = || rows.iter().map(|row| row.origin.as_ref());
    let drives = || described.drives.iter();
    let row_column =
        |get: fn(&GeneralRow) -> f64| rows.iter().map(|row| get(row)).collect::<Vec<f64>>();
    let joint_column =
        |get: fn(&Joint) -> Value| described.joints.iter().map(get).collect::<Vec<_>>();
    let capstan_column = |get: fn(&Capstan) -> Value| {
        let column = described.joints.iter().map(|joint| capstan(joint).map(get));
        column.collect::<Vec<_>>()
    };
    let ends = |end: usize| {
        let column = described.ranges.iter().map(|range| range[end]);
        column.collect::<Vec<_>>()
    };
    let limits = |end: usize| {
        let column = described.limits.iter().map(|limits| limits[end]);
        column
            .map(|limit| limit.is_finite().then_some(limit))
            .collect::<Vec<_>>()
    };
    let export = json!({
        "format": "haptical-runtime",
        "format_version": 1,
        "command": COMMAND,
        "haptical_version": VERSION,
        "device": provenance.device,
        "device_file": provenance.file,
        "device_sha256": provenance.sha256,
        "result_sha256": UNSEALED,
        "convention": match described.convention {
            Convention::Standard => "standard",
            Convention::Modified => "modified",
        },
        "units": {
            "home": "rad, m for a prismatic joint",
            "lower_limit": "rad, m for a prismatic joint",
            "upper_limit": "rad, m for a prismatic joint",
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
            "driven_by": drives().map(|drive| drive.joint + 1).collect::<Vec<_>>(),
            "type": drives().map(|drive| motion(drive.motion)).collect::<Vec<_>>(),
            "multiplier": drives().map(|drive| drive.multiplier).collect::<Vec<_>>(),
            "offset": drives().map(|drive| drive.offset).collect::<Vec<_>>(),
        },
        "handle_xyz_m": place(described.handle.as_ref()),
        "handle_rotation": turn(described.handle.as_ref()),
        "joints": {
            "name": described.names,
            "type": joint_column(|joint| json!(motion(joint.motion))),
            "home": joint_column(|joint| json!(joint.home)),
            // of the reading, by the device file; null: none
            "lower_limit": limits(0),
            "upper_limit": limits(1),
            "lowest_reading": ends(0),
            "highest_reading": ends(1),
            "transmission_error": joint_column(|joint| json!(match joint.transmission {
                Transmission::Exact => "none",
                Transmission::Capstan(_) => "capstan",
                Transmission::Parallelogram(_) => "parallelogram",
                Transmission::Polynomial { .. } => "chebyshev",
            })),
            "transmission_ratio": capstan_column(|capstan| json!(capstan.transmission_ratio)),
            "drum_distance_m": capstan_column(|capstan| json!(capstan.drum_distance_m)),
            "input_drum_denominator_m": capstan_column(|capstan| json!(capstan.input_drum_denominator_m)),
            "offset": capstan_column(|capstan| json!(capstan.offset)),
            "ratio_deviation": capstan_column(|capstan| json!(capstan.ratio_deviation)),
            "output_drum_xy_m": capstan_column(|capstan| json!(capstan.output_drum_xy_m)),
            "input_drum_xy_m": capstan_column(|capstan| json!(capstan.input_drum_xy_m)),
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
    sealed_json(&with_effects(export, &described.compensation))
}

/// With the effects, where there are any, and what is left out.
fn with_effects(mut export: Value, compensation: &Compensation) -> Value {
    let has_none = compensation.effects.is_empty() && compensation.left_out.is_empty();
    let Some(object) = export.as_object_mut() else {
        return export;
    };
    if !compensation.not_held.is_empty() {
        object.insert("not_held".to_owned(), json!(compensation.not_held));
    }
    if has_none {
        return export;
    }
    let effects = compensation.effects.iter();
    let effects: Vec<Value> = effects.map(|(label, own)| effect(label, own)).collect();
    let left_out = compensation.left_out.iter();
    let left_out: Vec<Value> = left_out
        .map(|own| json!({"effect": own.label, "why": own.why}))
        .collect();
    object.insert("effects".to_owned(), Value::Array(effects));
    object.insert("effects_left_out".to_owned(), Value::Array(left_out));
    export
}

/// An effect: its label, and the law of haptical-runtime with its numbers; joints and rows count from 1.
fn effect(label: &str, effect: &Effect) -> Value {
    let mut object = Map::new();
    object.insert("effect".to_owned(), json!(label));
    // `Backlash { joint: 0, width_rad: 0.002, driven_by: Motor }`, as Rust writes it
    let debug = format!("{effect:?}");
    let (law, fields) = debug.split_once(" { ").unwrap_or((&debug, ""));
    object.insert("law".to_owned(), json!(law));
    for field in split_fields(fields.trim_end_matches(" }")) {
        let Some((key, value)) = field.split_once(": ") else {
            continue;
        };
        let number: Result<Value, _> = serde_json::from_str(value);
        let value = match (key, number, value.split_once('(')) {
            ("joint" | "from" | "row", Ok(index), _) => json!(index.as_u64().map(|own| own + 1)),
            (_, Ok(number), _) => number,
            // `Travel(0.01)`
            (_, Err(_), Some((over, size))) => {
                let size: f64 = size.trim_end_matches(')').parse().unwrap_or(0.0);
                json!({over.to_lowercase(): size})
            }
            (_, Err(_), None) => json!(value.to_lowercase()),
        };
        object.insert(key.to_owned(), value);
    }
    Value::Object(object)
}

/// Fields, with commas of lists within them left alone.
fn split_fields(fields: &str) -> Vec<&str> {
    let (mut parts, mut start, mut depth) = (Vec::new(), 0, 0_i32);
    for (index, character) in fields.char_indices() {
        match character {
            '[' | '(' => depth += 1,
            ']' | ')' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(fields[start..index].trim());
                start = index + 1;
            }
            _ => {}
        }
    }
    parts.push(fields[start..].trim());
    parts
}

fn motion(motion: Motion) -> &'static str {
    match motion {
        Motion::Revolute => "revolute",
        Motion::Prismatic => "prismatic",
    }
}

/// The capstan of a joint; none for a joint without one.
fn capstan(joint: &Joint) -> Option<&Capstan> {
    match &joint.transmission {
        Transmission::Capstan(capstan) => Some(capstan),
        Transmission::Parallelogram(parallelogram) => Some(&parallelogram.capstan),
        Transmission::Exact | Transmission::Polynomial { .. } => None,
    }
}
