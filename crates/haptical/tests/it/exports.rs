//! Forms of an export against the device that they come from, at a hundred states, by another route than the one that wrote them.

use std::path::{Path, PathBuf};

use haptical::{Device, Export, Form, export};
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{Device as Model, Evaluation, RigidBodies};
use haptical_urdf::{BaseAndTip, device_from_mjcf, device_from_urdf};
use serde_json::Value;

pub(crate) const STATES: usize = 100;
/// Relative, of lengths of about a metre and of the largest torque.
const TOLERANCE: f64 = 1e-9;

/// A number between -0.5 and 0.5, without a generator.
fn part(row: usize, column: usize) -> f64 {
    (row as f64 * 2f64.sqrt() + (row * (column + 1)) as f64 * 0.618_033_988_749).fract() - 0.5
}

/// Two links with all that an identification of the dynamics writes.
pub(crate) const IDENTIFIED: &str = "\
[device]
name = \"identified\"
[[link]]
a_m = 0.0
alpha_rad = 0.3
d_m = 0.2
[[link]]
a_m = 0.4
alpha_rad = 1.1
d_m = 0.05
theta_offset_rad = 0.2
mass_kg = 2.0
centre_of_mass_m = [0.2, 0.02, 0.01]
inertia_kgm2 = [0.004, 0.03, 0.031, 0.0005, 0.0, 0.001]
[[link]]
a_m = 0.3
alpha_rad = 0.0
d_m = 0.0
mass_kg = 1.0
centre_of_mass_m = [0.15, 0.0, 0.03]
inertia_kgm2 = [0.002, 0.015, 0.016, 0.0, 0.0002, 0.0]
[[joint]]
home_rad = 0.4
armature_kgm2 = 0.2
torque_offset_nm = 0.16
torque_delay_s = 0.0021
[[joint]]
armature_kgm2 = 0.1
torque_limit_nm = 35.0
[gravity]
vector_mps2 = [0.1, -0.2, -9.81]
[[effect]]
name = \"joint-friction\"
joint = 1
coulomb_nm = 1.5
viscous_nm_s_per_rad = 0.8
stribeck_nm = 0.3
transition_rad_per_s = 0.02
";

/// Device files: of this test, of the fixtures, of shared/ where it is there.
fn devices() -> Vec<Device> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut paths: Vec<PathBuf> = ["haptic7.toml", "haptic7-deviating.toml"]
        .map(|name| root.join("fixtures/devices").join(name))
        .into();
    let of_runtime = ["general", "coupled", "identified", "parallelogram"];
    paths.extend(of_runtime.map(|name| {
        root.join("crates/runtime/tests/fixtures")
            .join(format!("{name}.toml"))
    }));
    let shared = root.join("../shared/cases/26-forward-ignores-torque-offset/identified.toml");
    match shared.exists() {
        true => paths.push(shared),
        false => println!("skipped: no {}", shared.display()),
    }
    let read = paths.iter().map(|path| Device::load(path).unwrap());
    let own = Device::from_toml(IDENTIFIED, "identified.toml").unwrap();
    std::iter::once(own).chain(read).collect()
}

pub(crate) fn exported(device: &Device, form: Form) -> String {
    export(device, &Export::new(form)).unwrap().text
}

/// Joint values within the limits, about home.
fn state(model: &Model, row: usize) -> Vec<f64> {
    let joints = model.joints.iter().enumerate();
    let values = joints.map(|(joint, own)| {
        let [lower, upper] = [own.lower_rad.max(-2.0), own.upper_rad.min(2.0)];
        0.5 * (lower + upper) + (upper - lower) * 0.9 * part(row, joint)
    });
    values.collect()
}

/// What a description's joint moves by when the device's does.
fn factors(model: &Model) -> Vec<f64> {
    let factor = |joint| model.drive(model.own_row(joint)?).map(|own| own.multiplier);
    (0..model.joints.len())
        .map(|joint| factor(joint).unwrap())
        .collect()
}

