//! Two devices, and a smooth recording of each that has every column an effect can need.

use std::fmt::Write;

use haptical_calibration::{Channel, channels};
use haptical_model::kinematics::nalgebra::{Matrix3, Rotation3, UnitQuaternion};
use haptical_model::{Device, Evaluation, Recording};

use crate::Effect;
use crate::{Context, Line, streams};

/// An effect of the registry.
pub(super) type AnyEffect = dyn Effect + 'static;

/// Rows of each of the two runs.
pub(super) const RUN: usize = 360;
/// Sampling interval \[s\].
pub(super) const STEP_S: f64 = 0.01;
/// When the second run starts \[s\].
pub(super) const SECOND_RUN_S: f64 = 50.0;

/// A device with its recording.
#[derive(Debug)]
pub(super) struct Rig {
    pub(super) name: &'static str,
    pub(super) device: Device,
    pub(super) recording: Recording,
}

impl Rig {
    pub(super) fn context(&self) -> Context<'_> {
        context(&self.device, &self.recording)
    }
}

/// What effects are computed from on a recording.
pub(super) fn context<'a>(device: &'a Device, recording: &'a Recording) -> Context<'a> {
    let channels = channels(device, recording).unwrap();
    let mut context = Context::new(device, recording, &streams(device, &channels)).unwrap();
    context.lines = channels.into_iter().map(line).collect();
    context
}

/// A line that was found in a channel.
fn line(channel: Channel) -> Line {
    Line {
        channel,
        frequency_hz: 7.3,
        phase_rad: vec![0.4; 2],
    }
}

/// Both rigs.
pub(super) fn rigs() -> [Rig; 2] {
    [seven_joints(), three_joints()]
}

/// Seven revolute joints in the standard convention: three capstans, a parallelogram, three direct ones;
/// encoders on the first four axes, one cable, masses, gravity along -y.
pub(super) fn seven_joints() -> Rig {
    let mut text = String::from("[device]\nname = \"seven\"\n");
    for (a, alpha, d) in [
        (0.25, -1.4, 0.05),
        (0.01, -1.5, 0.35),
        (0.0, 1.6, 0.01),
        (0.02, -1.5, 0.18),
        (0.0, 1.6, 0.0),
        (0.01, -1.6, 0.28),
        (0.0, 1.5, 0.02),
        (0.02, 0.0, 0.02),
    ] {
        write!(
            text,
            "[[link]]\na_m = {a}\nalpha_rad = {alpha}\nd_m = {d}\n\
             mass_kg = 0.2\ncentre_of_mass_m = [0.01, 0.0, 0.03]\n"
        )
        .unwrap();
    }
    let homes = [-2.6, 1.6, 0.1, 1.5, 0.2, -1.5, -0.5];
    for (joint, home) in homes.iter().enumerate() {
        let drive = match joint {
            0..=2 => {
                "transmission = \"capstan\"\ntransmission_ratio = 8.0\ndrum_distance_m = 0.0675\n"
            }
            3 => {
                "transmission = \"parallelogram\"\ntransmission_ratio = 12.0\n\
                 drum_distance_m = 0.0975\nparallelogram_lengths_m = [0.18, 0.076, 0.18, 0.076]\n"
            }
            _ => "transmission = \"direct\"\ntransmission_ratio = 1.0\n",
        };
        let encoder = if joint < 4 {
            "external_encoder_counts_per_rev = 20000\n"
        } else {
            ""
        };
        write!(
            text,
            "[[joint]]\nname = \"{joint}\"\nhome_rad = {home}\n{drive}{encoder}\
             encoder_counts_per_rev = 20000\n"
        )
        .unwrap();
    }
    text.push_str(
        "[cable_encoder]\ndrum_radius_m = 0.015\ncounts_per_rev = 20000\ndistance_sd_m = 1e-5\n\
         [gravity]\nvector_mps2 = [0.0, -9.81, 0.0]\n",
    );
    let device = Device::from_toml(&text, "seven.toml").unwrap().device;
    let recording = recording(&device, &[true, true, true, true, false, false, false]);
    Rig {
        name: "seven joints",
        device,
        recording,
    }
}

