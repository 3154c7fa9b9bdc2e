//! A torque that has nothing to do with the arm, beside sound external encoders.

use haptical_diagnosis::{Diagnosis, Options, Verdict, diagnose};
use haptical_model::{Device, Recording};

use crate::mechanics::{FILE, Noise, Scene};

/// Rows of a scene.
const ROWS: usize = 3000;

/// Standard deviation of the external encoders \[rad\].
const OUTPUT_SD_RAD: f64 = 2e-4;

/// The whole diagnosis of a recording, to which sound external encoders are added.
fn diagnosed(mut recording: Recording) -> Diagnosis {
    let key = "encoder_counts_per_rev";
    let encoders = FILE.replace(
        key,
        &format!("external_encoder_sd_rad = {OUTPUT_SD_RAD}\n{key}"),
    );
    let device = Device::from_toml(&encoders, "arm").unwrap().device;
    let mut noise = Noise(99);
    let read = recording.joint.iter().map(|angle| {
        let noisy = angle
            .iter()
            .map(|angle| angle + OUTPUT_SD_RAD * noise.normal());
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