pub(crate) fn near(found: f64, wanted: f64, scale: f64, what: &str) {
    let gap = (found - wanted).abs();
    assert!(
        gap <= TOLERANCE * scale.max(1.0),
        "{what}: {found:?}, {wanted:?}"
    );
}

fn same_kinematics(source: &Model, again: &Model, what: &str) {
    let factors = factors(source);
    let (mut here, mut there) = (Evaluation::new(source), Evaluation::new(again));
    for row in 0..STATES {
        let outputs = state(source, row);
        let values: Vec<f64> = outputs.iter().zip(&factors).map(|(q, f)| q * f).collect();
        here.move_outputs(&outputs).unwrap();
        there.move_outputs(&values).unwrap();
        let (wanted, found) = (here.pose().unwrap(), there.pose().unwrap());
        for axis in 0..3 {
            near(found.position_m[axis], wanted.position_m[axis], 1.0, what);
            for column in 0..3 {
                let place = (axis, column);
                near(found.rotation[place], wanted.rotation[place], 1.0, what);
            }
        }
        for (joint, factor) in factors.iter().enumerate() {
            let (wanted, found) = (here.joint_twist(joint), there.joint_twist(joint));
            for axis in 0..3 {
                near(factor * found.linear[axis], wanted.linear[axis], 1.0, what);
                near(
                    factor * found.angular[axis],
                    wanted.angular[axis],
                    1.0,
                    what,
                );
            }
        }
    }
}

pub(crate) fn same_torques(source: &Model, again: &Model, what: &str) {
    let factors = factors(source);
    let (here, there) = (
        RigidBodies::of_device(source).unwrap(),
        RigidBodies::of_device(again).unwrap(),
    );
    let (mut work, mut work_there) = (here.work(), there.work());
    let (mut wanted, mut found) = (vec![0.0; factors.len()], vec![0.0; factors.len()]);
    for row in 0..STATES {
        let q = state(source, row);
        let wave = |shift: usize| -> Vec<f64> {
            (0..factors.len())
                .map(|joint| 4.0 * part(row, joint + shift))
                .collect()
        };
        let (dq, ddq) = (wave(20), wave(40));
        let scaled =
            |own: &[f64]| -> Vec<f64> { own.iter().zip(&factors).map(|(a, f)| a * f).collect() };
        here.torques(&q, &dq, &ddq, &mut work, &mut wanted).unwrap();
        there
            .torques(
                &scaled(&q),
                &scaled(&dq),
                &scaled(&ddq),
                &mut work_there,
                &mut found,
            )
            .unwrap();
        let largest = wanted.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
        for ((found, wanted), factor) in found.iter().zip(&wanted).zip(&factors) {
            near(factor * found, *wanted, largest, what);
        }
    }
}

/// Descriptions are read back: poses, Jacobians, and torques of the motion where the file gives masses and inertias.
#[test]
fn descriptions_have_the_poses_jacobians_and_torques_of_their_device() {
    let mut weighed = 0;
    for device in devices() {
        let source = &device.model;
        let ends = BaseAndTip::to("handle");
        let urdf = device_from_urdf(&exported(&device, Form::Urdf), "again.urdf", ends).unwrap();
        let mjcf = device_from_mjcf(&exported(&device, Form::Mjcf), "again.xml", ends).unwrap();
        for (mut again, form) in [(urdf.device, Form::Urdf), (mjcf.device, Form::Mjcf)] {
            let what = format!("{form:?} of {}", source.name);
            same_kinematics(source, &again, &what);
            if RigidBodies::of_device(source).is_err() {
                continue;
            }
            weighed += 1;
            // what nobody states is made up in an MJCF; what a URDF cannot hold is listed there
            let mut wanted = source.clone();
            if form == Form::Urdf {
                again.gravity_mps2 = source.gravity_mps2;
            }
            for (own, other) in wanted.joints.iter_mut().zip(&mut again.joints) {
                if form == Form::Urdf || own.armature_kgm2.is_none() {
                    (own.armature_kgm2, other.armature_kgm2) = (None, None);
                }
            }
            same_torques(&wanted, &again, &what);
        }
    }
    assert!(weighed >= 2, "{weighed}");
}