/// A capstan, a slide and a capstan in the modified convention, the last without an external encoder; two
/// cables and a tracker, masses, gravity along -z.
pub(super) fn three_joints() -> Rig {
    let text = "
[device]
name = \"three\"
convention = \"modified\"
[[link]]
a_m = 0.3
alpha_rad = 0.3
d_m = 0.2
[[link]]
a_m = 0.05
alpha_rad = 1.2
d_m = 0.1
mass_kg = 0.4
centre_of_mass_m = [0.02, 0.01, 0.05]
[[link]]
a_m = 0.08
alpha_rad = -0.9
d_m = 0.25
mass_kg = 0.3
centre_of_mass_m = [0.0, 0.02, 0.1]
[[link]]
a_m = 0.12
alpha_rad = 1.1
d_m = 0.15
mass_kg = 0.2
centre_of_mass_m = [0.05, 0.0, 0.02]
[[joint]]
name = \"turn\"
home_rad = 0.4
transmission = \"capstan\"
transmission_ratio = 8.0
drum_distance_m = 0.07
encoder_counts_per_rev = 20000
external_encoder_counts_per_rev = 20000
[[joint]]
name = \"slide\"
type = \"prismatic\"
home_rad = 0.05
transmission = \"direct\"
transmission_ratio = 1.0
encoder_counts_per_rev = 20000
external_encoder_sd_rad = 1e-5
[[joint]]
name = \"wrist\"
home_rad = -0.7
transmission = \"capstan\"
transmission_ratio = 10.0
drum_distance_m = 0.06
encoder_counts_per_rev = 20000
[cable_encoder]
drum_radius_m = 0.02
counts_per_rev = 20000
distance_sd_m = 1e-5
exit_axis = [0.6, 0.8, 0.0]
[[cable]]
anchor_m = [0.1, -0.6, 0.2]
drum_radius_m = 0.02
counts_per_rev = 20000
distance_sd_m = 1e-5
[tracker]
base = \"known\"
tool = \"known\"
position_sd_m = 1e-4
rotation_sd_rad = 1e-3
[gravity]
vector_mps2 = [0.0, 0.0, -9.81]
";
    let device = Device::from_toml(text, "three.toml").unwrap().device;
    let recording = recording(&device, &[true, true, false]);
    Rig {
        name: "three joints",
        device,
        recording,
    }
}

/// Reading of a joint at a time: two incommensurable waves, so that reversals are not all alike.
pub(super) fn reading(device: &Device, joint: usize, time_s: f64) -> f64 {
    let size = match device.joints[joint].unit() {
        "m" => 0.06,
        _ => 0.5,
    };
    let pace = 1.3 + 0.37 * joint as f64;
    let phase = 0.9 * joint as f64;
    size * ((pace * time_s + phase).sin() + 0.4 * (2.3 * pace * time_s - phase).cos())
}

/// A smooth load of a number, in turn.
fn load(number: usize, time_s: f64) -> f64 {
    let pace = 0.9 + 0.23 * number as f64;
    (pace * time_s + 1.7 * number as f64).cos() + 0.3 * (3.1 * pace * time_s).sin()
}

/// What a device without any error would record; `measured` says which axes have an external encoder.
pub(super) fn recording(device: &Device, measured: &[bool]) -> Recording {
    let time_s: Vec<f64> = (0..2 * RUN)
        .map(|row| {
            let start_s = if row < RUN { 0.0 } else { SECOND_RUN_S };
            start_s + STEP_S * (row % RUN) as f64
        })
        .collect();
    let joints = device.joints.len();
    let at = |function: &dyn Fn(f64) -> f64| -> Vec<f64> {
        time_s.iter().map(|time_s| function(*time_s)).collect()
    };
    let mut recording = Recording {
        line: (2..).take(2 * RUN).collect(),
        run: Some((0..2 * RUN).map(|row| i64::from(row >= RUN)).collect()),
        joint: (0..joints)
            .map(|joint| at(&|time_s| reading(device, joint, time_s)))
            .collect(),
        output: vec![None; joints],
        torque_nm: (0..joints)
            .map(|joint| Some(at(&|time_s| 0.8 * load(joint, time_s))))
            .collect(),
        force_n: Some([10, 11, 12].map(|axis| at(&|time_s| 3.0 * load(axis, time_s)))),
        temperature_degc: Some(at(&|time_s| 22.0 + 3.0 * (0.5 * time_s).sin())),
        ..Recording::default()
    };
    measure(device, measured, &mut recording);
    recording.time_s = Some(time_s);
    recording
}

