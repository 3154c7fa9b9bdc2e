//! Touches with a known distance: it alone tells the size of the device, whatever the touches' noise is.

use haptical_calibration::{
    Channel, DeviceProblem, FittedDevice, GaugedProblem, HeldOut, Options, Weights, calibrate,
    candidate_parameters, channels, fit_device, prepare_device,
};
use haptical_identification::{evaluate_jacobian, worst_derivative};
use haptical_model::kinematics::Convention;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::transmission::CapstanError;
use haptical_model::{
    ContactPair, Device, JointCompliance, ParameterId, Recording, TransmissionError,
};

use crate::rig_recovery::moved_within_sight;
use crate::rig_scene::{
    Target, add_touches, general, normal, plain, poses, readings, table, touch, two_points,
};

/// Touches of each point, and of the plane.
const TOUCHES: usize = 60;
/// Recordings of each kind.
const RECORDINGS: u64 = 24;

/// Where the sockets are: 50 mm and 200 mm from the first.
fn sockets(device: &Device) -> [Vector3<f64>; 3] {
    let [first, second] = two_points(device);
    [first, second, first + Vector3::new(-0.12, 0.1, 0.125)]
}

fn name(socket: usize) -> String {
    format!("s{socket}")
}

/// Touches whose places miss their target by independent errors.
fn touched(truth: &Device, sockets: &[Vector3<f64>], noise_m: f64, seed: u64) -> Recording {
    let joints = truth.joints.len();
    let mut recording = plain(vec![Vec::new(); joints]);
    for (number, socket) in sockets.iter().enumerate() {
        let seed = 10 * seed + number as u64;
        let starts = readings(truth, 20 * TOUCHES, 1.5, seed);
        let rows: Vec<Vec<f64>> = (0..20 * TOUCHES)
            .filter_map(|row| {
                let error = [0, 1, 2].map(|axis| normal(seed + 5000, 3 * row as u64 + axis));
                let place = socket + Vector3::from(error) * noise_m;
                let start: Vec<f64> = starts.iter().map(|column| column[row]).collect();
                touch(truth, &start, &Target::Point(place))
            })
            .take(TOUCHES)
            .collect();
        assert_eq!(rows.len(), TOUCHES, "the socket is out of reach");
        add_touches(&mut recording, &rows, &name(number), false);
    }
    recording
}

/// The device with the distance of two sockets, measured with an error.
fn with_pair(nominal: &Device, [a, b]: [usize; 2], distance_m: f64, sd_m: f64) -> Device {
    let mut device = nominal.clone();
    device.contact_pairs.push(ContactPair {
        a: name(a),
        b: name(b),
        distance_m,
        sd_m,
    });
    device
}

/// Mean distance of the handle's places at postures far from each other: a length that does not depend on which of
/// equal parameters a fit held.
fn extent_m(device: &Device) -> f64 {
    let places = poses(device, &plain(readings(device, 40, 1.2, 77)));
    let pairs = places.iter().zip(places.iter().skip(11));
    let far: Vec<f64> = pairs
        .map(|(a, b)| (a.position_m - b.position_m).norm())
        .collect();
    far.iter().sum::<f64>() / far.len() as f64
}

/// Standard deviation of the extent by the fit's covariance, its derivatives by differences.
fn extent_sd_m(fitted: &FittedDevice) -> f64 {
    let (parameters, covariance) = fitted.whole.as_ref().unwrap().uncertain();
    let slopes: Vec<f64> = parameters
        .iter()
        .map(|parameter| {
            let at = |step: f64| {
                let mut device = fitted.device.clone();
                parameter.set(&mut device, parameter.value(&fitted.device) + step);
                extent_m(&device)
            };
            (at(1e-6) - at(-1e-6)) / 2e-6
        })
        .collect();
    let mut variance = 0.0;
    for (a, left) in slopes.iter().enumerate() {
        for (b, right) in slopes.iter().enumerate() {
            variance += left * covariance[(a, b)] * right;
        }
    }
    variance.sqrt()
}

fn options() -> Options {
    Options {
        held_out: HeldOut::None,
        ..Options::default()
    }
}

/// Least squares of the touches as they are would make the device smaller, by 3 % for touches of 2 mm or by three
/// standard deviations for a distance known to 1 mm.
#[test]
fn the_size_s_error_is_what_the_distance_s_error_makes_it() {
    let nominal = table(5);
    let all = sockets(&nominal);
    for (other, sd_m, noise_m) in [
        (1, 2e-4, 5e-4),
        (1, 2e-4, 2e-3),
        (2, 1e-3, 5e-4),
        (2, 1e-3, 2e-3),
    ] {
        let distance_m = (all[0] - all[other]).norm();
        let (mut sum, mut square, mut relative) = (0.0, 0.0, 0.0);
        for seed in 1..=RECORDINGS {
            let error = sd_m * normal(900 + seed, 1);
            let mut stated = with_pair(&nominal, [0, other], distance_m + error, sd_m);
            stated.surroundings.contact_sd_m = Some(noise_m);
            let sketch = touched(&nominal, &all, noise_m, seed);
            let truth = moved_within_sight(&stated, &sketch, seed);
            let recording = touched(&truth, &all, noise_m, seed);
            let fitted = fit_device(&stated, &recording, &options()).unwrap();
            let (extent, truth) = (extent_m(&fitted.device), extent_m(&truth));
            let deviation = (extent - truth) / extent_sd_m(&fitted);
            relative += extent / truth - 1.0;
            sum += deviation;
            square += deviation * deviation;
        }
        let count = RECORDINGS as f64;
        let (mean, rms) = (sum / count, (square / count).sqrt());
        let shown = format!(
            "sd {sd_m}, noise {noise_m}: mean {mean:.2}, rms {rms:.2}, relative {:.4}",
            relative / count
        );
        println!("{shown}");
        assert!(mean.abs() < 3.0 / count.sqrt(), "{shown}");
        // chi-square with as many degrees of freedom as there are recordings, chances of 1e-3 on either side
        assert!((0.55..1.47).contains(&rms), "{shown}");
    }
}

