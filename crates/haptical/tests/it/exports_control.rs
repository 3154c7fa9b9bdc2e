//! The C that is exported of a corrected device, against what a replay of its device file predicts.

use std::fmt::Write as _;
use std::process::Command;

use haptical::data::Cells;
use haptical::{Device, Form, Log, replay};

use crate::exports::{IDENTIFIED, STATES, exported, near};

/// Prints outputs and place of the handle for lines of readings, torques and a time.
const PROGRAM: &str = r#"
#include <stdio.h>
#include "model.h"
int main(void)
{
    haptical_effect_state state;
    haptical_reset_state(&state);
    for (;;) {
        haptical_inputs inputs = {0};
        haptical_compensated device;
        for (int joint = 0; joint < 2 * HAPTICAL_JOINTS; ++joint) {
            double *to = joint < HAPTICAL_JOINTS ? &inputs.readings[joint] : &inputs.torque_nm[joint - HAPTICAL_JOINTS];
            if (scanf("%lf", to) != 1) {
                return 0;
            }
        }
        if (scanf("%lf", &inputs.time_s) != 1 || haptical_forward(&inputs, &state, &device) != HAPTICAL_OK) {
            return 1;
        }
        for (int joint = 0; joint < HAPTICAL_JOINTS; ++joint) {
            printf("%.17g ", device.state.outputs[joint]);
        }
        printf("%.17g %.17g %.17g\n", device.state.position_m[0], device.state.position_m[1], device.state.position_m[2]);
    }
}
"#;

/// Effects that a corrected.toml may hold, each of which moves an output or the handle.
const EFFECTS: [&str; 8] = [
    "name = \"backlash\"\njoint = 1\nwidth_rad = 0.004\n",
    "name = \"capstan-compliance\"\njoint = 2\nstiffness_nm_per_rad = 260.0\n",
    "name = \"joint-compliance\"\njoint = 1\nstiffness_nm_per_rad = 410.0\n",
    "name = \"drum-out-of-round\"\njoint = 2\namplitude_rad = 0.002\nphase_rad = 0.7\n",
    "name = \"input-drum-harmonic\"\njoint = 1\namplitude_rad = 0.001\nphase_rad = -0.4\norder = 2\n",
    "name = \"cross-coupling\"\njoint = 2\nfrom_joint = 1\ngain = 0.01\n",
    "name = \"coupled-backlash\"\njoint = 2\nfrom_joint = 1\nwidth_rad = 0.002\nplay_rad = 0.1\n",
    "name = \"cable-pitch\"\njoint = 1\nquadratic_per_rad = 0.003\ncubic_per_rad2 = -0.001\n",
];

/// What the C of a device prints for a motion; nothing, and a message, where there is no compiler.
fn printed(device: &Device, input: &str) -> Option<Vec<Vec<f64>>> {
    if Command::new("gcc").arg("--version").output().is_err() {
        println!("skipped: there is no gcc to compile the header with");
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("model.h"),
        exported(device, Form::CHeader),
    )
    .unwrap();
    std::fs::write(folder.path().join("program.c"), PROGRAM).unwrap();
    std::fs::write(folder.path().join("input"), input).unwrap();
    let built = Command::new("gcc")
        .current_dir(folder.path())
        .args([
            "-std=c99",
            "-Wall",
            "-Werror",
            "-O1",
            "program.c",
            "-o",
            "program",
            "-lm",
        ])
        .output()
        .unwrap();
    assert!(
        built.status.success(),
        "{}",
        String::from_utf8_lossy(&built.stderr)
    );
    let stdin = std::fs::File::open(folder.path().join("input")).unwrap();
    let run = Command::new(folder.path().join("program"))
        .stdin(stdin)
        .output()
        .unwrap();
    assert!(run.status.success());
    let text = String::from_utf8(run.stdout).unwrap();
    let numbers = |line: &str| {
        line.split_whitespace()
            .map(|own| own.parse().unwrap())
            .collect()
    };
    Some(text.lines().map(numbers).collect())
}