/// Fills the measured channels from the model.
fn measure(device: &Device, measured: &[bool], recording: &mut Recording) {
    let rows = recording.len();
    let mut evaluation = Evaluation::new(device);
    let mut output = vec![vec![0.0; rows]; device.joints.len()];
    let mut cable_m = vec![vec![0.0; rows]; device.cables.len()];
    let mut position_m = [(); 3].map(|()| vec![0.0; rows]);
    let mut orientation = [(); 4].map(|()| vec![0.0; rows]);
    for row in 0..rows {
        let readings: Vec<f64> = recording.joint.iter().map(|column| column[row]).collect();
        evaluation.move_to(&readings).unwrap();
        for (joint, column) in output.iter_mut().enumerate() {
            column[row] = evaluation.output_rad(joint);
        }
        let pose = evaluation.pose().unwrap();
        for (column, cable) in cable_m.iter_mut().zip(&device.cables) {
            column[row] = (pose.position_m - nalgebra::Vector3::from(cable.anchor_m)).norm();
        }
        for (axis, column) in position_m.iter_mut().enumerate() {
            column[row] = pose.position_m[axis];
        }
        let rotation: Matrix3<f64> = pose.rotation;
        let turn =
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
        for (column, part) in orientation.iter_mut().zip([turn.w, turn.i, turn.j, turn.k]) {
            column[row] = part;
        }
    }
    recording.output = output
        .into_iter()
        .zip(measured)
        .map(|(column, measured)| measured.then_some(column))
        .collect();
    recording.cable_m = cable_m.into_iter().map(Some).collect();
    if device.tracker.is_some() {
        recording.position_m = Some(position_m);
        recording.orientation_wxyz = Some(orientation);
    }
}

/// A size that a device can show, by the name of the parameter.
pub(super) fn typical(parameter: &str) -> Option<f64> {
    Some(match parameter {
        "stiffness_nm_per_rad" => 300.0,
        "creep_per_nm" => 1e-4,
        "slip_rad" => 2e-3,
        "width_rad" | "amplitude_rad" | "gain" | "scale" | "tilt_rad" => 1e-3,
        "transition_rad" => 0.05,
        "play_rad" => 0.1,
        "delay_s" => 3e-3,
        "phase_rad" => 0.7,
        "quadratic_per_rad" => 2e-3,
        "counts" => 40.0,
        "time_s" => SECOND_RUN_S + 0.5 * STEP_S * RUN as f64,
        "rad_per_degc" => 5e-5,
        "rad_per_s" => 1e-5,
        "ratio_deviation" => 0.02,
        "offset_m" | "twist_m_per_rad2" | "shift_m" | "offset_rad" => 1e-3,
        "weight_n_per_m_over_tension" => 3e-3,
        "radius_m" => 6e-3,
        "amplitude_m" => 5e-5,
        "m_per_degc" => 1e-5,
        "m_per_s" => 2e-6,
        "rad_per_nm" => 1e-4,
        "m_per_n" => 1e-5,
        "x_n" | "y_n" | "z_n" => 0.2,
        "x_n_per_k" | "y_n_per_k" | "z_n_per_k" => 0.03,
        "x" | "y" | "z" | "xy" | "xz" | "yx" | "yz" | "zx" | "zy" => 0.03,
        "transition_n" => 0.5,
        "coulomb_nm" | "viscous_nm_s_per_rad" | "stribeck_nm" | "amplitude_nm" => 0.02,
        "coulomb_n" | "viscous_n_s_per_m" | "stribeck_n" | "amplitude_n" => 0.2,
        "transition_m" | "transition_m_per_s" => 2e-3,
        "transition_rad_per_s" => 0.02,
        "mass_kg" => 0.3,
        _ => return None,
    })
}

/// Values of an effect's parameters at their typical sizes, times `factor` for those that are sizes; orders
/// and the like are those of its first shape.
pub(super) fn values(effect: &AnyEffect, context: &Context<'_>, factor: f64) -> Vec<f64> {
    let shape = effect.shapes(context).first().copied().unwrap_or(0.0);
    effect
        .spec()
        .parameters
        .iter()
        .map(|spec| match (typical(spec.name), spec.name) {
            (Some(value), "phase_rad" | "time_s") => value,
            (Some(value), _) => factor * value,
            (None, "from_joint") => effect.other_joint().map_or(shape, |from| (from + 1) as f64),
            (None, "order" | "frequency_hz" | "cable") => shape,
            (None, "from_run") => shape + 1.0,
            (None, other) => panic!(
                "{} has a parameter `{other}` without a size",
                effect.label()
            ),
        })
        .collect()
}

/// Amplitudes at typical sizes, none of them zero, and the shape that belongs to them.
pub(super) fn amplitudes(effect: &AnyEffect, context: &Context<'_>) -> (Vec<f64>, f64) {
    let (mut amplitudes, shape) = effect.amplitudes(context, &values(effect, context, 1.0));
    let size = amplitudes
        .iter()
        .fold(0.0, |size: f64, a| size.max(a.abs()));
    for (index, amplitude) in amplitudes
        .iter_mut()
        .enumerate()
        .filter(|(_, a)| **a == 0.0)
    {
        *amplitude = size * (0.6 - 0.13 * index as f64);
    }
    (amplitudes, shape)
}