/// Derivatives of touches in units of the mobility: both conventions, general rows, a transmission, joints that yield,
/// planes and several pairs.
#[test]
fn touches_in_units_of_the_mobility_have_their_derivatives() {
    let mut modified = table(4);
    modified.convention = Convention::Modified;
    for nominal in [table(4), modified, general()] {
        have_their_derivatives(&nominal);
    }
}

fn have_their_derivatives(nominal: &Device) {
    let [first, second] = two_points(nominal);
    let all = [first, second, first + Vector3::new(-0.06, 0.05, 0.08)];
    let mut device = with_pair(nominal, [0, 1], 0.04, 1e-3);
    device = with_pair(&device, [2, 1], 0.1, 5e-4);
    let capstan = CapstanError::from_array([0.01, 0.1, 4e-4, -3e-4, 2e-5, 1e-5]);
    device.joints[1].transmission_error = TransmissionError::Capstan(capstan);
    device.joints[1].transmission_ratio = 8.0;
    device.joints[1].drum_distance_m = Some(0.0675);
    device.surroundings.compliance = vec![
        JointCompliance {
            rad_per_nm: 1e-3,
            fit: true,
        };
        device.joints.len()
    ];
    let mut recording = touched(nominal, &all, 5e-3, 3);
    let rows: Vec<Vec<f64>> = (0..20)
        .map(|row| {
            recording
                .joint
                .iter()
                .map(|column| column[row] + 0.1)
                .collect()
        })
        .collect();
    add_touches(&mut recording, &rows, "table", true);
    for (joint, column) in recording.torque_nm.iter_mut().enumerate() {
        let torque = |row: usize| 10.0 * normal(joint as u64, row as u64);
        *column = Some((0..recording.line.len()).map(torque).collect());
    }
    let device = prepare_device(&device, &recording).unwrap();
    let mut parameters = candidate_parameters(&device);
    parameters.extend(device.transmission_parameters(1));
    let found = channels(&device, &recording).unwrap();
    assert!(found.contains(&Channel::Plane) && found.contains(&Channel::ContactPair { index: 1 }));
    let weights = Weights::stated(&device, &found);
    let problem = DeviceProblem::new(&device, &recording, &found, &parameters, &weights).unwrap();
    let all: Vec<usize> = (0..parameters.len()).collect();
    let gauged = GaugedProblem::new(&problem).unwrap();
    let (jacobian, _) = evaluate_jacobian(&gauged, &problem.start(), &all).unwrap();
    // a last joint whose axis goes through the handle has rounding for its derivative
    let is_seen = |column: &usize| {
        jacobian
            .column(*column)
            .iter()
            .any(|entry| entry.abs() > 1e-6)
    };
    let seen = all.into_iter().filter(is_seen);
    let parameters: Vec<ParameterId> = seen.map(|index| parameters[index]).collect();
    let problem = DeviceProblem::new(&device, &recording, &found, &parameters, &weights).unwrap();
    let gauged = GaugedProblem::new(&problem).unwrap();
    let worst = worst_derivative(&gauged, &problem.start(), 1e-5).unwrap();
    assert!(
        worst.relative < 2e-6,
        "{}: {} for {}",
        parameters[worst.parameter].name(&device),
        worst.analytic,
        worst.numeric
    );
}

/// Two distances of which one is wrong by two centimetres: the fit cannot have both.
#[test]
fn a_pair_that_the_fit_contradicts_is_named() {
    let nominal = table(5);
    let all = sockets(&nominal);
    let recording = touched(&nominal, &all, 1e-4, 3);
    let mut device = nominal;
    device.surroundings.contact_sd_m = Some(1e-4);
    for (pair, error_m) in [([0, 1], 0.0), ([0, 2], 0.02)] {
        let distance_m = (all[pair[0]] - all[pair[1]]).norm();
        device = with_pair(&device, pair, distance_m + error_m, 1e-3);
    }
    let said = |device: &Device| {
        let result = calibrate(device, &recording, &options()).unwrap();
        let of_pairs = result.warnings.into_iter();
        let of_pairs = of_pairs.filter(|warning| warning.contains("contact-pair"));
        of_pairs.collect::<Vec<String>>()
    };
    assert!(
        said(&device)
            .iter()
            .any(|warning| warning.contains("from the stated one"))
    );
    device.contact_pairs[1].distance_m -= 0.02;
    assert!(said(&device).is_empty());
}
