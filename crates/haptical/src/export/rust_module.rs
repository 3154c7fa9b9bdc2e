//! Writes a device as a Rust module with one constant of `haptical-runtime`.

use std::fmt::{Debug, Write};

use haptical_runtime::{Capstan, GeneralRow, Link, Pose, Transmission};

use super::described::{Described, row_by_row};
use super::{Provenance, VERSION, one_line};

/// The text of the module.
pub(super) fn text(described: &Described, provenance: &Provenance) -> String {
    let mut text = format!(
        "// Written by `haptical export --format rust`, version {VERSION}: export again, do not edit.\n\
         // Device: {}\n\
         // From: {}, SHA-256 {}\n\n",
        one_line(&provenance.device),
        one_line(&provenance.file),
        provenance.sha256
    );
    let convention = described.convention;
    let (model, constructor, rows) = if described.is_plain_table {
        ("Model<JOINTS>", "Model::new", String::new())
    } else if described.drives_are_plain {
        ("Model<JOINTS>", "Model::general", String::new())
    } else {
        let rows = format!(
            "/// Number of rows that move.\npub const ROWS: usize = {};\n",
            described.rows.len()
        );
        ("CoupledModel<JOINTS, ROWS>", "CoupledModel::new", rows)
    };
    let limits = described.limits.iter();
    let limits: Vec<String> = limits
        .map(|ends| format!("[{}]", ends.map(limit).join(", ")))
        .collect();
    let limits = limits.join(", ");
    // `write!` to a String cannot fail.
    let _ = write!(
        text,
        "/// Name of the device.\npub const DEVICE: &str = {:?};\n\
         /// SHA-256 of the device file.\npub const DEVICE_SHA256: &str = {:?};\n\
         /// Number of joints.\npub const JOINTS: usize = {};\n{rows}\
         /// Joint limits of the device file: lowest and highest reading of each joint.\n\
         #[allow(clippy::approx_constant, reason = \"numbers of a device\")]\n\
         pub const LIMITS: [[f64; 2]; JOINTS] = [{limits}];\n\n\
         /// The device, worked out by the compiler.\n\
         #[allow(\n    clippy::approx_constant,\n    clippy::panic,\n    \
         reason = \"numbers of a device; the compiler alone meets the panic\"\n)]\n\
         pub static MODEL: haptical_runtime::{model} = match haptical_runtime::{constructor}(\n    \
         haptical_runtime::Convention::{convention:?},\n",
        provenance.device,
        provenance.sha256,
        described.joints.len(),
    );
    let row = |own: &GeneralRow| match described.is_plain_table {
        true => link(&own.link),
        false => general_row(own),
    };
    let base = row(&described.base).replace("\n        ", "\n    ");
    let _ = writeln!(text, "    {base},\n    [");
    for joint_row in &described.rows {
        let _ = writeln!(text, "        {},", row(joint_row));
    }
    text.push_str("    ],\n");
    if !described.is_plain_table {
        let _ = writeln!(text, "    {},", pose(described.handle.as_ref()));
    }
    text.push_str("    [\n");
    for (joint, name) in described.joints.iter().zip(&described.names) {
        let _ = write!(
            text,
            "        // joint `{}`\n        haptical_runtime::Joint {{\n            \
             motion: haptical_runtime::Motion::{:?},\n            home: {:?},\n            \
             transmission: {},\n        }},\n",
            one_line(name),
            joint.motion,
            joint.home,
            transmission(&joint.transmission)
        );
    }
    text.push_str("    ],\n");
    if !described.drives_are_plain {
        text.push_str("    [\n");
        for drive in &described.drives {
            let _ = writeln!(
                text,
                "        haptical_runtime::RowDrive {{ motion: haptical_runtime::Motion::{:?}, joint: {}, \
                 multiplier: {:?}, offset: {:?} }},",
                drive.motion, drive.joint, drive.multiplier, drive.offset
            );
        }
        text.push_str("    ],\n");
    }
    text.push_str(
        ") {\n    Ok(model) => match model.with_limits(LIMITS) {\n        Ok(model) => model,\n        \
         // both are met by the compiler alone, where the numbers above were changed\n        \
         Err(_) => panic!(\"a lower limit is not below the upper one\"),\n    },\n    \
         Err(_) => panic!(\"this is not a device that the runtime can hold\"),\n};\n",
    );
    push_effects(&mut text, described);
    text
}

