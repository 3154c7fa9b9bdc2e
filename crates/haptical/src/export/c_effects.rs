//! Writes the effects of a device for the C header: a table, and the functions of `assets/effects.h` that use it.

use std::fmt::Write;

use haptical_model::kinematics::ChainConstants;
use haptical_model::transmission::loops::SMALLEST_HALF_WIDTH;
use haptical_runtime::{Effect, Over, RowDrive, Side, Turnover};

use super::described::Described;
use super::one_line;

/// Types and functions, with marks where the effects go.
const TEMPLATE: &str = include_str!("../../assets/effects.h");

/// The text. A device without effects has a list of one that is none: its inverses are the same functions.
pub(super) fn text<const ROOM: usize>(
    described: &Described,
    constants: &ChainConstants<ROOM>,
) -> String {
    let compensation = &described.compensation;
    let (mut coefficients, mut count) = (String::new(), 0);
    let mut table =
        "static const haptical_effect haptical_effects[HAPTICAL_EFFECTS] = {\n".to_owned();
    for (label, effect) in &compensation.effects {
        let entry = entry(effect, constants, &described.drives);
        let numbers = |numbers: &[f64]| {
            let numbers: Vec<String> = numbers.iter().map(|n| format!("{n:?}")).collect();
            numbers.join(", ")
        };
        // `write!` to a String cannot fail.
        let mut own = String::new();
        if let Effect::Curve {
            coefficients: of, ..
        } = effect
        {
            own = format!(",\n     .first = {count}, .count = {}", of.len());
            count += of.len();
            let _ = writeln!(
                coefficients,
                "    /* {} */\n    {},",
                one_line(label),
                numbers(of)
            );
        }
        let _ = writeln!(
            table,
            "    /* {} */\n    {{.kind = HAPTICAL_{}, .joint = {}, .from = {}, .row = {}, .joint_before = {},\n     \
             .n = {{{}}}, .local_m = {{{}}}{own}}},",
            one_line(label),
            entry.kind,
            entry.joint,
            entry.from,
            entry.row,
            entry.joint_before,
            numbers(&entry.numbers),
            numbers(&entry.local_m),
        );
    }
    if count == 0 {
        // as many as the compiler sees a curve read
        coefficients.push_str("    0.0, 0.0, 0.0, 0.0\n");
    }
    if compensation.effects.is_empty() {
        table.push_str("    {.kind = HAPTICAL_NO_EFFECT},\n");
    }
    table.push_str("};\n\n");
    for left_out in compensation.warnings() {
        let _ = writeln!(table, "/* {} */", one_line(&left_out));
    }
    TEMPLATE
        .replacen(
            "/*@EFFECTS@*/",
            &compensation.effects.len().max(1).to_string(),
            1,
        )
        .replacen("/*@EFFECT_DATA@*/\n", &table, 1)
        .replacen("/*@COEFFICIENTS@*/\n", &coefficients, 1)
}

/// An effect as the C has it.
struct Entry {
    kind: &'static str,
    joint: usize,
    from: usize,
    row: usize,
    joint_before: i64,
    numbers: Vec<f64>,
    local_m: [f64; 3],
}

impl Entry {
    fn new(kind: &'static str, joint: usize, numbers: &[f64]) -> Self {
        Self {
            kind,
            joint,
            from: joint,
            row: 0,
            joint_before: -1,
            numbers: numbers.to_vec(),
            local_m: [0.0; 3],
        }
    }
}

fn entry<const ROOM: usize>(
    effect: &Effect,
    constants: &ChainConstants<ROOM>,
    drives: &[RowDrive],
) -> Entry {
    let carried = |mut entry: Entry, origin_m: [f64; 3]| {
        let own = drives.iter().position(|drive| drive.joint == entry.joint);
        entry.row = own.unwrap_or(0);
        let before = entry.row.checked_sub(1).and_then(|row| drives.get(row));
        entry.joint_before = before.map_or(-1, |drive| drive.joint as i64);
        entry.local_m = constants.local_m(entry.row, origin_m);
        entry
    };
    match *effect {
        Effect::LateralCompliance {
            joint,
            rad_per_nm,
            origin_m,
        } => carried(Entry::new("LATERAL", joint, &[rad_per_nm]), origin_m),
        Effect::AxisWobble {
            joint,
            order,
            cosine_rad: [first_cosine, second_cosine],
            sine_rad: [first_sine, second_sine],
            origin_m,
        } => {
            let numbers = [order, first_cosine, second_cosine, first_sine, second_sine];
            carried(Entry::new("WOBBLE", joint, &numbers), origin_m)
        }
        Effect::Weight {
            row,
            place_m,
            force_n,
        } => Entry {
            row,
            local_m: constants.local_m(row + 1, place_m),
            ..Entry::new("WEIGHT", 0, &force_n)
        },
        Effect::BaseCompliance {
            rad_per_nm,
            base_m: [x, y, z],
        } => Entry::new("BASE", 0, &[rad_per_nm, x, y, z]),
        Effect::ToolCompliance { m_per_n } => Entry::new("TOOL", 0, &[m_per_n]),
        Effect::ThermalGrowth {
            per_degc,
            reference_degc,
            base_m: [x, y, z],
        } => Entry::new("GROWTH", 0, &[per_degc, reference_degc, x, y, z]),
        Effect::ToolChanged { shift_m } => Entry::new("SHIFT", 0, &shift_m),
        _ => drive_entry(effect).unwrap_or_else(|| torque_entry(effect)),
    }
}

