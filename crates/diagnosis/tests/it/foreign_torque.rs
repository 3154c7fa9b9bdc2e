//! A torque that has nothing to do with the arm, beside sound external encoders.

use haptical_diagnosis::{Diagnosis, Options, Verdict, diagnose};
use haptical_model::{Device, Recording};

use crate::mechanics::{FILE, Noise, Scene};

/// Rows of a scene.
const ROWS: usize = 3000;

/// Standard deviation of the external encoders \[rad\].
const OUTPUT_SD_RAD: f64 = 2e-4;

/// The whole diagnosis of a recording, to which sound external encoders are added.
fn diagnosed(recording: Recording) -> Diagnosis {
    diagnosed_with(recording, |_, _| 0.0)
}

/// The same with an error of them, by joint and row.
fn diagnosed_with(mut recording: Recording, error: impl Fn(usize, usize) -> f64) -> Diagnosis {
    let key = "encoder_counts_per_rev";
    let encoders = FILE.replace(
        key,
        &format!("external_encoder_sd_rad = {OUTPUT_SD_RAD}\n{key}"),
    );
    let device = Device::from_toml(&encoders, "arm").unwrap().device;
    let mut noise = Noise(99);
    let read = recording.joint.iter().enumerate().map(|(joint, angle)| {
        let noisy = angle
            .iter()
            .enumerate()
            .map(|(row, angle)| angle + OUTPUT_SD_RAD * noise.normal() + error(joint, row));
        Some(noisy.collect())
    });
    recording.output = read.collect();
    diagnose(&device, &recording, &Options::default()).unwrap()
}

/// A torque that has nothing to do with the arm, in the place of the recorded one.
fn with_a_foreign_torque(hertz: f64) -> Diagnosis {
    let mut scene = Scene::new(21, ROWS);
    let times = scene.time_s.clone();
    for (torque, time) in scene.torque_nm[2].iter_mut().zip(times) {
        *torque = 20.0 * (std::f64::consts::TAU * hertz * time).sin();
    }
    diagnosed(scene.record())
}

#[test]
fn a_torque_that_no_effect_explains_is_a_gap_of_the_device() {
    let clean = diagnosed(Scene::new(21, ROWS).record());
    assert_eq!(clean.verdict, Verdict::NoGap);
    assert!(clean.warnings.is_empty(), "{:?}", clean.warnings);

    let gap = with_a_foreign_torque(0.5);
    assert_eq!(gap.verdict, Verdict::Unknown, "{:?}", gap.causes);
    assert_eq!(gap.unexplained_share, 1.0);
    let place = gap.place.unwrap();
    assert_eq!((place.channel.as_str(), place.joint), ("torque3", Some(3)));
    let listed = gap
        .gap
        .channels
        .iter()
        .find(|channel| channel.channel == "torque3");
    let torque = listed.unwrap();
    assert!(
        torque.rms_before > 10.0 && torque.share_of_gap > 0.9,
        "{torque:?}"
    );
}

/// Between the rates of motion and sampling it passes for noise: then the torques are not called tested.
#[test]
fn a_torque_that_drowns_in_its_noise_is_not_called_tested() {
    let gap = with_a_foreign_torque(13.0);
    let warned = gap
        .warnings
        .iter()
        .any(|warning| warning.contains("torques were not tested"));
    assert!(
        warned || gap.verdict == Verdict::Unknown,
        "{:?}",
        gap.warnings
    );
}

/// A gap of an encoder that has no name takes no name off the torques, as it would not if the two were two views of other kinds.
#[test]
fn what_an_encoder_shows_without_a_name_takes_none_off_the_torques() {
    let mut scene = Scene::new(21, ROWS);
    for row in 0..ROWS {
        let rate = scene.rate(2, row);
        scene.torque_nm[2][row] += 0.05 * (rate / 0.05).tanh() + 0.02 * rate;
    }
    let recording = scene.record();
    let times = recording.time_s.clone().unwrap();
    let beats = |joint: usize, row: usize| match joint {
        0 => 3e-3 * (std::f64::consts::TAU * 0.7 * times[row]).sin(),
        _ => 0.0,
    };
    let alone = diagnosed(Scene::new(21, ROWS).record());
    assert_eq!(alone.verdict, Verdict::NoGap);
    let beating = diagnosed_with(Scene::new(21, ROWS).record(), beats);
    assert_eq!(beating.verdict, Verdict::Unknown, "{:?}", beating.causes);
    let mut left = Vec::new();
    for error in [&beats as &dyn Fn(usize, usize) -> f64, &|_, _| 0.0] {
        let found = diagnosed_with(recording.clone(), error);
        assert_eq!(found.verdict, Verdict::Named, "{:?}", found.warnings);
        let first = &found.causes[0];
        assert_eq!(
            (first.effect.as_str(), first.joint),
            ("joint-friction", Some(3))
        );
        let has_error = error(0, 10) != 0.0;
        let is_said = |own: &String| own.starts_with("out1 shows a gap that no cause explains");
        assert_eq!(found.warnings.iter().any(is_said), has_error, "{found:?}");
        // the torques explain a part of the gap
        assert_eq!(found.closed_unseen_share.is_some(), has_error, "{found:?}");
        left.push(found.unexplained_share);
        let place = found.place.unwrap();
        assert_eq!(place.channel, "torque3");
        assert_eq!(
            place.region.contains("positions show another gap"),
            has_error
        );
    }
    assert!(left[0] > left[1] + 0.05, "{left:?}");
}
