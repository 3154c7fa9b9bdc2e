//! A log of commands with encoders on the links besides: the servos' answer is the same, and the links have another.

use std::f64::consts::TAU;

use haptical::data::Cells;
use haptical::diagnosis::{Diagnosis, Verdict};
use haptical::files::Source;
use haptical::{Device, Diagnose, Equipment, Identify, Log, check, diagnose};

const DEVICE: &str = "[device]\nname = \"two servos\"\ndof = 2\n\
    [[joint]]\nname = \"pan\"\ntransmission = \"direct\"\nencoder_counts_per_rev = 4096\nexternal_encoder_sd_rad = 3e-4\n\
    [[joint]]\nname = \"lift\"\ntransmission = \"direct\"\nencoder_counts_per_rev = 4096\nexternal_encoder_sd_rad = 3e-4\n";
const LATE_S: f64 = 0.08;

fn device() -> Device {
    Device::open(&Source::text(DEVICE, "device.toml"), &Equipment::default()).unwrap()
}

/// Two servos that answer late, with encoders on the links or without; `commands` are multiplied by a factor, and the first link is turned
/// by `dent_rad` at an angle of 0.2 rad and nowhere else.
fn log(device: &Device, has_outputs: bool, factor: f64, dent_rad: f64) -> Log {
    let count = TAU / 4096.0;
    let mut random = haptical_testkit::Random::new(1);
    let times: Vec<f64> = (0..1500).map(|row| 0.02 * f64::from(row)).collect();
    let mut columns = vec![("t_s".to_owned(), times.clone())];
    for joint in 1..=2 {
        let phase = f64::from(joint);
        let course = |time_s: f64| {
            0.4 * (1.3 * time_s + 0.5 * phase).sin() + 0.2 * (2.9 * time_s + phase).sin()
        };
        let angles: Vec<f64> = times.iter().map(|time_s| course(time_s - LATE_S)).collect();
        let commands = times.iter().map(|time_s| factor * course(*time_s));
        let readings = angles.iter().map(|angle| (angle / count).round() * count);
        columns.push((format!("command{joint}_rad"), commands.collect()));
        columns.push((format!("theta{joint}_rad"), readings.collect()));
        let dent_rad = if joint == 1 { dent_rad } else { 0.0 };
        let link = |angle: &f64| {
            let dent = (-0.5 * ((angle - 0.2) / 0.04).powi(2)).exp();
            angle + dent_rad * dent + 3e-4 * random.normal()
        };
        if has_outputs {
            columns.push((format!("out{joint}_rad"), angles.iter().map(link).collect()));
        }
    }
    let columns: Vec<(&str, Cells<'_>)> = columns
        .iter()
        .map(|(name, cells)| (name.as_str(), Cells::Numbers(cells)))
        .collect();
    Log::from_columns(&columns, "log", device).unwrap()
}

fn answer(log: &Log, device: &Device) -> Diagnosis {
    diagnose(device, log, &Diagnose::default())
        .unwrap()
        .diagnosis
}

fn names(found: &Diagnosis) -> Vec<(String, Option<usize>)> {
    let causes = found.causes.iter();
    causes
        .map(|cause| (cause.effect.clone(), cause.joint))
        .collect()
}

#[test]
fn encoders_on_links_take_no_cause_of_the_commands_away() {
    let device = device();
    let alone = answer(&log(&device, false, 1.0, 0.0), &device);
    let late = |joint| ("command-latency".to_owned(), Some(joint));
    assert_eq!(names(&alone), [late(1), late(2)]);
    let with_outputs = answer(&log(&device, true, 1.0, 0.0), &device);
    // of commands this slow a delay is a mass on the loop as well
    assert_eq!(alone.verdict, Verdict::Ambiguous);
    assert_eq!(with_outputs.verdict, alone.verdict);
    assert_eq!(names(&with_outputs), names(&alone));
    let channels = with_outputs.gap.channels.iter();
    let gaps: Vec<(&str, bool)> = channels
        .map(|gap| (gap.channel.as_str(), gap.has_gap))
        .collect();
    for channel in [
        ("theta1", true),
        ("theta2", true),
        ("out1", false),
        ("out2", false),
    ] {
        assert!(gaps.contains(&channel), "{gaps:?}");
    }
    // the loops are tested, and the reason of the chain is none of theirs
    let mut untestable = with_outputs.untestable.iter();
    assert!(untestable.all(|entry| entry.effect != "command-latency"));
}

#[test]
fn a_gap_of_the_links_is_said_with_the_causes_of_the_commands() {
    let device = device();
    let found = answer(&log(&device, true, 1.0, 0.02), &device);
    assert_eq!(found.verdict, Verdict::Ambiguous);
    let out1 = found.gap.channels.iter().find(|gap| gap.channel == "out1");
    assert!(out1.unwrap().has_gap, "{:?}", found.gap);
    let is_explained = found
        .causes
        .iter()
        .any(|cause| cause.effect != "command-latency");
    let is_said = |words: &String| words.starts_with("out1 shows a gap that no cause explains");
    assert!(
        is_explained || found.warnings.iter().any(is_said),
        "{found:?}"
    );
}

#[test]
fn commands_in_other_units_are_said_and_hide_no_link() {
    let device = device();
    let found = answer(&log(&device, true, 57.29578, 0.0), &device);
    assert_eq!(found.verdict, Verdict::NoGap);
    let is_said = |words: &String| {
        words.starts_with("the commands were not tested") && words.contains("degrees")
    };
    assert!(found.warnings.iter().any(is_said), "{:?}", found.warnings);
}

#[test]
fn a_check_of_drives_that_need_no_form_is_no_error() {
    let device = device();
    let log = log(&device, true, 1.0, 0.0);
    let found = check(&device, Some(&log), &Identify::default()).unwrap();
    let log = found.log.unwrap();
    assert_eq!((log.identifiable.len(), log.not_identified.len()), (0, 8));
}
