//! Simulated rigs give their devices back: within the intervals, and exactly where nothing is noisy.

use haptical_calibration::{
    CalibrationMethod, HeldOut, Options, Weighting, candidate_parameters, fit_device,
    prepare_device,
};
use haptical_identification::Status;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{
    Body, CableFit, ContactPair, Device, JointCompliance, ParameterId, Recording, TouchedPlane,
};
use proptest::prelude::*;

use crate::chain::{cable_at, pseudo_random};
use crate::rig_rank::judge;
use crate::rig_scene::{
    Target, add_touches, general, normal, placement, plain, poses, readings, shaken, table,
    touches, tracked, two_points, unknown_tracker,
};

/// Deviations of what the data can fix, from a device on which they were measured.
fn fit_and_scatter(nominal: &Device, truth: &Device, recording: &Recording) -> (f64, usize) {
    let options = Options {
        method: CalibrationMethod::TwoStep,
        weighting: Weighting::Stated,
        held_out: HeldOut::None,
        ..Options::default()
    };
    let fitted = fit_device(nominal, recording, &options).unwrap();
    let whole = fitted.whole.unwrap();
    let (mut square, mut count) = (0.0, 0);
    for &index in &whole.fitted {
        let parameter = whole.parameters[index];
        if let ParameterId::Link { .. } | ParameterId::Compliance { .. } = parameter {
            let error = parameter.value(&whole.device) - parameter.value(truth);
            square += (error / whole.estimates[index].standard_deviation.unwrap()).powi(2);
            count += 1;
        }
    }
    (square, count)
}

/// Moves the parameters that a recording of `nominal` fixes, so that those that are held are true.
pub(crate) fn moved_within_sight(nominal: &Device, recording: &Recording, seed: u64) -> Device {
    let judged = judge(nominal, recording);
    let prepared = prepare_device(nominal, recording).unwrap();
    let mut truth = nominal.clone();
    for (index, parameter) in candidate_parameters(&prepared).into_iter().enumerate() {
        let is_fixed = matches!(judged.statuses[index], Status::Identifiable { .. });
        if let (ParameterId::Link { .. }, true) = (parameter, is_fixed) {
            let size = 0.2 * parameter.plausible_size(&truth);
            let value = parameter.value(&truth) + size * pseudo_random(seed, index as u64);
            parameter.set(&mut truth, value);
        }
    }
    truth
}

/// A mixed log of one device: sockets, a plane, a tracker at an unknown place, an encoder fixture and a cable.
fn mixed(truth: &Device, seed: u64, sd_rad: f64) -> Recording {
    let joints = truth.joints.len();
    let mut recording = plain(readings(truth, 40, 1.3, 10 + seed));
    tracked(truth, &mut recording, 1.0, seed);
    let cable = truth.cables[0];
    let lengths = poses(truth, &recording)
        .into_iter()
        .enumerate()
        .map(|(row, pose)| {
            cable.reading(&pose.position_m).unwrap().reading_m
                + 1e-5 * normal(seed + 100, row as u64)
        });
    recording.cable_m = vec![Some(lengths.collect())];
    let points = two_points(truth);
    let plane = Vector3::new(0.2, -0.1, 1.0).normalize();
    let on_plane = Target::Plane(plane, plane.dot(&points[0]));
    let mut touched = plain(vec![Vec::new(); joints]);
    add_touches(
        &mut touched,
        &touches(truth, &Target::Point(points[0]), 25, seed),
        "left",
        false,
    );
    add_touches(
        &mut touched,
        &touches(truth, &Target::Point(points[1]), 25, seed + 1),
        "right",
        false,
    );
    add_touches(
        &mut touched,
        &touches(truth, &on_plane, 30, seed + 2),
        "table",
        true,
    );
    shaken(&mut touched, sd_rad, seed + 3);
    let ids = |column: &Option<Vec<String>>| column.clone().unwrap();
    let (contact, plane) = (ids(&touched.contact), ids(&touched.plane));
    let before = recording.len();
    add_touches(
        &mut recording,
        &(0..touched.len())
            .map(|row| touched.joint.iter().map(|column| column[row]).collect())
            .collect::<Vec<Vec<f64>>>(),
        "",
        false,
    );
    let padded = |own: Vec<String>| {
        let mut all = vec![String::new(); before];
        all.extend(own);
        all.resize(before + touched.len(), String::new());
        all
    };
    recording.contact = Some(padded(contact));
    recording.plane = Some(padded(plane));
    recording
}

