//! Touches without a length: the device keeps its size.

use haptical_calibration::{
    CalibrationError, FitRequest, HeldOut, Options, Weights, calibrate, candidate_parameters,
    channels, fit_parameters, prepare_device,
};
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Parameter, ParameterId, Recording};

use crate::chain::pseudo_random;
use crate::rig_scene::{Target, add_touches, plain, poses, shaken, touch};

/// Noise of the readings \[rad\]: touches return within a third of a millimetre.
const SD_RAD: f64 = 1e-3;

/// A humanoid's arm as a URDF gives it: the lengths of upper arm and forearm lie along the axes of the turns about
/// them, each as two numbers, and across the axes there are elbow offsets of 15 mm alone.
fn humanoid_arm() -> Device {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let origins = [
        ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]),
        ([0.0, 0.15, 0.35], [half, -half, 0.0, 0.0]),
        ([0.0, 0.0, 0.05], [0.5, 0.5, 0.5, 0.5]),
        ([0.13, 0.0, 0.0], [half, 0.0, -half, 0.0]),
        ([0.015, 0.0, -0.12], [half, -half, 0.0, 0.0]),
        ([-0.015, 0.14, 0.0], [half, half, 0.0, 0.0]),
        ([0.0, 0.0, -0.12], [half, -half, 0.0, 0.0]),
        ([0.0, 0.0, 0.0], [0.5, 0.5, 0.5, 0.5]),
    ];
    let mut text = "[device]\nhandle_xyz_m = [0.11, 0.0, 0.01]\n".to_owned();
    for (xyz, wxyz) in origins {
        text += &format!(
            "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\norigin_xyz_m = {xyz:?}\norigin_wxyz = {wxyz:?}\n"
        );
    }
    text += &"[[joint]]\ntransmission = \"direct\"\n".repeat(7);
    Device::from_toml(&text, "arm.toml").unwrap().device
}

/// A device that differs from the nominal one as real ones do.
fn built(nominal: &Device, seed: u64) -> Device {
    let mut truth = nominal.clone();
    for (index, parameter) in candidate_parameters(nominal).into_iter().enumerate() {
        let ParameterId::Link {
            row,
            parameter: kind,
        } = parameter
        else {
            continue;
        };
        let size = match kind {
            Parameter::A | Parameter::B | Parameter::D => 1e-3,
            Parameter::Theta => 2e-2,
            _ => 5e-3,
        };
        if row > 0 {
            parameter.set(&mut truth, 3.5 * size * pseudo_random(seed, index as u64));
        }
    }
    truth
}

/// What the joints reach \[rad\].
const LIMITS: [[f64; 2]; 7] = [
    [-2.5, 1.2],
    [-0.3, 1.8],
    [-1.5, 1.5],
    [-2.3, 0.05],
    [-1.8, 1.8],
    [-0.8, 0.8],
    [-0.6, 0.6],
];

/// Postures within the limits at which a target is touched.
fn postures(truth: &Device, target: &Target, rows: usize, seed: u64) -> Vec<Vec<f64>> {
    let start = |attempt: u64| {
        let joints = (0_u64..).zip(LIMITS);
        let number = |joint: u64| 0.5 + 0.5 * pseudo_random(seed, 7 * attempt + joint);
        let readings = joints.map(|(joint, [low, high])| low + (high - low) * number(joint));
        readings.collect::<Vec<f64>>()
    };
    let is_within = |readings: &Vec<f64>| {
        let joints = readings.iter().zip(LIMITS);
        let mut inside = joints.map(|(reading, [low, high])| (low..=high).contains(reading));
        inside.all(|inside| inside)
    };
    let found = (0..20_000).filter_map(|attempt| touch(truth, &start(attempt), target));
    let found: Vec<Vec<f64>> = found.filter(is_within).take(rows).collect();
    assert_eq!(found.len(), rows, "the target is out of reach");
    found
}

