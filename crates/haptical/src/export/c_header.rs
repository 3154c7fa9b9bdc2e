//! Writes a device as a C99 header: constants, and the functions of `assets/step.h` that use them.

use std::fmt::Write;

use haptical_model::kinematics::{self, ChainConstants, Preparation};
use haptical_model::transmission::{Drum, FourBar};
use haptical_runtime::{Capstan, Joint, Motion, POLYNOMIAL_TERMS, Parallelogram, Transmission};

use super::described::Described;
use super::{Provenance, VERSION, c_effects, one_line};
use crate::error::Error as Failure;

/// Types and functions, with marks where the device's numbers go.
const TEMPLATE: &str = include_str!("../../assets/step.h");

/// Its last line.
const END: &str = "#endif\n";

/// The text of the header.
pub(super) fn text(described: &Described, provenance: &Provenance) -> Result<String, Failure> {
    let constants = constants(described)?;
    let comment = format!(
        "/* Written by `haptical export --format c-header`, version {VERSION}: export again, do not edit.\n \
         * Device: {}\n * From: {}, SHA-256 {}\n \
         * C99; link with the mathematics library (-lm). One device per translation unit. */",
        one_line(&provenance.device),
        one_line(&provenance.file),
        provenance.sha256
    );
    // The comment comes last: a device's name may look like a mark.
    let text = TEMPLATE
        .replacen("/*@JOINTS@*/", &described.joints.len().to_string(), 1)
        .replacen("/*@ROWS@*/", &described.rows.len().to_string(), 1)
        .replacen("/*@TERMS@*/", &POLYNOMIAL_TERMS.to_string(), 1)
        .replacen("/*@DATA@*/\n", &data(described, &constants), 1)
        .replacen("/*@PROVENANCE@*/", &comment, 1);
    let effects = c_effects::text(described, &constants);
    let end = text.rfind(END).unwrap_or(text.len());
    Ok(text[..end].to_owned() + &effects + END)
}

/// Rows that move, at most: the chain's constants are worked out in memory of fixed size.
const ROOM: usize = 64;

/// What is left of the chain: its rows move from their homes.
fn constants(described: &Described) -> Result<ChainConstants<ROOM>, Failure> {
    let count = described.rows.len();
    if count > ROOM {
        let what = format!("{count} rows move; the header holds {ROOM}");
        let next = "write --format rust or json";
        return Err(Failure::bad_input(
            "not-exportable",
            what,
            "the device",
            next,
        ));
    }
    let mut chain = Preparation::EMPTY;
    let fixed = (&described.base, kinematics::Motion::Fixed, 0.0);
    let moving = described.rows.iter().zip(&described.drives);
    let moving = moving.map(|(row, drive)| {
        let joint = described.joints.get(drive.joint);
        let home = joint.map_or(0.0, |joint| joint.home);
        let motion = match drive.motion {
            Motion::Revolute => kinematics::Motion::Revolute,
            Motion::Prismatic => kinematics::Motion::Prismatic,
        };
        (row, motion, drive.multiplier * home + drive.offset)
    });
    for (row, motion, home) in std::iter::once(fixed).chain(moving) {
        if let Some(origin) = &row.origin {
            chain = chain.origin(origin);
        }
        let mut link = row.link;
        if let Some(parameter) = motion.variable() {
            link.set(parameter, link.get(parameter) + home);
        }
        chain = chain.row(described.convention, &link, motion);
    }
    if let Some(handle) = &described.handle {
        chain = chain.origin(handle);
    }
    Ok(chain.finish())
}

fn data(described: &Described, constants: &ChainConstants<ROOM>) -> String {
    let start = &constants.start;
    let axes = start.rotation.column_iter();
    let axes = axes.map(|axis| list(axis.into_owned().as_slice()));
    let origin = std::iter::once(list(start.position_m.as_slice()));
    let start: Vec<String> = origin.chain(axes).collect();
    // `write!` to a String cannot fail.
    let mut text = format!(
        "/* Frame of the first row in frame (-1): origin, x, y, z. */\n\
         static const double haptical_start[4][3] = {{\n    {}}};\n\
         /* Sine and cosine of the last turn about z. */\n\
         static const double haptical_end[2] = {};\n\n\
         static const haptical_row haptical_rows[HAPTICAL_ROWS + 1] = {{\n",
        start.join(",\n    "),
        list(&[constants.end_sine, constants.end_cosine]),
    );
    for (row, drive) in constants.joints.iter().zip(&described.drives) {
        let _ = writeln!(
            text,
            "    {{.offset_rad = {:?}, .x_m = {:?}, .y_m = {:?},\n     \
             .twist_sine = {:?}, .twist_cosine = {:?},\n     \
             .prismatic = {}, .joint = {}, .multiplier = {:?}}},",
            row.offset_rad,
            row.x_m,
            row.y_m,
            row.twist_sine,
            row.twist_cosine,
            i32::from(row.is_prismatic),
            drive.joint,
            drive.multiplier
        );
    }
    // one more than there are rows: C knows no empty arrays
    text.push_str("    {.joint = 0},\n};\n\nstatic const haptical_joint haptical_joints[HAPTICAL_JOINTS] = {\n");
    for (joint, range) in described.joints.iter().zip(&described.ranges) {
        push_joint(&mut text, joint, *range);
    }
    text.push_str(
        "};\n\n/* Joint limits of the device file: lowest and highest reading; the largest number where there is none. */\n\
         static const double haptical_limits[HAPTICAL_JOINTS][2] = {\n",
    );
    for ends in &described.limits {
        let ends = ends.map(|end| end.clamp(-f64::MAX, f64::MAX));
        let _ = writeln!(text, "    {},", list(&ends));
    }
    text.push_str("};\n\n");
    text
}

/// A drum's centre over the denominator, and its angle at home.
fn drum(text: &mut String, name: &str, xy_m: [f64; 2], denominator_m: f64) {
    let [x, y] = xy_m.map(|offset_m| offset_m / denominator_m);
    let home_rad = Drum::new(xy_m, denominator_m).home().tangent().atan();
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
    let denominator_m = capstan.drum_distance_m;
    drum(text, "output", capstan.output_drum_xy_m, denominator_m);
    let denominator_m = capstan.input_drum_denominator_m;
    drum(text, "input", capstan.input_drum_xy_m, denominator_m);
}

/// Lengths over the longest, and the interior angle at A at home: docs/equations.md, Parallelogram error.
fn push_loop(text: &mut String, parallelogram: &Parallelogram) {
    let (bars, _) = FourBar::new(parallelogram.lengths_m);
    let [u, v] = bars.corner((0.0, 1.0));
    let s = u.hypot(v);
    let product: f64 = bars.heron(s).into_iter().product();
    let home_rad = v.atan2(u) + product.max(0.0).sqrt().atan2(bars.gamma_side(s));
    let _ = writeln!(
        text,
        "     .lengths = {}, .loop_home_rad = {home_rad:?},",
        list(&bars.lengths())
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