/// A device file is the device; the flat numbers are its chain, multiplied out here.
#[test]
fn a_device_file_and_flat_numbers_have_the_poses_of_their_device() {
    let mut compared = 0;
    for device in devices() {
        let again = Device::from_toml(&exported(&device, Form::Toml), "again.toml").unwrap();
        assert_eq!(again.model.links, device.model.links);
        assert_eq!(again.model.joints, device.model.joints);
        assert_eq!(again.model.bodies, device.model.bodies);
        assert_eq!(again.model.effects, device.model.effects);
        let flat: Value = serde_json::from_str(&exported(&device, Form::Json)).unwrap();
        let mut here = Evaluation::new(&device.model);
        for row in 0..STATES {
            let readings = state(&device.model, row);
            if here.move_to(&readings).is_err() {
                continue;
            }
            compared += 1;
            let outputs: Vec<f64> = (0..readings.len())
                .map(|joint| here.output_rad(joint))
                .collect();
            let (place, turn) = flat_pose(&flat, &outputs);
            let wanted = here.pose().unwrap();
            near(
                (place - wanted.position_m).norm(),
                0.0,
                1.0,
                &device.model.name,
            );
            near(
                (turn - wanted.rotation).norm(),
                0.0,
                1.0,
                &device.model.name,
            );
        }
    }
    assert!(compared > 4 * STATES, "{compared}");
}

/// Denavit-Hartenberg's matrices with the Hayati term and a slide along y, of flat numbers; source: the device file's conventions.
fn flat_pose(flat: &Value, outputs: &[f64]) -> (Vector3<f64>, Matrix3<f64>) {
    let number = |group: &str, key: &str, row: usize| flat[group][key][row].as_f64().unwrap();
    let about = |axis: usize, angle: f64| {
        let (s, c) = angle.sin_cos();
        match axis {
            0 => Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c),
            1 => Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c),
            _ => Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0),
        }
    };
    let (mut place, mut turn) = (Vector3::zeros(), Matrix3::identity());
    let origin =
        |at: &Value, rotation: &Value, place: &mut Vector3<f64>, turn: &mut Matrix3<f64>| {
            if at.is_null() {
                return;
            }
            let own = Vector3::from_fn(|axis, _| at[axis].as_f64().unwrap());
            *place += *turn * own;
            *turn *= Matrix3::from_fn(|row, column| rotation[row][column].as_f64().unwrap());
        };
    let is_standard = flat["convention"] == "standard";
    for row in 0..=flat["drives"]["type"].as_array().unwrap().len() {
        let rows = &flat["rows"];
        origin(
            &rows["origin_xyz_m"][row],
            &rows["origin_rotation"][row],
            &mut place,
            &mut turn,
        );
        let of = |key: &str| number("rows", key, row);
        let (mut theta, mut d) = (of("theta_offset_rad"), of("d_m"));
        if row > 0 {
            let joint = flat["drives"]["driven_by"][row - 1].as_u64().unwrap() as usize - 1;
            let value = number("joints", "home", joint) + outputs[joint];
            let value = number("drives", "multiplier", row - 1) * value
                + number("drives", "offset", row - 1);
            match flat["drives"]["type"][row - 1] == "prismatic" {
                true => d += value,
                false => theta += value,
            }
        }
        let across = Vector3::new(of("a_m"), of("b_m"), 0.0);
        if is_standard {
            turn *= about(2, theta);
            place += turn * (across + Vector3::z() * d);
            turn *= about(0, of("alpha_rad")) * about(1, of("beta_rad"));
        } else {
            place += turn * across;
            turn *= about(0, of("alpha_rad")) * about(1, of("beta_rad")) * about(2, theta);
            place += turn * (Vector3::z() * d);
        }
    }
    origin(
        &flat["handle_xyz_m"],
        &flat["handle_rotation"],
        &mut place,
        &mut turn,
    );
    (place, turn)
}
