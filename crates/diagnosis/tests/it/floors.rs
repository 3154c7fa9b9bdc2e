//! Noise floors of single postures: by repeats where there are some, never above what is left.

use haptical_diagnosis::{Diagnosis, NoReduction, NoiseSource, Options, Verdict, diagnose};
use haptical_model::{Device, Recording};

use crate::normal::Normal;
use crate::postures::{self, POSITION_SD_M};

const REPEATS: usize = 3;

/// Every posture three times, its rows one after the other; `scatter_m` of each coordinate.
fn repeated(recording: &Recording, scatter_m: f64) -> Recording {
    let rows: Vec<usize> = (0..recording.len() * REPEATS)
        .map(|row| row / REPEATS)
        .collect();
    let mut recording = recording.select(&rows);
    recording.line = (2..).take(rows.len()).collect();
    let mut random = Normal::new(99);
    for column in recording.position_m.iter_mut().flatten() {
        column
            .iter_mut()
            .for_each(|value| *value += scatter_m * random.next());
    }
    recording
}

fn diagnosed(device: &Device, recording: &Recording) -> Diagnosis {
    diagnose(device, recording, &Options::default()).unwrap()
}

/// Real: postures recorded three times each, whose repeats scatter by 1.4 um, had floors of 54 and 28 mm, since most rows
/// do not differ from their neighbours.
#[test]
fn repeated_postures_are_no_motion_and_their_scatter_is_the_floor() {
    let rough = postures::recorded(1, f64::INFINITY, 5.0 * POSITION_SD_M);
    let recording = repeated(&rough, 0.2 * POSITION_SD_M);
    let diagnosis = diagnosed(&postures::device(), &recording);
    let position = &diagnosis.gap.channels[0];
    assert_eq!(position.noise_source, NoiseSource::Repeats);
    let [low, high] = position.noise_floor_ci95;
    assert!((low..high).contains(&(0.2 * POSITION_SD_M)), "{position:?}");
    // what does not repeat from posture to posture is no noise
    assert_eq!(diagnosis.verdict, Verdict::Unknown);
    assert!(position.has_gap);
    let is_evidence = |warning: &String| warning.contains("repeats of postures scatter by");
    assert!(
        diagnosis.warnings.iter().any(is_evidence),
        "{:?}",
        diagnosis.warnings
    );
}

/// Repeats that scatter as the device file says change nothing.
#[test]
fn repeats_as_stated_have_no_gap() {
    let exact = postures::recorded(1, f64::INFINITY, 0.0);
    let diagnosis = diagnosed(&postures::device(), &repeated(&exact, POSITION_SD_M));
    assert_eq!(
        diagnosis.verdict,
        Verdict::NoGap,
        "{:?}",
        diagnosis.whiteness
    );
    let position = &diagnosis.gap.channels[0];
    assert_eq!(position.noise_source, NoiseSource::Repeats);
    assert!((position.noise_floor / POSITION_SD_M - 1.0).abs() < 0.15);
    assert_eq!(position.no_reduction, Some(NoReduction::NoGap));
    assert!(
        diagnosis
            .warnings
            .iter()
            .all(|warning| !warning.contains("repeats"))
    );
}

/// Repeats from both sides scatter by a play: that is no noise.
#[test]
fn a_play_between_repeats_does_not_raise_a_stated_noise() {
    let exact = postures::recorded_with(1, POSITION_SD_M, |posture, link| {
        link[0] -= 4e-4 * (posture.reading[0] - posture.before[0]).signum();
        Default::default()
    });
    let there: Vec<usize> = (0..exact.len()).chain((0..exact.len()).rev()).collect();
    let mut recording = exact.select(&there);
    recording.line = (2..).take(there.len()).collect();
    // on the way back every posture is approached from the other side
    let back = postures::recorded_with(2, POSITION_SD_M, |_, _| Default::default());
    assert_eq!(back.len(), exact.len());
    let diagnosis = diagnosed(&postures::device(), &recording);
    let position = &diagnosis.gap.channels[0];
    assert!(position.noise_floor < 1.1 * POSITION_SD_M, "{position:?}");
}

/// A gap whose noise nothing states and no repeat shows: the floor is what was left, and closes nothing.
#[test]
fn a_floor_that_nothing_but_the_rest_gives_closes_no_share() {
    let mut device = postures::device();
    if let Some(tracker) = &mut device.tracker {
        tracker.position_sd_m = None;
    }
    let recording = postures::recorded(1, postures::STIFFNESS_NM_PER_RAD, POSITION_SD_M);
    let diagnosis = diagnosed(&device, &recording);
    let position = &diagnosis.gap.channels[0];
    assert_eq!(position.noise_source, NoiseSource::Rest);
    if position.reduction_percent.is_some() {
        assert!(position.noise_floor <= position.rms_before, "{position:?}");
    }
}
