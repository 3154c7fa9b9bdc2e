//! Modules and the header that `haptical export` wrote of devices with effects: against the device file, and C against Rust.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use haptical_runtime::{CompensatedModel, CompensatedState, Effect, Inputs};

use crate::devices::fixture;
use crate::effect_lists::{compensated, runtime_effects};

/// Three effects at three joints of the 7-DOF device.
#[allow(dead_code, reason = "not all of a module is used here")]
pub(crate) mod effects {
    include!("../fixtures/effects.rs");
}
/// A slide between two turning joints, with an effect of every kind.
#[allow(dead_code, reason = "not all of a module is used here")]
pub(crate) mod every_effect {
    include!("../fixtures/every_effect.rs");
}
/// An axis that wobbles behind one that is parallel to it.
#[allow(dead_code, reason = "not all of a module is used here")]
pub(crate) mod parallel_axes {
    include!("../fixtures/parallel_axes.rs");
}

/// Numbers are of the size of 1; both sides round some hundred times.
const TOLERANCE: f64 = 1e-12;

/// One instant of a motion with reversals, all inputs in use.
pub(crate) fn inputs<const JOINTS: usize>(row: usize) -> Inputs<JOINTS> {
    let t = 0.02 * row as f64;
    let wave =
        |pace: f64, phase: f64| (pace * t + phase).sin() + 0.4 * (2.3 * pace * t - phase).cos();
    let of_joints = |pace: f64, size: f64| {
        std::array::from_fn(|joint| size * wave(pace + 0.4 * joint as f64, 0.9 * joint as f64))
    };
    let of_axes = |pace: f64, size: f64| {
        std::array::from_fn(|axis| size * wave(pace + 0.3 * axis as f64, 1.0))
    };
    Inputs {
        readings: of_joints(1.3, 0.4),
        torque_nm: of_joints(0.7, 1.5),
        velocity: of_joints(1.1, 0.6),
        acceleration: of_joints(1.7, 2.0),
        force_n: of_axes(0.8, 3.0),
        handle_acceleration_mps2: of_axes(1.9, 1.0),
        time_s: t,
        temperature_degc: 20.0 + 2.0 * wave(0.3, 0.0),
    }
}

fn near(ours: f64, theirs: f64, what: &str) -> f64 {
    let gap = (ours - theirs).abs();
    assert!(
        gap <= TOLERANCE * theirs.abs().max(1.0),
        "{what}: {ours:?}, {theirs:?}"
    );
    gap
}

/// All numbers of a state, and of the torques for a force and a moment.
fn numbers<const JOINTS: usize>(device: &CompensatedState<JOINTS>) -> Vec<f64> {
    let state = &device.state;
    let mut numbers: Vec<f64> = state.outputs.to_vec();
    numbers.extend(state.output_slopes);
    numbers.extend(device.links);
    numbers.extend(state.pose.position_m.iter());
    numbers.extend(state.pose.rotation.transpose().iter());
    numbers.extend(
        state
            .jacobian
            .iter()
            .flat_map(|twist| twist.linear.iter().copied()),
    );
    numbers.extend(
        state
            .jacobian
            .iter()
            .flat_map(|twist| twist.angular.iter().copied()),
    );
    numbers.extend(device.hand_force_n);
    numbers.extend(
        device
            .drive_torques_nm([1.0, -2.0, 3.0], [0.1, -0.2, 0.3])
            .unwrap(),
    );
    numbers
}

