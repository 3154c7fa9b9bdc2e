//! The scale of an instrument is in the intervals of the lengths that rest on it.

use haptical_calibration::{Calibration, HeldOut, Options, ParameterFit, calibrate};
use haptical_model::{Cable, Device, Parameter, ParameterId, Recording, Tracker};
use haptical_simulator::{Noise, true_poses};

use crate::chain::pseudo_random;
use crate::haptic;

/// Every length of the rows that was identified, in half widths of its interval off the truth.
fn lengths_off(calibration: &Calibration, truth: &Device) -> Vec<(String, f64)> {
    let whole = calibration.fitted.whole.as_ref().unwrap();
    let each = whole.parameters.iter().zip(&whole.estimates);
    let off = each.filter_map(|(parameter, estimate)| {
        let ParameterId::Link {
            parameter: Parameter::A | Parameter::B | Parameter::D,
            ..
        } = parameter
        else {
            return None;
        };
        let [low, high] = estimate.ci95?;
        let half_width = (high - low) / 2.0;
        let error = (low + high) / 2.0 - parameter.value(truth);
        Some((estimate.name.clone(), (error / half_width).abs()))
    });
    off.collect()
}

fn identified(device: &Device, recording: &Recording) -> Calibration {
    let options = Options {
        held_out: HeldOut::None,
        ..Options::default()
    };
    calibrate(device, recording, &options).unwrap()
}

fn worst(off: &[(String, f64)]) -> f64 {
    off.iter().map(|(_, off)| *off).fold(0.0, f64::max)
}

/// A drum that is 0.1 % too small made every distance 0.1 % too long: a0 was 126 half widths off without a word.
#[test]
fn a_drum_that_is_off_is_within_the_lengths_intervals() {
    let Some(mut nominal) = haptic::haptic7() else {
        return;
    };
    let truth = haptic::truth_of(&nominal, 1.0);
    let mut recording = haptic::record(&truth, 400, 3, Noise::Gaussian);
    for reading in recording.cable_m[0].as_mut().unwrap() {
        *reading *= 1.001;
    }
    nominal.cables[0].scale_sd = None;
    let assumed = identified(&nominal, &recording);
    let off = lengths_off(&assumed, &truth);
    assert!(off.len() > 8 && worst(&off) < 1.1, "{off:?}");
    let scales = assumed.fitted.whole.as_ref().unwrap().intervals();
    assert_eq!(scales.length_scales.len(), 1);
    assert_eq!(scales.length_scales[0].name, "cable_scale");
    assert!(
        !scales.length_scales[0].is_stated
            && !scales.considered.contains(&"cable_scale".to_owned())
    );
    // a drum that is stated to be exact gives what the noise does
    nominal.cables[0].scale_sd = Some(0.0);
    let exact = identified(&nominal, &recording);
    let off = lengths_off(&exact, &truth);
    assert!(worst(&off) > 10.0, "{off:?}");
    let intervals = exact.fitted.whole.as_ref().unwrap().intervals();
    assert!(intervals.length_scales.is_empty());
    // values are the same, and so is what the data fix: a scale takes no parameter's partner away
    assert_eq!(
        assumed.fitted.whole.as_ref().unwrap().fitted,
        exact.fitted.whole.as_ref().unwrap().fitted
    );
    let sums = |calibration: &Calibration| {
        let sums = calibration.fitted.whole.as_ref().unwrap().combinations();
        sums.iter().map(|sum| sum.terms.len()).collect::<Vec<_>>()
    };
    assert_eq!(sums(&assumed), sums(&exact));
}

