//! Twelve motions of a real SO-101 with faults planted from the middle on: found, placed, and nothing where nothing was planted.

use std::path::PathBuf;

use haptical::servo::{Finding, JointLog, diagnose_joint, torque_gain};
use haptical::{Device, Log};

/// The folder of measured data, or a printed line.
fn measured() -> Option<PathBuf> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let places = ["../../../shared", "../../../../shared"];
    let mut places = places
        .iter()
        .map(|place| root.join(place).join("measured/so101"));
    let found = places.find(|place| place.is_dir());
    if found.is_none() {
        println!("skipped: no folder measured/so101 beside the project");
    }
    found
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    None,
    Offset,
    Gain,
    /// Of the positions, not of the velocities beside them.
    Delay,
    /// Of all that is measured.
    DelayOfAll,
    TorqueGain,
}

impl Fault {
    fn effect(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Offset => "joint-offset",
            Self::Gain => "servo-gain",
            Self::Delay | Self::DelayOfAll => "command-latency",
            Self::TorqueGain => "torque-gain",
        }
    }

    /// Plants it from a row on.
    fn plant(self, readings: &mut [f64], at: usize) {
        let before = readings.to_vec();
        let mean = before.iter().sum::<f64>() / before.len() as f64;
        for row in at..readings.len() {
            readings[row] = match self {
                Self::None => before[row],
                Self::Offset => before[row] + 17_f64.to_radians(),
                Self::Gain => mean + 4.0 * (before[row] - mean),
                Self::Delay | Self::DelayOfAll => before[row - 1],
                Self::TorqueGain => 4.0 * before[row],
            };
        }
    }
}

/// Joints' logs that were tested, with the fault found, with it placed, with another change, and with the fault in the interval
/// that is said.
type Counts = [usize; 5];

fn counted(device: &Device, files: &[PathBuf], fault: Fault) -> Counts {
    let mut counts = [0; 5];
    for file in files {
        let log = Log::read(file, device).unwrap();
        let recording = &log.recording;
        let time_s = recording.time_s.as_deref().unwrap();
        let at = time_s.len() / 2;
        for joint in 0..6 {
            let mut readings = recording.joint[joint].clone();
            let mut velocity = recording.velocity(joint).unwrap().to_vec();
            let mut torque = recording.torque_nm[joint].clone().unwrap();
            match fault {
                Fault::TorqueGain => fault.plant(&mut torque, at),
                _ => fault.plant(&mut readings, at),
            }
            if fault == Fault::DelayOfAll {
                fault.plant(&mut velocity, at);
                fault.plant(&mut torque, at);
            }
            let others = (0..6).filter(|other| *other != joint);
            let others: Vec<&[f64]> = others.map(|other| &recording.joint[other][..]).collect();
            let log = JointLog {
                time_s: Some(time_s),
                command: recording.command(joint),
                response: &readings,
                velocity: Some(&velocity),
                torque: Some(&torque),
                others: &others,
                ..JointLog::default()
            };
            let scale = torque_gain(&log);
            let of_torque = fault == Fault::TorqueGain;
            // a torque's scale shows no matter what the positions do
            let answer = if of_torque {
                None
            } else {
                diagnose_joint(&log).ok()
            };
            if answer.is_none() && !of_torque {
                continue;
            }
            counts[0] += 1;
            let causes = answer.map_or(Vec::new(), |answer| answer.causes);
            let changes: Vec<&Finding> = (causes.iter().chain(&scale))
                .filter(|cause| cause.since.is_some())
                .collect();
            let own = changes.iter().find(|cause| cause.effect == fault.effect());
            let since = own.and_then(|cause| cause.since);
            let near =
                |since: &haptical::servo::Instant| (since.time_s[1] - time_s[at]).abs() < 0.2;
            let placed = since.filter(near);
            let is_held =
                |since: haptical::servo::Instant| (since.rows[0]..=since.rows[2]).contains(&at);
            counts[4] += usize::from(since.is_some_and(is_held));
            counts[1] += usize::from(own.is_some());
            counts[2] += usize::from(placed.is_some());
            counts[3] += usize::from(changes.iter().any(|cause| cause.effect != fault.effect()));
        }
    }
    counts
}

/// The device, and the motions in the order of their names.
fn arm(folder: PathBuf) -> (Device, Vec<PathBuf>) {
    let device = "../../fixtures/devices/so101.toml";
    let device = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(device);
    let device = Device::load(&device).unwrap();
    let entries = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|end| end == "gz"));
    files.sort();
    assert_eq!(files.len(), 12);
    (device, files)
}

/// At least these shares of the tested joints have the fault found and placed, and none has another. Every fourth motion: all of
/// them take two minutes.
fn assert_found(fault: Fault, least_found: f64, least_placed: f64) {
    let Some(folder) = measured() else { return };
    let (device, files) = arm(folder);
    let files: Vec<PathBuf> = files.into_iter().step_by(4).collect();
    let counts = counted(&device, &files, fault);
    let least = |share: f64| (share * counts[0] as f64).floor() as usize;
    assert!(counts[0] >= 12, "{fault:?}: {counts:?}");
    assert!(
        counts[1] >= least(least_found) && counts[2] >= least(least_placed),
        "{fault:?}: {counts:?}"
    );
    assert_eq!(counts[3], 0, "{fault:?}: {counts:?}");
}

#[test]
fn sound_logs_have_no_fault() {
    assert_found(Fault::None, 0.0, 0.0);
}

#[test]
fn offsets_are_found() {
    assert_found(Fault::Offset, 1.0, 1.0);
}

#[test]
fn gains_are_found() {
    assert_found(Fault::Gain, 0.8, 0.8);
}

#[test]
fn delays_are_found() {
    assert_found(Fault::Delay, 0.9, 0.6);
}

#[test]
fn torques_of_another_scale_are_found() {
    assert_found(Fault::TorqueGain, 1.0, 1.0);
}

/// The numbers of docs/diagnosis-servo.md.
#[test]
#[ignore = "two minutes: cargo test -p haptical --test it so101 -- --ignored --nocapture"]
fn faults_that_are_planted_in_all_motions() {
    let Some(folder) = measured() else { return };
    let (device, files) = arm(folder);
    for (fault, found, placed) in [
        (Fault::None, 0, 0),
        (Fault::Offset, 72, 72),
        (Fault::Gain, 57, 57),
        (Fault::Delay, 55, 39),
        (Fault::DelayOfAll, 22, 12),
        (Fault::TorqueGain, 72, 71),
    ] {
        // thresholds of a delay were set with the first of them in view
        let halves = [0, 1].map(|half| {
            let own: Vec<PathBuf> = files.iter().skip(half).step_by(2).cloned().collect();
            let counts = counted(&device, &own, fault);
            println!("{fault:?}: tested, found, placed, another, within: {counts:?}");
            counts
        });
        let sum = |index: usize| halves[0][index] + halves[1][index];
        assert!(sum(1) >= found && sum(2) >= placed, "{fault:?}: {halves:?}");
        assert_eq!(sum(3), 0, "{fault:?}: {halves:?}");
    }
}
