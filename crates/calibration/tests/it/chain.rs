//! Random serial chains, what is measured of them, and the verdict on their parameters.

use haptical_calibration::{
    Channel, DeviceProblem, Weights, candidate_parameters, channels, identifiability_at,
    parameter_infos, preference_order,
};
use haptical_identification::{
    Identifiability, IdentifiabilityRules, Matrix, ParameterInfo, Status, evaluate_jacobian,
};
use haptical_model::kinematics::nalgebra::{Rotation3, UnitQuaternion};
use haptical_model::kinematics::{Convention, Link};
use haptical_model::{
    Cable, Device, Evaluation, Joint, JointType, ParameterId, Recording, Tracker,
    TransmissionError, TransmissionKind,
};
use proptest::prelude::*;

/// What a rig measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rig {
    Cable,
    Position,
    Pose,
}

pub(crate) const RIGS: [Rig; 3] = [Rig::Cable, Rig::Position, Rig::Pose];

/// Rows of a recording: more than three for each of the at most 32 parameters.
pub(crate) const ROWS: usize = 120;

/// A row without special values (docs/equations.md, "Structural count": the ranges of the check).
fn generic_link() -> impl Strategy<Value = Link> {
    let length = 0.05..0.4_f64;
    let twist = (0.3..1.4_f64, any::<bool>()).prop_map(|(s, up)| if up { s } else { -s });
    (length.clone(), twist, length, -3.0..3.0_f64).prop_map(|(a_m, alpha_rad, d_m, theta_rad)| {
        Link {
            a_m,
            alpha_rad,
            d_m,
            theta_rad,
            beta_rad: 0.0,
            b_m: 0.0,
        }
    })
}

/// A chain of revolute joints with as many joints as `joints` allows.
pub(crate) fn generic_chain(
    joints: std::ops::RangeInclusive<usize>,
) -> impl Strategy<Value = Device> {
    let (fewest, most) = (joints.start() + 1, joints.end() + 1);
    prop::collection::vec(generic_link(), fewest..=most).prop_map(device_of)
}

/// A device with revolute, directly driven joints, one cable and a known tracker.
pub(crate) fn device_of(links: Vec<Link>) -> Device {
    Device {
        name: "random chain".to_owned(),
        convention: Convention::Standard,
        bodies: vec![None; links.len()],
        origins: Vec::new(),
        drives: Vec::new(),
        parents: Vec::new(),
        hands: Vec::new(),
        joints: (1..links.len()).map(direct_joint).collect(),
        links,
        cables: vec![cable_at([0.0; 3])],
        tracker: Some(Tracker {
            base_known: true,
            base_per_run: false,
            tool_known: true,
            position_sd_m: Some(1e-4),
            rotation_sd_rad: Some(1e-4),
            scale_sd: Some(0.0),
        }),
        contact_pairs: Vec::new(),
        gravity_mps2: None,
        nominal_links: None,
        deviations: Default::default(),
        surroundings: Default::default(),
        effects: Vec::new(),
    }
}

pub(crate) fn cable_at(anchor_m: [f64; 3]) -> Cable {
    Cable {
        anchor_m,
        distance_sd_m: Some(1e-5),
        scale_sd: Some(0.0),
        ..Cable::default()
    }
}

pub(crate) fn direct_joint(number: usize) -> Joint {
    Joint {
        has_numeric_name: false,
        name: number.to_string(),
        joint_type: JointType::Revolute,
        home_rad: 0.0,
        lower_rad: -2.0,
        upper_rad: 2.0,
        sampling_sd_rad: Some(0.6),
        armature_kgm2: None,
        torque_offset_nm: None,
        torque_delay_s: None,
        torque_limit_nm: None,
        transmission: TransmissionKind::Direct,
        transmission_ratio: 1.0,
        drum_distance_m: None,
        input_drum_denominator_m: None,
        encoder_counts_per_rev: None,
        external_encoder_counts_per_rev: None,
        external_encoder_sd_rad: None,
        torque_scale_sd: 0.0,
        parallelogram_lengths_m: None,
        transmission_error: TransmissionError::default(),
    }
}