/// Quantized readings are the only noise of a touch, so that its size is known without a Monte-Carlo run: the
/// encoders' step, propagated through the chain, must give standard deviations that the errors have.
#[test]
fn mixed_logs_give_the_geometry_back_within_its_intervals() {
    for nominal in [table(5), general()] {
        let mut nominal = nominal;
        unknown_tracker(&mut nominal);
        nominal.cables = vec![cable_at([0.9, -0.7, 0.1])];
        (nominal.cables[0].fit.zero, nominal.cables[0].fit.anchor) = (true, true);
        // touches within 0.1 mm, whatever the encoders' steps are
        nominal.surroundings.contact_sd_m = Some(1e-6);
        nominal.surroundings.plane_sd_m = Some(1e-6);
        let sd_rad = 2e-5;
        for joint in &mut nominal.joints {
            let step = sd_rad * 12.0_f64.sqrt();
            joint.encoder_counts_per_rev = Some(std::f64::consts::TAU / step);
        }
        nominal.contact_pairs = vec![ContactPair {
            a: "left".to_owned(),
            b: "right".to_owned(),
            distance_m: 0.05,
            sd_m: 1e-5,
        }];
        let (mut square, mut count) = (0.0, 0);
        for seed in 0..3 {
            let seed = 40 * (seed + 1);
            let shape = |device: &Device| {
                let mut device = device.clone();
                device.surroundings.tracker_base = Some(placement(seed, 1.0, 0.0));
                device.surroundings.tracker_tool = Some(placement(seed + 1, 0.1, 0.0));
                device
            };
            let sketch = mixed(&shape(&nominal), seed, sd_rad);
            let truth = shape(&moved_within_sight(&nominal, &sketch, seed));
            let mut anchored = truth.clone();
            anchored.cables[0].anchor_m = [0.905, -0.704, 0.103];
            anchored.cables[0].zero_m = 0.004;
            let mut recording = mixed(&anchored, seed, 0.0);
            // all readings have the encoders' error
            shaken(&mut recording, sd_rad, seed + 7);
            let (own, fitted) = fit_and_scatter(&nominal, &truth, &recording);
            square += own;
            count += fitted;
        }
        let ratio = square / count as f64;
        // errors of one fit hang together: 60 to 90 of them are worth about 40
        assert!((0.5..1.7).contains(&ratio), "{ratio} over {count}");
    }
}

#[test]
fn a_cable_s_own_numbers_are_found() {
    let mut nominal = table(4);
    let axis = Some([-0.8, 0.6, 0.0]);
    nominal.cables = vec![cable_at([0.9, -0.7, 0.1]), cable_at([-0.8, 0.5, 0.6])];
    nominal.cables[1].fit = CableFit {
        anchor: true,
        zero: true,
        scale: false,
        exit_radius: true,
    };
    nominal.cables[1].exit_axis = axis;
    let mut truth = nominal.clone();
    truth.cables[1].anchor_m = [-0.804, 0.503, 0.606];
    truth.cables[1].zero_m = 0.003;
    truth.cables[1].exit_radius_m = 0.012;
    let mut recording = plain(readings(&truth, 300, 1.5, 8));
    let poses = poses(&truth, &recording);
    recording.cable_m = truth
        .cables
        .iter()
        .map(|cable| {
            let lengths = poses
                .iter()
                .map(|pose| cable.reading(&pose.position_m).unwrap().reading_m);
            Some(lengths.collect())
        })
        .collect();
    let options = Options {
        method: CalibrationMethod::TwoStep,
        held_out: HeldOut::None,
        ..Options::default()
    };
    let fitted = fit_device(&nominal, &recording, &options).unwrap().device;
    let found = &fitted.cables[1];
    for (have, want) in found.anchor_m.iter().zip(truth.cables[1].anchor_m) {
        assert!((have - want).abs() < 1e-8, "{have} for {want}");
    }
    assert!((found.zero_m - 0.003).abs() < 1e-8 && (found.exit_radius_m - 0.012).abs() < 1e-7);
    assert_eq!(fitted.cables[0], nominal.cables[0]);
}

fn compliant() -> Device {
    let mut device = table(5);
    unknown_tracker(&mut device);
    device.gravity_mps2 = Some([0.0, 0.0, -9.81]);
    device.bodies = (0..6)
        .map(|row| {
            (row > 0).then_some(Body {
                mass_kg: 4.0 - 0.5 * row as f64,
                centre_of_mass_m: [0.1, 0.02, -0.03],
                inertia_kgm2: None,
            })
        })
        .collect();
    device
}