/// Errors of joint angles.
fn drive_entry(effect: &Effect) -> Option<Entry> {
    Some(match *effect {
        Effect::CapstanCompliance { joint, rad_per_nm } => {
            Entry::new("CAPSTAN_COMPLIANCE", joint, &[rad_per_nm])
        }
        Effect::JointCompliance { joint, rad_per_nm } => {
            Entry::new("JOINT_COMPLIANCE", joint, &[rad_per_nm])
        }
        Effect::Backlash {
            joint,
            width_rad,
            driven_by,
        } => {
            let half_rad = 0.5 * width_rad;
            match driven_by {
                Side::Motor => Entry::new(
                    "PLAY",
                    joint,
                    &[half_rad.max(SMALLEST_HALF_WIDTH), half_rad],
                ),
                Side::Hand => Entry::new("DAHL", joint, &[0.0, half_rad]),
            }
        }
        Effect::CoupledBacklash {
            joint,
            from,
            width_rad,
            play_rad,
        } => Entry {
            from,
            ..Entry::new("PLAY", joint, &[0.5 * play_rad, width_rad / play_rad])
        },
        Effect::Hysteresis {
            joint,
            amplitude_rad,
            transition_rad,
            driven_by,
        } => {
            let amplitude_rad = match driven_by {
                Side::Motor => -amplitude_rad,
                Side::Hand => amplitude_rad,
            };
            Entry::new("DAHL", joint, &[transition_rad, amplitude_rad])
        }
        Effect::CapstanCreep {
            joint,
            creep_per_nm,
        } => Entry::new("CREEP", joint, &[creep_per_nm]),
        Effect::ViscousLag { joint, delay_s } => Entry::new("LAG", joint, &[delay_s]),
        Effect::EncoderLatency { delay_s } => Entry::new("LATENCY", 0, &[delay_s]),
        Effect::Harmonic {
            joint,
            periods,
            cosine_rad,
            sine_rad,
        } => Entry::new("HARMONIC", joint, &[periods, cosine_rad, sine_rad]),
        Effect::CablePitch {
            joint,
            quadratic_per_rad,
            cubic_per_rad2,
        } => Entry::new("POWERS", joint, &[quadratic_per_rad, cubic_per_rad2]),
        Effect::Coupling { joint, from, gain } => Entry {
            from,
            ..Entry::new("COUPLING", joint, &[gain])
        },
        Effect::Drift { joint, rad_per_s } => Entry::new("DRIFT", joint, &[rad_per_s]),
        Effect::SettlingDrift {
            joint,
            end_rad,
            time_constant_s,
        } => Entry::new("SETTLING", joint, &[end_rad, time_constant_s]),
        Effect::WarmDrift {
            joint,
            rad_per_degc,
            reference_degc,
        } => Entry::new("WARM", joint, &[rad_per_degc, reference_degc]),
        Effect::Curve {
            joint,
            over,
            lower,
            upper,
            ..
        } => {
            let kind = match over {
                Over::Angle => "CURVE_OVER_ANGLE",
                Over::Torque => "CURVE_OVER_TORQUE",
                Over::Temperature => "CURVE_OVER_TEMPERATURE",
                Over::Time => "CURVE_OVER_TIME",
            };
            Entry::new(kind, joint, &[lower, upper])
        }
        _ => return None,
    })
}

/// Torques of the drives and forces of the sensor; what is neither gains nothing.
fn torque_entry(effect: &Effect) -> Entry {
    match *effect {
        Effect::Friction {
            joint,
            coulomb_nm,
            viscous_nm_s_per_rad,
            stribeck_nm,
            stribeck_rad_per_s,
            side,
        } => {
            let (kind, over) = match side {
                Turnover::Travel(over) => ("FRICTION_OF_TRAVEL", over),
                Turnover::Rate(over) => ("FRICTION_OF_RATE", over),
            };
            let sizes = [coulomb_nm, viscous_nm_s_per_rad, stribeck_nm];
            Entry::new(
                kind,
                joint,
                &[sizes[0], sizes[1], sizes[2], stribeck_rad_per_s, over],
            )
        }
        Effect::MotorCogging {
            joint,
            periods,
            cosine_nm,
            sine_nm,
        } => Entry::new("COGGING", joint, &[periods, cosine_nm, sine_nm]),
        Effect::Payload {
            mass_kg,
            gravity_mps2: [x, y, z],
        } => Entry::new("PAYLOAD", 0, &[mass_kg, x, y, z]),
        Effect::ForceBias { bias_n } => Entry::new("FORCE_BIAS", 0, &bias_n),
        Effect::ForceWarmBias {
            n_per_degc: [x, y, z],
            reference_degc,
        } => Entry::new("FORCE_WARM_BIAS", 0, &[x, y, z, reference_degc]),
        Effect::ForceGain { gain } => Entry::new("FORCE_GAIN", 0, &gain),
        Effect::ForceCrosstalk { parts } => Entry::new("FORCE_CROSSTALK", 0, &parts),
        Effect::ForceHysteresis {
            size_n: [x, y, z],
            transition_n,
        } => Entry::new("FORCE_HYSTERESIS", 0, &[x, y, z, transition_n]),
        Effect::TorqueGain { joint, gain } => Entry::new("TORQUE_GAIN", joint, &[gain]),
        _ => Entry::new("TORQUE_GAIN", 0, &[0.0]),
    }
}