/// A number in [-1, 1) that only depends on `seed` and `index` (SplitMix64).
pub(crate) fn pseudo_random(seed: u64, index: u64) -> f64 {
    let mut z = seed
        .wrapping_mul(0xD134_2543_DE82_EF95)
        .wrapping_add((index + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^= z >> 31;
    (z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Exact measurements of a device at random readings: +-1.5 rad, +-0.15 m for prismatic joints.
pub(crate) fn measure(device: &Device, rig: Rig, rows: usize, seed: u64) -> Recording {
    let joints = device.joints.len();
    let joint: Vec<Vec<f64>> = (0..joints)
        .map(|joint| {
            let range = match device.joints[joint].joint_type {
                JointType::Revolute => 1.5,
                JointType::Prismatic => 0.15,
            };
            (0..rows)
                .map(|row| range * pseudo_random(seed, (row * joints + joint) as u64))
                .collect()
        })
        .collect();
    measure_at(device, rig, joint)
}

/// Exact measurements at given readings, one column for each joint.
pub(crate) fn measure_at(device: &Device, rig: Rig, joint: Vec<Vec<f64>>) -> Recording {
    let (joints, rows) = (joint.len(), joint[0].len());
    let mut recording = Recording {
        line: (2..2 + rows as u64).collect(),
        joint,
        output: vec![None; joints],
        torque_nm: vec![None; joints],
        cable_m: vec![None; device.cables.len()],
        ..Recording::default()
    };
    let mut evaluation = Evaluation::new(device);
    let mut cables = vec![Vec::new(); device.cables.len()];
    let (mut position, mut orientation) = ([(); 3].map(|()| vec![]), [(); 4].map(|()| vec![]));
    for row in 0..rows {
        let readings: Vec<f64> = recording.joint.iter().map(|column| column[row]).collect();
        evaluation.move_to(&readings).unwrap();
        let pose = evaluation.pose().unwrap();
        for (column, cable) in cables.iter_mut().zip(&device.cables) {
            column.push(
                (pose.position_m
                    - haptical_model::kinematics::nalgebra::Vector3::from(cable.anchor_m))
                .norm(),
            );
        }
        for axis in 0..3 {
            position[axis].push(pose.position_m[axis]);
        }
        let rotation = Rotation3::from_matrix_unchecked(pose.rotation);
        let q = UnitQuaternion::from_rotation_matrix(&rotation);
        for (column, part) in orientation.iter_mut().zip([q.w, q.i, q.j, q.k]) {
            column.push(part);
        }
    }
    match rig {
        Rig::Cable => recording.cable_m = cables.into_iter().map(Some).collect(),
        Rig::Position => recording.position_m = Some(position),
        Rig::Pose => {
            recording.position_m = Some(position);
            recording.orientation_wxyz = Some(orientation);
        }
    }
    recording
}

/// The verdict on all candidate parameters at the device itself.
pub(crate) fn judge(device: &Device, recording: &Recording) -> Identifiability {
    judge_by(&IdentifiabilityRules::default(), device, recording)
}

/// What the rows see of the parameters, however well the noise lets them be known: a parameter that is held because it is
/// weak gives way to one that depends on it.
pub(crate) fn structure(device: &Device, recording: &Recording) -> Identifiability {
    let rules = IdentifiabilityRules {
        weak_share: 1e12,
        ..IdentifiabilityRules::default()
    };
    judge_by(&rules, device, recording)
}

fn judge_by(
    rules: &IdentifiabilityRules,
    device: &Device,
    recording: &Recording,
) -> Identifiability {
    let channels = channels(device, recording).unwrap();
    let parameters = candidate_parameters(device);
    let weights = Weights::stated(device, &channels);
    identifiability_at(device, recording, &channels, &parameters, &weights, rules).unwrap()
}

/// Derivatives, names and order of preference of all candidate parameters.
pub(crate) struct Columns {
    pub(crate) parameters: Vec<ParameterId>,
    pub(crate) channels: Vec<Channel>,
    pub(crate) weights: Weights,
    pub(crate) jacobian: Matrix,
    pub(crate) infos: Vec<ParameterInfo>,
    pub(crate) order: Vec<usize>,
}

pub(crate) fn columns(device: &Device, recording: &Recording) -> Columns {
    let channels = channels(device, recording).unwrap();
    let parameters = candidate_parameters(device);
    let weights = Weights::stated(device, &channels);
    let problem = DeviceProblem::new(device, recording, &channels, &parameters, &weights).unwrap();
    let all: Vec<usize> = (0..parameters.len()).collect();
    let (jacobian, _) = evaluate_jacobian(&problem, &problem.start(), &all).unwrap();
    Columns {
        infos: parameter_infos(device, &parameters),
        order: preference_order(&parameters),
        parameters,
        channels,
        weights,
        jacobian,
    }
}

/// Names of the parameters without an effect, and of those that depend on others.
pub(crate) fn pruned(judged: &Identifiability) -> (Vec<&str>, Vec<&str>) {
    let named = |wanted: fn(&Status) -> bool| {
        let pairs = judged.names.iter().zip(&judged.statuses);
        pairs
            .filter(|(_, status)| wanted(status))
            .map(|(name, _)| name.as_str())
            .collect()
    };
    (
        named(|status| matches!(status, Status::Invisible)),
        named(|status| matches!(status, Status::Dependent { .. })),
    )
}

/// The combination that a dependent parameter acts like.
pub(crate) fn combination<'j>(judged: &'j Identifiability, name: &str) -> Vec<(&'j str, f64)> {
    let index = judged.names.iter().position(|other| other == name).unwrap();
    match &judged.statuses[index] {
        Status::Dependent { combination } => combination
            .iter()
            .map(|term| (term.name.as_str(), term.coefficient))
            .collect(),
        other => panic!("{name} is {other:?}"),
    }
}

/// Whether a joint (from 0) locked at a reading leaves the x axes of its two rows well apart: where
/// they are parallel or opposed the rows have more dependences than the locked joint's.
pub(crate) fn turned_when_locked(device: &Device, joint: usize, reading: f64) -> bool {
    (device.links[joint + 1].theta_rad + reading).sin().abs() > 0.05
}