/// The C that is exported against what a replay of the same device file predicts: effects of a control loop are those of a log.
#[test]
fn the_header_of_a_corrected_device_is_what_its_replay_predicts() {
    // without masses springs carry the torques of the log, as the loop is given them
    let file = IDENTIFIED.split("[[effect]]").next().unwrap();
    let is_of_body = |line: &&str| {
        ["mass_", "centre_", "inertia_"]
            .iter()
            .any(|own| line.starts_with(own))
    };
    let base: String = file
        .lines()
        .filter(|line| !is_of_body(line))
        .map(|line| format!("{line}\n"))
        .collect();
    let base = base.replace(
        "[[joint]]\n",
        "[[joint]]\ntransmission = \"capstan\"\ntransmission_ratio = 8.0\ndrum_distance_m = 0.0675\n\
         external_encoder_counts_per_rev = 20000\n",
    );
    let base = format!("{base}\n[tracker]\nbase = \"known\"\ntool = \"known\"\n");
    let with = |effects: &[&str]| {
        let effects: String = effects
            .iter()
            .map(|own| format!("\n[[effect]]\n{own}"))
            .collect();
        Device::from_toml(&format!("{base}{effects}"), "corrected.toml").unwrap()
    };
    let without = |name: &str| -> Vec<&str> {
        let kept = EFFECTS.iter().filter(|own| !own.contains(name));
        kept.copied().collect()
    };
    // postures apart; and a motion, which a play of another joint needs and in which a replay smooths what loads springs
    let apart = without("coupled-backlash");
    let mut cases: Vec<(f64, Vec<&str>)> = apart.iter().map(|own| (0.02, vec![*own])).collect();
    cases.push((0.02, apart));
    cases.push((0.005, without("capstan-compliance")));
    for (step_s, effects) in cases {
        let columns = motion(step_s);
        let input = lines(&columns);
        let cells: Vec<_> = columns
            .iter()
            .map(|(name, values)| (name.as_str(), Cells::Numbers(values)))
            .collect();
        let (plain, device) = (with(&[]), with(&effects));
        let (Some(plain), Some(found)) = (printed(&plain, &input), printed(&device, &input)) else {
            return;
        };
        let log = Log::from_columns(&cells, "log.csv", &device).unwrap();
        let predicted = replay(&device, &log).unwrap().predicted;
        assert_eq!(found.len(), STATES);
        let places = predicted.position_m.as_ref().unwrap();
        let mut moved = 0.0_f64;
        for (row, numbers) in found.iter().enumerate() {
            let what = format!("{effects:?}, row {row}");
            let outputs = predicted
                .output
                .iter()
                .map(|own| own.as_ref().unwrap()[row]);
            let wanted: Vec<f64> = outputs.chain(places.iter().map(|own| own[row])).collect();
            assert_eq!(numbers.len(), wanted.len());
            for (number, (found, wanted)) in numbers.iter().zip(wanted).enumerate() {
                // a replay adds what each effect does alone (A154): two errors of 5 mrad together move the handle by less than 0.1 mm
                match number < 2 || effects.len() == 1 {
                    true => near(*found, wanted, 1.0, &what),
                    false => assert!((found - wanted).abs() < 1e-4, "{what}: {found} {wanted}"),
                }
            }
            let moves = numbers
                .iter()
                .zip(&plain[row])
                .map(|(own, other)| (own - other).abs());
            moved = moves.fold(moved, f64::max);
        }
        assert!(moved > 1e-4, "{effects:?} does nothing");
    }
}

/// A motion with reversals, at two joints, with torques.
fn motion(step_s: f64) -> Vec<(String, Vec<f64>)> {
    let times: Vec<f64> = (0..STATES).map(|row| step_s * row as f64).collect();
    let of = |name: &str, f: &dyn Fn(f64) -> f64| {
        (
            name.to_owned(),
            times.iter().map(|t| f(*t)).collect::<Vec<f64>>(),
        )
    };
    let mut columns = vec![
        of("t_s", &|t| t),
        of("theta1_rad", &|t| 0.4 * (5.0 * t).sin() + 0.1 * t),
        of("theta2_rad", &|t| 0.3 * (7.0 * t + 0.5).cos()),
        of("torque1_nm", &|t| 2.0 * (3.0 * t).cos() + 0.5),
        of("torque2_nm", &|t| 1.5 * (4.0 * t + 0.2).sin()),
    ];
    let unread = ["out1_rad", "out2_rad", "x_m", "y_m", "z_m"];
    columns.extend(unread.map(|name| of(name, &|_| 0.0)));
    columns
}

/// Readings, torques and the time, row by row.
fn lines(columns: &[(String, Vec<f64>)]) -> String {
    let mut input = String::new();
    for row in 0..STATES {
        for column in [1, 2, 3, 4, 0] {
            write!(input, "{:?} ", columns[column].1[row]).unwrap();
        }
        input.push('\n');
    }
    input
}
