//! Noise of the recordings: sizes, colour, outliers, rounding.

use xtask_blind::{MotionPlan, NOMINALS, NoisePlan, Recorded, Scene};

fn recorded(change: impl Fn(&mut NoisePlan)) -> Recorded {
    let device = NOMINALS[0].device().expect("a device");
    let scene = Scene::draw(&device, &MotionPlan::default(), 12).expect("a scene");
    let mut plan = NoisePlan::white(device.joints.len());
    change(&mut plan);
    let scales = vec![1.0; device.joints.len()];
    scene.record(&[], &plan, &scales).expect("a recording")
}

/// Noise of external encoder 2 over its stated standard deviation.
fn noise(recorded: &Recorded) -> Vec<f64> {
    let read = recorded.log.output[1].as_ref().expect("readings");
    let clean = recorded.clean.output_rad[1].as_ref().expect("truth");
    let sd = std::f64::consts::TAU / 20_000.0 / 3.0;
    read.iter()
        .zip(clean)
        .map(|(read, clean)| (read - clean) / sd)
        .collect()
}

fn variance(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64
}

/// 6000 normal numbers: the variance is known to sqrt(2/6000), a correlation to 1/sqrt(6000); five
/// times that is not met by chance.
const FIVE_SD_VARIANCE: f64 = 0.092;
const FIVE_SD_CORRELATION: f64 = 0.065;

fn correlation(values: &[f64]) -> f64 {
    let products: f64 = values.windows(2).map(|pair| pair[0] * pair[1]).sum();
    products / values.iter().map(|value| value * value).sum::<f64>()
}

#[test]
fn white_noise_has_the_stated_size() {
    let noise = noise(&recorded(|_| {}));
    assert!((variance(&noise) - 1.0).abs() < FIVE_SD_VARIANCE);
    assert!(correlation(&noise).abs() < FIVE_SD_CORRELATION);
}

#[test]
fn coloured_noise_keeps_its_size() {
    let noise = noise(&recorded(|plan| plan.output[1].autoregression = 0.5));
    // AR(1) at 0.5: the variance is known less well by sqrt((1 + 0.25) / (1 - 0.25))
    assert!((variance(&noise) - 1.0).abs() < 1.3 * FIVE_SD_VARIANCE);
    assert!((correlation(&noise) - 0.5).abs() < FIVE_SD_CORRELATION);
}

#[test]
fn factor_and_outliers_and_rounding_act_on_their_channel() {
    let loud = noise(&recorded(|plan| plan.output[1].factor = 2.0));
    assert!((variance(&loud) / 4.0 - 1.0).abs() < FIVE_SD_VARIANCE);
    let other = noise(&recorded(|plan| plan.output[0].factor = 2.0));
    assert!((variance(&other) - 1.0).abs() < FIVE_SD_VARIANCE);

    let wild = noise(&recorded(|plan| plan.output[1].outlier_share = 0.02));
    let far = wild.iter().filter(|value| value.abs() > 4.5).count() as f64 / 6000.0;
    // of the 2 % with 8.06 standard deviations 57 % are beyond 4.5
    assert!((0.008..0.015).contains(&far), "{far}");

    let rounded = recorded(|plan| plan.output[1].rounded = true);
    let count = std::f64::consts::TAU / 20_000.0;
    let read = rounded.log.output[1].as_ref().expect("readings");
    // the log keeps seven digits
    assert!(
        read.iter()
            .all(|value| (value / count - (value / count).round()).abs() < 1e-3)
    );
}

#[test]
fn motor_readings_are_whole_counts() {
    let recorded = recorded(|_| {});
    for (joint, ratio) in [(0, 8.0), (3, 12.0), (6, 1.0)] {
        let count = std::f64::consts::TAU / 20_000.0 / ratio;
        let whole = |value: &f64| (value / count - (value / count).round()).abs() < 3e-3;
        assert!(recorded.log.joint[joint].iter().all(whole), "joint {joint}");
    }
}