/// Touches of sockets and of a plane.
fn touched(truth: &Device, seed: u64, has_plane: bool) -> Recording {
    let mut recording = plain(vec![Vec::new(); 7]);
    let sockets = [
        [0.28, 0.10, 0.12],
        [0.28, 0.30, 0.12],
        [0.10, 0.45, 0.30],
        [0.25, 0.15, 0.45],
    ];
    for (number, socket) in sockets.into_iter().enumerate() {
        let target = Target::Point(Vector3::from(socket));
        let rows = postures(truth, &target, 40, seed + number as u64);
        add_touches(&mut recording, &rows, &format!("s{number}"), false);
    }
    if has_plane {
        let target = Target::Plane(Vector3::new(0.03, -0.02, 1.0).normalize(), 0.12);
        let rows = postures(truth, &target, 150, seed + 9);
        add_touches(&mut recording, &rows, "table", true);
    }
    shaken(&mut recording, SD_RAD, seed + 20);
    recording
}

/// Distances between the handle's places at pairs of rows.
fn distances_m(device: &Device, recording: &Recording) -> Vec<f64> {
    let places = poses(device, recording);
    let pairs = places.iter().zip(places.iter().skip(45));
    let far = pairs.map(|(a, b)| (a.position_m - b.position_m).norm());
    far.collect()
}

#[test]
fn an_arm_with_its_lengths_along_the_axes_keeps_its_size() {
    let nominal = humanoid_arm();
    let truth = built(&nominal, 5);
    for (has_plane, sd_m) in [(true, None), (false, Some(1e-4)), (false, Some(1e-5))] {
        let recording = touched(&truth, 40, has_plane);
        let mut nominal = nominal.clone();
        nominal.surroundings.contact_sd_m = sd_m;
        let options = Options {
            held_out: HeldOut::None,
            ..Options::default()
        };
        let result = calibrate(&nominal, &recording, &options).unwrap();
        // upper arm or forearm, both of their numbers
        let said = result.warnings.join("\n");
        assert!(
            said.contains("b4 and d5 are held") || said.contains("a2 and d3 are held"),
            "{said}"
        );
        let contact = &result.fit_channels[0];
        assert!(
            (5e-5..1e-3).contains(&contact.rms_after),
            "{}",
            contact.rms_after
        );
        let readings = plain(recording.joint.clone());
        let [have, want] = [&result.device, &truth].map(|device| distances_m(device, &readings));
        let scale = have.iter().sum::<f64>() / want.iter().sum::<f64>();
        // the forearm's own deviation, of a quarter of a metre
        assert!((scale - 1.0).abs() < 0.015, "{scale}");
        for (have, want) in have.iter().zip(want) {
            assert!((have / scale - want).abs() < 2e-3, "{have} for {want}");
        }
    }
}

/// Forearm and elbow are two numbers, and the one that is held leaves its place to the other: the fit is drawn to a
/// device of no size, and says so instead of calling it perfect.
#[test]
fn a_device_that_shrinks_to_a_point_is_refused() {
    let nominal = humanoid_arm();
    let recording = touched(&built(&nominal, 5), 40, true);
    let device = prepare_device(&nominal, &recording).unwrap();
    let channels = channels(&device, &recording).unwrap();
    let weights = Weights::stated(&device, &channels);
    let mut parameters = candidate_parameters(&device);
    parameters.retain(|parameter| parameter.name(&device) != "b4");
    for starts in [0, 3] {
        let options = Options {
            starts,
            ..Options::default()
        };
        let (device, channels) = (&device, &channels);
        let fit = fit_parameters(&FitRequest {
            what: "arm",
            device,
            recording: &recording,
            channels,
            parameters: &parameters,
            unsupported: &[],
            weights: &weights,
            options: &options,
            start: None,
            yielded: None,
        });
        let refused = fit.map(|fit| (fit.cost, fit.starts)).unwrap_err();
        assert!(
            matches!(refused, CalibrationError::Collapsed { share, .. } if share < 0.1),
            "{refused}"
        );
        assert!(refused.is_unidentifiable());
        assert!(refused.to_string().contains("[[contact_pair]]"));
    }
}
