//! Normal noise of the external encoders and the cables against its formulas.

use std::f64::consts::TAU;

use haptical_simulator::model::{Device, Recording};
use haptical_simulator::{CableSigma, Noise, Settings, simulate, simulate_transmission};

use crate::device::arm;
use crate::statistics::{
    assert_centred, assert_uncorrelated, assert_uniform, differences, normal_cdf,
};

const ROWS: usize = 20_000;

/// Recording without noise at the same poses.
fn quiet(truth: &Device, settings: &Settings, seed: u64) -> Recording {
    let settings = Settings {
        output_noise: Noise::None,
        cable_noise: Noise::None,
        ..*settings
    };
    simulate(truth, &settings, ROWS, seed).expect("a recording")
}

fn noise(noisy: &[Option<Vec<f64>>], quiet: &[Option<Vec<f64>>], index: usize) -> Vec<f64> {
    let column = |columns: &[Option<Vec<f64>>]| columns[index].clone().expect("the column");
    differences(&column(noisy), &column(quiet))
}

#[track_caller]
fn assert_normal(noise: &[f64], sd: f64, what: &str) {
    assert_centred(noise, sd, what);
    let shares: Vec<f64> = noise.iter().map(|x| normal_cdf(x / sd)).collect();
    assert_uniform(&shares, what);
}

#[test]
fn external_encoders_have_the_stated_sd_or_a_third_of_a_count() {
    let (truth, settings) = (arm(), Settings::paper());
    let noisy = simulate(&truth, &settings, ROWS, 21).expect("a recording");
    let quiet = quiet(&truth, &settings, 21);
    // sigma_e = 2 pi / 20000 / 3 = 1.0472e-4 where nothing is stated
    let sds = [1.047_197_551_196_597_6e-4, 1.2e-4, 2e-5];
    let noises: Vec<Vec<f64>> = (0..3)
        .map(|j| noise(&noisy.output, &quiet.output, j))
        .collect();
    for (joint, sd) in sds.into_iter().enumerate() {
        assert_normal(&noises[joint], sd, "external encoder");
    }
    let cables: Vec<Vec<f64>> = (0..2)
        .map(|c| noise(&noisy.cable_m, &quiet.cable_m, c))
        .collect();
    for (a, b) in [
        (&noises[0], &noises[1]),
        (&noises[1], &noises[2]),
        (&noises[0], &cables[0]),
        (&noises[1], &cables[1]),
        (&cables[0], &cables[1]),
        (&noises[0], &noisy.joint[0]),
    ] {
        assert_uncorrelated(a, b, "two channels");
    }
    let first = &noises[0];
    assert_uncorrelated(&first[1..], &first[..ROWS - 1], "two rows");
    assert_eq!(
        noisy.output[3], None,
        "direct and without an external encoder"
    );
}

#[test]
fn cables_have_the_sd_that_is_asked_for() {
    let truth = arm();
    // by hand: R_d = 0.015 and 0.02 m, 20000 and 10000 counts
    for (sigma, sds) in [
        (CableSigma::Stated, [2e-5, 4e-5]),
        (CableSigma::Printed, [9.869_604_4e-6, 2.631_894_5e-5]),
        (CableSigma::Geometric, [1.570_796_3e-6, 4.188_790_2e-6]),
    ] {
        let settings = Settings {
            cable_sigma: sigma,
            ..Settings::paper()
        };
        let noisy = simulate(&truth, &settings, ROWS, 22).expect("a recording");
        let quiet = quiet(&truth, &settings, 22);
        for (cable, sd) in sds.into_iter().enumerate() {
            let noise = noise(&noisy.cable_m, &quiet.cable_m, cable);
            assert_normal(&noise, sd, &format!("{sigma:?}, cable {cable}"));
        }
    }
}

#[test]
fn noise_of_one_transmission_is_that_of_the_encoder_and_not_repeated() {
    let (truth, settings) = (arm(), Settings::paper());
    let silent = Settings {
        output_noise: Noise::None,
        ..settings
    };
    let alone = |settings| {
        let recording = simulate_transmission(&truth, settings, 1, ROWS, 23);
        recording.expect("a recording").output
    };
    let alone = noise(&alone(&settings), &alone(&silent), 1);
    assert_normal(&alone, 1.2e-4, "one transmission");
    let noisy = simulate(&truth, &settings, ROWS, 23).expect("a recording");
    let together = noise(&noisy.output, &quiet(&truth, &settings, 23).output, 1);
    assert_uncorrelated(&alone, &together, "one seed, two recordings");
}

#[test]
fn normal_noise_and_counts_add_their_variances() {
    let truth = arm();
    let settings = Settings {
        output_noise: Noise::GaussianAndCounts,
        cable_noise: Noise::GaussianAndCounts,
        cable_sigma: CableSigma::Stated,
        ..Settings::paper()
    };
    let noisy = simulate(&truth, &settings, ROWS, 24).expect("a recording");
    let quiet = quiet(&truth, &settings, 24);
    // poses spread over thousands of counts, so rounding adds count^2 / 12
    let outputs = [
        (TAU / 20000.0, TAU / 20000.0 / 3.0),
        (TAU / 18000.0, 1.2e-4),
    ];
    for (joint, (count, sd)) in outputs.into_iter().enumerate() {
        let noise = noise(&noisy.output, &quiet.output, joint);
        let want = (sd * sd + count * count / 12.0).sqrt();
        assert_centred(&noise, want, "output");
    }
    let count = TAU * 0.02 / 10000.0;
    let noise = noise(&noisy.cable_m, &quiet.cable_m, 1);
    assert_centred(
        &noise,
        (4e-5f64.powi(2) + count * count / 12.0).sqrt(),
        "cable",
    );
}
