//! The C header of `haptical export`, compiled and compared with the model.

use std::path::{Path, PathBuf};
use std::process::Command;

use haptical_model::kinematics::{Convention, joint_torques_nm, nalgebra::Vector3};
use haptical_model::{Device, Evaluation};

use crate::export::{export, fixture};
use crate::text;

/// Numbers are of the size of 1; both sides round some hundred times.
const TOLERANCE: f64 = 1e-12;

/// Reads readings and forces, prints each number of a step in its order.
const PROGRAM: &str = r#"
#include <stdio.h>
#include "model.h"

#define LIMITS_ALONE 12345.0 /* as a force: print what the limits say, and nothing else */

static void print(const double *numbers, int count)
{
    for (int i = 0; i < count; ++i) {
        printf("%.17g ", numbers[i]);
    }
}

/* The status, and what is left to the pose at the readings that are found for it from a posture beside it. */
static void print_pose_inverse(const double readings[HAPTICAL_JOINTS], const haptical_state *there)
{
    haptical_inputs near = {0};
    haptical_effect_state memory;
    haptical_pose wanted;
    haptical_found found;
    haptical_state again;
    double left = 0.0;
    int status, joint;
    haptical_reset_state(&memory);
    for (int joint = 0; joint < HAPTICAL_JOINTS; ++joint) {
        near.readings[joint] = 0.9 * readings[joint];
    }
    for (int i = 0; i < 3; ++i) {
        wanted.position_m[i] = there->position_m[i];
        for (int j = 0; j < 3; ++j) {
            wanted.rotation[i][j] = there->rotation[i][j];
        }
    }
    status = haptical_inverse_pose(&wanted, &near, &memory, &found);
    if (status == HAPTICAL_OK && haptical_step(found.readings, &again) == HAPTICAL_OK) {
        for (int i = 0; i < 3; ++i) {
            left = fmax(left, fabs(again.position_m[i] - wanted.position_m[i]));
            for (int j = 0; j < 3; ++j) {
                left = fmax(left, fabs(again.rotation[i][j] - wanted.rotation[i][j]));
            }
        }
    }
    if (status == HAPTICAL_OK && haptical_check_limits(found.readings, &joint) != HAPTICAL_OK) {
        left = 1.0;
    }
    printf("%d %.17g ", status, left);
}

int main(void)
{
    double readings[HAPTICAL_JOINTS], force_n[3];
    const double moment_nm[3] = {0.1, -0.2, 0.3};
    for (;;) {
        haptical_state state;
        double torques_nm[HAPTICAL_JOINTS];
        int status, joint;
        for (int i = 0; i < HAPTICAL_JOINTS; ++i) {
            if (scanf("%lf", &readings[i]) != 1) {
                return 0;
            }
        }
        for (int i = 0; i < 3; ++i) {
            if (scanf("%lf", &force_n[i]) != 1) {
                return 1;
            }
        }
        status = haptical_check_limits(readings, &joint);
        if (force_n[0] == LIMITS_ALONE) {
            printf("limits %d %d\n", status, joint);
            continue;
        }
        status = haptical_step(readings, &state);
        if (status != HAPTICAL_OK) {
            printf("refused %d %d\n", status, state.joint);
            continue;
        }
        status = haptical_torques(&state, force_n, moment_nm, state.output_slopes, torques_nm);
        if (status != HAPTICAL_OK) {
            printf("refused %d 0\n", status);
            continue;
        }
        print(state.outputs, HAPTICAL_JOINTS);
        print(state.output_slopes, HAPTICAL_JOINTS);
        print(state.position_m, 3);
        print(&state.rotation[0][0], 9);
        print(&state.jacobian_linear[0][0], 3 * HAPTICAL_JOINTS);
        print(&state.jacobian_angular[0][0], 3 * HAPTICAL_JOINTS);
        print(torques_nm, HAPTICAL_JOINTS);
        print_pose_inverse(readings, &state);
        printf("\n");
    }
}
"#;

/// What the model crate says of the same, in the same order; nothing where it refuses.
fn expected(device: &Device, readings: &[f64], force_n: [f64; 3]) -> Option<Vec<f64>> {
    let joints = 0..readings.len();
    let mut evaluation = Evaluation::new(device);
    evaluation.move_to(readings).ok()?;
    let pose = evaluation.pose().unwrap();
    let mut numbers: Vec<f64> = joints.clone().map(|j| evaluation.output_rad(j)).collect();
    numbers.extend(joints.clone().map(|j| evaluation.output_slope(j)));
    numbers.extend(pose.position_m.iter());
    numbers.extend(pose.rotation.transpose().iter());
    let twists: Vec<_> = joints.clone().map(|j| evaluation.joint_twist(j)).collect();
    numbers.extend(twists.iter().flat_map(|twist| twist.linear.iter().copied()));
    numbers.extend(
        twists
            .iter()
            .flat_map(|twist| twist.angular.iter().copied()),
    );
    let twists: Vec<_> = joints.map(|j| evaluation.reading_twist(j)).collect();
    let mut torques_nm = vec![0.0; readings.len()];
    let moment_nm = Vector3::new(0.1, -0.2, 0.3);
    joint_torques_nm(
        &twists,
        &Vector3::from(force_n),
        &moment_nm,
        &mut torques_nm,
    )
    .unwrap();
    numbers.extend(torques_nm);
    Some(numbers)
}

