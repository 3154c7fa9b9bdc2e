//! A curve of a device file: what it adds, what is refused of it, and that no catalogue has it.

use haptical_effects::correction::NAME;
use haptical_effects::device::{attached, effects_of};
use haptical_effects::{catalogue, drive_catalogue, names};
use haptical_model::{Device, Recording};

/// A joint with an external encoder, and a table of an effect.
fn device(effect: &str) -> Device {
    let joint = "[[joint]]\ntransmission = \"capstan\"\ntransmission_ratio = 8.0\ndrum_distance_m = 0.07\n\
                 external_encoder_sd_rad = 1e-4\n";
    let text = format!("{joint}\n[[effect]]\nname = \"correction\"\n{effect}");
    Device::from_toml(&text, "one.toml").unwrap().device
}

fn recording() -> Recording {
    let reading: Vec<f64> = (0..200).map(|row| (0.05 * f64::from(row)).sin()).collect();
    Recording {
        line: (2..202).collect(),
        time_s: Some((0..200).map(|row| 0.01 * f64::from(row)).collect()),
        output: vec![Some(reading.clone())],
        joint: vec![reading],
        torque_nm: vec![None],
        temperature_degc: Some((0..200).map(|row| 20.0 + 0.01 * f64::from(row)).collect()),
        ..Recording::default()
    }
}

/// Coefficients of a x^2 over -1 to 1 with `count` splines: the knots' squares less a third of their distance's (Marsden 1970).
fn square(a: f64, count: usize) -> Vec<f64> {
    let width = 2.0 / (count - 3) as f64;
    let knot = |index: usize| -1.0 + width * (index as f64 - 1.0);
    (0..count)
        .map(|index| a * (knot(index).powi(2) - width * width / 3.0))
        .collect()
}

fn added(device: &Device) -> Vec<f64> {
    let mut device = device.clone();
    let recording = recording();
    let with = attached(&mut device, &recording).unwrap();
    let out = with.added.iter().find(|own| own.channel == "out1").unwrap();
    out.readings.clone()
}

#[test]
fn a_square_over_the_joints_angle_is_that_square() {
    for count in [4, 5, 43] {
        let text = format!(
            "joint = 1\nfrom_rad = -1.0\nto_rad = 1.0\ncoefficients_rad = {:?}",
            square(2e-3, count)
        );
        let recording = recording();
        for (angle, own) in recording.joint[0].iter().zip(added(&device(&text))) {
            assert!(
                (own - 2e-3 * angle * angle).abs() < 1e-15,
                "{count} {angle} {own}"
            );
        }
    }
}

/// Temperatures of a device file count from zero, not from the recording's mean.
#[test]
fn a_line_over_the_temperature_is_that_line() {
    let knots = [20.0 - 2.0, 20.0, 22.0, 24.0].map(|degc| 1e-4 * degc);
    let text = format!("joint = 1\nfrom_degc = 20.0\nto_degc = 22.0\ncoefficients_rad = {knots:?}");
    let own = added(&device(&text));
    // smoothed over a second: far from the ends a line stays one
    for row in [60, 100, 140] {
        let degc = 20.0 + 0.01 * row as f64;
        assert!((own[row] - 1e-4 * degc).abs() < 1e-12, "{row}");
    }
}

#[test]
fn it_is_in_no_catalogue() {
    let device = device(
        "joint = 1\nfrom_rad = -1.0\nto_rad = 1.0\ncoefficients_rad = [0.0, 0.0, 0.0, 1e-3]",
    );
    assert!(!names().contains(&NAME));
    let mut all = catalogue(&device);
    all.extend(drive_catalogue(&device));
    assert!(all.iter().all(|effect| effect.name() != NAME));
}

#[test]
fn what_it_lacks_is_said() {
    let four = "coefficients_rad = [0.0, 0.0, 0.0, 1e-3]";
    for (text, wanted) in [
        (
            format!("from_rad = -1.0\nto_rad = 1.0\n{four}"),
            "give `joint`",
        ),
        (format!("joint = 1\n{four}"), "has no `from_rad`"),
        (
            format!("joint = 1\nfrom_rad = -1.0\n{four}"),
            "has no `to_rad`",
        ),
        (
            format!("joint = 1\nfrom_rad = 1.0\nto_rad = -1.0\n{four}"),
            "above the other end",
        ),
        (
            "joint = 1\nfrom_rad = -1.0\nto_rad = 1.0".to_owned(),
            "has no `coefficients_rad`",
        ),
        (
            "joint = 1\nfrom_rad = -1.0\nto_rad = 1.0\ncoefficients_rad = [0.0]".to_owned(),
            "has 1 numbers",
        ),
        (
            "joint = 1\nfrom_rad = -1.0\nto_rad = 1.0\ncoefficients_m = [0.0, 0.0, 0.0, 0.0]"
                .to_owned(),
            "has no parameter `coefficients_m`",
        ),
        (
            format!("joint = 1\nfrom_rad = -1.0\nto_rad = 1.0\nwidth = 1.0\n{four}"),
            "has no parameter `width`",
        ),
        (
            format!("joint = 1\nfrom_rad = -1.0\nto_rad = 1.0\nfit = true\n{four}"),
            "no calibration fits it",
        ),
    ] {
        let error = effects_of(&device(&text))
            .err()
            .map(|error| error.to_string());
        assert!(
            error.as_ref().is_some_and(|error| error.contains(wanted)),
            "{text}: {error:?}"
        );
    }
    // another effect has no list
    let text = "[[joint]]\n[[effect]]\nname = \"backlash\"\njoint = 1\nwidth_rad = 1e-3\ncoefficients_rad = [1.0]\n";
    let other = Device::from_toml(text, "one.toml").unwrap().device;
    assert!(effects_of(&other).is_err());
}