#[test]
fn joints_that_yield_to_the_weights_are_found() {
    let mut nominal = compliant();
    nominal.surroundings.compliance = vec![
        JointCompliance {
            rad_per_nm: 0.0,
            fit: true,
        };
        5
    ];
    let mut truth = nominal.clone();
    for (joint, compliance) in truth.surroundings.compliance.iter_mut().enumerate() {
        compliance.rad_per_nm = 1e-4 * (joint + 1) as f64;
    }
    truth.surroundings.tracker_base = Some(placement(5, 1.0, 0.0));
    truth.surroundings.tracker_tool = Some(placement(6, 0.1, 0.0));
    let mut recording = plain(readings(&truth, 120, 1.5, 3));
    tracked(&truth, &mut recording, 1.0, 9);
    let options = Options {
        method: CalibrationMethod::TwoStep,
        weighting: Weighting::Stated,
        held_out: HeldOut::None,
        ..Options::default()
    };
    let fitted = fit_device(&nominal, &recording, &options).unwrap();
    let whole = fitted.whole.unwrap();
    let mut found = 0;
    for &index in &whole.fitted {
        if let parameter @ ParameterId::Compliance { joint } = whole.parameters[index] {
            let sd = whole.estimates[index].standard_deviation.unwrap();
            let error = parameter.value(&whole.device) - 1e-4 * (joint + 1) as f64;
            assert!(
                error.abs() < 4.5 * sd,
                "joint {joint}: {error:e}, sd {sd:e}"
            );
            assert!(sd < 5e-5, "joint {joint}: sd {sd:e}");
            found += 1;
        }
    }
    assert!(found >= 4, "{found} of 5 were fitted");

    // torques of the log go before those of the masses
    let torques = haptical_model::holding_torques_nm(&truth, &recording)
        .unwrap()
        .unwrap();
    recording.torque_nm = torques.into_iter().map(Some).collect();
    let mut weightless = nominal.clone();
    weightless.bodies = vec![None; 6];
    let again = fit_device(&weightless, &recording, &options)
        .unwrap()
        .device;
    for joint in 0..5 {
        let (a, b) = (
            again.compliance_rad_per_nm(joint),
            fitted.device.compliance_rad_per_nm(joint),
        );
        assert!((a - b).abs() < 1e-6, "joint {joint}: {a:e} and {b:e}");
    }
}

/// Where a joint yields by some degrees, the torques are those at the angles that it yields to.
#[test]
fn soft_joints_are_found_without_noise() {
    let mut nominal = compliant();
    let may_yield = JointCompliance {
        rad_per_nm: 0.0,
        fit: true,
    };
    nominal.surroundings.compliance = vec![may_yield; 5];
    let mut truth = nominal.clone();
    truth.surroundings.compliance[1].rad_per_nm = 2e-3;
    truth.surroundings.tracker_base = Some(placement(5, 1.0, 0.0));
    truth.surroundings.tracker_tool = Some(placement(6, 0.1, 0.0));
    let mut recording = plain(readings(&truth, 120, 1.5, 3));
    tracked(&truth, &mut recording, 0.0, 9);
    let options = Options {
        weighting: Weighting::Stated,
        held_out: HeldOut::None,
        ..Options::default()
    };
    let fitted = fit_device(&nominal, &recording, &options).unwrap().device;
    let found = fitted.compliance_rad_per_nm(1);
    assert!((found - 2e-3).abs() < 1e-8, "{found:e}");
}

/// Base and tool of a tracker within a micrometre and a microradian: the geometry is true and nothing noisy.
fn tracker_is_found(device: &Device, with_turns: bool, seed: u64) -> Result<(), TestCaseError> {
    let mut truth = device.clone();
    unknown_tracker(&mut truth);
    truth.surroundings.tracker_base = Some(placement(seed, 2.0, 0.0));
    truth.surroundings.tracker_tool = Some(placement(seed + 1, 0.15, 0.0));
    let mut recording = plain(readings(&truth, 25, 1.4, seed + 2));
    tracked(&truth, &mut recording, 0.0, 1);
    if !with_turns {
        recording.orientation_wxyz = None;
    }
    let mut unknown = device.clone();
    unknown_tracker(&mut unknown);
    let prepared = prepare_device(&unknown, &recording).unwrap().surroundings;
    let places = [
        (prepared.tracker_base, truth.surroundings.tracker_base),
        (prepared.tracker_tool, truth.surroundings.tracker_tool),
    ];
    for (index, (have, want)) in places.into_iter().enumerate() {
        let (have, want) = (have.unwrap().pose(), want.unwrap().pose());
        prop_assert!((have.position_m - want.position_m).norm() < 1e-6);
        if with_turns || index == 0 {
            prop_assert!((have.rotation - want.rotation).norm() < 1e-6);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_tracker_anywhere_is_found(seed in 0_u64..1_000_000, with_turns: bool) {
        tracker_is_found(&table(5), with_turns, seed)?;
        tracker_is_found(&general(), with_turns, seed)?;
    }

    /// A plane's normal stays a unit vector and its slopes are its derivatives, however far it is tilted.
    #[test]
    fn tilted_normals_are_unit_vectors(x in -1.0..1.0_f64, y in -1.0..1.0_f64, t in -2.0..2.0_f64) {
        let normal = Vector3::new(x, y, 0.5).normalize();
        let plane = |tilt| TouchedPlane { id: String::new(), normal: normal.into(), tilt, offset_m: 0.0 };
        let (n, slopes) = plane([t, 0.3]).normal_and_slopes();
        prop_assert!((n.norm() - 1.0).abs() < 1e-14);
        let step = 1e-6;
        let by = (plane([t + step, 0.3]).normal_and_slopes().0
            - plane([t - step, 0.3]).normal_and_slopes().0) / (2.0 * step);
        prop_assert!((by - slopes[0]).norm() < 1e-9);
        prop_assert!(slopes[0].dot(&n).abs() < 1e-14);
    }
}