#[test]
fn the_exported_effects_are_those_of_the_file() {
    let device = fixture("every_effect.toml");
    // the cable's is left out
    let mut known = device.clone();
    known
        .effects
        .retain(|effect| effect.name != "cable-scale" && effect.name != "force-bias");
    assert_eq!(known.effects.len() + 2, device.effects.len());
    let expected = runtime_effects(&known);
    let biases = |effect: &Effect| {
        matches!(
            effect,
            Effect::ForceBias { .. } | Effect::ForceWarmBias { .. }
        )
    };
    let exported: Vec<Effect> = every_effect::COMPENSATED.effects().to_vec();
    assert_eq!(exported.iter().filter(|effect| biases(effect)).count(), 2);
    let exported: Vec<Effect> = exported
        .into_iter()
        .filter(|effect| !biases(effect))
        .collect();
    assert_eq!(exported.len(), expected.len());
    for (exported, expected) in exported.iter().zip(&expected) {
        // conversions round: compared as they are written, number by number
        let words = |effect: &Effect| -> Vec<String> {
            let text = format!("{effect:?}");
            text.split([' ', ',', '[', ']', '{', '}', '(', ')'])
                .map(str::to_owned)
                .collect()
        };
        for (one, other) in words(exported).iter().zip(&words(expected)) {
            match (one.parse::<f64>(), other.parse::<f64>()) {
                (Ok(one), Ok(other)) => {
                    assert!((one - other).abs() <= 1e-15, "{exported:?}, {expected:?}");
                }
                _ => assert_eq!(one, other),
            }
        }
    }
    let there = compensated::<7>(&fixture("effects.toml"));
    let (mut state, mut state_there) = (effects::COMPENSATED.start(), there.start());
    for row in 0..200 {
        let inputs = Inputs {
            readings: inputs::<7>(row).readings.map(|reading| 0.8 * reading),
            ..inputs(row)
        };
        let here = effects::COMPENSATED.forward(&inputs, &mut state).unwrap();
        let there = there.forward(&inputs, &mut state_there).unwrap();
        for (here, there) in numbers(&here).into_iter().zip(numbers(&there)) {
            near(here, there, "7-DOF device");
        }
    }
}

/// Prints each number of a step in the order of [`numbers`], then the readings that give the outputs.
const PROGRAM: &str = r#"
#include <stdio.h>
#include "HEADER"

static void print(const double *numbers, int count)
{
    for (int i = 0; i < count; ++i) {
        printf("%.17g ", numbers[i]);
    }
}

static int scan(double *numbers, int count)
{
    for (int i = 0; i < count; ++i) {
        if (scanf("%lf", &numbers[i]) != 1) {
            return 0;
        }
    }
    return 1;
}

/* The status, the readings, and what is left to the pose at them: from a posture beside it. */
static void print_pose_inverse(const haptical_state *there, const haptical_inputs *inputs,
                               const haptical_effect_state *before)
{
    haptical_inputs near = *inputs;
    haptical_effect_state state = *before;
    haptical_pose wanted;
    haptical_found found;
    haptical_compensated again;
    double left = 0.0;
    int status;
    for (int i = 0; i < 3; ++i) {
        wanted.position_m[i] = there->position_m[i];
        for (int j = 0; j < 3; ++j) {
            wanted.rotation[i][j] = there->rotation[i][j];
        }
    }
    for (int joint = 0; joint < HAPTICAL_JOINTS; ++joint) {
        near.readings[joint] -= 0.05;
    }
    status = haptical_inverse_pose(&wanted, &near, before, &found);
    printf("%d ", status);
    if (status != HAPTICAL_OK) {
        return;
    }
    print(found.readings, HAPTICAL_JOINTS);
    for (int joint = 0; joint < HAPTICAL_JOINTS; ++joint) {
        near.readings[joint] = found.readings[joint];
    }
    if (haptical_forward(&near, &state, &again) != HAPTICAL_OK) {
        left = 1.0;
    }
    for (int i = 0; i < 3; ++i) {
        left = fmax(left, fabs(again.state.position_m[i] - wanted.position_m[i]));
        for (int j = 0; j < 3; ++j) {
            left = fmax(left, fabs(again.state.rotation[i][j] - wanted.rotation[i][j]));
        }
    }
    for (int joint = 0; joint < HAPTICAL_JOINTS; ++joint) {
        left = fmax(left, fabs(again.state.outputs[joint] - found.outputs[joint]));
    }
    print(&left, 1);
}