/// Compiles the header of a device; nothing, and a message, where there is no compiler.
fn compiled(device: &Path, folder: &Path) -> Option<PathBuf> {
    if Command::new("gcc").arg("--version").output().is_err() {
        println!("skipped: there is no gcc to compile the header with");
        return None;
    }
    let output = export(device, "c-header", &folder.join("model.h"), &[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    std::fs::write(folder.join("program.c"), PROGRAM).unwrap();
    let built = Command::new("gcc")
        .current_dir(folder)
        .args([
            "-std=c99",
            "-Wall",
            "-Wextra",
            "-Wpedantic",
            "-Werror",
            "-O2",
        ])
        .args(["program.c", "-o", "program", "-lm"])
        .output()
        .unwrap();
    assert!(built.status.success(), "{}", text(&built.stderr));
    Some(folder.join("program"))
}

/// What the program prints for lines of readings and forces.
fn printed(program: &Path, input: &str) -> Vec<String> {
    let run = assert_cmd::Command::new(program)
        .write_stdin(input.to_owned())
        .output()
        .unwrap();
    assert!(run.status.success());
    text(&run.stdout).lines().map(str::to_owned).collect()
}

/// Compares the compiled header with the model on readings that cover the limits.
fn header_agrees(path: &Path) {
    let device = Device::load(path).unwrap().device;
    let folder = tempfile::tempdir().unwrap();
    let Some(program) = compiled(path, folder.path()) else {
        return;
    };
    let count = device.joints.len();
    // an irrational step per joint covers the ranges evenly, without a generator
    let part = |row: usize, column: usize| {
        (row as f64 * 2f64.sqrt() + (row * (column + 1)) as f64 * 0.618_033_988_749).fract() - 0.5
    };
    let cases: Vec<(Vec<f64>, [f64; 3])> = (0..500)
        .map(|row| {
            let readings = (0..count).map(|joint| 1.3 * part(row, joint)).collect();
            (readings, [7, 8, 9].map(|column| 20.0 * part(row, column)))
        })
        .collect();
    let input: String = cases
        .iter()
        .map(|(readings, force_n)| {
            let numbers = readings.iter().chain(force_n);
            numbers
                .map(|number| format!("{number:?} "))
                .collect::<String>()
                + "\n"
        })
        .collect();
    let lines = printed(&program, &input);
    assert_eq!(lines.len(), cases.len());
    let (mut reached, mut beyond) = (0, 0);
    for ((readings, force_n), line) in cases.iter().zip(&lines) {
        let expected = expected(&device, readings, *force_n).unwrap();
        let found: Vec<f64> = line
            .split_whitespace()
            .map(|word| word.parse().unwrap())
            .collect();
        assert_eq!(found.len(), expected.len() + 2, "{line}");
        let [.., status, left] = found[..] else {
            panic!("{line}");
        };
        assert!(left < 1e-10, "{left} is left of the pose at {readings:?}");
        reached += usize::from(status == 0.0);
        beyond += usize::from(status == 5.0);
        for (index, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let is_near = (found - expected).abs() <= TOLERANCE * expected.abs().max(1.0);
            assert!(
                is_near,
                "number {index} at {readings:?}: {found} in C, {expected} in Rust"
            );
        }
    }
    // of readings that are beyond the device's limits the pose is refused
    println!(
        "{}: {reached} of {} poses given back, {beyond} beyond the limits",
        path.display(),
        cases.len()
    );
    let sought = cases.len() - beyond;
    assert!(
        sought > 50 && reached * 10 > sought * 8,
        "{reached} of {sought}"
    );
}

#[test]
fn the_header_gives_the_same_numbers() {
    for name in ["identified.toml", "parallelogram.toml"] {
        let Some(path) = fixture(name) else { return };
        header_agrees(&path);
    }
}

/// Craig's convention, a prismatic joint with a cable, a tilt, a polynomial: what the 7-DOF device lacks.
const OTHER_DEVICE: &str = r#"
[device]
name = "other"
convention = "modified"
[[link]]
a_m = 0.1
alpha_rad = 0.3
d_m = 0.2
theta_offset_rad = -0.4
beta_rad = 0.05
[[link]]
a_m = -0.2
alpha_rad = 1.2
d_m = 0.1
theta_offset_rad = 0.7
[[link]]
a_m = 0.3
alpha_rad = -0.6
d_m = 0.4
beta_rad = -0.02
[[link]]
a_m = 0.05
alpha_rad = 2.1
d_m = -0.1
[[joint]]
home_rad = 0.5
transmission = "parallelogram"
transmission_ratio = -12
drum_distance_m = 0.09
input_drum_denominator_m = 0.0026
parallelogram_lengths_m = [0.18, 0.076, 0.18, 0.076]
[joint.transmission_error]
offset_rad = 0.01
ratio_deviation = 0.3
output_drum_xy_m = [0.001, -0.002]
input_drum_xy_m = [0.0002, 0.0001]
length_deviations_m = [0.001, -0.002, 0.0005, 0.0003]
[[joint]]
type = "prismatic"
home_m = 0.25
transmission = "capstan"
transmission_ratio = 9
drum_distance_m = 0.05
[joint.transmission_error]
offset_m = 0.002
ratio_deviation = -0.2
output_drum_xy_m = [-0.0003, 0.0004]
input_drum_xy_m = [0.00002, -0.00001]
[[joint]]
home_rad = -0.8
[joint.transmission_error]
range_rad = [-0.9, 1.1]
chebyshev = [0.01, -0.02, 0.005, 0.001, -0.0007]
"#;

#[test]
fn the_header_of_another_kind_of_device_gives_the_same_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.toml");
    std::fs::write(&path, OTHER_DEVICE).unwrap();
    header_agrees(&path);
}

/// Origins, slides along y, a handle, and rows that follow: in both conventions.
#[test]
fn the_header_of_general_rows_gives_the_same_numbers() {
    let folder = tempfile::tempdir().unwrap();
    for (name, rows) in [("arm.urdf", 6), ("linkage.urdf", 5)] {
        let Some(urdf) = crate::urdf::fixture(name) else {
            return;
        };
        let urdf = std::fs::read_to_string(urdf).unwrap();
        let mut device =
            haptical_urdf::device_from_urdf(&urdf, name, haptical_urdf::BaseAndTip::default())
                .unwrap()
                .device;
        assert_eq!(device.links.len(), rows + 1);
        for (index, id) in device.link_parameters(false).into_iter().enumerate() {
            id.set(&mut device, 0.03 * (index as f64).sin());
        }
        device.joints[0].home_rad = 0.4;
        for convention in [Convention::Standard, Convention::Modified] {
            device.convention = convention;
            let path = folder.path().join("general.toml");
            std::fs::write(&path, device.to_new_toml().unwrap()).unwrap();
            header_agrees(&path);
        }
    }
}

#[test]
fn the_header_refuses_what_the_runtime_refuses() {
    let Some(path) = fixture("parallelogram.toml") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let Some(program) = compiled(&path, folder.path()) else {
        return;
    };
    let input = "nan 0 0 0 0 0 0 1 1 1\n0 0 0 0 0 -inf 0 1 1 1\n0 200000 0 0 0 0 0 1 1 1\n\
                 0 0 0 1.7 0 0 0 1 1 1\n0 0 0 0 0 0 0 nan 1 1\n0 0 0 0 0 0 0 1.7e308 1.7e308 1.7e308\n";
    let expected = [
        "refused 1 1",
        "refused 1 6",
        "refused 2 2",
        "refused 3 4",
        "refused 1 0",
    ];
    let lines = printed(&program, input);
    assert_eq!(lines[..5], expected);
    assert!(
        !lines[5].contains("inf") && !lines[5].contains("nan"),
        "{}",
        lines[5]
    );
}

#[test]
fn the_header_knows_the_joint_limits_of_the_file() {
    let Some(path) = fixture("identified.toml") else {
        return;
    };
    let device = Device::load(&path).unwrap().device;
    let folder = tempfile::tempdir().unwrap();
    let Some(program) = compiled(&path, folder.path()) else {
        return;
    };
    let (lower, upper) = (device.joints[2].lower_rad, device.joints[2].upper_rad);
    let lines: Vec<String> = [lower, upper, lower.next_down(), upper.next_up(), f64::NAN]
        .iter()
        .map(|reading| format!("0 0 {reading:?} 0 0 0 0 12345 0 0\n"))
        .collect();
    let expected = [
        "limits 0 0",
        "limits 0 0",
        "limits 5 3",
        "limits 5 3",
        "limits 1 3",
    ];
    assert_eq!(
        printed(&program, &lines.concat().replace("NaN", "nan")),
        expected
    );
    // and a device without limits has none
    let path = folder.path().join("other.toml");
    std::fs::write(&path, OTHER_DEVICE).unwrap();
    let program = compiled(&path, folder.path()).unwrap();
    assert_eq!(
        printed(&program, "1e300 -1e300 1 12345 0 0\n"),
        ["limits 0 0"]
    );
}
