//! Writes a device as a C99 header: constants, and the functions of `assets/step.h` that use them.

use std::fmt::Write;

use haptical_model::kinematics::trigonometry::{arctangent2, sine_cosine};
use haptical_runtime::{
    Capstan, Convention, GeneralRow, Joint, Motion, POLYNOMIAL_TERMS, Parallelogram, Pose,
    RowDrive, Transmission,
};

use super::described::{Described, row_by_row};
use super::{Provenance, VERSION, one_line};

/// Types and functions, with marks where the device's numbers go.
const TEMPLATE: &str = include_str!("../../assets/step.h");

/// The text of the header.
pub(super) fn text(described: &Described, provenance: &Provenance) -> String {
    let comment = format!(
        "/* Written by `haptical export --format c-header`, version {VERSION}: export again, do not edit.\n \
         * Device: {}\n * From: {}, SHA-256 {}\n \
         * C99; link with the mathematics library (-lm). One device per translation unit. */",
        one_line(&provenance.device),
        one_line(&provenance.file),
        provenance.sha256
    );
    // The comment comes last: a device's name may look like a mark.
    TEMPLATE
        .replacen("/*@JOINTS@*/", &described.joints.len().to_string(), 1)
        .replacen("/*@ROWS@*/", &described.rows.len().to_string(), 1)
        .replacen("/*@TERMS@*/", &POLYNOMIAL_TERMS.to_string(), 1)
        .replacen("/*@DATA@*/\n", &data(described), 1)
        .replacen("/*@PROVENANCE@*/", &comment, 1)
}

fn data(described: &Described) -> String {
    let modified = i32::from(described.convention == Convention::Modified);
    let general = i32::from(!described.is_plain_table);
    let mut text = format!(
        "#define HAPTICAL_MODIFIED {modified} /* 1: Craig's convention */\n\
         #define HAPTICAL_GENERAL {general} /* 1: rows have origins, or slides along y */\n\n\
         static const haptical_row haptical_rows[HAPTICAL_ROWS + 1] = {{\n"
    );
    let is_general = !described.is_plain_table;
    push_row(&mut text, &described.base, None, is_general);
    for (row, drive) in described.rows.iter().zip(&described.drives) {
        let home = described
            .joints
            .get(drive.joint)
            .map_or(0.0, |own| own.home);
        push_row(
            &mut text,
            &at_home(row, drive, home),
            Some(drive),
            is_general,
        );
    }
    text.push_str("};\n\nstatic const haptical_frame haptical_handle = ");
    push_frame(&mut text, described.handle);
    text.push_str(";\n\nstatic const haptical_joint haptical_joints[HAPTICAL_JOINTS] = {\n");
    for (joint, range) in described.joints.iter().zip(&described.ranges) {
        push_joint(&mut text, joint, *range);
    }
    text.push_str("};\n\n");
    text
}

fn at_home(row: &GeneralRow, drive: &RowDrive, home: f64) -> GeneralRow {
    let mut row = *row;
    let constant = drive.multiplier * home + drive.offset;
    match drive.motion {
        Motion::Revolute => row.link.theta_rad += constant,
        Motion::Prismatic => row.link.d_m += constant,
    }
    row
}

fn push_frame(text: &mut String, pose: Option<Pose>) {
    let (position_m, rotation) = row_by_row(&pose.unwrap_or_default());
    let [x, y, z] = rotation.map(|row| list(&row));
    let _ = write!(text, "{{{}, {{{x}, {y}, {z}}}}}", list(&position_m));
}