int main(void)
{
    const double force_n[3] = {1.0, -2.0, 3.0}, moment_nm[3] = {0.1, -0.2, 0.3};
    haptical_effect_state state;
    haptical_inputs inputs;
    haptical_reset_state(&state);
    while (scan(inputs.readings, HAPTICAL_JOINTS) && scan(inputs.torque_nm, HAPTICAL_JOINTS)
           && scan(inputs.velocity, HAPTICAL_JOINTS) && scan(inputs.acceleration, HAPTICAL_JOINTS)
           && scan(inputs.force_n, 3) && scan(inputs.handle_acceleration_mps2, 3) && scan(&inputs.time_s, 1)
           && scan(&inputs.temperature_degc, 1)) {
        const haptical_effect_state before = state;
        haptical_compensated device;
        double torques_nm[HAPTICAL_JOINTS], readings[HAPTICAL_JOINTS];
        int joint;
        int status = haptical_forward(&inputs, &state, &device);
        if (status != HAPTICAL_OK) {
            printf("refused %d %d\n", status, device.state.joint);
            continue;
        }
        if (haptical_drive_torques(&device, force_n, moment_nm, torques_nm) != HAPTICAL_OK) {
            return 1;
        }
        print(device.state.outputs, HAPTICAL_JOINTS);
        print(device.state.output_slopes, HAPTICAL_JOINTS);
        print(device.links, HAPTICAL_JOINTS);
        print(device.state.position_m, 3);
        print(&device.state.rotation[0][0], 9);
        print(&device.state.jacobian_linear[0][0], 3 * HAPTICAL_JOINTS);
        print(&device.state.jacobian_angular[0][0], 3 * HAPTICAL_JOINTS);
        print(device.hand_force_n, 3);
        print(torques_nm, HAPTICAL_JOINTS);
        status = haptical_inverse(device.state.outputs, &inputs, &before, readings, &joint);
        printf("%d ", status);
        print(readings, HAPTICAL_JOINTS);
        print_pose_inverse(&device.state, &inputs, &before);
        printf("\n");
    }
    return 0;
}
"#;