/// The device with its effects, where it has any; and what is left out.
fn push_effects(text: &mut String, described: &Described) {
    let compensation = &described.compensation;
    for left_out in compensation.warnings() {
        let _ = write!(text, "\n// {}\n", one_line(&left_out));
    }
    if compensation.effects.is_empty() {
        return;
    }
    let (rows, model) = match described.is_plain_table || described.drives_are_plain {
        true => ("JOINTS", "haptical_runtime::CoupledModel::of_rows(MODEL)"),
        false => ("ROWS", "MODEL"),
    };
    let _ = write!(
        text,
        "\n/// Number of effects.\npub const EFFECTS: usize = {};\n\n\
         /// The device with its effects.\n\
         #[allow(\n    clippy::approx_constant,\n    clippy::panic,\n    \
         reason = \"numbers of a device; the compiler alone meets the panic\"\n)]\n\
         pub static COMPENSATED: haptical_runtime::CompensatedModel<JOINTS, {rows}, EFFECTS> = \
         match haptical_runtime::CompensatedModel::new(\n    {model},\n    [\n",
        compensation.effects.len(),
    );
    for (label, effect) in &compensation.effects {
        // as Rust writes it, with the paths of the enums
        let debug = format!("{effect:?}")
            .replace("driven_by: ", "driven_by: haptical_runtime::Side::")
            .replace("side: ", "side: haptical_runtime::Turnover::")
            .replace("over: ", "over: haptical_runtime::Over::")
            .replace("coefficients: [", "coefficients: &[");
        let _ = write!(
            text,
            "        // {}\n        haptical_runtime::Effect::{debug},\n",
            one_line(label)
        );
    }
    text.push_str(
        "    ],\n) {\n    Ok(model) => model,\n    \
         Err(_) => panic!(\"these are no effects that the runtime can hold\"),\n};\n",
    );
}

/// A joint limit as Rust writes it.
fn limit(limit: f64) -> String {
    match limit {
        f64::INFINITY => "f64::INFINITY".to_owned(),
        f64::NEG_INFINITY => "f64::NEG_INFINITY".to_owned(),
        finite => format!("{finite:?}"),
    }
}

fn link(link: &Link) -> String {
    // as Rust writes it
    format!("haptical_runtime::{link:?}")
}

fn pose(pose: Option<&Pose>) -> String {
    let Some(pose) = pose else {
        return "None".to_owned();
    };
    let (position_m, rotation) = row_by_row(pose);
    format!("Some(haptical_runtime::Pose::from_rows({position_m:?}, {rotation:?}))")
}

fn general_row(general: &GeneralRow) -> String {
    format!(
        "haptical_runtime::GeneralRow {{\n            origin: {},\n            link: {},\n        }}",
        pose(general.origin.as_ref()),
        link(&general.link),
    )
}

fn capstan(capstan: &Capstan, indent: &str) -> String {
    let fields: [(&str, &dyn Debug); 7] = [
        ("transmission_ratio", &capstan.transmission_ratio),
        ("drum_distance_m", &capstan.drum_distance_m),
        (
            "input_drum_denominator_m",
            &capstan.input_drum_denominator_m,
        ),
        ("offset", &capstan.offset),
        ("ratio_deviation", &capstan.ratio_deviation),
        ("output_drum_xy_m", &capstan.output_drum_xy_m),
        ("input_drum_xy_m", &capstan.input_drum_xy_m),
    ];
    let mut text = "haptical_runtime::Capstan {\n".to_owned();
    for (name, value) in fields {
        let _ = writeln!(text, "{indent}    {name}: {value:?},");
    }
    text + indent + "}"
}

fn transmission(transmission: &Transmission) -> String {
    let indent = " ".repeat(12);
    match transmission {
        Transmission::Exact => "haptical_runtime::Transmission::Exact".to_owned(),
        Transmission::Capstan(drive) => format!(
            "haptical_runtime::Transmission::Capstan({})",
            capstan(drive, &indent)
        ),
        Transmission::Parallelogram(parallelogram) => format!(
            "haptical_runtime::Transmission::Parallelogram(haptical_runtime::Parallelogram {{\n\
             {indent}    capstan: {},\n{indent}    lengths_m: {:?},\n{indent}}})",
            capstan(&parallelogram.capstan, &format!("{indent}    ")),
            parallelogram.lengths_m
        ),
        Transmission::Polynomial {
            range,
            coefficients,
        } => {
            let used = coefficients.iter().rposition(|c| *c != 0.0).unwrap_or(0) + 1;
            let used = coefficients.get(..used).unwrap_or(coefficients);
            format!(
                "haptical_runtime::Transmission::Polynomial {{\n{indent}    range: {range:?},\n\
                 {indent}    coefficients: haptical_runtime::padded({used:?}),\n{indent}}}"
            )
        }
    }
}
