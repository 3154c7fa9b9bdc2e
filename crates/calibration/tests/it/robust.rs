//! Wild readings: they move nothing, they are named, and without them nothing changes.

use haptical_calibration::{
    CalibrationMethod, Channel, FittedDevice, LossChoice, Options, calibrate, fit_device,
    with_ordered_noise,
};
use haptical_identification::Loss;
use haptical_model::{Device, Recording};
use haptical_simulator::Noise;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::haptic;

fn options(method: CalibrationMethod, loss: LossChoice) -> Options {
    Options {
        method,
        loss,
        ..Options::default()
    }
}

/// A fifth of the distances off by 5 to 200 mm, on both sides or one; the lines that were spoilt.
fn spoil(recording: &Recording, seed: u64, one_sided: bool) -> (Recording, Vec<u64>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut dirty = recording.clone();
    let mut lines = Vec::new();
    for row in 0..recording.len() {
        if random.random_bool(0.2) {
            let sign = if one_sided || random.random_bool(0.5) {
                1.0
            } else {
                -1.0
            };
            let size_m = random.random_range(5e-3..0.2);
            if let Some(distances) = &mut dirty.cable_m[0] {
                distances[row] = (distances[row] + sign * size_m).max(0.01);
            }
            lines.push(recording.line[row]);
        }
    }
    (dirty, lines)
}

fn recorded(rows: usize, seed: u64) -> Option<(Device, Recording)> {
    let nominal = haptic::haptic7()?;
    let truth = haptic::truth_of(&nominal, 1.0);
    let recording = haptic::record(&truth, rows, seed, Noise::Gaussian);
    Some((nominal, recording))
}

/// Largest move of a parameter, in its clean standard deviations, over those that both fits state.
fn largest_move(clean: &FittedDevice, other: &FittedDevice) -> f64 {
    let fits = |fitted: &FittedDevice| {
        let steps = fitted
            .transmissions
            .iter()
            .filter_map(|step| step.fit.clone());
        let whole = fitted.whole.clone();
        let all: Vec<_> = steps.chain(whole).collect();
        all.into_iter()
            .flat_map(|fit| fit.estimates)
            .collect::<Vec<_>>()
    };
    let (clean, other) = (fits(clean), fits(other));
    assert_eq!(clean.len(), other.len());
    let mut largest: f64 = 0.0;
    for (a, b) in clean.iter().zip(&other) {
        assert_eq!(a.name, b.name);
        assert_eq!(a.value.is_some(), b.value.is_some(), "{}", a.name);
        if let (Some(a_value), Some(b_value), Some(deviation)) =
            (a.value, b.value, a.standard_deviation)
        {
            largest = largest.max((a_value - b_value).abs() / deviation);
        }
    }
    largest
}

#[test]
fn a_fifth_of_wild_distances_moves_no_parameter() {
    // weights of the longest are found on some of its rows
    for (rows, seed) in [(200, 1), (200, 2), (1500, 3), (6000, 4)] {
        let Some((nominal, recording)) = recorded(rows, seed) else {
            return;
        };
        for method in [CalibrationMethod::Joint, CalibrationMethod::TwoStep] {
            let squares = options(method, LossChoice::Fixed(Loss::Squares));
            let clean = fit_device(&nominal, &recording, &squares).unwrap();
            for one_sided in [true, false] {
                let (dirty, lines) = spoil(&recording, 10 + seed, one_sided);
                let robust =
                    fit_device(&nominal, &dirty, &options(method, LossChoice::Auto)).unwrap();
                let moved = largest_move(&clean, &robust);
                println!("{rows} rows, {method:?}, one-sided {one_sided}: {moved:.2}");
                assert!(moved < 3.0, "{rows} rows, {method:?}: {moved}");
                let found = robust.robust.unwrap();
                assert!(found.settled && found.loss == Loss::Tukey);
                let named: Vec<u64> = found.outliers.iter().map(|outlier| outlier.line).collect();
                assert!(lines.iter().all(|line| named.contains(line)));
                assert!(
                    named.len() <= lines.len() + 1,
                    "{} of {}",
                    named.len(),
                    lines.len()
                );
                assert!(
                    found
                        .outliers
                        .iter()
                        .all(|outlier| outlier.channel == Channel::Cable { index: 0 })
                );
            }
        }
    }
}

#[test]
fn every_loss_withstands_them_better_than_squares() {
    let Some((nominal, recording)) = recorded(400, 5) else {
        return;
    };
    let method = CalibrationMethod::Joint;
    let squares = options(method, LossChoice::Fixed(Loss::Squares));
    let clean = fit_device(&nominal, &recording, &squares).unwrap();
    let (dirty, _) = spoil(&recording, 6, false);
    for (loss, allowed) in [
        (Loss::Tukey, 3.0),
        (Loss::Cauchy, 3.0),
        (Loss::StudentT, 3.0),
        (Loss::Huber, 8.0),
    ] {
        let robust =
            fit_device(&nominal, &dirty, &options(method, LossChoice::Fixed(loss))).unwrap();
        let moved = largest_move(&clean, &robust);
        println!("{loss}: {moved:.2}");
        assert!(moved < allowed, "{loss}: {moved}");
    }
}

#[test]
fn without_wild_readings_the_automatic_choice_is_least_squares() {
    for seed in 20..24 {
        let Some((nominal, recording)) = recorded(300, seed) else {
            return;
        };
        let method = CalibrationMethod::Joint;
        let squares = options(method, LossChoice::Fixed(Loss::Squares));
        let automatic = options(method, LossChoice::Auto);
        let plain = fit_device(&nominal, &recording, &squares).unwrap();
        let found = fit_device(&nominal, &recording, &automatic).unwrap();
        assert_eq!(found.device, plain.device);
        assert_eq!(found.robust, None);
    }
}

