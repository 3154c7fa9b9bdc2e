//! A second recording by what the rows of the log determine.

use haptical_effects::Context;
use haptical_model::Recording;

use super::arm::{Scene, arm};
use crate::answer::OnSecond;

/// What the first `rows` rows say of the whole recording.
fn judged(whole: &Recording, rows: usize) -> OnSecond {
    let device = arm();
    let log = whole.select(&(0..rows).collect::<Vec<_>>());
    let context = Context::new(&device, &log, &[]).unwrap();
    let answer = crate::force::examine(&context, Some(whole), &[]).unwrap();
    let why = answer.not_tested;
    answer.second.unwrap_or_else(|| panic!("{why:?}"))
}

#[test]
fn where_the_rows_of_the_log_determine_nothing_nothing_is_predicted() {
    for seed in [3, 4, 5] {
        let whole = Scene::new(seed, 6000).record();
        let seen = judged(&whole, 1500);
        let left_out = seen.second.channels.iter().map(|own| own.left_out);
        let is_said = seen
            .second
            .not_predicted
            .iter()
            .any(|own| own.contains("left out"));
        assert!(left_out.sum::<usize>() > 0 || is_said, "{seed}: {seen:?}");
        // what is predicted is within what the error of the fit scatters it by
        for channel in &seen.second.channels {
            assert!(
                !channel.has_gap && channel.rms < 3.0 * channel.noise_floor,
                "{seed}: {channel:?}"
            );
        }
        // most of the motion determines all
        let seen = judged(&whole, 5500);
        assert_eq!(seen.second.channels.len(), 5, "{seed}");
        assert_eq!(seen.second.not_predicted, Vec::<String>::new(), "{seed}");
        let share = |part: &OnSecond| part.predictions.len() as f64 / 5.0;
        assert!(share(&seen) > 0.95 * blocks(&whole), "{seed}");
    }
}

/// Means over time of a recording, of each torque.
fn blocks(whole: &Recording) -> f64 {
    let device = arm();
    let context = Context::new(&device, whole, &[]).unwrap();
    let recorded = crate::force::recorded::Recorded::new(&context, false);
    recorded.unwrap().blocks.len() as f64
}
