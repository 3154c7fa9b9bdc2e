//! Properties of every seed and every sensible device.

use haptical_simulator::model::Recording;
use haptical_simulator::{Noise, Sampling, Settings, simulate};
use proptest::prelude::*;

use crate::device::arm;

fn noise() -> impl Strategy<Value = Noise> {
    prop::sample::select(vec![
        Noise::None,
        Noise::Gaussian,
        Noise::Counts,
        Noise::GaussianAndCounts,
    ])
}

fn all_finite(recording: &Recording) -> bool {
    let optional = recording.output.iter().chain(&recording.cable_m).flatten();
    let mut columns = recording.joint.iter().chain(optional);
    columns.all(|column| column.iter().all(|value| value.is_finite()))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn readings_stay_inside_their_bounds(
        seed: u64,
        sd in 0.01f64..2.0,
        lower in -1.5f64..-0.05,
        upper in 0.05f64..1.5,
        share in 0.05f64..1.0,
        (output_noise, cable_noise, motor_counts) in (noise(), noise(), any::<bool>()),
    ) {
        let mut truth = arm();
        truth.joints[0].sampling_sd_rad = Some(sd);
        truth.joints[0].lower_rad = lower;
        truth.joints[0].upper_rad = upper;
        let normal = Settings { output_noise, cable_noise, motor_counts, ..Settings::paper() };
        let uniform = Settings { sampling: Sampling::Uniform, uniform_share: share, ..normal };
        let half_count = 0.5 * truth.joints[0].reading_quantum_rad().expect("given");
        for (settings, low, high) in [
            (normal, lower.max(-3.0 * sd), upper.min(3.0 * sd)),
            (uniform, share * lower, share * upper),
        ] {
            let recording = simulate(&truth, &settings, 20, seed).expect("a recording");
            prop_assert!(all_finite(&recording));
            let slack = if motor_counts { half_count * (1.0 + 1e-9) } else { 0.0 };
            for reading in &recording.joint[0] {
                prop_assert!((low - slack..=high + slack).contains(reading));
            }
        }
    }

    #[test]
    fn a_prefix_is_a_shorter_recording(seed: u64, rows in 1usize..30, more in 1usize..30) {
        let truth = arm();
        let settings = Settings::real_encoders();
        let long = simulate(&truth, &settings, rows + more, seed).expect("a recording");
        let short = simulate(&truth, &settings, rows, seed).expect("a recording");
        prop_assert_eq!(long.select(&(0..rows).collect::<Vec<usize>>()), short);
    }
}