#[test]
fn wild_readings_are_named_and_set_aside_in_the_held_out_figures() {
    let Some((nominal, recording)) = recorded(400, 31) else {
        return;
    };
    let (dirty, lines) = spoil(&recording, 32, false);
    let options = options(CalibrationMethod::Joint, LossChoice::Auto);
    let found = calibrate(&nominal, &dirty, &options).unwrap();
    let named: Vec<u64> = found.outliers.iter().map(|outlier| outlier.line).collect();
    assert!(lines.iter().all(|line| named.contains(line)));
    let reports = [&found.fit_channels, &found.held_out_channels];
    let cables = reports.map(|reports| {
        reports
            .iter()
            .find(|report| report.channel == "cable")
            .unwrap()
    });
    assert_eq!(cables[0].outliers + cables[1].outliers, named.len());
    for cable in cables {
        assert!(cable.outliers > 5);
        assert!(cable.rms_after > 20.0 * cable.noise_floor);
        assert!(cable.rms_after_good < 1.5 * cable.noise_floor);
    }
    let words = found.warnings.join("\n");
    assert!(
        words.contains("farther from the model than noise explains"),
        "{words}"
    );
    assert!(!words.contains("times the noise floor"), "{words}");
}

/// Adds 10 mm to the distances of chosen rows.
fn shifted(recording: &Recording, is_wild: impl Fn(usize) -> bool) -> Recording {
    let mut dirty = recording.clone();
    for row in (0..recording.len()).filter(|&row| is_wild(row)) {
        if let Some(distances) = &mut dirty.cable_m[0] {
            distances[row] += 0.01;
        }
    }
    dirty
}

/// Equal errors bend the fit of least squares until none of them stands out.
#[test]
fn equal_wild_readings_are_found_although_they_hide() {
    let Some((nominal, recording)) = recorded(1000, 41) else {
        return;
    };
    let method = CalibrationMethod::Joint;
    let squares = options(method, LossChoice::Fixed(Loss::Squares));
    let clean = fit_device(&nominal, &recording, &squares).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(42);
    let wild: Vec<bool> = (0..1000).map(|_| random.random_bool(0.2)).collect();
    let dirty = shifted(&recording, |row| wild[row]);
    let found = fit_device(&nominal, &dirty, &options(method, LossChoice::Auto)).unwrap();
    assert!(largest_move(&clean, &found) < 3.0);
}

/// A shift that lasts is an effect (a lost count, say): its rows are no single wild readings.
#[test]
fn a_shift_that_lasts_stays_with_least_squares() {
    let Some((nominal, recording)) = recorded(1000, 43) else {
        return;
    };
    let dirty = shifted(&recording, |row| row >= 800);
    let method = CalibrationMethod::Joint;
    let squares = options(method, LossChoice::Fixed(Loss::Squares));
    let plain = fit_device(&nominal, &dirty, &squares).unwrap();
    let found = fit_device(&nominal, &dirty, &options(method, LossChoice::Auto)).unwrap();
    assert_eq!(found.robust, None);
    assert_eq!(found.device, plain.device);
}

/// Largest factor on a standard deviation by which the floor of sizes of their own widens the joint fit of Tukey's loss.
fn widened(nominal: &Device, recording: &Recording) -> (f64, bool) {
    let options = options(CalibrationMethod::Joint, LossChoice::Fixed(Loss::Tukey));
    let fitted = fit_device(nominal, recording, &options).unwrap();
    let usual = FittedDevice {
        robust: None,
        ..fitted.clone()
    };
    let [usual, found] =
        [usual, fitted].map(|fit| with_ordered_noise(fit, recording, options.method).unwrap());
    let [usual, found] = [usual, found].map(|fitted| fitted.whole.unwrap());
    let mut largest: f64 = 0.0;
    for &index in &usual.fitted {
        let [before, after] = [&usual, &found].map(|fit| &fit.estimates[index]);
        let pair = (before.standard_deviation, after.standard_deviation);
        let (Some(before), Some(after)) = pair else {
            continue;
        };
        assert!(after > 0.999 * before, "{}", found.estimates[index].name);
        largest = largest.max(after / before);
    }
    (largest, found.is_widened)
}

/// Noise of the longest fifth of the distances twelve times larger, half of them one way and half the other.
#[test]
fn intervals_are_wider_where_long_distances_are_louder() {
    for seed in 60..66 {
        let Some((nominal, mut recording)) = recorded(300, seed) else {
            return;
        };
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let sd_m = nominal.cable_sd_m(0).unwrap();
        let distances = recording.cable_m[0].as_mut().unwrap();
        let mut sorted = distances.clone();
        sorted.sort_by(f64::total_cmp);
        for distance in distances.iter_mut().filter(|own| **own > sorted[240]) {
            // uniform, of this standard deviation
            *distance += 12.0 * sd_m * random.random_range(-3_f64.sqrt()..3_f64.sqrt());
        }
        let (largest, is_widened) = widened(&nominal, &recording);
        assert!(is_widened && largest > 1.3, "{seed}: {largest}");
    }
    let Some((nominal, recording)) = recorded(300, 64) else {
        return;
    };
    let (largest, _) = widened(&nominal, &spoil(&recording, 65, false).0);
    assert!(largest < 1.3, "of one size: {largest}");
}