/// Lines of the compiled program; nothing, and a message, where there is no compiler.
fn printed(header: &str, flags: &[&str], input: &str) -> Option<Vec<String>> {
    if Command::new("gcc").arg("--version").output().is_err() {
        println!("skipped: there is no gcc to compile the header with");
        return None;
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{header}{}", flags.len()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("program.c"), PROGRAM.replace("HEADER", header)).unwrap();
    let built = Command::new("gcc")
        .current_dir(&folder)
        .args([
            "-std=c99",
            "-Wall",
            "-Wextra",
            "-Wpedantic",
            "-Werror",
            "-I",
        ])
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures"))
        .args(flags)
        .args(["program.c", "-o", "program", "-lm"])
        .output()
        .unwrap();
    assert!(
        built.status.success(),
        "{}",
        String::from_utf8_lossy(&built.stderr)
    );
    let mut run = Command::new(folder.join("program"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = run.stdin.take().unwrap();
    let input = input.to_owned();
    let writer = std::thread::spawn(move || stdin.write_all(input.as_bytes()).unwrap());
    let output = run.wait_with_output().unwrap();
    writer.join().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.is_empty(), "{said}");
    let text = String::from_utf8(output.stdout).unwrap();
    Some(text.lines().map(str::to_owned).collect())
}

fn line(inputs: &Inputs<3>) -> String {
    let mut text = String::new();
    let lists: [&[f64]; 6] = [
        &inputs.readings,
        &inputs.torque_nm,
        &inputs.velocity,
        &inputs.acceleration,
        &inputs.force_n,
        &inputs.handle_acceleration_mps2,
    ];
    let numbers = lists
        .into_iter()
        .flatten()
        .chain([&inputs.time_s, &inputs.temperature_degc]);
    for number in numbers {
        write!(text, "{number:?} ").unwrap();
    }
    text.replace("NaN", "nan") + "\n"
}

#[test]
fn the_header_with_effects_gives_the_same_numbers() {
    let checked = [
        "-g",
        "-fsanitize=address,undefined",
        "-fno-sanitize-recover=all",
    ];
    let (every, parallel) = (&every_effect::COMPENSATED, &parallel_axes::COMPENSATED);
    assert_same_numbers("every_effect.h", every, &["-O2"]);
    assert_same_numbers("every_effect.h", every, &checked);
    assert_same_numbers("parallel_axes.h", parallel, &checked);
}

/// A header, compiled with some flags, against the module of the same device.
fn assert_same_numbers<const EFFECTS: usize>(
    header: &str,
    model: &CompensatedModel<3, 3, EFFECTS>,
    flags: &[&str],
) {
    const ROWS: usize = 600;
    let input: String = (0..ROWS).map(|row| line(&inputs(row))).collect();
    let Some(lines) = printed(header, flags, &input) else {
        return;
    };
    assert_eq!(lines.len(), ROWS);
    let mut state = model.start();
    let mut largest = 0.0_f64;
    let (mut inverted, mut posed) = (0, 0);
    for (row, line) in lines.iter().enumerate() {
        let inputs = inputs::<3>(row);
        let before = state;
        let here = model.forward(&inputs, &mut state).unwrap();
        let found: Vec<f64> = line
            .split_whitespace()
            .map(|word| word.parse().unwrap())
            .collect();
        let expected = numbers(&here);
        assert!(found.len() >= expected.len() + 5, "{line}");
        for (index, (found, expected)) in found.iter().zip(&expected).enumerate() {
            largest = largest.max(near(
                *found,
                *expected,
                &format!("row {row}, number {index}"),
            ));
        }
        // a play that a hand drives jumps: it has values that no reading gives, here as there
        let there = &found[expected.len()..];
        match model.inverse(&here.state.outputs, &inputs, &before) {
            Ok(readings) => {
                assert_eq!(there[0], 0.0, "row {row}");
                for (found, expected) in there[1..4].iter().zip(readings) {
                    assert!(
                        (found - expected).abs() < 1e-9,
                        "row {row}: {found} {expected}"
                    );
                }
                inverted += 1;
            }
            Err(_) => assert_eq!(there[0], 8.0, "row {row}"),
        }
        let beside = Inputs {
            readings: inputs.readings.map(|reading| reading - 0.05),
            ..inputs
        };
        match model.inverse_pose(&here.state.pose, &beside, &before) {
            Ok(readings) => {
                assert_eq!(there[4], 0.0, "row {row}");
                for (found, expected) in there[5..8].iter().zip(readings) {
                    assert!(
                        (found - expected).abs() < 1e-9,
                        "row {row}: {found} {expected}"
                    );
                }
                assert!(there[8] < 1e-10, "row {row}: {} is left", there[8]);
                posed += 1;
            }
            Err(_) => assert_eq!(there[4], 8.0, "row {row}"),
        }
    }
    println!(
        "largest difference of C and Rust: {largest:e}, {inverted} of {ROWS} rows inverted, {posed} poses"
    );
    assert!(inverted > ROWS * 9 / 10, "{inverted}");
    assert!(posed > ROWS * 8 / 10, "{posed}");
}

#[test]
fn the_header_with_effects_refuses_what_the_runtime_refuses() {
    let base = Inputs::<3>::at([0.1, 0.05, 0.2]);
    let cases = [
        (Inputs::at([f64::NAN, 0.0, 0.0]), "refused 1 1"),
        (Inputs::at([0.0, 2e6, 0.0]), "refused 2 2"),
        (
            Inputs {
                time_s: f64::NAN,
                ..base
            },
            "refused 6 0",
        ),
        (
            Inputs {
                torque_nm: [0.0, f64::INFINITY, 0.0],
                ..base
            },
            "refused 6 0",
        ),
        (
            Inputs {
                torque_nm: [1e12, 0.0, 0.0],
                ..base
            },
            "refused 4 1",
        ),
        (
            Inputs {
                force_n: [1e12, 0.0, 0.0],
                ..base
            },
            "refused 7 0",
        ),
    ];
    let input: String = cases.iter().map(|(inputs, _)| line(inputs)).collect();
    let Some(lines) = printed("every_effect.h", &["-O2", "-g"], &input) else {
        return;
    };
    for ((inputs, expected), line) in cases.iter().zip(&lines) {
        assert_eq!(line, expected);
        let model = &every_effect::COMPENSATED;
        let mut state = model.start();
        assert!(model.forward(inputs, &mut state).is_err(), "{expected}");
        assert_eq!(state, model.start(), "a refused step remembers nothing");
    }
}