/// A tracker reads all lengths by the same share too long, that of its own place included. The interval of each is
/// the length times the scale's, by a device that is larger as a whole; angles stay as they are.
#[test]
fn a_tracker_s_scale_widens_each_length_by_its_share() {
    let Some(mut device) = haptic::haptic7() else {
        return;
    };
    device.cables.clear();
    for joint in &mut device.joints {
        joint.transmission = haptical_model::TransmissionKind::Direct;
        joint.external_encoder_sd_rad = None;
        joint.external_encoder_counts_per_rev = None;
    }
    let mut device = haptic::exact_readings(device);
    device.tracker = Some(Tracker {
        base_known: true,
        tool_known: true,
        position_sd_m: Some(1e-5),
        rotation_sd_rad: None,
        scale_sd: Some(2e-3),
    });
    let mut recording = haptic::record(&device, 300, 7, Noise::None);
    recording.cable_m.clear();
    let poses = true_poses(&device, &recording).unwrap();
    recording.position_m = Some([0, 1, 2].map(|axis| {
        let noise = |row: usize| 1e-5 * pseudo_random(9, (3 * row + axis) as u64);
        let rows = poses.iter().enumerate();
        rows.map(|(row, pose)| pose.position_m[axis] + noise(row))
            .collect()
    }));
    let stated = identified(&device, &recording);
    device.tracker.as_mut().unwrap().scale_sd = Some(0.0);
    let exact = identified(&device, &recording);
    let (stated, exact) = (stated.fitted.whole.unwrap(), exact.fitted.whole.unwrap());
    let mut lengths = 0;
    for &index in &stated.fitted {
        let own = |fit: &ParameterFit| fit.estimates[index].standard_deviation.unwrap();
        let added = (own(&stated).powi(2) - own(&exact).powi(2)).max(0.0).sqrt();
        let value = stated.estimates[index].value.unwrap();
        if stated.estimates[index].unit == "m" {
            lengths += 1;
            assert!(
                (added - 2e-3 * value.abs()).abs() < 0.02 * 2e-3 * value.abs() + 2e-6,
                "{}: {added} of {value}",
                stated.estimates[index].name
            );
        } else {
            assert!(added < 2e-5, "{}: {added}", stated.estimates[index].name);
        }
    }
    assert!(lengths > 8, "{lengths} lengths");
}

/// Two cables tell the difference of their scales, and neither the sum: the intervals count what is left, and noise is
/// not taken for scale.
#[test]
fn two_cables_share_what_they_do_not_tell() {
    let Some(mut nominal) = haptic::haptic7() else {
        return;
    };
    let second = Cable {
        anchor_m: [0.4, 0.1, 0.3],
        ..nominal.cables[0]
    };
    nominal.cables.push(second);
    let truth = haptic::truth_of(&nominal, 1.0);
    let recording = haptic::record(&truth, 400, 5, Noise::Gaussian);
    let exact = identified(&nominal, &recording);
    for cable in &mut nominal.cables {
        cable.scale_sd = Some(1e-3);
    }
    let assumed = identified(&nominal, &recording);
    let (exact, assumed) = (exact.fitted.whole.unwrap(), assumed.fitted.whole.unwrap());
    assert_eq!(exact.fitted, assumed.fitted);
    let mut angles = 0;
    for &index in &assumed.fitted {
        let sd = |fit: &ParameterFit| fit.estimates[index].standard_deviation.unwrap();
        let ratio = sd(&assumed) / sd(&exact);
        assert!(ratio > 0.98, "{}: {ratio}", assumed.estimates[index].name);
        if assumed.estimates[index].unit == "rad" {
            angles += 1;
            assert!(ratio < 1.3, "{}: {ratio}", assumed.estimates[index].name);
        }
    }
    assert!(angles > 20, "{angles}");
    // a0 is off by the scale of both, less what the known distance of their anchors tells of it
    let a0 = assumed
        .estimates
        .iter()
        .find(|estimate| estimate.name == "a0")
        .unwrap();
    let share = a0.standard_deviation.unwrap() / a0.value.unwrap();
    assert!((1e-4..9e-4).contains(&share), "{share}");
}

/// `theta1` and `d0` are one turn about the cable's exit, of d0 / a0: a0 is known to the scale, and with it the factor.
#[test]
fn a_combination_counts_the_scale_of_its_factor() {
    let Some(mut nominal) = haptic::haptic7() else {
        return;
    };
    let truth = haptic::truth_of(&nominal, 1.0);
    let recording = haptic::record(&truth, 400, 3, Noise::Gaussian);
    let mut turn = |scale_sd: f64| {
        nominal.cables[0].scale_sd = Some(scale_sd);
        let fit = identified(&nominal, &recording).fitted.whole.unwrap();
        let sums = fit.combinations();
        let sum = sums
            .iter()
            .find(|sum| sum.terms[0].name == "theta1")
            .unwrap();
        sum.standard_deviation
    };
    let (exact, known) = (turn(0.0), turn(4e-3));
    let added = (known.powi(2) - exact.powi(2)).sqrt();
    let expected = 5e-3 * 4e-3 / 0.25;
    assert!((added / expected - 1.0).abs() < 0.15, "{added} {expected}");
}