fn push_row(text: &mut String, general: &GeneralRow, drive: Option<&RowDrive>, is_general: bool) {
    let row = &general.link;
    let (sin_alpha, cos_alpha) = sine_cosine(row.alpha_rad);
    let (sin_beta, cos_beta) = sine_cosine(row.beta_rad);
    // `write!` to a String cannot fail.
    let _ = write!(
        text,
        "    {{.a_m = {:?}, .d_m = {:?}, .theta_rad = {:?},\n     \
         .sin_alpha = {sin_alpha:?}, .cos_alpha = {cos_alpha:?},\n     \
         .sin_beta = {sin_beta:?}, .cos_beta = {cos_beta:?}",
        row.a_m, row.d_m, row.theta_rad
    );
    if is_general {
        let _ = write!(text, ",\n     .b_m = {:?}, .origin = ", row.b_m);
        push_frame(text, general.origin);
    }
    if let Some(drive) = drive {
        let prismatic = i32::from(drive.motion == Motion::Prismatic);
        let (joint, multiplier) = (drive.joint, drive.multiplier);
        let _ = write!(
            text,
            ",\n     .prismatic = {prismatic}, .joint = {joint}, .multiplier = {multiplier:?}"
        );
    }
    text.push_str("},\n");
}

/// A drum's centre over the denominator, and its angle at home.
fn drum(text: &mut String, name: &str, [x_m, y_m]: [f64; 2], denominator_m: f64) {
    let (x, y) = (x_m / denominator_m, y_m / denominator_m);
    let home_rad = arctangent2(y, 1.0 - x);
    let _ = writeln!(
        text,
        "     .{name}_x = {x:?}, .{name}_y = {y:?}, .{name}_home_rad = {home_rad:?},"
    );
}

fn push_capstan(text: &mut String, capstan: &Capstan) {
    let ratio = capstan.transmission_ratio;
    let slope = -capstan.ratio_deviation / (ratio + capstan.ratio_deviation);
    let _ = writeln!(
        text,
        "     .offset = {:?}, .ratio = {ratio:?}, .ratio_slope = {slope:?},",
        capstan.offset
    );
    drum(
        text,
        "output",
        capstan.output_drum_xy_m,
        capstan.drum_distance_m,
    );
    let denominator_m = capstan.input_drum_denominator_m;
    drum(text, "input", capstan.input_drum_xy_m, denominator_m);
}

/// Lengths over the longest, and the interior angle at A at home by the law of cosines:
/// docs/equations.md, Parallelogram error.
fn push_loop(text: &mut String, parallelogram: &Parallelogram) {
    let longest_m = parallelogram.lengths_m.into_iter().fold(0.0, f64::max);
    let lengths = parallelogram.lengths_m.map(|length_m| length_m / longest_m);
    let [l1, l2, l3, l4] = lengths;
    let s = l1.hypot(l2);
    let cosine = (l4 * l4 + s * s - l3 * l3) / (2.0 * l4 * s);
    let home_rad = l2.atan2(l1) + cosine.clamp(-1.0, 1.0).acos();
    let _ = writeln!(
        text,
        "     .lengths = {}, .loop_home_rad = {home_rad:?},",
        list(&lengths)
    );
}

fn list(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
    format!("{{{}}}", numbers.join(", "))
}

fn push_joint(text: &mut String, joint: &Joint, [lower, upper]: [f64; 2]) {
    let mut members = String::new();
    let name = match &joint.transmission {
        Transmission::Exact => "HAPTICAL_EXACT",
        Transmission::Capstan(capstan) => {
            push_capstan(&mut members, capstan);
            "HAPTICAL_CAPSTAN"
        }
        Transmission::Parallelogram(parallelogram) => {
            push_capstan(&mut members, &parallelogram.capstan);
            push_loop(&mut members, parallelogram);
            "HAPTICAL_PARALLELOGRAM"
        }
        Transmission::Polynomial { coefficients, .. } => {
            let _ = writeln!(members, "     .coefficients = {},", list(coefficients));
            "HAPTICAL_POLYNOMIAL"
        }
    };
    let _ = write!(
        text,
        "    {{.transmission = {name},\n     \
         .lower = {lower:?}, .upper = {upper:?},\n{members}    }},\n"
    );
}
